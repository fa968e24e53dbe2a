// Rendering a scene.
#pragma once

#include "snell/render/device.h"
#include "snell/render/film.h"
#include "snell/render/settings.h"
#include "snell/scene/repose.h"

#include <atomic>
#include <functional>
#include <memory>

namespace snell {

// Counted over the whole render.
struct RenderStats
{
    std::uint64_t camera_rays = 0, extension_rays = 0, shadow_rays = 0;
    std::uint64_t samples = 0;
    double load_seconds = 0, pack_seconds = 0, build_seconds = 0, render_seconds = 0; // load: filled by the caller
    bool updated = false; // packing and building only followed what moved
    std::size_t refitted_trees = 0, rebuilt_trees = 0;
    // Thread time by stage, summed over threads.
    double generate_seconds = 0, extend_seconds = 0, shade_seconds = 0, connect_seconds = 0, finalize_seconds = 0;
    std::size_t scene_bytes = 0, accel_bytes = 0;
    bool cancelled = false;

    std::uint64_t rays() const { return camera_rays + extension_rays + shadow_rays; }
};

struct Progress
{
    double fraction = 0; // of all samples
    uint spp_done = 0;   // samples a pixel finished
    RenderStats stats;   // so far
};

// Called a few times a second, from one thread at a time.
using ProgressCallback = std::function<void(const Progress&)>;

struct RenderResult
{
    Film film;
    RenderStats stats;
    std::string lost; // why the device gave up before the end (stats.cancelled is true then); empty: it did not
};

// Everything that is derived from a scene and can be used for several renders: packed arrays and acceleration
// structure.
struct Prepared
{
    PackedScene packed;
    std::unique_ptr<Accel> accel;
    std::unique_ptr<DeviceScene> device; // what a GPU has of them; null: the CPU renders
    CameraDesc camera;
    double pack_seconds = 0, build_seconds = 0; // of the last prepare() or update()
    bool updated = false;                       // the last was an update() that did not have to pack and build anew
    std::size_t builds = 1;                     // how often everything was packed and built
    PackedChanges changes;                      // that the last update() followed
    std::unique_ptr<MotionMap> motion;          // with RenderSettings::keep_motion
    RenderSettings settings;                    // that prepare() was called with

    // Follows the scene, from prepare() with keep_motion, which has changed since then or since the last update():
    // `changes` are SceneChange bits that say in what. What did not change is not touched. Every picture is then what
    // it would be had the scene been prepared as it is now, bit for bit (but for the steps of rays through trees that
    // were refitted). Nobody may render meanwhile. Throws Error as prepare() does; nothing can then be rendered until
    // an update(), with whatever bits, succeeds.
    void update(const Scene& scene, uint changes = change_pose);

  private:
    bool is_usable_ = true; // false: an update() has failed halfway
    void build(const Scene& scene);
    friend std::unique_ptr<Prepared> prepare(const Scene& scene, const RenderSettings& settings);
};

// The scene must be valid and complete. Throws Error for unknown names.
std::unique_ptr<Prepared> prepare(const Scene& scene, const RenderSettings& settings);

// Renders on the device that the scene was prepared for. If `cancel` becomes true, returns soon with what there is
// (sample counts may then differ between pixels); if the device is lost, with what it had given, and throws DeviceLost
// only if that is nothing. The film is a function of scene, settings and device only: threads and tiles do not change a
// bit.
RenderResult render(const Prepared& prepared, const RenderSettings& settings, const ProgressCallback& progress = {},
                    const std::atomic<bool>* cancel = nullptr);

// prepare and render in one.
RenderResult render(const Scene& scene, const RenderSettings& settings);

} // namespace snell
