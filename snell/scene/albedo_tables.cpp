#include "snell/scene/albedo_tables.h"

#include "snell/core/parallel.h"
#include "snell/kernel/albedo.h"
#include "snell/kernel/fresnel.h"
#include "snell/kernel/ggx_anisotropic.h"
#include "snell/kernel/iridescence.h"
#include "snell/kernel/microfacet.h"
#include "snell/kernel/principled_point.h"
#include "snell/kernel/sheen.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <memory>
#include <mutex>
#include <utility>

namespace snell {
namespace {

constexpr std::size_t max_glass_iors = 16; // of one scene
constexpr std::size_t max_kept_iors = 64;  // of the process
constexpr float smallest_alpha = 1e-4f;    // stands for 0 in the first row
constexpr float smallest_cosine = 1e-3f;   // and in the first column

// A Fibonacci lattice on the unit square: few points do, because integrands here have kinks but no noise. The first
// coordinate is bent so that square roots at both ends of the interval do no harm.
struct LatticePoint
{
    vec2 u;
    double weight; // they sum to 1
};

std::vector<LatticePoint> lattice(int count, int step)
{
    std::vector<LatticePoint> points;
    for (int i = 0; i < count; ++i) {
        const double q = (i + 0.5) / count;
        const double turn = std::fmod((static_cast<double>(i) * step + 0.25) / count, 1.0);
        points.push_back(
            {vec2(static_cast<float>(q * q * (3 - 2 * q)), static_cast<float>(turn)), 6 * q * (1 - q) / count});
    }
    return points;
}

// Quadrature is done at every third node of a table in each direction; between them a cubic goes through four. So the
// kernels can do with bilinear look-ups.
constexpr uint refinement = 3;
constexpr uint coarse_columns = (albedo_columns - 1) / refinement + 1, coarse_rows = (albedo_rows - 1) / refinement + 1;
constexpr uint coarse_length = coarse_columns * coarse_rows;
static_assert((coarse_columns - 1) * refinement + 1 == albedo_columns, "no whole number of steps");
static_assert((coarse_rows - 1) * refinement + 1 == albedo_rows, "no whole number of steps");

// Catmull and Rom's curve through `count` values that lie `stride` apart, at node i of the refined ones; beyond the
// ends it goes on straight.
float refined(const float* values, uint count, uint stride, uint i)
{
    const uint k = std::min(i / refinement, count - 2);
    const float x = static_cast<float>(i - k * refinement) / static_cast<float>(refinement);
    const float a = values[k * stride], b = values[(k + 1) * stride];
    const float before = k > 0 ? values[(k - 1) * stride] : 2.0f * a - b;
    const float after = k + 2 < count ? values[(k + 2) * stride] : 2.0f * b - a;
    const float slope_a = 0.5f * (b - before), slope_b = 0.5f * (after - a), d = b - a;
    return a + x * (slope_a + x * (3.0f * d - 2.0f * slope_a - slope_b + x * (slope_a + slope_b - 2.0f * d)));
}

void refine(const std::vector<float>& coarse, float* table)
{
    std::vector<float> wide(albedo_columns * coarse_rows);
    for (uint r = 0; r < coarse_rows; ++r)
        for (uint c = 0; c < albedo_columns; ++c)
            wide[r * albedo_columns + c] = refined(&coarse[r * coarse_columns], coarse_columns, 1, c);
    for (uint r = 0; r < albedo_rows; ++r)
        for (uint c = 0; c < albedo_columns; ++c)
            table[r * albedo_columns + c] = refined(&wide[c], coarse_rows, albedo_columns, r);
}

// The square of the i-th of n equally spaced numbers from 0 to 1.
float node(std::size_t i, uint n)
{
    return sqr(static_cast<float>(i) / static_cast<float>(n - 1));
}

struct Node
{
    vec3 wo;
    float alpha;
};

// The node of number i of a coarse table.
Node node_of(std::size_t i)
{
    const float c = std::max(node(i % coarse_columns, coarse_columns), smallest_cosine);
    return {vec3(safe_sqrt(1.0f - c * c), 0.0f, c), std::max(node(i / coarse_columns, coarse_rows), smallest_alpha)};
}

// G2 / G1: the part of what comes from visible facets that leaves in a direction with that |z|.
double leaves(float lambda_o, float z, float alpha)
{
    return static_cast<double>((1.0f + lambda_o) / (1.0f + lambda_o + ggx_lambda(z, alpha)));
}

// albedo_ggx and albedo_ggx_edge.
vec2 ggx_entry(const std::vector<LatticePoint>& points, const Node& at)
{
    const float lambda = ggx_lambda(at.wo.z, at.alpha);
    double whole = 0, edge = 0;
    for (const LatticePoint& p : points) {
        const vec3 h = sample_ggx_visible(at.wo, at.alpha, p.u);
        const float cos_h = dot(at.wo, h);
        const float z = 2.0f * cos_h * h.z - at.wo.z;
        if (z <= 0.0f) continue;
        const double g = p.weight * leaves(lambda, z, at.alpha);
        whole += g;
        edge += g * static_cast<double>(schlick_weight(cos_h));
    }
    return {static_cast<float>(whole), static_cast<float>(std::pow(edge / whole, 0.2))};
}

// Of rough glass with wo on one side: what F reflects and 1 - F refracts, and what F reflects less what it takes from
// refraction.
struct GlassSums
{
    double both = 0, edge = 0;

