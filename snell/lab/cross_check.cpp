#include "snell/lab/cross_check.h"

#include "snell/core/error.h"

#include <algorithm>
#include <bit>
#include <cmath>

namespace snell {

static std::string ray_in_words(const Ray& ray)
{
    return fmt::format("origin {:.9g} {:.9g} {:.9g}, direction {:.9g} {:.9g} {:.9g}, t from {:.9g} to {:.9g}",
                       ray.origin.x, ray.origin.y, ray.origin.z, ray.direction.x, ray.direction.y, ray.direction.z,
                       ray.t_min, ray.t_max);
}

static std::string hit_in_words(const Hit& hit)
{
    if (!is_hit(hit)) return "nothing";
    static constexpr const char* kinds[] = {"triangle", "sphere", "plane", "primitive"};
    std::string words = fmt::format("{} {} at t {:.9g} u {:.9g} v {:.9g}", kinds[primitive_kind(hit.primitive)],
                                    primitive_index(hit.primitive), hit.t, hit.u, hit.v);
    if (hit.instance != none) words += fmt::format(" of instance {}", hit.instance);
    return words;
}

// differ(i): whether the answers to ray i do; words(i): what they are.
template <class Differ, class Words>
static Disagreement compare(std::span<const Ray> rays, const Differ& differ, const Words& words)
{
    Disagreement result;
    for (std::size_t i = 0; i < rays.size(); ++i) {
        if (!differ(i)) continue;
        if (result.count++ > 0) continue;
        result.first = i;
        result.text = fmt::format("ray {} ({}): {}", i, ray_in_words(rays[i]), words(i));
    }
    return result;
}

static void check_sizes(std::size_t rays, std::size_t expected, std::size_t found)
{
    SNELL_CHECK_EQ(rays, expected);
    SNELL_CHECK_EQ(rays, found);
}

Disagreement compare_hits(std::span<const Ray> rays, std::span<const Hit> expected, std::span<const Hit> found)
{
    check_sizes(rays.size(), expected.size(), found.size());
    const auto same_bits = [](float a, float b) { return std::bit_cast<uint>(a) == std::bit_cast<uint>(b); };
    return compare(
        rays,
        [&](std::size_t i) {
            const Hit &a = expected[i], &b = found[i];
            return a.primitive != b.primitive || a.instance != b.instance || !same_bits(a.t, b.t) ||
                   !same_bits(a.u, b.u) || !same_bits(a.v, b.v);
        },
        [&](std::size_t i) {
            return fmt::format("{} expected, {} found", hit_in_words(expected[i]), hit_in_words(found[i]));
        });
}

Disagreement compare_hits_nearly(std::span<const Ray> rays, std::span<const Hit> expected, std::span<const Hit> found,
                                 double relative, double length, const CosineAtHit& cosine)
{
    check_sizes(rays.size(), expected.size(), found.size());
    return compare(
        rays,
        [&](std::size_t i) {
            const Hit &a = expected[i], &b = found[i];
            if (is_hit(a) != is_hit(b)) return true;
            if (!is_hit(a)) return false;
            const double speed = static_cast<double>(snell::length(rays[i].direction));
            const double t = std::max(std::abs(double(a.t)), std::abs(double(b.t)));
            const double apart = std::abs(double(a.t) - double(b.t)), allowed = relative * t + length / speed;
            if (apart <= allowed) return false;
            return !(cosine && apart * cosine(rays[i], a) <= allowed);
        },
        [&](std::size_t i) {
            return fmt::format("{} expected, {} found", hit_in_words(expected[i]), hit_in_words(found[i]));
        });
}

Disagreement compare_blocked(std::span<const Ray> rays, std::span<const std::uint8_t> expected,
                             std::span<const std::uint8_t> found)
{
    check_sizes(rays.size(), expected.size(), found.size());
    const auto word = [](std::uint8_t blocked) {
        return blocked == 1 ? "something" : blocked == 0 ? "nothing" : "no answer";
    };
    return compare(
        rays, [&](std::size_t i) { return expected[i] != found[i] || found[i] > 1; },
        [&](std::size_t i) { return fmt::format("{} expected, {} found", word(expected[i]), word(found[i])); });
}

std::size_t allowed_disagreements(std::size_t rays)
{
    return std::max(std::size_t{3}, static_cast<std::size_t>(1e-4 * static_cast<double>(rays)));
}

} // namespace snell
