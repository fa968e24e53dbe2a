// Options that say how a scene is opened: variants, the sandbox, moments and sequences, environments, its own wishes.
#include "program.h"
#include "scene_files.h"

#include "snell/io/image/read.h"
#include "snell/io/image/write.h"

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <chrono>
#include <csignal>
#include <thread>

namespace snell::test {
namespace {

#define EXPECT_SAYS(text, part) EXPECT_NE(std::string(text).find(part), std::string::npos) << (text)

class SceneOptions : public ::testing::Test
{
  protected:
    SceneOptions()
    {
        program.write("lamp.gltf", moving_lamp());
        program.write("still.gltf", still_lamp());
    }

    // Renders to a small float picture.
    Picture picture(std::vector<std::string> arguments)
    {
        arguments.insert(arguments.begin(), "render");
        for (const char* word : {"--size", "24x16", "--spp", "2", "-o", "picture.pfm"}) arguments.emplace_back(word);
        const Outcome outcome = program.run(arguments);
        EXPECT_EQ(outcome.code, 0) << outcome.err;
        said = outcome.err;
        return outcome.code == 0 ? read_picture(program.folder() / "picture.pfm") : Picture{};
    }

    // One line, and no picture.
    void expect_error(std::vector<std::string> arguments, int code, const std::vector<std::string>& words)
    {
        arguments.insert(arguments.begin(), "render");
        const std::vector<std::string> before = program.files();
        const Outcome outcome = program.run(arguments);
        EXPECT_EQ(outcome.code, code) << outcome.err;
        EXPECT_EQ(line_count(outcome.err), 1u) << outcome.err;
        for (const std::string& word : words) EXPECT_SAYS(outcome.err, word);
        EXPECT_EQ(program.files(), before);
    }

