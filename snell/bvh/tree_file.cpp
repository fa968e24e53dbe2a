#include "snell/bvh/tree_file.h"

#include "snell/core/error.h"
#include "snell/core/parallel.h"
#include "snell/io/file.h"

#include <algorithm>
#include <bit>
#include <cstring>
#include <fstream>
#include <limits>
#include <utility>

namespace snell {
namespace {

constexpr char magic[8] = {'s', 'n', 'e', 'l', 'l', 't', 'r', 'e'};
constexpr std::uint32_t format_version = 1;
constexpr std::uint32_t byte_order = 0x01020304; // reads as another number where bytes are the other way round

struct Header
{
    char magic[8];
    std::uint32_t version;
    std::uint32_t byte_order;
    Hash128 key;
    std::uint64_t nodes, entries;
    Hash128 content; // of the header with this field 0, the nodes and the entries
};
static_assert(sizeof(Header) == 64);
static_assert(sizeof(BinaryNode) == 32 && std::is_trivially_copyable_v<BinaryNode>);

Header make_header(const Hash128& key, std::size_t nodes, std::size_t entries)
{
    Header header = {};
    std::memcpy(header.magic, magic, sizeof(magic));
    header.version = format_version;
    header.byte_order = byte_order;
    header.key = key;
    header.nodes = nodes;
    header.entries = entries;
    return header;
}

Hash128 hash_content(const Header& header, const StoredTree& tree)
{
    const Hash128 parts[] = {hash_bytes(&header, sizeof(header)),
                             hash_in_parallel(tree.nodes.data(), tree.nodes.size() * sizeof(BinaryNode)),
                             hash_in_parallel(tree.order.data(), tree.order.size() * sizeof(uint))};
    return hash_bytes(parts, sizeof(parts));
}

template <class T>
bool read_array(InputFile& file, std::vector<T>& array, std::uint64_t count)
{
    array.resize(count);
    const std::size_t bytes = array.size() * sizeof(T);
    return file.read(reinterpret_cast<char*>(array.data()), bytes) == bytes;
}

std::uint64_t key_of(RefKind kind, uint index)
{
    return std::uint64_t{static_cast<uint>(kind)} << 32 | index;
}

} // namespace

StoredTree make_stored(const BinaryTree& tree, std::span<const PrimitiveRef> refs)
{
    SNELL_CHECK_LT(refs.size(), std::numeric_limits<uint>::max());
    struct Numbered
    {
        std::uint64_t key;
        uint number;
        bool operator<(const Numbered& other) const { return key < other.key; }
    };
    std::vector<Numbered> places(refs.size());
    for (std::size_t i = 0; i < refs.size(); ++i)
        places[i] = {key_of(refs[i].kind, refs[i].index), static_cast<uint>(i)};
    if (!std::is_sorted(places.begin(), places.end())) std::sort(places.begin(), places.end());

    StoredTree stored = {tree.nodes, std::vector<uint>(tree.order.size())};
    parallel_ranges(tree.order.size(), 16384, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) {
            const std::uint64_t key = key_of(tree.order[i].kind, tree.order[i].index);
            const auto place = std::lower_bound(places.begin(), places.end(), Numbered{key, 0});
            SNELL_CHECK_EQ(place != places.end() && place->key == key, true);
            stored.order[i] = place->number;
        }
    });
    return stored;
}

BinaryTree make_binary(StoredTree tree, std::span<const PrimitiveRef> refs)
{
    BinaryTree binary = {std::move(tree.nodes), std::vector<BinaryTree::Entry>(tree.order.size())};
    for (std::size_t i = 0; i < tree.order.size(); ++i) {
        const PrimitiveRef& ref = refs[tree.order[i]];
        binary.order[i] = {ref.index, ref.kind};
    }
    return binary;
}

void write_tree_file(const std::filesystem::path& file, const Hash128& key, const StoredTree& tree)
{
    Header header = make_header(key, tree.nodes.size(), tree.order.size());
    header.content = hash_content(header, tree);
    write_atomically(file, [&](const std::filesystem::path& temporary) {
        std::ofstream out(temporary, std::ios::binary | std::ios::trunc);
        const auto put = [&](const void* bytes, std::size_t size) {
            out.write(static_cast<const char*>(bytes), static_cast<std::streamsize>(size));
        };
        put(&header, sizeof(header));
        put(tree.nodes.data(), tree.nodes.size() * sizeof(BinaryNode));
        put(tree.order.data(), tree.order.size() * sizeof(uint));
        out.close();
        if (!out) throw Error({file.string()}, "writing failed", "check the disk's free space");
    });
}

TreeFile read_tree_file(const std::filesystem::path& file, const Hash128& key, std::size_t most_entries)
{
    TreeFile result;
    std::error_code error;
    if (!std::filesystem::exists(file, error) && !error) return result;
    result.state = TreeFileState::refused;
    try {
        InputFile in(file);
        Header header;
        if (in.read(reinterpret_cast<char*>(&header), sizeof(header)) != sizeof(header)) return result;
        Header expected = make_header(key, header.nodes, header.entries);
        const Hash128 content = std::exchange(header.content, {});
        if (std::memcmp(&header, &expected, sizeof(header)) != 0) return result;
        if (header.entries > most_entries || header.nodes > 2 * std::uint64_t{most_entries}) return result;
        if (in.size() != sizeof(header) + header.nodes * sizeof(BinaryNode) + header.entries * sizeof(uint))
            return result;
        if (!read_array(in, result.tree.nodes, header.nodes) || !read_array(in, result.tree.order, header.entries))
            return result;
        if (hash_content(header, result.tree) == content) result.state = TreeFileState::good;
    } catch (const Error&) { // a folder, a device, a file that is not ours to read: as good as a damaged one
    }
    return result;
}

} // namespace snell
