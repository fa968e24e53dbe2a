#include "snell/bvh/deferred.h"

#include <algorithm>

namespace snell {

const Accel& DeferredAccel::now() const
{
    if (is_ready_) return *accel_;
    const std::lock_guard lock(mutex_);
    if (is_ready_) return *accel_;
    if (!accel_)
        accel_ = info_.make(scene_, options_);
    else
        accel_->update(missed_);
    missed_ = {};
    is_ready_ = true;
    return *accel_;
}

void DeferredAccel::update(const PackedChanges& changes)
{
    if (!changes.any()) return;
    const std::lock_guard lock(mutex_);
    is_ready_ = false;
    missed_.world |= changes.world;
    missed_.instances |= changes.instances;
    std::vector<uint> both;
    std::set_union(missed_.groups.begin(), missed_.groups.end(), changes.groups.begin(), changes.groups.end(),
                   std::back_inserter(both));
    missed_.groups = std::move(both);
}

} // namespace snell
