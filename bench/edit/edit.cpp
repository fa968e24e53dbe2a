// Measures how long Prepared::update() takes to follow an edit of each kind.
//
//     bench_edit SCENE...
//
// For each scene one line a kind of edit: milliseconds, the median of 15, of applying it and updating, and how many
// trees were refitted, rebuilt, whether everything was built anew, and the lights that there are then. "group": the
// instance with the most triangles moves; "small group": the one with the fewest.
#include "snell/scene/edit.h"
#include "snell/core/error.h"
#include "snell/core/timer.h"
#include "snell/io/load.h"
#include "snell/render/render.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstdio>
#include <functional>

using namespace snell;

namespace {

constexpr int rounds = 15;

void measure(Scene& scene, Prepared& prepared, const char* what, const std::function<Edit(int)>& edit)
{
    std::vector<double> seconds;
    for (int i = 0; i < rounds; ++i) {
        const Edit next = edit(i);
        const Timer timer;
        prepared.update(scene, apply_edit(scene, next).changes);
        seconds.push_back(timer.seconds());
    }
    std::sort(seconds.begin(), seconds.end());
    const AccelStats& stats = prepared.accel->stats;
    fmt::print("  {:<36} {:9.3f} ms  {} refitted, {} rebuilt{}; {} lights\n", what, 1e3 * seconds[rounds / 2],
               stats.refitted, stats.rebuilt, prepared.updated ? "" : ", all anew", prepared.packed.lights.size());
    std::fflush(stdout);
}

// The instance that stands still and has the most triangles (or, of those that have any, the fewest); none: there is
// none.
uint find_instance(const Scene& scene, bool largest)
{
    uint found = none;
    std::size_t best = 0;
    for (uint i = 0; i < scene.instances.size(); ++i) {
        if (scene.instances[i].node.valid()) continue;
        std::size_t triangles = 0;
        for (const Index<Mesh> mesh : scene.groups[scene.instances[i].group.value].meshes)
            triangles += scene.meshes[mesh.value].triangles.size();
        if (triangles == 0 || (found != none && (largest ? triangles <= best : triangles >= best))) continue;
        found = i;
        best = triangles;
    }
    return found;
}

void move_instance(Scene& scene, Prepared& prepared, const char* what, uint index)
{
    if (index == none) return;
    const Transform rest = scene.instances[index].transform;
    const float step = 0.001f * prepared.packed.radius;
    measure(scene, prepared, what, [&](int i) {
        return SetTransform{index, compose(translation(vec3(step * static_cast<float>(i), 0, 0)), rest)};
    });
}

void run(const char* name)
{
    Scene scene = load_scene(name);
    complete(scene, 16.0f / 9.0f);
    RenderSettings settings;
    settings.keep_motion = true;
    const auto prepared = prepare(scene, settings);
    fmt::print("{}: {} triangles, {} lights, {} MB of textures; packed in {:.0f} ms, built in {:.0f} ms\n", name,
               prepared->packed.triangles.size(), prepared->packed.lights.size(),
               prepared->packed.texels.size() / 250000, 1e3 * prepared->pack_seconds, 1e3 * prepared->build_seconds);

    measure(scene, *prepared, "camera", [&](int i) {
        SetCamera set{0, scene.cameras[0]};
        set.value.fov_degrees = 40.0f + static_cast<float>(i);
        return set;
    });
    measure(scene, *prepared, "colour of a material", [&](int i) {
        SetMaterial set{{0}, scene.materials[0]};
        set.value.base_color = vec3(0.05f * static_cast<float>(i));
        return set;
    });
    measure(scene, *prepared, "all layers of a principled material", [&](int i) {
        SetMaterial set{{0}, scene.materials[0]};
        set.value.kind = material_principled;
        set.value.principled.roughness = 0.05f * static_cast<float>(i);
        set.value.principled.anisotropy = 0.5f;
        return set;
    });
    measure(scene, *prepared, "light added and removed", [&](int i) {
        return i % 2 == 0 ? Edit(AddLight{0, LightDesc{}}) : Edit(RemoveLight{0});
    });
    measure(scene, *prepared, "light's colour", [&](int i) {
        if (scene.lights.empty()) return Edit(AddLight{0, LightDesc{}});
        SetLight set{0, scene.lights[0]};
        set.value.emission = vec3(static_cast<float>(i));
        return Edit(set);
    });
    Image sky{"sky", 2048, 1024, texels_rgba32f, {}, std::vector<float>(std::size_t{4} * 2048 * 1024, 0.5f)};
    const auto shared = std::make_shared<const Image>(std::move(sky));
    measure(scene, *prepared, "picture of 2048 x 1024 added", [&](int) { return AddImage{shared}; });
    measure(scene, *prepared, "environment's picture", [&](int i) {
        SetEnvironment set{scene.environment};
        set.value.radiance = vec3(1.0f);
        set.value.image = {static_cast<uint>(scene.images.size()) - 1u - static_cast<uint>(i % 2)};
        return set;
    });
    measure(scene, *prepared, "environment's colour", [&](int i) {
        SetEnvironment set{scene.environment};
        set.value.radiance = vec3(0.1f * static_cast<float>(i), 0.2f, 0.3f);
        return set;
    });
    measure(scene, *prepared, "environment's rotation", [&](int i) {
        SetEnvironment set{scene.environment};
        set.value.to_world = rotation(vec3(0, 1, 0), 5.0f * static_cast<float>(i));
        return set;
    });
    const uint largest = find_instance(scene, true), smallest = find_instance(scene, false);
    move_instance(scene, *prepared, "group", largest);
    if (smallest != largest) move_instance(scene, *prepared, "small group", smallest);
    measure(scene, *prepared, "emission of a material, on", [&](int i) {
        SetMaterial set{{0}, scene.materials[0]};
        set.value.emission = vec3(0.1f * static_cast<float>(i));
        return set;
    });
    measure(scene, *prepared, "name", [&](int) { return Rename{ScenePart::material, 0, "x"}; });
}

} // namespace

int main(int argc, char** argv)
{
    if (argc < 2) {
        fmt::print(stderr, "usage: bench_edit SCENE...\n");
        return 2;
    }
    try {
        for (int i = 1; i < argc; ++i) run(argv[i]);
    } catch (const Error& error) {
        fmt::print(stderr, "{}\n", error.what());
        return 1;
    }
    return 0;
}
