// What the tests of the cache build trees of.
#pragma once

#include "snell/bvh/primitives.h"
#include "tests/bvh/scenes.h"

namespace snell::test {

inline PackedScene soup(int count, uint seed = 1)
{
    Random random(seed);
    PackedScene scene;
    add_soup(scene, random, count, 0.2f);
    end_world(scene);
    return scene;
}

// Triangles, spheres and instances.
inline PackedScene mixture(std::vector<PrimitiveRef>& refs)
{
    Random random(2);
    PackedScene scene;
    add_soup(scene, random, 10, 0.3f);
    end_group(scene);
    add_soup(scene, random, 300, 0.3f);
    add_cloud(scene, random, 100, 0.1f);
    end_world(scene);
    for (int i = 0; i < 50; ++i)
        add_instance(scene, 0, compose(translation(2.0f * random.in_box(1.0f)), scaling(vec3(0.1f))));
    refs = collect_primitives(scene, scene.world);
    collect_instances(scene, {Box{vec3(-1.3f), vec3(1.3f)}}, refs);
    return scene;
}

} // namespace snell::test
