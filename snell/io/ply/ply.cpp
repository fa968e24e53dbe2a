#include "snell/io/ply/ply.h"

#include "snell/io/file.h"
#include "snell/io/ply/reader.h"
#include "snell/io/polygon.h"
#include "snell/kernel/tone.h"

#include <array>

namespace snell {
namespace {

using namespace ply;

// What a vertex property is for; also its place in a row of values.
enum Slot
{
    slot_x,
    slot_y,
    slot_z,
    slot_nx,
    slot_ny,
    slot_nz,
    slot_u,
    slot_v,
    slot_red,
    slot_green,
    slot_blue,
    slot_count,
    slot_unused = slot_count
};

Slot find_slot(const Property& property)
{
    struct Name
    {
        std::string_view name;
        Slot slot;
    };
    static constexpr Name all[] = {{"x", slot_x},
                                   {"y", slot_y},
                                   {"z", slot_z},
                                   {"nx", slot_nx},
                                   {"ny", slot_ny},
                                   {"nz", slot_nz},
                                   {"u", slot_u},
                                   {"v", slot_v},
                                   {"s", slot_u},
                                   {"t", slot_v},
                                   {"texture_u", slot_u},
                                   {"texture_v", slot_v},
                                   {"red", slot_red},
                                   {"green", slot_green},
                                   {"blue", slot_blue},
                                   {"diffuse_red", slot_red},
                                   {"diffuse_green", slot_green},
                                   {"diffuse_blue", slot_blue}};
    if (!property.is_list)
        for (const Name& name : all)
            if (property.name == name.name) return name.slot;
    return slot_unused;
}

// Colours in integers are encoded with the sRGB curve, as the scanners' and editors' byte colours are.
float decode_color(float value, Type type)
{
    if (!is_integer(type)) return value;
    const bool is_byte = type == Type::uint8 || type == Type::int8;
    return srgb_decode(value / (is_byte ? 255.0f : 65535.0f));
}

// Reads the elements of one file into a mesh.
template <class Reader>
class Body
{
  public:
    Body(const Header& header, Reader reader) : reader_(std::move(reader))
    {
        for (int i = 0; i < 256; ++i)
            byte_colors_[static_cast<std::size_t>(i)] = srgb_decode(static_cast<float>(i) / 255.0f);
        if (const Element* vertices = header.find("vertex")) vertex_count_ = vertices->count;
    }

    Mesh read(const Header& header)
    {
        for (const Element& element : header.elements) {
            if (element.name == "vertex")
                read_vertices(element);
            else if (element.name == "face")
                read_index_lists(element, &Body::add_face);
            else if (element.name == "tristrips")
                read_index_lists(element, &Body::add_strip);
            else
                skip_element(element);
        }
        cut_polygons();
        if (!reader_.at_end()) leftover = true;
        return std::move(mesh_);
    }

    std::string unused;           // names of what was skipped
    std::uint64_t degenerate = 0; // faces with less than three vertices
    bool leftover = false;        // there is more in the file

  private:
    void say_unused(const std::string& name)
    {
        constexpr std::size_t long_enough = 300;
        if (unused.size() < long_enough)
            unused += (unused.empty() ? "" : ", ") + name.substr(0, 40);
        else if (!unused.ends_with("..."))
            unused += ", ...";
    }

    void skip(const Property& property)
    {
        std::uint64_t count = 1;
        if (property.is_list) count = list_length(property);
        reader_.skip(property.type, count);
    }

    std::uint64_t list_length(const Property& property)
    {
        const long long count = reader_.integer(property.count_type);
        if (count < 0 || !reader_.can_hold(property.type, static_cast<std::uint64_t>(count)))
            reader_.fail(fmt::format("a list of {} values, which the rest of the file cannot hold", count),
                         "the file is truncated or damaged: get or write it again");
        return static_cast<std::uint64_t>(count);
    }

