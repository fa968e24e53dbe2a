// What every panel of the viewer is, and what panels share.
#pragma once

#include "snell/render/session.h"

#include <array>
#include <memory>
#include <string>
#include <vector>

struct ImDrawList;

namespace snell::view {

struct Pane
{
    PaneRequest request;
    ShotPtr shot;                     // what is shown now; null: nothing yet
    float x = 0, y = 0, w = 0, h = 0; // where in the window, in ImGui's units
    std::string label;                // "path, bvh8": drawn into its corner when there are several
};

// A pixel of a pane, at the pane's full resolution; not set: none.
struct PickedPixel
{
    std::size_t pane = 0;
    int x = 0, y = 0;
};

// Shared by all panels; lives in the user interface's thread.
struct ViewState
{
    Session& session;
    // The scene without what is heavy: the same indices, but no vertices, triangles or texels. Kept equal to the
    // session's scene by making every edit in both (see apply() of snell/view/document.h).
    Scene outline;
    CameraDesc camera; // what is shown; write it with App::look()
    std::vector<Pane> panes;
    std::optional<PickedPixel> picked; // by a click into the picture
    float exposure_ev = 0.0f;
    uint curve = 0; // tone_*
    bool ui_hidden = false;
    SessionStatus status;
    double time = 0; // seconds since the window opened
    // Ask for things to be done after this frame; App fills these in.
    std::function<void(const CameraDesc&)> look;
    std::function<void(const std::string&)> say; // a message at the window's bottom for some seconds
    std::function<void(std::string)> open;
};

// A window of controls. It is drawn in each frame while it is open. Every control has a tooltip (tip() in widgets.h).
class Panel
{
  public:
    virtual ~Panel() = default;
    virtual const char* name() const = 0; // title, and its name for scripts; unique
    virtual const char* help() const = 0; // one sentence: what it is for, with the textbook's term
    virtual bool opens_at_start() const { return false; }
    virtual void draw(ViewState& state) = 0; // inside its ImGui window
    // Over the picture of a pane, also while the panel's window is closed only if it says so itself.
    virtual void draw_over(ViewState&, const Pane&, ImDrawList&) {}
    // A click into a picture that moved nothing. True: taken.
    virtual bool click(ViewState&, const PickedPixel&) { return false; }
};

// Each panel is one file of snell/view/panels/ with one function make_NAME_panel(), listed in panels.cpp.
std::vector<std::unique_ptr<Panel>> make_panels();

} // namespace snell::view
