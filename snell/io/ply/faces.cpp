#include "snell/io/ply/faces.h"

#include "snell/core/parallel.h"

#include <algorithm>
#include <cmath>

namespace snell::ply {
namespace {

constexpr uint no_uv = 0xffffffffu; // the bits of a NaN that no file is given

uint uv_bits(float value)
{
    return floatBitsToUint(std::isfinite(value) ? value + 0.0f : 0.0f);
}

// The elements of `from` that the keys' first numbers name.
template <class T>
void gather(std::vector<T>& from, std::span<const uvec3> keys)
{
    if (from.empty()) return;
    std::vector<T> to(keys.size());
    for (std::size_t i = 0; i < keys.size(); ++i) to[i] = from[keys[i].x];
    from = std::move(to);
}

} // namespace

void Faces::add_face(std::span<const uint> corners, std::span<const float> uvs, uint texture)
{
    if (corners.size() < 3) {
        ++degenerate;
        return;
    }
    if (has_wedges_) {
        const bool has_uvs = uvs.size() == 2 * corners.size();
        has_uvs_ = has_uvs_ || has_uvs;
        corners_.clear();
        for (std::size_t i = 0; i < corners.size(); ++i)
            corners_.push_back(table_.find_or_add(has_uvs
                                                      ? uvec3(corners[i], uv_bits(uvs[2 * i]), uv_bits(uvs[2 * i + 1]))
                                                      : uvec3(corners[i], no_uv, no_uv)));
        corners = corners_;
    }
    if (corners.size() == 3) {
        mesh_.triangles.push_back(uvec3(corners[0], corners[1], corners[2]));
        if (has_textures_) triangle_textures.push_back(texture);
        return;
    }
    polygon_sizes_.push_back(static_cast<uint>(corners.size()));
    polygon_corners_.insert(polygon_corners_.end(), corners.begin(), corners.end());
    if (has_textures_) polygon_textures_.push_back(texture);
}

void Faces::add_faces(std::span<const uint> corners, uint size)
{
    polygon_corners_.insert(polygon_corners_.end(), corners.begin(), corners.end());
    polygon_sizes_.insert(polygon_sizes_.end(), corners.size() / size, size);
}

// Several pieces at the same time; the triangles come in the order of the polygons.
void Faces::cut_polygons()
{
    constexpr std::size_t piece = 1 << 13;
    struct Piece
    {
        std::size_t first_corner = 0;
        std::vector<uvec3> triangles;
        std::vector<uint> textures;
    };
    std::vector<Piece> pieces((polygon_sizes_.size() + piece - 1) / piece);
    std::size_t corner = 0;
    for (std::size_t i = 0; i < polygon_sizes_.size(); ++i) {
        if (i % piece == 0) pieces[i / piece].first_corner = corner;
        corner += polygon_sizes_[i];
    }
    mesh_.triangles.reserve(mesh_.triangles.size() + corner - 2 * polygon_sizes_.size());
    const auto cut = [&](std::size_t number) {
        Piece& out = pieces[number];
        Triangulator triangulate;
        std::vector<vec3> points;
        std::size_t first = out.first_corner;
        for (std::size_t i = number * piece; i < std::min(polygon_sizes_.size(), (number + 1) * piece); ++i) {
            const std::span<const uint> corners(polygon_corners_.data() + first, polygon_sizes_[i]);
            points.clear();
            for (const uint c : corners) points.push_back(mesh_.positions[position_of(c)]);
            for (const uvec3 t : triangulate(points))
                out.triangles.push_back(uvec3(corners[t.x], corners[t.y], corners[t.z]));
            if (has_textures_) out.textures.resize(out.triangles.size(), polygon_textures_[i]);
            first += corners.size();
        }
    };
    // Some pieces at a time, so that little is kept twice.
    constexpr std::size_t at_once = 64;
    for (std::size_t begin = 0; begin < pieces.size(); begin += at_once) {
        const std::size_t count = std::min(at_once, pieces.size() - begin);
        parallel_for(count, [&](std::size_t i) { cut(begin + i); });
        for (std::size_t i = begin; i < begin + count; ++i) {
            mesh_.triangles.insert(mesh_.triangles.end(), pieces[i].triangles.begin(), pieces[i].triangles.end());
            triangle_textures.insert(triangle_textures.end(), pieces[i].textures.begin(), pieces[i].textures.end());
            pieces[i] = {};
        }
    }
    polygon_sizes_ = {}, polygon_corners_ = {}, polygon_textures_ = {};
}

bool Faces::finish()
{
    cut_polygons();
    if (!has_wedges_) return false;
    const std::span<const uvec3> keys = table_.keys();
    if (!has_uvs_) {
        for (uvec3& t : mesh_.triangles) t = uvec3(keys[t.x].x, keys[t.y].x, keys[t.z].x);
        return false;
    }
    gather(mesh_.positions, keys);
    gather(mesh_.normals, keys);
    gather(mesh_.uvs_1, keys);
    gather(mesh_.tangents, keys);
    gather(mesh_.colors, keys);
    gather(mesh_.uvs, keys);
    mesh_.uvs.resize(keys.size(), vec2(0.0f));
    for (std::size_t i = 0; i < keys.size(); ++i)
        if (keys[i].y != no_uv) mesh_.uvs[i] = vec2(uintBitsToFloat(keys[i].y), uintBitsToFloat(keys[i].z));
    return true;
}

} // namespace snell::ply
