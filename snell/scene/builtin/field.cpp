// A field of boulders in a closed hall, of as many triangles as one asks for: what structures are measured with.
#include "snell/core/error.h"
#include "snell/core/parallel.h"
#include "snell/kernel/random.h"
#include "snell/kernel/warp.h"
#include "snell/scene/builtin.h"
#include "snell/scene/builtin/makers.h"
#include "snell/scene/shapes.h"

#include <algorithm>
#include <cmath>

namespace snell {

namespace {

float corner_value(int x, int y, int z, uint seed)
{
    const uvec3 word = pcg3d(uvec3(static_cast<uint>(x), static_cast<uint>(y), static_cast<uint>(z) ^ (seed << 20u)));
    return 2.0f * unit_float(word.x) - 1.0f;
}

// Value noise from -1 to 1: random numbers at whole coordinates, smoothly joined.
float value_noise(vec3 p, uint seed)
{
    const vec3 cell = floor(p), f = p - cell, s = f * f * (3.0f - 2.0f * f);
    const int x = static_cast<int>(cell.x), y = static_cast<int>(cell.y), z = static_cast<int>(cell.z);
    float sides[2];
    for (int dz = 0; dz < 2; ++dz) {
        const float near = mix(corner_value(x, y, z + dz, seed), corner_value(x + 1, y, z + dz, seed), s.x);
        const float far = mix(corner_value(x, y + 1, z + dz, seed), corner_value(x + 1, y + 1, z + dz, seed), s.x);
        sides[dz] = mix(near, far, s.y);
    }
    return mix(sides[0], sides[1], s.z);
}

// Octaves of it (Perlin 1985), so many that the finest are as wide as a few triangles: rough at every size.
float rough_noise(vec3 p, int octaves, uint seed)
{
    float sum = 0.0f, weight = 1.0f;
    for (int i = 0; i < octaves; ++i) {
        sum += weight * value_noise(p, seed + static_cast<uint>(i));
        weight *= 0.52f;
        p = 2.0f * p + vec3(17.3f, 5.1f, 9.7f); // or all octaves would have a corner at 0
    }
    return sum;
}

int octaves_for(int steps, float cells)
{
    return std::clamp(static_cast<int>(std::log2(static_cast<float>(steps) / cells)) - 1, 1, 14);
}

constexpr float ground_cells = 3.0f; // of the coarsest octave, from the middle to a wall

float ground_height(float x, float z, int octaves)
{
    return 0.14f * rough_noise(ground_cells * vec3(x, 0.0f, z), octaves, 11u);
}

// Squares over [-1, 1]^2, each of two triangles.
Mesh make_ground(int steps, int octaves, Index<MaterialDesc> material)
{
    Mesh mesh;
    mesh.name = "ground";
    mesh.material = material;
    const auto columns = static_cast<std::size_t>(steps) + 1;
    mesh.positions.resize(columns * columns);
    mesh.triangles.resize(2 * (columns - 1) * (columns - 1));
    parallel_ranges(columns, 8, [&](std::size_t begin, std::size_t end) {
        const auto place = [&](std::size_t i) {
            return -1.0f + 2.0f * static_cast<float>(i) / static_cast<float>(steps);
        };
        for (std::size_t row = begin; row < end; ++row) {
            for (std::size_t column = 0; column < columns; ++column) {
                const float x = place(column), z = place(row);
                mesh.positions[row * columns + column] = {x, ground_height(x, z, octaves), z};
                if (row + 1 == columns || column + 1 == columns) continue;
                const uint a = static_cast<uint>(row * columns + column), b = a + 1;
                const uint c = a + static_cast<uint>(columns), d = c + 1;
                uvec3* two = &mesh.triangles[2 * (row * (columns - 1) + column)];
                two[0] = {a, c, b};
                two[1] = {b, c, d};
            }
        }
    });
    return mesh;
}

struct Boulder
{
    vec3 center, radii;
    uint seed = 0;
};

// Appended at the given places: 2 rings (rings - 1) + 2 vertices and 4 rings (rings - 1) triangles.
void make_boulder(const Boulder& boulder, int rings, vec3* vertices, uvec3* triangles, uint first)
{
    const int around = 2 * rings, octaves = octaves_for(around, 6.0f);
    const auto set_vertex = [&](int number, vec3 n) {
        const float bulge = 1.0f + 0.3f * rough_noise(1.6f * n + vec3(20.0f), octaves, boulder.seed);
        vertices[number] = boulder.center + boulder.radii * (bulge * n);
    };
    set_vertex(0, vec3(0, 1, 0));
    set_vertex(1, vec3(0, -1, 0));
    const auto vertex = [&](int ring, int i) -> uint {
        if (ring == 0) return first;
        if (ring == rings) return first + 1u;
        return first + 2u + static_cast<uint>((ring - 1) * around + i % around);
    };
    for (int ring = 0; ring < rings; ++ring) {
        const vec2 down = unit_circle(0.5f * static_cast<float>(ring) / static_cast<float>(rings));
        for (int i = 0; i < around; ++i) {
            if (ring > 0) {
                const vec2 turn = unit_circle(static_cast<float>(i) / static_cast<float>(around));
                set_vertex(2 + (ring - 1) * around + i, vec3(down.y * turn.x, down.x, down.y * turn.y));
            }
            const uint a = vertex(ring, i), b = vertex(ring, i + 1), c = vertex(ring + 1, i),
                       d = vertex(ring + 1, i + 1);
            if (ring > 0) *triangles++ = {a, b, c};
            if (ring + 1 < rings) *triangles++ = {b, d, c};
        }
    }
}

Mesh make_boulders(const std::vector<Boulder>& boulders, int rings, Index<MaterialDesc> material)
{
    Mesh mesh;
    mesh.name = "boulders";
    mesh.material = material;
    const auto r = static_cast<std::size_t>(rings);
    const std::size_t vertices = 2 * r * (r - 1) + 2, triangles = 4 * r * (r - 1);
    mesh.positions.resize(boulders.size() * vertices);
    mesh.triangles.resize(boulders.size() * triangles);
    parallel_for(boulders.size(), [&](std::size_t i) {
        make_boulder(boulders[i], rings, &mesh.positions[i * vertices], &mesh.triangles[i * triangles],
                     static_cast<uint>(i * vertices));
    });
    return mesh;
}

} // namespace

Scene make_field(int count)
{
    if (count < field_least || count > field_most)
        throw Error(fmt::format("a field of {} triangles", count),
                    fmt::format("give a number from {} to {}", field_least, field_most));
    Scene scene;
    scene.name = "field";
    const auto earth = add(scene, diffuse("earth", vec3(0.42f, 0.33f, 0.22f)));
    const auto stone = add(scene, diffuse("stone", vec3(0.62f)));
    const auto wall = add(scene, diffuse("wall", vec3(0.72f, 0.74f, 0.78f)));
    const auto lamp = add(scene, emitter("lamp", vec3(14.0f, 13.0f, 11.0f)));

    // Six parts of ten are ground, the boulders are so fine that all of it comes to at least the number wanted.
    const double wanted = count;
    const int steps = static_cast<int>(std::sqrt(0.3 * wanted));
    const int octaves = octaves_for(steps, 2.0f * ground_cells);
    place(scene, make_ground(steps, octaves, earth));

    const int number = std::clamp(static_cast<int>(std::cbrt(wanted)), 8, 256);
    const double of_each = (wanted - 2.0 * steps * steps - 14.0) / number; // 4 rings (rings - 1)
    const int rings = std::max(3, static_cast<int>(std::ceil(0.5 + std::sqrt(0.25 + 0.25 * of_each))));
    std::vector<Boulder> boulders(static_cast<std::size_t>(number));
    for (std::size_t i = 0; i < boulders.size(); ++i) {
        const auto draw = [&](uint what) {
            const uvec3 word = pcg3d(uvec3(static_cast<uint>(i), what, 1995u));
            return vec3(unit_float(word.x), unit_float(word.y), unit_float(word.z));
        };
        const vec3 where = draw(0u), shape = draw(1u), size = draw(2u);
        const float radius = 0.03f + 0.13f * size.x * size.x;
        const float x = 1.7f * (where.x - 0.5f), z = 1.7f * (where.y - 0.5f);
        boulders[i].radii = radius * (0.7f + 0.6f * shape);
        boulders[i].center = {x, ground_height(x, z, octaves) + 0.4f * radius, z};
        boulders[i].seed = 100u + 16u * static_cast<uint>(i);
    }
    place(scene, make_boulders(boulders, rings, stone));

    Mesh hall = make_box("hall", {-1.0f, -0.5f, -1.0f}, {1.0f, 1.1f, 1.0f}, wall);
    for (uvec3& triangle : hall.triangles) std::swap(triangle.y, triangle.z); // seen from inside
    place(scene, std::move(hall));
    place(scene, make_quad("lamp", {-0.3f, 1.08f, -0.3f}, {0.3f, 1.08f, -0.3f}, {0.3f, 1.08f, 0.3f},
                           {-0.3f, 1.08f, 0.3f}, lamp));
    add(scene, CameraDesc{"in the corner", {-0.86f, 0.52f, 0.9f}, {0.1f, 0.0f, -0.15f}, {0, 1, 0}, 58.0f});
    return scene;
}

} // namespace snell
