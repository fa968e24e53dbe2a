// Which nodes of a binary tree become the children of wide ones.
#pragma once

#include "snell/bvh/scratch.h"
#include "snell/bvh/tree.h"
#include "snell/scene/packed.h"

#include <array>
#include <span>

namespace snell {

// The wide tree of least expected cost that keeps the order of a binary one, by dynamic programming over the number of
// children that a subtree may take up (Wald, Benthin, Boulos 2008, Getting Rid of Packets; Ylitie, Karras, Laine 2017,
// Efficient Incoherent Ray Traversal on GPUs Through Compressed Wide BVHs, 3.2). Subtrees whose triangles fit one block
// become leaves, and leaves are parted in two, where that pays. In parallel; the same for any number of threads. Refers
// to what it was made from.
template <uint width>
class Collapse
{
  public:
    Collapse(const PackedScene& scene, const BinaryTree& tree);

    // A subtree of the binary tree, or one part of a leaf.
    struct Child
    {
        uint index, end; // node of the binary tree, and where its subtree ends
        uint part;       // 0: the whole, else the first or second part
    };
    struct Children
    {
        std::array<Child, width> list;
        uint count = 0;

        const Child* begin() const { return list.data(); }
        const Child* end() const { return list.data() + count; }
        void add(const Child& child) { list[count++] = child; }
    };
    Child root() const { return {0, static_cast<uint>(tree_.nodes.size()), 0}; }
    // Of the wide node that takes the place of a subtree, in depth-first order. Not for leaves.
    Children children(const Child& of) const;

    bool is_leaf(const Child& child) const { return (notes(child.index) & leaf_bit) != 0; }
    // What is in a leaf. Those that were one already in the binary tree may have several blocks; of trees with spatial
    // splits others may hold a triangle twice.
    std::span<const BinaryTree::Entry> entries(const Child& leaf) const;
    // Behind the last entry of the last leaf; leaves that are emitted one after the other mostly lie so in memory.
    const BinaryTree::Entry* entries_end() const { return order_.data() + order_.size(); }
    Box box(const Child& child) const;

  private:
    // By node: the least cost of its subtree as up to 1, 2, ... width - 1 children, and notes.
    union Cell
    {
        float cost;
        uint notes;
    };
    // Notes: how many triangles lie below (0: too many, or others), and in the first part of a leaf.
    static constexpr uint leaf_bit = 1u << 16, part_shift = 8, count_mask = 255;

    const PackedScene& scene_;
    const BinaryTree& tree_;
    Scratch<std::array<Cell, width>> cells_;
    Scratch<BinaryTree::Entry> order_; // as the tree's, but for the parts of leaves
    double scale_ = 1;                 // areas are relative to the root's
    float cost_of_part_ = 0;

    uint notes(uint index) const { return cells_[index][width - 1].notes; }
    float cost(uint index, uint places) const { return cells_[index][places - 1].cost; }
    uint middle(uint index) const { return tree_.nodes[index].link; }

    void price_all();
    void price(uint index);
    void price_leaf(uint index);
    uint count_if_block(uint index) const;
    uint first_entry(uint index) const;
    uint best_share(uint index, uint places) const;
    void add(Children& to, uint index, uint end, uint places) const;
};

} // namespace snell
