#include "snell/io/stl/stl.h"

#include "snell/core/error.h"
#include "snell/io/byte_window.h"
#include "snell/io/index_table.h"
#include "snell/io/progress.h"
#include "snell/io/text_cursor.h"

#include <algorithm>
#include <bit>
#include <cstring>
#include <functional>

namespace snell {
namespace {

constexpr std::size_t header_bytes = 84, facet_bytes = 50;
static_assert(std::endian::native == std::endian::little, "binary STL is little-endian");

// Collects facets.
class Facets
{
  public:
    explicit Facets(std::size_t expected) : table_(expected / 2 + 1) { triangles_.reserve(expected); }

    void add(vec3 normal, const vec3 (&corners)[3])
    {
        uvec3 triangle;
        for (int i = 0; i < 3; ++i) {
            const vec3 p = corners[i] + 0.0f; // -0 and 0 are one place
            triangle[i] = table_.find_or_add(uvec3(floatBitsToUint(p.x), floatBitsToUint(p.y), floatBitsToUint(p.z)));
        }
        triangles_.push_back(triangle);
        if (dot(normal, cross(corners[1] - corners[0], corners[2] - corners[0])) < 0.0f) ++against_;
    }

    std::size_t count() const { return triangles_.size(); }
    std::size_t against_winding() const { return against_; }

    Mesh mesh(std::string name)
    {
        Mesh mesh;
        mesh.name = std::move(name);
        mesh.positions.reserve(table_.keys().size());
        for (const uvec3 k : table_.keys())
            mesh.positions.push_back(vec3(uintBitsToFloat(k.x), uintBitsToFloat(k.y), uintBitsToFloat(k.z)));
        mesh.triangles = std::move(triangles_);
        return mesh;
    }

