#include "snell/scene/keyframes.h"

#include "snell/core/error.h"

#include <algorithm>
#include <cmath>

namespace snell {

vec4 unit_quaternion(vec4 q)
{
    const glm::dvec4 d(q);
    const double size = glm::length(d);
    if (!(size > 1e-12) || !std::isfinite(size)) return {0.0f, 0.0f, 0.0f, 1.0f};
    return vec4(d / size);
}

vec4 slerp(vec4 a, vec4 b, float t)
{
    const glm::dvec4 from(a);
    glm::dvec4 to(b);
    double cosine = glm::dot(from, to);
    if (cosine < 0.0) { // b and -b are the same rotation, one of them half a turn farther
        to = -to;
        cosine = -cosine;
    }
    const double along = static_cast<double>(t);
    // The sine of the angle is too small to divide by: there the chord is as good as the arc.
    constexpr double nearly_parallel = 1.0 - 1e-9;
    if (cosine > nearly_parallel) return unit_quaternion(vec4((1.0 - along) * from + along * to));
    const double angle = std::acos(cosine);
    return unit_quaternion(vec4((std::sin((1.0 - along) * angle) * from + std::sin(along * angle) * to)));
}

Transform compose_trs(vec3 translation, vec4 rotation, vec3 scale)
{
    const glm::dvec4 q(rotation);
    const glm::dvec3 s(scale);
    const double xx = q.x * q.x, yy = q.y * q.y, zz = q.z * q.z, xy = q.x * q.y, xz = q.x * q.z, yz = q.y * q.z;
    const double wx = q.w * q.x, wy = q.w * q.y, wz = q.w * q.z;
    const glm::dvec3 x(1.0 - 2.0 * (yy + zz), 2.0 * (xy - wz), 2.0 * (xz + wy));
    const glm::dvec3 y(2.0 * (xy + wz), 1.0 - 2.0 * (xx + zz), 2.0 * (yz - wx));
    const glm::dvec3 z(2.0 * (xz - wy), 2.0 * (yz + wx), 1.0 - 2.0 * (xx + yy));
    return {vec4(vec3(x * s), translation.x), vec4(vec3(y * s), translation.y), vec4(vec3(z * s), translation.z)};
}

// Where in the list of keys a moment lies: between `first` and first + 1, `part` of the way; or on `first` if last.
namespace {
struct Moment
{
    std::size_t first = 0;
    float part = 0.0f;     // in [0, 1)
    float interval = 0.0f; // seconds; 0: there is no next key to go to
};
} // namespace

static Moment find_moment(const std::vector<float>& times, float seconds)
{
    const auto after = std::upper_bound(times.begin(), times.end(), seconds);
    if (after == times.begin()) return {};
    const auto first = static_cast<std::size_t>(after - times.begin()) - 1;
    if (after == times.end()) return {first, 0.0f, 0.0f};
    const float interval = *after - times[first];
    const float part = (seconds - times[first]) / interval;
    // Times that do not ascend, or are not finite, must not lead beyond the keys.
    if (!(part >= 0.0f && part < 1.0f) || !std::isfinite(interval)) return {first, 0.0f, 0.0f};
    return {first, part, interval};
}

void sample_keys(const AnimationChannel& channel, float seconds, std::span<float> into)
{
    const std::size_t width = into.size();
    const bool cubic = channel.interpolation == Interpolation::cubic;
    SNELL_CHECK_LT(std::size_t{0}, channel.times.size());
    SNELL_CHECK_EQ(channel.values.size(), channel.times.size() * width * (cubic ? 3 : 1));

    const auto set = [&](std::size_t number) { return channel.values.data() + number * width; };
    const Moment at = find_moment(channel.times, seconds);
    const std::size_t last = channel.times.size() - 1;
    const bool between = at.interval > 0.0f && at.first < last;
    if (cubic && between) {
        // A key is three sets: in-tangent, value, out-tangent; tangents are a second's.
        const float* v0 = set(3 * at.first + 1);
        const float* b0 = set(3 * at.first + 2);
        const float* a1 = set(3 * at.first + 3);
        const float* v1 = set(3 * at.first + 4);
        const double t = static_cast<double>(at.part), t2 = t * t, t3 = t2 * t;
        const double h0 = 2 * t3 - 3 * t2 + 1, h1 = 3 * t2 - 2 * t3;
        const double g0 = (t3 - 2 * t2 + t) * static_cast<double>(at.interval);
        const double g1 = (t3 - t2) * static_cast<double>(at.interval);
        for (std::size_t i = 0; i < width; ++i)
            into[i] = static_cast<float>(h0 * static_cast<double>(v0[i]) + g0 * static_cast<double>(b0[i]) +
                                         h1 * static_cast<double>(v1[i]) + g1 * static_cast<double>(a1[i]));
    } else {
        const float* v0 = cubic ? set(3 * at.first + 1) : set(at.first);
        std::copy(v0, v0 + width, into.begin());
        if (channel.interpolation == Interpolation::linear && between) {
            const float* v1 = set(at.first + 1);
            if (channel.property == AnimatedProperty::rotation) {
                const vec4 a = unit_quaternion({v0[0], v0[1], v0[2], v0[3]});
                const vec4 q = slerp(a, unit_quaternion({v1[0], v1[1], v1[2], v1[3]}), at.part);
                for (int i = 0; i < 4; ++i) into[static_cast<std::size_t>(i)] = q[i];
            } else {
                for (std::size_t i = 0; i < width; ++i) into[i] = v0[i] + at.part * (v1[i] - v0[i]);
            }
        }
    }
    if (channel.property == AnimatedProperty::rotation) {
        const vec4 q = unit_quaternion({into[0], into[1], into[2], into[3]});
        for (int i = 0; i < 4; ++i) into[static_cast<std::size_t>(i)] = q[i];
    }
}

} // namespace snell
