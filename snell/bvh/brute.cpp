#include "snell/bvh/brute.h"

#include "snell/bvh/simd/ray_state.h"
#include "snell/core/error.h"
#include "snell/kernel/intersect.h"

namespace snell {
namespace {

class Brute : public Accel
{
  public:
    Brute(const PackedScene& packed, const AccelOptions& options)
        : scene(packed),
          test(options.triangle_test == TriangleTest::moller_trumbore ? test_moller_trumbore : test_watertight)
    {
        stats.leaves = packed.triangles.size() + packed.spheres.size() + packed.planes.size();
        stats.sah_cost = static_cast<double>(stats.leaves);
    }

    void intersect(std::span<const Ray> rays, std::span<Hit> hits) const override
    {
        SNELL_CHECK_EQ(rays.size(), hits.size());
        for (std::size_t i = 0; i < rays.size(); ++i) hits[i] = trace(rays[i]).hit;
    }

    void intersect_next(std::span<const Ray> rays, std::span<const Hit> after, std::span<Hit> hits) const override
    {
        SNELL_CHECK_EQ(rays.size(), hits.size());
        SNELL_CHECK_EQ(rays.size(), after.size());
        for (std::size_t i = 0; i < rays.size(); ++i) {
            Ray ray = rays[i];
            ray.t_min = float_before(after[i].t);
            hits[i] = trace(ray, &after[i]).hit;
        }
    }

    void occluded(std::span<const Ray> rays, std::span<std::uint8_t> blocked) const override
    {
        SNELL_CHECK_EQ(rays.size(), blocked.size());
        for (std::size_t i = 0; i < rays.size(); ++i) blocked[i] = is_hit(trace(rays[i]).hit) ? 1 : 0;
    }

    void intersect_counted(std::span<const Ray> rays, std::span<Hit> hits, std::span<uint> steps) const override
    {
        SNELL_CHECK_EQ(rays.size(), hits.size());
        SNELL_CHECK_EQ(rays.size(), steps.size());
        for (std::size_t i = 0; i < rays.size(); ++i) {
            const Result result = trace(rays[i]);
            hits[i] = result.hit;
            steps[i] = result.steps;
        }
    }

    void update(const PackedChanges&) override {} // it looks at the scene itself

  private:
    struct Result
    {
        Hit hit;
        uint steps;
        const Hit* after; // or nullptr
    };

    const PackedScene& scene;
    const uint test;

    Result trace(const Ray& ray, const Hit* after = nullptr) const
    {
        Result result = {miss(ray.t_max), 0, after};
        if (!is_traceable(ray)) return result;
        const SceneView view = scene.view();
        for (uint i = 0; i < scene.planes.size(); ++i)
            look(view, pack_primitive(kind_plane, i), none, ray, shear_ray(ray), result);
        group(view, scene.world, none, ray, result);
        for (uint i = 0; i < scene.instances.size(); ++i) {
            const Instance& instance = scene.instances[i];
            const Ray local = ray_to_object(ray, instance.to_object);
            if (is_traceable(local)) group(view, scene.groups[instance.group], i, local, result);
        }
        return result;
    }

    void group(const SceneView& view, const PackedGroup& group, uint instance, const Ray& ray, Result& result) const
    {
        const ShearedRay shear = shear_ray(ray);
        for (uint i = 0; i < group.triangle_count; ++i)
            look(view, pack_primitive(kind_triangle, group.first_triangle + i), instance, ray, shear, result);
        for (uint i = 0; i < group.sphere_count; ++i)
            look(view, pack_primitive(kind_sphere, group.first_sphere + i), instance, ray, shear, result);
    }

    void look(const SceneView& view, uint primitive, uint instance, const Ray& ray, const ShearedRay& shear,
              Result& result) const
    {
        ++result.steps;
        Intersection r = intersect_primitive_by(view, primitive, ray, shear, test);
        if (r.ok && result.after != nullptr && !is_later_hit(r.t, primitive, instance, *result.after)) {
            Ray onward = ray; // the far side of a sphere may be
            onward.t_min = r.t;
            r = intersect_primitive_by(view, primitive, onward, shear, test);
        }
        if (r.ok && is_better_hit(r.t, primitive, instance, result.hit))
            result.hit = {r.t, r.u, r.v, primitive, instance};
    }
};

} // namespace

std::unique_ptr<Accel> make_brute(const PackedScene& scene, const AccelOptions& options)
{
    return std::make_unique<Brute>(scene, options);
}

} // namespace snell
