// Pictures through every camera model: under an even sky each sees what its weights make of a radiance of 1.
#include "snell/scene/camera_models.h"
#include "tests/render/scenes.h"

#include <cmath>

namespace snell::test {
namespace {

constexpr int width = 48, height = 32;

Film picture_of(const CameraModel& model, float fov, uint spp, const Scene& around = {})
{
    Scene scene = around;
    scene.environment.radiance = vec3(1.0f);
    scene.cameras = {CameraDesc{"c", {0, 0, 4}, {0, 0, 0}, {0, 1, 0}, fov}};
    scene.cameras[0].model = model;
    RenderSettings settings;
    settings.width = width, settings.height = height;
    settings.spp = spp;
    return render(scene, settings).film;
}

vec3 mean_of(const Picture& picture, int x0, int y0, int x1, int y1)
{
    vec3 sum(0.0f);
    for (int y = y0; y < y1; ++y)
        for (int x = x0; x < x1; ++x) sum += picture.at(x, y);
    return sum / static_cast<float>((x1 - x0) * (y1 - y0));
}

TEST(CameraPictures, AnEvenSkyIsEven)
{
    for (const CameraModelInfo& info : camera_models()) {
        if (info.kind == camera_lens) continue;
        SCOPED_TRACE(std::string(info.name));
        CameraModel model = usual_model(info.kind);
        if (info.kind == camera_pinhole) model.lens_radius = 0.1f;
        const Film film = picture_of(model, info.usual_fov, 4);
        const Picture picture = film.picture();
        const std::vector<float> alpha = film.alpha();
        const CameraDesc desc{"c", {0, 0, 4}, {0, 0, 0}, {0, 1, 0}, info.usual_fov, false, {}, model};
        const ReadyCamera camera = make_camera(desc, width, height);
        for (int y = 0; y < height; ++y)
            for (int x = 0; x < width; ++x) {
                int seeing = 0; // corners of the pixel
                for (int corner = 0; corner < 4; ++corner)
                    seeing += camera_sees(camera_ray(camera, vec2(x + (corner & 1), y + (corner >> 1)))) ? 1 : 0;
                const float a = alpha.empty() ? 1.0f : alpha[static_cast<std::size_t>(y * width + x)];
                if (seeing == 4) {
                    EXPECT_EQ(picture.at(x, y), vec3(1.0f)) << x << " " << y;
                    EXPECT_EQ(a, 1.0f) << x << " " << y;
                } else if (seeing == 0) {
                    EXPECT_EQ(picture.at(x, y), vec3(0.0f)) << x << " " << y;
                    EXPECT_EQ(a, 0.0f) << x << " " << y;
                }
            }
    }
}

// Each sample of a display's picture has one colour, at three times its weight.
TEST(CameraPictures, SeparateColorsAreWhiteInTheMean)
{
    CameraModel model = usual_model(camera_hmd);
    model.k = {0.1f, 0, 0, 0.2f, 0, 0, 0.3f, 0, 0};
    const vec3 mean = mean_of(picture_of(model, 90.0f, 64).picture(), 0, 0, width, height);
    for (int c = 0; c < 3; ++c) EXPECT_NEAR(mean[c], 1.0f, 0.02f);
}

// Exposed like a pinhole in the middle, darker in the corners; black there, not transparent.
TEST(CameraPictures, LensesDarkenTheCorners)
{
    for (const LensPrescription& lens : known_lenses()) {
        SCOPED_TRACE(lens.name);
        CameraModel model = usual_model(camera_lens);
        model.lens = lens;
        const Film film = picture_of(model, 40.0f, 64);
        const Picture picture = film.picture();
        EXPECT_NEAR(mean_of(picture, 22, 14, 26, 18).x, 1.0f, 0.03f);
        EXPECT_LT(mean_of(picture, 0, 0, 3, 3).x, 0.7f);
        for (const float a : film.alpha()) ASSERT_EQ(a, 1.0f);
        for (const vec3& pixel : picture.pixels) ASSERT_TRUE(pixel.x == pixel.y && pixel.y == pixel.z);
    }
}

// A small lamp before the plane that is sharp becomes a disk of light with the same flux in all.
TEST(CameraPictures, BlurKeepsTheLight)
{
    Scene scene;
    MaterialDesc glow;
    glow.base_color = vec3(0.0f);
    glow.emission = vec3(50.0f);
    SphereDesc lamp;
    lamp.radius = 0.05f;
    lamp.material = add(scene, glow);
    place(scene, lamp);
    MaterialDesc black;
    black.base_color = vec3(0.0f);
    SphereDesc dark;
    dark.radius = 100.0f;
    dark.material = add(scene, black);
    place(scene, dark);
    const auto lit = [&](float radius, float focus, int& pixels) {
        CameraModel model = usual_model(camera_pinhole);
        model.lens_radius = radius, model.focus_distance = focus;
        const Picture picture = picture_of(model, 30.0f, 256, scene).picture();
        pixels = 0;
        for (const vec3& pixel : picture.pixels) pixels += pixel.x > 0.01f ? 1 : 0;
        return mean_of(picture, 0, 0, width, height).x;
    };
    int sharp = 0, in_focus = 0, blurred = 0;
    const float flux = lit(0.0f, 4.0f, sharp);
    EXPECT_NEAR(lit(0.1f, 4.0f, in_focus), flux, 0.03f * flux);
    EXPECT_NEAR(lit(0.1f, 8.0f, blurred), flux, 0.03f * flux);
    EXPECT_LE(in_focus, 2 * sharp);
    // A lens of radius 0.1, sharp at 8, spreads what is 4 away over 0.05 at its own distance.
    EXPECT_GT(blurred, 2 * sharp);
}

} // namespace
} // namespace snell::test
