// What measuring acceleration structures comes to: figures of each structure, and ratios to Embree.
#pragma once

#include <cstddef>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace snell {

// Of several runs.
struct Spread
{
    double median = 0, low = 0, high = 0;
};

Spread spread_of(std::vector<double> values); // zeros if there are none

// How fast one set of rays goes through one structure.
struct TraceFigure
{
    Spread one;                    // Mrays a second of CPU time, one thread at work
    Spread all;                    // all threads at work: their number times Mrays a second of CPU time of each
    Spread wall;                   // all threads, Mrays a second of the clock on the wall
    std::size_t disagreements = 0; // rays
};

enum class YardstickQuality
{
    ours, // none of Embree's
    low,
    medium,
    high
};

struct AccelRow
{
    std::string name;
    std::string accel, builder, traversal;                  // of ours
    YardstickQuality quality = YardstickQuality::ours;      // of Embree's
    unsigned packet = 1;                                    // of Embree's: rays a call
    Spread build;                                           // seconds, all threads
    double build_cpu_seconds = 0;                           // of all threads together, median
    std::size_t bytes = 0, nodes = 0;                       // nodes: 0 where it does not say
    double sah_cost = 0;                                    // 0 where it does not say
    std::map<std::string, TraceFigure, std::less<>> traces; // by the name of the ray set; those it was measured with

    bool is_ours() const { return quality == YardstickQuality::ours; }
};

struct AccelScene
{
    std::string name;
    std::size_t triangles = 0, spheres = 0, instances = 0;
    std::vector<std::pair<std::string, std::size_t>> sets; // of rays: name and number
    std::vector<AccelRow> rows;                            // ours first
};

// Ours over Embree's, above 1 where ours is better; nothing where one of them was not measured.
//  - camera: against the fastest of single rays and packets of the qualities medium and high;
//  - any_hit: shadow and ao, each against the fastest of the same; geometric mean;
//  - incoherent: bounces 1 to 3, each against the faster of medium and high, single rays; geometric mean;
//  - bytes: Embree's medium over ours;
//  - build: see build_ratio().
struct AccelRatios
{
    std::optional<double> camera, any_hit, incoherent, build, bytes, refit, path;
};

// Of the structure `ours`, by one thread's figures or those of all. `build` is of all rows of ours together.
AccelRatios ratios_of(const AccelScene& scene, const AccelRow& ours, bool all_threads = false);

// One set alone, against the Embree rows as above.
std::optional<double> set_ratio(const AccelScene& scene, const AccelRow& ours, std::string_view set,
                                bool all_threads = false);

// The geometric mean of bounces 1 to 3, Mrays/s of one thread: the speed that build times are set against.
std::optional<double> incoherent_speed(const AccelRow& row);

// Build time at equal speed: the geometric mean over Embree's qualities (single rays) of Embree's build time over that
// of the quickest builder of ours whose tree is traced at least as fast. Where none is, what the best of ours reaches:
// the smaller of its ratios in building and in tracing, which is then below 1.
std::optional<double> build_ratio(const AccelScene& scene);

// No Embree row is both built and traced faster than `ours`.
bool is_on_front(const AccelScene& scene, const AccelRow& ours);

// Geometric means over those that have the figure.
AccelRatios mean_ratios(std::span<const AccelRatios> all);

} // namespace snell
