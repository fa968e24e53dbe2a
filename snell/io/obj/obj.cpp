#include "snell/io/obj/obj.h"

#include "snell/core/error.h"
#include "snell/io/file.h"
#include "snell/io/index_table.h"
#include "snell/io/obj/material.h"
#include "snell/io/obj/parse.h"
#include "snell/io/polygon.h"

#include <cmath>
#include <optional>

namespace snell {
namespace {

using namespace obj;

// Normals for faces of smoothing groups: the sum over a position's faces in a group, weighted by angle (Thuermer and
// Wuethrich 1998), so that they do not depend on how a surface is cut into polygons.
class SmoothNormals
{
  public:
    explicit SmoothNormals(const Document& document) : document_(document) {}

    void add(const Face& face, std::span<const vec3> points)
    {
        const vec3 sum = polygon_normal(points);
        const float size = length(sum);
        if (!(size > 0.0f && std::isfinite(size))) return;
        for (std::size_t i = 0; i < points.size(); ++i) {
            const vec3 a = points[i + 1 < points.size() ? i + 1 : 0] - points[i];
            const vec3 b = points[i > 0 ? i - 1 : points.size() - 1] - points[i];
            const float angle = std::atan2(length(cross(a, b)), dot(a, b));
            const uint k = index(face, i);
            if (std::isfinite(angle)) sums_[k] += angle / size * sum;
        }
    }

    // Where the normal of the face's i-th corner is.
    uint index(const Face& face, std::size_t i)
    {
        const int position = document_.corners[face.first + i].position;
        const uint k = table_.find_or_add(uvec3(static_cast<uint>(position), face.smoothing, 0));
        if (k == sums_.size()) sums_.push_back(vec3(0.0f));
        return k;
    }

    vec3 normal(uint k) const
    {
        const float size = length(sums_[k]);
        return size > 0.0f ? sums_[k] / size : vec3(0.0f);
    }

  private:
    const Document& document_;
    IndexTable table_;
    std::vector<vec3> sums_;
};

// Makes meshes of the faces.
class Builder
{
  public:
    explicit Builder(const Document& document) : document_(document), smooth_(document)
    {
        for (const Face& face : document_.faces)
            if (is_smoothed(face)) smooth_.add(face, points_of(face));
    }

    Mesh build(std::span<const uint> faces, const std::vector<Index<MaterialDesc>>& materials)
    {
        bool normals = false, uvs = false;
        std::size_t corner_count = 0;
        for (const uint f : faces) {
            const Face& face = document_.faces[f];
            normals = normals || has_normals(face) || is_smoothed(face);
            for (uint i = 0; i < face.count; ++i) uvs = uvs || corner(face, i).uv >= 0;
            corner_count += face.count;
        }

        Mesh mesh;
        IndexTable vertices(corner_count / 4);
        flat_.clear();
        for (const uint f : faces) {
            const Face& face = document_.faces[f];
            const std::span<const vec3> points = points_of(face);
            indices_.clear();
            for (uint i = 0; i < face.count; ++i) {
                const Corner c = corner(face, i);
                indices_.push_back(vertices.find_or_add(uvec3(static_cast<uint>(c.position), static_cast<uint>(c.uv),
                                                              normals ? normal_key(face, i, points) : 0)));
            }
            for (const uvec3 t : triangulate_(points)) {
                mesh.triangles.push_back(uvec3(indices_[t.x], indices_[t.y], indices_[t.z]));
                mesh.triangle_materials.push_back(materials[face.material]);
            }
        }
        for (const uvec3 key : vertices.keys()) {
            mesh.positions.push_back(document_.positions[key.x]);
            if (!document_.colors.empty()) mesh.colors.push_back(document_.colors[key.x]);
            if (uvs) mesh.uvs.push_back(key.y == none ? vec2(0.0f) : document_.uvs[key.y]);
            if (normals) mesh.normals.push_back(normal_of(key.z));
        }
        if (!mesh.triangles.empty()) mesh.material = mesh.triangle_materials[0];
        if (std::all_of(mesh.triangle_materials.begin(), mesh.triangle_materials.end(),
                        [&](Index<MaterialDesc> m) { return m == mesh.material; }))
            mesh.triangle_materials.clear();
        return mesh;
    }