    void skip_element(const Element& element)
    {
        say_unused(element.name);
        if (element.properties.empty()) return; // its rows have no bytes, whatever their number
        for (std::uint64_t i = 0; i < element.count; ++i)
            for (const Property& property : element.properties) skip(property);
    }

    void read_vertices(const Element& element)
    {
        struct Column
        {
            const Property* property;
            Slot slot;
        };
        std::vector<Column> columns;
        std::array<bool, slot_count + 1> has{};
        for (const Property& property : element.properties) {
            Slot slot = find_slot(property);
            if (has[slot]) slot = slot_unused; // the first of two names for one thing counts
            if (slot == slot_unused)
                say_unused(property.name);
            else
                has[slot] = true;
            columns.push_back({&property, slot});
        }
        if (!has[slot_x] || !has[slot_y] || !has[slot_z])
            reader_.fail("the vertices have no x, y and z", "write the file with these properties");
        if (element.count >= none) reader_.fail("more than 4294967294 vertices", "split the file");

        const bool normals = has[slot_nx] && has[slot_ny] && has[slot_nz];
        const bool uvs = has[slot_u] && has[slot_v];
        const bool colors = has[slot_red] && has[slot_green] && has[slot_blue];
        const std::size_t count = element.count;
        mesh_.positions.reserve(count);
        if (normals) mesh_.normals.reserve(count);
        if (uvs) mesh_.uvs.reserve(count);
        if (colors) mesh_.colors.reserve(count);

        float row[slot_count] = {};
        for (std::size_t i = 0; i < count; ++i) {
            for (const Column& column : columns) {
                if (column.slot == slot_unused)
                    skip(*column.property);
                else if (column.slot < slot_red)
                    row[column.slot] = reader_.number(column.property->type);
                else
                    row[column.slot] = color(column.property->type);
            }
            mesh_.positions.push_back(vec3(row[slot_x], row[slot_y], row[slot_z]));
            if (normals) mesh_.normals.push_back(vec3(row[slot_nx], row[slot_ny], row[slot_nz]));
            if (uvs) mesh_.uvs.push_back(vec2(row[slot_u], row[slot_v]));
            if (colors) mesh_.colors.push_back(vec3(row[slot_red], row[slot_green], row[slot_blue]));
        }
    }

    float color(Type type)
    {
        if (type != Type::uint8) return decode_color(reader_.number(type), type);
        const long long byte = reader_.integer(type);
        return byte_colors_[static_cast<std::size_t>(std::clamp(byte, 0ll, 255ll))]; // a text may say anything
    }

    // The one list of each row that holds vertex indices goes to `add`.
    void read_index_lists(const Element& element, void (Body::*add)())
    {
        const Property* indices = nullptr;
        for (const Property& property : element.properties) {
            const bool is_it =
                property.is_list && (property.name == "vertex_indices" || property.name == "vertex_index");
            if (is_it && !indices)
                indices = &property;
            else
                say_unused(element.name + "'s " + property.name);
        }
        if (!indices && element.count > 0)
            reader_.fail(fmt::format("the element '{}' has no list vertex_indices", element.name),
                         "write the file with this property");
        if (indices && !is_integer(indices->type))
            reader_.fail("vertex_indices are of no integer type", "write the file with integer indices");
        if (element.name == "face") mesh_.triangles.reserve(element.count);

        for (std::uint64_t i = 0; i < element.count; ++i) {
            for (const Property& property : element.properties) {
                if (&property != indices) {
                    skip(property);
                    continue;
                }
                const std::uint64_t count = list_length(property);
                corners_.clear();
                for (std::uint64_t k = 0; k < count; ++k) corners_.push_back(reader_.integer(property.type));
                (this->*add)();
            }
        }
    }

    uint checked(long long index)
    {
        if (index < 0 || static_cast<std::uint64_t>(index) >= vertex_count_)
            reader_.fail(
                fmt::format("vertex {} is referred to, but there are {}, counted from 0", index, vertex_count_),
                "the file is damaged: get or write it again");
        return static_cast<uint>(index);
    }

