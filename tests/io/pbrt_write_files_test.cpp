// Files of other formats that are written as pbrt files and read back.
#include "tests/io/gltf_files.h"
#include "tests/io/pbrt_write.h"

#include <png.h>

namespace snell {
namespace {

using namespace test;

TEST(PbrtWrite, AnObjOfSeveralMaterialsComesBack)
{
    const Folder folder;
    folder.write("m.mtl", "newmtl red\nKd .8 .1 .1\nnewmtl shiny\nKd .2 .2 .3\nKs .4 .4 .4\nNs 50\nillum 2\n"
                          "newmtl lamp\nKd 0 0 0\nKe 5 4 3\nnewmtl glass\nillum 7\nNi 1.4\nd 0.5\nKd .9 .9 .9\n");
    const std::filesystem::path file =
        folder.write("a.obj", "mtllib m.mtl\nv -1 0 -1\nv 1 0 -1\nv 1 0 1\nv -1 0 1\nv -1 2 -1\nv 1 2 -1\nv 1 2 1\n"
                              "v -1 2 1\nvt 0 0\nvt 1 0\nvt 1 1\nvn 0 1 0\nusemtl red\nf 1/1/1 4/2/1 3/3/1 2/1/1\n"
                              "usemtl shiny\nf 1 2 6 5\nusemtl lamp\nf 5 6 7 8\nusemtl glass\nf 4/1 8/2 7/3\n");
    const Scene scene = load_scene(file);
    const Scene back = write_and_read(folder, scene);
    EXPECT_EQ(triangle_count(scene), triangle_count(back));
    for (const MaterialDesc& m : scene.materials) {
        const MaterialDesc* other = find_material(back, m.name);
        ASSERT_NE(other, nullptr) << m.name;
        expect_same(scene, m, back, *other);
    }
    expect_same_picture(scene, back, "obj");
}

// Every extension's numbers and textures, from a file.
TEST(PbrtWrite, AGltfOfEveryExtensionComesBack)
{
    const Folder folder;
    Image noisy = noise("", texels_rgba8_srgb, 4, true);
    png_image png = {};
    png.version = PNG_IMAGE_VERSION;
    png.width = noisy.width, png.height = noisy.height;
    png.format = PNG_FORMAT_RGBA;
    std::string bytes(65536, '\0');
    png_alloc_size_t size = bytes.size();
    ASSERT_TRUE(png_image_write_to_memory(&png, bytes.data(), &size, 0, noisy.bytes.data(), 0, nullptr));
    folder.write("noise.png", bytes.substr(0, size));

    Gltf file;
    file.append("images", {{"uri", "noise.png"}});
    file.append("samplers", {{"wrapS", 33648}, {"wrapT", 33071}, {"magFilter", 9728}, {"minFilter", 9728}});
    file.append("textures", {{"source", 0}});
    file.append("textures", {{"source", 0}, {"sampler", 0}});
    const json plain = {{"index", 0}, {"texCoord", 1}};
    const json moved = {
        {"index", 1},
        {"extensions",
         {{"KHR_texture_transform", {{"offset", {0.1, 0.2}}, {"rotation", 0.7}, {"scale", {1.5, 0.75}}}}}}};
    const auto normal = [&](double scale) {
        json map = plain;
        map["scale"] = scale;
        return map;
    };
    file.append("materials",
                {{"name", "all"},
                 {"pbrMetallicRoughness",
                  {{"baseColorFactor", {0.9, 0.8, 0.7, 0.6}},
                   {"baseColorTexture", moved},
                   {"metallicFactor", 0.4},
                   {"roughnessFactor", 0.7},
                   {"metallicRoughnessTexture", plain}}},
                 {"normalTexture", normal(0.5)},
                 {"emissiveFactor", {0.1, 0.2, 0.3}},
                 {"emissiveTexture", moved},
                 {"alphaMode", "BLEND"},
                 {"doubleSided", true},
                 {"extensions",
                  {{"KHR_materials_emissive_strength", {{"emissiveStrength", 3}}},
                   {"KHR_materials_ior", {{"ior", 1.4}}},
                   {"KHR_materials_specular",
                    {{"specularFactor", 0.6},
                     {"specularTexture", plain},
                     {"specularColorFactor", {0.9, 0.5, 1.3}},
                     {"specularColorTexture", moved}}},
                   {"KHR_materials_clearcoat",
                    {{"clearcoatFactor", 0.5},
                     {"clearcoatTexture", plain},
                     {"clearcoatRoughnessFactor", 0.3},
                     {"clearcoatRoughnessTexture", moved},
                     {"clearcoatNormalTexture", normal(0.3)}}},
                   {"KHR_materials_sheen",
                    {{"sheenColorFactor", {0.3, 0.2, 0.1}},
                     {"sheenColorTexture", plain},
                     {"sheenRoughnessFactor", 0.4},
                     {"sheenRoughnessTexture", moved}}},
                   {"KHR_materials_transmission", {{"transmissionFactor", 0.5}, {"transmissionTexture", plain}}},
                   {"KHR_materials_volume",
                    {{"thicknessFactor", 1}, {"attenuationDistance", 0.7}, {"attenuationColor", {0.3, 0.6, 0.9}}}},
                   {"KHR_materials_anisotropy",
                    {{"anisotropyStrength", 0.6}, {"anisotropyRotation", 1.1}, {"anisotropyTexture", plain}}},
                   {"KHR_materials_iridescence",
                    {{"iridescenceFactor", 0.8},
                     {"iridescenceTexture", moved},
                     {"iridescenceIor", 1.7},
                     {"iridescenceThicknessMinimum", 150},
                     {"iridescenceThicknessMaximum", 650},
                     {"iridescenceThicknessTexture", plain}}},
                   {"KHR_materials_dispersion", {{"dispersion", 0.2}}},
                   {"KHR_materials_diffuse_transmission",
                    {{"diffuseTransmissionFactor", 0.2},
                     {"diffuseTransmissionTexture", moved},
                     {"diffuseTransmissionColorFactor", {0.9, 0.8, 0.4}},
                     {"diffuseTransmissionColorTexture", plain}}}}}});
    file.mesh({{"POSITION", file.accessor<float>({-1, -1, 0, 1, -1, 0, 1, 1, 0, -1, 1, 0.5}, "VEC3")},
               {"NORMAL", file.accessor<float>({0, 0, 1, 0, 0, 1, 0, 0.6f, 0.8f, 0, 0, 1}, "VEC3")},
               {"TANGENT", file.accessor<float>({1, 0, 0, 1, 1, 0, 0, -1, 1, 0, 0, 1, 0, 1, 0, 1}, "VEC4")},
               {"TEXCOORD_0", file.accessor<float>({0, 0, 2, 0, 2, 2, 0, 2}, "VEC2")},
               {"TEXCOORD_1", file.accessor<float>({0, 0, 0.5f, 0, 0.5f, 1, 0, 1}, "VEC2")},
               {"COLOR_0", file.accessor<float>({1, 1, 1, 1, 0.5f, 1, 1, 1, 1, 0.3f, 1, 0.5f, 1, 1, 1, 1}, "VEC4")}},
              {{"material", 0}, {"indices", file.accessor<std::uint16_t>({0, 1, 2, 0, 2, 3}, "SCALAR")}});
    file.node({{"name", "sheet"}, {"mesh", 0}, {"rotation", {0.1, 0.2, 0.3, 0.927361849549570}}});
    const Scene scene = load_scene(folder.write("a.gltf", file.text()));
    EXPECT_EQ(notes_of(scene), "");
    // The file has set them all: none is as it was.
    const MaterialDesc& m = scene.materials.at(0);
    for (const pbrt::NumberSlot& slot : pbrt::number_slots) {
        EXPECT_NE(m.principled.*slot.number, PrincipledDesc{}.*slot.number) << slot.name;
        if (slot.texture != nullptr) {
            EXPECT_TRUE((m.principled.*slot.texture).valid()) << slot.name;
        }
    }
    const Scene back = write_and_read(folder, scene);
    expect_same(scene, back);
    expect_same_picture(scene, back, "gltf");
}

TEST(PbrtWrite, ScenesOfOthersComeBack)
{
    const std::filesystem::path shared = std::filesystem::path(SNELL_SOURCE_DIR) / "../shared/scenes";
    for (const char* name :
         {"gltf/DamagedHelmet/glTF-Binary/DamagedHelmet.glb",
          "gltf/AlphaBlendModeTest/glTF-Binary/AlphaBlendModeTest.glb",
          "gltf/LightsPunctualLamp/glTF/LightsPunctualLamp.gltf", "gltf/SheenChair/glTF/SheenChair.gltf",
          "pbrt/bitterli-coffee/scene-v4.pbrt", "mesh/cornell_box_mcguire/CornellBox-Glossy.obj"}) {
        if (!std::filesystem::exists(shared / name)) {
            std::cout << "left out: no " << name << " in ../shared/scenes\n";
            continue;
        }
        SCOPED_TRACE(name);
        const Scene scene = load_scene(shared / name);
        const Folder folder;
        expect_same_picture(scene, write_and_read(folder, scene), name);
    }
}

} // namespace
} // namespace snell
