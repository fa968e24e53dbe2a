// Trees that outlive the program.
#pragma once

#include "snell/bvh/build.h"
#include "snell/core/hash.h"

#include <filesystem>
#include <string>

namespace snell {

// A folder of trees, one file each, "HASH.snelltree". What is in it is used only if it is the tree that would be built,
// as far as can be told: the file's name and header carry the hash of what the tree is made from, a hash over the whole
// content must be right, and the tree must be sound over the very primitives (find_tree_fault()). So a file that is
// stale, cut off, damaged or somebody else's is built anew and replaced, and none can do worse than cost time. Several
// programs may use a folder at the same time.
struct TreeCache
{
    std::filesystem::path folder;                      // made if it is not there; empty: no cache
    std::uint64_t most_bytes = std::uint64_t{4} << 30; // beyond, files that were not used for the longest time go
    std::size_t least_references = 4096;               // smaller trees are faster built than read
};

// What has come of the trees that a cache was asked for.
struct CacheUse
{
    std::size_t loaded = 0;  // from their files
    std::size_t built = 0;   // and written
    std::size_t refused = 0; // of those built: there was a file, but it was no good
};

// Hash of all that a tree depends on: the references, the vertices of triangles, the options, the limits and costs in
// build.h, the format of files, and this build of snell, whose builders may differ from those of another.
Hash128 tree_key(const PackedScene& scene, std::span<const PrimitiveRef> refs, const BuildOptions& options);

// Makes the folder if it is not there. Throws Error, naming it, unless files can be written there now.
void check_cache_folder(const std::filesystem::path& folder);

// As build_tree(), through the cache. Throws Error if a tree has to be kept and the folder cannot be written.
BinaryTree build_cached(const PackedScene& scene, std::vector<PrimitiveRef> refs, const BuildOptions& options,
                        const TreeCache& cache, CacheUse* use = nullptr);

} // namespace snell
