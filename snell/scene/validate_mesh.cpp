#include "snell/scene/validate_mesh.h"

#include "snell/core/error.h"
#include "snell/core/parallel.h"

#include <atomic>
#include <cmath>

namespace snell {

static constexpr std::size_t grain = 1 << 15;

std::string label(const std::string& name, std::size_t number)
{
    return name.empty() ? fmt::format("{}", number) : fmt::format("'{}'", name);
}

bool is_seen(vec3 p)
{
    constexpr float largest = 1e18f;
    return abs(p.x) <= largest && abs(p.y) <= largest && abs(p.z) <= largest; // false for NaN
}

bool is_usable(const Transform& m)
{
    for (const vec4 row : {m.x, m.y, m.z})
        if (!is_seen(vec3(row.x, row.y, row.z)) || !is_seen(vec3(row.w))) return false;
    return true;
}

void warn(Scene& scene, std::string text)
{
    note(scene, Note::Kind::warning, std::move(text));
}

static void check_length(const std::string& who, const char* what, std::size_t given, std::size_t wanted,
                         const char* per)
{
    if (given != 0 && given != wanted)
        throw Error(fmt::format("{} has {} {} for {} {}", who, given, what, wanted, per),
                    "give one each, or none at all");
}

// The smallest i for which bad(i), or count if there is none: parallel, and the same for any number of threads.
template <class Bad>
static std::size_t find_first(std::size_t count, const Bad& bad)
{
    std::atomic<std::size_t> first = count;
    parallel_ranges(count, grain, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end && i < first.load(std::memory_order_relaxed); ++i) {
            if (!bad(i)) continue;
            std::size_t known = first.load();
            while (i < known && !first.compare_exchange_weak(known, i)) {
            }
            return;
        }
    });
    return first;
}

// Calls mend(item) for each; counts those for which it returned true.
template <class T, class Mend>
static std::size_t mend_all(std::vector<T>& items, const Mend& mend)
{
    std::atomic<std::size_t> mended = 0;
    parallel_ranges(items.size(), grain, [&](std::size_t begin, std::size_t end) {
        std::size_t here = 0;
        for (std::size_t i = begin; i < end; ++i) here += mend(items[i]) ? 1 : 0;
        if (here > 0) mended += here;
    });
    return mended;
}

enum class Fault : std::uint8_t
{
    no,
    position,
    area
};

// What nearly all triangles pass: corners that are there, and an area far above the rounding of floats. Three times as
// fast as looking closely.
static bool is_plainly_good(const Mesh& mesh, uvec3 t)
{
    const std::size_t vertices = mesh.positions.size();
    if (t.x >= vertices || t.y >= vertices || t.z >= vertices) return false;
    const vec3 a = mesh.positions[t.x], b = mesh.positions[t.y], c = mesh.positions[t.z];
    const vec3 e1 = b - a, e2 = c - a;
    const float size4 = dot(e1, e1) * dot(e2, e2);
    const vec3 n = cross(e1, e2);
    constexpr float sine2 = 1e-6f, smallest = 1e-30f, largest = 1e30f; // false for NaN
    return dot(n, n) > sine2 * size4 && size4 > smallest && size4 < largest && is_seen(a) && is_seen(b) && is_seen(c);
}

static Fault triangle_fault(const Mesh& mesh, uvec3 t)
{
    if (is_plainly_good(mesh, t)) return Fault::no;
    const vec3 a = mesh.positions[t.x], b = mesh.positions[t.y], c = mesh.positions[t.z];
    if (!is_seen(a) || !is_seen(b) || !is_seen(c)) return Fault::position;
    const glm::dvec3 e1 = glm::dvec3(b) - glm::dvec3(a), e2 = glm::dvec3(c) - glm::dvec3(a);
    const glm::dvec3 n = glm::cross(e1, e2);
    // Long thin triangles are kept; what is thinner than the rounding of doubles is a line.
    constexpr double line = 1e-28;
    return glm::dot(n, n) > line * glm::dot(e1, e1) * glm::dot(e2, e2) ? Fault::no : Fault::area;
}

// Drops the triangles that have no surface, in place and in order.
static void drop_triangles(Mesh& mesh, bool keep_lines, std::size_t& bad_positions, std::size_t& no_area)
{
    const std::size_t count = mesh.triangles.size();
    const auto fault = [&](std::size_t i) {
        const Fault found = triangle_fault(mesh, mesh.triangles[i]);
        return keep_lines && found == Fault::area ? Fault::no : found;
    };
    const std::size_t first = find_first(count, [&](std::size_t i) { return fault(i) != Fault::no; });
    std::size_t kept = first;
    for (std::size_t i = first; i < count; ++i) {
        switch (fault(i)) {
        case Fault::no:
            mesh.triangles[kept] = mesh.triangles[i];
            if (!mesh.triangle_materials.empty()) mesh.triangle_materials[kept] = mesh.triangle_materials[i];
            ++kept;
            break;
        case Fault::position:
            ++bad_positions;
            break;
        case Fault::area:
            ++no_area;
            break;
        }
    }
    mesh.triangles.resize(kept);
    if (!mesh.triangle_materials.empty()) mesh.triangle_materials.resize(kept);
}

// Whether a normal's direction survives the arithmetic of floats.
static bool is_direction(vec3 n)
{
    const float size2 = dot(n, n);
    return size2 > 1e-30f && size2 < 1e30f; // false for NaN
}

