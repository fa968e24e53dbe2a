// The header of a PLY file.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace snell::ply {

enum class Format
{
    ascii,
    little_endian,
    big_endian
};

enum class Type
{
    int8,
    uint8,
    int16,
    uint16,
    int32,
    uint32,
    float32,
    float64
};

std::size_t size_of(Type type); // bytes in a binary file
bool is_integer(Type type);

struct Property
{
    std::string name;
    Type type = Type::float32; // of the value, or of a list's items
    bool is_list = false;
    Type count_type = Type::uint8; // of a list's length
};

struct Element
{
    std::string name;
    std::uint64_t count = 0;
    std::vector<Property> properties;

    std::size_t least_row_bytes(Format format) const; // with all lists empty
    bool has_lists() const;
};

struct Header
{
    Format format = Format::ascii;
    std::vector<Element> elements;
    std::vector<std::string> textures; // what 'comment TextureFile' says, as MeshLab writes it
    std::size_t body = 0;              // byte offset of what follows the header
    int lines = 0;                     // of the header

    const Element* find(std::string_view element) const;
};

// bytes: as much of the file as is in view. Empty if the header is not complete and there is more (is_all false).
// Throws Error with the line.
std::optional<Header> read_header(const std::string& file, std::string_view bytes, bool is_all);

// Throws Error if an element announces more rows than `left` bytes behind the header can hold: after that it is safe to
// allocate by the counts.
void check_counts(const std::string& file, const Header& header, std::uint64_t left);

} // namespace snell::ply
