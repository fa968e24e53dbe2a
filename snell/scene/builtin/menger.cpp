// Menger's sponge: of the 27 parts of a cube the 20 on its edges stay, and so on in each of them.
#include "snell/core/error.h"
#include "snell/scene/builtin.h"
#include "snell/scene/builtin/makers.h"
#include "snell/scene/shapes.h"

#include <algorithm>

namespace snell {

static constexpr int block_depth = 2; // levels within the mesh that the instances share; 400 cubes

// Whether the cell (x, y, z) of 3^levels a side belongs to the sponge.
static bool is_solid(ivec3 cell, int levels)
{
    for (int i = 0; i < 3; ++i)
        if (cell[i] < 0) return false;
    for (int level = 0; level < levels; ++level) {
        const int middles = (cell.x % 3 == 1) + (cell.y % 3 == 1) + (cell.z % 3 == 1);
        if (middles >= 2) return false;
        cell /= 3;
    }
    return cell == ivec3(0); // else outside
}

static int power(int base, int exponent)
{
    return exponent == 0 ? 1 : base * power(base, exponent - 1);
}

template <class Visit>
static void for_cells(int levels, const Visit& visit)
{
    const int size = power(3, levels);
    for (int z = 0; z < size; ++z)
        for (int y = 0; y < size; ++y)
            for (int x = 0; x < size; ++x)
                if (is_solid({x, y, z}, levels)) visit(ivec3(x, y, z));
}

// The sponge of that depth in [0, 1]^3. Faces between two of its cubes can never be seen and are left out.
static Mesh make_sponge(int levels, Index<MaterialDesc> material)
{
    Mesh mesh;
    mesh.name = "sponge";
    mesh.material = material;
    const int size = power(3, levels);
    const float step = 1.0f / static_cast<float>(size);
    std::vector<uint> number(static_cast<std::size_t>(power(size + 1, 3)), none);
    const auto vertex = [&](ivec3 p) {
        uint& n = number[static_cast<std::size_t>((p.z * (size + 1) + p.y) * (size + 1) + p.x)];
        if (n == none) {
            n = static_cast<uint>(mesh.positions.size());
            mesh.positions.push_back(vec3(p) * step);
        }
        return n;
    };
    for_cells(levels, [&](ivec3 cell) {
        for (int axis = 0; axis < 3; ++axis) {
            for (int side = 0; side < 2; ++side) {
                ivec3 normal(0), u(0), v(0);
                normal[axis] = 2 * side - 1;
                if (is_solid(cell + normal, levels)) continue;
                u[(axis + 1) % 3] = 1;
                v[(axis + 2) % 3] = 1;
                if (side == 0) std::swap(u, v);
                ivec3 corner = cell;
                corner[axis] += side;
                const uint a = vertex(corner), b = vertex(corner + u), c = vertex(corner + u + v),
                           d = vertex(corner + v);
                mesh.triangles.emplace_back(a, b, c);
                mesh.triangles.emplace_back(a, c, d);
            }
        }
    });
    return mesh;
}

Scene make_menger(int depth)
{
    if (depth < 0 || depth > menger_deepest)
        throw Error(fmt::format("a Menger sponge of depth {}", depth),
                    fmt::format("give a depth from 0 to {}", menger_deepest));
    Scene scene;
    scene.name = "menger";
    scene.environment.radiance = vec3(0.16f, 0.22f, 0.34f);
    const auto stone = add(scene, diffuse("stone", {0.75f, 0.68f, 0.58f}));
    const auto floor = add(scene, diffuse("floor", {0.36f, 0.34f, 0.33f}));
    const auto lamp = add(scene, emitter("lamp", {26.0f, 12.0f, 3.6f}));
    add(scene, PlaneDesc{"floor", vec3(0.0f), {0, 1, 0}, floor});

    // The cube [-1, 1] x [0, 2] x [-1, 1].
    const Transform place_cube = compose(translation({-1, 0, -1}), scaling(vec3(2.0f)));
    const int inner = std::min(depth, block_depth), outer = depth - inner;
    const Index<Mesh> mesh = add(scene, make_sponge(inner, stone));
    const Index<Group> block = add(scene, Group{"block", {mesh}, {}});
    const float scale = 1.0f / static_cast<float>(power(3, outer));
    for_cells(outer, [&](ivec3 cell) {
        const Transform place_block = compose(scaling(vec3(scale)), translation(vec3(cell)));
        add(scene, InstanceDesc{"", block, compose(place_cube, place_block)});
    });

    if (depth > 0) place(scene, SphereDesc{"lamp", {0, 1, 0}, 0.22f, lamp});
    LightDesc sun;
    sun.name = "sun";
    sun.kind = light_directional;
    sun.direction = {0.6f, -1.0f, -0.35f};
    sun.emission = vec3(2.7f, 2.35f, 1.9f);
    add(scene, sun);
    add(scene, CameraDesc{"corner", {2.9f, 3.3f, 4.6f}, {0.05f, 0.86f, 0.0f}, {0, 1, 0}, 33.0f});
    return scene;
}

} // namespace snell
