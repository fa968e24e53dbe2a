// What every builder of the table keeps to, on friendly and hostile input (see snell/bvh/build.h).
#include "snell/bvh/primitives.h"
#include "snell/bvh/quality.h"
#include "snell/core/error.h"
#include "snell/core/parallel.h"
#include "snell/io/load.h"
#include "tests/bvh/scenes.h"

#include <gtest/gtest.h>

#include <cstdio>
#include <cstring>
#include <filesystem>
#include <functional>
#include <map>
#include <set>

namespace snell::test {
namespace {

constexpr uint seed = 34;

struct Input
{
    std::string name;
    PackedScene scene;
    std::vector<PrimitiveRef> refs;
};

Input finish(std::string name, PackedScene scene)
{
    std::vector<Box> boxes;
    for (const PackedGroup& group : scene.groups) {
        Box box;
        for (const PrimitiveRef& ref : collect_primitives(scene, group)) box.extend(Box{ref.lower, ref.upper});
        boxes.push_back(box);
    }
    std::vector<PrimitiveRef> refs = collect_primitives(scene, scene.world);
    collect_instances(scene, boxes, refs);
    return {std::move(name), std::move(scene), std::move(refs)};
}

Input make_input(const std::string& name, const std::function<void(PackedScene&, Random&)>& fill)
{
    PackedScene scene;
    Random random(seed);
    fill(scene, random);
    if (scene.world.triangle_count + scene.world.sphere_count == 0) end_world(scene);
    return finish(name, std::move(scene));
}

// A triangle with the given smallest and largest corner.
void add_between(PackedScene& scene, vec3 lower, vec3 upper)
{
    add_triangle(scene, lower, upper, vec3(lower.x, upper.y, upper.z));
}

std::vector<Input> inputs()
{
    std::vector<Input> all;
    const auto add = [&](const std::string& name, const std::function<void(PackedScene&, Random&)>& fill) {
        all.push_back(make_input(name, fill));
    };
    for (int count = 0; count <= 12; ++count)
        add(std::to_string(count) + " triangles", [=](PackedScene& s, Random& r) { add_soup(s, r, count, 0.3f); });
    add("one sphere", [](PackedScene& s, Random& r) { add_cloud(s, r, 1, 0.3f); });
    add("soup", [](PackedScene& s, Random& r) { add_soup(s, r, 20'000, 0.05f); });
    add("triangles and spheres", [](PackedScene& s, Random& r) {
        add_soup(s, r, 700, 0.2f);
        add_cloud(s, r, 800, 0.2f);
    });
    add("triangles, spheres and instances", [](PackedScene& s, Random& r) {
        add_soup(s, r, 10, 0.5f);
        end_group(s);
        add_soup(s, r, 300, 0.2f);
        add_cloud(s, r, 300, 0.2f);
        end_world(s);
        for (int i = 0; i < 400; ++i) add_instance(s, 0, translation(r.in_box(1.0f)));
    });
    add("instances in one place", [](PackedScene& s, Random& r) {
        add_soup(s, r, 3, 0.5f);
        end_group(s);
        add_soup(s, r, 3, 0.5f);
        end_world(s);
        for (int i = 0; i < 50; ++i) add_instance(s, 0, translation(vec3(0.0f)));
    });
    add("grid", [](PackedScene& s, Random&) { add_grid(s, 40, 0.0f); });
    add("duplicates", [](PackedScene& s, Random&) {
        for (int i = 0; i < 3000; ++i) add_triangle(s, vec3(0.0f), vec3(1.0f, 0.0f, 0.0f), vec3(0.0f, 1.0f, 0.5f));
    });
    add("all centres equal", [](PackedScene& s, Random&) {
        for (int i = 1; i <= 600; ++i) {
            const float size = static_cast<float>(i);
            add_between(s, vec3(-size), vec3(size));
            add_sphere(s, vec3(0.0f), size);
        }
    });
    add("points", [](PackedScene& s, Random& r) {
        for (int i = 0; i < 2000; ++i) {
            const vec3 p = r.in_box(1.0f);
            add_triangle(s, p, p, p);
        }
    });
    add("slivers", [](PackedScene& s, Random& r) {
        for (int i = 0; i < 2000; ++i) {
            const vec3 p = r.in_box(100.0f), d = r.direction();
            add_triangle(s, p, p + 100.0f * d, p + 100.0f * d + r.in_box(1e-4f));
        }
    });
    add("far away", [](PackedScene& s, Random& r) {
        add_soup(s, r, 2000, 1.0f, vec3(1e9f, -1e9f, 1e9f));
        add_soup(s, r, 2000, 1.0f, vec3(-1e9f, 1e9f, 1e9f));
    });
    add("one giant in a crowd", [](PackedScene& s, Random& r) {
        add_soup(s, r, 3000, 1e-3f);
        add_between(s, vec3(-1e9f), vec3(1e9f));
        add_triangle(s, vec3(3e9f), vec3(3e9f), vec3(3e9f));
    });
    // The heuristic peels off one at a time, again and again.
    add("doubling distances", [](PackedScene& s, Random&) {
        for (int i = 0; i < 20'000; ++i) {
            const float x = std::exp2(static_cast<float>(i % 240) - 120.0f) * (i % 2 ? 1.0f : -1.0f);
            add_between(s, vec3(x, 0.0f, 0.0f), vec3(x, 1.0f, 0.0f));
        }
    });
    add("as large as floats are", [](PackedScene& s, Random& r) {
        for (int i = 0; i < 1000; ++i) {
            const vec3 p = r.in_box(3e38f);
            add_triangle(s, p, r.in_box(3e38f), p);
            add_triangle(s, p, 0.99f * p, p);
        }
    });
    add("as small as floats are", [](PackedScene& s, Random& r) {
        for (int i = 0; i < 1000; ++i) add_triangle(s, r.in_box(1e-38f), r.in_box(1e-38f), r.in_box(1e-44f));
    });
    return all;
}

bool encloses(const Box& outer, const Box& inner)
{
    return all(lessThanEqual(outer.lower, inner.lower)) && all(greaterThanEqual(outer.upper, inner.upper));
}

using Name = std::pair<RefKind, uint>;

// Spatial splits repeat references and cut their boxes; all other builders make exact boxes around whole primitives.
struct Checker
{
    const Input& input;
    const BinaryTree& tree;
    const bool splits;
    std::map<Name, const PrimitiveRef*> refs = {};
    std::map<Name, std::vector<Box>> found = {}; // boxes of the leaves that hold it
    std::vector<int> depth = {};
    std::size_t entries = 0;

    void check()
    {
        if (input.refs.empty()) {
            EXPECT_TRUE(tree.nodes.empty() && tree.order.empty());
            return;
        }
        for (const PrimitiveRef& ref : input.refs) refs[{ref.kind, ref.index}] = &ref;
        ASSERT_FALSE(tree.nodes.empty());
        depth.assign(tree.nodes.size(), -1); // not a child of anything yet
        depth[0] = 0;
        for (uint i = 0; i < tree.nodes.size(); ++i) {
            ASSERT_GE(depth[i], 0) << "nobody's child: " << i;
            ASSERT_LE(depth[i], max_tree_depth);
            tree.nodes[i].count > 0 ? check_leaf(tree.nodes[i]) : check_inner(i);
            if (testing::Test::HasFatalFailure()) return;
        }
        ASSERT_EQ(entries, tree.order.size());
        ASSERT_EQ(found.size(), refs.size()) << "some are in no leaf";
        if (splits) return check_pieces();
        ASSERT_EQ(entries, refs.size()) << "some are in two leaves";
    }

    void check_leaf(const BinaryNode& node)
    {
        ASSERT_LE(node.count, max_leaf_size);
        ASSERT_LE(node.link + node.count, tree.order.size());
        entries += node.count;
        const RefKind kind = tree.order[node.link].kind;
        if (kind == RefKind::instance) {
            ASSERT_EQ(node.count, 1u);
        }
        Box whole;
        std::set<uint> inside;
        for (uint i = node.link; i < node.link + node.count; ++i) {
            ASSERT_EQ(tree.order[i].kind, kind);
            ASSERT_TRUE(inside.insert(tree.order[i].index).second) << "twice in a leaf";
            const auto ref = refs.find({kind, tree.order[i].index});
            ASSERT_NE(ref, refs.end()) << "an entry of nothing";
            whole.extend(Box{ref->second->lower, ref->second->upper});
            found[ref->first].push_back(node.box);
        }
        if (!splits) {
            ASSERT_TRUE(encloses(node.box, whole) && encloses(whole, node.box));
        }
    }

    void check_inner(uint i)
    {
        const BinaryNode& node = tree.nodes[i];
        ASSERT_GT(node.link, i + 1);
        ASSERT_LT(node.link, tree.nodes.size());
        Box whole;
        for (const uint child : {i + 1, node.link}) {
            ASSERT_LT(depth[child], 0) << "a child of two";
            depth[child] = depth[i] + 1;
            whole.extend(tree.nodes[child].box);
        }
        if (!splits) {
            ASSERT_TRUE(encloses(node.box, whole) && encloses(whole, node.box));
        }
    }

    // The corners of triangles are where no clipping moves them.
    void check_pieces()
    {
        for (const auto& [name, boxes] : found) {
            if (name.first != RefKind::triangle) continue;
            const Triangle& tri = input.scene.triangles[name.second];
            for (const uint corner : {tri.v0, tri.v1, tri.v2}) {
                const vec3 p = input.scene.positions[corner];
                bool covered = false;
                for (const Box& box : boxes) covered = covered || encloses(box, Box{p, p});
                ASSERT_TRUE(covered) << "a corner of triangle " << name.second;
            }
        }
    }
};

void expect_sound(const Input& input, const BuilderInfo& builder)
{
    const BinaryTree tree = builder.build(input.scene, input.refs, {});
    Checker{input, tree, builder.name == "sbvh" || builder.name == "auto"}.check();
}

TEST(Builders, KeepTheRules)
{
    for (const Input& input : inputs())
        for (const BuilderInfo& builder : builders()) {
            SCOPED_TRACE(std::string(builder.name) + ", " + input.name + ", seed " + std::to_string(seed));
            expect_sound(input, builder);
        }
}

TEST(Builders, KeepTheRulesOnARealMesh)
{
    const std::filesystem::path file =
        std::filesystem::path(SNELL_SOURCE_DIR) / ".." / "shared" / "scenes" / "mesh" / "sponza_dabrovic/sponza.obj";
    if (!std::filesystem::exists(file)) {
        std::printf("left out: sponza.obj is not here\n");
        return;
    }
    const Input input = finish("sponza", pack(load_scene(file)));
    for (const BuilderInfo& builder : builders()) {
        SCOPED_TRACE(builder.name);
        expect_sound(input, builder);
    }
}

bool same(const BinaryTree& a, const BinaryTree& b)
{
    static_assert(sizeof(BinaryNode) == 32 && sizeof(BinaryTree::Entry) == 8, "no padding, so bytes can be compared");
    return a.nodes.size() == b.nodes.size() && a.order.size() == b.order.size() &&
           std::memcmp(a.nodes.data(), b.nodes.data(), a.nodes.size() * sizeof(BinaryNode)) == 0 &&
           std::memcmp(a.order.data(), b.order.data(), a.order.size() * sizeof(BinaryTree::Entry)) == 0;
}

// So many that all passes run in parallel, and of three kinds.
TEST(Builders, AreTheSameForAnyNumberOfThreads)
{
    const Input input = make_input("many", [](PackedScene& s, Random& r) {
        add_soup(s, r, 10, 0.5f);
        end_group(s);
        add_soup(s, r, 70'000, 0.02f);
        add_cloud(s, r, 5000, 0.02f);
        end_world(s);
        for (int i = 0; i < 1000; ++i) add_instance(s, 0, translation(r.in_box(1.0f)));
    });
    for (const BuilderInfo& builder : builders()) {
        SCOPED_TRACE(builder.name);
        set_thread_count(1);
        const BinaryTree one = builder.build(input.scene, input.refs, {});
        Checker{input, one, builder.name == "sbvh" || builder.name == "auto"}.check();
        for (const int threads : {2, 5, 16}) {
            set_thread_count(threads);
            EXPECT_TRUE(same(one, builder.build(input.scene, input.refs, {}))) << threads << " threads";
        }
    }
    set_thread_count(0);
}

TEST(Builders, GiveTheHitsOfBruteForce)
{
    const Input input = make_input("mixed", [](PackedScene& s, Random& r) {
        add_soup(s, r, 40, 0.5f);
        add_cloud(s, r, 5, 0.3f);
        end_group(s);
        add_soup(s, r, 300, 0.4f);
        add_cloud(s, r, 50, 0.2f);
        end_world(s);
        for (int i = 0; i < 20; ++i) add_instance(s, 0, translation(r.in_box(1.0f)));
    });
    Random random(seed + 1);
    const std::vector<Ray> rays = random_rays(random, 2000);
    std::vector<Hit> expected(rays.size()), hits(rays.size());
    find_accel("brute")->make(input.scene, {})->intersect(rays, expected);
    for (const BuilderInfo& builder : builders()) {
        AccelOptions options;
        options.build.builder = builder.name;
        accels().front().make(input.scene, options)->intersect(rays, hits);
        for (std::size_t i = 0; i < rays.size(); ++i) {
            ASSERT_EQ(hits[i].t, expected[i].t) << builder.name << ", ray " << i << ", seed " << seed + 1;
            ASSERT_EQ(hits[i].primitive, expected[i].primitive) << builder.name << ", ray " << i;
        }
    }
}

double cost(const Input& input, std::string_view builder)
{
    return measure_quality(input.scene, find_builder(builder)->build(input.scene, input.refs, {}), false).sah;
}

// Triangles of very different sizes, unevenly strewn: where a good tree differs from a bad one.
TEST(Builders, AreAsGoodAsTheyShouldBe)
{
    const Input input = make_input("uneven", [](PackedScene& s, Random& r) {
        for (int i = 0; i < 30; ++i) add_soup(s, r, 2000, 0.5f / static_cast<float>(i + 1), 3.0f * r.in_box(1.0f));
    });
    const double reference = cost(input, "sweep");
    EXPECT_GT(reference, 10.0);
    EXPECT_LT(cost(input, "binned"), 1.04 * reference); // 1.02 with leaves of four, 1.03 with eight
    EXPECT_GT(cost(input, "median"), 1.05 * reference);
    for (const BuilderInfo& builder : builders()) EXPECT_LT(cost(input, builder.name), 2.0 * reference) << builder.name;
}

double blocks(std::size_t count)
{
    return static_cast<double>(count) / max_leaf_size;
}

std::size_t leaves_below(const BinaryTree& tree, uint node, std::set<uint>& refs)
{
    const BinaryNode& n = tree.nodes[node];
    for (uint i = n.link; i < n.link + n.count; ++i) refs.insert(tree.order[i].index);
    if (n.count > 0) return 1;
    return leaves_below(tree, node + 1, refs) + leaves_below(tree, n.link, refs);
}

// No plane through the centres is better than the sweep's first; tried the slow way.
TEST(SweepBuilder, FindsTheBestSplit)
{
    for (uint round = 0; round < 20; ++round) {
        SCOPED_TRACE(round);
        Random random(seed + round);
        PackedScene scene;
        add_soup(scene, random, 37, 0.5f);
        end_world(scene);
        const std::vector<PrimitiveRef> refs = collect_primitives(scene, scene.world);
        double best = std::numeric_limits<double>::infinity();
        for (int axis = 0; axis < 3; ++axis)
            for (const PrimitiveRef& at : refs) {
                Box left, right;
                std::size_t on_left = 0;
                for (const PrimitiveRef& ref : refs) {
                    const bool is_left = ref.lower[axis] + ref.upper[axis] < at.lower[axis] + at.upper[axis];
                    (is_left ? left : right).extend(Box{ref.lower, ref.upper});
                    on_left += is_left ? 1 : 0;
                }
                if (on_left > 0)
                    best = std::min(best, left.half_area() * blocks(on_left) +
                                              right.half_area() * blocks(refs.size() - on_left));
            }
        const BinaryTree tree = build_sweep_sah(scene, refs, {});
        const uint right = tree.nodes[0].link;
        std::set<uint> on_left, on_right;
        leaves_below(tree, 1, on_left);
        leaves_below(tree, right, on_right);
        EXPECT_DOUBLE_EQ(tree.nodes[1].box.half_area() * blocks(on_left.size()) +
                             tree.nodes[right].box.half_area() * blocks(on_right.size()),
                         best);
    }
}

TEST(MedianBuilder, CutsTheLongestSideInTheMiddle)
{
    Random random(seed);
    std::vector<PrimitiveRef> refs;
    for (uint i = 0; i < 1000; ++i) {
        const vec3 p = random.in_box(1.0f) * vec3(1.0f, 5.0f, 2.0f);
        refs.push_back({p, i, p, RefKind::sphere});
    }
    const BinaryTree tree = build_median({}, refs, {});
    EXPECT_LT(tree.nodes[1].box.upper.y, 0.05f); // of the side from -5 to 5, nearly
    EXPECT_GT(tree.nodes[tree.nodes[0].link].box.lower.y, -0.05f);
}

TEST(BuilderRegistry, FindsByName)
{
    std::set<std::string_view> names;
    for (const BuilderInfo& builder : builders()) {
        EXPECT_EQ(find_builder(builder.name), &builder);
        EXPECT_FALSE(builder.summary.empty());
        EXPECT_TRUE(names.insert(builder.name).second) << builder.name;
    }
    EXPECT_EQ(builders().front().name, "auto");
    EXPECT_EQ(find_builder("bined"), nullptr);
    BuildOptions options;
    options.builder = "bined";
    try {
        build_tree({}, {}, options);
        FAIL() << "an unknown builder";
    } catch (const Error& error) {
        EXPECT_NE(std::string(error.what()).find("'binned'"), std::string::npos) << error.what();
    }
}

} // namespace
} // namespace snell::test
