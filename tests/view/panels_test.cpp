// What the viewer's panels do: editing, comparing, looking inside, measuring, time.
#include "viewer.h"

#include "snell/io/file.h"
#include "tests/io/gltf_files.h"

#include <sstream>

namespace snell::test {

// The left wall's colour, by hand; what follows from it is seen in the picture and in the saved file.
TEST_F(Viewer, EditsAMaterialUndoesAndSaves)
{
    const Outcome outcome = script("open cornell\n"
                                   "wait rest\n"
                                   "panel Help close\npanel View close\npanel Rendering close\n"
                                   "panel Scene open\n"
                                   "panel Inspector open\n"
                                   "screenshot before.exr\n"
                                   "set select \"material left wall\"\n"
                                   "wait frame\n"
                                   "assert selection \"material 'left wall'\"\n"
                                   "assert dirty 0\n"
                                   "enter Reflectance.x 0.01\n"
                                   "wait rest\n"
                                   "assert base_red == 0.01\n"
                                   "assert dirty 1\n"
                                   "screenshot after.exr\n"
                                   "set save edited.pbrt\n"
                                   "wait saving == 0\n"
                                   "assert dirty 0\n"
                                   "key Ctrl+z\n"
                                   "wait rest\n"
                                   "assert base_red > 0.1\n"
                                   "screenshot undone.exr\n"
                                   "key Ctrl+y\n"
                                   "wait rest\n"
                                   "assert base_red == 0.01\n"
                                   "quit\n",
                                   {"--spp", "8", "--size", "700x500"});
    ASSERT_EQ(outcome.code, 0) << outcome.err;
    // The wall is at the left.
    EXPECT_LT(mean("after.exr", 0.05f, 0.3f, 0.2f, 0.7f).x, 0.3f * mean("before.exr", 0.05f, 0.3f, 0.2f, 0.7f).x);
    EXPECT_EQ(picture("undone.exr").pixels, picture("before.exr").pixels);
    const Outcome again =
        program_.run({"render", "edited.pbrt", "--spp", "8", "--size",
                      std::to_string(picture("after.exr").width) + "x" + std::to_string(picture("after.exr").height),
                      "-o", "again.exr", "-q"});
    ASSERT_EQ(again.code, 0) << again.err;
    for (int channel = 0; channel < 3; ++channel)
        EXPECT_NEAR(mean("again.exr")[channel] / mean("after.exr")[channel], 1.0f, 0.02f);
}

// Adding a light, hiding a thing, moving a lamp: each restarts the picture, and each can be taken back.
TEST_F(Viewer, AddsALightAndMovesAThing)
{
    const Outcome outcome = script("open spheres\n"
                                   "wait rest\n"
                                   "panel View close\npanel Rendering close\n"
                                   "panel Scene open\n"
                                   "panel Inspector open\n"
                                   "wait frame\n"
                                   "press \"+ Point light\"\n"
                                   "wait lights == 2\n"
                                   "wait rest\n"
                                   "screenshot lit.exr\n"
                                   "key Ctrl+z\n"
                                   "wait lights == 1\n"
                                   "wait rest\n"
                                   "screenshot unlit.exr\n"
                                   "quit\n",
                                   {"--spp", "4", "--size", "700x500"});
    ASSERT_EQ(outcome.code, 0) << outcome.err;
    EXPECT_GT(mean("lit.exr").x, 1.05f * mean("unlit.exr").x);
}

TEST_F(Viewer, ComparesPanes)
{
    ASSERT_EQ(program_.run({"render", "cornell", "--spp", "64", "--size", "345x480", "-o", "truth.exr", "-q"}).code, 0);
    const Outcome outcome = script("open cornell\n"
                                   "wait picture\n"
                                   "key F2\n"
                                   "set panes 2\n"
                                   "set pane.integrator 2:albedo\n"
                                   "wait rest\n"
                                   "screenshot --window beside.png\n"
                                   "set arrangement divider\n"
                                   "wait rest\n"
                                   "screenshot --window divided.png\n"
                                   "set arrangement side\n"
                                   "set pane.integrator 2:path\n"
                                   "set pane.seed 2:9\n"
                                   "set panes 3\n"
                                   "set truth 2\n"
                                   "wait rest\n"
                                   "wait relmse1 > 0\n"
                                   "set show 3:difference:1:2:absolute\n"
                                   "wait 300\n"
                                   "screenshot --window difference.png\n"
                                   "set show 3:difference:1:1:absolute\n"
                                   "wait 300\n"
                                   "screenshot --window nothing.png\n"
                                   "set show 2:file:truth.exr\n"
                                   "wait 300\n"
                                   "set pane.accel 1:embree\n"
                                   "wait rest\n"
                                   "set panes 1\n"
                                   "wait rest\n"
                                   "quit\n",
                                   {"--spp", "4", "--size", "900x500"});
    ASSERT_EQ(outcome.code, 0) << outcome.err;
    const Outcome wrong = script("open cornell\nwait scene\nset pane.seed 1:many\n");
    EXPECT_EQ(wrong.code, 2);
    EXPECT_NE(wrong.err.find("script.txt:3: seed: 'many' is not a number"), std::string::npos) << wrong.err;
    // The albedo knows no shadow.
    const vec3 shaded = mean("beside.png", 0.0f, 0.1f, 0.5f, 0.9f), albedo = mean("beside.png", 0.5f, 0.1f, 1.0f, 0.9f);
    EXPECT_GT(albedo.y, 1.2f * shaded.y);
    EXPECT_NE(mean("divided.png"), mean("beside.png"));
    // The third pane is below at the left. Noise against other noise; against itself nothing.
    EXPECT_GT(mean("difference.png", 0.15f, 0.6f, 0.35f, 0.9f).x, 0.01f);
    EXPECT_LT(mean("nothing.png", 0.15f, 0.6f, 0.35f, 0.9f).x, 0.002f);
}

TEST_F(Viewer, LooksInside)
{
    const Outcome outcome = script("open whitted\n"
                                   "wait rest\n"
                                   "panel View close\npanel Rendering close\n"
                                   "panel Pixel open\n"
                                   "panel Paths open\n"
                                   "panel Trees open\n"
                                   "click 630 600\n"
                                   "wait picked == on\n"
                                   "wait pixel.distance > 0\n"
                                   "wait paths.count == 8\n"
                                   "assert paths.exact == 8\n" // each is what the renderer had, bit for bit
                                   "assert paths.vertices > 0\n"
                                   "set paths.samples 3\n"
                                   "wait paths.count == 3\n"
                                   "wait trees.nodes > 0\n"
                                   "wait trees.steps > 0\n"
                                   "set trees.level 1\n"
                                   "set trees.step 2\n"
                                   "wait 300\n"
                                   "screenshot --window inside.png\n"
                                   "panel Pixel close\npanel Paths close\n"
                                   "panel \"Data views\" open\n"
                                   "wait 300\n"
                                   "quit\n",
                                   {"--spp", "4", "--size", "1000x700", "--integrator", "path"});
    ASSERT_EQ(outcome.code, 0) << outcome.err;
}

// All builders, on this scene: the number of rows is that of `snell list`.
TEST_F(Viewer, MeasuresBuildersAndSwitchesThem)
{
    const Outcome measured = script("open field:2000\n"
                                    "wait rest\n"
                                    "panel View close\npanel Rendering close\n"
                                    "panel Trees open\n"
                                    "wait trees.nodes > 0\n"
                                    "press \"Measure all builders\"\n"
                                    "wait trees.measured == 7\n"
                                    "set builder median\n"
                                    "wait rest\n"
                                    "wait trees.mrays > 0\n"
                                    "set accel bvh2\n"
                                    "wait rest\n"
                                    "assert phase resting\n"
                                    "quit\n",
                                    {"--spp", "1", "--size", "900x900"});
    EXPECT_EQ(measured.code, 0) << measured.err;
}

TEST_F(Viewer, MeasuresAndRecordsNumbers)
{
    const Outcome outcome = script("open cornell\n"
                                   "wait picture\n"
                                   "panel View close\npanel Rendering close\n"
                                   "panel Numbers open\n"
                                   "panel Convergence open\n"
                                   "set record curve.csv\n"
                                   "wait rays_per_second > 1000\n"
                                   "wait samples_per_second > 100\n"
                                   "assert memory_mb > 10\n"
                                   "hold w 300\n"
                                   "wait picture\n"
                                   "assert input_to_picture_ms > 0\n"
                                   "wait spp 64\n"
                                   "wait points >= 4\n"
                                   "assert rmse > 0\n"
                                   "assert slope < 0\n"
                                   "set record \"\"\n"
                                   "screenshot --window numbers.png\n"
                                   "quit\n",
                                   {"--size", "640x480", "--spp", "256"});
    ASSERT_EQ(outcome.code, 0) << outcome.err;
    const std::string csv = read_file(program_.folder() / "curve.csv");
    EXPECT_GE(line_count(csv), 5u) << csv;
}

// A triangle that goes from the left to the right within two seconds.
TEST_F(Viewer, PlaysAndScrubsAnimations)
{
    Gltf file;
    const std::vector<float> corners = {-1, -1, 0, 1, -1, 0, 0, 1, 0}, times = {0, 2}, places = {-1, 0, 0, 1, 0, 0};
    const int positions = file.accessor(corners, "VEC3"), at = file.accessor(times, "SCALAR"),
              to = file.accessor(places, "VEC3");
    file.mesh({{"POSITION", positions}});
    file.node({{"mesh", 0}, {"name", "thing"}});
    file.append("animations",
                {{"name", "walk"},
                 {"samplers", json::array({{{"input", at}, {"output", to}}})},
                 {"channels", json::array({{{"sampler", 0}, {"target", {{"node", 0}, {"path", "translation"}}}}})}});
    program_.write("walk.gltf", file.text());
    const Outcome outcome = script("open walk.gltf\n"
                                   "wait scene\n"
                                   "set eye 0,0,8\nset target 0,0,0\nset integrator albedo\n"
                                   "panel Timeline open\n"
                                   "set time 0\n"
                                   "wait rest\n"
                                   "screenshot left.exr\n"
                                   "set time 2\n"
                                   "wait rest\n"
                                   "screenshot right.exr\n"
                                   "set time 0\n"
                                   "key Space\n"
                                   "assert playing on\n"
                                   "wait time > 0.2\n"
                                   "key Space\n"
                                   "assert playing off\n"
                                   "wait rest\n"
                                   "quit\n",
                                   {"--size", "600x400", "--spp", "1"});
    ASSERT_EQ(outcome.code, 0) << outcome.err;
    EXPECT_GT(mean("left.exr", 0.0f, 0.0f, 0.5f, 1.0f).x, mean("left.exr", 0.5f, 0.0f, 1.0f, 1.0f).x);
    EXPECT_LT(mean("right.exr", 0.0f, 0.0f, 0.5f, 1.0f).x, mean("right.exr", 0.5f, 0.0f, 1.0f, 1.0f).x);
}

// The file is read again when it changes; the camera stays where the user has put it.
TEST_F(Viewer, ReadsAChangedFileAgain)
{
    const std::string triangle = "v -1 -1 0\nv 1 -1 0\nv 0 1 0\nf 1 2 3\n";
    program_.write("thing.obj", triangle);
    program_.write("script.txt", "open thing.obj\n"
                                 "wait scene\n"
                                 "set eye 0,0,9\n"
                                 "set integrator albedo\n"
                                 "wait rest\n"
                                 "screenshot one.exr\n"
                                 "say ready\n"
                                 "wait opened > 1\n"
                                 "wait rest\n"
                                 "assert eye.z == 9\n"
                                 "screenshot two.exr\n"
                                 "quit\n");
    program_.start({"view", "--script", "script.txt", "--size", "400x400", "--spp", "1"});
    ASSERT_TRUE(program_.wait_for("ready"));
    program_.write("thing.obj", triangle + "v -3 -3 -1\nv 3 -3 -1\nv 0 3 -1\nf 4 5 6\n");
    const Outcome outcome = program_.wait();
    ASSERT_EQ(outcome.code, 0) << outcome.err;
    EXPECT_GT(mean("two.exr").x, 1.5f * mean("one.exr").x);
}

} // namespace snell::test
