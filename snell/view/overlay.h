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
        : pane_(pane), list_(list), width_(static_cast<float>(std::max(pane.request.settings.width, 1))),
          height_(static_cast<float>(std::max(pane.request.settings.height, 1))),
          camera_(make_camera(state.camera, static_cast<int>(width_), static_cast<int>(height_)))
    {
    }

    vec3 eye() const { return camera_.origin; }

    // Nothing: behind the camera.
    std::optional<ImVec2> point(vec3 p) const
    {
        const vec3 at = camera_project(camera_, p);
        if (!(at.z > 0.0f) || !is_finite(at.x) || !is_finite(at.y)) return std::nullopt;
        return to_window(at);
    }

    // Cut off at a plane just before the camera.
    void line(vec3 a, vec3 b, ImU32 color, float thickness = 1.0f) const
    {
        const float near = 1e-4f * (length(a - camera_.origin) + length(b - camera_.origin));
        float da = dot(a - camera_.origin, camera_.forward), db = dot(b - camera_.origin, camera_.forward);
        if (da < near && db < near) return;
        if (da < near) a = a + (b - a) * ((near - da) / (db - da));
        if (db < near) b = b + (a - b) * ((near - db) / (da - db));
        const vec3 pa = camera_project(camera_, a), pb = camera_project(camera_, b);
        if (!is_finite3(pa) || !is_finite3(pb)) return;
        // Far outside, ImGui's own clipping runs out of precision.
        const float far = 1e5f;
        if (std::abs(pa.x) > far || std::abs(pa.y) > far || std::abs(pb.x) > far || std::abs(pb.y) > far) return;
        list_.AddLine(to_window(pa), to_window(pb), color, thickness);
    }

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
    Camera camera_;

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
