// What the inspector shows of trees is what rays meet: the walk in plain code has the hits and the steps of traversal.
#include "snell/lab/bvh_probe.h"

#include "snell/scene/builtin.h"
#include "tests/render/scenes.h"

#include <random>
#include <set>

namespace snell::test {
namespace {

std::vector<std::pair<std::string, Scene>> scenes()
{
    std::vector<std::pair<std::string, Scene>> all = {{"mixed", mixed_scene()},
                                                      {"cornell", *make_builtin_scene("cornell")},
                                                      {"sphereflake", make_sphereflake(4)}, // of instances
                                                      {"menger", make_menger(2)},
                                                      {"field", make_field(20'000)}};
    for (auto& [name, scene] : all) {
        validate(scene);
        complete(scene, 1.0f);
    }
    return all;
}

RenderSettings settings_of(const std::string& accel)
{
    RenderSettings settings;
    settings.width = settings.height = 64;
    settings.accel = accel;
    return settings;
}

std::vector<Ray> rays_of(const Prepared& prepared)
{
    const ViewRays view = make_view_rays(prepared, prepared.camera, settings_of(""), 4096);
    std::vector<Ray> rays = view.camera;
    rays.insert(rays.end(), view.bounce.begin(), view.bounce.end());
    std::mt19937 random(3);
    const auto number = [&] { return static_cast<float>(random() >> 8) * 0x1p-23f - 1.0f; };
    for (int i = 0; i < 1000; ++i) { // along axes as well, and short ones
        const vec3 direction = i % 3 == 0 ? vec3(0, i % 2 ? 1 : -1, 0) : vec3(number(), number(), number());
        const vec3 origin = prepared.packed.center + prepared.packed.radius * vec3(number(), number(), number());
        rays.push_back(make_ray(origin, direction, i % 5 == 0 ? prepared.packed.radius : infinity()));
    }
    rays.push_back(make_ray(vec3(0.0f), vec3(0.0f), 1.0f)); // of no direction
    return rays;
}

TEST(BvhProbe, WalksAreTraversals)
{
    for (const auto& [name, scene] : scenes())
        for (const char* accel : {"bvh8", "bvh8q", "bvh4", "bvh2"}) {
            SCOPED_TRACE(name + " " + accel);
            const auto prepared = prepare(scene, settings_of(accel));
            const Inspectable* trees = find_trees(*prepared->accel);
            ASSERT_NE(trees, nullptr);
            const std::vector<Ray> rays = rays_of(*prepared);
            std::vector<Hit> hits(rays.size());
            std::vector<uint> steps(rays.size());
            prepared->accel->intersect_counted(rays, hits, steps);
            std::size_t other_steps = 0, found = 0;
            for (std::size_t i = 0; i < rays.size(); ++i) {
                const RayWalk walk = trees->walk(rays[i]);
                ASSERT_EQ(std::memcmp(&walk.hit, &hits[i], sizeof(Hit)), 0) << "ray " << i;
                found += is_hit(walk.hit);
                other_steps += walk.counted != steps[i];
                uint counted = 0, met = 0;
                float best = rays[i].t_max;
                for (const WalkStep& step : walk.steps) {
                    EXPECT_LE(step.best, best); // the nearest hit comes nearer
                    best = step.best;
                    EXPECT_LE(step.met, step.tested);
                    if (step.what == WalkStep::What::node) counted += 1;
                    if (step.what == WalkStep::What::leaf || step.what == WalkStep::What::planes)
                        counted += step.tested;
                    if (step.what == WalkStep::What::leaf || step.what == WalkStep::What::planes) met += step.met;
                    if (step.what == WalkStep::What::node || step.what == WalkStep::What::leaf) {
                        EXPECT_LE(step.enter, step.leave);
                    }
                    if (step.what == WalkStep::What::skipped) {
                        EXPECT_GT(step.enter, step.best * 0.999999f);
                    }
                }
                EXPECT_EQ(counted, walk.counted);
                EXPECT_EQ(met > 0, is_hit(walk.hit));
            }
            EXPECT_GT(found, 1000u);
            EXPECT_LE(other_steps, rays.size() / 500); // where no fused multiply-add rounds the slabs alike
        }
}

TEST(BvhProbe, TreesHoldTheScene)
{
    for (const auto& [name, scene] : scenes())
        for (const char* accel : {"bvh8", "bvh8q", "bvh4", "bvh2"}) {
            SCOPED_TRACE(name + " " + accel);
            const auto prepared = prepare(scene, settings_of(accel));
            const std::vector<TreeView> trees = find_trees(*prepared->accel)->trees();
            ASSERT_EQ(trees.size(), 2 + prepared->packed.groups.size());
            std::size_t nodes = 0, leaves = 0, primitives = 0;
            for (const TreeView& tree : trees) {
                const TreeFigures figures = measure_tree(tree);
                nodes += figures.nodes;
                leaves += figures.leaves;
                primitives += figures.primitives;
                std::vector<uint> children(tree.nodes.size(), 0);
                for (std::size_t i = 0; i < tree.nodes.size(); ++i) {
                    const TreeNode& node = tree.nodes[i];
                    if (i == 0) {
                        EXPECT_EQ(node.parent, none);
                        continue;
                    }
                    ASSERT_LT(node.parent, i);
                    const TreeNode& parent = tree.nodes[node.parent];
                    EXPECT_EQ(node.depth, parent.depth + 1);
                    ++children[node.parent];
                    // a grid of 8 bits sticks out of the parent's box by less than a cell
                    const vec3 slack = 0.01f * parent.box.extent() + vec3(1e-5f);
                    for (int axis = 0; axis < 3; ++axis) {
                        EXPECT_GE(node.box.lower[axis], parent.box.lower[axis] - slack[axis]);
                        EXPECT_LE(node.box.upper[axis], parent.box.upper[axis] + slack[axis]);
                    }
                }
                for (std::size_t i = 0; i < tree.nodes.size(); ++i) EXPECT_EQ(children[i], tree.nodes[i].children);
                if (!tree.nodes.empty()) {
                    EXPECT_DOUBLE_EQ(figures.levels.at(0).area, 1.0);
                }
                std::size_t in_levels = 0;
                for (const LevelFigures& level : figures.levels) in_levels += level.nodes + level.leaves;
                EXPECT_EQ(in_levels, tree.nodes.size());
            }
            EXPECT_EQ(nodes, prepared->accel->stats.nodes);
            EXPECT_EQ(leaves, prepared->accel->stats.leaves);
            EXPECT_GE(primitives, prepared->packed.triangles.size() + prepared->packed.spheres.size());
            // An inner node of a walk is one of the list, with the same box.
            std::set<std::pair<uint, ChildWord>> known;
            for (uint t = 0; t < trees.size(); ++t)
                for (const TreeNode& node : trees[t].nodes) known.insert({t, node.word});
            for (const Ray& ray : rays_of(*prepared))
                for (const WalkStep& step : find_trees(*prepared->accel)->walk(ray).steps)
                    if (step.what == WalkStep::What::node || step.what == WalkStep::What::leaf) {
                        ASSERT_TRUE(known.contains({step.tree, step.word}));
                    }
        }
}

TEST(BvhProbe, SomeStructuresHaveNoTrees)
{
    const auto prepared = prepare(mixed_scene(), settings_of("brute"));
    EXPECT_EQ(find_trees(*prepared->accel), nullptr);
}

TEST(BvhProbe, CornersOfBoxes)
{
    const Transform moved = translation(vec3(10, 0, 0));
    const std::array<vec3, 8> corners = box_corners({vec3(1, 2, 3), vec3(4, 5, 6)}, &moved);
    EXPECT_EQ(corners[0], vec3(11, 2, 3));
    EXPECT_EQ(corners[5], vec3(14, 2, 6));
}

TEST(BvhProbe, StructuresAreMeasured)
{
    Scene scene = make_field(20'000);
    validate(scene);
    complete(scene, 1.0f);
    const auto prepared = prepare(scene, settings_of(""));
    const ViewRays rays = make_view_rays(*prepared, prepared->camera, settings_of(""), 4096);
    EXPECT_EQ(rays.camera.size(), 4096u);
    EXPECT_GT(rays.bounce.size(), 500u);
    const StructureFigures good = measure_structure(*prepared, "bvh8", "sweep", rays, 0.0);
    const StructureFigures poor = measure_structure(*prepared, "bvh8", "median", rays, 0.0);
    EXPECT_GT(good.speed.camera, 0.0);
    EXPECT_GT(good.speed.bounce, 0.0);
    EXPECT_GT(good.build_seconds, 0.0);
    EXPECT_TRUE(good.has_epo);
    EXPECT_LT(good.quality.sum.sah, poor.quality.sum.sah);
    EXPECT_LT(good.stats.sah_cost, poor.stats.sah_cost);
    EXPECT_FALSE(measure_structure(*prepared, "brute", "", rays, 0.0).has_quality);
    EXPECT_THROW(measure_structure(*prepared, "bvh9", "", rays, 0.0), Error);
    EXPECT_THROW(measure_structure(*prepared, "bvh8", "nobody", rays, 0.0), Error);
}

} // namespace
} // namespace snell::test
