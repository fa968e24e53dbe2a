// The parameters of a directive: "type name" [ values ].
#pragma once

#include "snell/core/vec.h"
#include "snell/io/pbrt/tokenizer.h"

#include <initializer_list>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace snell::pbrt {

// Types, under the names of pbrt-v4. v3's point, vector and color are read as point3, vector3 and rgb.
enum class Type
{
    integer,
    number, // "float"
    point2,
    vector2,
    point3,
    vector3,
    normal,
    spectrum,
    rgb,
    xyz,
    blackbody,
    boolean,
    string,
    texture,
    unknown
};

struct Parameter
{
    Type type = Type::unknown;
    std::string type_name, name;
    Spot spot;
    std::vector<float> numbers;       // all types but integer, boolean, string and texture; spectra of numbers, too
    std::vector<int> integers;        // integer; boolean as 0 and 1
    std::vector<std::string> strings; // string, texture, spectra by name or file
    mutable bool used = false;        // somebody asked for it
};

class Notes;

// Look-ups mark what they find as used; what stays unused is unknown, and said so by report_unused().
class ParameterList
{
  public:
    Spot spot; // of the directive

    // Reads parameters as long as strings follow. Throws Error if values do not fit their type. Parameters of unknown
    // type are read over and noted.
    static ParameterList read(Tokenizer& tokens, Spot directive, Notes& notes);

    // The parameter of that name and one of these types (none given: any); null if there is none.
    const Parameter* find(std::string_view name, std::initializer_list<Type> types = {}) const;
    bool has(std::string_view name) const;

    // Single values. One that is not finite, or of the wrong type, counts as missing.
    float number(std::string_view name, float otherwise) const;
    std::optional<float> number(std::string_view name) const;
    int integer(std::string_view name, int otherwise) const;
    std::optional<int> integer(std::string_view name) const;
    bool flag(std::string_view name, bool otherwise) const;
    std::string text(std::string_view name, const std::string& otherwise = {}) const;
    vec3 point(std::string_view name, vec3 otherwise) const;

    // Lists; empty if missing.
    std::span<const float> numbers(std::string_view name) const;
    std::vector<vec2> points2(std::string_view name) const;
    std::vector<vec3> points3(std::string_view name) const;
    std::span<const int> integers(std::string_view name) const;
    std::span<const std::string> texts(std::string_view name) const;

    // For parameters that steer how a picture is computed, not what it shows.
    void ignore(std::initializer_list<std::string_view> names) const;

    // A warning for each parameter that nobody asked for. who: 'Shape "sphere"'.
    void report_unused(const std::string& who, Notes& notes) const;

    // Appends parameters that this list does not have.
    void append_missing(const std::vector<Parameter>& defaults);

    const std::vector<Parameter>& all() const { return list_; }

  private:
    std::vector<Parameter> list_;
};

} // namespace snell::pbrt
