// Do two structures see the same hits?
#pragma once

#include "snell/kernel/ray.h"

#include <cstdint>
#include <functional>
#include <span>
#include <string>

namespace snell {

struct Disagreement
{
    std::size_t count = 0; // of rays
    std::size_t first = 0; // the first of them
    std::string text;      // what each says about that one
};

// Bit for bit: what every structure of snell owes every other. The spans are equally long.
Disagreement compare_hits(std::span<const Ray> rays, std::span<const Hit> expected, std::span<const Hit> found);

// Against a structure with arithmetic of its own: both miss, or both hit at nearly the same distance from the plane of
// the surface that was expected (along the ray a grazing hit moves far for little); which of two surfaces in one place
// is hit does not count. relative: of t. length: further tolerance in scene units. cosine: between a ray and the normal
// of what it hits, from 0 to 1; none: 1.
using CosineAtHit = std::function<double(const Ray& ray, const Hit& hit)>;
Disagreement compare_hits_nearly(std::span<const Ray> rays, std::span<const Hit> expected, std::span<const Hit> found,
                                 double relative, double length, const CosineAtHit& cosine = {});

// 1: blocked, 0: not; anything else is wrong.
Disagreement compare_blocked(std::span<const Ray> rays, std::span<const std::uint8_t> expected,
                             std::span<const std::uint8_t> found);

// So many rays may disagree with a structure that is not watertight or rounds otherwise: rays that graze an edge, and
// slivers, where t has few digits. One in 10,000, and 3 at least.
std::size_t allowed_disagreements(std::size_t rays);

} // namespace snell
