#include "snell/scene/lens.h"

#include "snell/core/error.h"
#include "snell/core/parallel.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>

namespace snell {
namespace {

constexpr uint ring_count = 64;
constexpr uint grid_size = 64; // rays a side of the square in which a ring's pupil is looked for

// A ray near the axis: its height, and its slope times the index of its medium.
struct Paraxial
{
    double y = 0, slope = 0;
};

void refract(Paraxial& ray, double radius, double eta_from, double eta_to)
{
    if (radius != 0) ray.slope -= ray.y * (eta_to - eta_from) / radius;
}

double eta_before(const LensPrescription& lens, std::size_t i)
{
    return i == 0 ? 1.0 : static_cast<double>(lens.surfaces[i - 1].eta);
}

// From the front vertex to behind surface `end` - 1.
Paraxial through(const LensPrescription& lens, Paraxial ray, std::size_t end)
{
    for (std::size_t i = 0; i < end; ++i) {
        const LensSurface& s = lens.surfaces[i];
        const double eta = static_cast<double>(s.eta);
        refract(ray, static_cast<double>(s.radius), eta_before(lens, i), eta);
        if (i + 1 < end) ray.y += static_cast<double>(s.thickness) * ray.slope / eta;
    }
    return ray;
}

// The stop, or what is narrowest if there is none.
std::size_t stop_of(const LensPrescription& lens)
{
    std::size_t narrowest = 0;
    for (std::size_t i = 0; i < lens.surfaces.size(); ++i) {
        const LensSurface& s = lens.surfaces[i];
        if (s.radius == 0.0f && static_cast<double>(s.eta) == eta_before(lens, i)) return i;
        if (s.diameter < lens.surfaces[narrowest].diameter) narrowest = i;
    }
    return narrowest;
}

// The bounds of what a ring of the film sees of the lens: rays from a few of its radii through a grid over the plane of
// the rear vertex. They grow by one cell, for what lies between the rays.
vec4 pupil_bounds(const LensSystem& lens, float inner, float outer, float half)
{
    const float cell = 2.0f * half / static_cast<float>(grid_size);
    vec4 box(half, half, -half, -half);
    for (const float part : {0.0f, 0.5f, 1.0f})
        for (uint y = 0; y < grid_size / 2; ++y) // the lower half mirrors the upper one
            for (uint x = 0; x < grid_size; ++x) {
                const vec2 at((static_cast<float>(x) + 0.5f) * cell - half, (static_cast<float>(y) + 0.5f) * cell);
                if (at.x >= box.x && at.x <= box.z && at.y <= box.w) continue;
                LensRay ray;
                ray.origin = vec3(inner + part * (outer - inner), 0.0f, 0.0f);
                ray.direction = normalize(vec3(at.x, at.y, lens.rear_z) - ray.origin);
                ray.weight = 1.0f;
                if (trace_lens_to_scene(lens, ray).weight == 0.0f) continue;
                box.x = std::min(box.x, at.x), box.z = std::max(box.z, at.x);
                box.w = std::max(box.w, at.y), box.y = -box.w;
            }
    if (box.x > box.z) return vec4(0.0f);
    return {box.x - cell, -box.w - cell, box.z + cell, box.w + cell};
}

// The mean weight of samples in the middle of the film.
double middle_weight(const LensSystem& lens)
{
    constexpr uint side = 256;
    std::array<double, side> rows{};
    parallel_for(side, [&](std::size_t y) {
        for (uint x = 0; x < side; ++x) {
            const vec2 u((static_cast<float>(x) + 0.5f) / side, (static_cast<float>(y) + 0.5f) / side);
            rows[y] += static_cast<double>(sample_lens(lens, vec2(0.0f), u).weight);
        }
    });
    return std::accumulate(rows.begin(), rows.end(), 0.0) / (side * side);
}

} // namespace

double Cardinal::f_number() const
{
    return focal_length / (2 * entrance_radius);
}

Cardinal cardinal(const LensPrescription& lens)
{
    SNELL_CHECK_LT(0u, lens.surfaces.size());
    Cardinal c;
    for (std::size_t i = 0; i + 1 < lens.surfaces.size(); ++i)
        c.length += static_cast<double>(lens.surfaces[i].thickness);
    const Paraxial parallel = through(lens, {1, 0}, lens.surfaces.size());
    const double eta_last = static_cast<double>(lens.surfaces.back().eta);
    c.focal_length = -1 / parallel.slope;
    c.back_focus = -parallel.y * eta_last / parallel.slope;

    // A ray from the front vertex plane meets the middle of the stop: A y + B slope = 0 there.
    const std::size_t stop = stop_of(lens);
    double a = 1, b = 0;
    if (stop > 0) {
        Paraxial first = through(lens, {1, 0}, stop), second = through(lens, {0, 1}, stop);
        const double gap = static_cast<double>(lens.surfaces[stop - 1].thickness) / eta_before(lens, stop);
        a = first.y + gap * first.slope, b = second.y + gap * second.slope;
    }
    c.entrance_pupil = b / a; // it crosses the axis there
    c.entrance_radius = std::abs(0.5 * static_cast<double>(lens.surfaces[stop].diameter) / a);
    return c;
}

float stop_diameter(const LensPrescription& lens)
{
    SNELL_CHECK_LT(0u, lens.surfaces.size());
    return lens.surfaces[stop_of(lens)].diameter;
}

double focused_film_distance(const LensPrescription& lens, double distance)
{
    const Cardinal c = cardinal(lens);
    const double eta = static_cast<double>(lens.surfaces.back().eta);
    const double to_front = distance - c.entrance_pupil; // from the object to the front vertex
    if (!(to_front > 0))
        throw Error(fmt::format("the lens {} cannot be focused at {:g} mm: that is inside it", lens.name, distance),
                    "focus farther away");
    const Paraxial start = std::isfinite(to_front) ? Paraxial{1, 1 / to_front} : Paraxial{1, 0};
    const Paraxial end = through(lens, start, lens.surfaces.size());
    const double film = -end.y * eta / end.slope;
    if (!(film > 0) || !std::isfinite(film) || film > 1e5)
        throw Error(fmt::format("the lens {} makes no sharp picture of what is {:g} mm away", lens.name, distance),
                    "focus farther away");
    return film;
}

LensSystem FocusedLens::view() const
{
    LensSystem s = system;
    s.table.at = table.data();
    return s;
}

FocusedLens focus_lens(const LensPrescription& lens, double distance, double film_diagonal, double stop_diameter,
                       double unit)
{
    SNELL_CHECK_LT(0.0, film_diagonal);
    const Cardinal c = cardinal(lens);
    const double film_distance = focused_film_distance(lens, distance);
    FocusedLens focused;
    focused.name = lens.name;
    double z = film_distance + c.length;
    const std::size_t stop = stop_of(lens);
    for (std::size_t i = 0; i < lens.surfaces.size(); ++i) {
        const LensSurface& s = lens.surfaces[i];
        float aperture = 0.5f * s.diameter;
        if (i == stop && stop_diameter > 0) aperture = std::min(aperture, 0.5f * static_cast<float>(stop_diameter));
        focused.table.emplace_back(static_cast<float>(z), s.radius, s.eta, aperture);
        if (i + 1 < lens.surfaces.size()) z -= static_cast<double>(s.thickness);
    }
    LensSystem& system = focused.system;
    system.interface_count = static_cast<uint>(lens.surfaces.size());
    system.pupil_count = ring_count;
    system.film_radius = 0.5f * static_cast<float>(film_diagonal);
    system.rear_z = static_cast<float>(film_distance);
    system.entrance_z = static_cast<float>(film_distance + c.length - c.entrance_pupil);
    system.gain = 1.0f;
    system.unit = static_cast<float>(unit);

    const float half = 1.05f * 0.5f * lens.surfaces.back().diameter;
    const LensSystem view = focused.view();
    std::vector<vec4> pupils(ring_count);
    parallel_for(ring_count, [&](std::size_t i) {
        const float width = system.film_radius / static_cast<float>(ring_count);
        pupils[i] = pupil_bounds(view, static_cast<float>(i) * width, static_cast<float>(i + 1) * width, half);
    });
    focused.table.insert(focused.table.end(), pupils.begin(), pupils.end());
    const double middle = middle_weight(focused.view());
    if (!(middle > 0))
        throw Error(fmt::format("no light comes through the lens {} to the middle of the film", lens.name),
                    "open its aperture, or mend its prescription");
    system.gain = static_cast<float>(1 / middle);
    return focused;
}

const std::vector<LensPrescription>& known_lenses()
{
    // Tronnier, US patent 2,673,491, and Muller's fisheye, in the numbers of W. J. Smith, Modern Lens Design (1992),
    // pages 312 and 164, scaled to 50 and 15 mm.
    static const std::vector<LensPrescription> all = {
        {"double-gauss",
         {{29.475f, 3.76f, 1.67f, 25.2f},
          {84.83f, 0.12f, 1.0f, 25.2f},
          {19.275f, 4.025f, 1.67f, 23.0f},
          {40.77f, 3.275f, 1.699f, 23.0f},
          {12.75f, 5.705f, 1.0f, 18.0f},
          {0.0f, 4.5f, 1.0f, 17.1f},
          {-14.495f, 1.18f, 1.603f, 17.0f},
          {40.77f, 6.065f, 1.658f, 20.0f},
          {-20.385f, 0.19f, 1.0f, 20.0f},
          {437.065f, 3.22f, 1.717f, 20.0f},
          {-39.73f, 36.114f, 1.0f, 20.0f}}},
        {"fisheye",
         {{45.33735f, 1.25025f, 1.62f, 45.51f},
          {17.08965f, 11.1204f, 1.0f, 31.02f},
          {112.80285f, 1.5981f, 1.639f, 26.7f},
          {12.50235f, 16.73235f, 1.0f, 20.13f},
          {14.3823f, 3.0081f, 1.654f, 13.53f},
          {65.80155f, 8.08425f, 1.0f, 12.21f},
          {0.0f, 2.12445f, 1.0f, 9.12f},
          {44.18115f, 3.2901f, 1.517f, 8.94f},
          {-7.83975f, 1.4571f, 1.805f, 8.76f},
          {-21.4326f, 0.09405f, 1.0f, 8.94f},
          {-33.5589f, 1.41f, 1.673f, 8.94f},
          {-22.5606f, 34.7f, 1.0f, 9.78f}}},
    };
    return all;
}

const LensPrescription* find_lens(const std::string& name)
{
    for (const LensPrescription& lens : known_lenses())
        if (lens.name == name) return &lens;
    return nullptr;
}

} // namespace snell
