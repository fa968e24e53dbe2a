// What the properties of a PLY file's vertices are for.
#pragma once

#include "snell/io/ply/header.h"
#include "snell/scene/scene.h"

#include <string>
#include <vector>

namespace snell::ply {

// What a vertex property is for; also its place in a row of values.
enum Slot
{
    slot_x,
    slot_y,
    slot_z,
    slot_nx,
    slot_ny,
    slot_nz,
    slot_u,
    slot_v,
    slot_u1,
    slot_v1,
    slot_tx,
    slot_ty,
    slot_tz,
    slot_tw,
    slot_red,
    slot_green,
    slot_blue,
    slot_alpha,
    slot_count,
    slot_unused = slot_count
};

struct Column
{
    const Property* property;
    Slot slot;
    std::size_t offset; // in a row of a binary file without lists
};

struct Layout
{
    std::vector<Column> columns; // one a property
    std::size_t row_bytes = 0;   // of a binary file; 0: rows differ, for there are lists
    bool positions = false, normals = false, uvs = false, uvs_1 = false, tangents = false, colors = false;
    std::vector<std::string> unused; // names of properties
};

Layout read_layout(const Element& vertices);

// Makes room for `count` vertices in all, with the attributes that there are.
void resize(Mesh& mesh, const Layout& layout, std::size_t count);
void reserve(Mesh& mesh, const Layout& layout, std::size_t count);

// Where a slot's numbers are in a mesh's arrays: to[0], to[stride], ... Null if the mesh has no such attribute.
struct Target
{
    float* to = nullptr;
    std::size_t stride = 0;
};
Target target_of(Slot slot, Mesh& mesh, std::size_t first_vertex);

// The number that a value becomes. Colours in integers are encoded with the sRGB curve, as the scanners' and editors'
// byte colours are; opacity is not.
float convert(float value, Slot slot, Type type);

} // namespace snell::ply
