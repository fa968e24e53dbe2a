// Spectra, colours and textures of pbrt files.
#include "tests/io/pbrt_files.h"

#include "snell/io/pbrt/bake.h"
#include "snell/io/pbrt/color.h"
#include "snell/io/pbrt/named_spectra.h"
#include "snell/io/pbrt/spectrum.h"

namespace snell {
namespace {

using namespace test;
using pbrt::Spectrum;

Spectrum sampled(pbrt::Samples samples)
{
    Spectrum s;
    s.kind = Spectrum::Kind::sampled;
    s.samples = std::make_shared<const pbrt::Samples>(std::move(samples));
    return s;
}

vec3 base_color(const std::string& parameter, const std::string& before = {})
{
    const Scene scene = read_pbrt(before + " WorldBegin Material \"diffuse\" " + parameter + a_triangle);
    return scene.materials.at(0).base_color;
}

vec3 point_light(const std::string& parameters, const std::string& after = {})
{
    return read_pbrt("WorldBegin LightSource \"point\" " + parameters + after).lights.at(0).emission;
}

float luminance(vec3 rgb)
{
    return 0.2126f * rgb.x + 0.7152f * rgb.y + 0.0722f * rgb.z;
}

TEST(PbrtColor, TheObserversFitHasTheStandardsMaximaAndEqualAreas)
{
    EXPECT_NEAR(pbrt::cie_1931(555).y, 1.0, 0.01);
    EXPECT_NEAR(pbrt::cie_1931(600).x, 1.0622, 0.02);
    EXPECT_NEAR(pbrt::cie_1931(445).z, 1.7826, 0.04);
    glm::dvec3 sum(0.0);
    for (int nm = 360; nm <= 830; ++nm) sum += pbrt::cie_1931(nm);
    EXPECT_NEAR(sum.x, 106.9, 1.0);
    EXPECT_NEAR(sum.y, 106.9, 1.0);
    EXPECT_NEAR(sum.z, 106.9, 1.0);
}

TEST(PbrtColor, Spaces)
{
    const pbrt::ColorSpace& aces = *pbrt::find_color_space("ACES2065-1");
    expect_near(aces.reflectance * vec3(0.4f), vec3(0.4f), 1e-5f);
    expect_near(aces.light * vec3(1, 0, 0), vec3(2.558f, -0.277f, -0.017f), 0.02f); // AP0 to Rec.709, unadapted
    expect_near(pbrt::find_color_space("rec2020")->light * vec3(1.0f), vec3(1.0f), 1e-5f);
    expect_near(pbrt::find_color_space("rec2020")->light * vec3(0, 1, 0), vec3(-0.588f, 1.133f, -0.101f), 2e-3f);
    EXPECT_EQ(pbrt::find_color_space("adobe"), nullptr);
    expect_near(base_color("\"rgb reflectance\" [.5 .5 .5]", "ColorSpace \"aces2065-1\""), vec3(0.5f), 1e-5f);
}

TEST(PbrtSpectra, ReflectancesBecomeTheColourInWhiteLight)
{
    expect_near(pbrt::reflectance_rgb(sampled({{400, 0.7f}, {700, 0.7f}})), vec3(0.7f), 1e-5f);
    const vec3 red = pbrt::reflectance_rgb(sampled({{590, 0.0f}, {610, 1.0f}}));
    EXPECT_GT(red.x, 0.6f);
    EXPECT_LT(red.y, 0.1f);
    EXPECT_LT(red.z, 0.05f);
    expect_near(base_color("\"spectrum reflectance\" [300 .25 800 .25]"), vec3(0.25f), 1e-5f);
    expect_near(base_color("\"spectrum reflectance\" .4"), vec3(0.4f), 1e-6f);
    expect_near(base_color("\"color reflectance\" [.4 .5 .6]"), vec3(0.4f, 0.5f, 0.6f), 1e-6f);
    expect_near(base_color("\"xyz reflectance\" [.9505 1 1.089]"), vec3(1.0f), 2e-3f);
    const Folder folder;
    folder.write("grey.spd", "# a comment\n400 .3\n700\t.3\n");
    const Scene scene = read_pbrt(
        folder, std::string("WorldBegin Material \"diffuse\" \"spectrum reflectance\" \"grey.spd\"") + a_triangle);
    expect_near(scene.materials.at(0).base_color, vec3(0.3f), 1e-5f);
    folder.write("bad.spd", "400 .3\n700 x\n");
    try {
        read_pbrt(folder, "WorldBegin Material \"diffuse\" \"spectrum reflectance\" \"bad.spd\"");
        FAIL();
    } catch (const Error& error) {
        EXPECT_EQ(error.place.line, 2);
    }
    EXPECT_TRUE(has_note(read_pbrt("WorldBegin Material \"diffuse\" \"spectrum reflectance\" \"stdillum-X\""),
                         "neither a known name nor a file"));
}

TEST(PbrtSpectra, LightsOfV4HaveTheLuminanceOfTheirScale)
{
    expect_near(point_light("\"rgb I\" [1 2 3] \"float scale\" 2"), vec3(2, 4, 6), 1e-5f);
    for (const char* spectrum : {"\"blackbody I\" 3000", "\"blackbody I\" 9000", "\"spectrum I\" [400 .1 600 9 700 2]",
                                 "\"spectrum I\" \"stdillum-A\"", "\"spectrum I\" \"stdillum-F4\""})
        EXPECT_NEAR(luminance(point_light(std::string(spectrum) + " \"float scale\" 7")), 7.0f, 0.02f) << spectrum;
    const vec3 warm = point_light("\"blackbody I\" 2856"), a = point_light("\"spectrum I\" \"stdillum-A\"");
    expect_near(warm, a, 0.03f, "illuminant A is a blackbody of 2856 K");
    expect_near(point_light("\"spectrum I\" \"stdillum-D65\""), vec3(1.0f), 2e-3f);
    // v3: relative to the peak, times the scale.
    const vec3 v3 = point_light("\"blackbody I\" [5000 10]", " WorldEnd");
    EXPECT_NEAR(luminance(v3), 9.6f, 0.4f);
}

TEST(PbrtSpectra, MetalsKeepTheirReflectance)
{
    // Constant spectra come back; others have the reflectance of the spectra at normal incidence.
    const pbrt::Metal grey = pbrt::metal_rgb(sampled({{400, 1.5f}}), sampled({{400, 3.0f}}));
    expect_near(grey.eta, vec3(1.5f), 1e-3f);
    expect_near(grey.k, vec3(3.0f), 1e-3f);
    const auto eta = sampled({{400, 1.5f}, {500, 1.0f}, {600, 0.2f}, {700, 0.15f}});
    const auto k = sampled({{400, 1.9f}, {500, 1.9f}, {600, 3.0f}, {700, 4.0f}});
    const pbrt::Metal metal = pbrt::metal_rgb(eta, k);
    pbrt::Samples reflectance;
    for (float nm = 360; nm <= 830; nm += 1) {
        const float e = static_cast<float>(pbrt::value_at(*eta.samples, static_cast<double>(nm)));
        const float q = static_cast<float>(pbrt::value_at(*k.samples, static_cast<double>(nm)));
        reflectance.emplace_back(nm, ((e - 1) * (e - 1) + q * q) / ((e + 1) * (e + 1) + q * q));
    }
    const vec3 wanted = pbrt::reflectance_rgb(sampled(reflectance));
    const vec3 l = metal.eta - 1.0f, h = metal.eta + 1.0f;
    expect_near((l * l + metal.k * metal.k) / (h * h + metal.k * metal.k), wanted, 1e-3f);
    const pbrt::Metal gold = pbrt::named_metal("Au");
    EXPECT_GT(gold.k.x, gold.k.z);
    EXPECT_FLOAT_EQ(pbrt::find_named_spectrum("glass-BK7")->rgb.x, 1.5168f);
    EXPECT_FALSE(pbrt::find_named_spectrum("metal-Xx-eta").has_value());
}

TextureRef base_texture(const Scene& scene)
{
    return scene.materials.at(0).base_texture;
}
vec3 at(const Scene& scene, float u, float v)
{
    const MaterialDesc& m = scene.materials.at(0);
    const vec4 t = pbrt::look_up(scene.images.at(m.base_texture.image.value), m.base_texture, {u, v});
    return m.base_color * vec3(t.x, t.y, t.z);
}
std::string textured(const std::string& textures, const std::string& name = "t")
{
    return "WorldBegin " + textures + " Material \"diffuse\" \"texture reflectance\" \"" + name + "\"" + a_triangle;
}

TEST(PbrtTextures, ConstantsFold)
{
    const Scene scene = read_pbrt(textured(R"(
        Texture "a" "spectrum" "constant" "rgb value" [.2 .4 .6]
        Texture "b" "spectrum" "scale" "texture tex" "a" "float scale" .5
        Texture "n" "float" "constant" "float value" .25
        Texture "t" "spectrum" "mix" "texture tex1" "b" "rgb tex2" [1 1 1] "texture amount" "n")"));
    EXPECT_FALSE(base_texture(scene).valid());
    expect_near(scene.materials[0].base_color, vec3(0.325f, 0.4f, 0.475f), 1e-5f);
    EXPECT_TRUE(scene.images.empty());
}

TEST(PbrtTextures, PicturesKeepScaleMappingWrapAndFilter)
{
    const Folder folder;
    // 2 x 1, red and blue
    folder.write("p.tga", std::string("\0\0\2\0\0\0\0\0\0\0\0\0\2\0\1\0\x18\x20\0\0\xff\xff\0\0", 24));
    const Scene scene = read_pbrt(folder, textured(R"(
        Texture "p" "spectrum" "imagemap" "string filename" "p.tga" "float uscale" 2 "float vscale" 3 "float udelta" .25
            "string wrap" "clamp" "string filter" "point" "float scale" .5
        Texture "t" "spectrum" "scale" "texture tex" "p" "float scale" .5)"));
    const TextureRef ref = base_texture(scene);
    ASSERT_TRUE(ref.valid());
    EXPECT_EQ(ref.row_u, vec3(2, 0, 0.25f));
    EXPECT_EQ(ref.row_v, vec3(0, 3, 0));
    EXPECT_EQ(ref.wrap_u, wrap_clamp);
    EXPECT_EQ(ref.filter, filter_nearest);
    EXPECT_EQ(scene.images[0].width, 2u);
    expect_near(scene.materials[0].base_color, vec3(0.25f), 1e-6f);
    expect_near(at(scene, 0.05f, 0.1f), vec3(0.25f, 0, 0), 1e-5f);
    expect_near(at(scene, 0.9f, 0.1f), vec3(0, 0, 0.25f), 1e-5f);
    EXPECT_EQ(warning_count(scene), 0u) << all_notes(scene);
    // The same file twice is one image; as a number it is grey.
    const Scene twice = read_pbrt(folder, textured(R"(Texture "t" "spectrum" "imagemap" "string filename" "p.tga"
        Texture "u" "spectrum" "imagemap" "string filename" "p.tga" "float uscale" 4
        Texture "f" "float" "imagemap" "string filename" "p.tga" "string encoding" "linear")") +
                                              " Material \"diffuse\" \"texture reflectance\" \"u\" Shape \"sphere\" "
                                              "Shape \"sphere\" \"texture alpha\" \"f\"");
    ASSERT_EQ(twice.images.size(), 2u);
    const MaterialDesc& holes = twice.materials.at(2);
    EXPECT_EQ(holes.coverage, coverage_blend);
    const vec4 grey = pbrt::look_up(twice.images[1], holes.opacity_texture, {0.25f, 0.5f});
    expect_near(vec3(grey.x, grey.y, grey.z), vec3(1.0f / 3.0f), 2e-3f);
}

TEST(PbrtTextures, CheckerboardsAreExact)
{
    const Scene scene =
        read_pbrt(textured("Texture \"t\" \"spectrum\" \"checkerboard\" \"float uscale\" 4 \"float vscale\" 2 "
                           "\"rgb tex1\" [.1 .2 .3] \"rgb tex2\" [.9 .8 .7]"));
    EXPECT_EQ(scene.images.at(0).width, 2u);
    for (int j = 0; j < 4; ++j)
        for (int i = 0; i < 8; ++i) {
            const float u = (static_cast<float>(i) + 0.3f) / 4, v = (static_cast<float>(j) + 0.7f) / 2;
            expect_near(at(scene, u, v), (i + j) % 2 == 0 ? vec3(.1f, .2f, .3f) : vec3(.9f, .8f, .7f), 1e-6f);
        }
}

TEST(PbrtTextures, TexturesOfTexturesAreComputed)
{
    const Scene scene = read_pbrt(textured(R"(
        Texture "a" "spectrum" "checkerboard" "float uscale" 2 "float vscale" 2 "rgb tex1" [1 1 1] "rgb tex2" [0 0 0]
        Texture "b" "spectrum" "bilerp" "rgb v00" [0 0 0] "rgb v10" [1 0 0] "rgb v01" [0 1 0] "rgb v11" [1 1 0]
        Texture "t" "spectrum" "mix" "texture tex1" "a" "texture tex2" "b" "float amount" .5)"));
    expect_near(at(scene, 0.25f, 0.25f), vec3(0.625f, 0.625f, 0.5f), 0.02f);
    expect_near(at(scene, 0.75f, 0.25f), vec3(0.375f, 0.125f, 0.0f), 0.02f);
    EXPECT_EQ(warning_count(scene), 0u) << all_notes(scene);
}

TEST(PbrtTextures, WhatIsMissingIsSaid)
{
    const Scene scene = read_pbrt(textured("Texture \"t\" \"spectrum\" \"imagemap\" \"string filename\" \"none.png\""));
    EXPECT_EQ(warning_count(scene), 1u) << all_notes(scene);
    EXPECT_GT(at(scene, 0.1f, 0.9f).x, 0.0f);
    EXPECT_TRUE(has_note(read_pbrt(textured("", "nowhere")), "'nowhere' is not defined"));
    EXPECT_TRUE(has_note(read_pbrt(textured("Texture \"t\" \"spectrum\" \"marble\"")), "'marble' are not there"));
    EXPECT_TRUE(
        has_note(read_pbrt(textured("Texture \"t\" \"spectrum\" \"checkerboard\" \"string mapping\" \"spherical\"")),
                 "mapping 'spherical'"));
}

} // namespace
} // namespace snell
