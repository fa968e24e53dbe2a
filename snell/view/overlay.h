// Lines in space over the picture of a pane.
#pragma once

#include "snell/kernel/camera.h"
#include "snell/render/params.h"
#include "snell/view/panel.h"

#include <imgui.h>

namespace snell::view {

class Overlay
{
  public:
    Overlay(const ViewState& state, const Pane& pane, ImDrawList& list)
        : Overlay(state.camera, pane, static_cast<float>(std::max(pane.request.settings.width, 1)),
                  static_cast<float>(std::max(pane.request.settings.height, 1)), list)
    {
    }
    // For a picture of that many pixels.
    Overlay(const CameraDesc& camera, const Pane& pane, float width, float height, ImDrawList& list);

    vec3 eye() const { return camera_.origin; }

    // Nothing: it is not seen. Of an HMD: in the left eye.
    std::optional<ImVec2> point(vec3 p) const
    {
        const vec3 at = project(p, 0);
        if (!(at.z > 0.0f) || !is_finite(at.x) || !is_finite(at.y)) return std::nullopt;
        return to_window(at);
    }

    // Bent as the camera bends it, in both eyes of an HMD; cut off where it is not seen.
    void line(vec3 a, vec3 b, ImU32 color, float thickness = 1.0f) const;

    void dot_at(vec3 p, float radius, ImU32 color) const
    {
        if (const auto at = point(p)) list_.AddCircleFilled(*at, radius, color);
    }

    void box(const std::array<vec3, 8>& corners, ImU32 color, float thickness = 1.0f) const
    {
        for (uint i = 0; i < 8; ++i)
            for (uint axis = 0; axis < 3; ++axis)
                if ((i >> axis & 1u) == 0u) line(corners[i], corners[i | 1u << axis], color, thickness);
    }

  private:
    const Pane& pane_;
    ImDrawList& list_;
    float width_, height_;
    ReadyCamera camera_;
    std::vector<vec2> lens_; // of a traced one: angle of a ray from the axis, and its radius on the film; ascending

    // As camera_project_eye(); through a traced lens by a table, to a pixel or so: there may be thousands of lines.
    vec3 project(vec3 p, uint eye) const;
    void straight_line(vec3 a, vec3 b, ImU32 color, float thickness) const;
    struct Pen
    {
        uint eye;
        ImU32 color;
        float thickness;
    };
    void bent_line(vec3 a, vec3 at_a, vec3 b, vec3 at_b, int level, const Pen& pen) const;

    ImVec2 to_window(vec3 at) const
    {
        return ImVec2(pane_.x + at.x / width_ * pane_.w, pane_.y + at.y / height_ * pane_.h);
    }
};

// From linear Rec.709 to what ImGui takes, as sRGB.
inline ImU32 overlay_color(vec3 linear, float alpha = 1.0f)
{
    const auto encode = [](float x) {
        x = clamp(x, 0.0f, 1.0f);
        return x <= 0.0031308f ? 12.92f * x : 1.055f * std::pow(x, 1.0f / 2.4f) - 0.055f;
    };
    return ImGui::GetColorU32(ImVec4(encode(linear.x), encode(linear.y), encode(linear.z), alpha));
}

// A bar of the heat map at the lower left of a pane, from 0 to `most`.
void draw_legend(const Pane& pane, ImDrawList& list, std::string_view title, double most, std::string_view unit,
                 float ui_scale);

} // namespace snell::view
