// Measures what a GPU makes of rays, trees and pictures, beside this machine's processor, in one run.
//
//     bench_gpu [--device NAME] [--rays N] [--size WxH] [--runs N] [--json FILE] [--scenes FOLDER]
//               [--eye X,Y,Z --target X,Y,Z --fov DEGREES] [SCENE...]
//
// For each scene: Mrays/s of camera rays, shadow rays, ambient occlusion and three diffuse bounces
// (snell/lab/ray_sets.h) by the device's clock, in trees of quantised 8-wide nodes and of plain binary ones, and by all
// threads of the processor, with what that is of the device's ceilings (measure.h); trees built and refitted by both;
// then pictures with one sample a pixel and 8 bounces: time of a frame, samples and rays a second, and what the stages
// take. Medians of the runs; device and processor take turns.
//
// Without SCENE: Sponza, the dragon, the coffee maker and a field of 5 million triangles, the first three from FOLDER
// (by default shared/scenes beside the project); where they are not there, built-in scenes.
#include "bench/gpu/measure.h"

#include "snell/core/error.h"
#include "snell/io/load.h"
#include "snell/scene/builtin.h"

#include <fmt/format.h>

#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <optional>

using namespace snell;
using namespace snell::bench;

namespace {

struct View
{
    std::string scene; // file or name of a built-in one
    std::optional<vec3> eye, target;
    std::optional<float> fov;
};

struct Job
{
    Measuring measuring{"gpu", 0, 1920, 1080, 5};
    std::string json;
    std::filesystem::path folder;
    View view; // its scene is not used
    std::vector<View> scenes;
};

std::vector<float> numbers_of(const std::string& option, const std::string& text, char separator, std::size_t count)
{
    std::vector<float> numbers;
    const char* at = text.c_str();
    for (;;) {
        char* end = nullptr;
        numbers.push_back(std::strtof(at, &end));
        if (end == at || (*end != separator && *end != '\0'))
            throw Error(fmt::format("{} {}: that is no list of numbers", option, text));
        if (*end == '\0') break;
        at = end + 1;
    }
    if (numbers.size() != count) throw Error(fmt::format("{} {}: {} numbers are wanted", option, text, count));
    return numbers;
}

Job parse(int argc, char** argv)
{
    Job job;
    std::vector<std::string> names;
    for (int i = 1; i < argc; ++i) {
        const std::string word = argv[i];
        if (!word.starts_with("--")) {
            names.push_back(word);
            continue;
        }
        if (i + 1 == argc) throw Error(word + " wants a value");
        const std::string value = argv[++i];
        const auto vector = [&] {
            const auto n = numbers_of(word, value, ',', 3);
            return vec3(n[0], n[1], n[2]);
        };
        if (word == "--device") {
            job.measuring.device = value;
        } else if (word == "--rays") {
            job.measuring.rays = static_cast<std::size_t>(numbers_of(word, value, ',', 1)[0]);
        } else if (word == "--runs") {
            job.measuring.runs = std::max(1, static_cast<int>(numbers_of(word, value, ',', 1)[0]));
        } else if (word == "--size") {
            const auto n = numbers_of(word, value, 'x', 2);
            job.measuring.width = static_cast<int>(n[0]), job.measuring.height = static_cast<int>(n[1]);
        } else if (word == "--json") {
            job.json = value;
        } else if (word == "--scenes") {
            job.folder = value;
        } else if (word == "--eye") {
            job.view.eye = vector();
        } else if (word == "--target") {
            job.view.target = vector();
        } else if (word == "--fov") {
            job.view.fov = numbers_of(word, value, ',', 1)[0];
        } else {
            throw Error("there is no option " + word, "see the head of bench/gpu/gpu.cpp");
        }
    }
    const std::string& device = job.measuring.device;
    if (!is_device_name(device) || device == "cpu" || device == "auto") throw Error("--device: give gpu or gpu:N");
    for (const std::string& name : names) {
        job.scenes.push_back(job.view);
        job.scenes.back().scene = name;
    }
    return job;
}

// The scenes that the project measures itself by, or what a stranger's clone has.
std::vector<View> usual_scenes(const std::filesystem::path& folder)
{
    std::vector<View> views;
    views.push_back({"mesh/sponza_dabrovic/sponza.obj", vec3(-10.0f, 5.0f, 0.0f), vec3(5.0f, 4.0f, 0.0f), 70.0f});
    views.push_back({"mesh/stanford_dragon/dragon_vrip_res2.ply", {}, {}, {}});
    views.push_back({"pbrt/bitterli-coffee/scene-v4.pbrt", {}, {}, {}});
    for (View& view : views) {
        view.scene = (folder / view.scene).string();
        if (std::filesystem::exists(view.scene)) continue;
        fmt::print("there is no {}: built-in scenes are measured instead\n", view.scene);
        return {{"cornell", {}, {}, {}}, {"sphereflake:5", {}, {}, {}}, {"field:5000000", {}, {}, {}}};
    }
    views.push_back({"field:5000000", {}, {}, {}});
    return views;
}

Scene open_scene(const Job& job, const View& view)
{
    std::optional<Scene> builtin = make_builtin_scene(view.scene);
    Scene scene = builtin ? std::move(*builtin) : load_scene(view.scene);
    complete(scene, static_cast<float>(job.measuring.width) / static_cast<float>(job.measuring.height));
    CameraDesc& camera = scene.cameras.front();
    if (view.eye) camera.eye = *view.eye;
    if (view.target) camera.target = *view.target;
    if (view.fov) camera.fov_degrees = *view.fov;
    return scene;
}

} // namespace

