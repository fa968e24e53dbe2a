#include "snell/io/ply/header.h"

#include "snell/io/text_cursor.h"

#include <array>
#include <optional>

namespace snell::ply {
namespace {

// Real files have a dozen; names are compared pair by pair.
constexpr std::size_t most_names = 1000;

std::optional<Type> find_type(std::string_view name)
{
    struct Names
    {
        std::string_view old_name, new_name;
        Type type;
    };
    static constexpr std::array<Names, 8> all = {{{"char", "int8", Type::int8},
                                                  {"uchar", "uint8", Type::uint8},
                                                  {"short", "int16", Type::int16},
                                                  {"ushort", "uint16", Type::uint16},
                                                  {"int", "int32", Type::int32},
                                                  {"uint", "uint32", Type::uint32},
                                                  {"float", "float32", Type::float32},
                                                  {"double", "float64", Type::float64}}};
    for (const Names& names : all)
        if (name == names.old_name || name == names.new_name) return names.type;
    return {};
}

// Thrown where the view ends within the header.
struct Incomplete
{
};

// The header line by line; each ends as the first one does, for a binary body may begin with a byte that looks like
// half a line end.
class Lines
{
  public:
    Lines(const std::string& file, std::string_view bytes, bool is_all) : file_(file), bytes_(bytes), is_all_(is_all)
    {
        const std::size_t first = bytes.find_first_of("\r\n");
        if (first == std::string_view::npos) return;
        end_of_line_ = bytes.substr(first, bytes.substr(first).starts_with("\r\n") ? 2 : 1);
    }

    std::string_view next()
    {
        const std::size_t end = end_of_line_.empty() ? std::string_view::npos : bytes_.find(end_of_line_, offset_);
        ++line_;
        if (end == std::string_view::npos && !is_all_) throw Incomplete();
        if (end == std::string_view::npos)
            fail("the header has no 'end_header'", "the file is truncated: get or write it again");
        const std::string_view line = bytes_.substr(offset_, end - offset_);
        offset_ = end + end_of_line_.size();
        return line;
    }

    std::size_t offset() const { return offset_; }
    int line() const { return line_; }

    [[noreturn]] void fail(const std::string& message, const std::string& remedy = "mend the header") const
    {
        throw Error(Place{file_, line_, 0}, message, remedy);
    }

