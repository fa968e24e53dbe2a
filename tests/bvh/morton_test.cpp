// Morton codes, the radix sort, and the builders on them.
#include "snell/bvh/morton.h"
#include "snell/bvh/primitives.h"
#include "snell/core/parallel.h"
#include "tests/bvh/scenes.h"
#include "tests/bvh/tree_checks.h"

#include <gtest/gtest.h>

#include <bit>

namespace snell::test {
namespace {

std::uint64_t random64(Random& random)
{
    const std::uint64_t high = random.bits();
    return high << 32 | random.bits();
}

// All digits used, and ones of which only few values occur.
TEST(Morton, RadixSortIsStable)
{
    Random random(81);
    for (const std::size_t count : {0u, 1u, 2u, 700u, 65'536u, 200'001u})
        for (const auto& [first, bits] : {std::pair(0, 63), {20, 33}, {63, 1}, {7, 11}, {5, 12}}) {
            SCOPED_TRACE(count);
            std::vector<MortonKey> expected(count);
            for (std::uint32_t i = 0; i < count; ++i)
                expected[i] = {random.bits() % 3 ? random64(random) : random.bits() % 5, i};
            Scratch<MortonKey> wide(count), wide_scratch(count);
            Scratch<std::uint64_t> packed(count), packed_scratch(count);
            for (std::size_t i = 0; i < count; ++i) wide[i] = expected[i], packed[i] = expected[i].code;
            const std::uint64_t mask = (std::uint64_t{1} << bits) - 1;
            std::stable_sort(expected.begin(), expected.end(), [&](const MortonKey& a, const MortonKey& b) {
                return (a.code >> first & mask) < (b.code >> first & mask);
            });
            radix_sort(wide, wide_scratch, first, bits);
            radix_sort(packed, packed_scratch, first, bits);
            std::size_t wrong = 0;
            for (std::size_t i = 0; i < count; ++i)
                wrong += wide[i].code != expected[i].code || wide[i].index != expected[i].index ||
                         packed[i] != expected[i].code;
            EXPECT_EQ(wrong, 0u) << first << " " << bits;
        }
}

PrimitiveRef ref_at(vec3 center, uint index = 0)
{
    return {center - vec3(0.25f), index, center + vec3(0.25f), RefKind::triangle};
}

Box quarters_of(std::initializer_list<vec3> centers)
{
    Box box;
    for (const vec3 c : centers) box.extend(0.5f * c);
    return box;
}

// In a cube the bits of the axes alternate, in a long box the long axis comes first.
TEST(Morton, CodesInterleave)
{
    const MortonGrid cube(quarters_of({vec3(0.0f), vec3(8.0f)}), 9);
    for (uint x = 0; x < 8; ++x)
        for (uint y = 0; y < 8; ++y)
            for (uint z = 0; z < 8; ++z) {
                std::uint64_t expected = 0;
                for (uint bit = 0; bit < 3; ++bit)
                    expected |= std::uint64_t{(x >> bit & 1) << 2 | (y >> bit & 1) << 1 | (z >> bit & 1)} << (3 * bit);
                const vec3 corner(static_cast<float>(x), static_cast<float>(y), static_cast<float>(z));
                EXPECT_EQ(cube.code(ref_at(corner + 0.5f)), expected);
            }
    EXPECT_EQ(cube.code(ref_at(vec3(8.0f))), 511u);

    const MortonGrid tower(quarters_of({vec3(0.0f), vec3(1.0f, 1.0f, 15.9f)}), 6);
    EXPECT_EQ(tower.code(ref_at(vec3(0.9f, 0.1f, 15.0f))) >> 3, 0b111u); // z, z, z ...
    EXPECT_EQ(tower.code(ref_at(vec3(0.9f, 0.9f, 0.1f))) >> 3, 0b000u);

    for (const int bits : {1, 2, 30, 33, 44, 63}) {
        const MortonGrid grid(quarters_of({vec3(-1.0f), vec3(1.0f, 5.0f, 2.0f)}), bits);
        EXPECT_EQ(grid.code(ref_at(vec3(-1.0f))), 0u);
        EXPECT_EQ(grid.code(ref_at(vec3(1.0f, 5.0f, 2.0f))), (std::uint64_t{1} << bits) - 1);
    }
}

// Points, huge and tiny boxes, boxes without width: no code is out of range and nothing is undefined.
TEST(Morton, OddBoxes)
{
    for (const float size : {0.0f, 1e-45f, 1e-38f, 1e-30f, 1.0f, 1e30f, 3.4e38f}) {
        const PrimitiveRef a{vec3(-size), 0, vec3(-size), RefKind::triangle};
        const PrimitiveRef b{vec3(size, size, 0.0f), 0, vec3(size, size, 0.0f), RefKind::triangle};
        Box box;
        for (const PrimitiveRef& ref : {a, b}) box.extend(MortonGrid::quarter_centre(ref));
        const MortonGrid grid(box, 63);
        EXPECT_EQ(grid.code(a), 0u);
        EXPECT_LT(grid.code(b), std::uint64_t{1} << 63);
        if (size >= 1e-30f) {
            EXPECT_GT(grid.code(b), std::uint64_t{1} << 59) << size;
        }
    }
}

// Whatever the keys: each reference once, along the curve, equal cells by index.
TEST(Morton, SortsReferences)
{
    Random random(82);
    for (const uint count : {1u, 2u, 100u, 5000u, 300'000u})
        for (const bool crowded : {false, true}) {
            SCOPED_TRACE(count);
            std::vector<PrimitiveRef> refs;
            for (uint i = 0; i < count; ++i)
                refs.push_back(ref_at(crowded && i > 0 ? vec3(1e7f) + random.in_box(2.0f) : random.in_box(100.0f), i));
            const MortonOrder order = sort_by_morton(refs);
            ASSERT_EQ(order.size(), refs.size());
            EXPECT_EQ(order.kinds, 2u);
            EXPECT_EQ(order.is_wide(), crowded && count > 2);
            std::vector<bool> seen(count);
            Box box;
            for (const PrimitiveRef& ref : refs) box.extend(MortonGrid::quarter_centre(ref));
            const MortonGrid full(box, 63);
            const auto index = [&](std::size_t i) {
                return order.is_wide() ? order.wide[i].index
                                       : order.packed[i] & ((std::uint64_t{1} << order.index_bits) - 1);
            };
            for (std::size_t i = 0; i < count; ++i) {
                ASSERT_LT(index(i), count);
                EXPECT_FALSE(seen[index(i)]);
                seen[index(i)] = true;
                if (i == 0) continue;
                if (order.is_wide()) {
                    const auto [a, b] = std::pair(order.wide[i - 1], order.wide[i]);
                    ASSERT_TRUE(a.code < b.code || (a.code == b.code && a.index < b.index));
                    ASSERT_EQ(b.code, full.code(refs[b.index]));
                } else {
                    ASSERT_LT(order.packed[i - 1], order.packed[i]);
                }
            }
        }
    EXPECT_EQ(sort_by_morton({}).size(), 0u);
}

class MortonBuilder : public testing::TestWithParam<const char*>
{
  protected:
    BinaryTree build(const std::vector<PrimitiveRef>& refs) const
    {
        const BuilderInfo* info = find_builder(GetParam());
        EXPECT_NE(info, nullptr);
        return info ? info->build({}, refs, {}) : BinaryTree{};
    }
};

TEST_P(MortonBuilder, IsSound)
{
    for (const int count : {0, 1, 2, 3, 4, 5, 9, 100, 20'000}) {
        SCOPED_TRACE(count);
        Random random(83);
        PackedScene scene;
        add_soup(scene, random, count, 0.1f);
        end_world(scene);
        std::vector<PrimitiveRef> refs = collect_primitives(scene, scene.world);
        expect_sound_tree(refs, build(refs));
        for (PrimitiveRef& ref : refs) ref.kind = RefKind::instance;
        expect_sound_tree(refs, build(refs));
        for (PrimitiveRef& ref : refs) ref.kind = RefKind(1 + random.bits() % 3);
        expect_sound_tree(refs, build(refs));
    }
}

TEST_P(MortonBuilder, SurvivesHostileInput)
{
    Random random(84);
    const auto check = [&](const char* what, uint count, const auto& box_of) {
        SCOPED_TRACE(what);
        std::vector<PrimitiveRef> refs;
        for (uint i = 0; i < count; ++i) {
            const Box box = box_of(i);
            refs.push_back({box.lower, i, box.upper, RefKind::triangle});
        }
        expect_sound_tree(refs, build(refs));
    };
    const auto point = [](vec3 p) { return Box{p, p}; };
    check("one point", 10'000, [&](uint) { return point(vec3(1.0f)); });
    check("nested around one centre", 10'000, [](uint i) {
        const float r = 1.0f + static_cast<float>(i);
        return Box{vec3(-r), vec3(r)};
    });
    check("nested, from large to small", 10'000, [](uint i) {
        const float r = 1.0f + static_cast<float>(10'000 - i);
        return Box{vec3(-r), vec3(r)};
    });
    check("distances that double", 20'000,
          [&](uint i) { return point(vec3(std::exp2(static_cast<float>(i % 250) - 125.0f), 0.0f, 0.0f)); });
    check("growing along the curve", 20'000, [](uint i) {
        const float x = static_cast<float>(i), r = std::exp(x * 0.004f);
        return Box{vec3(x - r, -r, -r), vec3(x + r, r, r)};
    });
    check("far away", 10'000, [&](uint) {
        const vec3 p = vec3(1e9f) + random.in_box(1000.0f);
        return Box{p, p + vec3(1.0f)};
    });
    check("as far as floats go", 5000, [&](uint) { return point(random.in_box(1.0f) * 3.4e38f); });
    check("all of space", 1000, [&](uint i) {
        const float r = i % 2 ? 3.4e38f : 1e38f;
        return Box{vec3(-r), vec3(r)};
    });
    check("denormals", 5000, [&](uint) { return point(random.in_box(1.0f) * 1e-40f); });
    check("a line", 20'000, [&](uint) { return point(vec3(0.0f, random.uniform(), 0.0f)); });
    check("pairs", 20'000, [&](uint i) { return point(vec3(static_cast<float>(i / 2), 0.0f, 1.0f)); });
    check("a crowd far from the rest", 20'000, [&](uint i) {
        const vec3 p = i < 10 ? random.in_box(1e8f) : random.in_box(1.0f);
        return Box{p, p + vec3(0.01f)};
    });
}

TEST_P(MortonBuilder, SameForAnyThreadCount)
{
    Random random(85);
    PackedScene scene;
    add_soup(scene, random, 150'000, 0.01f);
    add_cloud(scene, random, 10'000, 0.01f);
    add_grid(scene, 100, 0.5f);
    end_world(scene);
    const std::vector<PrimitiveRef> refs = collect_primitives(scene, scene.world);
    set_thread_count(1);
    const BinaryTree alone = build(refs);
    for (const int threads : {2, 5, 16}) {
        set_thread_count(threads);
        EXPECT_TRUE(same_tree(alone, build(refs))) << threads;
    }
    set_thread_count(0);
    expect_sound_tree(refs, alone);
}

// Each wants the one before it, so only the first two agree. Merged one a round they would take time that grows with
// the square of their number, and be a chain.
TEST(Ploc, GrowingGaps)
{
    std::vector<PrimitiveRef> refs;
    for (uint i = 0; i < 20'000; ++i) {
        const float x = 250.0f * std::exp(0.004f * static_cast<float>(i));
        refs.push_back({vec3(x, 0.0f, 0.0f), i, vec3(x, 1.0f, 1.0f), RefKind::triangle});
    }
    const BinaryTree tree = build_ploc({}, refs, {});
    expect_sound_tree(refs, tree);
    EXPECT_LT(tree_depth(tree), 64);
}

// A tree as good as can be expected: one that is sound but random would cost many times more.
TEST_P(MortonBuilder, IsNotMuchWorseThanBinned)
{
    Random random(86);
    PackedScene scene;
    add_grid(scene, 60, 0.1f);
    add_soup(scene, random, 20'000, 0.02f);
    end_world(scene);
    const std::vector<PrimitiveRef> refs = collect_primitives(scene, scene.world);
    const double best = tree_cost(build_binned_sah(scene, refs, {}));
    EXPECT_LT(tree_cost(build(refs)), best * (std::string_view(GetParam()) == "ploc" ? 1.15 : 1.6));
}

// One reference far out must not spoil the order of all others.
TEST_P(MortonBuilder, CopesWithCrowds)
{
    Random random(87);
    std::vector<PrimitiveRef> crowd;
    for (uint i = 0; i < 5000; ++i) crowd.push_back(ref_at(random.in_box(20.0f), i));
    const double alone = tree_cost(build(crowd));
    const Box box = build(crowd).nodes.front().box;
    crowd.push_back(ref_at(vec3(1e5f, 2e5f, 1e5f), 5000));
    const BinaryTree tree = build(crowd);
    expect_sound_tree(crowd, tree);
    const double relative = tree_cost(tree) * tree.nodes.front().box.half_area() / box.half_area();
    const double own = tree.nodes.front().box.half_area() / box.half_area(); // of the root, which is worth nothing
    EXPECT_LT(relative - own, 1.2 * alone);
}

TEST_P(MortonBuilder, HitsAreThoseOfBruteForce)
{
    Random random(88);
    PackedScene scene;
    add_soup(scene, random, 100, 0.3f);
    add_cloud(scene, random, 30, 0.1f);
    end_group(scene);
    add_soup(scene, random, 1000, 0.1f);
    add_grid(scene, 12, 0.0f);
    add_grid(scene, 12, 0.0f); // every hit twice
    add_cloud(scene, random, 200, 0.1f);
    end_world(scene);
    for (int i = 0; i < 20; ++i) add_instance(scene, 0, translation(2.0f * random.in_box(1.0f)));
    std::vector<Ray> rays = random_rays(random, 1000, 2.0f);
    for (const Ray& ray : hostile_rays(scene, random)) rays.push_back(ray);

    AccelOptions options;
    options.build.builder = GetParam();
    const auto accel = accels().front().make(scene, options), brute = find_accel("brute")->make(scene, {});
    std::vector<Hit> hits(rays.size()), expected(rays.size());
    accel->intersect(rays, hits);
    brute->intersect(rays, expected);
    std::vector<std::uint8_t> blocked(rays.size()), expected_blocked(rays.size());
    accel->occluded(rays, blocked);
    brute->occluded(rays, expected_blocked);
    std::size_t found = 0;
    for (std::size_t i = 0; i < rays.size(); ++i) {
        found += is_hit(expected[i]);
        EXPECT_EQ(std::bit_cast<uint>(hits[i].t), std::bit_cast<uint>(expected[i].t)) << i;
        EXPECT_EQ(hits[i].primitive, expected[i].primitive) << i;
        EXPECT_EQ(hits[i].instance, expected[i].instance) << i;
        EXPECT_EQ(blocked[i], expected_blocked[i]) << i;
    }
    EXPECT_GT(found, rays.size() / 4);
}

INSTANTIATE_TEST_SUITE_P(, MortonBuilder, testing::Values("lbvh", "ploc"),
                         [](const auto& tested) { return std::string(tested.param); });

} // namespace
} // namespace snell::test
