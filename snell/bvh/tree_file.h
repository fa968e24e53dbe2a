// Binary trees in files, and whether a tree is one.
#pragma once

#include "snell/bvh/tree.h"
#include "snell/core/hash.h"

#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace snell {

// A BinaryTree whose leaves name references by their place in the array that the builder was given.
struct StoredTree
{
    std::vector<BinaryNode> nodes;
    std::vector<uint> order;
};

// The other way round throws nothing: what read_tree_file() has read and find_tree_fault() has passed is a tree.
// The references must be those of the tree, each kind and index once.
StoredTree make_stored(const BinaryTree& tree, std::span<const PrimitiveRef> refs);
BinaryTree make_binary(StoredTree tree, std::span<const PrimitiveRef> refs);

// Replaces the file at once, or throws Error and leaves it as it was. The numbers are the machine's own, so files do
// not travel between machines of different byte order: they are refused there.
void write_tree_file(const std::filesystem::path& file, const Hash128& key, const StoredTree& tree);

enum class TreeFileState
{
    good,
    missing,
    refused // of another key or format, damaged, too short or too long, not to be read, no file at all
};

struct TreeFile
{
    TreeFileState state = TreeFileState::missing;
    StoredTree tree; // if good: as it was written, or a forgery
};

// Never throws but for lack of memory. A file of more than most_entries entries, or twice as many nodes, is refused
// before anything is allocated.
TreeFile read_tree_file(const std::filesystem::path& file, const Hash128& key, std::size_t most_entries);

// What keeps a tree from being one over the references, by everything that build.h promises of trees: depth first,
// entries in the order of the leaves, every node and entry used once, leaves of one kind within max_leaf_size, depth
// within max_tree_depth, finite boxes that lie in each other, every reference there and enclosed by its leaf; or, where
// builders may split references, by its leaves together. Nothing if all is well. Takes time and memory in proportion to
// the nodes, whatever is in them.
std::optional<std::string> find_tree_fault(const StoredTree& tree, std::span<const PrimitiveRef> refs, bool may_split);

} // namespace snell
