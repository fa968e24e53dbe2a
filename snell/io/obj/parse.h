// An OBJ file's content as plain arrays.
#pragma once

#include "snell/core/vec.h"

#include <string>
#include <vector>

namespace snell::obj {

// Indices from 0 into the arrays of a Document; -1: not given.
struct Corner
{
    int position, uv, normal;
};

struct Face
{
    std::size_t first; // of its corners
    uint count;        // at least 3
    uint object;
    uint material;
    uint smoothing; // group; 0: off
};

// A material library that the file asks for: what stands behind `mtllib`, one or several names.
struct Library
{
    std::string names;
    int line;
};

struct Document
{
    std::vector<vec3> positions;
    std::vector<vec3> normals;
    std::vector<vec2> uvs;
    std::vector<vec3> colors; // empty, or one a position
    std::vector<Corner> corners;
    std::vector<Face> faces;
    std::vector<std::string> objects;   // distinct names
    std::vector<std::string> materials; // distinct names; the first is "", for faces before any `usemtl`
    std::vector<Library> libraries;
    std::vector<std::string> warnings; // what was skipped or strange, at most one of a kind
};

// All indices of the result are in range. Throws Error. Takes the text, for tinyobjloader wants to read from
// non-constant memory.
Document parse(const std::string& file, std::string text);

} // namespace snell::obj
