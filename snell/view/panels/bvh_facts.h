// What the panel of trees shows: gathered in the session's thread, where the structure is.
#pragma once

#include "snell/lab/bvh_probe.h"
#include "snell/render/session.h"
#include "snell/view/panel.h"

#include <array>
#include <string>
#include <string_view>
#include <vector>

namespace snell::view {

inline constexpr std::size_t most_boxes = 4000;   // of a level, that are gathered
inline constexpr std::size_t rays_of_set = 16384; // to measure speed with
inline constexpr double burst_seconds = 0.05;     // for each set of rays

// Which structure a pane traces with.
struct Which
{
    std::size_t pane = 0;
    std::string accel, builder;
    std::uint64_t scene = 0; // SessionStatus::scene_version
    bool operator==(const Which&) const = default;
};

// One with nodes.
struct Tree
{
    std::string name;
    TreeFigures figures;
};

struct Facts
{
    Which which;
    bool has_trees = false;
    std::vector<Tree> trees;
    AccelStats stats;
    TraceSpeed speed;
};

struct Level
{
    Which which;
    int tree = -1, depth = -1;
    std::size_t count = 0; // of boxes on that level, every instance of a group's tree counted
    std::vector<std::array<vec3, 8>> nodes, leaves;
};

struct Walk
{
    Which which;
    Ray ray;
    RayWalk walk;
    std::vector<std::array<vec3, 8>> boxes; // of the steps, in world space
    float length = 0;                       // of the ray that is drawn
};

// Of the structure and its trees; how fast it traces is measured. Throw Error while the structure is not there yet.
Facts gather_facts(const SessionAccess& access, const Which& which);
// The boxes of one level of a tree (a number of Facts::trees), of all its instances: most_boxes at most.
Level gather_level(const SessionAccess& access, const Which& which, int tree, int depth);
// The central ray of a pixel, step by step.
Walk follow_ray(const SessionAccess& access, const Which& which, const PickedPixel& pixel,
                const RenderSettings& settings);

std::string_view word_of(WalkStep::What what);

} // namespace snell::view
