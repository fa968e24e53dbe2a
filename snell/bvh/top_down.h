// What all builders share that work from the root down: recursion, leaves, depth, parallel pieces. How a part is cut in
// two is the business of a splitter:
//
//   struct Part { std::size_t begin, end; ... };   positions in the tree's order, and what else it likes to know
//   Part whole();
//   Box box(const Part&) const;
//   BinaryTree::Entry entry(const Part&, std::size_t position) const;
//   void split(const Part& part, bool halve, Part& left, Part& right);
//
// split() rearranges what stands at the part's positions and gives each side at least one; with `halve` the sides
// differ by at most one. It is called for different parts at the same time.
#pragma once

#include "snell/bvh/big_pages.h"
#include "snell/bvh/build.h"
#include "snell/core/error.h"
#include "snell/core/parallel.h"

#include <memory>
#include <vector>

namespace snell {

template <class Splitter>
class TopDown
{
  public:
    explicit TopDown(Splitter& s) : splitter(s) {}

    BinaryTree run(std::size_t count)
    {
        if (count == 0) return {};
        SNELL_CHECK_LT(count, std::size_t{1} << 30);
        tree.order = make_big<BinaryTree::Entry>(count);
        const std::unique_ptr<Piece> root = build_piece(splitter.whole(), 0);
        std::vector<Place> places;
        const std::size_t size = place(*root, 0, places);
        tree.nodes = make_big<BinaryNode>(size);
        parallel_for(places.size(), [&](std::size_t i) { copy(places[i]); });
        return std::move(tree);
    }

  private:
    using Part = typename Splitter::Part;

    // Parts that are deeper are halved. Of fewer than 2^30 references that takes 28 levels more: 92 in all.
    static constexpr int halving_depth = 64;
    static_assert(halving_depth + 28 <= max_tree_depth);
    static constexpr std::size_t piece_size = 4096; // subtrees up to here are built by one thread

    // One part of the tree: nodes in final order with links that count from their own first one, or (left is set) an
    // inner node over two pieces.
    struct Piece
    {
        std::vector<BinaryNode> nodes;
        std::unique_ptr<Piece> left, right;
    };
    struct Place
    {
        const Piece* piece;
        std::size_t first; // node of the tree
        uint right;        // node of the tree where the right piece begins
    };

    Splitter& splitter;
    BinaryTree tree;

    bool is_leaf(const Part& part) const
    {
        const std::size_t count = part.end - part.begin;
        if (count == 1) return true;
        if (count > max_leaf_size) return false;
        const RefKind kind = splitter.entry(part, part.begin).kind;
        bool alike = kind != RefKind::instance;
        for (std::size_t i = part.begin + 1; i < part.end; ++i) alike = alike && splitter.entry(part, i).kind == kind;
        return alike;
    }

    void build_nodes(std::vector<BinaryNode>& nodes, const Part& part, int depth)
    {
        const std::size_t self = nodes.size();
        if (is_leaf(part)) {
            nodes.push_back(
                {splitter.box(part), static_cast<uint>(part.begin), static_cast<uint>(part.end - part.begin)});
            for (std::size_t i = part.begin; i < part.end; ++i) tree.order[i] = splitter.entry(part, i);
            return;
        }
        nodes.push_back({splitter.box(part), 0, 0});
        Part left, right;
        splitter.split(part, depth >= halving_depth, left, right);
        build_nodes(nodes, left, depth + 1);
        nodes[self].link = static_cast<uint>(nodes.size());
        build_nodes(nodes, right, depth + 1);
    }

    std::unique_ptr<Piece> build_piece(const Part& part, int depth)
    {
        auto piece = std::make_unique<Piece>();
        const std::size_t count = part.end - part.begin;
        if (count <= piece_size) {
            piece->nodes.reserve(count * 3 / 4 + 1); // leaves of 3 and more
            build_nodes(piece->nodes, part, depth);
            return piece;
        }
        piece->nodes.push_back({splitter.box(part), 0, 0});
        Part left, right;
        splitter.split(part, depth >= halving_depth, left, right);
        parallel_both([&] { piece->left = build_piece(left, depth + 1); },
                      [&] { piece->right = build_piece(right, depth + 1); });
        return piece;
    }

    // Where each piece goes, from `first` on. Returns where the next one begins.
    static std::size_t place(const Piece& piece, std::size_t first, std::vector<Place>& places)
    {
        const std::size_t self = places.size();
        places.push_back({&piece, first, 0});
        if (!piece.left) return first + piece.nodes.size();
        const std::size_t right = place(*piece.left, first + 1, places);
        places[self].right = static_cast<uint>(right);
        return place(*piece.right, right, places);
    }

    void copy(const Place& place)
    {
        for (std::size_t i = 0; i < place.piece->nodes.size(); ++i) {
            BinaryNode node = place.piece->nodes[i];
            if (node.count == 0)
                node.link = place.piece->left ? place.right : node.link + static_cast<uint>(place.first);
            tree.nodes[place.first + i] = node;
        }
    }
};

} // namespace snell
