// The text of pbrt files: tokens, parameters, blocks, transforms, includes.
#include "tests/io/pbrt_files.h"

#include "snell/io/pbrt/tokenizer.h"
#include "snell/io/pbrt/transform.h"

#include <chrono>

namespace snell {
namespace {

using namespace test;
using pbrt::Token;

TEST(PbrtTokens, WordsStringsBracketsAndTheirPlaces)
{
    const std::string file = "a.pbrt";
    const std::string text =
        "\xef\xbb\xbfShape \"sphere\" # a comment \"with\" [ things ]\r\n  [1\t-2.5e3]\"\\\"q\\\"\"";
    pbrt::Tokenizer tokens(file, text);
    const struct
    {
        Token::Kind kind;
        std::string_view text;
        int line, column;
    } expected[] = {{Token::Kind::word, "Shape", 1, 1},       {Token::Kind::string, "sphere", 1, 7},
                    {Token::Kind::open, "[", 2, 3},           {Token::Kind::word, "1", 2, 4},
                    {Token::Kind::word, "-2.5e3", 2, 6},      {Token::Kind::close, "]", 2, 12},
                    {Token::Kind::string, "\\\"q\\\"", 2, 13}};
    for (const auto& e : expected) {
        EXPECT_EQ(tokens.peek().text, e.text);
        const Token t = tokens.next();
        EXPECT_EQ(t.kind, e.kind);
        EXPECT_EQ(t.text, e.text);
        EXPECT_EQ(t.spot.line, e.line);
        EXPECT_EQ(t.spot.column, e.column);
    }
    EXPECT_EQ(tokens.next().kind, Token::Kind::end);
    EXPECT_EQ(tokens.next().kind, Token::Kind::end);
    EXPECT_EQ(pbrt::unescape("\\\"q\\\" a\\\\b c\\new"), "\"q\" a\\b c\\new");
}

TEST(PbrtErrors, HaveTheirPlace)
{
    const struct
    {
        const char* text;
        const char* place;
        const char* message;
    } cases[] = {
        {"WorldBegin\nShape \"sphere", "scene.pbrt:2:7:", "does not end on its line"},
        {"WorldBegin\nShape \"sphere\" \"float radius\" [ 1 2", "scene.pbrt:2:16:", "']'"},
        {"WorldBegin\nShape \"sphere\" \"float radius\" \"one\"", "scene.pbrt:2:31:", "a number should be here"},
        {"WorldBegin\nShape \"sphere\" \"float radius\" 1e999", "scene.pbrt:2:31:", "too large"},
        {"WorldBegin\nShape \"sphere\" \"radius\" 1", "scene.pbrt:2:16:", "type name"},
        {"WorldBegin Shape \"trianglemesh\" \"point3 P\" [0 0 0 1]", "scene.pbrt:1:33:", "no multiple of 3"},
        {"WorldBegin Shape \"trianglemesh\" \"point3 P\" [0 0 0 1 0 0 0 1 0] \"integer indices\" [0 1 3]",
         "scene.pbrt:1:64:", "index 3"},
        {"WorldBegin Shape \"trianglemesh\" \"point3 P\" [0 0 0 1 0 0 0 1 0] \"integer indices\" [0 1 -1]",
         "scene.pbrt:1:64:", "index -1"},
        {"WorldBegin Shape \"trianglemesh\" \"point3 P\" [0 0 0 1 0 0 0 1 0] \"integer indices\" [0 1 99999999999]",
         "scene.pbrt:1:87:", "whole number"},
        {"Translate 1 2", "scene.pbrt:1:14:", "truncated"},
        {"Translate 1 2 x", "scene.pbrt:1:15:", "a number"},
        {"Translate 1 2 1e400", "scene.pbrt:1:15:", "at most 1e18"},
        {"LookAt 0 0 0 0 0 0 0 1 0", "scene.pbrt:1:1:", "no direction"},
        {"LookAt 0 0 0 0 1 0 0 1 0", "scene.pbrt:1:1:", "no direction"},
        {"WorldBegin\nAttributeEnd", "scene.pbrt:2:1:", "ends nothing"},
        {"WorldBegin AttributeBegin ObjectEnd", "scene.pbrt:1:27:", "ends nothing"},
        {"WorldBegin ObjectBegin \"a\" ObjectInstance \"a\" ObjectEnd", "scene.pbrt:1:28:", "cannot contain"},
        {"WorldBegin ObjectBegin \"a\" ObjectBegin \"b\"", "scene.pbrt:1:28:", "within another"},
        {"WorldBegin Shape \"trianglemesh\" \"point3 P\" [0 0 0 1 0 0 0 1 0 1 1 0]",
         "scene.pbrt:1:12:", "no triangles"},
        {"WorldBegin Shape \"plymesh\"", "scene.pbrt:1:12:", "filename"},
        {"\x01\x02", "scene.pbrt:1:1:", "neither a directive nor a number"},
        {"Scale 0 1 1 Camera \"perspective\"", "scene.pbrt:1:13:", "no inverse"},
    };
    for (const auto& c : cases) {
        const std::string error = pbrt_error(c.text);
        EXPECT_NE(error.find(c.place), std::string::npos) << c.text << "\n" << error;
        EXPECT_NE(error.find(c.message), std::string::npos) << c.text << "\n" << error;
    }
}

TEST(PbrtErrors, HostileFilesEndInTime)
{
    const auto start = std::chrono::steady_clock::now();
    std::string nested;
    for (int i = 0; i < 200'000; ++i) nested += "AttributeBegin ";
    EXPECT_NE(pbrt_error(nested).find("nested more than"), std::string::npos);

    const Folder folder;
    EXPECT_THROW(read_pbrt(folder, "Include \"scene.pbrt\""), Error);
    // Each file includes the next one twice: 2^30 times in all.
    for (int i = 0; i < 30; ++i)
        folder.write(fmt::format("{}.pbrt", i), fmt::format("Include \"{}.pbrt\" Include \"{}.pbrt\"", i + 1, i + 1));
    folder.write("30.pbrt", "Identity");
    EXPECT_THROW(read_pbrt(folder, "Include \"0.pbrt\""), Error);

    // Textures of textures, each of the last one twice.
    std::string doubled = "WorldBegin Texture \"t0\" \"spectrum\" \"checkerboard\" \"float uscale\" 8 ";
    for (int i = 1; i < 40; ++i)
        doubled += fmt::format(
            "Texture \"t{}\" \"spectrum\" \"mix\" \"texture tex1\" \"t{}\" \"texture tex2\" \"t{}\" ", i, i - 1, i - 1);
    doubled += "Material \"diffuse\" \"texture reflectance\" \"t39\"";
    const Scene scene = read_pbrt(doubled + a_triangle);
    ASSERT_EQ(scene.materials.size(), 1u);

    // Few bytes that ask for much.
    const Scene fine =
        read_pbrt("WorldBegin Shape \"loopsubdiv\" \"integer levels\" 12 \"point3 P\" [0 0 0 1 0 0 0 1 0]");
    EXPECT_LE(triangle_count(fine), 4'000'000u);
    EXPECT_TRUE(has_note(fine, "subdivided"));
    EXPECT_LT(std::chrono::steady_clock::now() - start, std::chrono::seconds(60));
}

TEST(PbrtErrors, DamagedFilesGiveAnErrorOrAScene)
{
    const std::string whole =
        std::string(
            "LookAt 0 0 5 0 0 0 0 1 0 Camera \"perspective\" \"float fov\" 40 WorldBegin\n"
            "Texture \"t\" \"spectrum\" \"checkerboard\" \"rgb tex1\" [1 0 0]\n"
            "MakeNamedMaterial \"m\" \"string type\" \"coateddiffuse\" \"texture reflectance\" \"t\"\n"
            "AttributeBegin NamedMaterial \"m\" Shape \"bilinearmesh\" \"point3 P\" [0 0 0 1 0 0 0 1 0 1 1 1]\n"
            "ObjectBegin \"o\" Shape \"sphere\" \"float radius\" .5 ObjectEnd ObjectInstance \"o\" AttributeEnd\n"
            "AreaLightSource \"diffuse\" \"spectrum L\" [400 1 700 2] \"float power\" 3 ") +
        a_triangle;
    const Folder folder;
    std::size_t scenes = 0, errors = 0;
    const auto load = [&](const std::string& text) {
        try {
            Scene scene = read_pbrt(folder, text);
            validate(scene);
            ++scenes;
        } catch (const Error&) {
            ++errors;
        }
    };
    for (std::size_t i = 0; i < whole.size(); i += 3) load(whole.substr(0, i));
    for (std::size_t i = 0; i < whole.size(); i += 3) {
        std::string damaged = whole;
        damaged[i] = "\"[]9-e#\n"[i / 3 % 8];
        load(damaged);
    }
    EXPECT_GT(scenes, 50u);
    EXPECT_GT(errors, 50u);
}

TEST(PbrtNotes, UnknownThingsAreNotedOnceWithTheirPlace)
{
    const Scene scene = read_pbrt("WorldBegin\nFrobnicate \"x\" \"float y\" [ 1 2 ]\nFrobnicate 1 2\n"
                                  "Shape \"sphere\" \"float radius\" 2 \"float wobble\" 3\n"
                                  "Shape \"sphere\" \"float radius\" 3 \"float wobble\" 3\n"
                                  "Shape \"dodecahedron\"\nMaterial \"velvet\" \"float x\" 1\nShape \"sphere\"\n"
                                  "Shape \"sphere\" \"half radius\" [ 1 \"two\" ]");
    EXPECT_EQ(warning_count(scene), 5u) << all_notes(scene);
    EXPECT_TRUE(has_note(scene, "scene.pbrt:2: the directive 'Frobnicate'"));
    EXPECT_TRUE(has_note(scene, "scene.pbrt:4: \"float wobble\""));
    EXPECT_TRUE(has_note(scene, "scene.pbrt:6: shapes of type 'dodecahedron'"));
    EXPECT_TRUE(has_note(scene, "scene.pbrt:7: materials of type 'velvet'"));
    EXPECT_TRUE(has_note(scene, "scene.pbrt:9: a parameter's type 'half'"));
    EXPECT_EQ(scene.instances.size(), 4u);
}

TEST(PbrtTransforms, ComposeAsDirectivesSay)
{
    const std::string shape = a_triangle; // spheres keep no more than centre and radius
    const Scene scene = read_pbrt(R"(WorldBegin
        AttributeBegin Translate 1 2 3 Rotate 90 0 0 1 Scale 2 3 4)" +
                                  shape + R"(AttributeEnd
        TransformBegin Translate 5 0 0 TransformEnd
        Transform [1 0 0 0  0 1 0 0  0 0 1 0  7 8 9 1] ConcatTransform [2 0 0 0 0 2 0 0 0 0 2 0 0 0 0 1]
        CoordinateSystem "here" Identity )" +
                                  shape + "CoordSysTransform \"here\"" + shape);
    ASSERT_EQ(scene.instances.size(), 3u);
    const auto at = [&](std::size_t i, vec3 p) { return transform_point(scene.instances[i].transform, p); };
    expect_near(at(0, vec3(0)), vec3(1, 2, 3), 1e-6f);
    expect_near(at(0, vec3(1, 0, 0)), vec3(1, 4, 3), 1e-5f);
    expect_near(at(0, vec3(0, 1, 0)), vec3(-2, 2, 3), 1e-5f);
    expect_near(at(0, vec3(0, 0, 1)), vec3(1, 2, 7), 1e-5f);
    expect_near(at(1, vec3(1, 0, 0)), vec3(1, 0, 0), 1e-6f);
    expect_near(at(2, vec3(1, 0, 0)), vec3(9, 8, 9), 1e-6f);
}

TEST(PbrtTransforms, SingularOnesLeaveTheShapeOut)
{
    const Scene scene = read_pbrt("WorldBegin Scale 1 0 1 Shape \"sphere\"");
    EXPECT_TRUE(scene.instances.empty());
    EXPECT_TRUE(has_note(scene, "no inverse"));
}

TEST(PbrtIncludes, AreReadInPlaceAndFilesFoundFromTheScene)
{
    const Folder folder;
    folder.write_folder("sub");
    folder.write("sub/part.pbrt", "Material \"diffuse\" \"rgb reflectance\" [.1 .2 .3] Translate 1 0 0");
    const Scene scene = read_pbrt(folder, "WorldBegin Include \"sub/part.pbrt\" Shape \"sphere\"");
    ASSERT_EQ(scene.spheres.size(), 1u);
    EXPECT_EQ(scene.spheres[0].center, vec3(1, 0, 0));
    expect_near(scene.materials[0].base_color, vec3(0.1f, 0.2f, 0.3f), 1e-6f);
    const Scene imported = read_pbrt(folder, "WorldBegin Import \"sub/part.pbrt\" Shape \"sphere\"");
    EXPECT_EQ(imported.spheres.at(0).center, vec3(0.0f));
    try {
        read_pbrt(folder, "Identity\nInclude \"nothing.pbrt\"");
        FAIL();
    } catch (const Error& error) {
        EXPECT_EQ(error.place.line, 2);
    }
    LoadOptions sandbox;
    sandbox.sandbox = true;
    EXPECT_THROW(read_pbrt(folder, "Include \"/etc/hosts\"", sandbox), Error);
}

TEST(PbrtCamera, PictureXIsPbrts)
{
    const std::string look = "LookAt 1 2 3  4 2 -1  0 1 0 Camera \"perspective\" \"float fov\" 30 WorldBegin";
    const Scene plain = read_pbrt(look);
    const Scene mirrored = read_pbrt("Scale -1 1 1 " + look);
    ASSERT_EQ(plain.cameras.size(), 1u);
    for (const Scene* scene : {&plain, &mirrored}) {
        const CameraDesc& camera = scene->cameras.at(0);
        expect_near(camera.eye, vec3(1, 2, 3), 1e-5f);
        expect_near(normalize(camera.target - camera.eye), vec3(0.6f, 0, -0.8f), 1e-5f);
        EXPECT_GT(camera.up.y, 0.99f);
        EXPECT_FLOAT_EQ(camera.fov_degrees, 30.0f);
    }
    // pbrt's camera is left-handed: x to the right is cross(up, view), the other way round than ours.
    EXPECT_TRUE(plain.cameras[0].mirrored);
    EXPECT_FALSE(mirrored.cameras[0].mirrored);
}

TEST(PbrtCamera, ScreenWindowNarrowsTheView)
{
    const Scene scene = read_pbrt("Camera \"perspective\" \"float fov\" 90 \"float screenwindow\" [-1 1 -.5 .5] "
                                  "Film \"rgb\" \"integer xresolution\" 200 \"integer yresolution\" 100 WorldBegin");
    EXPECT_NEAR(scene.cameras.at(0).fov_degrees, 2 * 26.565f, 1e-2f);
    EXPECT_EQ(warning_count(scene), 0u) << all_notes(scene);
    const Scene lens = read_pbrt("Camera \"perspective\" \"float lensradius\" .1 \"float focaldistance\" 3 WorldBegin");
    EXPECT_EQ(warning_count(lens), 0u) << all_notes(lens);
    EXPECT_EQ(lens.cameras.at(0).model.lens_radius, 0.1f);
    EXPECT_EQ(lens.cameras.at(0).model.focus_distance, 3.0f);
    EXPECT_EQ(warning_count(read_pbrt("Camera \"spherical\" WorldBegin")), 1u); // pbrt-v4's map of equal areas
}

TEST(PbrtCamera, OtherModels)
{
    const auto camera = [](const std::string& text) {
        const Scene scene = read_pbrt(text + " WorldBegin");
        EXPECT_EQ(warning_count(scene), 0u) << text;
        return scene.cameras.at(0).model;
    };
    EXPECT_EQ(camera("Camera \"environment\"").kind, camera_equirectangular);
    EXPECT_EQ(camera("Camera \"spherical\" \"string mapping\" \"equirectangular\"").kind, camera_equirectangular);
    EXPECT_EQ(camera("Camera \"orthographic\" \"float screenwindow\" [-4 4 -3 3]").half_side, 3.0f);
    EXPECT_EQ(camera("Camera \"orthographic\"").half_side, 1.0f);
    EXPECT_EQ(camera("Camera \"fisheye\" \"string projection\" \"rectilinear\"").kind, camera_pinhole);
    EXPECT_EQ(camera("Camera \"fisheye\" \"string projection\" \"equisolid\" \"float fov\" 220").kind,
              camera_equisolid);
    EXPECT_EQ(camera("Camera \"hmd\" \"float ipd\" .07 \"float distortion\" [.1 .2 .3]").k[5], 0.3f);

    const CameraModel lens =
        camera("Film \"rgb\" \"float diagonal\" 30 Camera \"realistic\" \"string lensfile\" \"fisheye\" "
               "\"float aperturediameter\" 4 \"float focusdistance\" 2");
    EXPECT_EQ(lens.kind, camera_lens);
    EXPECT_EQ(lens.lens.name, "fisheye");
    EXPECT_EQ(lens.stop_diameter, 4.0f);
    EXPECT_EQ(lens.focus_distance, 2.0f);
    EXPECT_EQ(lens.film_diagonal, 30.0f);

    for (const char* broken :
         {"Camera \"realistic\"", "Camera \"realistic\" \"string lensfile\" \"none.dat\"",
          "Camera \"realistic\" \"string lensfile\" \"fisheye\" \"float focusdistance\" .001",
          "Camera \"fisheye\" \"string projection\" \"oblong\"", "Camera \"fisheye\" \"float distortion\" [1 2 3]",
          "Camera \"hmd\" \"float fov\" 190", "Film \"rgb\" \"float diagonal\" 0"}) {
        const Scene scene = read_pbrt(std::string(broken) + " WorldBegin");
        EXPECT_EQ(warning_count(scene), 1u) << broken;
    }
}

TEST(PbrtOptions, BecomeHints)
{
    const Scene scene = read_pbrt(R"(Film "rgb" "integer xresolution" [320] "integer yresolution" 200
        "float cropwindow" [.25 .5 0 1] "string filename" "a.exr" "float diagonal" 35
        Sampler "halton" "integer pixelsamples" 48 "integer seed" 7
        Integrator "volpath" "integer maxdepth" 9 "bool regularize" true  WorldBegin)");
    EXPECT_EQ(scene.hints.width, 320);
    EXPECT_EQ(scene.hints.height, 200);
    EXPECT_EQ(scene.hints.spp, 48u);
    EXPECT_EQ(scene.hints.seed, 7u);
    EXPECT_EQ(scene.hints.max_depth, 9u);
    EXPECT_EQ(scene.hints.integrator, "path");
    EXPECT_EQ(scene.hints.sampler, "sobol");
    EXPECT_EQ(scene.hints.output, "a.exr");
    ASSERT_TRUE(scene.hints.crop_window.has_value());
    EXPECT_EQ((*scene.hints.crop_window)[1], 0.5f);
    EXPECT_EQ(warning_count(scene), 0u) << all_notes(scene);
    const Scene v3 =
        read_pbrt("Film \"image\" \"integer xresolution\" 64 Sampler \"stratified\" \"integer xsamples\" 3 "
                  "\"integer ysamples\" 5 WorldBegin WorldEnd");
    EXPECT_EQ(v3.hints.spp, 15u);
    EXPECT_EQ(v3.hints.height, 480);
}

} // namespace
} // namespace snell
