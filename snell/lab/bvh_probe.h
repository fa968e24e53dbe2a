// Looking into acceleration structures: figures of trees by level, and what builders come to on the rays of a view.
#pragma once

#include "snell/bvh/inspect.h"
#include "snell/bvh/quality.h"
#include "snell/render/render.h"

#include <array>
#include <string>
#include <vector>

namespace snell {

struct LevelFigures
{
    std::size_t nodes = 0, leaves = 0; // nodes: inner ones; an instance counts as a leaf
    std::size_t primitives = 0;        // in the leaves
    double area = 0; // of all boxes of the level over that of the root's: the visits that a random ray makes there
};

struct TreeFigures
{
    std::size_t nodes = 0, leaves = 0, primitives = 0;
    uint depth = 0; // of the deepest leaf; the root has 0
    double mean_leaf_depth = 0, mean_leaf_size = 0;
    double sah_cost = 0;              // as TreeView's
    std::vector<LevelFigures> levels; // by depth
};
TreeFigures measure_tree(const TreeView& tree);

// The corners of a box, moved by an instance's transform unless it is nullptr. Bit i of a corner's number: the upper
// side on axis i.
std::array<vec3, 8> box_corners(const Box& box, const Transform* to_world = nullptr);

// The binary trees that the options' builder makes of a scene: sums, but SAH cost and EPO, which are of the largest
// tree. with_epo: see measure_quality().
struct SceneQuality
{
    TreeQuality sum;
    std::size_t trees = 0;
};
SceneQuality measure_scene_quality(const PackedScene& scene, const BuildOptions& options, bool with_epo = true);

// Rays of a view: camera rays evenly over the picture in tiles of 8 by 8 pixels, and from what each of them hits one in
// a direction drawn by the cosine, shuffled. About `count` of each; the same ones whatever the structure.
struct ViewRays
{
    std::vector<Ray> camera, bounce;
};
ViewRays make_view_rays(const Prepared& prepared, const CameraDesc& camera, const RenderSettings& settings,
                        std::size_t count);

// Millions of rays a second of this thread's time: the median of at least three rounds through the rays, and of as many
// as go into `seconds` for each set. 0 for a set without rays.
struct TraceSpeed
{
    double camera = 0, bounce = 0;
};
TraceSpeed measure_speed(const Accel& accel, const ViewRays& rays, double seconds);

// A structure built anew and measured.
struct StructureFigures
{
    std::string accel, builder;
    double build_seconds = 0;
    AccelStats stats;
    TraceSpeed speed;
    bool has_quality = false; // of the builder's binary trees
    bool has_epo = false;     // left out for more than epo_triangles
    SceneQuality quality;
};
inline constexpr std::size_t epo_triangles = 500'000;

// accel: a name of accels(); builder: a name of builders(), or empty for structures without. Throws Error for unknown
// names and for a structure that is not in this build.
StructureFigures measure_structure(const Prepared& prepared, const std::string& accel, const std::string& builder,
                                   const ViewRays& rays, double seconds);

} // namespace snell
