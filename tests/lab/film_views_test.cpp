// Numbers of a film as heat maps, against values worked out by hand.
#include "snell/lab/film_views.h"

#include "snell/kernel/views.h"
#include "tests/render/scenes.h"

namespace snell::test {
namespace {

TEST(FilmViews, Values)
{
    Film film(2, 1, false);
    for (const float x : {1.0f, 3.0f, 2.0f, 2.0f}) film.add_sample(0, vec3(x));
    film.seconds[0] = 0.25f;
    EXPECT_EQ(film_values(film, FilmView::sample_count), (std::vector<float>{4, 0}));
    EXPECT_EQ(film_values(film, FilmView::seconds), (std::vector<float>{0.25f, 0}));
    const float error = std::sqrt(2.0f / 3.0f / 4.0f); // variance of four samples over their number
    EXPECT_NEAR(film_values(film, FilmView::standard_error)[0], error, 1e-5f);
    EXPECT_NEAR(film_values(film, FilmView::relative_error)[0], error / 2.0f, 1e-5f);
}

TEST(FilmViews, HeatMapsOrderWhatTheyShow)
{
    std::vector<float> values;
    for (int i = 0; i < 200; ++i) values.push_back(static_cast<float>(i));
    const HeatMap map = heat_map(200, 1, values);
    EXPECT_EQ(map.most, 197.0f);
    for (std::size_t i = 1; i < 198; ++i)
        EXPECT_GT(luminance(map.picture.pixels[i]), luminance(map.picture.pixels[i - 1])) << i;
    EXPECT_EQ(map.picture.pixels[199], heat_color(1.0f));
    EXPECT_EQ(heat_map(200, 1, values, 50.0f).picture.pixels[25], heat_color(0.5f));
    EXPECT_EQ(heat_map(1, 1, {0.0f}).most, 1.0f);
}

// A pixel of a tile with work to do has taken longer than one of the sky, and all of them together what the threads
// did.
TEST(FilmViews, TimeIsSpentWhereTheWorkIs)
{
    RenderSettings settings;
    settings.width = settings.height = 64;
    settings.spp = 32;
    settings.threads = 1;
    Scene scene;
    scene.environment.radiance = vec3(1.0f);
    MaterialDesc white;
    white.base_color = vec3(0.95f);
    const auto material = add(scene, white);
    for (int i = 0; i < 40; ++i) { // a heap of balls in the lower half
        SphereDesc ball;
        ball.center = vec3(0.25f * static_cast<float>(i % 8 - 4), -0.8f - 0.2f * static_cast<float>(i / 8), 0.0f);
        ball.radius = 0.2f;
        ball.material = material;
        place(scene, ball);
    }
    CameraDesc camera;
    camera.eye = vec3(0, 0, 4);
    camera.target = vec3(0.0f);
    camera.fov_degrees = 40.0f;
    add(scene, camera);
    const Film film = render(scene, settings).film;
    double above = 0, below = 0;
    for (std::size_t i = 0; i < film.seconds.size(); ++i)
        (i < film.seconds.size() / 2 ? above : below) += film.seconds[i];
    EXPECT_GT(above, 0.0);
    EXPECT_GT(below, 1.3 * above);
}

} // namespace
} // namespace snell::test
