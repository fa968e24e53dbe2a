// Where a ray meets a triangle, a sphere or a plane.
//
// Every function takes a ray that is_traceable() and answers with the nearest t in the open interval (t_min, t_max).
// NaN in the geometry is a miss. All of them use plain multiplications and additions in the order written here: the
// SIMD traversal repeats them lane by lane, and so finds bit for bit the same t, u and v.
#ifndef SNELL_KERNEL_INTERSECT_H
#define SNELL_KERNEL_INTERSECT_H
#include "snell/kernel/lang.h"
#include "snell/kernel/ray.h"
#include "snell/kernel/scene_view.h"
SNELL_BEGIN

struct Intersection
{
    float t;    // distance along the ray, in lengths of its direction; t_max of the ray if ok is false
    float u, v; // triangle: barycentric weights of vertices 1 and 2 (vertex 0 has 1 - u - v); else 0
    bool ok;    // false: no hit, the rest has no meaning
};

// Triangle tests by number.
SNELL_CONST uint test_watertight = 0u;
SNELL_CONST uint test_moller_trumbore = 1u;

SNELL_FN Intersection no_intersection(float t_max)
{
    Intersection miss_all;
    miss_all.t = t_max;
    miss_all.u = 0.0f;
    miss_all.v = 0.0f;
    miss_all.ok = false;
    return miss_all;
}

// abs() by clearing the sign bit: what compilers make of abs() may be a branch.
SNELL_FN float magnitude(float x)
{
    return uintBitsToFloat(floatBitsToUint(x) & 0x7fffffffu);
}

// False for rays that hit nothing by definition: a NaN, an infinite origin, a direction of zero or beyond what float
// arithmetic can divide by (largest component outside 2^-100 to 2^100), an empty interval.
SNELL_FN bool is_traceable(Ray ray)
{
    float longest = max(magnitude(ray.direction.x), max(magnitude(ray.direction.y), magnitude(ray.direction.z)));
    bool usable = is_finite3(ray.direction) && longest >= 7.8886090522101181e-31f && longest <= 1.2676506002282294e30f;
    return is_finite3(ray.origin) && usable && ray.t_min < ray.t_max;
}

// A ray made ready for the watertight test: the axis kz along which its direction is longest, the other two, and the
// shear that maps the direction to the unit vector of kz.
struct ShearedRay
{
    int kx, ky, kz;
    float sx, sy, sz;
};

// The axis along which a vector is longest. Which one it is is unpredictable, so there is no branch: three comparisons
// make a number from 0 to 7, and the constant is a table of eight two-bit entries (2 2 2 0 1 2 1 0).
SNELL_FN int longest_axis(vec3 d)
{
    vec3 a = vec3(magnitude(d.x), magnitude(d.y), magnitude(d.z));
    int order = int(a.x >= a.y) + 2 * int(a.x >= a.z) + 4 * int(a.y >= a.z);
    return (0x192a >> (2 * order)) & 3;
}

SNELL_FN ShearedRay shear_ray(Ray ray)
{
    ShearedRay s;
    s.kz = longest_axis(ray.direction);
    s.kx = s.kz == 2 ? 0 : s.kz + 1;
    s.ky = s.kx == 2 ? 0 : s.kx + 1;
    s.sx = ray.direction[s.kx] / ray.direction[s.kz];
    s.sy = ray.direction[s.ky] / ray.direction[s.kz];
    s.sz = 1.0f / ray.direction[s.kz];
    return s;
}

// The rounding error of the product p = a * b: p + product_error(a, b, p) is exact unless it underflows (Dekker 1971, A
// floating-point technique for extending the available precision).
SNELL_FN float product_error(float a, float b, float p)
{
    SNELL_PRECISE float ca = 4097.0f * a;
    SNELL_PRECISE float cb = 4097.0f * b;
    SNELL_PRECISE float a1 = ca - (ca - a);
    SNELL_PRECISE float b1 = cb - (cb - b);
    SNELL_PRECISE float a2 = a - a1;
    SNELL_PRECISE float b2 = b - b1;
    SNELL_PRECISE float e = ((a1 * b1 - p) + a1 * b2 + a2 * b1) + a2 * b2;
    return e;
}

// a * b - c * d with the right sign. Rounding is monotone: if a * b > c * d, then round(a * b) >= round(c * d), and a
// difference of two floats is never rounded across zero or to zero. So the plain expression has the exact sign or is 0,
// and only a 0 needs a closer look.
SNELL_FN float edge_function(float a, float b, float c, float d)
{
    SNELL_PRECISE float p = a * b;
    SNELL_PRECISE float q = c * d;
    SNELL_PRECISE float w = p - q;
    if (w == 0.0f) w = product_error(a, b, p) - product_error(c, d, q);
    return w;
}