  private:
    // A vertex's normal, two bits for where it is and the index there.
    static constexpr uint from_file = 0u << 30, from_smooth = 1u << 30, from_flat = 2u << 30,
                          index_bits = (1u << 30) - 1;

    const Corner& corner(const Face& face, uint i) const { return document_.corners[face.first + i]; }

    bool has_normals(const Face& face) const
    {
        for (uint i = 0; i < face.count; ++i)
            if (corner(face, i).normal < 0) return false;
        return true;
    }

    bool is_smoothed(const Face& face) const { return face.smoothing > 0 && !has_normals(face); }

    std::span<const vec3> points_of(const Face& face)
    {
        points_.clear();
        for (uint i = 0; i < face.count; ++i)
            points_.push_back(document_.positions[static_cast<std::size_t>(corner(face, i).position)]);
        return points_;
    }

    uint normal_key(const Face& face, uint i, std::span<const vec3> points)
    {
        if (has_normals(face)) return from_file | static_cast<uint>(corner(face, i).normal);
        if (face.smoothing > 0) return from_smooth | smooth_.index(face, i);
        // A flat face between smooth ones has its own vertices, with its own normal.
        if (i == 0) flat_.push_back(polygon_normal(points));
        return from_flat | static_cast<uint>(flat_.size() - 1);
    }

    vec3 normal_of(uint key) const
    {
        const uint index = key & index_bits;
        if ((key & ~index_bits) == from_file) return document_.normals[index];
        if ((key & ~index_bits) == from_smooth) return smooth_.normal(index);
        const float size = length(flat_[index]);
        return size > 0.0f ? flat_[index] / size : vec3(0.0f);
    }

    const Document& document_;
    SmoothNormals smooth_;
    Triangulator triangulate_;
    std::vector<vec3> points_, flat_;
    std::vector<uint> indices_;
};

void scale_colors(Scene& scene, const std::string& name, std::vector<vec3>& colors)
{
    float largest = 0.0f;
    for (const vec3 color : colors) largest = max(largest, max3(color));
    if (largest <= 1.0f) return;
    for (vec3& color : colors) color /= 255.0f;
    note(scene, Note::Kind::info, fmt::format("{}: vertex colours up to {} are taken as 0 to 255", name, largest));
}

} // namespace

Scene load_obj(const std::filesystem::path& file)
{
    const std::string name = file.string();
    Document document = parse(name, read_file(file));
    if (document.faces.empty())
        throw Error({name},
                    document.positions.empty()
                        ? "contains neither vertices nor faces"
                        : fmt::format("contains {} points, but no faces", document.positions.size()),
                    "choose a file with a surface in it");
    // The indices of normals share a word with where they come from.
    if (document.corners.size() >= (1u << 30)) throw Error({name}, "more than 1073741823 corners", "split the file");

    Scene scene;
    scene.name = file.stem().string();
    for (std::string& warning : document.warnings) note(scene, Note::Kind::warning, std::move(warning));
    scale_colors(scene, name, document.colors);

    MaterialLibrary library(scene, file.parent_path());
    for (const Library& wanted : document.libraries)
        library.load(wanted.names, fmt::format("{}:{}", name, wanted.line));
    std::vector<Index<MaterialDesc>> materials(document.materials.size());
    std::vector<std::vector<uint>> faces_of(document.objects.size());
    for (uint f = 0; f < document.faces.size(); ++f) {
        const Face& face = document.faces[f];
        faces_of[face.object].push_back(f);
        Index<MaterialDesc>& material = materials[face.material];
        if (material.valid()) continue;
        material = library.find(document.materials[face.material], name);
        const bool is_default = document.materials[face.material].empty();
        if (is_default && !document.colors.empty()) scene.materials[material.value].base_color = vec3(1.0f);
    }

    Builder builder(document);
    Group group;
    group.name = scene.name;
    for (std::size_t i = 0; i < faces_of.size(); ++i) {
        if (faces_of[i].empty()) continue;
        Mesh mesh = builder.build(faces_of[i], materials);
        mesh.name = document.objects[i].empty() ? scene.name : document.objects[i];
        group.meshes.push_back(add(scene, std::move(mesh)));
    }
    const Index<Group> index = add(scene, std::move(group));
    add(scene, InstanceDesc{scene.name, index, identity_transform()});
    return scene;
}

} // namespace snell
