#include "snell/view/panels/bvh_facts.h"

#include "snell/core/error.h"
#include "snell/lab/pixel_probe.h"
#include "snell/view/overlay.h"

#include <algorithm>

namespace snell::view {

static const Prepared& prepared_of(const SessionAccess& access, const Which& which)
{
    if (which.pane >= access.prepared.size() || access.prepared[which.pane] == nullptr)
        throw Error("the scene is not ready yet");
    const RenderSettings& settings = access.panes[which.pane].settings;
    const auto builder = settings.parameters.find("builder");
    if (settings.accel != which.accel || (builder == settings.parameters.end() ? "" : builder->second) != which.builder)
        throw Error("the structure is being built");
    return *access.prepared[which.pane];
}

Facts gather_facts(const SessionAccess& access, const Which& which)
{
    const Prepared& prepared = prepared_of(access, which);
    Facts facts;
    facts.which = which;
    facts.stats = prepared.accel->stats;
    if (const Inspectable* trees = find_trees(*prepared.accel)) {
        facts.has_trees = true;
        for (const TreeView& tree : trees->trees())
            if (!tree.nodes.empty()) facts.trees.push_back({tree.name, measure_tree(tree)});
    }
    facts.speed = measure_speed(*prepared.accel,
                                make_view_rays(prepared, access.camera, access.panes[which.pane].settings, rays_of_set),
                                burst_seconds);
    return facts;
}

Level gather_level(const SessionAccess& access, const Which& which, int number, int depth)
{
    const Prepared& prepared = prepared_of(access, which);
    Level level;
    level.which = which;
    level.tree = number, level.depth = depth;
    const Inspectable* trees = find_trees(*prepared.accel);
    if (trees == nullptr) return level;
    int at = 0;
    for (const TreeView& tree : trees->trees()) {
        if (tree.nodes.empty() || at++ != number) continue;
        std::vector<const Transform*> places;
        if (tree.group == none)
            places.push_back(nullptr);
        else
            for (const Instance& instance : prepared.packed.instances)
                if (instance.group == tree.group) places.push_back(&instance.to_world);
        std::vector<const TreeNode*> nodes;
        for (const TreeNode& node : tree.nodes)
            if (static_cast<int>(node.depth) == depth) nodes.push_back(&node);
        level.count = nodes.size() * places.size();
        const std::size_t stride = std::max<std::size_t>(1, (level.count + most_boxes - 1) / most_boxes);
        for (std::size_t i = 0; i < level.count; i += stride) {
            const TreeNode& node = *nodes[i % nodes.size()];
            (node.kind == TreeNodeKind::inner ? level.nodes : level.leaves)
                .push_back(box_corners(node.box, places[i / nodes.size()]));
        }
    }
    return level;
}

Walk follow_ray(const SessionAccess& access, const Which& which, const PickedPixel& pixel,
                const RenderSettings& settings)
{
    const Prepared& prepared = prepared_of(access, which);
    const Inspectable* trees = find_trees(*prepared.accel);
    if (trees == nullptr) throw Error("this structure has no tree to follow a ray through");
    Walk walk;
    walk.which = which;
    walk.ray = probe_pixel(prepared, access.camera, access.scene, settings, pixel.x, pixel.y).first.ray;
    walk.walk = trees->walk(walk.ray);
    walk.length = is_hit(walk.walk.hit) ? walk.walk.hit.t : 2.0f * prepared.packed.radius;
    for (const WalkStep& step : walk.walk.steps) {
        const Transform* place = step.instance == none ? nullptr : &prepared.packed.instances[step.instance].to_world;
        walk.boxes.push_back(box_corners(step.box, place));
    }
    return walk;
}

std::string_view word_of(WalkStep::What what)
{
    switch (what) {
    case WalkStep::What::planes:
        return "planes";
    case WalkStep::What::node:
        return "node";
    case WalkStep::What::leaf:
        return "leaf";
    case WalkStep::What::skipped:
        return "skipped";
    case WalkStep::What::enter:
        return "into instance";
    default:
        return "out of instance";
    }
}

} // namespace snell::view
