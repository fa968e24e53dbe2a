// Meshes from an OBJ file's faces.
#pragma once

#include "snell/io/index_table.h"
#include "snell/io/obj/parse.h"
#include "snell/io/polygon.h"
#include "snell/scene/scene.h"

#include <span>

namespace snell::obj {

// A face of a document.
struct FaceView
{
    std::span<const uint> corners; // indices of Document::vertices
    const Run* run = nullptr;
};

// Normals for faces of smoothing groups: the sum over a position's faces in a group, weighted by angle (Thuermer and
// Wuethrich 1998), so that they do not depend on how a surface is cut into polygons.
class SmoothNormals
{
  public:
    explicit SmoothNormals(const Document& document) : document_(document) {}

    void add(const FaceView& face, std::span<const vec3> points);
    // Where the normal of the face's i-th corner is.
    uint index(const FaceView& face, std::size_t i);
    vec3 normal(uint index) const;

  private:
    const Document& document_;
    IndexTable table_;
    std::vector<vec3> sums_;
};

// Makes one mesh of each object. A vertex is shared by the corners that agree in position, texture coordinate and
// normal. Where no face has normals, neither in the file nor by its smoothing group, the mesh has none; else flat faces
// have their own.
class Builder
{
  public:
    // The document must outlive the builder.
    explicit Builder(Document& document);

    // runs: numbers of the runs that belong to the object, in order, at least one. materials: by Document::materials.
    // is_last: the document is not needed any more, its arrays are freed as soon as they have been used.
    Mesh build(std::span<const uint> runs, const std::vector<Index<MaterialDesc>>& materials, bool is_last);

  private:
    // A vertex's normal, two bits for where it is and the index there.
    static constexpr uint from_file = 0u << 30, from_smooth = 1u << 30, from_flat = 2u << 30,
                          index_bits = (1u << 30) - 1;

    // What the faces of an object have.
    struct Attributes
    {
        bool uvs = false;
        bool normals = false;   // of some face
        bool as_written = true; // the document's distinct corners are the mesh's vertices
    };

    template <class Use>
    void for_each_face(uint run, const Use& use);
    Attributes look(std::span<const uint> runs);
    bool has_normals(const FaceView& face) const;
    bool is_smoothed(const FaceView& face) const;
    std::span<const vec3> points_of(const FaceView& face);
    void cut(const FaceView& face, Mesh& mesh);
    uint normal_key(const FaceView& face, std::size_t i);
    vec3 normal_of(uint key) const;
    void build_as_written(std::span<const uint> runs, const Attributes& has, bool is_last, Mesh& mesh);
    void build_mixed(std::span<const uint> runs, const Attributes& has, Mesh& mesh);

    Document& document_;
    SmoothNormals smooth_;
    Triangulator triangulate_;
    std::vector<vec3> points_, flat_;
    std::vector<uint> indices_;
    std::vector<uint> numbers_;              // by vertex of the document: its number in the mesh at hand, or none
    std::vector<std::size_t> run_triangles_; // of the mesh at hand, at the end of each run
};

} // namespace snell::obj
