#include "bench_trace.h"

#include "bench_lane.h"
#include "console.h"

#include "snell/core/error.h"
#include "snell/core/parallel.h"
#include "snell/core/timer.h"

#ifdef SNELL_HAS_EMBREE
#include "snell/bvh/embree_scene.h"
#endif

#include <fmt/format.h>

#include <algorithm>
#include <functional>
#include <map>
#include <memory>
#include <set>

namespace snell::app {

namespace {

// Triangles that all structures of ours may hold together: scenes beyond are measured a few structures at a time.
constexpr std::size_t triangles_at_once = 12'000'000;

// What can be built: each of ours, and Embree in each quality.
struct Structure
{
    std::string name;
    std::function<void()> build; // in place of what was built before
    std::function<void()> drop;
    std::vector<double> seconds, cpu_seconds;
    double spent = 0;
    std::unique_ptr<Accel> accel; // of ours
#ifdef SNELL_HAS_EMBREE
    std::unique_ptr<EmbreeScene> embree;
#endif
    std::vector<std::size_t> rows; // of the AccelScene: one, or one for each width of Embree's packets
};

class Measurement
{
  public:
    Measurement(const std::string& scene_name, const PackedScene& packed, const Camera& camera_of_rays,
                const TraceJob& what, std::vector<std::string>& complaints)
        : scene(packed), camera(camera_of_rays), job(what), failures(complaints)
    {
        result.name = scene_name;
        result.triangles = packed.triangles.size();
        result.spheres = packed.spheres.size();
        result.instances = packed.instances.size();
    }

    AccelScene run();

  private:
    const PackedScene& scene;
    const Camera& camera;
    const TraceJob& job;
    std::vector<std::string>& failures;
    AccelScene result;
    std::vector<Structure> structures; // ours, then Embree's
    std::vector<RaySet> sets;
    std::vector<Answers> references; // by set

