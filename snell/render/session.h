// Interactive rendering: a thread that refines pictures of a scene for as long as nothing changes, begins anew when
// something does, and never makes its caller wait.
#pragma once

#include "snell/io/load.h"
#include "snell/render/governor.h"
#include "snell/render/render.h"
#include "snell/scene/change.h"

#include <functional>
#include <memory>
#include <string>
#include <vector>

namespace snell {

// What one pane of the window shows: all panes look at the same scene through the same camera, each with settings of
// its own (integrator, sampler, accelerator, parameters, seed, spp as the number to stop at; width and height are the
// pane's size in pixels). Settings that agree in what prepare() needs share one Prepared.
struct PaneRequest
{
    RenderSettings settings;
    bool is_rendered = true; // false: the pane shows something else, and costs nothing
    bool operator==(const PaneRequest&) const = default;
};

// A picture of a pane; nothing in it changes once it was handed out.
struct Shot
{
    Film film; // its size is the size it was rendered at, less than asked for while things move. `excess` is left empty
    int width = 0, height = 0;    // asked for
    bool is_data = false;         // values are data, not light: see IntegratorInfo::is_view
    std::uint64_t input = 0;      // the latest request that it answers
    double seconds = 0;           // of rendering that are in it
    uint spp = 0;                 // samples that every pixel has, at least
    RenderStats stats;            // of this picture's rendering
    std::uint64_t generation = 0; // pictures of one generation show the same thing, with ever more samples
    bool finished = false;        // as many samples as asked for
    bool is_preview = false;      // the governor has left something out; not comparable with others of its generation
    // To be seen where this one has no samples yet (Film::sample_count is 0); only while spp is 0. Has samples
    // everywhere.
    std::shared_ptr<const Shot> under;
};
using ShotPtr = std::shared_ptr<const Shot>;

// What queries and edits, which run on the session's thread, get to see.
struct SessionAccess
{
    Scene& scene; // empty before the first was opened. Another one may have come since the request was made
    const std::vector<PaneRequest>& panes;
    const std::vector<const Prepared*>& prepared; // by pane; null: not prepared (no scene yet, or an error)
    const CameraDesc& camera;                     // that the panes show
    std::uint64_t scene_opened;                   // SessionStatus::opened of the scene
};

// What can be shown of a scene before its trees are built: boxes in world space.
struct SceneSketch
{
    std::string name;
    std::uint64_t opened = 0;  // the number of its open()
    Bounds bounds;             // of everything
    std::vector<Bounds> boxes; // of its parts: the first 1000
    CameraDesc camera;
};

struct SessionStatus
{
    enum class Phase
    {
        empty,     // nothing was opened
        loading,   // reading files
        preparing, // packing, building trees
        rendering,
        resting, // every pane has the samples that were asked for, or the session is paused
        failed
    };
    Phase phase = Phase::empty;
    std::string name;       // of the scene
    std::string what;       // now under way: "reading mesh.ply"; of a failure: the error, with its remedy
    double fraction = 0;    // of loading
    bool is_moving = false; // the governor is at work
    GovernorState governor;
    RenderStats stats;                              // of all panes since the scene was opened
    double prepare_seconds = 0, update_seconds = 0; // the last of each
    double copy_seconds = 0;                        // what handing out the last picture has cost
    std::size_t scene_triangles = 0, peak_memory_bytes = 0;
    std::uint64_t scene_version = 0; // counts what changes the scene: opened, edited
    std::uint64_t opened = 0;        // the number of the open() that the scene comes from; 0: none yet
    // Of a scene that was loaded and is being prepared; null at other times.
    std::shared_ptr<const SceneSketch> sketch;
};

class Session
{
  public:
    Session();
    ~Session(); // cancels what is under way and ends the threads, within a tile's time
    Session(const Session&) = delete;
    Session& operator=(const Session&) = delete;

    // All of these return at once, and number the request: a Shot whose `input` is that number or larger answers it.

    // Loads a scene on a thread of its own (load may throw; LoadOptions::progress should call progress(), which throws
    // to cancel loading when another scene is opened or the session ends), validates, completes and prepares it. What
    // was shown goes on being shown, and can be edited, until the new scene is there: SessionStatus::opened is then
    // this request's number. The camera is then its first one. If it fails, the old scene stays and status() says why.
    std::uint64_t open(std::string name, std::function<Scene(const LoadProgressCallback& progress)> load);
    void cancel_open();
    std::uint64_t set_panes(std::vector<PaneRequest> panes); // 1 to 4
    std::uint64_t set_camera(const CameraDesc& camera);
    // Runs between tiles. edit() begins the pictures anew as far as the returned SceneChange bits ask for it; the
    // panes' camera is set_camera()'s alone. Edits wait for the first scene. One that was meant for another scene
    // (which status() had not named as opened when it was posted) is left out.
    std::uint64_t edit(std::function<uint(Scene&)> edit);
    // Runs between tiles, in its turn among the edits, and changes nothing. For probes, inspectors, saving. Results
    // come back by whatever the function captures.
    void query(std::function<void(const SessionAccess&)> query);
    // No picture is refined. What changes is still shown, in its first picture.
    void set_paused(bool paused);
    std::uint64_t restart(); // the same pictures from their first sample

    // Camera and edits are what moves, and for some time after them. Then the governor keeps frame times.
    void set_governor(const GovernorSettings& settings);

    ShotPtr shot(std::size_t pane) const; // the newest; null before the first
    SessionStatus status() const;

  private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

} // namespace snell
