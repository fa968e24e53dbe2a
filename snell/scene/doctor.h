// The scene report: what a scene holds, what it will take to render, and what in it was mended or looks wrong. It
// finds the usual reasons of "my scene is black, or wrong" before a ray is traced.
#pragma once

#include "snell/scene/scene.h"

#include <cstddef>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace snell {

// One fact about a scene that its owner should know.
struct Finding
{
    enum class Severity
    {
        info,     // worth knowing
        repaired, // something was wrong and has been mended; the picture should be as meant
        doubtful, // the picture is probably not what was meant
        error     // the scene cannot be rendered as it is
    };
    std::string kind; // of a fixed list, for programs: "open-glass"
    Severity severity = Severity::info;
    std::string text;      // what, where and what to do
    std::size_t count = 1; // how many triangles, objects, texels, ... it is about
};

std::string_view to_string(Finding::Severity severity);

// The scene, counted. Kinds are in the order of their numbers, those that do not occur are left out.
struct SceneReport
{
    using Tally = std::vector<std::pair<std::string, std::size_t>>;
    struct Texture
    {
        std::string name;
        uint width = 0, height = 0;
        std::string format; // "rgba8-linear", "rgba8-srgb", "rgba32f"
        std::size_t bytes = 0;
    };

    std::size_t mesh_triangles = 0;   // in the meshes
    std::size_t placed_triangles = 0; // with every instance counted
    std::size_t placed_spheres = 0;
    std::size_t mirrored_instances = 0; // whose transform has a negative determinant
    Tally materials;                    // by kind: "diffuse", "dielectric", ...
    Tally lights;                       // by kind: "point", ..., "triangle", "sphere", each as often as it is placed
    std::size_t light_count = 0;        // the sum of these
    std::vector<Texture> textures;
    std::size_t morph_targets = 0; // of all rigs
    Bounds bounds;                 // of all instances, in the world
    std::size_t scene_bytes = 0;   // the Scene, textures included
    std::size_t texture_bytes = 0;
    std::size_t packed_bytes = 0;
    std::size_t accel_bytes = 0; // forecast for the default accelerator, to about a tenth
    std::size_t peak_bytes = 0;  // forecast for rendering, to about a tenth, without the film

    // By severity, the gravest first; of one kind there are at most `listed_of_a_kind`, and then one that counts the
    // rest.
    std::vector<Finding> findings;
    std::size_t infos = 0, repaired = 0, doubtful = 0, errors = 0; // findings, those included that are not listed

    static constexpr std::size_t listed_of_a_kind = 20;
};

// Examines a scene that has passed validate(). O(n log n) in the scene's size, in parallel; what would take longer is
// done on a sample (overlapping solids, lamps that light nothing, double faces of huge scenes). The scene is packed to
// be measured, so it needs the memory for that.
SceneReport examine(const Scene& scene);

} // namespace snell
