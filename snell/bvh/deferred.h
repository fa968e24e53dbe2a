// A structure that is built, and follows its scene, when somebody asks it: for scenes that a GPU renders, where the
// host traces rays now and then only.
#pragma once

#include "snell/bvh/accel.h"
#include "snell/bvh/inspect.h"

#include <atomic>
#include <mutex>

namespace snell {

// Refers to the scene, which must be as update() says whenever it is asked. `stats` are left to the owner.
class DeferredAccel final : public Accel, public Inspectable
{
  public:
    // info: of a structure with trees of ours.
    DeferredAccel(const PackedScene& scene, const AccelInfo& info, const AccelOptions& options)
        : scene_(scene), info_(info), options_(options)
    {
    }

    // The structure itself, built and up to date.
    const Accel& now() const;
    bool is_built() const { return is_ready_; } // and up to date

    void intersect(std::span<const Ray> rays, std::span<Hit> hits) const override { now().intersect(rays, hits); }
    void intersect_next(std::span<const Ray> rays, std::span<const Hit> after, std::span<Hit> hits) const override
    {
        now().intersect_next(rays, after, hits);
    }
    void occluded(std::span<const Ray> rays, std::span<std::uint8_t> blocked) const override
    {
        now().occluded(rays, blocked);
    }
    void find_blockers(std::span<const Ray> rays, std::span<uint> primitives) const override
    {
        now().find_blockers(rays, primitives);
    }
    void intersect_counted(std::span<const Ray> rays, std::span<Hit> hits, std::span<uint> steps) const override
    {
        now().intersect_counted(rays, hits, steps);
    }
    void update(const PackedChanges& changes) override;

    std::vector<TreeView> trees() const override { return find_trees(now())->trees(); }
    RayWalk walk(const Ray& ray) const override { return find_trees(now())->walk(ray); }

  private:
    const PackedScene& scene_;
    const AccelInfo& info_;
    const AccelOptions options_;
    mutable std::mutex mutex_; // of what follows
    mutable std::unique_ptr<Accel> accel_;
    mutable PackedChanges missed_; // since it was built or followed last
    mutable std::atomic<bool> is_ready_ = false;
};

} // namespace snell