    void add_ours(const StructureChoice& choice);
    void add_embree();
    void build(std::span<Structure* const> group);
    void trace(std::span<Structure* const> group);
    void trace_set(std::size_t number, std::span<Structure* const> group);
    void note_build(Structure& structure);
};

void Measurement::add_ours(const StructureChoice& choice)
{
    AccelRow row;
    row.name = choice.name;
    row.accel = choice.info->name;
    row.builder = choice.builder;
    row.traversal = choice.traversal;
    Structure structure;
    structure.name = choice.name;
    structure.rows = {result.rows.size()};
    result.rows.push_back(std::move(row));
    structures.push_back(std::move(structure));
    const std::size_t at = structures.size() - 1;
    structures[at].build = [this, at, choice] {
        structures[at].accel.reset();
        structures[at].accel = choice.info->make(scene, choice.options);
    };
    structures[at].drop = [this, at] { structures[at].accel.reset(); };
}

void Measurement::add_embree()
{
    if (!job.embree) return;
#ifdef SNELL_HAS_EMBREE
    if (!scene.planes.empty()) {
        console().warning(fmt::format("{}: infinite planes are nothing for Embree; it is left out", result.name));
        return;
    }
    struct Kind
    {
        const char* name;
        YardstickQuality quality;
        EmbreeQuality embree;
    };
    for (const Kind& kind : {Kind{"Embree", YardstickQuality::medium, EmbreeQuality::medium},
                             Kind{"Embree HIGH", YardstickQuality::high, EmbreeQuality::high},
                             Kind{"Embree LOW", YardstickQuality::low, EmbreeQuality::low}}) {
        if (kind.quality == YardstickQuality::low && !job.low_quality) continue;
        if (kind.quality == YardstickQuality::high && !job.high_quality) continue;
        Structure structure;
        structure.name = kind.name;
        for (const unsigned packet : {1u, 8u, 16u}) {
            if (packet > 1 && (!job.packets || kind.quality == YardstickQuality::low)) continue;
            AccelRow row;
            row.name = packet == 1 ? kind.name : fmt::format("{} packets of {}", kind.name, packet);
            if (job.robust) row.name += " robust";
            row.quality = kind.quality;
            row.packet = packet;
            structure.rows.push_back(result.rows.size());
            result.rows.push_back(std::move(row));
        }
        structures.push_back(std::move(structure));
        const std::size_t at = structures.size() - 1;
        EmbreeSceneOptions options;
        options.quality = kind.embree;
        options.robust = job.robust;
        structures[at].build = [this, at, options] {
            structures[at].embree.reset();
            structures[at].embree = std::make_unique<EmbreeScene>(scene, options);
        };
        structures[at].drop = [this, at] { structures[at].embree.reset(); };
    }
#else
    console().warning("built without Embree: nothing to compare with; install libembree-dev and build again");
#endif
}

// Several times in turn, and the last ones are kept.
void Measurement::build(std::span<Structure* const> group)
{
    const int rounds = job.runs;
    for (int round = 0; round < rounds; ++round) {
        for (Structure* one : group) {
            if (round > 0 && one->spent * (1.0 + 1.0 / round) > job.build_budget) continue;
            if (round == 0) console().info(fmt::format("{}: building {}", result.name, one->name));
            one->drop();
            const Timer timer;
            const double cpu = process_cpu_seconds();
            one->build();
            double seconds = timer.seconds();
            one->spent += seconds;
#ifdef SNELL_HAS_EMBREE
            if (one->embree) seconds = one->embree->build_seconds(); // without the copy of the vertices
#endif
            one->seconds.push_back(seconds);
            one->cpu_seconds.push_back(process_cpu_seconds() - cpu);
        }
    }
    for (Structure* one : group) note_build(*one);
}

void Measurement::note_build(Structure& structure)
{
    for (const std::size_t number : structure.rows) {
        AccelRow& row = result.rows[number];
        row.build = spread_of(structure.seconds);
        row.build_cpu_seconds = spread_of(structure.cpu_seconds).median;
        if (structure.accel) {
            row.bytes = structure.accel->stats.bytes;
            row.nodes = structure.accel->stats.nodes;
            row.sah_cost = structure.accel->stats.sah_cost;
        }
#ifdef SNELL_HAS_EMBREE
        if (structure.embree) row.bytes = structure.embree->bytes();
#endif
    }
}

void Measurement::trace(std::span<Structure* const> group)
{
    if (sets.empty()) {
        console().info(fmt::format("{}: preparing rays", result.name));
        RaySetOptions options;
        options.rays = job.rays;
        sets = make_ray_sets(scene, camera, *structures[0].accel, options);
        references.resize(sets.size());
        for (const RaySet& set : sets) result.sets.emplace_back(set.name, set.rays.size());
    }
    for (std::size_t i = 0; i < sets.size(); ++i)
        if (!sets[i].rays.empty()) trace_set(i, group);
}

void Measurement::trace_set(std::size_t number, std::span<Structure* const> group)
{
    const RaySet& set = sets[number];
    console().info(fmt::format("{}: {} rays", result.name, set.name));
    std::vector<Lane> lanes;
    Answers own;
#ifdef SNELL_HAS_EMBREE
    std::map<unsigned, std::shared_ptr<bench::EmbreeRays>> prepared; // by width; all qualities take the same ones
#endif
    for (Structure* one : group) {
        if (one->accel) {
            lanes.push_back(our_lane(*one->accel, one->rows[0], set, references[number], own, job.falsify));
            continue;
        }
#ifdef SNELL_HAS_EMBREE
        for (const std::size_t row : one->rows) {
            const unsigned width = result.rows[row].packet;
            // Beyond the first bounces packets only lose time, the benchmark's as well.
            if (width > 1 && set.name.starts_with("bounce")) continue;
            auto& rays = prepared[width];
            if (!rays) rays = std::make_shared<bench::EmbreeRays>(set.rays, width, set.any_hit);
            // Which way it treats packets better depends on the scene: the row has the better one.
            for (const bool coherent : {false, true}) {
                if (width == 1 && coherent != set.coherent) continue;
                lanes.push_back(embree_lane(one->embree->handle(), row, set, rays, coherent, references[number], scene,
                                            job.falsify));
            }
        }
#endif
    }

    const double rays = static_cast<double>(set.rays.size());
    for (int run = -1; run < job.runs; ++run) { // the first one warms up and is checked
        for (Lane& lane : lanes) {
            lane.reset();
            const Spent one = run_once(set.rays.size(), run < 0, lane.trace);
            if (run < 0) {
                AccelRow& row = result.rows[lane.row];
                const Disagreement difference = lane.check();
                std::size_t& count = row.traces[set.name].disagreements;
                count = std::max(count, difference.count);
                if (difference.count > lane.allowed)
                    failures.push_back(fmt::format("{}: {} disagrees with {} about {} of {} {} rays: {}", result.name,
                                                   row.name, result.rows[0].name, difference.count, set.rays.size(),
                                                   set.name, difference.text));
                continue;
            }
            lane.one.push_back(1e-6 * rays / one.cpu);
            if (!job.all_threads) continue;
            lane.reset();
            const Spent all = run_once(set.rays.size(), true, lane.trace);
            lane.all.push_back(1e-6 * rays / all.cpu * thread_count());
            lane.wall.push_back(1e-6 * rays / all.wall);
        }
    }
    std::set<std::size_t> known; // rows of this group
    for (Lane& lane : lanes) {
        TraceFigure& figure = result.rows[lane.row].traces[set.name];
        const Spread one = spread_of(std::move(lane.one));
        if (!known.insert(lane.row).second && one.median <= figure.one.median) continue;
        figure.one = one;
        figure.all = spread_of(std::move(lane.all));
        figure.wall = spread_of(std::move(lane.wall));
    }
}

AccelScene Measurement::run()
{
    structures.reserve(job.ours.size() + 3);
    for (const StructureChoice& choice : job.ours) add_ours(choice);
    add_embree();

    // The first one of ours and Embree's are in every group, so that all are measured beside them.
    std::vector<Structure*> fixed = {&structures[0]}, others;
    for (std::size_t i = 1; i < structures.size(); ++i)
        (i < job.ours.size() ? others : fixed).push_back(&structures[i]);
    const std::size_t at_once =
        std::max<std::size_t>(1, triangles_at_once / std::max<std::size_t>(result.triangles, 1));
    build(fixed);
    for (std::size_t first = 0; first == 0 || first < others.size(); first += at_once) {
        std::vector<Structure*> some(others.begin() + static_cast<std::ptrdiff_t>(std::min(first, others.size())),
                                     others.begin() +
                                         static_cast<std::ptrdiff_t>(std::min(first + at_once, others.size())));
        build(some);
        if (job.trace) {
            std::vector<Structure*> group = fixed;
            group.insert(group.begin() + 1, some.begin(), some.end());
            trace(group);
        }
        for (Structure* one : some) one->drop();
    }
    return std::move(result);
}

} // namespace

AccelScene measure_structures(const std::string& name, const PackedScene& scene, const Camera& camera,
                              const TraceJob& job, std::vector<std::string>& failures)
{
    SNELL_CHECK_LT(0u, job.ours.size());
    return Measurement(name, scene, camera, job, failures).run();
}

} // namespace snell::app