// Ray against triangle, from both sides (Woop, Benthin, Wald 2013, Watertight Ray/Triangle Intersection, JCGT 2).
//
// Why it is watertight: the sheared position of a vertex depends on the vertex and the ray alone, so triangles that
// share vertices share them after the shear, bit for bit, and still tile the plane. Whether the ray is inside is then
// decided by edge functions with exact signs, in float alone (the paper repeats them in double where one is 0). Edges
// belong to both triangles. (No fused multiply-add: it would round the two products of an edge differently.)
//   s  shear_ray(ray)
SNELL_FN Intersection intersect_triangle_watertight(Ray ray, ShearedRay s, vec3 v0, vec3 v1, vec3 v2)
{
    vec3 a = v0 - ray.origin;
    vec3 b = v1 - ray.origin;
    vec3 c = v2 - ray.origin;
    float az = a[s.kz];
    float bz = b[s.kz];
    float cz = c[s.kz];
    float ax = a[s.kx] - s.sx * az;
    float ay = a[s.ky] - s.sy * az;
    float bx = b[s.kx] - s.sx * bz;
    float by = b[s.ky] - s.sy * bz;
    float cx = c[s.kx] - s.sx * cz;
    float cy = c[s.ky] - s.sy * cz;

    float w0 = edge_function(cx, by, cy, bx);
    float w1 = edge_function(ax, cy, ay, cx);
    float w2 = edge_function(bx, ay, by, ax);
    Intersection r = no_intersection(ray.t_max);
    if ((w0 < 0.0f || w1 < 0.0f || w2 < 0.0f) && (w0 > 0.0f || w1 > 0.0f || w2 > 0.0f)) return r;
    float det = (w0 + w1) + w2;
    if (det == 0.0f) return r;

    float t = ((w0 * (s.sz * az) + w1 * (s.sz * bz)) + w2 * (s.sz * cz)) / det;
    if (!(t > ray.t_min && t < ray.t_max)) return r;
    r.t = t;
    r.u = w1 / det;
    r.v = w2 / det;
    r.ok = true;
    return r;
}

// Ray against triangle, from both sides (Moeller and Trumbore 1997, Fast, Minimum Storage Ray/Triangle Intersection).
// Not watertight: a ray may slip between two triangles that share an edge.
SNELL_FN Intersection intersect_triangle_moller_trumbore(Ray ray, vec3 v0, vec3 v1, vec3 v2)
{
    vec3 e1 = v1 - v0;
    vec3 e2 = v2 - v0;
    vec3 d = ray.direction;
    vec3 s = ray.origin - v0;
    float px = d.y * e2.z - d.z * e2.y;
    float py = d.z * e2.x - d.x * e2.z;
    float pz = d.x * e2.y - d.y * e2.x;
    float qx = s.y * e1.z - s.z * e1.y;
    float qy = s.z * e1.x - s.x * e1.z;
    float qz = s.x * e1.y - s.y * e1.x;
    float det = (e1.x * px + e1.y * py) + e1.z * pz;
    Intersection r = no_intersection(ray.t_max);
    if (det == 0.0f) return r;

    float u = ((s.x * px + s.y * py) + s.z * pz) / det;
    float v = ((d.x * qx + d.y * qy) + d.z * qz) / det;
    float t = ((e2.x * qx + e2.y * qy) + e2.z * qz) / det;
    if (!(u >= 0.0f && v >= 0.0f && u + v <= 1.0f)) return r;
    if (!(t > ray.t_min && t < ray.t_max)) return r;
    r.t = t;
    r.u = u;
    r.v = v;
    r.ok = true;
    return r;
}

