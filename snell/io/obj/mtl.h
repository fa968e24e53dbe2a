// The statements of MTL material libraries, as they are written.
#pragma once

#include "snell/core/vec.h"

#include <map>
#include <set>
#include <string>
#include <string_view>

namespace snell::obj {

// A texture and its options.
struct MtlMap
{
    std::string file;    // as written, quotes removed
    vec3 offset{0.0f};   // -o
    vec3 scale{1.0f};    // -s
    bool clamps = false; // -clamp on
    float strength = 1;  // -bm
    char channel = 0;    // -imfchan: r g b m l z, or 0
    std::string ignored; // names of options that are not used, though they change something
    int line = 0;
};

// Numbers are 0 and maps missing where there is no such statement: ask has().
struct MtlMaterial
{
    std::string name;
    std::string file;
    int line = 0; // of its newmtl

    std::map<std::string, vec3, std::less<>> numbers; // by keyword: Kd, Ns, illum, ...; a single number three times
    std::map<std::string, MtlMap, std::less<>> maps;  // by keyword: map_Kd, norm, ...; bump is map_bump
    std::set<std::string, std::less<>> others;        // statements that are not known

    bool has(std::string_view keyword) const { return numbers.contains(keyword); }
    bool has_map(std::string_view keyword) const { return maps.contains(keyword); }
    vec3 color(std::string_view keyword) const;
    float number(std::string_view keyword, float otherwise) const;
    const MtlMap* map(std::string_view keyword) const;
};

// Reads one statement, without its line end, into a material. `line` is its number. Returns what is wrong with it, and
// is ignored; empty if nothing is.
std::string read_statement(std::string_view statement, int line, MtlMaterial& to);

} // namespace snell::obj
