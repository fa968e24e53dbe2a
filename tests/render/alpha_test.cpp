// The picture's alpha: what a hidden environment lets one see through, and what was not rendered.
#include "tests/render/scenes.h"

#include "tests/analytic/probe.h"

namespace snell::test {
namespace {

// A shining ball before a bright sky that the camera does not see.
Scene ball_before_hidden_sky(float opacity = 1.0f)
{
    Scene scene;
    MaterialDesc shine;
    shine.kind = material_unlit;
    shine.base_color = vec3(0.75f);
    shine.coverage = opacity < 1.0f ? coverage_blend : coverage_opaque;
    shine.opacity = opacity;
    add_sphere(scene, vec3(0.0f), 1.0f, add(scene, shine));
    scene.environment.radiance = vec3(5.0f);
    scene.environment.visible = false;
    look(scene, vec3(0, 0, 5), vec3(0.0f), 40.0f);
    validate(scene);
    return scene;
}

TEST(Alpha, IsThePartThatIsCovered)
{
    const Scene scene = ball_before_hidden_sky();
    for (const char* integrator : {"path", "whitted"}) {
        const RenderSettings settings = small_picture(integrator);
        const Film film = render(scene, settings).film;
        const std::vector<float> alpha = film.alpha();
        const Picture picture = film.picture();
        ASSERT_EQ(alpha.size(), picture.pixels.size());
        int between = 0;
        for (std::size_t i = 0; i < alpha.size(); ++i) {
            EXPECT_NEAR(picture.pixels[i].x, 0.75f * alpha[i], 1e-6f); // the ball's colour, multiplied with it
            between += alpha[i] > 0.0f && alpha[i] < 1.0f;
        }
        EXPECT_EQ(alpha[0], 0.0f);
        EXPECT_EQ(alpha[14 * 37 + 18], 1.0f);
        EXPECT_GT(between, 10);
    }
}

TEST(Alpha, CountsAllSamplesAndHoles)
{
    RenderSettings settings = probe_settings("path", {}, 400);
    const Film film = render(ball_before_hidden_sky(0.3f), settings).film;
    double mean = 0;
    for (const float a : film.alpha()) mean += double{a} / 256;
    EXPECT_NEAR(film.alpha()[16 * 8 + 8], 0.51f, 0.12f); // two layers
    EXPECT_GT(mean, 0.1);
}

TEST(Alpha, IsOneWhereTheEnvironmentShows)
{
    Scene scene = ball_before_hidden_sky();
    scene.environment.visible = true;
    EXPECT_TRUE(render(scene, small_picture("path")).film.alpha().empty());
    scene.environment.visible = false;
    EXPECT_TRUE(render(scene, small_picture("furnace")).film.alpha().empty()); // its sky is seen
    EXPECT_TRUE(render(scene, small_picture("ao")).film.alpha().empty());
}

TEST(Alpha, IsNothingOutsideTheRegion)
{
    Scene scene = mixed_scene();
    RenderSettings settings = small_picture("path");
    settings.region = Region{5, 6, 20, 21};
    const std::vector<float> alpha = render(scene, settings).film.alpha();
    ASSERT_EQ(alpha.size(), 37u * 29u);
    for (std::size_t y = 0; y < 29; ++y)
        for (std::size_t x = 0; x < 37; ++x)
            EXPECT_EQ(alpha[y * 37 + x], x >= 5 && x < 20 && y >= 6 && y < 21 ? 1.0f : 0.0f);
}

TEST(Alpha, DoesNotDependOnTheOrderOfWork)
{
    const Scene scene = ball_before_hidden_sky(0.5f);
    RenderSettings settings = small_picture("path");
    settings.threads = 1;
    const Film plain = render(scene, settings).film;
    settings.threads = 3;
    settings.tile_size = 5;
    EXPECT_EQ(render(scene, settings).film.seen_through, plain.seen_through);
}

} // namespace
} // namespace snell::test
