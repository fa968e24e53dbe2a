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
    bool dynamic = false; // for refitting by update(): the quality is then the one that Embree has for that
    bool filter = false;  // intersection filters will be passed in contexts
};

// Geometry 0 of the world are its triangles and geometry 1 its spheres, as far as there are any, with the numbers that
// they have within PackedScene::world; instances have geometry 2 + their number, and in their scenes the same holds of
// their groups. Planes, which have no bounds, are not in it, nor is what reaches beyond 1.8e18, which Embree leaves
// out.
//
// Rays are Embree's: tnear must not be negative, hits lie in (tnear, tfar]. Barycentric coordinates are ours. A
// sphere's nearer point is found first; a filter that refuses it is asked about the farther one.
class EmbreeScene
{
  public:
    // Refers to the scene's triangles and spheres, which must stay where they are; vertices are copied. Throws Error if
    // Embree fails.
    EmbreeScene(const PackedScene& scene, const EmbreeSceneOptions& options = {});
    ~EmbreeScene();
    EmbreeScene(const EmbreeScene&) = delete;
    EmbreeScene& operator=(const EmbreeScene&) = delete;

    // After the scene's vertices, spheres or transforms have changed in place. What was built for it is refitted, all
    // else rebuilt.
    void update(const PackedChanges& changes);

    RTCScene handle() const;
    double build_seconds() const; // of the last build or update, the copies of vertices not counted
    std::size_t bytes() const;    // of Embree's own structures, as its memory monitor counts; no vertices, no indices

  private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

} // namespace snell
