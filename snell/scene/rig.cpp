#include "snell/scene/rig.h"

#include "snell/core/parallel.h"
#include "snell/scene/validate_mesh.h"

#include <algorithm>

namespace snell {

static constexpr std::size_t grain = 4096;

namespace {
struct Vertex
{
    vec3 position, normal, tangent;
};
} // namespace

// Along v, or `rest` if v is that or has no direction.
static vec3 direction_or(vec3 v, vec3 rest)
{
    if (v == rest) return rest;
    const float size2 = dot(v, v);
    return size2 > 1e-30f && size2 < 1e30f ? v / sqrt(size2) : rest;
}

static void morph(const Rig& rig, std::span<const float> weights, std::size_t vertex, Vertex& v)
{
    for (std::size_t k = 0; k < std::min(rig.targets.size(), weights.size()); ++k) {
        const float weight = weights[k];
        if (weight == 0.0f) continue;
        const MorphTarget& target = rig.targets[k];
        if (!target.positions.empty()) v.position += weight * target.positions[vertex];
        if (!target.normals.empty()) v.normal += weight * target.normals[vertex];
        if (!target.tangents.empty()) v.tangent += weight * target.tangents[vertex];
    }
}

static Transform blend(const Rig& rig, std::span<const Transform> joints, std::size_t vertex)
{
    Transform sum{vec4(0.0f), vec4(0.0f), vec4(0.0f)};
    for (std::size_t i = vertex; i < rig.joints.size(); i += rig.positions.size()) { // one run, or two
        for (int k = 0; k < 4; ++k) {
            const float weight = rig.weights[i][k];
            const uint joint = rig.joints[i][k];
            if (!(weight > 0.0f) || joint >= joints.size()) continue;
            sum.x += weight * joints[joint].x;
            sum.y += weight * joints[joint].y;
            sum.z += weight * joints[joint].z;
        }
    }
    return sum;
}

// Moves the vertex; returns whether the map mirrors.
static bool carry(const Transform& m, Vertex& v)
{
    vec3 x(m.x.x, m.x.y, m.x.z), y(m.y.x, m.y.y, m.y.z), z(m.z.x, m.z.y, m.z.z);
    v.position = transform_point(m, v.position);
    // Only directions from here on: products of three small scales would leave the range of floats.
    const float largest = max3(max(abs(x), max(abs(y), abs(z))));
    if (largest > 0.0f) x /= largest, y /= largest, z /= largest;
    v.tangent = vec3(dot(x, v.tangent), dot(y, v.tangent), dot(z, v.tangent));
    // The inverse transpose is the matrix of cofactors over the determinant, of which only the sign matters here: so a
    // map that flattens has normals too.
    const vec3 yz = cross(y, z), zx = cross(z, x), xy = cross(x, y);
    const bool mirrors = dot(x, yz) < 0.0f;
    const vec3 n(dot(yz, v.normal), dot(zx, v.normal), dot(xy, v.normal));
    v.normal = mirrors ? -n : n;
    return mirrors;
}

void deform(const Rig& rig, std::span<const float> weights, std::span<const Transform> joints, Mesh& mesh)
{
    const bool skinned = rig.skin.valid();
    const bool normals = !rig.normals.empty(), tangents = !rig.tangents.empty();
    mesh.positions.resize(rig.positions.size());
    if (normals) mesh.normals.resize(rig.normals.size());
    if (tangents) mesh.tangents.resize(rig.tangents.size());
    parallel_ranges(rig.positions.size(), grain, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) {
            const vec3 rest_normal = normals ? rig.normals[i] : vec3(0.0f);
            const vec4 rest_tangent = tangents ? rig.tangents[i] : vec4(0.0f);
            Vertex v{rig.positions[i], rest_normal, vec3(rest_tangent.x, rest_tangent.y, rest_tangent.z)};
            morph(rig, weights, i, v);
            const bool mirrors = skinned && carry(blend(rig, joints, i), v);
            // Out of reach of the arithmetic: better where it rests than a spike into nowhere.
            mesh.positions[i] = is_seen(v.position) ? v.position : rig.positions[i];
            if (normals) mesh.normals[i] = direction_or(v.normal, rest_normal);
            if (tangents) {
                const vec3 t = direction_or(v.tangent, vec3(rest_tangent.x, rest_tangent.y, rest_tangent.z));
                mesh.tangents[i] = vec4(t.x, t.y, t.z, mirrors ? -rest_tangent.w : rest_tangent.w);
            }
        }
    });
}

} // namespace snell
