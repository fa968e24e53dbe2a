// Real meshes, when they are at hand: the tree against brute force on some of their rays.
#include "snell/io/load.h"
#include "tests/bvh/scenes.h"

#include <gtest/gtest.h>

#include <cstdio>
#include <cstring>
#include <filesystem>

namespace snell::test {
namespace {

TEST(BvhAgrees, RealMeshes)
{
    const std::filesystem::path folder = std::filesystem::path(SNELL_SOURCE_DIR) / ".." / "shared" / "scenes" / "mesh";
    for (const char* name : {"stanford_bunny/bun_zipper.ply", "cornell_box_mcguire/CornellBox-Original.obj",
                             "sponza_dabrovic/sponza.obj"}) {
        const std::filesystem::path file = folder / name;
        if (!std::filesystem::exists(file)) {
            std::printf("left out: %s is not here\n", name);
            continue;
        }
        SCOPED_TRACE(name);
        const Scene scene = load_scene(file);
        const Bounds bounds = scene_bounds(scene);
        const PackedScene packed = pack(scene);
        Random random(41);
        const float size = 0.5f * max3(bounds.extent());
        std::vector<Ray> rays = random_rays(random, 300, size, bounds.center());
        const std::vector<Ray> hostile = hostile_rays(packed, random);
        rays.insert(rays.end(), hostile.end() - 300, hostile.end()); // to vertices and edges of the mesh

        const std::vector<Ray> seen =
            camera_rays(bounds.center() + size * vec3(0.3f, 0.4f, 2.0f), bounds.center(), 0.7f * size, 5);

        for (const std::vector<Ray>& batch : {rays, seen}) {
            std::vector<Hit> expected(batch.size()), hits(batch.size());
            find_accel("brute")->make(packed, {})->intersect(batch, expected);
            std::size_t found = 0;
            for (const char* accel : {"bvh8", "bvh8q"}) {
                find_accel(accel)->make(packed, {})->intersect(batch, hits);
                for (std::size_t i = 0; i < batch.size(); ++i) {
                    found += is_hit(expected[i]);
                    EXPECT_EQ(std::memcmp(&hits[i], &expected[i], sizeof(Hit)), 0)
                        << accel << " ray " << i << ": t " << hits[i].t << " primitive " << hits[i].primitive
                        << ", expected " << expected[i].t << " primitive " << expected[i].primitive;
                }
            }
            EXPECT_GT(found, batch.size() / 3);
        }
    }
}

} // namespace
} // namespace snell::test
