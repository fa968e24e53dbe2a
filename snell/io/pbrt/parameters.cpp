#include "snell/io/pbrt/parameters.h"

#include "snell/io/pbrt/notes.h"
#include "snell/io/text_cursor.h"

#include <array>
#include <cmath>

namespace snell::pbrt {
namespace {

struct TypeName
{
    std::string_view name;
    Type type;
};

constexpr std::array<TypeName, 17> type_names = {{{"integer", Type::integer},
                                                  {"float", Type::number},
                                                  {"point2", Type::point2},
                                                  {"vector2", Type::vector2},
                                                  {"point3", Type::point3},
                                                  {"point", Type::point3},
                                                  {"vector3", Type::vector3},
                                                  {"vector", Type::vector3},
                                                  {"normal", Type::normal},
                                                  {"spectrum", Type::spectrum},
                                                  {"rgb", Type::rgb},
                                                  {"color", Type::rgb},
                                                  {"xyz", Type::xyz},
                                                  {"blackbody", Type::blackbody},
                                                  {"bool", Type::boolean},
                                                  {"string", Type::string},
                                                  {"texture", Type::texture}}};

Type find_type(std::string_view name)
{
    for (const TypeName& t : type_names)
        if (t.name == name) return t.type;
    return Type::unknown;
}

std::size_t numbers_each(Type type)
{
    switch (type) {
    case Type::point2:
    case Type::vector2:
        return 2;
    case Type::point3:
    case Type::vector3:
    case Type::normal:
    case Type::rgb:
    case Type::xyz:
        return 3;
    default:
        return 1;
    }
}

[[noreturn]] void fail(const Token& token, const Parameter& parameter, std::string_view wanted)
{
    throw Error(token.spot.place(),
                fmt::format("{} should be here, for \"{} {}\", but there is {}", wanted, parameter.type_name,
                            parameter.name, token.kind == Token::Kind::end ? "the end" : show_word(token.text)),
                "mend the value");
}

float read_number(const Token& token, const Parameter& parameter)
{
    float value = 0;
    const char* p = token.text.data();
    const char* const end = p + token.text.size();
    if (token.kind != Token::Kind::word || !read_float(p, end, value) || p != end) fail(token, parameter, "a number");
    // 'inf' may be meant; 1e999 is a slip.
    if (std::isinf(value) && token.text.find_first_of("nN") == std::string_view::npos)
        throw Error(token.spot.place(), fmt::format("{} is too large for a number", show_word(token.text)),
                    "numbers go to 3.4e38");
    return value;
}

int read_integer(const Token& token, const Parameter& parameter)
{
    int value = 0;
    std::string_view text = token.text;
    if (text.starts_with('+')) text.remove_prefix(1);
    const char* const end = text.data() + text.size();
    const auto result = std::from_chars(text.data(), end, value);
    if (token.kind == Token::Kind::word && result.ec == std::errc() && result.ptr == end) return value;
    // Exporters write 3.0, or 1e3.
    const float number = read_number(token, parameter);
    if (number == std::floor(number) && std::abs(number) < 2147483520.0f) return static_cast<int>(number);
    fail(token, parameter, "a whole number");
}

void read_value(const Token& token, Parameter& parameter)
{
    switch (parameter.type) {
    case Type::integer:
        parameter.integers.push_back(read_integer(token, parameter));
        return;
    case Type::boolean:
        if (token.text == "true" || token.text == "false")
            parameter.integers.push_back(token.text == "true");
        else
            fail(token, parameter, "true or false");
        return;
    case Type::string:
    case Type::texture:
        if (token.kind != Token::Kind::string) fail(token, parameter, "a string in quotes");
        parameter.strings.push_back(unescape(token.text));
        return;
    case Type::spectrum:
        if (token.kind == Token::Kind::string)
            parameter.strings.push_back(unescape(token.text));
        else
            parameter.numbers.push_back(read_number(token, parameter));
        return;
    case Type::unknown:
        return;
    default:
        parameter.numbers.push_back(read_number(token, parameter));
    }
}

} // namespace

ParameterList ParameterList::read(Tokenizer& tokens, Spot directive, Notes& notes)
{
    ParameterList result;
    result.spot = directive;
    while (tokens.peek().kind == Token::Kind::string) {
        const Token declaration = tokens.next();
        std::string_view text = trim(declaration.text);
        const std::size_t blank = text.find_first_of(" \t");
        Parameter parameter;
        parameter.spot = declaration.spot;
        parameter.type_name = text.substr(0, blank);
        parameter.name = blank == std::string_view::npos ? "" : trim(text.substr(blank));
        if (parameter.name.empty())
            throw Error(declaration.spot.place(),
                        fmt::format("\"type name\" of a parameter should be here, but there is {}",
                                    show_word(declaration.text)),
                        "write \"float radius\" or the like");
        parameter.type = find_type(parameter.type_name);
        if (parameter.type == Type::unknown)
            notes.warn(parameter.spot, "type " + parameter.type_name,
                       fmt::format("a parameter's type {} is unknown; what has it is ignored",
                                   show_word(parameter.type_name)));

        Token value = tokens.next();
        if (value.kind == Token::Kind::open) {
            for (value = tokens.next(); value.kind != Token::Kind::close; value = tokens.next()) {
                if (value.kind == Token::Kind::open) fail(value, parameter, "a value");
                if (value.kind == Token::Kind::end)
                    throw Error(parameter.spot.place(), "the file ends before the ']' of this parameter",
                                "it is truncated: get or write it again");
                read_value(value, parameter);
            }
        } else if (value.kind == Token::Kind::word || value.kind == Token::Kind::string) {
            read_value(value, parameter);
        } else {
            fail(value, parameter, "a value");
        }
        const std::size_t each = numbers_each(parameter.type);
        if (parameter.numbers.size() % each != 0)
            throw Error(parameter.spot.place(),
                        fmt::format("\"{} {}\" has {} numbers, which is no multiple of {}", parameter.type_name,
                                    parameter.name, parameter.numbers.size(), each),
                        "numbers are missing");
        if (parameter.type != Type::unknown) result.list_.push_back(std::move(parameter));
    }
    return result;
}

const Parameter* ParameterList::find(std::string_view name, std::initializer_list<Type> types) const
{
    for (const Parameter& parameter : list_) {
        if (parameter.name != name) continue;
        if (types.size() != 0 && std::find(types.begin(), types.end(), parameter.type) == types.end()) continue;
        parameter.used = true;
        return &parameter;
    }
    return nullptr;
}

bool ParameterList::has(std::string_view name) const
{
    return std::any_of(list_.begin(), list_.end(), [&](const Parameter& p) { return p.name == name; });
}

std::optional<float> ParameterList::number(std::string_view name) const
{
    const Parameter* p = find(name, {Type::number, Type::integer});
    if (p == nullptr) return {};
    if (!p->integers.empty()) return static_cast<float>(p->integers[0]);
    if (!p->numbers.empty() && std::isfinite(p->numbers[0])) return p->numbers[0];
    return {};
}

float ParameterList::number(std::string_view name, float otherwise) const
{
    return number(name).value_or(otherwise);
}

std::optional<int> ParameterList::integer(std::string_view name) const
{
    const Parameter* p = find(name, {Type::integer, Type::number});
    if (p == nullptr) return {};
    if (!p->integers.empty()) return p->integers[0];
    if (!p->numbers.empty() && std::abs(p->numbers[0]) < 1e9f) return static_cast<int>(p->numbers[0]);
    return {};
}

int ParameterList::integer(std::string_view name, int otherwise) const
{
    return integer(name).value_or(otherwise);
}

bool ParameterList::flag(std::string_view name, bool otherwise) const
{
    const Parameter* p = find(name, {Type::boolean});
    return p != nullptr && !p->integers.empty() ? p->integers[0] != 0 : otherwise;
}

std::string ParameterList::text(std::string_view name, const std::string& otherwise) const
{
    const Parameter* p = find(name, {Type::string});
    return p != nullptr && !p->strings.empty() ? p->strings[0] : otherwise;
}

vec3 ParameterList::point(std::string_view name, vec3 otherwise) const
{
    const std::vector<vec3> points = points3(name);
    if (points.empty()) return otherwise;
    const vec3 p = points[0];
    return std::isfinite(p.x) && std::isfinite(p.y) && std::isfinite(p.z) ? p : otherwise;
}

std::span<const float> ParameterList::numbers(std::string_view name) const
{
    const Parameter* p = find(name, {Type::number});
    return p != nullptr ? std::span<const float>(p->numbers) : std::span<const float>();
}

std::vector<vec2> ParameterList::points2(std::string_view name) const
{
    // v3 has texture coordinates as "float uv".
    const Parameter* p = find(name, {Type::point2, Type::vector2, Type::number});
    std::vector<vec2> points;
    if (p == nullptr) return points;
    points.reserve(p->numbers.size() / 2);
    for (std::size_t i = 0; i + 1 < p->numbers.size(); i += 2) points.emplace_back(p->numbers[i], p->numbers[i + 1]);
    return points;
}

std::vector<vec3> ParameterList::points3(std::string_view name) const
{
    const Parameter* p = find(name, {Type::point3, Type::vector3, Type::normal});
    std::vector<vec3> points;
    if (p == nullptr) return points;
    points.reserve(p->numbers.size() / 3);
    for (std::size_t i = 0; i + 2 < p->numbers.size(); i += 3)
        points.emplace_back(p->numbers[i], p->numbers[i + 1], p->numbers[i + 2]);
    return points;
}

std::span<const int> ParameterList::integers(std::string_view name) const
{
    const Parameter* p = find(name, {Type::integer});
    return p != nullptr ? std::span<const int>(p->integers) : std::span<const int>();
}

std::span<const std::string> ParameterList::texts(std::string_view name) const
{
    const Parameter* p = find(name, {Type::string});
    return p != nullptr ? std::span<const std::string>(p->strings) : std::span<const std::string>();
}

void ParameterList::ignore(std::initializer_list<std::string_view> names) const
{
    for (const std::string_view name : names)
        for (const Parameter& parameter : list_)
            if (parameter.name == name) parameter.used = true;
}

void ParameterList::report_unused(const std::string& who, Notes& notes) const
{
    for (const Parameter& parameter : list_) {
        if (parameter.used) continue;
        const std::string what = fmt::format("\"{} {}\"", parameter.type_name, parameter.name.substr(0, 60));
        notes.warn(parameter.spot, who + what,
                   fmt::format("{} is not a parameter of {} here; it is ignored", what, who));
    }
}

void ParameterList::append_missing(const std::vector<Parameter>& defaults)
{
    const std::size_t own = list_.size();
    for (const Parameter& parameter : defaults) {
        bool is_there = false;
        for (std::size_t i = 0; i < own && !is_there; ++i) is_there = list_[i].name == parameter.name;
        if (is_there) continue;
        list_.push_back(parameter);
        list_.back().used = true; // it need not fit every shape or material it is given to
    }
}

} // namespace snell::pbrt
