#include "snell/bvh/build.h"
#include "snell/bvh/tree_file.h"

#include <fmt/format.h>

namespace snell {
namespace {

bool encloses(const Box& outer, vec3 lower, vec3 upper)
{
    return outer.lower.x <= lower.x && outer.lower.y <= lower.y && outer.lower.z <= lower.z &&
           outer.upper.x >= upper.x && outer.upper.y >= upper.y && outer.upper.z >= upper.z;
}

// The right children that are still to come, with what their parents say of them.
struct Pending
{
    uint node = 0;
    uint parent = none;
    int depth = 0;
};

class Checker
{
  public:
    Checker(const StoredTree& stored, std::span<const PrimitiveRef> references, bool split)
        : tree(stored), refs(references), may_split(split), found(references.size()),
          covered(split ? references.size() : 0)
    {
    }

    std::optional<std::string> run();

  private:
    const StoredTree& tree;
    const std::span<const PrimitiveRef> refs;
    const bool may_split;
    std::vector<std::uint8_t> found; // by reference: some leaf has it
    std::vector<Box> covered;        // by reference, if they may be split: the boxes of its leaves together
    std::size_t next_entry = 0;

    const char* leaf_fault(const BinaryNode& leaf);
};

const char* Checker::leaf_fault(const BinaryNode& leaf)
{
    if (leaf.count > max_leaf_size) return "too large a leaf";
    if (leaf.link != next_entry) return "entries out of order";
    if (leaf.count > tree.order.size() - next_entry) return "a leaf beyond the entries";
    for (uint i = 0; i < leaf.count; ++i) {
        const uint number = tree.order[next_entry + i];
        if (number >= refs.size()) return "an entry beyond the references";
        const PrimitiveRef& ref = refs[number];
        if (ref.kind != refs[tree.order[next_entry]].kind) return "a leaf of two kinds";
        if (ref.kind == RefKind::instance && leaf.count > 1) return "an instance that is not alone";
        if (may_split) {
            covered[number].extend(leaf.box);
        } else {
            if (found[number] != 0) return "a reference in two leaves";
            if (!encloses(leaf.box, ref.lower, ref.upper)) return "a reference outside of its leaf";
        }
        found[number] = 1;
    }
    next_entry += leaf.count;
    return nullptr;
}

std::optional<std::string> Checker::run()
{
    const auto fault = [](std::size_t node, const char* what) { return fmt::format("node {}: {}", node, what); };
    const std::size_t count = tree.nodes.size();
    if (tree.nodes.empty() != refs.empty()) return "nodes without references, or the other way round";
    std::vector<Pending> pending;
    Pending now;
    for (std::size_t i = 0; i < count; ++i) {
        const BinaryNode& node = tree.nodes[i];
        if (!is_finite3(node.box.lower) || !is_finite3(node.box.upper) || node.box.empty())
            return fault(i, "a box that is none");
        if (now.parent != none && !encloses(tree.nodes[now.parent].box, node.box.lower, node.box.upper))
            return fault(i, "a box outside of its parent's");
        if (now.depth > max_tree_depth) return fault(i, "too deep");
        if (node.count == 0) {
            if (node.link <= i + 1 || node.link >= count) return fault(i, "a child out of range");
            pending.push_back({node.link, static_cast<uint>(i), now.depth + 1});
            now = {static_cast<uint>(i + 1), static_cast<uint>(i), now.depth + 1};
            continue;
        }
        if (const char* what = leaf_fault(node)) return fault(i, what);
        if (pending.empty()) {
            if (i + 1 != count) return fault(i, "nodes that nobody refers to");
            break;
        }
        now = pending.back();
        pending.pop_back();
        if (now.node != i + 1) return fault(now.parent, "children out of order");
    }
    if (next_entry != tree.order.size()) return "entries that are in no leaf";
    for (std::size_t i = 0; i < refs.size(); ++i) {
        if (found[i] == 0) return fmt::format("reference {} is missing", i);
        if (may_split && !encloses(covered[i], refs[i].lower, refs[i].upper))
            return fmt::format("reference {} sticks out of its leaves", i);
    }
    return std::nullopt;
}

} // namespace

std::optional<std::string> find_tree_fault(const StoredTree& tree, std::span<const PrimitiveRef> refs, bool may_split)
{
    return Checker(tree, refs, may_split).run();
}

} // namespace snell