  private:
    IndexTable table_;
    std::vector<uvec3> triangles_;
    std::size_t against_ = 0;
};

bool same_word(std::string_view word, std::string_view keyword)
{
    return std::equal(word.begin(), word.end(), keyword.begin(), keyword.end(),
                      [](char a, char b) { return (a >= 'A' && a <= 'Z' ? a - 'A' + 'a' : a) == b; });
}

std::size_t binary_facet_count(std::string_view bytes)
{
    std::uint32_t count = 0;
    if (bytes.size() >= header_bytes) std::memcpy(&count, bytes.data() + 80, 4);
    return count;
}

using Progress = std::function<void()>;

Facets read_binary(ByteWindow& window, std::size_t count, const Progress& progress)
{
    window.take(header_bytes);
    Facets facets(std::min<std::uint64_t>(count, window.most_left() / facet_bytes));
    for (std::size_t done = 0; done < count;) {
        while (window.view().size() < facet_bytes && window.more()) {
        }
        const std::size_t here = std::min(window.view().size() / facet_bytes, count - done);
        if (here == 0)
            throw Error({window.name()},
                        fmt::format("the header announces {} facets, but the file has only {}", count, done),
                        "it is truncated or no STL file: get or write it again");
        const char* from = window.view().data();
        for (std::size_t i = 0; i < here; ++i, from += facet_bytes) {
            float f[12];
            std::memcpy(f, from, sizeof f);
            facets.add(vec3(f[0], f[1], f[2]),
                       {vec3(f[3], f[4], f[5]), vec3(f[6], f[7], f[8]), vec3(f[9], f[10], f[11])});
        }
        done += here;
        window.take(here * facet_bytes);
        progress();
    }
    return facets;
}

Facets read_ascii(ByteWindow& window, const Progress& progress)
{
    // Some 250 bytes a facet as they are usually written; a guess only, and packed files announce too much.
    Facets facets(window.is_exact() ? window.most_left() / 250 : 0);
    TextCursor in(window);
    const auto expect = [&](std::string_view keyword) {
        const std::string_view word = in.word();
        if (!same_word(word, keyword))
            throw Error(in.place(word),
                        word.empty() ? fmt::format("the file ends where '{}' should be", keyword)
                                     : fmt::format("'{}' should be here, but there is {}", keyword, show_word(word)),
                        "mend the file or write it again");
    };
    const auto read_vec3 = [&](std::string_view what) {
        const float x = in.number(what), y = in.number(what), z = in.number(what);
        return vec3(x, y, z);
    };

    expect("solid");
    in.rest_of_line(); // a name, with spaces perhaps
    bool is_open = true;
    while (!in.at_end()) {
        const std::string_view word = in.word();
        if (same_word(word, "endsolid") && is_open) {
            in.rest_of_line();
            is_open = false;
        } else if (same_word(word, "solid") && !is_open) {
            in.rest_of_line();
            is_open = true;
        } else if (same_word(word, "facet") && is_open) {
            expect("normal");
            const vec3 normal = read_vec3("a normal's coordinate");
            expect("outer"), expect("loop");
            vec3 corners[3];
            for (vec3& corner : corners) {
                expect("vertex");
                corner = read_vec3("a vertex's coordinate");
            }
            expect("endloop"), expect("endfacet");
            facets.add(normal, corners);
            if (facets.count() % (1 << 14) == 0) progress();
        } else {
            throw Error(in.place(word),
                        fmt::format("'{}' should be here, but there is {}", is_open ? "facet' or 'endsolid" : "solid",
                                    show_word(word)),
                        "mend the file or write it again");
        }
    }
    if (is_open) throw Error(in.place(), "the file ends without 'endsolid'", "it is truncated: get or write it again");
    return facets;
}

} // namespace

Scene load_stl(const std::filesystem::path& file, const LoadOptions& options)
{
    ByteWindow window(file);
    const std::string& name = window.name();
    const std::string_view start = window.view();
    const std::size_t count = binary_facet_count(start);
    const std::uint64_t wanted = header_bytes + std::uint64_t{count} * facet_bytes;
    const std::uint64_t size = window.most_left(); // of packed files an upper bound only
    const bool says_solid = start.starts_with("solid") || trim(start.substr(0, 80)).starts_with("solid");

    Scene scene;
    scene.name = inner_stem(file);
    // A text that has its own size in bytes 80 to 83 by chance does not happen: it would be over 500 MB of ASCII art.
    // Other binary files, packed ones and those with bytes missing or left over, have a NUL somewhere in their header
    // or first facet.
    const bool has_nul = start.substr(0, header_bytes + facet_bytes).find('\0') != std::string::npos;
    const bool is_binary = start.size() >= header_bytes && (size == wanted || !says_solid || has_nul);
    if (!is_binary && !says_solid)
        throw Error({name},
                    fmt::format("{} bytes are too few for a binary STL file, and it is no ASCII one", start.size()),
                    "get or write it again");
    if (is_binary && size < wanted)
        throw Error({name},
                    fmt::format("the header announces {} facets, {} bytes in all, but the file has only {}", count,
                                wanted, size),
                    "it is truncated or no STL file: get or write it again");

    const std::function<void(double)> report = reading_progress(options, file);
    const Progress progress = [&] {
        if (window.disk_size() > 0)
            report(static_cast<double>(window.disk_done()) / static_cast<double>(window.disk_size()));
    };
    Facets facets = is_binary ? read_binary(window, count, progress) : read_ascii(window, progress);
    progress();
    if (facets.count() == 0) throw Error({name}, "contains no facets", "choose a file with a surface in it");
    // Usually two bytes or a line end; packed files are not inflated any further to count them.
    const std::uint64_t left = window.is_exact() ? window.most_left() : window.view().size();
    if (is_binary && left > 0)
        note(scene, Note::Kind::warning, fmt::format("{}: {} bytes after the last facet are ignored", name, left));
    if (facets.against_winding() > 0)
        note(scene, Note::Kind::warning,
             fmt::format("{}: {} of {} facet normals point against the winding of their vertices; the winding is used",
                         name, facets.against_winding(), facets.count()));
    MaterialDesc material;
    material.name = "default";
    Mesh mesh = facets.mesh(scene.name);
    mesh.material = add(scene, material);
    place(scene, std::move(mesh));
    return scene;
}

} // namespace snell