int main(int argc, char** argv)
{
    try {
        Job job = parse(argc, argv);
        Measuring& measuring = job.measuring;
        const DeviceChoice choice = choose_device(measuring.device);
        measuring.device = choice.device;
        const std::shared_ptr<Gpu> gpu = Gpu::open(measuring.device);
        if (gpu->is_processor() && measuring.width == 1920 && measuring.height == 1080)
            measuring.width = 480, measuring.height = 270;
        if (measuring.rays == 0) measuring.rays = std::size_t{1} << (gpu->is_processor() ? 16 : 21);
        const Ceilings ceilings = measure_ceilings(*gpu, measuring.runs);
        fmt::print("{}, {}; pictures of {}x{}; medians of {}\n", choice.reason, gpu->info().info.driver,
                   measuring.width, measuring.height, measuring.runs);
        fmt::print("ceilings: {:.1f} GB/s copied (read and written), {:.1f} GFLOP/s of multiply-adds; a step of a ray "
                   "counts as {:.0f} bytes and {:.0f} operations\n",
                   1e-9 * ceilings.bytes_per_second, 1e-9 * ceilings.flops_per_second, bytes_per_step, flops_per_step);
        fmt::print("goals of a card like an H200, in Sponza: camera 3000, bounce1 1200 Mrays/s; 16 ms a frame at "
                   "1920x1080\n");
        nlohmann::json json = {{"device", gpu->info().info.title},
                               {"driver", gpu->info().info.driver},
                               {"bytes_per_second", ceilings.bytes_per_second},
                               {"flops_per_second", ceilings.flops_per_second},
                               {"size", {measuring.width, measuring.height}}};
        if (job.scenes.empty()) job.scenes = usual_scenes(job.folder);
        for (const View& view : job.scenes) {
            const Scene scene = open_scene(job, view);
            const std::string name = std::filesystem::path(view.scene).filename().string();
            fmt::print("{}\n", name);
            nlohmann::json& of_scene = json["scenes"][name];
            of_scene["rays"] = measure_rays(measuring, scene, ceilings);
            of_scene["trees"] = measure_trees(measuring, scene);
            of_scene["frames"] = measure_frames(measuring, scene);
        }
        if (!job.json.empty()) {
            std::ofstream file(job.json);
            file << json.dump(1) << "\n";
            if (!file.flush()) throw Error(job.json + " cannot be written");
        }
    } catch (const Error& error) {
        fmt::print(stderr, "bench_gpu: error: {}\n", error.what());
        return 1;
    }
    return 0;
}
