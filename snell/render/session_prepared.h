// What the panes of a session have prepared: one Prepared for all panes whose settings ask for the same.
#pragma once

#include "snell/render/render.h"

#include <memory>
#include <vector>

namespace snell {

// Whether prepare() would make the same of a scene.
bool same_preparation(const RenderSettings& a, const RenderSettings& b);

class PreparedSet
{
  public:
    // Null: there is none yet.
    const Prepared* find(const RenderSettings& settings) const;
    // Prepares the scene if nobody has yet. Throws as prepare() does.
    const Prepared* get(const Scene& scene, const RenderSettings& settings);
    // Follows what has changed: a mask of SceneChange bits. Only what they ask for is done anew. What cannot follow is
    // dropped, and get() will throw the reason.
    void follow(const Scene& scene, uint changes);
    // Drops what none of these needs.
    void keep_for(const std::vector<RenderSettings>& settings);
    bool empty() const { return entries_.empty(); }

    double prepare_seconds = 0, update_seconds = 0; // of the last of each

  private:
    struct Entry
    {
        RenderSettings settings;
        std::unique_ptr<Prepared> prepared;
    };
    std::vector<Entry> entries_;
};

} // namespace snell
