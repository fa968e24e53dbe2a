// Cameras that trace their rays through the glass of a lens (Kolb, Mitchell and Hanrahan 1995, A Realistic Camera Model
// for Computer Graphics). In millimetres: the film lies in z = 0 around the axis, the scene at z > 0.
#ifndef SNELL_KERNEL_LENS_SYSTEM_H
#define SNELL_KERNEL_LENS_SYSTEM_H
#include "snell/kernel/scene_view.h"
SNELL_BEGIN

// A surface of the lens: part of a sphere, or of a plane.
struct LensInterface
{
    float z;        // of its vertex
    float radius;   // of curvature, > 0 if the scene's side is convex; 0: a plane
    float eta;      // index of refraction on the film's side
    float aperture; // half the diameter that lets light pass
};

struct LensSystem
{
    // From `first` on: the interfaces, from the scene to the film, as LensInterface has them. Behind them the pupils:
    // where light from a ring of the film may leave the lens, of rings of equal width from the axis to film_radius.
    // Bounds x0, y0, x1, y1 in the plane of the rearmost vertex, of what film points on the +x axis see.
    Vec4Array table;
    uint first;
    uint interface_count;
    uint pupil_count;
    float film_radius; // half the film's diagonal
    float rear_z;      // of the rearmost vertex
    float entrance_z;  // of the entrance pupil, around which the lens turns without parallax
    float gain;        // makes the mean weight in the middle of the film 1
    float unit;        // a millimetre in the scene's lengths
};
SNELL_LAYOUT(LensSystem, 40)

// For cameras that have none.
SNELL_FN LensSystem no_lens()
{
    LensSystem lens;
    lens.table = SNELL_NO_ARRAY(Vec4Array);
    lens.first = 0u;
    lens.interface_count = 0u;
    lens.pupil_count = 0u;
    lens.film_radius = 0.0f;
    lens.rear_z = 0.0f;
    lens.entrance_z = 0.0f;
    lens.gain = 0.0f;
    lens.unit = 0.0f;
    return lens;
}

SNELL_FN LensInterface lens_interface(SNELL_IN(LensSystem) lens, uint i)
{
    vec4 row = lens.table.at[lens.first + i];
    LensInterface face;
    face.z = row.x;
    face.radius = row.y;
    face.eta = row.z;
    face.aperture = row.w;
    return face;
}

SNELL_FN vec4 lens_pupil(SNELL_IN(LensSystem) lens, uint ring)
{
    return lens.table.at[lens.first + lens.interface_count + ring];
}

// A ray on its way through a lens; direction has unit length.
struct LensRay
{
    vec3 origin;
    float weight; // of the sample, 0: the ray was blocked
    vec3 direction;
};

// Where a ray meets an interface, and how it goes on there by Snell's law into the medium of index eta_to. Weight 0: it
// passes by, outside the aperture, or is totally reflected.
SNELL_FN_COLD LensRay cross_lens_interface(LensRay ray, LensInterface face, float eta_from, float eta_to)
{
    LensRay blocked = ray;
    blocked.weight = 0.0f;
    vec3 o = ray.origin;
    vec3 d = ray.direction;
    float t;
    vec3 normal;
    if (face.radius == 0.0f) {
        if (d.z == 0.0f) return blocked;
        t = (face.z - o.z) / d.z;
        normal = vec3(0.0f, 0.0f, 1.0f);
    } else {
        vec3 from_center = vec3(o.x, o.y, o.z - (face.z - face.radius));
        float b = dot(from_center, d);
        vec3 beside = from_center - b * d; // to the point of the ray that is nearest to the sphere's centre
        float disc = face.radius * face.radius - dot(beside, beside);
        if (disc < 0.0f) return blocked;
        bool nearer = (d.z > 0.0f) == (face.radius < 0.0f); // which half of the sphere is glass
        t = nearer ? -b - sqrt(disc) : -b + sqrt(disc);
        normal = (from_center + t * d) / face.radius;
    }
    if (t < 0.0f) return blocked;
    vec3 p = o + t * d;
    if (p.x * p.x + p.y * p.y > face.aperture * face.aperture) return blocked;
    LensRay onward = ray;
    onward.origin = p;
    if (eta_from == eta_to) return onward;
    if (dot(normal, d) > 0.0f) normal = -normal;
    float eta = eta_from / eta_to;
    float cos_i = -dot(normal, d);
    float sin2_t = eta * eta * (1.0f - cos_i * cos_i);
    if (sin2_t >= 1.0f) return blocked;
    onward.direction = normalize(eta * d + (eta * cos_i - sqrt(1.0f - sin2_t)) * normal);
    return onward;
}

