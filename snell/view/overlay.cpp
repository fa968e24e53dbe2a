#include "snell/view/overlay.h"

#include "snell/kernel/views.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace snell::view {

Overlay::Overlay(const CameraDesc& camera, const Pane& pane, float width, float height, ImDrawList& list)
    : pane_(pane), list_(list), width_(width), height_(height),
      camera_(make_camera(camera, static_cast<int>(width), static_cast<int>(height)))
{
    if (camera_.model != camera_lens) return;
    constexpr int steps = 64;
    for (int i = 0; i <= steps; ++i) {
        const float r = camera_.lens.film_radius * static_cast<float>(i) / steps;
        const LensRay ray = lens_chief_ray(camera_.lens, r);
        const float angle = std::atan2(std::hypot(ray.direction.x, ray.direction.y), ray.direction.z);
        if (!(ray.weight > 0.0f) || (!lens_.empty() && angle <= lens_.back().x)) break;
        lens_.emplace_back(angle, r);
    }
}

vec3 Overlay::project(vec3 p, uint eye) const
{
    if (camera_.model != camera_lens) return camera_project_eye(camera_, p, eye, camera_green);
    const vec3 d = p - camera_.origin;
    const float x = dot(d, camera_.right), y = dot(d, camera_.up), aside = std::hypot(x, y);
    const float angle = std::atan2(aside, dot(d, camera_.forward));
    const auto above = std::lower_bound(lens_.begin(), lens_.end(), angle, [](vec2 a, float b) { return a.x < b; });
    if (above == lens_.end()) return vec3(0.0f);
    float r = above->y;
    if (above != lens_.begin()) {
        const vec2 low = *(above - 1);
        r = low.y + (angle - low.x) / (above->x - low.x) * (above->y - low.y);
    }
    const float s = aside > 0.0f ? r / aside : 0.0f;
    return {camera_.center.x + x * s * camera_.focal.x, camera_.center.y - y * s * camera_.focal.y, length(d)};
}

void Overlay::line(vec3 a, vec3 b, ImU32 color, float thickness) const
{
    if (camera_.model == camera_pinhole || camera_.model == camera_orthographic)
        return straight_line(a, b, color, thickness);
    for (uint eye = 0; eye < (camera_.model == camera_hmd ? 2u : 1u); ++eye)
        bent_line(a, project(a, eye), b, project(b, eye), 0, {eye, color, thickness});
}

// Cut off at a plane just before the camera.
void Overlay::straight_line(vec3 a, vec3 b, ImU32 color, float thickness) const
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

// Halved until the halves are straight. What is a jump even of the shortest piece goes around the picture's edge.
void Overlay::bent_line(vec3 a, vec3 at_a, vec3 b, vec3 at_b, int level, const Pen& pen) const
{
    constexpr int least = 2, most = 8, blind = 4; // blind: where no more of it is expected to be seen
    const vec3 middle = 0.5f * (a + b), at = project(middle, pen.eye);
    const bool sees_a = at_a.z > 0.0f, sees_b = at_b.z > 0.0f, sees = at.z > 0.0f;
    const vec2 gap(at_b.x - at_a.x, at_b.y - at_a.y);
    if (sees_a && sees_b && sees) {
        const vec2 bend = vec2(at.x, at.y) - 0.5f * vec2(at_a.x + at_b.x, at_a.y + at_b.y);
        const bool is_straight = level >= least && length(bend) < 1.0f && length(gap) < 0.25f * width_;
        const bool is_jump = length(gap) > 0.125f * width_;
        if (is_straight || (level == most && !is_jump))
            return list_.AddLine(to_window(at_a), to_window(at_b), pen.color, pen.thickness);
    }
    if (level == most || (level >= blind && !sees_a && !sees_b && !sees)) return;
    bent_line(a, at_a, middle, at, level + 1, pen);
    bent_line(middle, at, b, at_b, level + 1, pen);
}

void draw_legend(const Pane& pane, ImDrawList& list, std::string_view title, double most, std::string_view unit,
                 float ui_scale)
{
    const float width = std::min(260.0f * ui_scale, 0.6f * pane.w), height = 14.0f * ui_scale,
                margin = 12.0f * ui_scale;
    const float line = ImGui::GetTextLineHeight();
    const ImVec2 low(pane.x + margin, pane.y + pane.h - margin - height - line);
    list.AddRectFilled(ImVec2(low.x - 6.0f * ui_scale, low.y - line - 6.0f * ui_scale),
                       ImVec2(low.x + width + 6.0f * ui_scale, low.y + height + line + 6.0f * ui_scale),
                       IM_COL32(0, 0, 0, 170), 4.0f);
    const std::string head = unit.empty() ? std::string(title) : fmt::format("{} [{}]", title, unit);
    list.AddText(ImVec2(low.x, low.y - line - 2.0f), IM_COL32(255, 255, 255, 255), head.c_str());
    constexpr int steps = 64;
    for (int i = 0; i < steps; ++i) {
        const float a = static_cast<float>(i) / steps, b = static_cast<float>(i + 1) / steps;
        list.AddRectFilled(ImVec2(low.x + a * width, low.y), ImVec2(low.x + b * width, low.y + height),
                           overlay_color(heat_color(0.5f * (a + b))));
    }
    for (int i = 0; i <= 4; ++i) {
        const std::string number = fmt::format("{:.3g}", most * i / 4);
        const float x = low.x + width * static_cast<float>(i) / 4.0f;
        const float wide = ImGui::CalcTextSize(number.c_str()).x;
        const float shift = i == 0 ? 0.0f : i == 4 ? wide : 0.5f * wide;
        list.AddText(ImVec2(x - shift, low.y + height), IM_COL32(255, 255, 255, 255), number.c_str());
    }
}

} // namespace snell::view