    Program program;
    std::string said;
};

vec3 sum(const Picture& picture)
{
    vec3 total(0.0f);
    for (const vec3& pixel : picture.pixels) total += pixel;
    return total;
}

// Mean column of what is bright.
float column(const Picture& picture)
{
    float weighted = 0, all = 0;
    for (int y = 0; y < picture.height; ++y)
        for (int x = 0; x < picture.width; ++x) {
            weighted += picture.at(x, y).x * (static_cast<float>(x) + 0.5f);
            all += picture.at(x, y).x;
        }
    return weighted / all;
}

// ---- moments and sequences ----

TEST_F(SceneOptions, TimeMovesTheScene)
{
    const float start = column(picture({"lamp.gltf", "--time", "0"}));
    EXPECT_LT(start, 9.0f);
    EXPECT_NEAR(column(picture({"lamp.gltf"})), start, 1e-4f) << "at rest it is where the animation begins";
    EXPECT_NEAR(column(picture({"lamp.gltf", "--time", "1"})), 12.0f, 0.3f);
    EXPECT_NEAR(column(picture({"lamp.gltf", "--time=2"})), 24.0f - start, 0.3f);
    EXPECT_NEAR(column(picture({"lamp.gltf", "--time", "50", "-v"})), 24.0f - start, 0.3f);
    EXPECT_SAYS(said, "the animation ends at 2 s");
    EXPECT_NEAR(column(picture({"lamp.gltf", "--animation", "back"})), 24.0f - start, 0.3f);
    EXPECT_NEAR(column(picture({"lamp.gltf", "--animation", "1", "--time", "2"})), start, 0.3f);
}

TEST_F(SceneOptions, AnimationsThatAreNotThere)
{
    for (const std::vector<std::string>& moment :
         {std::vector<std::string>{"--time", "1"}, {"--frames", "0:2"}, {"--animation", "run"}}) {
        std::vector<std::string> arguments = {"still.gltf"};
        arguments.insert(arguments.end(), moment.begin(), moment.end());
        expect_error(arguments, 2, {moment[0], "'still.gltf'", "no animation"});
    }
    expect_error({"lamp.gltf", "--animation", "bakc"}, 2, {"did you mean 'back'", "there"});
    expect_error({"lamp.gltf", "--animation", "3"}, 2, {"--animation", "from 0 to 2"});
    expect_error({"lamp.gltf", "--time", "-1"}, 2, {"--time"});
    expect_error({"lamp.gltf", "--time", "soon"}, 2, {"--time"});
    expect_error({"lamp.gltf", "--time", "1", "--frames", "0:2"}, 2, {"--time", "--frames", "exclude each other"});
    expect_error({"lamp.gltf", "--fps", "25"}, 2, {"--fps", "--frames"});
    expect_error({"lamp.gltf", "--frames", "0:2", "--fps", "0"}, 2, {"--fps"});
    for (const char* frames : {"2:2", "3", "-1:4", "a:b", "0:1:2"})
        expect_error({"lamp.gltf", "--frames", frames}, 2, {"--frames", "0:24"});
}

TEST_F(SceneOptions, ASequenceIsWhatItsMomentsAre)
{
    const Outcome outcome = program.run({"render", "lamp.gltf", "--frames", "1:4", "--fps", "2", "--size", "24x16",
                                         "--spp", "2", "-o", "out.%02d.pfm", "-o", "50%%_%d.png", "--stats=json"});
    ASSERT_EQ(outcome.code, 0) << outcome.err;
    EXPECT_EQ(program.files(), (std::vector<std::string>{"50%_1.png", "50%_2.png", "50%_3.png", "lamp.gltf",
                                                         "out.01.pfm", "out.02.pfm", "out.03.pfm", "still.gltf"}));
    EXPECT_SAYS(outcome.err, "frame 1 of 3: wrote out.01.pfm, 50%_1.png");
    EXPECT_SAYS(outcome.err, "frame 3 of 3: wrote out.03.pfm");
    EXPECT_SAYS(outcome.err, "3 of 3 frames in");
    EXPECT_EQ(outcome.err.find("nothing moves at the end"), std::string::npos) << outcome.err;
    for (const auto& [frame, time] : {std::pair{"1", "0.5"}, {"2", "1"}, {"3", "1.5"}})
        EXPECT_EQ(read_picture(program.folder() / (std::string("out.0") + frame + ".pfm")).pixels,
                  picture({"lamp.gltf", "--time", time}).pixels)
            << "frame " << frame;

    ASSERT_EQ(line_count(outcome.out), 3u);
    const auto last = nlohmann::json::parse(outcome.out.substr(outcome.out.rfind('{', outcome.out.rfind("\"scene\""))));
    EXPECT_EQ(last.at("frame"), 3);
    EXPECT_EQ(last.at("time"), 1.5);
    EXPECT_EQ(last.at("outputs").at(0), "out.03.pfm");
}

TEST_F(SceneOptions, NumbersOfASequenceAreFoundAPlace)
{
    const std::vector<std::string> frames = {"render", "lamp.gltf", "--frames", "7:8", "--size", "4x4", "--spp", "1"};
    const auto run = [&](std::vector<std::string> more) {
        more.insert(more.begin(), frames.begin(), frames.end());
        return program.run(more);
    };
    EXPECT_SAYS(run({"-o", "name.pfm"}).err, "numbers go before the ending: name.0007.pfm");
    EXPECT_SAYS(run({}).err, "lamp.0007.png");
    const Outcome outcome = run({"-o", "a.b%05d.pfm"});
    EXPECT_EQ(outcome.err.find("numbers go"), std::string::npos) << outcome.err;
    for (const char* file : {"name.0007.pfm", "lamp.0007.png", "a.b00007.pfm"})
        EXPECT_TRUE(std::filesystem::exists(program.folder() / file)) << file;

    for (const char* pattern :
         {"out%s.pfm", "out%4d.pfm", "out%-4d.pfm", "out%.pfm", "out%04d%", "out%099d.pfm", "out%n.pfm", "%04x.pfm"})
        expect_error({"lamp.gltf", "--frames", "0:2", "-o", pattern}, 2, {"has a % that is no number", "%04d", "%%"});
    expect_error({"lamp.gltf", "--frames", "0:2", "-o", "%d_%d.pfm"}, 2, {"'%d_%d.pfm' has two numbers"});
    expect_error({"lamp.gltf", "--frames", "0:2", "-o", "none/%d.pfm"}, 1, {"none"});
    expect_error({"lamp.gltf", "--frames", "0:2", "-o", "out.%d"}, 1, {"out"});
    // Of a still, a percent sign is a character like any other.
    EXPECT_EQ(program.run({"render", "lamp.gltf", "--size", "4x4", "--spp", "1", "-o", "%s%d.pfm"}).code, 0);
    EXPECT_TRUE(std::filesystem::exists(program.folder() / "%s%d.pfm"));
}

TEST_F(SceneOptions, FramesBeyondTheAnimation)
{
    const Outcome outcome = program.run(
        {"render", "lamp.gltf", "--frames", "1:4", "--fps", "1", "--size", "8x8", "--spp", "1", "-o", "f%d.pfm"});
    ASSERT_EQ(outcome.code, 0) << outcome.err;
    EXPECT_SAYS(outcome.err, "the animation lasts 2 s, the frames go on to 3 s");
    EXPECT_EQ(read_picture(program.folder() / "f2.pfm").pixels, read_picture(program.folder() / "f3.pfm").pixels);
    EXPECT_NE(read_picture(program.folder() / "f1.pfm").pixels, read_picture(program.folder() / "f2.pfm").pixels);
}

TEST_F(SceneOptions, AnInterruptedSequenceKeepsWhatThereIs)
{
    program.start({"render", "lamp.gltf", "--frames", "0:1000", "--size", "64x64", "--spp", "512", "-o", "f%d.pfm"});
    ASSERT_TRUE(program.wait_for("frame 2 of 1000: wrote"));
    std::this_thread::sleep_for(std::chrono::milliseconds(30));
    program.send(SIGINT);
    const Outcome outcome = program.wait();
    EXPECT_EQ(outcome.code, 130) << outcome.err;
    EXPECT_SAYS(outcome.err, "interrupted: ");
    EXPECT_SAYS(outcome.err, "of 1000 frames in");
    for (const char* file : {"f0.pfm", "f1.pfm"}) EXPECT_EQ(read_picture(program.folder() / file).width, 64) << file;
    EXPECT_FALSE(std::filesystem::exists(program.folder() / "f999.pfm"));
}

TEST_F(SceneOptions, TheTimeoutIsForAllFrames)
{
    const Outcome outcome = program.run({"render", "lamp.gltf", "--frames", "0:1000", "--size", "64x64", "--spp", "512",
                                         "--timeout", "0.5", "-o", "f%d.pfm"});
    EXPECT_EQ(outcome.code, 0) << outcome.err;
    EXPECT_SAYS(outcome.err, "out of time: ");
    EXPECT_TRUE(std::filesystem::exists(program.folder() / "f0.pfm"));
    EXPECT_FALSE(std::filesystem::exists(program.folder() / "f999.pfm"));
}

TEST_F(SceneOptions, CamerasMoveUnlessTheCommandLinePlacesThem)
{
    const auto columns = [&](const std::vector<std::string>& camera) {
        std::vector<std::string> words = {"render", "lamp.gltf", "--animation", "tracking", "--frames",
                                          "0:3",    "--fps",     "1",           "--size",   "24x16",
                                          "--spp",  "4",         "-o",          "f%d.pfm"};
        words.insert(words.end(), camera.begin(), camera.end());
        const Outcome outcome = program.run(words);
        EXPECT_EQ(outcome.code, 0) << outcome.err;
        std::vector<float> all;
        for (const char* file : {"f0.pfm", "f1.pfm", "f2.pfm"})
            all.push_back(column(read_picture(program.folder() / file)));
        return all;
    };
    for (const float c : columns({"--camera", "front", "--fov", "40"})) EXPECT_NEAR(c, 12.0f, 0.3f);
    const std::vector<float> fixed = columns({"--eye", "0,0,4", "--target", "0,0,0"});
    EXPECT_LT(fixed[0], 10.0f);
    EXPECT_NEAR(fixed[1], 12.0f, 0.3f);
    EXPECT_GT(fixed[2], 14.0f);
}

TEST_F(SceneOptions, AllAnimationsAtOnce)
{
    // There and back move the lamp, tracking the lamp and the camera: of channels for one thing the last counts.
    const float tracking = column(picture({"lamp.gltf", "--time", "0", "--animation", "tracking"}));
    EXPECT_LT(tracking + 2.0f, column(picture({"lamp.gltf", "--time", "0", "--animation", "back"})));
    EXPECT_EQ(column(picture({"lamp.gltf", "--time", "0", "--animation", "all"})), tracking);
}

// ---- loading ----

TEST_F(SceneOptions, Variants)
{
    program.write("coloured.gltf", coloured_lamp());
    const vec3 own = sum(picture({"coloured.gltf"}));
    EXPECT_GT(own.x, 1.0f);
    EXPECT_EQ(own.y, 0.0f);
    const vec3 green = sum(picture({"coloured.gltf", "--variant", "green"}));
    EXPECT_EQ(green.x, 0.0f);
    EXPECT_EQ(green.y, own.x);
    expect_error({"coloured.gltf", "--variant", "blue"}, 1, {"'blue'", "red, green"});
    expect_error({"cornell", "--variant", "blue"}, 2, {"no variant 'blue'"});
}

TEST_F(SceneOptions, TheSandboxEndsAtTheScenesFolder)
{
    std::filesystem::create_directory(program.folder() / "scene");
    program.write("outside.bin", moving_lamp_data());
    program.write("scene/inside.bin", moving_lamp_data());
    program.write("scene/out.gltf", moving_lamp("../outside.bin"));
    program.write("scene/in.gltf", moving_lamp("inside.bin"));
    const vec3 seen = sum(picture({"scene/out.gltf"}));
    EXPECT_SAYS(said, "leads out of the scene's folder");
    EXPECT_EQ(sum(picture({"scene/in.gltf", "--sandbox"})), seen);
    EXPECT_EQ(said.find("folder"), std::string::npos) << said;
    expect_error({"scene/out.gltf", "--sandbox"}, 1, {"out.gltf", "../outside.bin", "--sandbox"});
}

// ---- light from afar ----

// A map whose left half is red and whose right half is green.
void write_map(const std::filesystem::path& file)
{
    Picture map;
    map.width = 16;
    map.height = 8;
    for (int i = 0; i < 16 * 8; ++i) map.pixels.push_back(i % 16 < 8 ? vec3(3, 0, 0) : vec3(0, 2, 0));
    write_picture(file, map);
}

TEST_F(SceneOptions, Environments)
{
    write_map(program.folder() / "map.exr");
    // The mean of what is seen far from the lamp, looking to the middle of the map.
    const auto seen = [&](const std::vector<std::string>& more) {
        std::vector<std::string> words = {"still.gltf", "--eye", "0,0,-50",       "--target", "0,0,-90",
                                          "--fov",      "10",    "--environment", "map.exr"};
        words.insert(words.end(), more.begin(), more.end());
        return sum(picture(words)) / (24.0f * 16.0f);
    };
    const auto expect_near = [](vec3 a, vec3 b) {
        for (int i = 0; i < 3; ++i) EXPECT_NEAR(a[i], b[i], 1e-3f) << "component " << i;
    };
    const vec3 both = seen({});
    EXPECT_NEAR(both.x, 1.5f, 0.2f);
    EXPECT_NEAR(both.y, 1.0f, 0.2f);
    expect_near(seen({"--environment-rotation", "60"}), {3, 0, 0}); // the left half goes to the right
    expect_near(seen({"--environment-rotation", "-60"}), {0, 2, 0});
    expect_near(seen({"--environment-rotation=60", "--environment-scale", "2.5"}), {7.5f, 0, 0});
    EXPECT_EQ(seen({"--environment-rotation", "60", "--hide-environment"}), vec3(0.0f));
}

TEST_F(SceneOptions, TheScenesOwnEnvironment)
{
    program.write("sky.pbrt", R"(LookAt 0 0 5  0 0 9  0 1 0
Camera "perspective" "float fov" 40
WorldBegin
LightSource "infinite" "rgb L" [0.5 1 2]
Shape "sphere"
)");
    const vec3 plain = sum(picture({"sky.pbrt"})), bright = sum(picture({"sky.pbrt", "--environment-scale", "3"}));
    EXPECT_GT(plain.z, 1.0f);
    for (int i = 0; i < 3; ++i) EXPECT_NEAR(bright[i], 3.0f * plain[i], 1e-4f * bright[i]);
    EXPECT_EQ(sum(picture({"sky.pbrt", "--environment-rotation", "77"})), plain); // the same all around
    EXPECT_EQ(sum(picture({"sky.pbrt", "--hide-environment"})), vec3(0.0f));
}

TEST_F(SceneOptions, EnvironmentsThatAreNoGood)
{
    expect_error({"still.gltf", "--environment", "missing.exr"}, 1, {"missing.exr"});
    expect_error({"still.gltf", "--environment", "lamp.gltf"}, 1, {"lamp.gltf"});
    expect_error({"cornell", "--environment-rotation", "90"}, 2, {"--environment-rotation", "no environment"});
    expect_error({"cornell", "--environment-scale", "2"}, 2, {"--environment-scale", "--environment FILE"});
    expect_error({"cornell", "--environment-scale", "-2"}, 2, {"--environment-scale"});
    expect_error({"cornell", "--environment-rotation", "left"}, 2, {"--environment-rotation"});
}

// ---- the scene's wishes ----

TEST_F(SceneOptions, WishesOfTheSceneUnlessTheCommandLineSaysOtherwise)
{
    program.write("wish.pbrt", R"(Film "rgb" "integer xresolution" 20 "integer yresolution" 10
"string filename" "../elsewhere/wish.pfm"
Sampler "independent" "integer pixelsamples" 3
Integrator "path" "integer maxdepth" 4
LookAt 0 0 5  0 0 0  0 1 0
Camera "perspective" "float fov" 40
WorldBegin
LightSource "infinite" "rgb L" [1 1 1]
Shape "sphere"
)");
    const Outcome outcome = program.run({"render", "wish.pbrt", "-v", "--stats=json"});
    ASSERT_EQ(outcome.code, 0) << outcome.err;
    for (const char* words : {"taken over from the scene", "20x10 pixels", "3 samples a pixel", "sampler independent",
                              "max_depth 4", "output wish.pfm", "wrote wish.pfm (20x10, 3 samples"})
        EXPECT_SAYS(outcome.err, words);
    EXPECT_EQ(nlohmann::json::parse(outcome.out).at("spp"), 3.0);
    EXPECT_EQ(read_picture(program.folder() / "wish.pfm").width, 20);

    const Outcome other = program.run(
        {"render", "wish.pbrt", "-v", "--width", "10", "--spp", "2", "--sampler", "sobol", "-o", "other.pfm"});
    ASSERT_EQ(other.code, 0) << other.err;
    EXPECT_SAYS(other.err, "wrote other.pfm (10x5, 2 samples"); // the form stays
    for (const char* words : {"samples a pixel,", "sampler", "output"}) {
        const std::string line = other.err.substr(other.err.find("taken over"));
        EXPECT_EQ(line.substr(0, line.find('\n')).find(words), std::string::npos) << line;
    }
}

} // namespace
} // namespace snell::test