// Gives the vertices without a usable normal the area-weighted mean over their triangles.
static std::size_t mend_normals(Mesh& mesh)
{
    std::vector<std::uint8_t> bad;
    const std::size_t count = mesh.normals.size();
    if (find_first(count, [&](std::size_t i) { return !is_direction(mesh.normals[i]); }) == count) return 0;

    bad.resize(count);
    std::size_t mended = 0;
    for (std::size_t i = 0; i < count; ++i) {
        if (is_direction(mesh.normals[i])) continue;
        bad[i] = 1;
        ++mended;
    }
    std::vector<glm::dvec3> sums(count, glm::dvec3(0.0));
    for (const uvec3 t : mesh.triangles) {
        if (!bad[t.x] && !bad[t.y] && !bad[t.z]) continue;
        const glm::dvec3 a(mesh.positions[t.x]), b(mesh.positions[t.y]), c(mesh.positions[t.z]);
        const glm::dvec3 n = glm::cross(b - a, c - a);
        for (int k = 0; k < 3; ++k) sums[t[k]] += n;
    }
    for (std::size_t i = 0; i < count; ++i) {
        if (!bad[i]) continue;
        const double size = glm::length(sums[i]);
        mesh.normals[i] = size > 0.0 ? vec3(sums[i] / size) : vec3(0, 1, 0); // in no triangle: never looked at
    }
    return mended;
}

std::vector<std::string> validate_mesh(Mesh& mesh, const std::string& who, std::size_t material_count,
                                       bool changes_shape)
{
    const std::size_t vertices = mesh.positions.size();
    check_length(who, "normals", mesh.normals.size(), vertices, "vertices");
    check_length(who, "texture coordinates", mesh.uvs.size(), vertices, "vertices");
    check_length(who, "second texture coordinates", mesh.uvs_1.size(), vertices, "vertices");
    check_length(who, "tangents", mesh.tangents.size(), vertices, "vertices");
    check_length(who, "colours", mesh.colors.size(), vertices, "vertices");
    check_length(who, "triangle materials", mesh.triangle_materials.size(), mesh.triangles.size(), "triangles");

    // One pass over a mesh without faults.
    const std::size_t doubtful =
        find_first(mesh.triangles.size(), [&](std::size_t i) { return !is_plainly_good(mesh, mesh.triangles[i]); });
    const bool is_good = doubtful == mesh.triangles.size();
    const std::size_t outside = is_good ? mesh.triangles.size() : find_first(mesh.triangles.size(), [&](std::size_t i) {
        const uvec3 t = mesh.triangles[i];
        return t.x >= vertices || t.y >= vertices || t.z >= vertices;
    });
    if (outside < mesh.triangles.size()) {
        const uvec3 t = mesh.triangles[outside];
        const uint vertex = t.x >= vertices ? t.x : t.y >= vertices ? t.y : t.z;
        throw Error(fmt::format("{}: triangle {} refers to vertex {} of {}", who, outside, vertex, vertices));
    }
    mend_all(mesh.triangle_materials, [&](Index<MaterialDesc>& material) {
        if (material.valid()) return false;
        material = mesh.material;
        return true;
    });
    const std::size_t lost = find_first(mesh.triangle_materials.size(), [&](std::size_t i) {
        return mesh.triangle_materials[i].value >= material_count;
    });
    if (lost < mesh.triangle_materials.size())
        throw Error(fmt::format("{}: triangle {} refers to material {} of {}", who, lost,
                                mesh.triangle_materials[lost].value, material_count));

    std::vector<std::string> mended;
    const auto say = [&](std::size_t count, const char* one, const char* many) {
        if (count > 0) mended.push_back(fmt::format(fmt::runtime(count == 1 ? one : many), who, count));
    };
    std::size_t bad_positions = 0, no_area = 0;
    if (!is_good) drop_triangles(mesh, changes_shape, bad_positions, no_area);
    say(bad_positions, "{}: dropped {} triangle with a vertex that is NaN, infinite or beyond 1e18",
        "{}: dropped {} triangles with a vertex that is NaN, infinite or beyond 1e18");
    say(no_area, "{}: dropped {} triangle without area", "{}: dropped {} triangles without area");
    say(mend_normals(mesh), "{}: replaced {} zero or non-finite normal", "{}: replaced {} zero or non-finite normals");
    const auto mend_uv = [](vec2& uv) {
        if (is_finite(uv.x) && is_finite(uv.y)) return false;
        uv = vec2(0.0f);
        return true;
    };
    say(mend_all(mesh.tangents,
                 [](vec4& t) {
                     if (is_direction(vec3(t)) && is_finite(t.w)) return false;
                     t = vec4(1, 0, 0, 1);
                     return true;
                 }),
        "{}: replaced {} zero or non-finite tangent", "{}: replaced {} zero or non-finite tangents");
    say(mend_all(mesh.uvs, mend_uv) + mend_all(mesh.uvs_1, mend_uv), "{}: replaced {} non-finite texture coordinate",
        "{}: replaced {} non-finite texture coordinates");
    say(mend_all(mesh.colors,
                 [](vec4& color) {
                     vec3 rgb(color);
                     if (!is_finite3(rgb)) rgb = vec3(1.0f);
                     rgb = max(rgb, vec3(0.0f));
                     if (max3(rgb) > 1.0f) rgb = min(rgb / max3(rgb), vec3(1.0f));
                     const vec4 legal(rgb, is_finite(color.w) ? clamp(color.w, 0.0f, 1.0f) : 1.0f);
                     const bool differs = !(legal == color);
                     color = legal;
                     return differs;
                 }),
        "{}: mended {} vertex colour outside [0, 1]", "{}: mended {} vertex colours outside [0, 1]");
    return mended;
}

} // namespace snell
