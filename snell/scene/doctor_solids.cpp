// Solids of glass that overlap: a ray inside both is in one medium only, so it refracts and absorbs wrongly.
#include "snell/scene/doctor_parts.h"
#include "snell/scene/validate_mesh.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace snell::doctor {

using Severity = Finding::Severity;

// The work is bounded: what goes beyond is said, not done.
static constexpr std::size_t most_solids = std::size_t{1} << 18;
static constexpr std::size_t most_pairs = std::size_t{1} << 22; // of bounding boxes
static constexpr std::size_t most_tests = std::size_t{1} << 28; // of rays with triangles: about a second
static constexpr std::size_t tests_of_a_pair = 1000;            // what looking at a pair costs besides
static constexpr std::size_t points_of_a_mesh = 48, points_of_a_sphere = 26;

namespace {
struct Solid
{
    Bounds bounds; // in the world
    uint mesh = none, sphere = none;
    uint instance = 0;
};

enum class Where
{
    outside,
    inside,
    on // the surface, where rounding decides
};

// How one solid's surface lies to another solid.
struct Relation
{
    std::size_t inside = 0, outside = 0, on = 0;
};

class Examiner
{
  public:
    Examiner(const Scene& scene, const std::vector<MeshFacts>& facts, Findings& findings)
        : scene_(scene), facts_(facts), findings_(findings)
    {
    }
    void run();

  private:
    void gather();
    void compare(const Solid& a, const Solid& b);
    Relation relate(const Solid& a, const Solid& b);
    std::vector<vec3> surface_points(const Solid& solid) const;
    Where locate(vec3 world, const Solid& solid, const Transform& to_object);
    std::string name(const Solid& solid) const;
    void report(const Solid& a, const Solid& b, const char* kind, Severity severity, const char* what);

    const Scene& scene_;
    const std::vector<MeshFacts>& facts_;
    Findings& findings_;
    std::vector<Solid> solids_;
    std::size_t tested_ = 0;
    bool complete_ = true;
};
} // namespace

void Examiner::gather()
{
    // Of each group what is closed glass.
    std::vector<Group> glass(scene_.groups.size());
    for (std::size_t g = 0; g < glass.size(); ++g) {
        for (const Index<Mesh> mesh : scene_.groups[g].meshes)
            if (facts_[mesh.value].has_solid_glass && facts_[mesh.value].glass.is_closed())
                glass[g].meshes.push_back(mesh);
        for (const Index<SphereDesc> sphere : scene_.groups[g].spheres)
            if (is_solid_glass(scene_.materials[scene_.spheres[sphere.value].material.value]))
                glass[g].spheres.push_back(sphere);
    }
    for (std::size_t i = 0; i < scene_.instances.size(); ++i) {
        const InstanceDesc& instance = scene_.instances[i];
        const Group& group = glass[instance.group.value];
        if (solids_.size() + group.meshes.size() + group.spheres.size() > most_solids) {
            complete_ = false;
            return;
        }
        for (const Index<Mesh> mesh : group.meshes)
            solids_.push_back(
                {transformed(facts_[mesh.value].bounds, instance.transform), mesh.value, none, static_cast<uint>(i)});
        for (const Index<SphereDesc> index : group.spheres) {
            const SphereDesc& sphere = scene_.spheres[index.value];
            Bounds bounds;
            bounds.extend(sphere.center - vec3(sphere.radius));
            bounds.extend(sphere.center + vec3(sphere.radius));
            solids_.push_back({transformed(bounds, instance.transform), none, index.value, static_cast<uint>(i)});
        }
    }
}

