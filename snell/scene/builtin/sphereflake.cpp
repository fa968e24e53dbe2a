// Haines 1987, A proposal for standard graphics environments: every sphere carries nine of a third of its size, six
// around its equator and three on top, like the upper vertices of a cuboctahedron.
#include "snell/core/error.h"
#include "snell/scene/builtin.h"
#include "snell/scene/builtin/makers.h"
#include "snell/scene/shapes.h"

#include <array>
#include <cmath>

namespace snell {

static constexpr int cluster_depth = 3; // levels below a cluster's root; 820 spheres

// A map from the unit sphere with axis +Y to one of its children with its axis outwards.
static std::array<Transform, 9> child_maps()
{
    std::array<Transform, 9> maps;
    for (uint i = 0; i < 9; ++i) {
        const bool equator = i < 6;
        const float polar = equator ? 90.0f : 35.264390f; // of (1,1,0) against (1,1,1)
        const float azimuth = equator ? 60.0f * static_cast<float>(i) : 30.0f + 120.0f * static_cast<float>(i - 6);
        const Transform outwards = compose(rotation({0, 1, 0}, azimuth), rotation({0, 0, 1}, -polar));
        maps[i] = compose(outwards, compose(translation({0, 1.0f + 1.0f / 3.0f, 0}), scaling(vec3(1.0f / 3.0f))));
    }
    return maps;
}

namespace {
struct Grower
{
    Scene& scene;
    std::array<Transform, 9> children;
    std::array<Index<MaterialDesc>, 3> materials;

    // Adds the spheres of `levels` generations below `map` to the group; calls tip(map) for each one of the next.
    template <class Tip>
    void grow(Group& group, const Transform& map, int generation, int levels, const Tip& tip)
    {
        if (levels == 0) {
            tip(map);
            return;
        }
        const vec3 center(map.x.w, map.y.w, map.z.w);
        const float radius = length(vec3(map.x.x, map.y.x, map.z.x));
        const auto material = materials[static_cast<std::size_t>(generation) % materials.size()];
        group.spheres.push_back(add(scene, SphereDesc{"", center, radius, material}));
        for (const Transform& child : children) grow(group, compose(map, child), generation + 1, levels - 1, tip);
    }
};
} // namespace

Scene make_sphereflake(int depth)
{
    if (depth < 0 || depth > sphereflake_deepest)
        throw Error(fmt::format("a sphereflake of depth {}", depth),
                    fmt::format("give a depth from 0 to {}", sphereflake_deepest));
    Scene scene;
    scene.name = "sphereflake";
    scene.environment.radiance = vec3(0.36f, 0.48f, 0.72f);
    const auto floor = add(scene, mix_of("polished floor", {0.22f, 0.20f, 0.18f}, vec3(0.16f), 0.0f));
    add(scene, PlaneDesc{"floor", {0, -1.0f, 0}, {0, 1, 0}, floor});
    Grower grower{scene,
                  child_maps(),
                  {add(scene, mix_of("silver", {0.10f, 0.11f, 0.13f}, {0.72f, 0.74f, 0.78f}, 0.0f)),
                   add(scene, mix_of("gold", {0.30f, 0.17f, 0.03f}, {0.60f, 0.42f, 0.16f}, 0.0f)),
                   add(scene, mix_of("steel", {0.05f, 0.10f, 0.17f}, {0.50f, 0.58f, 0.70f}, 0.0f))}};

    // The trunk is made of spheres in the world, the rest of placed clusters that share their spheres.
    const Transform upright = rotation({0, 1, 0}, 20.0f);
    Group trunk, cluster;
    trunk.name = "trunk";
    cluster.name = "cluster";
    if (depth <= cluster_depth) {
        grower.grow(trunk, upright, 0, depth + 1, [](const Transform&) {});
    } else {
        const int trunk_levels = depth - cluster_depth;
        grower.grow(cluster, identity_transform(), trunk_levels, cluster_depth + 1, [](const Transform&) {});
        const Index<Group> shared = add(scene, cluster);
        grower.grow(trunk, upright, 0, trunk_levels, [&](const Transform& map) {
            add(scene, InstanceDesc{"", shared, map});
        });
    }
    add(scene, InstanceDesc{"trunk", add(scene, trunk), identity_transform()});

    LightDesc sun;
    sun.name = "sun";
    sun.kind = light_directional;
    sun.direction = {0.75f, -1.0f, -0.65f};
    sun.emission = vec3(3.6f, 3.2f, 2.5f);
    add(scene, sun);
    add(scene, CameraDesc{"front", {0.5f, 2.1f, 6.1f}, {0.05f, 0.1f, 0.0f}, {0, 1, 0}, 34.0f});
    return scene;
}

} // namespace snell
