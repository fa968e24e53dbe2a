// Spatial splits: nothing is lost where triangles are cut, and what the cuts cost and bring.
#include "snell/bvh/build.h"
#include "snell/bvh/clip.h"
#include "snell/bvh/primitives.h"
#include "snell/core/parallel.h"
#include "snell/io/load.h"
#include "tests/bvh/scenes.h"
#include "tests/bvh/tree_checks.h"

#include <gtest/gtest.h>

#include <array>
#include <cstdio>
#include <cstring>
#include <filesystem>

namespace snell::test {
namespace {

BuildOptions with_budget(double budget)
{
    BuildOptions options;
    options.builder = "sbvh";
    options.split_budget = budget;
    return options;
}

// Needles through the whole cube, in any direction: what object splits can do least with.
void add_needles(PackedScene& scene, Random& random, int count)
{
    for (int i = 0; i < count; ++i) {
        const vec3 a = random.in_box(1.0f), b = random.in_box(1.0f);
        add_triangle(scene, a, b, b + random.in_box(0.01f));
    }
}

PackedScene needles(int count, uint seed = 51)
{
    Random random(seed);
    PackedScene scene;
    add_needles(scene, random, count);
    end_world(scene);
    return scene;
}

// A closed drum of slats from top to bottom, many times as long as wide, leaning, so that their boxes overlap.
PackedScene drum(int slats)
{
    PackedScene scene;
    const auto rim = [&](int i, float z) {
        const float angle = 6.2831853f * static_cast<float>(i % slats) / static_cast<float>(slats);
        return vec3(std::cos(angle) + 0.2f * z, std::sin(angle) + 0.3f * z, z);
    };
    for (int i = 0; i < slats; ++i) {
        add_triangle(scene, rim(i, -3), rim(i + 1, -3), rim(i, 3));
        add_triangle(scene, rim(i + 1, -3), rim(i + 1, 3), rim(i, 3));
        add_triangle(scene, rim(i, -3), rim(i + 1, -3), vec3(-0.6f, -0.9f, -3));
        add_triangle(scene, rim(i, 3), rim(i + 1, 3), vec3(0.6f, 0.9f, 3));
    }
    end_world(scene);
    return scene;
}

// ---- cuts ----

using Point = std::array<long double, 3>;

bool is_in(const Box& box, const Point& p, long double slack)
{
    for (std::size_t k = 0; k < 3; ++k) {
        const int axis = static_cast<int>(k);
        if (p[k] < box.lower[axis] - slack || p[k] > box.upper[axis] + slack) return false;
    }
    return true;
}

// Where the triangle's edges cross the plane.
std::vector<Point> crossings(const vec3 (&v)[3], int axis, float plane)
{
    std::vector<Point> points;
    for (int i = 0; i < 3; ++i) {
        const vec3 &a = v[i], &b = v[(i + 1) % 3];
        if (!(std::min(a[axis], b[axis]) < plane && std::max(a[axis], b[axis]) > plane)) continue;
        const long double from = a[axis], to = b[axis], t = (plane - from) / (to - from);
        Point& p = points.emplace_back();
        for (std::size_t k = 0; k < 3; ++k) {
            const long double x = a[static_cast<int>(k)], y = b[static_cast<int>(k)];
            p[k] = x + t * (y - x);
        }
    }
    return points;
}

long double reach(const vec3 (&v)[3])
{
    return max3(max(abs(v[0]), max(abs(v[1]), abs(v[2]))));
}

// Both boxes hold the points of the plane exactly, not only to within a rounding, and are hardly larger.
TEST(CutTriangle, IsRoundedOutwards)
{
    Random random(50);
    int cuts = 0;
    for (int i = 0; i < 60'000; ++i) {
        const float scale = i % 3 == 0 ? std::exp2(random.range(-100.0f, 100.0f)) : 1.0f;
        const vec3 offset = i % 5 == 0 ? 1e9f * random.in_box(1.0f) : vec3(0.0f);
        vec3 v[3];
        for (vec3& p : v) p = scale * random.in_box(1.0f) + offset;
        const int axis = i % 3;
        const float low = std::min(v[0][axis], std::min(v[1][axis], v[2][axis]));
        const float high = std::max(v[0][axis], std::max(v[1][axis], v[2][axis]));
        const float plane = low + random.uniform() * (high - low);
        const CutBoxes cut = cut_triangle(v, axis, plane);
        for (const vec3& p : v) {
            const Point exact = {p.x, p.y, p.z};
            ASSERT_TRUE(p[axis] > plane || is_in(cut.below, exact, 0));
            ASSERT_TRUE(p[axis] < plane || is_in(cut.above, exact, 0));
        }
        const long double noise = reach(v) * 0x1p-60L; // of the exact points themselves
        Box tight[2];
        for (const Point& p : crossings(v, axis, plane)) {
            ++cuts;
            ASSERT_TRUE(is_in(cut.below, p, noise)) << i;
            ASSERT_TRUE(is_in(cut.above, p, noise)) << i;
            for (Box& box : tight) box.extend(vec3(float(p[0]), float(p[1]), float(p[2])));
        }
        for (const vec3& p : v) {
            if (p[axis] <= plane) tight[0].extend(p);
            if (p[axis] >= plane) tight[1].extend(p);
        }
        if (low >= plane || high <= plane) continue;
        const vec3 near = vec3(static_cast<float>(reach(v)) * 0x1p-22f);
        for (int k = 0; k < 3; ++k) {
            ASSERT_GE(cut.below.lower[k], tight[0].lower[k] - near[k]);
            ASSERT_LE(cut.below.upper[k], tight[0].upper[k] + near[k]);
            ASSERT_GE(cut.above.lower[k], tight[1].lower[k] - near[k]);
            ASSERT_LE(cut.above.upper[k], tight[1].upper[k] + near[k]);
        }
    }
    EXPECT_GT(cuts, 80'000);
}

TEST(CutTriangle, BesideOrWithinThePlane)
{
    const vec3 v[3] = {{0, 0, 0}, {0, 1, 0}, {0, 0, 1}};
    EXPECT_TRUE(cut_triangle(v, 0, 1.0f).above.empty());
    EXPECT_TRUE(cut_triangle(v, 0, -1.0f).below.empty());
    const CutBoxes within = cut_triangle(v, 0, 0.0f);
    EXPECT_EQ(within.below.upper, vec3(0, 1, 1));
    EXPECT_EQ(within.above.upper, vec3(0, 1, 1));
    const vec3 huge[3] = {{-3e38f, 0, -3e38f}, {3e38f, 0, 3e38f}, {3e38f, 1, -3e38f}};
    const CutBoxes halves = cut_triangle(huge, 0, 0.0f);
    EXPECT_EQ(halves.below.upper.x, 0.0f);
    EXPECT_EQ(halves.above.lower.x, 0.0f);
    EXPECT_EQ(halves.below.lower.z, -3e38f);
    EXPECT_NEAR(halves.below.upper.z, 0.0f, 1e25f); // of 3e38
}

// ---- trees ----

// What a tree with cut triangles keeps to: every point of every triangle lies in a leaf that holds the triangle.
// Points: random ones, and those where edges cross the sides of leaves, for there the cuts were.
void expect_covering_tree(const PackedScene& scene, const std::vector<PrimitiveRef>& refs, const BinaryTree& tree)
{
    ASSERT_EQ(tree.nodes.empty(), refs.empty());
    ASSERT_LE(tree_depth(tree), max_tree_depth);
    std::map<std::pair<RefKind, uint>, std::vector<Box>> leaves;
    std::vector<uint> parents(tree.nodes.size());
    uint next_entry = 0;
    for (uint i = 0; i < tree.nodes.size(); ++i) {
        const BinaryNode& node = tree.nodes[i];
        if (node.count == 0) {
            ASSERT_GT(node.link, i + 1);
            ASSERT_LT(node.link, tree.nodes.size());
            ++parents[i + 1];
            ++parents[node.link];
            Box below = tree.nodes[i + 1].box;
            below.extend(tree.nodes[node.link].box);
            ASSERT_EQ(below.lower, node.box.lower);
            ASSERT_EQ(below.upper, node.box.upper);
            continue;
        }
        ASSERT_EQ(node.link, next_entry);
        next_entry += node.count;
        ASSERT_LE(next_entry, tree.order.size());
        ASSERT_LE(node.count, max_leaf_size);
        const RefKind kind = tree.order[node.link].kind;
        ASSERT_TRUE(kind != RefKind::instance || node.count == 1);
        for (uint j = node.link; j < node.link + node.count; ++j) {
            ASSERT_EQ(tree.order[j].kind, kind);
            for (uint k = node.link; k < j; ++k) ASSERT_NE(tree.order[j].index, tree.order[k].index) << "twice";
            leaves[{kind, tree.order[j].index}].push_back(node.box);
        }
    }
    for (uint i = 1; i < tree.nodes.size(); ++i) ASSERT_EQ(parents[i], 1u) << i;
    ASSERT_EQ(next_entry, tree.order.size());
    ASSERT_EQ(leaves.size(), refs.size());

    Random random(52);
    for (const PrimitiveRef& ref : refs) {
        const std::vector<Box>& boxes = leaves[{ref.kind, ref.index}];
        ASSERT_FALSE(boxes.empty());
        if (ref.kind != RefKind::triangle) {
            ASSERT_EQ(boxes.size(), 1u);
            ASSERT_EQ(min(boxes[0].lower, ref.lower), boxes[0].lower);
            ASSERT_EQ(max(boxes[0].upper, ref.upper), boxes[0].upper);
            continue;
        }
        const Triangle& tri = scene.triangles[ref.index];
        const vec3 v[3] = {scene.positions[tri.v0], scene.positions[tri.v1], scene.positions[tri.v2]};
        std::vector<Point> points;
        for (int i = 0; i < 4; ++i) {
            const long double a = random.uniform(), b = (1 - a) * random.uniform(), c = 1 - a - b;
            Point& p = points.emplace_back();
            for (std::size_t k = 0; k < 3; ++k) {
                const int axis = static_cast<int>(k);
                p[k] = a * v[0][axis] + b * v[1][axis] + c * v[2][axis];
            }
        }
        for (const vec3& p : v) points.push_back({p.x, p.y, p.z});
        for (const Box& box : boxes)
            for (int axis = 0; axis < 3; ++axis)
                for (const float plane : {box.lower[axis], box.upper[axis]})
                    for (const Point& p : crossings(v, axis, plane)) points.push_back(p);
        const long double noise = reach(v) * 0x1p-60L;
        for (const Point& p : points)
            ASSERT_TRUE(std::any_of(boxes.begin(), boxes.end(), [&](const Box& box) { return is_in(box, p, noise); }))
                << "triangle " << ref.index << " in " << boxes.size() << " leaves: " << double(p[0]) << " "
                << double(p[1]) << " " << double(p[2]);
    }
}

// Budgets are kept to, and used.
TEST(Sbvh, KeepsToItsBudget)
{
    const PackedScene scene = needles(3000);
    const std::vector<PrimitiveRef> refs = collect_primitives(scene, scene.world);
    std::size_t before = refs.size();
    for (const double budget : {0.0, 0.1, 0.3, 3.0}) {
        SCOPED_TRACE(budget);
        const BinaryTree tree = build_sbvh(scene, refs, with_budget(budget));
        expect_covering_tree(scene, refs, tree);
        EXPECT_LE(static_cast<double>(tree.order.size()), (1 + budget) * static_cast<double>(refs.size()));
        EXPECT_GE(static_cast<double>(tree.order.size()),
                  (1 + 0.7 * std::min(budget, 0.3)) * static_cast<double>(refs.size()));
        EXPECT_GE(tree.order.size(), before);
        before = tree.order.size();
    }
}

TEST(Sbvh, SmallSets)
{
    for (int count = 0; count < 40; ++count) {
        SCOPED_TRACE(count);
        Random random(53);
        PackedScene scene;
        add_needles(scene, random, count);
        add_cloud(scene, random, count / 3, 0.5f);
        end_world(scene);
        const std::vector<PrimitiveRef> refs = collect_primitives(scene, scene.world);
        expect_covering_tree(scene, refs, build_sbvh(scene, refs, with_budget(1)));
    }
}

// More than two chunks of references that are cut, so that the passes of several threads are used.
TEST(Sbvh, IsTheSameForAnyNumberOfThreads)
{
    const PackedScene scene = needles(70'000);
    const std::vector<PrimitiveRef> refs = collect_primitives(scene, scene.world);
    set_thread_count(1);
    const BinaryTree one = build_sbvh(scene, refs, with_budget(0.3));
    EXPECT_GT(one.order.size(), refs.size() + refs.size() / 5);
    for (const int threads : {2, 5, 16}) {
        set_thread_count(threads);
        EXPECT_TRUE(same_tree(one, build_sbvh(scene, refs, with_budget(0.3)))) << threads;
    }
    set_thread_count(0);
    EXPECT_LE(one.order.size(), refs.size() + refs.size() * 3 / 10);
    expect_covering_tree(scene, refs, one);
}

// The same without a budget as the binned builder, to within what differs between the two.
TEST(Sbvh, CostsLessWhereTrianglesAreLong)
{
    const PackedScene scene = drum(1000);
    const std::vector<PrimitiveRef> refs = collect_primitives(scene, scene.world);
    const double binned = tree_cost(build_binned_sah(scene, refs, {}));
    EXPECT_LT(tree_cost(build_sbvh(scene, refs, with_budget(1))), 0.6 * binned);
    EXPECT_LT(tree_cost(build_sbvh(scene, refs, with_budget(0.25))), 0.9 * binned);
    EXPECT_LT(tree_cost(build_sbvh(scene, refs, with_budget(0))), 1.05 * binned);
}

// ---- hits ----

void expect_hits_of_brute_force(const PackedScene& scene, const std::vector<Ray>& rays)
{
    std::vector<Hit> expected(rays.size()), hits(rays.size());
    std::vector<std::uint8_t> blocked(rays.size());
    find_accel("brute")->make(scene, {})->intersect(rays, expected);
    AccelOptions options;
    options.build = with_budget(1);
    const auto accel = find_accel("bvh8")->make(scene, options);
    accel->intersect(rays, hits);
    accel->occluded(rays, blocked);
    int wrong = 0;
    for (std::size_t i = 0; i < rays.size() && wrong < 3; ++i) {
        if (std::memcmp(&hits[i], &expected[i], sizeof(Hit)) == 0 && blocked[i] == (is_hit(expected[i]) ? 1 : 0))
            continue;
        ++wrong;
        ADD_FAILURE() << "ray " << i << ": t " << hits[i].t << " primitive " << hits[i].primitive << " blocked "
                      << int(blocked[i]) << ", expected " << expected[i].t << " " << expected[i].primitive;
    }
}

std::vector<Ray> rays_for(const PackedScene& scene, Random& random, int count)
{
    std::vector<Ray> rays = random_rays(random, count);
    const std::vector<Ray> hostile = hostile_rays(scene, random);
    rays.insert(rays.end(), hostile.begin(), hostile.end());
    return rays;
}

TEST(Sbvh, HitsOfNeedles)
{
    const PackedScene scene = needles(3000, 54);
    Random random(55);
    expect_hits_of_brute_force(scene, rays_for(scene, random, 2000));
}

TEST(Sbvh, HitsOfGridsAndWalls)
{
    Random random(56);
    PackedScene scene;
    add_grid(scene, 12, 0.25f);
    add_grid(scene, 1, 0.0f);
    add_grid(scene, 1, -0.5f);
    for (int i = 0; i < 40; ++i) { // walls along the axes, in planes that spatial splits like
        const float x = random.range(-1.0f, 1.0f);
        add_triangle(scene, vec3(x, -1, -1), vec3(x, 1, -1), vec3(x, 1, 1));
        add_triangle(scene, vec3(-1, x, -1), vec3(1, x, 1), vec3(-1, x, 1));
    }
    add_soup(scene, random, 500, 0.02f);
    end_world(scene);
    expect_hits_of_brute_force(scene, rays_for(scene, random, 2000));
}

TEST(Sbvh, HitsOfAllKinds)
{
    Random random(57);
    PackedScene scene;
    add_needles(scene, random, 300);
    add_cloud(scene, random, 50, 0.2f);
    end_group(scene);
    add_needles(scene, random, 500);
    add_soup(scene, random, 500, 0.3f);
    add_cloud(scene, random, 200, 0.3f);
    end_world(scene);
    for (int i = 0; i < 30; ++i) add_instance(scene, 0, translation(random.in_box(1.0f)));
    expect_hits_of_brute_force(scene, rays_for(scene, random, 2000));
}

// Meshes that builders stumble over: duplicates, no area, all centres in one place, far away, of all sizes at once.
std::vector<PackedScene> hostile_meshes()
{
    std::vector<PackedScene> scenes(6);
    Random random(58);
    for (int i = 0; i < 500; ++i) add_triangle(scenes[0], vec3(-1, 0, 0.1f), vec3(1, 0.3f, 0), vec3(0, 1, 1));
    for (int i = 0; i < 500; ++i) {
        const vec3 a = random.in_box(1.0f), b = random.in_box(1.0f);
        add_triangle(scenes[1], a, i % 2 == 0 ? a : b, i % 3 == 0 ? a : b); // points and lines
        add_triangle(scenes[1], a, b, b + vec3(0, 0, 1e-7f));
    }
    for (int i = 0; i < 500; ++i) {
        const vec3 a = random.in_box(1.0f);
        add_triangle(scenes[2], a, -a, vec3(a.y, a.z, -a.x) * 0.5f); // centres close together, all overlap
    }
    for (int i = 0; i < 500; ++i) {
        const vec3 at = vec3(1e9f, -1e9f, 1e9f) + 1e4f * random.in_box(1.0f);
        add_triangle(scenes[3], at, at + 1e4f * random.in_box(1.0f), at + 1e4f * random.in_box(1.0f));
    }
    for (int i = 0; i < 500; ++i) {
        const float size = std::exp2(random.range(-120.0f, 120.0f));
        add_triangle(scenes[4], size * random.in_box(1.0f), size * random.in_box(1.0f), size * random.in_box(1.0f));
    }
    for (int i = 0; i < 500; ++i)
        add_triangle(scenes[5], 3e38f * random.in_box(1.0f), 3e38f * random.in_box(1.0f), random.in_box(1e-40f));
    for (PackedScene& scene : scenes) end_world(scene);
    return scenes;
}

TEST(Sbvh, HostileMeshesAreCovered)
{
    int number = 0;
    for (const PackedScene& scene : hostile_meshes()) {
        SCOPED_TRACE(number++);
        const std::vector<PrimitiveRef> refs = collect_primitives(scene, scene.world);
        for (const double budget : {0.25, 4.0})
            expect_covering_tree(scene, refs, build_sbvh(scene, refs, with_budget(budget)));
    }
}

TEST(Sbvh, HitsOfHostileMeshes)
{
    Random random(59);
    int number = 0;
    for (const PackedScene& scene : hostile_meshes()) {
        if (number == 4) break; // sizes that the ray tests themselves cannot cope with
        SCOPED_TRACE(number++);
        std::vector<Ray> rays = rays_for(scene, random, 500);
        for (const Ray& ray : random_rays(random, 500, 1e4f, vec3(1e9f, -1e9f, 1e9f))) rays.push_back(ray);
        expect_hits_of_brute_force(scene, rays);
    }
}

// Rays from inside a drum, at the places where the planes of cuts meet the slats' common edges, must not get out.
TEST(Sbvh, NoRayLeavesThroughACut)
{
    const PackedScene scene = drum(400);
    const std::vector<PrimitiveRef> refs = collect_primitives(scene, scene.world);
    const BinaryTree tree = build_sbvh(scene, refs, with_budget(2));
    ASSERT_GT(tree.order.size(), refs.size() * 3 / 2);

    Random random(60);
    std::vector<Ray> rays;
    for (const BinaryNode& node : tree.nodes) {
        if (node.count == 0) continue;
        for (uint i = 0; i < node.count; ++i) {
            const Triangle& tri = scene.triangles[tree.order[node.link + i].index];
            const vec3 v[3] = {scene.positions[tri.v0], scene.positions[tri.v1], scene.positions[tri.v2]};
            for (int axis = 0; axis < 3; ++axis)
                for (const float plane : {node.box.lower[axis], node.box.upper[axis]})
                    for (const Point& p : crossings(v, axis, plane))
                        rays.push_back(ray_between(random.in_box(0.2f), vec3(float(p[0]), float(p[1]), float(p[2]))));
        }
    }
    ASSERT_GT(rays.size(), 5000u);
    AccelOptions options;
    options.build = with_budget(2);
    const auto accel = find_accel("bvh8")->make(scene, options);
    std::vector<Hit> hits(rays.size());
    std::vector<std::uint8_t> blocked(rays.size());
    accel->intersect(rays, hits);
    accel->occluded(rays, blocked);
    for (std::size_t i = 0; i < rays.size(); ++i) {
        ASSERT_TRUE(is_hit(hits[i])) << i;
        ASSERT_EQ(blocked[i], 1) << i;
    }
    rays.resize(3000);
    expect_hits_of_brute_force(scene, rays);
}

TEST(Sbvh, RealMeshes)
{
    const std::filesystem::path folder = std::filesystem::path(SNELL_SOURCE_DIR) / ".." / "shared" / "scenes" / "mesh";
    const std::filesystem::path file = folder / "sponza_dabrovic" / "sponza.obj";
    if (!std::filesystem::exists(file)) {
        std::printf("left out: sponza_dabrovic/sponza.obj is not here\n");
        return;
    }
    const PackedScene scene = pack(load_scene(file));
    const std::vector<PrimitiveRef> refs = collect_primitives(scene, scene.world);
    const BinaryTree tree = build_sbvh(scene, refs, with_budget(0.25));
    EXPECT_LT(tree_cost(tree), 0.85 * tree_cost(build_binned_sah(scene, refs, {})));
    EXPECT_LE(tree.order.size(), refs.size() + refs.size() / 4);
    expect_covering_tree(scene, refs, tree);
}

} // namespace
} // namespace snell::test