    void add_face()
    {
        if (corners_.size() == 3) {
            mesh_.triangles.push_back(uvec3(checked(corners_[0]), checked(corners_[1]), checked(corners_[2])));
        } else if (corners_.size() > 3) {
            polygon_sizes_.push_back(static_cast<uint>(corners_.size()));
            for (const long long index : corners_) polygon_corners_.push_back(checked(index));
        } else {
            ++degenerate;
        }
    }

    // -1 begins a new strip; every second triangle of a strip runs the other way round.
    void add_strip()
    {
        std::size_t start = 0;
        for (std::size_t i = 0; i < corners_.size(); ++i) {
            if (corners_[i] == -1) {
                start = i + 1;
                continue;
            }
            const uint c = checked(corners_[i]);
            if (i < start + 2) continue;
            const uint a = checked(corners_[i - 2]), b = checked(corners_[i - 1]);
            if (a == b || b == c || c == a) continue; // strips are joined by such triangles
            mesh_.triangles.push_back((i - start) % 2 == 0 ? uvec3(a, b, c) : uvec3(b, a, c));
        }
    }

    // Only now: the faces may come before the vertices.
    void cut_polygons()
    {
        Triangulator triangulate;
        std::vector<vec3> points;
        std::size_t first = 0;
        for (const uint size : polygon_sizes_) {
            const std::span<const uint> corners(polygon_corners_.data() + first, size);
            points.clear();
            for (const uint corner : corners) points.push_back(mesh_.positions[corner]);
            for (const uvec3 t : triangulate(points))
                mesh_.triangles.push_back(uvec3(corners[t.x], corners[t.y], corners[t.z]));
            first += size;
        }
    }

    Reader reader_;
    Mesh mesh_;
    std::uint64_t vertex_count_ = 0;
    std::vector<long long> corners_; // of the face at hand
    std::vector<uint> polygon_sizes_, polygon_corners_;
    std::array<float, 256> byte_colors_{};
};

template <class Reader>
Mesh read_body(Scene& scene, const std::string& name, std::string_view bytes, const Header& header)
{
    Body<Reader> body(header, Reader(name, bytes, header.body));
    Mesh mesh = body.read(header);
    if (mesh.triangles.empty())
        throw Error({name},
                    mesh.positions.empty() ? "contains no vertices"
                                           : fmt::format("contains {} points, but no faces", mesh.positions.size()),
                    "choose a file with a surface in it");
    if (!body.unused.empty()) note(scene, Note::Kind::info, fmt::format("{}: not used: {}", name, body.unused));
    if (body.degenerate > 0)
        note(scene, Note::Kind::warning,
             fmt::format("{}: {} faces have less than three vertices and are dropped", name, body.degenerate));
    if (body.leftover)
        note(scene, Note::Kind::warning, fmt::format("{}: there is more in the file than its header announces", name));
    return mesh;
}

} // namespace

Scene load_ply(const std::filesystem::path& file)
{
    const std::string bytes = read_file(file);
    const std::string name = file.string();
    const Header header = read_header(name, bytes);

    Scene scene;
    scene.name = file.stem().string();
    Mesh mesh;
    switch (header.format) {
    case Format::ascii:
        mesh = read_body<AsciiReader>(scene, name, bytes, header);
        break;
    case Format::little_endian:
        mesh = read_body<BinaryReader<false>>(scene, name, bytes, header);
        break;
    case Format::big_endian:
        mesh = read_body<BinaryReader<true>>(scene, name, bytes, header);
        break;
    }
    mesh.name = scene.name;
    MaterialDesc material;
    material.name = "default";
    if (!mesh.colors.empty()) material.base_color = vec3(1.0f); // the vertices' colours multiply it
    mesh.material = add(scene, material);
    place(scene, std::move(mesh));
    return scene;
}

} // namespace snell
