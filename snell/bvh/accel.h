// Ray intersection structures, swappable by name.
#pragma once

#include "snell/bvh/build.h"
#include "snell/kernel/ray.h"
#include "snell/scene/packed.h"

#include <filesystem>
#include <map>
#include <memory>
#include <span>
#include <string>
#include <string_view>

namespace snell {

enum class TriangleTest
{
    watertight,
    moller_trumbore
};

// How a batch of rays goes through a tree.
enum class Traversal
{
    automatic, // packets for coherent batches, else streams
    single,    // one ray after the other
    packets,   // sixteen rays together
    stream     // many rays in flight
};

// What to do with the tree of a mesh that has changed its shape.
enum class UpdatePolicy
{
    automatic, // refit, and rebuild once the SAH cost is more than rebuild_factor times that of the last build
    refit,
    rebuild
};

struct AccelOptions
{
    TriangleTest triangle_test = TriangleTest::watertight;
    Traversal traversal = Traversal::automatic;
    BuildOptions build;
    UpdatePolicy update = UpdatePolicy::automatic;
    double rebuild_factor = 1.5;
    std::filesystem::path cache; // folder that keeps trees; empty: none
    bool build_on_gpu = false;   // the GPU that renders builds the trees too, and `build` is for the host's own use

    bool operator==(const AccelOptions&) const = default;
};

struct AccelStats
{
    double build_seconds = 0; // the last build, or update
    std::size_t bytes = 0;    // of the structure, the scene's own arrays not counted
    std::size_t nodes = 0, leaves = 0;
    double sah_cost = 0;                   // expected cost of a random ray that enters, in visits of nodes
    std::size_t refitted = 0, rebuilt = 0; // trees, by the last update; the one over instances not counted
    std::size_t loaded = 0, refused = 0;   // trees from AccelOptions::cache, and its files that were no good
};

// Finds hits for batches of rays. Thread-safe after construction; refers to the PackedScene it was built from. A ray
// with a NaN, a zero direction or an empty interval hits nothing. Ties in t go to the smaller primitive (then the
// smaller instance), so that every structure gives the same answer
// (but for those of AccelInfo::exact false).
class Accel
{
  public:
    virtual ~Accel() = default;

    // The nearest hit of each ray in (t_min, t_max). hits.size() == rays.size().
    virtual void intersect(std::span<const Ray> rays, std::span<Hit> hits) const = 0;

    // The nearest hit behind `after[i]`, a hit of the same ray: of surfaces at the same t, each comes once, in the
    // order of ties. For rays that pass through what they meet.
    virtual void intersect_next(std::span<const Ray> rays, std::span<const Hit> after, std::span<Hit> hits) const = 0;

    // blocked[i] becomes 1 if anything lies in (t_min, t_max) of ray i, else 0.
    virtual void occluded(std::span<const Ray> rays, std::span<std::uint8_t> blocked) const = 0;

    // As occluded, and says by what: primitives[i] becomes that of something in (t_min, t_max), not always the nearest,
    // as in Hit::primitive; none where nothing is.
    virtual void find_blockers(std::span<const Ray> rays, std::span<uint> primitives) const;

    // As intersect, and counts the steps (nodes visited plus primitive tests) of each ray.
    virtual void intersect_counted(std::span<const Ray> rays, std::span<Hit> hits, std::span<uint> steps) const = 0;

    // Follows the PackedScene, whose arrays have changed in place. Only what changed is touched: a tree is refitted or
    // rebuilt by the policy of the options, and the tree over the instances is rebuilt. Nobody may trace meanwhile.
    virtual void update(const PackedChanges& changes) = 0;

    AccelStats stats;
};

struct AccelInfo
{
    std::string_view name;
    std::string_view summary;
    std::unique_ptr<Accel> (*make)(const PackedScene&, const AccelOptions&);
    bool exact = true; // false: somebody else's code, whose hits may differ where edges are grazed, and which may not
                       // be part of this build: make() then throws Error
};

std::span<const AccelInfo> accels(); // the first one is the default
const AccelInfo* find_accel(std::string_view name);

} // namespace snell
