#include "snell/io/obj/build.h"

#include "snell/core/parallel.h"

#include <algorithm>
#include <cmath>

namespace snell::obj {

static constexpr std::size_t grain = 1 << 14;

void SmoothNormals::add(const FaceView& face, std::span<const vec3> points)
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

uint SmoothNormals::index(const FaceView& face, std::size_t i)
{
    const uint position = document_.vertices[face.corners[i]].x;
    const uint k = table_.find_or_add(uvec3(position, face.run->smoothing, 0));
    if (k == sums_.size()) sums_.push_back(vec3(0.0f));
    return k;
}

vec3 SmoothNormals::normal(uint index) const
{
    const float size = length(sums_[index]);
    return size > 0.0f ? sums_[index] / size : vec3(0.0f);
}

Builder::Builder(Document& document) : document_(document), smooth_(document)
{
    for (uint r = 0; r < document_.runs.size(); ++r)
        if (document_.runs[r].smoothing > 0)
            for_each_face(r, [&](const FaceView& face) {
                if (is_smoothed(face)) smooth_.add(face, points_of(face));
            });
}

template <class Use>
void Builder::for_each_face(uint run, const Use& use)
{
    std::size_t corner = document_.runs[run].first_corner;
    const std::size_t end = document_.run_end(run);
    for (std::size_t f = document_.runs[run].first_face; f < end; ++f) {
        const std::size_t size = document_.face_sizes.empty() ? 3 : document_.face_sizes[f];
        use(FaceView{{document_.corners.data() + corner, size}, &document_.runs[run]});
        corner += size;
    }
}

bool Builder::has_normals(const FaceView& face) const
{
    for (const uint corner : face.corners)
        if (document_.vertices[corner].z == none) return false;
    return true;
}

bool Builder::is_smoothed(const FaceView& face) const
{
    return face.run->smoothing > 0 && !has_normals(face);
}

std::span<const vec3> Builder::points_of(const FaceView& face)
{
    points_.clear();
    for (const uint corner : face.corners) points_.push_back(document_.positions[document_.vertices[corner].x]);
    return points_;
}

Builder::Attributes Builder::look(std::span<const uint> runs)
{
    Attributes has;
    bool all = true, any = false, smoothing = false;
    for (const uint r : runs) smoothing = smoothing || document_.runs[r].smoothing > 0;
    if (runs.size() == document_.runs.size()) {
        // Every distinct corner is some face's.
        for (const uvec3 vertex : document_.vertices) {
            has.uvs = has.uvs || vertex.y != none;
            any = any || vertex.z != none;
            all = all && vertex.z != none;
        }
        if (all || !(any || smoothing)) {
            has.normals = all;
            return has;
        }
    }
    all = true, any = false;
    for (const uint r : runs)
        for_each_face(r, [&](const FaceView& face) {
            for (const uint corner : face.corners) {
                has.uvs = has.uvs || document_.vertices[corner].y != none;
                any = any || document_.vertices[corner].z != none;
            }
            const bool has_all = has_normals(face);
            all = all && has_all;
            has.normals = has.normals || has_all || face.run->smoothing > 0;
        });
    has.as_written = has.normals ? all : !any;
    return has;
}

Mesh Builder::build(std::span<const uint> runs, const std::vector<Index<MaterialDesc>>& materials, bool is_last)
{
    Mesh mesh;
    run_triangles_.clear();
    const Attributes has = look(runs);
    if (has.as_written)
        build_as_written(runs, has, is_last, mesh);
    else
        build_mixed(runs, has, mesh);

    const auto material_of = [&](uint r) { return materials[document_.runs[r].material]; };
    mesh.material = material_of(runs[0]);
    if (!std::all_of(runs.begin(), runs.end(), [&](uint r) { return material_of(r) == mesh.material; })) {
        mesh.triangle_materials.reserve(mesh.triangles.size());
        for (std::size_t i = 0; i < runs.size(); ++i)
            mesh.triangle_materials.resize(run_triangles_[i], material_of(runs[i]));
    }
    return mesh;
}

// Adds the triangles of a face whose vertices' numbers are in indices_.
void Builder::cut(const FaceView& face, Mesh& mesh)
{
    if (indices_.size() == 3) {
        mesh.triangles.push_back(uvec3(indices_[0], indices_[1], indices_[2]));
        return;
    }
    for (const uvec3 t : triangulate_(points_of(face)))
        mesh.triangles.push_back(uvec3(indices_[t.x], indices_[t.y], indices_[t.z]));
}

template <class T, class From>
static void fill(std::vector<T>& to, std::size_t count, const From& from)
{
    to.resize(count);
    parallel_ranges(count, grain, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) to[i] = from(i);
    });
}