    // A facet h; eta: transmitted side over wo's side; reflected: the part of what it reflects that leaves.
    void add(const Node& at, vec3 h, float eta, double reflected, float lambda, double weight)
    {
        const float cos_h = dot(at.wo, h);
        const DielectricSplit split = split_dielectric(cos_h, eta);
        const double f = static_cast<double>(glass_edge(split));
        double refracted = 0;
        if (split.reflectance < 1.0f) {
            const float z = (cos_h / eta - split.cos_t) * h.z - at.wo.z / eta;
            if (z < 0.0f) refracted = leaves(lambda, z, at.alpha);
        }
        edge += weight * f * (reflected - refracted);
        both += weight * (f * reflected + (1 - f) * refracted);
    }
};

// The entries of the three tables, for a denser over thinner index > 1.
vec3 glass_entry(const std::vector<LatticePoint>& points, const Node& at, float ior)
{
    const float lambda = ggx_lambda(at.wo.z, at.alpha);
    GlassSums thin, dense;
    for (const LatticePoint& p : points) {
        const vec3 h = sample_ggx_visible(at.wo, at.alpha, p.u);
        const float z = 2.0f * dot(at.wo, h) * h.z - at.wo.z;
        const double reflected = z > 0.0f ? leaves(lambda, z, at.alpha) : 0.0;
        thin.add(at, h, ior, reflected, lambda, p.weight);
        dense.add(at, h, 1.0f / ior, reflected, lambda, p.weight);
    }
    return vec3(thin.both, thin.edge, dense.both);
}

float sheen_entry(const std::vector<LatticePoint>& points, const Node& at)
{
    double sum = 0;
    for (const LatticePoint& p : points) {
        const vec2 side = unit_circle(p.u.y);
        const float z = p.u.x, r = safe_sqrt(1.0f - z * z);
        sum += p.weight * static_cast<double>(eval_sheen(at.alpha, at.wo, vec3(r * side.x, r * side.y, z)));
    }
    return static_cast<float>(std::log(std::max(sum * 2.0 * static_cast<double>(pi), 1e-20)));
}

// Albedos x and y as ggx_entry's, but y not yet over x.
vec2 anisotropic_entry(const std::vector<LatticePoint>& points, vec3 wo, vec2 alphas)
{
    const float lambda = anisotropic_lambda(wo, alphas);
    double whole = 0, edge = 0;
    for (const LatticePoint& p : points) {
        const vec3 h = sample_anisotropic_visible(wo, alphas, p.u);
        const float cos_h = dot(wo, h);
        const vec3 wi = 2.0f * cos_h * h - wo;
        if (wi.z <= 0.0f) continue;
        const float g = (1.0f + lambda) / (1.0f + lambda + anisotropic_lambda(wi, alphas));
        whole += p.weight * static_cast<double>(g);
        edge += p.weight * static_cast<double>(g * schlick_weight(cos_h));
    }
    return {static_cast<float>(whole), static_cast<float>(edge)};
}

// The two anisotropic tables, one after the other; the isotropic ones are done.
std::vector<float> anisotropic_tables(const std::vector<float>& common)
{
    const std::vector<LatticePoint> points = lattice(377, 233);
    const FloatArray isotropic{common.data()};
    std::vector<float> values(2 * anisotropic_length);
    parallel_for(anisotropic_length, [&](std::size_t i) {
        std::size_t rest = i;
        const auto next = [&](uint n) { return std::exchange(rest, rest / n) % n; };
        const float c = std::max(node(next(anisotropic_cosines), anisotropic_cosines), smallest_cosine);
        const float turn = static_cast<float>(next(anisotropic_turns)) / static_cast<float>(anisotropic_turns - 1);
        const float across = node(next(anisotropic_alphas), anisotropic_alphas);
        const float strength =
            static_cast<float>(next(anisotropic_strengths)) / static_cast<float>(anisotropic_strengths - 1);
        const vec2 alphas = max(principled_alphas(across, strength), vec2(smallest_alpha));
        // the azimuth along which the roughness is so far between the two
        const float seen = alphas.y + (alphas.x - alphas.y) * turn;
        const float x2 = alphas.x > alphas.y ? (sqr(seen) - sqr(alphas.y)) / (sqr(alphas.x) - sqr(alphas.y)) : turn;
        const float r = safe_sqrt(1.0f - c * c), mean = 0.5f * (alphas.x + alphas.y);
        const vec2 e = anisotropic_entry(points, vec3(r * safe_sqrt(x2), r * safe_sqrt(1.0f - x2), c), alphas);
        values[i] = e.x / look_up_rough_albedo(isotropic, albedo_ggx, c, mean);
        values[anisotropic_length + i] =
            std::pow(e.y / e.x, 0.2f) - look_up_rough_albedo(isotropic, albedo_ggx_edge, c, mean);
    });
    return values;
}

std::vector<float> common_tables()
{
    const std::vector<LatticePoint> points = lattice(610, 377);
    std::vector<float> whole(coarse_length), edge(coarse_length), sheen(coarse_length);
    parallel_for(coarse_length, [&](std::size_t i) {
        Node at = node_of(i);
        const vec2 ggx = ggx_entry(points, at);
        whole[i] = ggx.x;
        edge[i] = ggx.y;
        at.alpha =
            std::pow(sheen_alpha_min, static_cast<float>(i / coarse_columns) / static_cast<float>(coarse_rows - 1));
        sheen[i] = sheen_entry(points, at);
    });
    std::vector<float> values(albedo_length);
    refine(whole, &values[albedo_ggx]);
    refine(edge, &values[albedo_ggx_edge]);
    refine(sheen, &values[albedo_sheen]);
    std::fill_n(values.begin() + albedo_anisotropic, anisotropic_length, 1.0f);
    return values;
}

std::vector<float> glass_tables(float ior)
{
    // the edge of total reflection needs many points, but only a rough surface sees it everywhere
    const std::vector<LatticePoint> few = lattice(610, 377), many = lattice(2584, 1597);
    std::vector<float> thin(coarse_length), thin_edge(coarse_length), dense(coarse_length);
    parallel_for(coarse_length, [&](std::size_t i) {
        const Node at = node_of(i);
        const vec3 entry = glass_entry(at.alpha < 0.05f ? few : many, at, std::max(ior, 1.0f / ior));
        thin[i] = entry.x;
        thin_edge[i] = entry.y;
        dense[i] = entry.z;
    });
    std::vector<float> values(glass_tables_length);
    refine(thin, &values[glass_thin_side]);
    refine(thin_edge, &values[glass_thin_side_edge]);
    refine(dense, &values[glass_dense_side]);
    return values;
}

using Shared = std::shared_ptr<const std::vector<float>>;

// The tables of that ior, from an earlier call where there was one.
Shared kept_glass_tables(float ior)
{
    static std::mutex mutex;
    static std::map<float, Shared> kept;
    {
        const std::lock_guard lock(mutex);
        if (const auto found = kept.find(ior); found != kept.end()) return found->second;
    }
    const Shared made = std::make_shared<const std::vector<float>>(glass_tables(ior));
    const std::lock_guard lock(mutex);
    if (kept.size() >= max_kept_iors) kept.clear();
    kept[ior] = made;
    return made;
}

bool has_table(float ior)
{
    return ior >= 0.05f && ior <= 20.0f; // false for NaN
}

} // namespace

AlbedoTables albedo_tables(std::span<const float> iors, bool anisotropic)
{
    static const std::vector<float> common = common_tables();
    AlbedoTables result;
    result.values = common;
    if (anisotropic) {
        static const std::vector<float> table = anisotropic_tables(common);
        std::copy(table.begin(), table.end(), result.values.begin() + albedo_anisotropic);
    }

    std::vector<float> wanted;
    std::copy_if(iors.begin(), iors.end(), std::back_inserter(wanted), has_table);
    std::sort(wanted.begin(), wanted.end());
    wanted.erase(std::unique(wanted.begin(), wanted.end()), wanted.end());
    if (wanted.size() > max_glass_iors) {
        std::vector<float> some;
        for (std::size_t i = 0; i < max_glass_iors; ++i)
            some.push_back(wanted[i * (wanted.size() - 1) / (max_glass_iors - 1)]);
        wanted = some;
    }
    for (const float ior : wanted) {
        const Shared tables = kept_glass_tables(ior);
        result.values.insert(result.values.end(), tables->begin(), tables->end());
    }
    for (const float ior : iors) {
        if (!has_table(ior)) {
            result.glass_table.push_back(none);
            continue;
        }
        const auto above = std::lower_bound(wanted.begin(), wanted.end(), ior);
        std::size_t nearest = static_cast<std::size_t>(above - wanted.begin());
        if (above == wanted.end() || (above != wanted.begin() && ior - *(above - 1) < *above - ior)) --nearest;
        result.glass_table.push_back(albedo_length + static_cast<uint>(nearest) * glass_tables_length);
    }
    return result;
}

} // namespace snell
