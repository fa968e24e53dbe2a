// Rough surfaces as in the papers, in double precision: Walter et al. 2007, equations 20, 21, 22 and 33 as printed,
// with Heitz's 2014 height-correlated masking. Slow, and nothing in common with the renderer's code.
#pragma once

#include <glm/glm.hpp>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace snell::test {

inline double reference_d(double cos_m, double alpha)
{
    if (cos_m <= 0) return 0;
    const double c2 = cos_m * cos_m, tan2 = (1 - c2) / c2, a2 = alpha * alpha;
    return a2 / (std::numbers::pi * c2 * c2 * (a2 + tan2) * (a2 + tan2));
}

inline double reference_lambda(double c, double alpha)
{
    const double tan2 = (1 - c * c) / (c * c);
    return 0.5 * (std::sqrt(1 + alpha * alpha * tan2) - 1);
}

inline double reference_fresnel(double c, double ior)
{
    const double g2 = ior * ior - 1 + c * c;
    if (g2 <= 0) return 1;
    const double g = std::sqrt(g2), a = (g - c) / (g + c), b = (c * (g + c) - 1) / (c * (g - c) + 1);
    return 0.5 * a * a * (1 + b * b);
}

// BSDF * |cos wi| of a rough dielectric without tint. eta_o, eta_i: indices on the sides of wo and wi.
inline double reference_dielectric(double alpha, double ior, glm::dvec3 o, glm::dvec3 i)
{
    const double eta_o = o.z > 0 ? 1 : ior, eta_i = i.z > 0 ? 1 : ior;
    const bool reflects = o.z * i.z > 0;
    glm::dvec3 h = reflects ? (o.z > 0 ? 1.0 : -1.0) * (i + o) : -(eta_i * i + eta_o * o);
    h = glm::normalize(h);
    if (h.z < 0) h = -h;
    const double oh = glm::dot(o, h), ih = glm::dot(i, h);
    if (oh * o.z <= 0 || ih * i.z <= 0) return 0;
    const double g = 1 / (1 + reference_lambda(o.z, alpha) + reference_lambda(i.z, alpha));
    const double other = o.z > 0 ? ior : 1 / ior;
    const double fresnel = reference_fresnel(std::abs(oh), other);
    if (reflects) return fresnel * g * reference_d(h.z, alpha) / (4 * std::abs(o.z));
    const double sum = eta_i * ih + eta_o * oh;
    // equation 21 with the roles of radiance: light arrives from i, so the index of the side it leaves to is squared
    return std::abs(oh * ih / o.z) * eta_o * eta_o * (1 - fresnel) * g * reference_d(h.z, alpha) / (sum * sum);
}

// Part of the light that a surface of perfectly reflecting facets returns towards a direction of that cosine, after one
// reflection: the mean of G2 over the facets that it sees.
inline double smith_albedo(double alpha, double z)
{
    constexpr int n = 500;
    const glm::dvec3 wo(std::sqrt(1 - z * z), 0, z);
    double sum = 0;
    for (int i = 0; i < n; ++i)
        for (int j = 0; j < n; ++j) {
            // over facets m, in the variable in which D(m) (m.n) is uniform
            const double s = (i + 0.5) / n, p = 2 * std::numbers::pi * (j + 0.5) / n;
            const double cm = 1 / std::sqrt(1 + alpha * alpha * s / (1 - s)), sm = std::sqrt(1 - cm * cm);
            const glm::dvec3 m(sm * std::cos(p), sm * std::sin(p), cm);
            const double om = glm::dot(wo, m), iz = 2 * om * cm - z;
            if (om <= 0 || iz <= 0) continue;
            const double g2 = 1 / (1 + reference_lambda(z, alpha) + reference_lambda(iz, alpha));
            sum += g2 * om / (z * cm) / (n * n);
        }
    return sum;
}

} // namespace snell::test
