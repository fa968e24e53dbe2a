// The elements of a PLY file into a mesh.
#pragma once

#include "snell/core/parallel.h"
#include "snell/io/ply/faces.h"
#include "snell/io/ply/reader.h"
#include "snell/io/ply/vertices.h"

#include <algorithm>
#include <atomic>
#include <functional>

namespace snell::ply {

// What there was beside the mesh.
struct Rest
{
    std::string unused;           // names of what was skipped
    std::uint64_t degenerate = 0; // faces with less than three vertices
    bool leftover = false;        // there is more in the file
    bool wedges = false;          // texture coordinates are those of the faces' corners
    std::vector<uint> triangle_textures;
};

template <class Reader>
class Body
{
  public:
    // progress: called now and then. texture_count: of the file.
    Body(const Header& header, Reader reader, std::function<void()> progress, std::size_t texture_count)
        : header_(header), reader_(std::move(reader)), progress_(std::move(progress)), texture_count_(texture_count),
          faces_(mesh_, has_property(header, "texcoord", true),
                 texture_count > 1 && has_property(header, "texnumber", false))
    {
        if (const Element* vertices = header.find("vertex")) vertex_count_ = vertices->count;
    }

    Mesh read(Rest& rest)
    {
        for (const Element& element : header_.elements) {
            if (element.name == "vertex")
                read_vertices(element);
            else if (element.name == "face")
                read_faces(element);
            else if (element.name == "tristrips")
                read_strips(element);
            else
                skip_element(element);
        }
        rest_.wedges = faces_.finish();
        rest_.degenerate = faces_.degenerate;
        rest_.triangle_textures = std::move(faces_.triangle_textures);
        rest_.leftover = !reader_.at_end();
        rest = std::move(rest_);
        return std::move(mesh_);
    }

  private:
    static constexpr std::size_t grain = 1 << 12;
    static constexpr std::size_t few_rows = 1 << 10;

    static bool has_property(const Header& header, std::string_view name, bool is_list)
    {
        if (const Element* faces = header.find("face"))
            for (const Property& property : faces->properties)
                if (property.is_list == is_list && property.name == name) return true;
        return false;
    }

