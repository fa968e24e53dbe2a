// What every panel of the viewer is, and what panels share.
#pragma once

#include "snell/render/session.h"
#include "snell/view/document.h"
#include "snell/view/timings.h"

#include <array>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

struct ImDrawList;

namespace snell::view {

struct Pane
{
    PaneRequest request;              // its size in pixels is the window's business
    ShotPtr shot;                     // what is shown now; null: nothing yet
    ShotPtr instead;                  // if set, shown in place of the session's pictures: a reference, a difference
    float x = 0, y = 0, w = 0, h = 0; // where in the window, in ImGui's units
    float clip_x0 = 0, clip_x1 = 0;   // of these, what is seen: all of it, or its side of a divider
    std::string label;                // "path, bvh8": drawn into its corner when there are several
};

// How several panes share the window.
enum class Arrangement
{
    side_by_side, // two, or four in two rows
    divider       // the first two, one on each side of a line that can be dragged
};

// A pixel of a pane, at the pane's full resolution; not set: none.
struct PickedPixel
{
    std::size_t pane = 0;
    int x = 0, y = 0;
};

// What a click into the picture has found: on the first surface that the pixel's central ray meets.
struct PickedPoint
{
    vec3 point{0.0f};
    float distance = 0;
    uint material = none; // of Scene::materials
};

// Shared by all panels; lives in the user interface's thread.
struct ViewState
{
    explicit ViewState(Session& session_of_all) : session(session_of_all) {}

    Session& session;
    // The scene without what is heavy: the same indices, but no vertices, triangles or texels. Kept equal to the
    // session's scene by making every edit in both (see apply() of snell/view/document.h).
    Scene outline;
    Document document;           // edits it, and the session's scene with it
    std::vector<Note> notes;     // what loading and repairing the scene had to say
    std::uint64_t opened = 0;    // SessionStatus::opened that the outline is of; 0: none yet
    Bounds bounds;               // of the scene
    std::string file;            // name of the built-in scene or file
    CameraDesc camera;           // what is shown; write it with look()
    std::vector<Pane> panes;     // at least one
    std::size_t active_pane = 0; // the one that the settings panel changes: clicked last
    Arrangement arrangement = Arrangement::side_by_side;
    float divider = 0.5f;                    // part of the width that is left of it
    std::optional<PickedPixel> picked;       // by a click into the picture
    std::optional<PickedPoint> picked_point; // follows soon after it; none: the sky
    float exposure_ev = 0.0f;
    uint curve = 0;     // tone_*
    bool smooth = true; // pictures smaller than their pane are enlarged bilinearly; else by squares
    bool ui_hidden = false;
    bool is_playing = false; // the animation
    bool is_paused = false;  // no picture is refined; write it with App's key or pause()
    GovernorSettings governor;
    bool is_orbiting = false;                         // left-drag orbits, instead of looking around
    float speed = 1.0f;                               // of flying, in scene units a second
    std::array<std::optional<CameraDesc>, 10> stored; // views 1 to 9; 0 is unused
    bool is_light = false;                            // the style
    float ui_scale = 1.0f;                            // of the style: 2 on a HiDPI display
    std::vector<std::string> recent;                  // scenes, the latest first
    SessionStatus status;
    Timings timings;
    double time = 0; // seconds since the window opened
    // Ask for things to be done after this frame; App fills these in.
    std::function<void(const CameraDesc&)> look;
    std::function<void(const std::string&)> say;   // a message at the window's bottom for some seconds
    std::function<void(std::string)> open;         // a built-in scene or file
    std::function<void(const std::string&)> press; // a key, by its name in the table of keys: "F12"
    std::function<void()> wake;                    // draw another frame soon: something moves
};

// A window of controls. It is drawn in each frame while it is open. Every control has a tooltip (tip() in widgets.h).
class Panel
{
  public:
    virtual ~Panel() = default;
    virtual const char* name() const = 0; // title, and its name for scripts; unique
    virtual const char* help() const = 0; // one sentence: what it is for, with the textbook's term
    virtual bool opens_at_start() const { return false; }
    virtual bool floats_at_start() const { return false; } // a window of its own, instead of a place in the column
    virtual void draw(ViewState& state) = 0;               // inside its ImGui window
    // Called once a frame for every panel, open or not, before anything is drawn: for what arrives by itself.
    virtual void update(ViewState&) {}
    // Over the picture of a pane, also while the panel's window is closed only if it says so itself.
    virtual void draw_over(ViewState&, const Pane&, ImDrawList&) {}
    // A click into a picture that moved nothing. True: taken.
    virtual bool click(ViewState&, const PickedPixel&) { return false; }
    // For scripts: `set NAME VALUE`, and `assert NAME ...`. False, nothing: this panel has no such name. set() throws
    // Error for a value that makes no sense.
    virtual bool set(ViewState&, const std::string& /*name*/, const std::string& /*value*/) { return false; }
    virtual std::optional<std::string> get(ViewState&, const std::string& /*name*/) { return std::nullopt; }

    bool is_open = false, is_floating = false; // App's
};

// Each panel is one file of snell/view/panels/ with one function make_NAME_panel(), listed in panels.cpp.
std::vector<std::unique_ptr<Panel>> make_panels();

} // namespace snell::view
