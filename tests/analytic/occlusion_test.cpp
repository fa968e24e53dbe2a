// Ambient occlusion with a known answer.
#include "tests/analytic/probe.h"

namespace snell::test {
namespace {

// A wall as high as the sky takes half of it.
TEST(AmbientOcclusion, AtTheFootOfAWall)
{
    Scene scene;
    add_plane(scene, vec3(0.0f), vec3(0.0f, 1.0f, 0.0f), diffuse(scene, 0.5f));
    add_plane(scene, vec3(0.0f), vec3(1.0f, 0.0f, 0.0f), diffuse(scene, 0.5f));
    look(scene, vec3(2.0f, 1.0f, 1.0f), vec3(0.01f, 0.0f, 0.0f), 1e-4f);
    expect_value(measure(scene, probe_settings("ao", {{"distance", "1e6"}})), 0.5);
}

// Under a ceiling at height h, directions closer to the vertical than cos = h / distance meet it in time. Of the
// cosine-weighted hemisphere that leaves (h / distance)^2.
TEST(AmbientOcclusion, UnderACeiling)
{
    Scene scene;
    add_plane(scene, vec3(0.0f), vec3(0.0f, 1.0f, 0.0f), diffuse(scene, 0.5f));
    add_plane(scene, vec3(0.0f, 2.0f, 0.0f), vec3(0.0f, -1.0f, 0.0f), diffuse(scene, 0.5f));
    look(scene, vec3(2.0f, 1.0f, 1.0f), vec3(0.0f), 1e-4f);
    expect_value(measure(scene, probe_settings("ao", {{"distance", "4"}})), 0.25);
    expect_value(measure(scene, probe_settings("ao", {{"distance", "2.5"}})), 0.64);
    expect_value(measure(scene, probe_settings("ao", {{"distance", "1.9"}})), 1, 1e-6);
}

TEST(AmbientOcclusion, FreeSurfacesAndTheSkyAreWhite)
{
    Scene scene;
    add_sphere(scene, vec3(0.0f), 1.0f, diffuse(scene, 0.1f));
    look(scene, vec3(0.0f, 0.0f, 4.0f), vec3(0.0f), 60.0f);
    for (const double v : pixel_means(render_film(scene, probe_settings("ao", {{"distance", "10"}}, 16))))
        EXPECT_NEAR(v, 1, 1e-6);
}

} // namespace
} // namespace snell::test
