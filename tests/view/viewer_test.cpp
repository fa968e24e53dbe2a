// The viewer as a user has it: a window on a display, keys, mouse and files.
#include "viewer.h"

#include "snell/core/timer.h"
#include "snell/io/file.h"

#include <regex>

#include <unistd.h>

namespace snell::test {

TEST_F(Viewer, OpensWalksResizesAndCloses)
{
    const Outcome outcome = script("assert phase empty\n"
                                   "open cornell\n"
                                   "wait picture\n"
                                   "assert scene cornell\n"
                                   "assert eye.z == 4\n"
                                   "hold w 300\n"
                                   "wait picture\n"
                                   "assert eye.z < 3.99\n"
                                   "assert latency.count > 0\n"
                                   "assert latency < 5000\n"
                                   "key Ctrl+1\n"
                                   "drag 200 200 300 230\n"
                                   "assert target != 0,1,0\n"
                                   "key 1\n"
                                   "assert eye.x == 0\n"
                                   "key ]\nkey ]\n"
                                   "assert exposure == 1\n"
                                   "size 900 500\n"
                                   "wait picture\n"
                                   "assert width < 900\n"
                                   "key g\n"
                                   "wait 400\n"
                                   "assert hidden on\n"
                                   "assert width == 900\n"
                                   "assert height == 500\n"
                                   "quit\n");
    EXPECT_EQ(outcome.code, 0) << outcome.err;
}

TEST_F(Viewer, ShowsThePictureThatRenderMakes)
{
    const Outcome outcome = script("key g\n"
                                   "open spheres\n"
                                   "wait scene\n"
                                   "wait rest\n"
                                   "assert spp == 16\n"
                                   "screenshot view.exr\n"
                                   "screenshot --window window.png\n"
                                   "quit\n",
                                   {"--size", "200x150", "--spp", "16"});
    ASSERT_EQ(outcome.code, 0) << outcome.err;
    // A window may be made no smaller than 320 x 240.
    const Picture shot = picture("view.exr");
    const Outcome rendered = program_.run({"render", "spheres", "--spp", "16", "--size",
                                           std::to_string(shot.width) + "x" + std::to_string(shot.height), "-o",
                                           "render.exr", "-o", "render.png", "-q"});
    ASSERT_EQ(rendered.code, 0) << rendered.err;
    const vec3 a = mean("view.exr"), b = mean("render.exr");
    const vec3 c = mean("window.png"), d = mean("render.png");
    for (int channel = 0; channel < 3; ++channel) {
        EXPECT_NEAR(a[channel] / b[channel], 1.0f, 1e-3f);
        EXPECT_NEAR(c[channel] / d[channel], 1.0f, 0.01f); // what the screen shows
    }
    EXPECT_GT(a.x, 0.01f);
}

TEST_F(Viewer, ControlsWorkAndDoNotDisturbThePicture)
{
    const Outcome outcome = script("open cornell\n"
                                   "wait picture\n"
                                   "assert spp >= 0\n"
                                   "press Governor\n"
                                   "assert governor off\n"
                                   "assert eye.z == 4\n" // the click was not the picture's
                                   "press Panels\n"
                                   "press Messages\n"
                                   "panel Help open\n"
                                   "screenshot --window dark.png\n"
                                   "set light on\n"
                                   "wait frame\n"
                                   "screenshot --window light.png\n"
                                   "set integrator normals\n"
                                   "wait rest\n"
                                   "set integrator nonsense\n",
                                   {"--spp", "4"});
    EXPECT_EQ(outcome.code, 2);
    EXPECT_NE(outcome.err.find("script.txt:16: there is no integrator 'nonsense'"), std::string::npos) << outcome.err;
    EXPECT_GT(mean("light.png").x, mean("dark.png").x);
}

TEST_F(Viewer, LooksThroughEveryCameraModel)
{
    std::string text =
        "open grid\nwait picture\npanel \"Camera laboratory\" open\npanel Trees open\nset trees.level 2\n";
    for (const char* model : {"orthographic", "equirectangular", "equidistant", "equisolid", "stereographic",
                              "fisheye-orthographic", "kannala-brandt", "brown-conrady", "hmd", "lens", "rectilinear"})
        text += std::string("set camera_model ") + model + "\nwait picture\nwait frame\nassert round_trip < 0.05\n";
    text += "assert camera_model pinhole\n"
            "set focus_by_click on\n"
            "click 300 300\n"
            "wait 1000\n"
            "assert focus_distance > 0.5\n"
            "set camera_model lens\n"
            "set camera \"--focus-distance 0.001\"\n";
    const Outcome outcome = script(text);
    EXPECT_EQ(outcome.code, 2);
    EXPECT_NE(outcome.err.find("focus farther away"), std::string::npos) << outcome.err;
}

TEST_F(Viewer, OpensWhatIsDropped)
{
    program_.write("box.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
    program_.write("broken.glb", "this is none");
    const Outcome outcome = script("open cornell\n"
                                   "wait picture\n"
                                   "drop box.obj\n"
                                   "wait scene\n"
                                   "wait picture\n"
                                   "assert scene box.obj\n"
                                   "drop broken.glb\n"
                                   "wait 1500\n"
                                   "assert phase failed\n"
                                   "assert scene box.obj\n" // what was shown stays
                                   "screenshot --window failed.png\n"
                                   "press Dismiss\n"
                                   "open cornell\n"
                                   "wait scene\n"
                                   "wait picture\n"
                                   "quit\n");
    EXPECT_EQ(outcome.code, 0) << outcome.err;
}

TEST_F(Viewer, RecordsAPath)
{
    program_.write("path.txt", "# two views\n--eye 0,1,4 --target 0,1,0\n--eye 1,1,3\n");
    const Outcome outcome = program_.run({"view", "cornell", "--size", "320x240", "--spp", "1", "--record",
                                          "walk.%02d.png", "--path", "path.txt", "--record-frames", "3"});
    EXPECT_EQ(outcome.code, 0) << outcome.err;
    for (const char* name : {"walk.00.png", "walk.01.png", "walk.02.png"}) EXPECT_GT(mean(name).x, 0.01f) << name;
    EXPECT_NE(mean("walk.00.png"), mean("walk.02.png"));
}

TEST_F(Viewer, SaysWhereAScriptFails)
{
    const Outcome failed = script("open cornell\nwait picture\nassert exposure == 3\n");
    EXPECT_EQ(failed.code, 1);
    EXPECT_NE(failed.err.find("script.txt:3: exposure == 3 does not hold: it is 0"), std::string::npos) << failed.err;
    const Outcome wrong = script("open cornell\nsing\n");
    EXPECT_EQ(wrong.code, 2);
    EXPECT_NE(wrong.err.find("script.txt:2: there is no command 'sing'"), std::string::npos) << wrong.err;
}

TEST_F(Viewer, NeedsADisplay)
{
    const std::string display = getenv("DISPLAY");
    unsetenv("DISPLAY");
    const Outcome outcome = program_.run({"view", "cornell"});
    setenv("DISPLAY", display.c_str(), 1);
    EXPECT_EQ(outcome.code, 1);
    EXPECT_EQ(line_count(outcome.err), 1u) << outcome.err;
    EXPECT_NE(outcome.err.find("snell render"), std::string::npos) << outcome.err;
}

TEST_F(Viewer, ClosesAtOnceWhileALargeSceneIsBeingOpened)
{
    program_.write("script.txt", "open field:2000000\nwait 1500\nsay closing\nquit\n");
    program_.start({"view", "--script", "script.txt"});
    ASSERT_TRUE(program_.wait_for("closing"));
    const Timer timer;
    const Outcome outcome = program_.wait();
    EXPECT_EQ(outcome.code, 0) << outcome.err;
#ifdef __SANITIZE_ADDRESS__
    constexpr double most = 15.0; // the search for leaks comes before the end
#else
    constexpr double most = 3.0; // one second, on a machine that has nothing else to do
#endif
    EXPECT_LT(timer.seconds(), most);
}

// The real path of input: an X server's events.
TEST_F(Viewer, TakesRealKeysAndMouse)
{
    ASSERT_EQ(shell("command -v xdotool > /dev/null"), 0) << "install xdotool";
    program_.start({"view", "cornell", "--size", "640x480", "--scale", "1"});
    const std::string window = "timeout 60 xdotool search --sync --name 'snell: cornell' ";
    ASSERT_EQ(shell(window + "windowfocus > /dev/null"), 0); // the title says that the scene is there
    ASSERT_EQ(shell("sleep 1; xdotool keydown w sleep 0.5 keyup w sleep 0.5 key c sleep 0.5"), 0);
    ASSERT_EQ(shell(window +
                    "mousemove --window %1 100 200 mousedown 1 sleep 0.3 mousemove --window %1 180 220 sleep 0.3 "
                    "mouseup 1 sleep 0.5 key c sleep 0.5 > /dev/null"),
              0);
    ASSERT_EQ(shell("xdotool key Escape sleep 1 key Return"), 0);
    const Outcome outcome = program_.wait();
    EXPECT_EQ(outcome.code, 0) << outcome.err;
    static const std::regex camera("--eye 0,1,([0-9.]+) --target ([-0-9.e]+),");
    std::vector<std::pair<double, double>> seen;
    for (std::sregex_iterator i(outcome.out.begin(), outcome.out.end(), camera), end; i != end; ++i)
        seen.emplace_back(std::stod((*i)[1]), std::stod((*i)[2]));
    ASSERT_EQ(seen.size(), 2u) << outcome.out;
    EXPECT_LT(seen[0].first, 3.99); // it has walked
    EXPECT_EQ(seen[0].second, 0.0);
    EXPECT_LT(seen[1].second, -0.01); // and looked to the left: the picture follows the hand
    EXPECT_NE(read_file(program_.folder() / "config/snell/recent").find("cornell"), std::string::npos);
}

TEST_F(Viewer, SurvivesRandomInput)
{
    const char* seconds = getenv("SNELL_LONG") != nullptr ? "3600" : "15";
    const Outcome outcome = script(std::string("open cornell\nwait picture\nrandom ") + seconds +
                                   " 7\nopen whitted\nwait scene\nrandom 5 8\nassert memory < 3000\nquit\n");
    EXPECT_EQ(outcome.code, 0) << outcome.err;
}

} // namespace snell::test
