// snell camera: the numbers it prints, and what it says to nonsense.
#include "program.h"

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <cmath>
#include <fstream>
#include <iterator>

namespace snell::test {
namespace {

nlohmann::json measure(std::vector<std::string> arguments)
{
    arguments.insert(arguments.begin(), "camera");
    arguments.push_back("--json");
    Program program;
    const Outcome outcome = program.run(arguments);
    EXPECT_EQ(outcome.code, 0) << outcome.err;
    EXPECT_EQ(line_count(outcome.out), 1u);
    return nlohmann::json::parse(outcome.out);
}

TEST(CameraCommand, MeasuresACamera)
{
    const nlohmann::json json = measure({"--fov", "90", "--size", "600x300", "--points", "5"});
    EXPECT_NEAR(json.at("fov_degrees").at("vertical").get<double>(), 90.0, 0.01);
    EXPECT_NEAR(json.at("fov_degrees").at("horizontal").get<double>(), 2 * std::atan(2.0) * 180 / 3.14159265, 0.01);
    EXPECT_LT(json.at("round_trip").at("worst_pixels").get<double>(), 1e-3);
    EXPECT_EQ(json.at("round_trip").at("lost"), 0);
    EXPECT_EQ(json.at("distortion").size(), 5u);
    EXPECT_EQ(measure({"cornell"}).at("camera"), "front");

    Program program;
    const Outcome table = program.run({"camera", "cornell"});
    EXPECT_EQ(table.code, 0);
    EXPECT_NE(table.out.find("field of view"), std::string::npos);
    EXPECT_GT(line_count(table.out), 15u);
}

TEST(CameraCommand, MeasuresLenses)
{
    const nlohmann::json json = measure({"--lens", "double-gauss", "--focus-distance", "2"});
    EXPECT_EQ(json.at("model"), "lens");
    const nlohmann::json& lens = json.at("lens");
    EXPECT_NEAR(lens.at("focal_length_mm").get<double>(), 50.36, 0.05);
    EXPECT_GT(lens.at("film_distance_mm").get<double>(), 37.0); // extended, against 36.1 at infinity
    EXPECT_NEAR(lens.at("vignetting")[0].at("light").get<double>(), 1.0, 0.02);
    EXPECT_LT(lens.at("vignetting").back().at("light").get<double>(), 0.7);
    EXPECT_LT(json.at("round_trip").at("worst_pixels").get<double>(), 0.02);
    // A diagonal of 43.27 mm at 50.36 mm in focus at 2 m.
    EXPECT_NEAR(json.at("fov_degrees").at("diagonal").get<double>(), 45.0, 1.5);
    EXPECT_LT(measure({"--lens", "double-gauss", "--film", "20"}).at("fov_degrees").at("diagonal").get<double>(), 25.0);
    EXPECT_GT(measure({"--lens", "fisheye"}).at("fov_degrees").at("diagonal").get<double>(), 120.0);

    Program program;
    const auto file = program.write("simple.txt", "0 1 1 10 # the stop\n100 2 1.5 30\n-100 95 1 30\n");
    const Outcome table = program.run({"camera", "--lens", file.string()});
    EXPECT_EQ(table.code, 0) << table.err;
    EXPECT_NE(table.out.find("focal length   100.3"), std::string::npos) << table.out; // the lensmaker's, 2 mm thick
}

TEST(CameraCommand, MeasuresEveryModel)
{
    for (const char* name : {"rectilinear", "orthographic", "equirectangular", "equidistant", "equisolid",
                             "stereographic", "fisheye-orthographic", "kannala-brandt", "brown-conrady", "hmd"}) {
        const nlohmann::json json = measure({"--camera-model", name});
        EXPECT_LT(json.at("round_trip").at("worst_pixels").get<double>(), 2e-3) << name;
        EXPECT_EQ(json.at("round_trip").at("lost"), 0) << name;
    }
    EXPECT_NEAR(measure({"--camera-model", "equidistant", "--fov", "150"}).at("fov_degrees").at("vertical"), 150, 0.01);
    Program program;
    const auto file =
        program.write("c.yml", "image_width: 640\nimage_height: 480\ncamera_matrix:\n  data: [500, 0, 319.5, "
                               "0, 500, 239.5, 0, 0, 1]\nD:\n  data: [0, 0, 0, 0]\n");
    const nlohmann::json json = measure({"--calibration", file.string(), "--size", "640x480"});
    EXPECT_EQ(json.at("model"), "brown-conrady");
    EXPECT_NEAR(json.at("fov_degrees").at("horizontal").get<double>(), 2 * std::atan(320.0 / 500) * 180 / 3.14159265,
                0.01);
}

std::string bytes_of(const std::filesystem::path& file)
{
    std::ifstream in(file, std::ios::binary);
    return {std::istreambuf_iterator<char>(in), {}};
}

// Width and height as a PNG's header has them.
std::pair<int, int> png_size(const std::string& bytes)
{
    const auto number = [&](std::size_t at) {
        int n = 0;
        for (std::size_t i = at; i < at + 4; ++i) n = n * 256 + static_cast<unsigned char>(bytes.at(i));
        return n;
    };
    return {number(16), number(20)};
}

TEST(StereoRender, SideBySideAndAsViews)
{
    Program program;
    const auto pair = program.folder() / "pair.png", views = program.folder() / "pair.exr";
    const Outcome outcome = program.run({"render", "grid", "--stereo", "--ipd", "0.2", "--spp", "2", "--size", "40x30",
                                         "-o", pair.string(), "-o", views.string()});
    EXPECT_EQ(outcome.code, 0) << outcome.err;
    EXPECT_EQ(png_size(bytes_of(pair)), std::pair(80, 30));
    const std::string exr = bytes_of(views);
    for (const char* word : {"multiView", "right.R", "right.A", "right.Z", "Albedo.left.R", "Albedo.right.R"})
        EXPECT_NE(exr.find(word), std::string::npos) << word;
    EXPECT_EQ(exr.find("worldToNDC"), std::string::npos); // of one eye

    // The root channels are the left eye's: the picture of a camera that stands half the distance to the left.
    const auto left = program.folder() / "left.exr";
    const Outcome alone = program.run({"compare", views.string(), views.string()});
    EXPECT_EQ(alone.code, 0) << alone.err;
    EXPECT_EQ(program.run({"render", "grid", "--spp", "2", "--size", "40x30", "-o", left.string()}).code, 0);
    EXPECT_NE(bytes_of(left).find("worldToNDC"), std::string::npos);
    EXPECT_EQ(program.run({"compare", views.string(), left.string(), "--metric", "mse", "--threshold", "0"}).code, 1);
}

TEST(CameraRender, EveryModelMakesAPicture)
{
    Program program;
    for (const char* name : {"orthographic", "equirectangular", "equidistant", "equisolid", "stereographic",
                             "fisheye-orthographic", "kannala-brandt", "brown-conrady", "hmd", "lens"}) {
        const auto file = program.folder() / (std::string(name) + ".exr");
        const Outcome outcome = program.run(
            {"render", "grid", "--camera-model", name, "--spp", "1", "--size", "24x16", "-o", file.string(), "-q"});
        EXPECT_EQ(outcome.code, 0) << name << outcome.err;
        EXPECT_EQ(outcome.err, "") << name;
        EXPECT_EQ(bytes_of(file).find("worldToNDC"), std::string::npos) << name;
        EXPECT_NE(bytes_of(file).find("worldToCamera"), std::string::npos) << name;
    }
}

TEST(CameraCommand, NonsenseIsOneLine)
{
    const std::tuple<std::vector<std::string>, int, const char*> cases[] = {
        {{"camera", "--points", "1"}, 2, "--points"},
        {{"camera", "--size", "0x5"}, 2, "--size"},
        {{"camera", "no-such-scene"}, 1, "no-such-scene"},
        {{"camera", "--lens", "no-such-lens"}, 2, "double-gauss, fisheye"},
        {{"camera", "--lens", "double-gauss", "--focus-distance", "0.005"}, 2, "focus farther away"},
        {{"camera", "--lens", "double-gauss", "--film", "-3"}, 2, "--film"},
        {{"camera", "--lens", "double-gauss", "--stop", "0"}, 2, "--stop"},
        {{"camera", "--lens", "double-gauss", "--lens-unit", "mm"}, 2, "--lens-unit"},
        {{"camera", "--lens", "double-gauss", "--fov", "40"}, 2, "--fov"},
        {{"camera", "--lens", "double-gauss", "--camera-model", "hmd"}, 2, "--lens"},
        {{"camera", "--film", "30"}, 2, "--film"},
        {{"camera", "--stop", "3"}, 2, "--stop"},
        {{"camera", "--lens-unit", "1"}, 2, "--lens-unit"},
        {{"camera", "--camera-model", "equidistand"}, 2, "equidistant"},
        {{"camera", "--camera-model", "pinhole", "--fov", "180"}, 2, "field of view"},
        {{"camera", "--camera-model", "equidistant", "--lens-radius", "0.1"}, 2, "only pinhole"},
        {{"camera", "--lens-radius", "-1"}, 2, "--lens-radius"},
        {{"camera", "--focus-distance", "0"}, 2, "--focus-distance"},
        {{"camera", "--blades", "2.5"}, 2, "--blades"},
        {{"camera", "--blade-rotation", "x"}, 2, "--blade-rotation"},
        {{"camera", "--view-size", "2"}, 2, "orthographic"},
        {{"camera", "--camera-model", "orthographic", "--view-size", "0"}, 2, "--view-size"},
        {{"camera", "--ipd", "0.06"}, 2, "hmd"},
        {{"camera", "--camera-model", "hmd", "--ipd", "-0.06"}, 2, "--ipd"},
        {{"camera", "--camera-model", "hmd", "--distortion", "1,2"}, 2, "--distortion"},
        {{"camera", "--camera-model", "brown-conrady", "--distortion", "-3,0,0,0"}, 2, "folds"},
        {{"camera", "--distortion", "1,x"}, 2, "--distortion"},
        {{"camera", "--calibration", "no-such.yml"}, 1, "no-such.yml"},
        {{"camera", "--calibration", "broken.yml"}, 1, "broken.yml:3:"},
        {{"camera", "--camera-model", "hmd", "--calibration", "broken.yml"}, 2, "--calibration"},
        {{"camera", "--lens", "broken.txt"}, 1, "broken.txt:2:"},
        {{"render", "--stereo", "--camera-model", "hmd", "cornell"}, 2, "--stereo"},
    };
    for (const auto& [arguments, code, words] : cases) {
        Program program;
        program.write("broken.txt", "100 2 1.5 30\n-100 95 glass 30\n");
        std::vector<std::string> there = arguments;
        program.write("broken.yml", "image_width: 640\nimage_height: 480\ncamera_matrix:\n  data: [1, 2, 3]\n");
        if (there.back().starts_with("broken.")) there.back() = (program.folder() / there.back()).string();
        const Outcome outcome = program.run(there);
        SCOPED_TRACE(outcome.err);
        EXPECT_EQ(outcome.code, code);
        EXPECT_EQ(line_count(outcome.err), 1u);
        EXPECT_EQ(outcome.out, "");
        EXPECT_NE(outcome.err.find(words), std::string::npos) << words;
    }
}

} // namespace
} // namespace snell::test
