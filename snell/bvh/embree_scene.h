// A PackedScene inside Embree; only where it is installed (SNELL_HAS_EMBREE).
#pragma once

#include "snell/scene/packed.h"

#include <embree3/rtcore.h>

#include <memory>

namespace snell {

enum class EmbreeQuality
{
    low,    // Morton codes
    medium, // binned SAH, its default
    high    // spatial splits
};

struct EmbreeSceneOptions
{
    EmbreeQuality quality = EmbreeQuality::medium;
    bool robust = false;  // its watertight mode; its default is the faster one
    bool dynamic = false; // built for refitting by update()
    bool filter = false;  // intersection filters will be passed in contexts
};

// Geometry 0 of the world are its triangles and geometry 1 its spheres, as far as there are any, with the numbers that
// they have within PackedScene::world; instances have geometry 2 + their number, and in their scenes the same holds of
// their groups. Planes, which have no bounds, are not in it.
class EmbreeScene
{
  public:
    EmbreeScene(const PackedScene& scene, const EmbreeSceneOptions& options = {}); // throws Error if Embree fails
    ~EmbreeScene();
    EmbreeScene(const EmbreeScene&) = delete;
    EmbreeScene& operator=(const EmbreeScene&) = delete;

    // After the scene's vertices or transforms have changed in place.
    void update(const PackedChanges& changes);

    RTCScene handle() const;
    double build_seconds() const; // of the last build or update, buffers' copies not counted
    std::size_t bytes() const;    // that Embree holds, as its memory monitor counts

  private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

} // namespace snell