// From the film through the lens into the scene. Weight 0: blocked; else it stays as it is.
SNELL_FN_COLD LensRay trace_lens_to_scene(SNELL_IN(LensSystem) lens, LensRay ray)
{
    LensRay r = ray;
    for (uint i = lens.interface_count; i > 0u; --i) {
        LensInterface face = lens_interface(lens, i - 1u);
        float eta_to = i > 1u ? lens_interface(lens, i - 2u).eta : 1.0f;
        r = cross_lens_interface(r, face, face.eta, eta_to);
        if (r.weight == 0.0f) return r;
    }
    return r;
}

// The other way. The ray ends at the rearmost interface and points to the film.
SNELL_FN_COLD LensRay trace_lens_to_film(SNELL_IN(LensSystem) lens, LensRay ray)
{
    LensRay r = ray;
    float eta_from = 1.0f;
    for (uint i = 0u; i < lens.interface_count; ++i) {
        LensInterface face = lens_interface(lens, i);
        r = cross_lens_interface(r, face, eta_from, face.eta);
        if (r.weight == 0.0f) return r;
        eta_from = face.eta;
    }
    return r;
}

// A sample of the light that reaches a point of the film: towards a uniform point of its ring's pupil, and out into the
// scene. The weight is the irradiance's cos^4 (one cosine for the film, three for the slanted and distant pupil) times
// the pupil's area, so that rays need none of their own; a mean of 1 in the middle of the film.
SNELL_FN_COLD LensRay sample_lens(SNELL_IN(LensSystem) lens, vec2 film, vec2 u)
{
    float r = length(film);
    uint ring = min(uint(r / lens.film_radius * float(lens.pupil_count)), lens.pupil_count - 1u);
    vec4 box = lens_pupil(lens, ring);
    vec2 at = vec2(box.x + u.x * (box.z - box.x), box.y + u.y * (box.w - box.y));
    vec2 axis = r > 0.0f ? film / r : vec2(1.0f, 0.0f); // turns the pupil of the +x axis to the film point
    vec3 target = vec3(axis.x * at.x - axis.y * at.y, axis.y * at.x + axis.x * at.y, lens.rear_z);
    LensRay ray;
    ray.origin = vec3(film.x, film.y, 0.0f);
    ray.direction = normalize(target - ray.origin);
    float cos2 = ray.direction.z * ray.direction.z;
    ray.weight = lens.gain * cos2 * cos2 * (box.z - box.x) * (box.w - box.y);
    if (!(ray.weight > 0.0f)) {
        ray.weight = 0.0f;
        return ray;
    }
    return trace_lens_to_scene(lens, ray);
}

// The ray from the film point (r, 0) through the middle of its pupil, r in [0, film_radius]. The middles of the rings
// are interpolated, so that this changes smoothly with r. Weight 0: blocked.
SNELL_FN_COLD LensRay lens_chief_ray(SNELL_IN(LensSystem) lens, float r)
{
    float place = clamp(r / lens.film_radius * float(lens.pupil_count) - 0.5f, 0.0f, float(lens.pupil_count - 1u));
    uint ring = uint(place);
    uint next = min(ring + 1u, lens.pupil_count - 1u);
    float x0 = 0.5f * (lens_pupil(lens, ring).x + lens_pupil(lens, ring).z);
    float x1 = 0.5f * (lens_pupil(lens, next).x + lens_pupil(lens, next).z);
    LensRay ray;
    ray.origin = vec3(r, 0.0f, 0.0f);
    ray.direction = normalize(vec3(x0 + (place - float(ring)) * (x1 - x0) - r, 0.0f, lens.rear_z));
    ray.weight = 1.0f;
    return trace_lens_to_scene(lens, ray);
}

// The inverse of the chief ray: at which radius of the film a point is seen that lies `aside` of the axis (>= 0), at z.
// -1: not on the film.
SNELL_FN_COLD float lens_film_radius(SNELL_IN(LensSystem) lens, float aside, float z)
{
    float below = 0.0f;
    float above = lens.film_radius;
    for (uint i = 0u; i < 26u; ++i) {
        float r = i == 0u ? lens.film_radius : 0.5f * (below + above);
        LensRay ray = lens_chief_ray(lens, r);
        // The film's right sees the left: the point as this ray sees it.
        float x = -aside - ray.origin.x;
        float too_far = atan(-ray.direction.x, ray.direction.z) - atan(-x, z - ray.origin.z);
        bool inside = ray.weight > 0.0f && too_far < 0.0f; // the point is farther out than the ray
        if (i == 0u) {
            if (inside) return -1.0f;
            continue;
        }
        if (inside)
            below = r;
        else
            above = r;
    }
    // Blocked rays were taken for far ones: the end of the picture is no place where the point is seen.
    LensRay ray = lens_chief_ray(lens, below);
    float x = -aside - ray.origin.x;
    float miss = atan(-ray.direction.x, ray.direction.z) - atan(-x, z - ray.origin.z);
    return ray.weight > 0.0f && abs(miss) < 1e-3f ? 0.5f * (below + above) : -1.0f;
}

SNELL_END
#endif
