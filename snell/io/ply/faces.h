// Triangles from the faces of a PLY file.
#pragma once

#include "snell/io/index_table.h"
#include "snell/io/polygon.h"
#include "snell/scene/scene.h"

#include <span>
#include <vector>

namespace snell::ply {

// Collects faces of all sizes; polygons are cut at the end, for the vertices may come behind them.
//
// With texture coordinates by corner ("wedges"), vertices are split where these differ.
class Faces
{
  public:
    // wedges: add_face will give texture coordinates; textures: and numbers of textures.
    Faces(Mesh& mesh, bool wedges, bool textures) : mesh_(mesh), has_wedges_(wedges), has_textures_(textures) {}

    bool is_plain() const { return !has_wedges_ && !has_textures_; }
    bool has_wedges() const { return has_wedges_; }

    // corners: vertices. uvs: two numbers a corner, or of any other length: this face has none.
    void add_face(std::span<const uint> corners, std::span<const float> uvs, uint texture);

    // If it is plain: more faces of `size` corners each, one behind the other.
    void add_faces(std::span<const uint> corners, uint size);

    // Cuts the polygons and, with wedges, rearranges the mesh's vertices. All corners must be in range of them. Returns
    // whether any face had texture coordinates.
    bool finish();

    std::vector<uint> triangle_textures; // of each triangle, with textures
    std::uint64_t degenerate = 0;        // faces with less than three corners

  private:
    uint position_of(uint corner) const { return has_wedges_ ? table_.keys()[corner].x : corner; }
    void cut_polygons();

    Mesh& mesh_;
    bool has_wedges_, has_textures_, has_uvs_ = false;
    IndexTable table_;                  // with wedges: vertex, and the bits of u and v
    std::vector<uint> corners_;         // of the face at hand
    std::vector<uint> polygon_corners_; // of all polygons
    std::vector<uint> polygon_sizes_;
    std::vector<uint> polygon_textures_; // with textures
};

} // namespace snell::ply
