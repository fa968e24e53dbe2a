// An OBJ file's content as plain arrays.
#pragma once

#include "snell/core/vec.h"

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

namespace snell {
class ByteWindow;
}

namespace snell::obj {

// Consecutive faces of one object, material and smoothing group.
struct Run
{
    std::size_t first_face = 0, first_corner = 0;
    uint object = 0;
    uint material = 0;
    uint smoothing = 0; // group; 0: off
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
    // The distinct corners: indices from 0 into positions, uvs and normals; none: not given (never for a position).
    std::vector<uvec3> vertices;
    std::vector<uint> corners;    // indices of vertices, face by face
    std::vector<uint> face_sizes; // corners a face, at least 3; empty: all have 3
    std::size_t face_count = 0;
    std::vector<Run> runs;              // cover all faces
    std::vector<std::string> objects;   // distinct names
    std::vector<std::string> materials; // distinct names; the first is "", for faces before any `usemtl`
    std::vector<Library> libraries;
    std::vector<std::string> warnings; // what was skipped or strange, at most one of a kind

    std::size_t run_end(std::size_t run) const { return run + 1 < runs.size() ? runs[run + 1].first_face : face_count; }
};

// Reads the file to its end, several pieces of it at a time in parallel. All indices of the result are in range. Throws
// Error with line and column. progress: called with what part of the file is done, between 0 and 1.
Document parse(ByteWindow& window, const std::function<void(double)>& progress);

} // namespace snell::obj