void Builder::build_as_written(std::span<const uint> runs, const Attributes& has, bool is_last, Mesh& mesh)
{
    const bool is_whole = runs.size() == document_.runs.size();
    std::vector<uint> used; // the document's vertices by their number in the mesh; if it is not whole
    if (is_whole && document_.face_sizes.empty()) {
        const std::vector<uint>& c = document_.corners;
        fill(mesh.triangles, document_.face_count,
             [&](std::size_t i) { return uvec3(c[3 * i], c[3 * i + 1], c[3 * i + 2]); });
        for (const uint r : runs) run_triangles_.push_back(document_.run_end(r));
    } else {
        if (!is_whole) numbers_.resize(document_.vertices.size(), none);
        std::size_t count = 0;
        for (const uint r : runs) for_each_face(r, [&](const FaceView& face) { count += face.corners.size() - 2; });
        mesh.triangles.reserve(count);
        for (const uint r : runs) {
            for_each_face(r, [&](const FaceView& face) {
                indices_.assign(face.corners.begin(), face.corners.end());
                if (!is_whole)
                    for (uint& vertex : indices_) {
                        uint& number = numbers_[vertex];
                        if (number == none) {
                            number = static_cast<uint>(used.size());
                            used.push_back(vertex);
                        }
                        vertex = number;
                    }
                cut(face, mesh);
            });
            run_triangles_.push_back(mesh.triangles.size());
        }
        for (const uint vertex : used) numbers_[vertex] = none;
    }
    if (is_last) document_.corners = {}, document_.face_sizes = {};

    Document& d = document_;
    const std::size_t count = is_whole ? d.vertices.size() : used.size();
    const auto vertex = [&](std::size_t i) { return d.vertices[is_whole ? i : used[i]]; };
    fill(mesh.positions, count, [&](std::size_t i) { return d.positions[vertex(i).x]; });
    if (is_last) d.positions = {};
    if (!d.colors.empty()) fill(mesh.colors, count, [&](std::size_t i) { return vec4(d.colors[vertex(i).x], 1.0f); });
    if (is_last) d.colors = {};
    if (has.normals) fill(mesh.normals, count, [&](std::size_t i) { return d.normals[vertex(i).z]; });
    if (is_last) d.normals = {};
    if (has.uvs)
        fill(mesh.uvs, count, [&](std::size_t i) { return vertex(i).y == none ? vec2(0.0f) : d.uvs[vertex(i).y]; });
    if (is_last) d.uvs = {}, d.vertices = {};
}

void Builder::build_mixed(std::span<const uint> runs, const Attributes& has, Mesh& mesh)
{
    IndexTable vertices;
    flat_.clear();
    for (const uint r : runs) {
        for_each_face(r, [&](const FaceView& face) {
            indices_.clear();
            for (std::size_t i = 0; i < face.corners.size(); ++i) {
                const uvec3 vertex = document_.vertices[face.corners[i]];
                indices_.push_back(
                    vertices.find_or_add(uvec3(vertex.x, vertex.y, has.normals ? normal_key(face, i) : 0)));
            }
            cut(face, mesh);
        });
        run_triangles_.push_back(mesh.triangles.size());
    }
    const std::span<const uvec3> keys = vertices.keys();
    const Document& d = document_;
    fill(mesh.positions, keys.size(), [&](std::size_t i) { return d.positions[keys[i].x]; });
    if (!d.colors.empty())
        fill(mesh.colors, keys.size(), [&](std::size_t i) { return vec4(d.colors[keys[i].x], 1.0f); });
    if (has.uvs)
        fill(mesh.uvs, keys.size(), [&](std::size_t i) { return keys[i].y == none ? vec2(0.0f) : d.uvs[keys[i].y]; });
    if (has.normals) fill(mesh.normals, keys.size(), [&](std::size_t i) { return normal_of(keys[i].z); });
}

uint Builder::normal_key(const FaceView& face, std::size_t i)
{
    if (has_normals(face)) return from_file | document_.vertices[face.corners[i]].z;
    if (face.run->smoothing > 0) return from_smooth | smooth_.index(face, i);
    // A flat face between smooth ones has its own vertices, with its own normal.
    if (i == 0) flat_.push_back(polygon_normal(points_of(face)));
    return from_flat | static_cast<uint>(flat_.size() - 1);
}

vec3 Builder::normal_of(uint key) const
{
    const uint index = key & index_bits;
    if ((key & ~index_bits) == from_file) return document_.normals[index];
    if ((key & ~index_bits) == from_smooth) return smooth_.normal(index);
    const float size = length(flat_[index]);
    return size > 0.0f ? flat_[index] / size : vec3(0.0f);
}

} // namespace snell::obj
