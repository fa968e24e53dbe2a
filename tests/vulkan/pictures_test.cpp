// Pictures of the GPU backend are those of the CPU backend: the same random numbers, the same paths.
#include "snell/core/timer.h"
#include "snell/kernel/views.h"
#include "snell/render/integrator.h"
#include "snell/render/rendering.h"
#include "snell/scene/camera_models.h"
#include "tests/vulkan/pictures.h"

namespace snell::test {
namespace {

TEST(GpuPictures, BuiltInScenes)
{
    SNELL_NEEDS_GPU();
    for (const BuiltinScene& builtin : builtin_scenes()) {
        SCOPED_TRACE(builtin.name);
        expect_same_picture(small_builtin(builtin), one_sample("path"));
    }
}

TEST(GpuPictures, EveryIntegrator)
{
    SNELL_NEEDS_GPU();
    const Scene scene = mixed_scene();
    for (const IntegratorInfo& integrator : integrators()) {
        if (integrator.radiance) continue;
        // Boxes of nodes are met or missed by other roundings: a step more or less.
        expect_same_picture(scene, one_sample(integrator.name), integrator.view == view_steps ? 0.2 : 0.005);
    }
}

TEST(GpuPictures, PrincipledMaterialsHolesAndDispersion)
{
    SNELL_NEEDS_GPU();
    for (const char* integrator : {"path", "whitted"}) expect_same_picture(principled_scene(), one_sample(integrator));
}

TEST(GpuPictures, PathTracerWithItsSwitches)
{
    SNELL_NEEDS_GPU();
    const Scene scene = mixed_scene();
    for (const char* key : {"nee", "mis", "rr"}) {
        SCOPED_TRACE(key);
        RenderSettings settings = one_sample("path");
        settings.parameters[key] = "0";
        settings.parameters["max_depth"] = "20"; // more than one submission
        expect_same_picture(scene, settings);
    }
    for (const char* depth : {"1", "2"}) {
        RenderSettings settings = one_sample("path");
        settings.parameters["max_depth"] = depth;
        settings.sampler = "independent";
        settings.seed = 7;
        settings.first_sample = 3;
        expect_same_picture(scene, settings);
    }
}

// All that the camera sees is glass, where each ray becomes two: more than the queues take at once.
TEST(GpuPictures, RaysThatBranchWithoutEnd)
{
    SNELL_NEEDS_GPU();
    Scene scene;
    scene.environment.radiance = vec3(1.0f, 0.8f, 0.6f);
    MaterialDesc glass;
    glass.kind = material_dielectric;
    glass.ior = 1.5f;
    for (const float radius : {3.0f, 2.5f, 2.0f}) {
        SphereDesc ball;
        ball.radius = radius;
        ball.material = add(scene, glass);
        place(scene, ball);
    }
    CameraDesc camera;
    camera.eye = vec3(0.0f, 0.0f, 4.0f);
    camera.target = vec3(0.0f);
    add(scene, camera);
    validate(scene);
    RenderSettings settings = one_sample("whitted");
    settings.width = settings.height = 128;
    settings.spp = 3;
    expect_same_picture(scene, settings, 0.02); // three samples, of a hundred rays each
}

// Also where a camera sees nothing: outside of a fisheye's circle, behind the rim of a lens.
TEST(GpuPictures, EveryCameraModel)
{
    SNELL_NEEDS_GPU();
    Scene scene = mixed_scene();
    for (const CameraModelInfo& info : camera_models()) {
        SCOPED_TRACE(std::string(info.name));
        CameraModel model = usual_model(info.kind);
        if (info.kind == camera_pinhole) model.lens_radius = 0.05f;
        scene.cameras[0].model = model;
        scene.cameras[0].fov_degrees = info.usual_fov;
        for (const char* integrator : {"path", "whitted", "ao", "albedo"}) {
            // Rays through a lens of glass are the result of a dozen refractions: more of them round the other way.
            expect_same_picture(scene, one_sample(integrator), info.kind == camera_lens ? 0.02 : 0.005);
        }
    }
    scene.cameras[0].model = usual_model(camera_equidistant);
    scene.cameras[0].fov_degrees = 200.0f;
    RenderSettings settings = small_picture("path");
    settings.accel = "bvh8q";
    const FilmLayers p = render(scene, settings).film.layers, q = render(scene, gpu_settings(settings)).film.layers;
    EXPECT_EQ(p.sample_count, q.sample_count);
    EXPECT_LT(share_of_others(p.albedo, q.albedo), 0.005);
    EXPECT_LT(share_of_others(p.position, q.position), 0.005);
}

TEST(GpuPictures, TheBinaryTreeGivesTheSameBits)
{
    SNELL_NEEDS_GPU();
    RenderSettings settings = gpu_settings(one_sample("path"));
    const RenderResult quantised = render(mixed_scene(), settings);
    settings.accel = "bvh2";
    EXPECT_TRUE(same_bits(render(mixed_scene(), settings).film.sum, quantised.film.sum));
}

TEST(GpuPictures, LayersOfFirstHits)
{
    SNELL_NEEDS_GPU();
    RenderSettings settings = small_picture("path");
    settings.accel = "bvh8q";
    const Film cpu = render(mixed_scene(), settings).film, gpu = render(mixed_scene(), gpu_settings(settings)).film;
    const FilmLayers &p = cpu.layers, &q = gpu.layers;
    const auto same = [](const std::vector<vec3>& a, const std::vector<vec3>& b) { return share_of_others(a, b); };
    EXPECT_LT(same(p.albedo, q.albedo), 0.005);
    EXPECT_LT(same(p.normal, q.normal), 0.005);
    EXPECT_LT(same(p.geometric_normal, q.geometric_normal), 0.005);
    EXPECT_LT(same(p.position, q.position), 0.005);
    EXPECT_LT(same(p.emission, q.emission), 0.005);
    EXPECT_LT(same(p.direct, q.direct), 0.05); // eleven samples each
    EXPECT_LT(same(p.indirect, q.indirect), 0.05);
    EXPECT_EQ(p.object, q.object);
    EXPECT_EQ(p.material, q.material);
    EXPECT_EQ(p.hit_count, q.hit_count);
    EXPECT_EQ(p.sample_count, q.sample_count);
    for (std::size_t i = 0; i < p.depth.size(); ++i)
        EXPECT_NEAR(p.depth[i], q.depth[i], 1e-3f * p.depth[i]) << "pixel " << i;
    const auto [least, most] = std::minmax_element(q.steps.begin(), q.steps.end());
    EXPECT_GT(*least, 0.0f);
    EXPECT_GT(*most, *least);
    EXPECT_GT(*std::max_element(gpu.seconds.begin(), gpu.seconds.end()), 0.0f);
}

// However the samples of a picture are asked for, and however many run together.
TEST(GpuPictures, AreTheSameInParts)
{
    SNELL_NEEDS_GPU();
    for (const char* integrator : {"path", "whitted"}) {
        SCOPED_TRACE(integrator);
        const RenderSettings settings = gpu_settings(small_picture(integrator));
        const auto prepared = prepare(mixed_scene(), settings);
        const auto go_on = [] { return true; };
        Rendering whole(*prepared, settings, prepared->camera), parts(*prepared, settings, prepared->camera);
        whole.add_samples(whole.region(), 0, settings.spp, go_on);
        for (uint sample = 0; sample < settings.spp; sample += 4)
            for (const int x : {0, 5, 30})
                parts.add_samples({x, 0,
                                   x == 0   ? 5
                                   : x == 5 ? 30
                                            : settings.width,
                                   settings.height},
                                  sample, std::min(4u, settings.spp - sample), go_on);
        expect_same_film(whole.film, parts.film);
        EXPECT_EQ(whole.stats().rays(), parts.stats().rays());
    }
}

TEST(GpuPictures, AllMeansAreThoseOfTheCpu)
{
    SNELL_NEEDS_GPU();
    // Independent random numbers, and others on both sides: blocks of pixels agree within three standard errors.
    for (const char* integrator : {"path", "whitted"}) {
        SCOPED_TRACE(integrator);
        RenderSettings settings = one_sample(integrator);
        settings.sampler = "independent";
        settings.spp = 64;
        settings.seed = 1;
        const Film cpu = render(principled_scene(), settings).film;
        settings.seed = 2;
        const Film gpu = render(principled_scene(), gpu_settings(settings)).film;
        const Blocks blocks = compare_blocks(cpu, gpu);
        EXPECT_EQ(blocks.beyond_three, 0) << blocks.worst;
    }
}

TEST(GpuPictures, FollowAScene)
{
    SNELL_NEEDS_GPU();
    RenderSettings settings = gpu_settings(one_sample("path"));
    settings.keep_motion = true;
    Scene scene = mixed_scene();
    const auto prepared = prepare(scene, settings);
    scene.instances.back().transform = translation(vec3(0.5f, 1.5f, 0.5f));
    prepared->update(scene, change_pose);
    EXPECT_TRUE(prepared->updated);
    EXPECT_LT(prepared->device->uploaded_bytes, prepared->device->bytes());
    const Film followed = render(*prepared, settings).film;
    EXPECT_TRUE(same_bits(followed.sum, render(scene, settings).film.sum));
}

TEST(GpuPictures, StopsWhenAsked)
{
    SNELL_NEEDS_GPU();
    RenderSettings settings = gpu_settings(small_picture("path"));
    settings.width = settings.height = 128;
    const auto prepared = prepare(mixed_scene(), settings);
    Rendering rendering(*prepared, settings, prepared->camera);
    int calls = 0;
    rendering.add_samples(rendering.region(), 0, settings.spp, [&] { return ++calls < 2; });
    EXPECT_EQ(calls, 2);
    EXPECT_LT(rendering.stats().samples, rendering.samples_in_all());
    EXPECT_EQ(rendering.film.sample_count.back(), 0u);
}

} // namespace
} // namespace snell::test
