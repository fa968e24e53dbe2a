// Some lines of an OBJ file by themselves.
#pragma once

#include "snell/core/vec.h"

#include <cstdint>
#include <limits>
#include <string>
#include <string_view>
#include <vector>

namespace snell::obj {

// What a corner or a limit is about.
enum Kind
{
    kind_position,
    kind_uv,
    kind_normal,
    kind_count
};

// One of a corner's three indices, as far as a chunk can know it. 0 and up: from the file's first element on; none
// (-1): not given; below: back from where it stands, which the chunk knows only from its own first element on.
constexpr int not_given = -1;
constexpr int relative_zero = std::numeric_limits<int>::min() + (1 << 30);

inline bool is_relative(int index)
{
    return index < not_given;
}

struct Corner
{
    int at[kind_count];
};

// A statement that is in force from a face on.
struct Event
{
    enum class What
    {
        material,
        object,
        group,
        smoothing,
        library
    };
    What what;
    std::size_t face = 0, corner = 0; // how many faces and corners of the chunk come before it
    int line = 0;                     // from 0, within the chunk
    std::string name;
    uint smoothing = 0;
};

// Kinds of lines that are noted.
enum Skipped
{
    skipped_undrawn,
    skipped_free_form,
    skipped_unknown,
    skipped_not_finite,
    skipped_small_face,
    skipped_count
};

struct Tally
{
    std::size_t count = 0;
    int first_line = 0;
};

struct Chunk
{
    std::vector<vec3> positions, normals, colors; // colors: empty, or one a position
    std::vector<vec2> uvs;
    std::vector<Corner> corners;
    std::vector<uint> face_sizes;
    bool has_polygons = false; // faces of other than three corners
    std::vector<Event> events;
    Tally skipped[skipped_count];
    int lines = 0;

    // The index that reaches furthest, up and back, and where: to be checked when it is known what there is.
    struct Reach
    {
        int index = -1;
        int line = 0;
        int written = 0;       // as the file says it
        std::size_t count = 0; // elements of the chunk before that line
    };
    Reach highest[kind_count], lowest[kind_count];
    bool has_relative = false;

    // What is wrong, if anything: reading stopped there.
    bool failed = false;
    int error_line = 0, error_column = 0; // column: 0 if not known
    std::string message, remedy;
};

// Reads whole lines. Lines end with \n, \r\n or \r; those with a backslash before their end go on in the next one.
Chunk parse_chunk(std::string_view text);

} // namespace snell::obj