// Ray against sphere: the nearer root in the interval, so also the far side for an origin inside. A tangent ray and a
// sphere of radius 0 are misses. The discriminant comes from the distance between the ray and the centre, and the roots
// from the numerically stable quadratic (Haines, Guenther, Akenine-Moeller 2019, Ray Tracing Gems ch. 7), so that small
// or far spheres keep their shape. The direction may have any length: it is scaled first, for its square must neither
// vanish nor overflow.
SNELL_FN Intersection intersect_sphere(Ray ray, vec3 center, float radius)
{
    float scale = 1.0f / max(magnitude(ray.direction.x), max(magnitude(ray.direction.y), magnitude(ray.direction.z)));
    vec3 d = ray.direction * scale;
    vec3 f = ray.origin - center;
    float a = (d.x * d.x + d.y * d.y) + d.z * d.z;
    float b = -((f.x * d.x + f.y * d.y) + f.z * d.z);
    vec3 nearest = f + (b / a) * d; // from the centre to the point of the ray's line that is nearest to it
    float r2 = radius * radius;
    float discriminant = r2 - ((nearest.x * nearest.x + nearest.y * nearest.y) + nearest.z * nearest.z);
    Intersection r = no_intersection(ray.t_max);
    if (!(discriminant > 0.0f)) return r;

    float root = sqrt(a * discriminant);
    float q = b >= 0.0f ? b + root : b - root;
    float c = ((f.x * f.x + f.y * f.y) + f.z * f.z) - r2;
    float t0 = (c / q) * scale;
    float t1 = (q / a) * scale;
    float first = t0 < t1 ? t0 : t1;
    float second = t0 < t1 ? t1 : t0;
    float t = first > ray.t_min ? first : second;
    if (!(t > ray.t_min && t < ray.t_max)) return r;
    r.t = t;
    r.ok = true;
    return r;
}

// Ray against the plane of points p with dot(normal, p) == offset, from both sides. A ray inside the plane misses it.
SNELL_FN Intersection intersect_plane(Ray ray, vec3 normal, float offset)
{
    float along = (normal.x * ray.direction.x + normal.y * ray.direction.y) + normal.z * ray.direction.z;
    float height = offset - ((normal.x * ray.origin.x + normal.y * ray.origin.y) + normal.z * ray.origin.z);
    Intersection r = no_intersection(ray.t_max);
    if (along == 0.0f) return r;
    float t = height / along;
    if (!(t > ray.t_min && t < ray.t_max)) return r;
    r.t = t;
    r.ok = true;
    return r;
}

// The ray in the space of an instance's group. The direction is not normalised, so that t counts the same.
SNELL_FN Ray ray_to_object(Ray ray, Transform to_object)
{
    Ray local;
    local.origin = transform_point(to_object, ray.origin);
    local.t_min = ray.t_min;
    local.direction = transform_vector(to_object, ray.direction);
    local.t_max = ray.t_max;
    return local;
}

// Any primitive, by number as in Hit::primitive. The ray lies in the primitive's own space (see ray_to_object).
//   s     shear_ray(ray)
//   test  test_watertight or test_moller_trumbore
SNELL_FN_COLD Intersection intersect_primitive_by(SNELL_IN(SceneView) scene, uint primitive, Ray ray, ShearedRay s,
                                                  uint test)
{
    uint index = primitive_index(primitive);
    if (primitive_kind(primitive) == kind_triangle) {
        Triangle tri = scene.triangles.at[index];
        vec3 v0 = scene.positions.at[tri.v0];
        vec3 v1 = scene.positions.at[tri.v1];
        vec3 v2 = scene.positions.at[tri.v2];
        if (test == test_moller_trumbore) return intersect_triangle_moller_trumbore(ray, v0, v1, v2);
        return intersect_triangle_watertight(ray, s, v0, v1, v2);
    }
    if (primitive_kind(primitive) == kind_sphere) {
        Sphere ball = scene.spheres.at[index];
        return intersect_sphere(ray, ball.center, ball.radius);
    }
    if (primitive_kind(primitive) == kind_plane) {
        Plane plane = scene.planes.at[index];
        return intersect_plane(ray, plane.normal, plane.offset);
    }
    return no_intersection(ray.t_max);
}

SNELL_FN_COLD Intersection intersect_primitive(SNELL_IN(SceneView) scene, uint primitive, Ray ray)
{
    return intersect_primitive_by(scene, primitive, ray, shear_ray(ray), test_watertight);
}

// The tie rule of all structures: does a hit of (primitive, instance) at t replace the one found so far? Nearer wins;
// at equal t the smaller primitive, then the smaller instance (none, world space, counts as the largest).
SNELL_FN bool is_better_hit(float t, uint primitive, uint instance, Hit found)
{
    if (t != found.t) return t < found.t;
    if (primitive != found.primitive) return primitive < found.primitive;
    return instance < found.instance;
}

// Whether a hit comes behind another one of the same ray in that order.
SNELL_FN bool is_later_hit(float t, uint primitive, uint instance, Hit earlier)
{
    if (t != earlier.t) return t > earlier.t;
    if (primitive != earlier.primitive) return primitive > earlier.primitive;
    return instance > earlier.instance;
}

SNELL_END
#endif
