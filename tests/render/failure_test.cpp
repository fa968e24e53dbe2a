// What goes wrong on the way to a picture: samples that are no numbers, renders that are stopped, names that do not
// exist.
#include "snell/kernel/surface.h"
#include "snell/lab/metrics.h"
#include "snell/render/integrator.h"
#include "tests/render/scenes.h"

#include <atomic>
#include <functional>
#include <limits>

namespace snell::test {
namespace {

std::string message_of(const std::function<void()>& f)
{
    try {
        f();
    } catch (const Error& e) {
        return e.what();
    }
    return "(no error)";
}

void expect_error(const RenderSettings& settings, const std::vector<std::string>& parts)
{
    const std::string message = message_of([&] { render(mixed_scene(), settings); });
    for (const std::string& part : parts)
        EXPECT_NE(message.find(part), std::string::npos) << part << " in: " << message;
}

// Some pixels of the left part of the picture have no value, in different ways.
bool is_bad(const Ray& ray)
{
    return ray.direction.x < -0.2f && ray.direction.y > 0.0f;
}

void register_once()
{
    if (find_integrator("test-nan") != nullptr) return;
    register_integrator("test-nan", "NaN and infinity in places", [](const RayScene&, const Ray& ray, SampleStream&) {
        if (!is_bad(ray)) return vec3(1.0f, 2.0f, 3.0f);
        return ray.direction.x < -0.3f ? vec3(1.0f, std::numeric_limits<float>::quiet_NaN(), 1.0f)
                                       : vec3(infinity(), 1.0f, 1.0f);
    });
    register_integrator("test-hits", "what a custom integrator can do",
                        [](const RayScene& scene, const Ray& ray, SampleStream& sampler) {
                            const Hit hit = scene.intersect(ray);
                            if (!is_hit(hit)) return vec3(0.0f);
                            const SurfacePoint p = surface_point(scene.view, ray, hit);
                            const Ray up = make_ray(offset_point(p.position, vec3(0.0f, 1.0f, 0.0f)),
                                                    vec3(0.0f, 1.0f, 0.0f), infinity());
                            const float a = sampler.next_1d();
                            const vec2 b = sampler.next_2d();
                            return vec3(scene.occluded(up) ? 0.0f : 1.0f, a, b.y);
                        });
}

TEST(NonFinite, SamplesAreDroppedCountedAndPlaced)
{
    register_once();
    RenderSettings settings = small_picture("test-nan");
    settings.pixel_jitter = false;
    settings.layers = false;
    std::vector<Film> films;
    for (const int threads : {1, 4})
        for (const int tile : {3, 16}) {
            settings.threads = threads;
            settings.tile_size = tile;
            films.push_back(render(mixed_scene(), settings).film);
        }
    const Film& film = films[0];
    std::vector<std::uint64_t> bad;
    for (std::size_t i = 0; i < film.sum.size(); ++i) {
        ASSERT_TRUE(is_finite3(film.sum[i]));
        ASSERT_TRUE(film.sample_count[i] == 0 || film.sample_count[i] == settings.spp);
        if (film.sample_count[i] == 0) bad.push_back(i);
    }
    ASSERT_GT(bad.size(), 16u);
    EXPECT_EQ(film.dropped_samples, bad.size() * settings.spp);
    bad.resize(16); // the first ones, whatever the threads did
    for (const Film& f : films) {
        EXPECT_EQ(f.dropped, bad);
        expect_same_film(f, film);
    }
}

TEST(NonFinite, StrictStopsAndNamesThePixel)
{
    register_once();
    RenderSettings settings = small_picture("test-nan");
    settings.strict = true;
    settings.threads = 2;
    expect_error(settings, {"not finite", "pixel", "strict"});
}

TEST(Custom, IntegratorsHaveRaysAndRandomNumbers)
{
    register_once();
    RenderSettings settings = small_picture("test-hits");
    settings.spp = 64;
    const Film film = render(mixed_scene(), settings).film;
    double red = 0, green = 0, blue = 0, hits = 0;
    for (std::size_t i = 0; i < film.sum.size(); ++i) {
        red += double{film.sum[i].x}, green += double{film.sum[i].y}, blue += double{film.sum[i].z};
        if (film.sum[i].y > 0.0f) hits += film.sample_count[i];
    }
    EXPECT_GT(red, 0);
    EXPECT_LT(red, hits);
    EXPECT_NEAR(green / hits, 0.5, 0.03); // pixels at edges are counted whole
    EXPECT_NEAR(blue / hits, 0.5, 0.03);
    // and is as independent of threads and tiles as the others
    settings.threads = 1;
    settings.tile_size = 5;
    expect_same_film(render(mixed_scene(), settings).film, film);
    EXPECT_NE(message_of([] { register_integrator("path", "", {}); }).find("path"), std::string::npos);
}

TEST(Cancel, LeavesWhatThereIs)
{
    RenderSettings settings = small_picture("path");
    settings.width = settings.height = 64;
    settings.spp = 100'000; // for ever
    settings.threads = 2;
    const auto prepared = prepare(mixed_scene(), settings);
    std::atomic<bool> cancel = false;
    int reports = 0;
    double fraction = -1;
    const RenderResult result = render(
        *prepared, settings,
        [&](const Progress& p) {
            EXPECT_GE(p.fraction, fraction) << "progress goes forward";
            fraction = p.fraction;
            EXPECT_LE(p.fraction, 1.0);
            if (++reports == 3) cancel = true;
        },
        &cancel);
    EXPECT_TRUE(result.stats.cancelled);
    EXPECT_GE(reports, 3);
    std::uint64_t samples = 0;
    for (std::size_t i = 0; i < result.film.sum.size(); ++i) {
        samples += result.film.sample_count[i];
        ASSERT_TRUE(is_finite3(result.film.sum[i]));
        ASSERT_LT(result.film.sample_count[i], settings.spp);
    }
    EXPECT_EQ(samples, result.stats.samples);
    EXPECT_EQ(samples, result.stats.camera_rays);
    // a picture of it is a picture: pixels are means, whatever their number of samples
    const Picture picture = result.film.picture();
    float most = 0.0f;
    for (const vec3& v : picture.pixels) most = max(most, max3(v));
    EXPECT_GT(most, 0.5f);
    EXPECT_LT(most, 1000.0f);
}

TEST(Cancel, BeforeTheStart)
{
    RenderSettings settings = small_picture("path");
    settings.threads = 1;
    const auto prepared = prepare(mixed_scene(), settings);
    const std::atomic<bool> cancel = true;
    const RenderResult result = render(*prepared, settings, {}, &cancel);
    EXPECT_TRUE(result.stats.cancelled);
    for (const vec3& v : result.film.picture().pixels) ASSERT_TRUE(is_finite3(v));
}

TEST(Timeout, Stops)
{
    RenderSettings settings = small_picture("path");
    settings.spp = 1'000'000;
    settings.timeout_seconds = 0.2;
    const RenderResult result = render(*prepare(mixed_scene(), settings), settings);
    EXPECT_TRUE(result.stats.cancelled);
    EXPECT_GT(result.stats.samples, 0u);
    EXPECT_LT(result.stats.render_seconds, 20);
}

TEST(TargetError, StopsEarlyAndKeepsItsPromise)
{
    RenderSettings settings;
    settings.width = settings.height = 32;
    settings.spp = 4096;
    settings.sampler = "independent"; // whose error is what the estimate assumes
    settings.target_error = 0.02;
    const RenderResult result = render(mixed_scene(), settings);
    EXPECT_FALSE(result.stats.cancelled);
    EXPECT_GE(result.film.sample_count[0], 8u);
    EXPECT_LT(result.film.sample_count[0], 4096u);

    RenderSettings reference = settings;
    reference.target_error = 0;
    reference.seed = 1;
    const Film truth = render(mixed_scene(), reference).film;
    const double error = compare_pictures(result.film.picture(), truth.picture()).relmse;
    const double promised = result.film.estimated_relmse({0, 0, 32, 32});
    EXPECT_LE(promised, settings.target_error);
    // the estimate of a heavy-tailed variance from few samples is itself noisy
    EXPECT_GT(error, 0.4 * promised);
    EXPECT_LT(error, 2.5 * promised);
}

TEST(Names, ThatDoNotExist)
{
    RenderSettings settings = small_picture("path");
    settings.integrator = "paht";
    expect_error(settings, {"integrator", "'paht'", "'path'"});
    settings.integrator = "xyzzy";
    expect_error(settings, {"'xyzzy'", "whitted"});
    settings = small_picture("path");
    settings.parameters = {{"max_dept", "3"}};
    expect_error(settings, {"'path'", "'max_dept'", "'max_depth'"});
    settings.parameters = {{"max_depth", "many"}};
    expect_error(settings, {"max_depth", "many", "number"});
    settings.parameters = {{"max_depth", "-1"}};
    expect_error(settings, {"max_depth", "-1"});
    settings.parameters = {{"max_depth", "2.7"}};
    expect_error(settings, {"max_depth", "2.7", "whole number"});
    for (const char* key : {"nee", "mis", "rr"}) {
        settings.parameters = {{key, "0.5"}};
        expect_error(settings, {key, "0.5", "neither 0 nor 1"});
    }
    settings.parameters = {{"max_depth", "nan"}};
    expect_error(settings, {"max_depth", "nan"});
    settings = small_picture("normals");
    settings.parameters = {{"max_depth", "3"}};
    expect_error(settings, {"'normals'", "'max_depth'"});
    settings = small_picture("path");
    settings.sampler = "halton";
    expect_error(settings, {"sampler", "'halton'", "sobol", "independent"});
    settings = small_picture("path");
    settings.accel = "octree";
    expect_error(settings, {"'octree'"});
}

TEST(Sizes, ThatMakeNoPicture)
{
    RenderSettings settings = small_picture("path");
    settings.width = 0;
    expect_error(settings, {"0x29"});
    settings.width = 1 << 20;
    expect_error(settings, {"1048576", "65536"});
    settings = small_picture("path");
    settings.spp = 0;
    expect_error(settings, {"samples"});
    settings = small_picture("path");
    settings.region = Region{40, 0, 50, 10};
    expect_error(settings, {"region"});
}

TEST(Camera, ThatSeesNothing)
{
    const RenderSettings settings = small_picture("path");
    Scene scene = mixed_scene();
    scene.cameras[0].target = scene.cameras[0].eye;
    EXPECT_NE(message_of([&] { render(scene, settings); }).find("camera"), std::string::npos);
    scene = mixed_scene();
    scene.cameras[0].up = scene.cameras[0].target - scene.cameras[0].eye;
    EXPECT_NE(message_of([&] { render(scene, settings); }).find("up"), std::string::npos);
    for (const float fov : {0.0f, 180.0f, -3.0f}) {
        scene = mixed_scene();
        scene.cameras[0].fov_degrees = fov;
        EXPECT_NE(message_of([&] { render(scene, settings); }).find("field of view"), std::string::npos);
    }
    scene.cameras.clear();
    EXPECT_NE(message_of([&] { render(scene, settings); }).find("camera"), std::string::npos);
}

TEST(Stats, CountRays)
{
    RenderSettings settings = small_picture("path");
    const RenderResult r = render(*prepare(mixed_scene(), settings), settings);
    EXPECT_EQ(r.stats.camera_rays, 37u * 29u * 11u);
    EXPECT_EQ(r.stats.samples, r.stats.camera_rays);
    EXPECT_GT(r.stats.extension_rays, r.stats.camera_rays / 2);
    EXPECT_GT(r.stats.shadow_rays, r.stats.camera_rays / 2);
    EXPECT_FALSE(r.stats.cancelled);
    settings.integrator = "normals";
    const RenderResult n = render(*prepare(mixed_scene(), settings), settings);
    EXPECT_EQ(n.stats.extension_rays + n.stats.shadow_rays, 0u);
}

} // namespace
} // namespace snell::test
