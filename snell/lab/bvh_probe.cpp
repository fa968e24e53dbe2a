#include "snell/lab/bvh_probe.h"

#include "snell/bvh/primitives.h"
#include "snell/core/error.h"
#include "snell/core/timer.h"
#include "snell/kernel/views.h"
#include "snell/render/integrator.h"
#include "snell/render/params.h"

#include <algorithm>
#include <cmath>

#include <time.h>

namespace snell {

TreeFigures measure_tree(const TreeView& tree)
{
    TreeFigures figures;
    figures.sah_cost = tree.sah_cost;
    if (tree.nodes.empty()) return figures;
    const double whole = tree.nodes[0].box.half_area();
    double depths = 0;
    for (const TreeNode& node : tree.nodes) {
        if (node.depth >= figures.levels.size()) figures.levels.resize(node.depth + 1);
        LevelFigures& level = figures.levels[node.depth];
        if (whole > 0) level.area += node.box.half_area() / whole;
        if (node.kind == TreeNodeKind::inner) {
            ++level.nodes;
            ++figures.nodes;
            continue;
        }
        ++level.leaves;
        ++figures.leaves;
        level.primitives += node.primitives;
        figures.primitives += node.primitives;
        figures.depth = std::max(figures.depth, node.depth);
        depths += node.depth;
    }
    if (figures.leaves > 0) {
        figures.mean_leaf_depth = depths / static_cast<double>(figures.leaves);
        figures.mean_leaf_size = static_cast<double>(figures.primitives) / static_cast<double>(figures.leaves);
    }
    return figures;
}

std::array<vec3, 8> box_corners(const Box& box, const Transform* to_world)
{
    std::array<vec3, 8> corners;
    for (uint i = 0; i < 8; ++i) {
        vec3 p;
        for (int axis = 0; axis < 3; ++axis) p[axis] = (i >> axis & 1u) != 0 ? box.upper[axis] : box.lower[axis];
        corners[i] = to_world != nullptr ? transform_point(*to_world, p) : p;
    }
    return corners;
}

SceneQuality measure_scene_quality(const PackedScene& scene, const BuildOptions& options, bool with_epo)
{
    SceneQuality result;
    std::size_t largest = 0;
    const auto add = [&](const BinaryTree& tree) {
        if (tree.nodes.empty()) return;
        const TreeQuality one = measure_quality(scene, tree, with_epo);
        TreeQuality& sum = result.sum;
        result.trees += 1;
        sum.nodes += one.nodes;
        sum.leaves += one.leaves;
        sum.references += one.references;
        sum.depth = std::max(sum.depth, one.depth);
        if (one.references <= largest) return;
        largest = one.references;
        sum.sah = one.sah;
        sum.epo = one.epo;
        sum.mean_leaf_depth = one.mean_leaf_depth;
        sum.mean_leaf_size = one.mean_leaf_size;
    };
    std::vector<Box> boxes;
    for (const PackedGroup& group : scene.groups) {
        const BinaryTree tree = build_tree(scene, collect_primitives(scene, group), options);
        boxes.push_back(tree.nodes.empty() ? Box() : tree.nodes[0].box);
        add(tree);
    }
    std::vector<PrimitiveRef> refs = collect_primitives(scene, scene.world);
    collect_instances(scene, boxes, refs);
    add(build_tree(scene, std::move(refs), options));
    return result;
}

// ---- speed ----

ViewRays make_view_rays(const Prepared& prepared, const CameraDesc& camera, const RenderSettings& settings,
                        std::size_t count)
{
    const IntegratorInfo* path = find_integrator("path");
    RenderSettings plain = settings;
    plain.integrator = path->name;
    plain.parameters.clear();
    // The same view in fewer pixels, so that the rays are spread over all of it.
    const double scale = std::min(1.0, std::sqrt(static_cast<double>(std::max<std::size_t>(count, 64)) /
                                                 (static_cast<double>(settings.width) * settings.height)));
    plain.width = std::max(8, static_cast<int>(settings.width * scale) / 8 * 8);
    plain.height = std::max(8, static_cast<int>(settings.height * scale) / 8 * 8);
    const ReadyParams params = make_render_params(plain, *path, camera, prepared.packed.radius);

    ViewRays rays;
    std::vector<PathState> states;
    for (int y0 = 0; y0 < plain.height; y0 += 8)
        for (int x0 = 0; x0 < plain.width; x0 += 8)
            for (int i = 0; i < 64; ++i) {
                const CameraPath start =
                    generate_camera_path(params, static_cast<uint>(x0 + i % 8), static_cast<uint>(y0 + i / 8), 0u, 0u);
                rays.camera.push_back(start.ray);
                states.push_back(start.state);
            }
    std::vector<Hit> hits(rays.camera.size());
    prepared.accel->intersect(rays.camera, hits);
    const SceneView view = prepared.packed.view();
    for (std::size_t i = 0; i < hits.size(); ++i) {
        if (!is_hit(hits[i])) continue;
        Connection c = ambient_connection(view, params, states[i], rays.camera[i], hits[i]);
        c.ray.t_max = infinity();
        rays.bounce.push_back(c.ray);
    }
    // Neighbours in a queue of a path tracer have little in common; the order is the same each time.
    for (std::size_t i = rays.bounce.size(); i > 1; --i)
        std::swap(rays.bounce[i - 1], rays.bounce[hash_uint(static_cast<uint>(i)) % i]);
    return rays;
}

static double thread_seconds()
{
    timespec now{};
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
    return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

static double mrays_per_second(const Accel& accel, std::span<const Ray> rays, double seconds)
{
    if (rays.empty()) return 0;
    constexpr std::size_t batch = 2048; // as the backend's
    std::vector<Hit> hits(batch);
    std::vector<double> speeds;
    double spent = 0;
    while (speeds.size() < 3 || (spent < seconds && speeds.size() < 1000)) {
        const double start = thread_seconds();
        for (std::size_t i = 0; i < rays.size(); i += batch) {
            const std::size_t n = std::min(batch, rays.size() - i);
            accel.intersect(rays.subspan(i, n), std::span(hits).first(n));
        }
        const double took = std::max(thread_seconds() - start, 1e-9);
        spent += took;
        speeds.push_back(1e-6 * static_cast<double>(rays.size()) / took);
        if (spent > 20 * seconds) break; // brute force on a large scene
    }
    std::nth_element(speeds.begin(), speeds.begin() + static_cast<std::ptrdiff_t>(speeds.size() / 2), speeds.end());
    return speeds[speeds.size() / 2];
}

TraceSpeed measure_speed(const Accel& accel, const ViewRays& rays, double seconds)
{
    return {mrays_per_second(accel, rays.camera, seconds), mrays_per_second(accel, rays.bounce, seconds)};
}

StructureFigures measure_structure(const Prepared& prepared, const std::string& accel, const std::string& builder,
                                   const ViewRays& rays, double seconds)
{
    const AccelInfo* info = find_accel(accel);
    if (info == nullptr) throw Error(fmt::format("there is no accelerator '{}'", accel), "`snell list` names them");
    StructureFigures figures;
    figures.accel = accel;
    figures.builder = builder;
    AccelOptions options;
    options.build.builder = builder;
    const Timer timer;
    const std::unique_ptr<Accel> built = info->make(prepared.packed, options);
    figures.build_seconds = timer.seconds();
    figures.stats = built->stats;
    figures.speed = measure_speed(*built, rays, seconds);
    if (find_trees(*built) != nullptr) {
        figures.has_quality = true;
        figures.has_epo = prepared.packed.triangles.size() <= epo_triangles;
        figures.quality = measure_scene_quality(prepared.packed, options.build, figures.has_epo);
    }
    return figures;
}

} // namespace snell