  private:
    std::string file_;
    std::string_view bytes_, end_of_line_;
    bool is_all_;
    std::size_t offset_ = 0;
    int line_ = 0;
};

std::string_view take_word(std::string_view& line)
{
    while (!line.empty() && is_space(line.front())) line.remove_prefix(1);
    std::size_t length = 0;
    while (length < line.size() && !is_space(line[length])) ++length;
    const std::string_view word = line.substr(0, length);
    line.remove_prefix(length);
    return word;
}

Type read_type(const Lines& lines, std::string_view word)
{
    const std::optional<Type> type = find_type(word);
    if (!type)
        lines.fail(fmt::format("{} is not a type", show_word(word)),
                   "use char, uchar, short, ushort, int, uint, float or double");
    return *type;
}

Element read_element(const Lines& lines, const Header& header, std::string_view line)
{
    Element element;
    element.name = take_word(line);
    const std::string_view count = take_word(line);
    const auto result = std::from_chars(count.data(), count.data() + count.size(), element.count);
    if (element.name.empty() || count.empty() || result.ec != std::errc() || result.ptr != count.data() + count.size())
        lines.fail(fmt::format("an element's line is 'element NAME COUNT', but the count is {}", show_word(count)));
    if (header.find(element.name)) lines.fail(fmt::format("a second element {}", show_word(element.name)));
    return element;
}

Property read_property(const Lines& lines, std::string_view line)
{
    Property property;
    std::string_view type = take_word(line);
    if (type == "list") {
        property.is_list = true;
        property.count_type = read_type(lines, take_word(line));
        if (!is_integer(property.count_type)) lines.fail("a list's length is of no integer type");
        type = take_word(line);
    }
    property.type = read_type(lines, type);
    property.name = take_word(line);
    if (property.name.empty()) lines.fail("a property without a name");
    return property;
}

} // namespace

std::size_t size_of(Type type)
{
    switch (type) {
    case Type::int8:
    case Type::uint8:
        return 1;
    case Type::int16:
    case Type::uint16:
        return 2;
    case Type::int32:
    case Type::uint32:
    case Type::float32:
        return 4;
    case Type::float64:
        return 8;
    }
    return 8;
}

bool is_integer(Type type)
{
    return type != Type::float32 && type != Type::float64;
}

std::size_t Element::least_row_bytes(Format format) const
{
    // In a text each value takes a digit and a space; the very last space may be missing.
    if (format == Format::ascii) return 2 * properties.size();
    std::size_t bytes = 0;
    for (const Property& property : properties)
        bytes += size_of(property.is_list ? property.count_type : property.type);
    return bytes;
}

bool Element::has_lists() const
{
    for (const Property& property : properties)
        if (property.is_list) return true;
    return false;
}

const Element* Header::find(std::string_view element) const
{
    for (const Element& e : elements)
        if (e.name == element) return &e;
    return nullptr;
}

static Header read_lines(const std::string& file, std::string_view bytes, bool is_all)
{
    if (!bytes.starts_with("ply") || (bytes.size() > 3 && !is_space(bytes[3])))
        throw Error({file, 1, 1}, "does not begin with 'ply'", "it is no PLY file: check the name and how it was made");

    Header header;
    Lines lines(file, bytes, is_all);
    lines.next();
    bool has_format = false;
    for (;;) {
        std::string_view line = lines.next();
        const std::string_view keyword = take_word(line);
        if (keyword == "end_header") break;
        if (keyword == "comment" && take_word(line) == "TextureFile" && header.textures.size() < most_names)
            header.textures.emplace_back(trim(line));
        if (keyword.empty() || keyword == "comment" || keyword == "obj_info") continue;
        if (keyword == "format") {
            const std::string_view format = take_word(line), version = take_word(line);
            if (format == "ascii")
                header.format = Format::ascii;
            else if (format == "binary_little_endian")
                header.format = Format::little_endian;
            else if (format == "binary_big_endian")
                header.format = Format::big_endian;
            else
                lines.fail(fmt::format("unknown format {}", show_word(format)));
            if (version != "1.0")
                lines.fail(fmt::format("unknown version {}", show_word(version)), "write it as version 1.0");
            has_format = true;
        } else if (keyword == "element") {
            if (header.elements.size() == most_names) lines.fail("more than 1000 elements");
            header.elements.push_back(read_element(lines, header, line));
        } else if (keyword == "property") {
            if (header.elements.empty()) lines.fail("a property before the first element");
            Element& element = header.elements.back();
            if (element.properties.size() == most_names) lines.fail("more than 1000 properties");
            element.properties.push_back(read_property(lines, line));
            for (std::size_t i = 0; i + 1 < element.properties.size(); ++i)
                if (element.properties[i].name == element.properties.back().name)
                    lines.fail(fmt::format("a second property {}", show_word(element.properties.back().name)));
        } else {
            lines.fail(fmt::format("unknown keyword {}", show_word(keyword)));
        }
    }
    if (!has_format) lines.fail("the header has no 'format' line");
    header.body = lines.offset();
    header.lines = lines.line();
    return header;
}

std::optional<Header> read_header(const std::string& file, std::string_view bytes, bool is_all)
{
    try {
        return read_lines(file, bytes, is_all);
    } catch (const Incomplete&) {
        return {};
    }
}

void check_counts(const std::string& file, const Header& header, std::uint64_t left)
{
    if (header.format == Format::ascii) ++left;
    for (const Element& element : header.elements) {
        const std::size_t row = element.least_row_bytes(header.format);
        if (row > 0 && element.count > left / row)
            throw Error(
                {file},
                fmt::format("the header announces {} rows of {}, at least {} bytes each, but only {} bytes are left",
                            element.count, show_word(element.name), row, left),
                "the file is truncated or its header wrong: get or write it again");
        left -= row * element.count;
    }
}

} // namespace snell::ply
