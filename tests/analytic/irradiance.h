// Irradiance in closed form.
#pragma once

#include <glm/glm.hpp>

#include <cmath>
#include <numbers>
#include <vector>

namespace snell::test {

// The part of a polygon above the plane through the point (Sutherland and Hodgman).
inline std::vector<glm::dvec3> clip_to_horizon(const std::vector<glm::dvec3>& corners, glm::dvec3 point,
                                               glm::dvec3 normal)
{
    std::vector<glm::dvec3> result;
    for (std::size_t i = 0; i < corners.size(); ++i) {
        const glm::dvec3 a = corners[i] - point, b = corners[(i + 1) % corners.size()] - point;
        const double ha = glm::dot(a, normal), hb = glm::dot(b, normal);
        if (ha >= 0) result.push_back(a);
        if ((ha > 0 && hb < 0) || (ha < 0 && hb > 0)) result.push_back(a + (b - a) * (ha / (ha - hb)));
    }
    return result;
}

// Lambert 1760 (Photometria): irradiance at a point with that normal from a polygon of radiance 1 that faces it.
inline double polygon_irradiance(const std::vector<glm::dvec3>& corners, glm::dvec3 point, glm::dvec3 normal)
{
    const std::vector<glm::dvec3> p = clip_to_horizon(corners, point, normal);
    double sum = 0;
    for (std::size_t i = 0; i < p.size(); ++i) {
        const glm::dvec3 a = glm::normalize(p[i]), b = glm::normalize(p[(i + 1) % p.size()]);
        const glm::dvec3 c = glm::cross(a, b);
        const double l = glm::length(c);
        if (l > 0) sum += std::atan2(l, glm::dot(a, b)) * glm::dot(c / l, normal);
    }
    return std::abs(0.5 * sum);
}

// From a sphere of radiance 1, all of it above the horizon.
inline double sphere_irradiance(glm::dvec3 center, double radius, glm::dvec3 point, glm::dvec3 normal)
{
    const glm::dvec3 d = center - point;
    return std::numbers::pi * radius * radius * glm::dot(d, normal) / std::pow(glm::length(d), 3);
}

} // namespace snell::test