    void say_unused(const std::string& name)
    {
        constexpr std::size_t long_enough = 300;
        std::string& all = rest_.unused;
        if (all.size() < long_enough)
            all += (all.empty() ? "" : ", ") + name.substr(0, 40);
        else if (!all.ends_with("..."))
            all += ", ...";
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

    // ---- vertices ----

    void read_vertices(const Element& element)
    {
        const Layout layout = read_layout(element);
        for (const std::string& name : layout.unused) say_unused(name);
        if (!layout.positions) reader_.fail("the vertices have no x, y and z", "write the file with these properties");
        if (element.count >= none) reader_.fail("more than 4294967294 vertices", "split the file");
        reserve(mesh_, layout, element.count);
        if constexpr (Reader::is_binary)
            if (layout.row_bytes > 0) return read_vertex_rows(layout, element.count);

        resize(mesh_, layout, element.count);
        Target targets[slot_count];
        for (int slot = 0; slot < slot_count; ++slot) targets[slot] = target_of(static_cast<Slot>(slot), mesh_, 0);
        for (std::size_t i = 0; i < element.count; ++i) {
            if (i % (1 << 16) == 0) progress_();
            for (const Column& column : layout.columns) {
                if (column.slot == slot_unused) {
                    skip(*column.property);
                    continue;
                }
                const float value = convert(reader_.number(column.property->type), column.slot, column.property->type);
                if (const Target& to = targets[column.slot]; to.to) to.to[i * to.stride] = value;
            }
        }
    }

    // Rows of one length: as many as are in view, by several threads.
    void read_vertex_rows(const Layout& layout, std::size_t count)
    {
        for (std::size_t done = 0; done < count;) {
            const std::string_view bytes = reader_.rows(layout.row_bytes);
            const std::size_t rows = std::min(bytes.size() / layout.row_bytes, count - done);
            if (rows == 0) reader_.fail_truncated();
            resize(mesh_, layout, done + rows);
            parallel_ranges(rows, grain, [&](std::size_t begin, std::size_t end) {
                // In pieces that stay in the first-level cache while each column is taken out.
                constexpr std::size_t piece = 256;
                for (std::size_t first = begin; first < end; first += piece)
                    for (const Column& column : layout.columns)
                        take_column(layout, column, bytes, done, first, std::min(end, first + piece));
            });
            done += rows;
            reader_.take_bytes(rows * layout.row_bytes);
            progress_();
        }
    }

    void take_column(const Layout& layout, const Column& column, std::string_view bytes, std::size_t base,
                     std::size_t begin, std::size_t end)
    {
        const Target to = target_of(column.slot, mesh_, base);
        if (!to.to) return;
        const char* from = bytes.data() + column.offset + begin * layout.row_bytes;
        with_type(column.property->type, [&](auto t) {
            const bool is_plain = column.slot < slot_red;
            for (std::size_t i = begin; i < end; ++i, from += layout.row_bytes) {
                const auto value = static_cast<float>(load_value<decltype(t), Reader::swaps_bytes>(from));
                to.to[i * to.stride] = is_plain ? value : convert(value, column.slot, column.property->type);
            }
        });
    }

    // ---- faces ----

    // The list of an element's rows that holds vertex indices.
    const Property* find_indices(const Element& element)
    {
        const Property* indices = nullptr;
        for (const Property& property : element.properties)
            if (property.is_list && (property.name == "vertex_indices" || property.name == "vertex_index")) {
                indices = &property;
                break;
            }
        if (!indices && element.count > 0)
            reader_.fail(fmt::format("the element '{}' has no list vertex_indices", element.name),
                         "write the file with this property");
        if (indices && !is_integer(indices->type))
            reader_.fail("vertex_indices are of no integer type", "write the file with integer indices");
        return indices;
    }

    void read_list(const Property& property)
    {
        const std::uint64_t count = list_length(property);
        corners_.clear();
        for (std::uint64_t k = 0; k < count; ++k) corners_.push_back(reader_.integer(property.type));
    }

    void read_faces(const Element& element)
    {
        const Property* const indices = find_indices(element);
        const Property *wedges = nullptr, *texture = nullptr;
        for (const Property& property : element.properties) {
            if (property.is_list && property.name == "texcoord")
                wedges = &property;
            else if (!property.is_list && property.name == "texnumber" && texture_count_ > 1)
                texture = &property;
            else if (&property != indices)
                say_unused(element.name + "'s " + property.name);
        }
        mesh_.triangles.reserve(element.count);
        std::uint64_t done = 0;
        while (done < element.count) {
            if constexpr (Reader::is_binary)
                if (faces_.is_plain()) done += read_face_rows(element, *indices, element.count - done);
            // One by one: what the rows in view are not alike in.
            constexpr std::uint64_t some = 256;
            for (std::uint64_t k = 0; k < some && done < element.count; ++k, ++done)
                read_face(element, indices, wedges, texture);
            if (done % (1 << 16) < some) progress_();
        }
    }

    void read_face(const Element& element, const Property* indices, const Property* wedges, const Property* texture)
    {
        uvs_.clear();
        uint number = 0;
        for (const Property& property : element.properties) {
            if (&property == indices) {
                read_list(property);
            } else if (&property == wedges) {
                for (std::uint64_t left = list_length(property); left > 0; --left)
                    uvs_.push_back(reader_.number(property.type));
            } else if (&property == texture) {
                const float wanted = reader_.number(property.type);
                if (wanted > 0 && wanted < static_cast<float>(texture_count_)) number = static_cast<uint>(wanted);
            } else {
                skip(property);
            }
        }
        vertices_.clear();
        if (corners_.size() >= 3)
            for (const long long index : corners_) vertices_.push_back(checked(index));
        faces_.add_face(vertices_, uvs_, number);
    }

    // Faces of one size, as many as are in view and begin here, by several threads. Returns how many.
    std::uint64_t read_face_rows(const Element& element, const Property& indices, std::uint64_t most)
    {
        std::size_t before = 0, behind = 0;
        for (const Property& property : element.properties) {
            if (property.is_list && &property != &indices) return 0;
            if (!property.is_list) (&property < &indices ? before : behind) += size_of(property.type);
        }
        const std::size_t start = before + size_of(indices.count_type);
        const std::string_view first = reader_.rows(start);
        if (first.size() < start) return 0;
        const auto size_at = [&](const char* row) {
            return with_type(indices.count_type, [&](auto t) {
                return static_cast<long long>(load_value<decltype(t), Reader::swaps_bytes>(row + before));
            });
        };
        const long long size = size_at(first.data());
        constexpr long long most_corners = 64;
        if (size < 3 || size > most_corners) return 0;
        const auto corners = static_cast<std::size_t>(size);
        const std::size_t row = start + corners * size_of(indices.type) + behind;
        const std::string_view bytes = reader_.rows(row);
        const std::size_t tried =
            std::min(most_rows_, static_cast<std::size_t>(std::min<std::uint64_t>(bytes.size() / row, most)));
        if (tried == 0) return 0;
        std::size_t rows = tried;

        std::atomic<std::size_t> alike = rows, wrong = rows;
        const auto lower = [](std::atomic<std::size_t>& to, std::size_t value) {
            std::size_t known = to.load();
            while (value < known && !to.compare_exchange_weak(known, value)) {
            }
        };
        const std::size_t old = mesh_.triangles.size();
        if (corners == 3)
            mesh_.triangles.resize(old + rows);
        else
            vertices_.resize(corners * rows);
        with_type(indices.type, [&](auto t) {
            using T = decltype(t);
            uint* const to = corners == 3 ? &mesh_.triangles.data()[old].x : vertices_.data();
            parallel_ranges(rows, grain, [&](std::size_t begin, std::size_t end) {
                const char* from = bytes.data() + begin * row;
                for (std::size_t i = begin; i < end; ++i, from += row) {
                    if (size_at(from) != size) return lower(alike, i);
                    for (std::size_t k = 0; k < corners; ++k) {
                        const auto index =
                            static_cast<std::int64_t>(load_value<T, Reader::swaps_bytes>(from + start + k * sizeof(T)));
                        if (index < 0 || static_cast<std::uint64_t>(index) >= vertex_count_) return lower(wrong, i);
                        to[i * corners + k] = static_cast<uint>(index);
                    }
                }
            });
        });
        rows = std::min(alike.load(), wrong.load());
        if (corners == 3) {
            mesh_.triangles.resize(old + rows);
        } else {
            vertices_.resize(corners * rows);
            faces_.add_faces(vertices_, static_cast<uint>(corners));
        }
        reader_.take_bytes(rows * row);
        // Where sizes change often, most of what was tried is in vain.
        most_rows_ = rows == tried ? 8 * std::min(most_rows_, bytes.size()) : few_rows;
        return rows; // a wrong index is met again, and reported, one by one
    }

    // -1 begins a new strip; every second triangle of a strip runs the other way round.
    void read_strips(const Element& element)
    {
        const Property* const indices = find_indices(element);
        for (const Property& property : element.properties)
            if (&property != indices) say_unused(element.name + "'s " + property.name);
        for (std::uint64_t row = 0; row < element.count; ++row)
            for (const Property& property : element.properties) {
                if (&property != indices) {
                    skip(property);
                    continue;
                }
                read_list(property);
                add_strip();
            }
    }

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
            const uint forward[3] = {a, b, c}, backward[3] = {b, a, c};
            faces_.add_face((i - start) % 2 == 0 ? forward : backward, {}, 0);
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

    const Header& header_;
    Reader reader_;
    std::function<void()> progress_;
    std::size_t texture_count_;
    Mesh mesh_;
    Rest rest_;
    Faces faces_;
    std::uint64_t vertex_count_ = 0;
    std::size_t most_rows_ = few_rows; // to be tried in one go
    std::vector<long long> corners_;   // of the face at hand
    std::vector<uint> vertices_;       // the same, checked
    std::vector<float> uvs_;
};

} // namespace snell::ply