std::vector<vec3> Examiner::surface_points(const Solid& solid) const
{
    std::vector<vec3> points;
    const Transform& to_world = scene_.instances[solid.instance].transform;
    if (solid.sphere != none) {
        const SphereDesc& sphere = scene_.spheres[solid.sphere];
        for (int x = -1; x <= 1; ++x)
            for (int y = -1; y <= 1; ++y)
                for (int z = -1; z <= 1; ++z)
                    if (x != 0 || y != 0 || z != 0)
                        points.push_back(
                            transform_point(to_world, sphere.center + sphere.radius * normalize(vec3(x, y, z))));
        return points;
    }
    const Mesh& mesh = scene_.meshes[solid.mesh];
    const std::size_t step = mesh.triangles.size() * 3 / points_of_a_mesh + 1;
    for (std::size_t i = 0; i < mesh.triangles.size(); i += step) {
        if (!is_solid_glass(scene_.materials[material_of(mesh, i)])) continue;
        const uvec3 t = mesh.triangles[i];
        const vec3 a = mesh.positions[t.x], b = mesh.positions[t.y], c = mesh.positions[t.z];
        const float ab = length(b - a), bc = length(c - b), ca = length(a - c);
        // Of two crossing bars neither has a corner in the other: the middle of the longest side finds those.
        const vec3 middle = 0.5f * (ab >= bc && ab >= ca ? a + b : bc >= ca ? b + c : c + a);
        for (const vec3 p : {a, middle, (a + b + c) / 3.0f}) points.push_back(transform_point(to_world, p));
    }
    return points;
}

// Along a ray from p, the crossings of a closed surface are odd in number inside it.
Where Examiner::locate(vec3 world, const Solid& solid, const Transform& to_object)
{
    const vec3 local = transform_point(to_object, world);
    if (solid.sphere != none) {
        const SphereDesc& sphere = scene_.spheres[solid.sphere];
        const float d = length(local - sphere.center) / sphere.radius;
        return d < 1.0f - 1e-4f ? Where::inside : d > 1.0f + 1e-4f ? Where::outside : Where::on;
    }
    const Mesh& mesh = scene_.meshes[solid.mesh];
    const bool all = facts_[solid.mesh].is_all_glass;
    const glm::dvec3 origin(local), direction(0.5773, 0.1234567, 0.80712345); // along no likely edge
    const double on = 1e-5 * static_cast<double>(length(facts_[solid.mesh].bounds.extent()));
    std::size_t crossings = 0;
    tested_ += mesh.triangles.size();
    for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
        if (!all && !is_solid_glass(scene_.materials[material_of(mesh, i)])) continue;
        const uvec3 t = mesh.triangles[i];
        const glm::dvec3 a = glm::dvec3(mesh.positions[t.x]) - origin;
        const glm::dvec3 e1 = glm::dvec3(mesh.positions[t.y]) - origin - a;
        const glm::dvec3 e2 = glm::dvec3(mesh.positions[t.z]) - origin - a;
        const glm::dvec3 p = glm::cross(direction, e2);
        const double det = glm::dot(e1, p);
        if (det == 0.0) continue;
        const double u = -glm::dot(a, p) / det;
        if (u < 0.0 || u > 1.0) continue;
        const glm::dvec3 q = glm::cross(-a, e1);
        const double v = glm::dot(direction, q) / det;
        if (v < 0.0 || u + v > 1.0) continue;
        const double distance = glm::dot(e2, q) / det;
        if (std::abs(distance) < on) return Where::on;
        if (distance > 0.0) ++crossings;
    }
    return crossings % 2 == 1 ? Where::inside : Where::outside;
}

// Where points of a's surface lie to b.
Relation Examiner::relate(const Solid& a, const Solid& b)
{
    Relation relation;
    tested_ += tests_of_a_pair / 2;
    const Transform to_object = inverse(scene_.instances[b.instance].transform).value();
    for (const vec3 p : surface_points(a)) {
        const bool is_near = p.x >= b.bounds.lower.x && p.y >= b.bounds.lower.y && p.z >= b.bounds.lower.z &&
                             p.x <= b.bounds.upper.x && p.y <= b.bounds.upper.y && p.z <= b.bounds.upper.z;
        switch (is_near ? locate(p, b, to_object) : Where::outside) {
        case Where::inside:
            ++relation.inside;
            break;
        case Where::outside:
            ++relation.outside;
            break;
        case Where::on:
            ++relation.on;
            break;
        }
        if (relation.inside > 0 && relation.outside > 0) break;
    }
    return relation;
}

