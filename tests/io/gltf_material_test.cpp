// Materials with their extensions and textures.
#include "tests/io/gltf_files.h"

#include <png.h>
#include <webp/encode.h>

namespace snell {
namespace {

using namespace test;

// 1 x 1.
std::string png_of(std::uint8_t r, std::uint8_t g, std::uint8_t b, std::uint8_t a)
{
    const std::uint8_t texel[] = {r, g, b, a};
    png_image image = {};
    image.version = PNG_IMAGE_VERSION;
    image.width = image.height = 1;
    image.format = PNG_FORMAT_RGBA;
    std::string out(4096, '\0');
    png_alloc_size_t size = out.size();
    EXPECT_TRUE(png_image_write_to_memory(&image, out.data(), &size, 0, texel, 0, nullptr));
    return out.substr(0, size);
}

json data_image(const std::string& bytes)
{
    return {{"uri", "data:image/png;base64," + base64(bytes)}};
}

MaterialDesc material_of(json material)
{
    const Scene scene = load(Gltf::with_material(std::move(material)));
    EXPECT_EQ(notes_of(scene), "");
    return scene.materials.at(0);
}

MaterialDesc extended(const char* extension, json fields)
{
    return material_of({{"extensions", {{extension, std::move(fields)}}}});
}

TEST(GltfMaterial, Defaults)
{
    const MaterialDesc m = material_of({{"name", "plain"}});
    EXPECT_EQ(m.kind, material_principled);
    EXPECT_EQ(m.base_color, vec3(1));
    EXPECT_EQ(m.principled.metallic, 1.0f);
    EXPECT_EQ(m.principled.roughness, 1.0f);
    EXPECT_EQ(m.principled.transmission, 0.0f);
    EXPECT_EQ(m.ior, 1.5f);
    EXPECT_EQ(m.coverage, coverage_opaque);
    EXPECT_FALSE(m.two_sided_emission);
    // A primitive without a material has the same.
    EXPECT_EQ(load(Gltf::triangle()).materials.at(0).principled.metallic, 1.0f);
}

TEST(GltfMaterial, Core)
{
    const MaterialDesc m =
        material_of({{"pbrMetallicRoughness",
                      {{"baseColorFactor", {0.1, 0.2, 0.3, 0.4}}, {"metallicFactor", 0.5}, {"roughnessFactor", 0.25}}},
                     {"emissiveFactor", {1, 0.5, 0}},
                     {"alphaMode", "MASK"},
                     {"alphaCutoff", 0.3},
                     {"doubleSided", true},
                     {"extensions", {{"KHR_materials_emissive_strength", {{"emissiveStrength", 4}}}}}});
    EXPECT_EQ(m.base_color, vec3(0.1f, 0.2f, 0.3f));
    EXPECT_EQ(m.principled.metallic, 0.5f);
    EXPECT_EQ(m.principled.roughness, 0.25f);
    EXPECT_EQ(m.emission, vec3(4, 2, 0));
    EXPECT_TRUE(m.two_sided_emission);
    EXPECT_EQ(m.coverage, coverage_mask);
    EXPECT_EQ(m.cutoff, 0.3f);
    EXPECT_EQ(m.opacity, 0.4f);
    const json base = {{"baseColorFactor", {1, 1, 1, 0.5}}};
    EXPECT_EQ(material_of({{"pbrMetallicRoughness", base}}).opacity, 1.0f);
    EXPECT_EQ(material_of({{"pbrMetallicRoughness", base}, {"alphaMode", "BLEND"}}).coverage, coverage_blend);
}

TEST(GltfMaterial, Extensions)
{
    const MaterialDesc unlit = extended("KHR_materials_unlit", json::object());
    EXPECT_EQ(unlit.kind, material_unlit);
    EXPECT_EQ(extended("KHR_materials_ior", {{"ior", 1.8}}).ior, 1.8f);
    EXPECT_EQ(extended("KHR_materials_ior", {{"ior", 0}}).principled.specular_color, vec3(25)); // reflects all
    EXPECT_EQ(extended("KHR_materials_dispersion", {{"dispersion", 0.1}}).principled.dispersion, 0.1f);

    PrincipledDesc p =
        extended("KHR_materials_specular", {{"specularFactor", 0.3}, {"specularColorFactor", {2, 1, 0}}}).principled;
    EXPECT_EQ(p.specular, 0.3f);
    EXPECT_EQ(p.specular_color, vec3(2, 1, 0));
    p = extended("KHR_materials_clearcoat", {{"clearcoatFactor", 0.6}, {"clearcoatRoughnessFactor", 0.1}}).principled;
    EXPECT_EQ(p.clearcoat, 0.6f);
    EXPECT_EQ(p.clearcoat_roughness, 0.1f);
    p = extended("KHR_materials_sheen", {{"sheenColorFactor", {0.1, 0.2, 0.3}}, {"sheenRoughnessFactor", 0.7}})
            .principled;
    EXPECT_EQ(p.sheen_color, vec3(0.1f, 0.2f, 0.3f));
    EXPECT_EQ(p.sheen_roughness, 0.7f);
    p = extended("KHR_materials_anisotropy", {{"anisotropyStrength", 0.6}, {"anisotropyRotation", 1.5}}).principled;
    EXPECT_EQ(p.anisotropy, 0.6f);
    EXPECT_EQ(p.anisotropy_rotation, 1.5f);
    p = extended("KHR_materials_iridescence",
                 {{"iridescenceFactor", 1}, {"iridescenceIor", 1.4}, {"iridescenceThicknessMaximum", 500}})
            .principled;
    EXPECT_EQ(p.iridescence, 1.0f);
    EXPECT_EQ(p.iridescence_ior, 1.4f);
    EXPECT_EQ(p.iridescence_thickness_min, 100.0f);
    EXPECT_EQ(p.iridescence_thickness_max, 500.0f);
    p = extended("KHR_materials_diffuse_transmission",
                 {{"diffuseTransmissionFactor", 0.4}, {"diffuseTransmissionColorFactor", {1, 0, 0}}})
            .principled;
    EXPECT_EQ(p.diffuse_transmission, 0.4f);
    EXPECT_EQ(p.diffuse_transmission_color, vec3(1, 0, 0));
}

TEST(GltfMaterial, GlassIsThinOrSolid)
{
    EXPECT_TRUE(extended("KHR_materials_transmission", {{"transmissionFactor", 1}}).principled.thin_walled);
    json extensions = {{"KHR_materials_transmission", {{"transmissionFactor", 0.9}}},
                       {"KHR_materials_volume",
                        {{"thicknessFactor", 1}, {"attenuationDistance", 0.5}, {"attenuationColor", {0.5, 1, 0}}}}};
    const MaterialDesc solid = material_of({{"extensions", extensions}});
    EXPECT_EQ(solid.principled.transmission, 0.9f);
    EXPECT_FALSE(solid.principled.thin_walled);
    EXPECT_NEAR(solid.absorption.x, 2 * std::log(2.0f), 1e-6f);
    EXPECT_EQ(solid.absorption.y, 0.0f);
    EXPECT_TRUE(std::isfinite(solid.absorption.z) && solid.absorption.z > 20.0f);
    extensions["KHR_materials_volume"].erase("attenuationDistance");
    EXPECT_EQ(material_of({{"extensions", extensions}}).absorption, vec3(0));
}

// glTF's texel at (u, v) is ours at (u, 1 - v), with every transform.
TEST(GltfMaterial, TextureTransforms)
{
    Gltf file = Gltf::with_material({{"pbrMetallicRoughness", {{"baseColorTexture", {{"index", 0}}}}}});
    file.append("images", data_image(png_of(1, 2, 3, 255)));
    file.append("textures", {{"source", 0}, {"sampler", 0}});
    file.append("samplers", {{"magFilter", 9728}, {"wrapS", 33071}, {"wrapT", 33648}});
    json& info = file.root["materials"][0]["pbrMetallicRoughness"]["baseColorTexture"];
    const auto lookup = [&](double u, double v) {
        const TextureRef ref = load(file).materials[0].base_texture;
        const vec3 at(static_cast<float>(u), static_cast<float>(1.0 - v), 1.0f);
        return vec2(dot(ref.row_u, at), 1.0f - dot(ref.row_v, at));
    };
    const auto expect = [](vec2 a, double x, double y) {
        EXPECT_NEAR(a.x, x, 1e-6);
        EXPECT_NEAR(a.y, y, 1e-6);
    };
    expect(lookup(0.3, 0.2), 0.3, 0.2);
    info["extensions"]["KHR_texture_transform"] = {{"offset", {0.5, 0.25}}, {"scale", {2, 3}}};
    expect(lookup(0.3, 0.2), 0.5 + 0.6, 0.25 + 0.6);
    // A quarter turn counter-clockwise, as it is seen with v downwards: what was right goes up, what was down right.
    info["extensions"]["KHR_texture_transform"]["rotation"] = 1.5707963267948966;
    expect(lookup(0.3, 0.2), 0.5 + 0.6, 0.25 - 0.6);
    info["extensions"]["KHR_texture_transform"] = {{"texCoord", 1}};
    const TextureRef ref = load(file).materials[0].base_texture;
    EXPECT_EQ(ref.uv_set, 1u);
    EXPECT_EQ(ref.filter, filter_nearest);
    EXPECT_EQ(ref.wrap_u, wrap_clamp);
    EXPECT_EQ(ref.wrap_v, wrap_mirror);
    info["extensions"]["KHR_texture_transform"] = {{"texCoord", 5}};
    EXPECT_NE(notes_of(load(file)).find("TEXCOORD_5"), std::string::npos);
}

TEST(GltfMaterial, OneImageAsColourAndAsData)
{
    Gltf file = Gltf::with_material(
        {{"pbrMetallicRoughness", {{"baseColorTexture", {{"index", 0}}}, {"metallicRoughnessTexture", {{"index", 0}}}}},
         {"alphaMode", "BLEND"}});
    file.append("images", {{"bufferView", file.view(png_of(10, 20, 30, 40))}, {"mimeType", "image/png"}});
    file.append("textures", {{"source", 0}});
    const Scene scene = load(file);
    const MaterialDesc& m = scene.materials[0];
    ASSERT_EQ(scene.images.size(), 2u);
    EXPECT_EQ(scene.images[m.base_texture.image.value].format, texels_rgba8_srgb);
    EXPECT_EQ(scene.images[m.principled.roughness_texture.image.value].format, texels_rgba8_linear);
    EXPECT_EQ(m.principled.roughness_texture.channel, 1u);
    EXPECT_EQ(m.principled.metallic_texture.channel, 2u);
    EXPECT_EQ(m.opacity_texture.channel, 3u);
    EXPECT_EQ(m.opacity_texture.image, m.base_texture.image);
    // Without holes it need not be looked up.
    file.root["images"][0] = data_image(png_of(10, 20, 30, 255));
    EXPECT_FALSE(load(file).materials[0].opacity_texture.valid());
}

TEST(GltfMaterial, SpecularGlossiness)
{
    Gltf file = Gltf::with_material({{"extensions",
                                      {{"KHR_materials_pbrSpecularGlossiness",
                                        {{"diffuseFactor", {0.1, 0.2, 0.3, 1}},
                                         {"specularFactor", {0.04, 0.08, 1}},
                                         {"glossinessFactor", 0.5},
                                         {"specularGlossinessTexture", {{"index", 0}}}}}}}});
    file.append("images", data_image(png_of(255, 255, 255, 51)));
    file.append("textures", {{"source", 0}});
    const Scene scene = load(file);
    const MaterialDesc& m = scene.materials[0];
    EXPECT_EQ(m.base_color, vec3(0.1f, 0.2f, 0.3f));
    EXPECT_EQ(m.principled.metallic, 0.0f);
    EXPECT_NEAR(m.principled.specular_color.y, 2.0f, 1e-5f);
    EXPECT_EQ(m.principled.roughness, 1.0f);
    const TextureRef& rough = m.principled.roughness_texture;
    EXPECT_EQ(scene.images[rough.image.value].bytes[rough.channel], 230); // 1 - 0.5 * 51 / 255
    file.root["materials"][0]["extensions"]["KHR_materials_pbrSpecularGlossiness"].erase("specularGlossinessTexture");
    EXPECT_EQ(load(file).materials[0].principled.roughness, 0.5f);
}

TEST(GltfMaterial, WebPComesFirst)
{
    const std::uint8_t texel[] = {200, 100, 50, 255};
    std::uint8_t* packed = nullptr;
    const std::size_t size = WebPEncodeLosslessRGBA(texel, 1, 1, 4, &packed);
    const std::string webp(reinterpret_cast<const char*>(packed), size);
    WebPFree(packed);
    Gltf file = Gltf::with_material({{"pbrMetallicRoughness", {{"baseColorTexture", {{"index", 0}}}}}});
    file.append("images", data_image(png_of(1, 2, 3, 255)));
    file.append("images", data_image(webp));
    file.append("textures", {{"source", 0}, {"extensions", {{"EXT_texture_webp", {{"source", 1}}}}}});
    EXPECT_EQ(load(file).images.at(0).bytes, (std::vector<std::uint8_t>{200, 100, 50, 255}));
    file.root["images"][1] = data_image(webp.substr(0, size - 6));
    EXPECT_NE(notes_of(load(file)).find("magenta"), std::string::npos);
}

TEST(GltfMaterial, MissingPicturesAreNamed)
{
    Gltf file = Gltf::with_material({{"pbrMetallicRoughness", {{"baseColorTexture", {{"index", 0}}}}},
                                     {"normalTexture", {{"index", 1}, {"scale", 0.5}}}});
    file.append("images", {{"uri", "no%20such.png"}});
    file.append("images", {{"uri", "http://example.org/n.png"}});
    file.append("textures", {{"source", 0}});
    file.append("textures", {{"source", 1}});
    Scene scene = load(file);
    EXPECT_NE(notes_of(scene).find("no such.png: no such file"), std::string::npos) << notes_of(scene);
    EXPECT_NE(notes_of(scene).find("nothing is fetched"), std::string::npos);
    EXPECT_EQ(scene.images[0].bytes[0], 255); // magenta
    EXPECT_EQ(scene.images[0].bytes[1], 0);
    EXPECT_EQ(scene.images[1].bytes, (std::vector<std::uint8_t>{128, 128, 255, 255})); // straight up
    EXPECT_EQ(scene.materials[0].normal_scale, 0.5f);

    // Basis pictures cannot be read; a plain one beside them can.
    file.root["images"][0] = data_image("\xabKTX 20\xbb and so on");
    file.root["textures"][0] = {{"extensions", {{"KHR_texture_basisu", {{"source", 0}}}}}};
    EXPECT_NE(notes_of(load(file)).find("is KTX2"), std::string::npos);
    file.root["images"][1] = data_image(png_of(1, 2, 3, 255));
    file.root["textures"][0]["source"] = 1;
    EXPECT_EQ(notes_of(load(file)).find("KTX2"), std::string::npos);
    file.root["textures"][0]["source"] = 2;
    EXPECT_NE(error_of(file).find("refers to image 2, but there are 2"), std::string::npos);
    file.root["materials"][0]["normalTexture"]["index"] = 2;
    EXPECT_NE(error_of(file).find("refers to"), std::string::npos);
}

TEST(GltfMaterial, SandboxRefusesWhatLiesOutside)
{
    Gltf file = Gltf::with_material({{"pbrMetallicRoughness", {{"baseColorTexture", {{"index", 0}}}}}});
    file.append("images", {{"uri", "../../secret.png"}});
    file.append("textures", {{"source", 0}});
    LoadOptions options;
    options.sandbox = true;
    EXPECT_NE(error_of(file, options).find("sandbox"), std::string::npos);
    EXPECT_EQ(error_of(file), "");
}

} // namespace
} // namespace snell
