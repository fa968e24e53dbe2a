// The header of a PLY file.
#pragma once

#include <cstdint>
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
    std::size_t body = 0; // byte offset of what follows the header

    const Element* find(std::string_view element) const;
};

// Throws Error with the line. No element announces more rows than the rest of the file has bytes for: it is safe to
// allocate by the counts.
Header read_header(const std::string& file, std::string_view bytes);

} // namespace snell::ply