std::string Examiner::name(const Solid& solid) const
{
    return solid.mesh != none ? mesh_label(scene_, solid.mesh)
                              : fmt::format("sphere {}", label(scene_.spheres[solid.sphere].name, solid.sphere));
}

void Examiner::report(const Solid& a, const Solid& b, const char* kind, Severity severity, const char* what)
{
    Bounds both;
    both.lower = max(a.bounds.lower, b.bounds.lower);
    both.upper = min(a.bounds.upper, b.bounds.upper);
    const vec3 c = both.center();
    const bool same = a.mesh == b.mesh && a.sphere == b.sphere;
    const std::string who = same ? fmt::format("{} in instances {} and {}", name(a), a.instance, b.instance)
                                 : fmt::format("{} and {}", name(a), name(b));
    findings_.add(kind, severity, fmt::format("{}, around ({:.4g}, {:.4g}, {:.4g}): {}", who, c.x, c.y, c.z, what));
}

void Examiner::compare(const Solid& a, const Solid& b)
{
    const Relation ab = relate(a, b), ba = relate(b, a);
    const bool crosses =
        (ab.inside > 0 && ab.outside > 0) || (ba.inside > 0 && ba.outside > 0) || (ab.inside > 0 && ba.inside > 0);
    const bool coincides = ab.inside + ab.outside == 0 && ba.inside + ba.outside == 0;
    if (crosses || coincides)
        report(a, b, "overlapping-dielectrics", Severity::doubtful,
               "two solids of glass overlap; a ray in both is taken to be in the one that it entered last: cut one "
               "of them to the other's surface");
    else if (ab.inside > 0 || ba.inside > 0)
        report(a, b, "nested-dielectrics", Severity::info,
               "one solid of glass lies inside the other; nested media have no priorities, so what is between the "
               "two may absorb wrongly");
}

void Examiner::run()
{
    gather();
    std::sort(solids_.begin(), solids_.end(), [](const Solid& a, const Solid& b) {
        return a.bounds.lower.x != b.bounds.lower.x ? a.bounds.lower.x < b.bounds.lower.x : a.instance < b.instance;
    });
    std::size_t pairs = 0;
    std::vector<std::size_t> open; // solids that reach the present x
    for (std::size_t i = 0; i < solids_.size() && complete_; ++i) {
        const Bounds& box = solids_[i].bounds;
        std::erase_if(open, [&](std::size_t j) { return solids_[j].bounds.upper.x <= box.lower.x; });
        for (const std::size_t j : open) {
            if (++pairs > most_pairs || tested_ > most_tests) {
                complete_ = false;
                break;
            }
            const vec3 lower = max(box.lower, solids_[j].bounds.lower), upper = min(box.upper, solids_[j].bounds.upper);
            // Bodies that only touch share no volume.
            const vec3 least = 1e-5f * min(box.extent(), solids_[j].bounds.extent());
            const vec3 shared = upper - lower;
            if (shared.x > least.x && shared.y > least.y && shared.z > least.z) compare(solids_[j], solids_[i]);
        }
        open.push_back(i);
        pairs += open.size() / 8; // what keeping the list costs
    }
    if (!complete_)
        findings_.add("partly-examined", Severity::info,
                      fmt::format("there are too many solids of glass to compare each with its neighbours: only some "
                                  "of {} were looked at for overlaps",
                                  amount(solids_.size(), "solid")));
}

void check_solids(const Scene& scene, const std::vector<MeshFacts>& facts, Findings& findings)
{
    Examiner(scene, facts, findings).run();
}

} // namespace snell::doctor
