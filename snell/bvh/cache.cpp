#include "snell/bvh/cache.h"

#include "snell/bvh/tree_file.h"
#include "snell/core/error.h"
#include "snell/core/version.h"
#include "snell/io/file.h"

#include <algorithm>
#include <bit>
#include <chrono>
#include <cstring>

namespace snell {
namespace fs = std::filesystem;
namespace {

constexpr std::string_view ending = ".snelltree";

// One block of references with the vertices of the triangles among them.
Hash128 hash_references(const PackedScene& scene, std::span<const PrimitiveRef> refs)
{
    std::vector<float> numbers;
    numbers.reserve(refs.size() * (8 + 9));
    const auto put = [&](vec3 v) { numbers.insert(numbers.end(), {v.x, v.y, v.z}); };
    for (const PrimitiveRef& ref : refs) {
        put(ref.lower);
        put(ref.upper);
        numbers.push_back(std::bit_cast<float>(ref.index));
        numbers.push_back(std::bit_cast<float>(ref.kind));
        if (ref.kind != RefKind::triangle) continue;
        const Triangle& tri = scene.triangles[ref.index];
        for (const uint v : {tri.v0, tri.v1, tri.v2}) put(scene.positions[v]);
    }
    return hash_bytes(numbers.data(), numbers.size() * sizeof(float), refs.size());
}

// No more entries than that are in a tree that the options allow.
std::size_t most_entries(std::size_t refs, const BuildOptions& options)
{
    return refs + static_cast<std::size_t>(std::max(options.split_budget, 0.0) * static_cast<double>(refs)) + 1;
}

// Whether leaves may hold parts of references.
bool splits_references(const BuildOptions& options)
{
    return options.builder == "sbvh";
}

struct Kept
{
    fs::path path;
    std::uint64_t bytes;
    fs::file_time_type used;
};

// Removes what was not used for the longest time until the rest is within the limit; `newest` stays. Others may remove
// files at the same time, so nothing here is an error.
void trim_folder(const TreeCache& cache, const fs::path& newest)
{
    std::error_code error;
    std::vector<Kept> kept;
    std::uint64_t total = 0;
    const fs::file_time_type now = fs::file_time_type::clock::now();
    for (fs::directory_iterator it(cache.folder, error), end; !error && it != end; it.increment(error)) {
        std::error_code gone;
        if (it->symlink_status(gone).type() != fs::file_type::regular) continue;
        const fs::path& path = it->path();
        const fs::file_time_type used = it->last_write_time(gone);
        const std::uint64_t bytes = it->file_size(gone);
        if (gone) continue;
        const std::string name = path.filename().string();
        // What a program that was killed has left of write_atomically().
        if (name.starts_with(".snell-") && name.ends_with(".tmp") && now - used > std::chrono::hours(24)) {
            fs::remove(path, gone);
            continue;
        }
        if (path.extension() != ending) continue;
        total += bytes;
        if (path != newest) kept.push_back({path, bytes, used});
    }
    std::sort(kept.begin(), kept.end(),
              [](const Kept& a, const Kept& b) { return a.used != b.used ? a.used < b.used : a.path < b.path; });
    for (const Kept& file : kept) {
        if (total <= cache.most_bytes) return;
        if (fs::remove(file.path, error)) total -= file.bytes;
    }
}

} // namespace

void check_cache_folder(const fs::path& folder)
{
    std::error_code error;
    fs::create_directories(folder, error);
    if (!fs::is_directory(folder, error))
        throw Error({folder.string()}, "the folder for trees cannot be made", "choose another for --accel-cache");
    check_can_write(folder / ("probe" + std::string(ending)));
}

Hash128 tree_key(const PackedScene& scene, std::span<const PrimitiveRef> refs, const BuildOptions& options)
{
    constexpr std::size_t block = 8192;
    const Hash128 geometry = hash_blocks((refs.size() + block - 1) / block, [&](std::size_t i) {
        return hash_references(scene, refs.subspan(i * block, std::min(block, refs.size() - i * block)));
    });
    const std::string settings = fmt::format(
        "{} {} {:a} {} leaves {} depth {} costs {:a} {:a} version {} {}", refs.size(),
        options.builder.empty() ? builders().front().name : options.builder, options.split_budget, options.reinsertion,
        max_leaf_size, max_tree_depth, cost_of_node, cost_of_block, version(), commit());
    const Hash128 parts[] = {geometry, hash_bytes(settings.data(), settings.size())};
    return hash_bytes(parts, sizeof(parts));
}

BinaryTree build_cached(const PackedScene& scene, std::vector<PrimitiveRef> refs, const BuildOptions& options,
                        const TreeCache& cache, CacheUse* use)
{
    if (cache.folder.empty() || refs.size() < cache.least_references)
        return build_tree(scene, std::move(refs), options);

    CacheUse ignored;
    CacheUse& count = use != nullptr ? *use : ignored;
    const Hash128 key = tree_key(scene, refs, options);
    const fs::path file = cache.folder / (to_hex(key) + std::string(ending));
    TreeFile known = read_tree_file(file, key, most_entries(refs.size(), options));
    if (known.state == TreeFileState::good && !find_tree_fault(known.tree, refs, splits_references(options))) {
        ++count.loaded;
        std::error_code no_matter;
        fs::last_write_time(file, fs::file_time_type::clock::now(), no_matter); // when it was used
        return make_binary(std::move(known.tree), refs);
    }
    if (known.state != TreeFileState::missing) ++count.refused;
    known = {};

    check_cache_folder(cache.folder); // before the work is done
    BinaryTree tree = build_tree(scene, refs, options);
    const StoredTree stored = make_stored(tree, refs);
    write_tree_file(file, key, stored);
    trim_folder(cache, file);
    ++count.built;
    return tree;
}

} // namespace snell
