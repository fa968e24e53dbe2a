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
// become leaves where that pays. In parallel; the same for any number of threads. Refers to what it was made from.
template <uint width>
class Collapse
{
  public:
    Collapse(const PackedScene& scene, const BinaryTree& tree);

    struct Children
    {
        std::array<uint, width> index, end; // nodes of the binary tree, and where their subtrees end
        uint count = 0;
    };
    // Of the wide node that takes the place of that one, in depth-first order. Not for leaves.
    Children children(uint index, uint end) const;

    bool is_leaf(uint index) const { return (note(index) & leaf_bit) != 0; }
    // What is in a leaf. Those that were one already in the binary tree may have several blocks; of trees with spatial
    // splits others may hold a triangle twice.
    std::span<const BinaryTree::Entry> entries(uint index) const;

  private:
    // By node: the least cost of its subtree as up to 1, 2, ... width - 1 children, and notes.
    union Cell
    {
        float cost;
        uint notes;
    };
    static constexpr uint leaf_bit = 256, count_mask = 255; // how many triangles lie below; 0: too many, or others

    const PackedScene& scene_;
    const BinaryTree& tree_;
    Scratch<std::array<Cell, width>> cells_;
    double scale_ = 1; // areas are relative to the root's

    uint note(uint index) const { return cells_[index][width - 1].notes; }
    float cost(uint index, uint places) const { return cells_[index][places - 1].cost; }
    uint middle(uint index) const { return tree_.nodes[index].link; }

    void price_all();
    void price(uint index);
    uint count_if_block(uint index) const;
    uint first_entry(uint index) const;
    uint best_share(uint index, uint places) const;
    void add(Children& to, uint index, uint end, uint places) const;
};

} // namespace snell
