// Which trees are none, whatever their checksums say.
#include "snell/bvh/build.h"
#include "snell/bvh/tree_file.h"
#include "tests/bvh/cache_scenes.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cstring>
#include <functional>

namespace snell::test {
namespace {

// What no checksum tells: files that somebody has made up.
TEST(TreeFault, ForgeriesAreFound)
{
    std::vector<PrimitiveRef> refs;
    const PackedScene scene = mixture(refs);
    const StoredTree good = make_stored(build_tree(scene, refs, {}), refs);
    ASSERT_FALSE(find_tree_fault(good, refs, false));
    ASSERT_FALSE(find_tree_fault(good, refs, true));

    std::size_t inner = 0, leaf = 0, instance = 0; // some of each, not the root
    for (std::size_t i = 1; i < good.nodes.size(); ++i) {
        const BinaryNode& node = good.nodes[i];
        if (node.count == 0) inner = i;
        if (node.count >= 2) leaf = i;
        if (node.count == 1 && refs[good.order[node.link]].kind == RefKind::instance) instance = i;
    }
    ASSERT_GT(inner * leaf * instance, 0u);
    const float nan = std::nanf("");
    const uint count = static_cast<uint>(good.nodes.size());
    using Forge = std::function<void(StoredTree&)>;
    const std::pair<const char*, Forge> forgeries[] = {
        {"no nodes", [](StoredTree& t) { t.nodes.clear(); }},
        {"no entries", [](StoredTree& t) { t.order.clear(); }},
        {"nothing", [](StoredTree& t) { t = {}; }},
        {"its own child", [&](StoredTree& t) { t.nodes[inner].link = static_cast<uint>(inner); }},
        {"a child before it", [&](StoredTree& t) { t.nodes[inner].link = 0; }},
        {"both children alike", [&](StoredTree& t) { t.nodes[inner].link = static_cast<uint>(inner) + 1; }},
        {"a child beyond the end", [&](StoredTree& t) { t.nodes[inner].link = count; }},
        {"a child far beyond the end", [&](StoredTree& t) { t.nodes[inner].link = none; }},
        {"another's child", [&](StoredTree& t) { t.nodes[inner].link += 1; }},
        {"another's child, at the root", [&](StoredTree& t) { t.nodes[0].link -= 1; }},
        {"a leaf for the root", [](StoredTree& t) { t.nodes[0].count = 1, t.nodes[0].link = 0; }},
        {"an inner node for a leaf", [&](StoredTree& t) { t.nodes[leaf].count = 0; }},
        {"a last node too much", [](StoredTree& t) { t.nodes.push_back(t.nodes.back()); }},
        {"a last node too few", [](StoredTree& t) { t.nodes.pop_back(); }},
        {"a leaf too large", [&](StoredTree& t) { t.nodes[leaf].count = max_leaf_size + 1; }},
        {"a leaf much too large", [&](StoredTree& t) { t.nodes[leaf].count = none; }},
        {"a leaf too small", [&](StoredTree& t) { t.nodes[leaf].count -= 1; }},
        {"a leaf's entries elsewhere", [&](StoredTree& t) { t.nodes[leaf].link += 1; }},
        {"a leaf's entries nowhere", [&](StoredTree& t) { t.nodes[leaf].link = none; }},
        {"an entry too much", [](StoredTree& t) { t.order.push_back(0); }},
        {"an entry too few", [](StoredTree& t) { t.order.pop_back(); }},
        {"an entry out of range", [&](StoredTree& t) { t.order[3] = static_cast<uint>(refs.size()); }},
        {"an entry far out of range", [](StoredTree& t) { t.order[3] = none; }},
        {"an entry twice", [](StoredTree& t) { t.order[3] = t.order[4]; }},
        {"entries exchanged", [](StoredTree& t) { std::swap(t.order.front(), t.order.back()); }},
        {"two kinds in a leaf",
         [&](StoredTree& t) { std::swap(t.order[t.nodes[leaf].link], t.order[t.nodes[instance].link]); }},
        {"a box that is NaN", [&](StoredTree& t) { t.nodes[leaf].box.lower.y = nan; }},
        {"a root that is NaN", [&](StoredTree& t) { t.nodes[0].box.upper.y = nan; }},
        {"a root that is endless", [&](StoredTree& t) { t.nodes[0].box.upper.y = infinity(); }},
        {"an empty box", [&](StoredTree& t) { t.nodes[inner].box = {}; }},
        {"a box too small for its primitives",
         [&](StoredTree& t) { t.nodes[leaf].box.lower.x = std::nextafter(t.nodes[leaf].box.lower.x, 9.0f); }},
        {"a root too small",
         [&](StoredTree& t) { t.nodes[0].box.upper.z = std::nextafter(t.nodes[0].box.upper.z, 0.0f); }},
        {"a box too large for its parent's", [&](StoredTree& t) { t.nodes[leaf].box.upper.z = 1e9f; }},
    };
    for (const auto& [name, forge] : forgeries) {
        SCOPED_TRACE(name);
        StoredTree tree = good;
        forge(tree);
        EXPECT_TRUE(find_tree_fault(tree, refs, false));
        EXPECT_TRUE(find_tree_fault(tree, refs, true)) << "where references may be split";
    }
    // Two references in one leaf: spheres may share it, instances and a mixture may not.
    const StoredTree shared = {{{Box{vec3(0.0f), vec3(1.0f)}, 0, 2}}, {0, 1}};
    for (const RefKind first : {RefKind::triangle, RefKind::sphere, RefKind::instance})
        for (const RefKind second : {RefKind::triangle, RefKind::sphere, RefKind::instance}) {
            const std::vector<PrimitiveRef> two = {{vec3(0.0f), 0, vec3(1.0f), first},
                                                   {vec3(0.0f), 1, vec3(1.0f), second}};
            const bool sound = first == second && first != RefKind::instance;
            EXPECT_EQ(!find_tree_fault(shared, two, false), sound);
        }
    EXPECT_FALSE(find_tree_fault({}, {}, false));
}

// A chain as deep as allowed, and one deeper.
TEST(TreeFault, DepthIsBounded)
{
    for (const int depth : {1, max_tree_depth, max_tree_depth + 1, 5000}) {
        const Box box{vec3(0.0f), vec3(1.0f)};
        StoredTree chain;
        std::vector<PrimitiveRef> refs;
        for (uint i = 0; i <= static_cast<uint>(depth); ++i) {
            refs.push_back({box.lower, i, box.upper, RefKind::triangle});
            chain.order.push_back(i);
        }
        // Each inner node has a leaf to its left; the last leaf is to the right of the last.
        for (uint i = 0; i < static_cast<uint>(depth); ++i) {
            chain.nodes.push_back({box, 2 * i + 2, 0});
            chain.nodes.push_back({box, i, 1});
        }
        chain.nodes.push_back({box, static_cast<uint>(depth), 1});
        EXPECT_EQ(find_tree_fault(chain, refs, false).has_value(), depth > max_tree_depth) << depth;
    }
}

// Numbers of a good tree changed at random: what is let through differs in boxes alone, and those are larger.
TEST(TreeFault, RandomForgeries)
{
    constexpr uint seed = 77;
    SCOPED_TRACE(fmt::format("seed {}", seed));
    Random random(seed);
    const PackedScene scene = soup(200);
    const std::vector<PrimitiveRef> refs = collect_primitives(scene, scene.world);
    for (const char* builder : {"", "sbvh"}) {
        const bool splits = *builder != 0;
        if (splits && find_builder(builder) == nullptr) continue;
        const StoredTree good = make_stored(build_tree(scene, refs, {builder}), refs);
        int refused = 0;
        for (int i = 0; i < 3000; ++i) {
            StoredTree tree = good;
            for (int k = 0; k <= i % 3; ++k) {
                const bool in_order = random.bits() % 4 == 0;
                uint* word = in_order ? &tree.order[random.bits() % tree.order.size()]
                                      : reinterpret_cast<uint*>(tree.nodes.data()) +
                                            random.bits() % (tree.nodes.size() * sizeof(BinaryNode) / sizeof(uint));
                uint value = 0;
                std::memcpy(&value, word, sizeof(value));
                switch (random.bits() % 4) {
                case 0:
                    value ^= 1u << random.bits() % 32;
                    break;
                case 1:
                    value += static_cast<uint>(random.bits() % 7) - 3;
                    break;
                case 2:
                    value = static_cast<uint>(random.bits());
                    break;
                default:
                    value = static_cast<uint>(random.bits() % tree.nodes.size());
                }
                std::memcpy(word, &value, sizeof(value));
            }
            if (find_tree_fault(tree, refs, splits)) {
                ++refused;
                continue;
            }
            for (std::size_t n = 0; n < tree.nodes.size(); ++n) {
                ASSERT_EQ(tree.nodes[n].count, good.nodes[n].count);
                ASSERT_EQ(tree.nodes[n].link, good.nodes[n].link);
            }
            if (!splits) {
                ASSERT_EQ(tree.order, good.order);
            }
        }
        EXPECT_GT(refused, 1500);
    }
}

} // namespace
} // namespace snell::test
