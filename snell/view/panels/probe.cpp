// The pixel probe: what is under the mouse, or under the pixel that was picked.
#include "snell/core/error.h"
#include "snell/lab/pixel_probe.h"
#include "snell/view/panel.h"
#include "snell/view/question.h"
#include "snell/view/widgets.h"

#include <fmt/format.h>
#include <imgui.h>

#include <cmath>

namespace snell::view {

namespace {
struct Found
{
    std::size_t pane = 0;
    int width = 0, height = 0;
    PixelProbe pixel;
};

std::string numbers(vec3 v)
{
    return fmt::format("{:.4g} {:.4g} {:.4g}", v.x, v.y, v.z);
}

class PixelPanel : public Panel
{
  public:
    const char* name() const override { return "Pixel"; }
    const char* help() const override
    {
        return "Pixel probe: value, hit point, normals, material and traversal steps of one pixel.";
    }

    void update(ViewState& state) override
    {
        if (!is_open) return;
        const std::optional<PickedPixel> wanted = follows_mouse_ ? under_mouse(state) : state.picked;
        if (!wanted || wanted->pane >= state.panes.size()) return;
        const auto found = question_.answer();
        const RenderSettings& settings = state.panes[wanted->pane].request.settings;
        const bool is_same = found != nullptr && asked_ && asked_->pane == wanted->pane && asked_->x == wanted->x &&
                             asked_->y == wanted->y && asked_camera_ == camera_key(state);
        if (is_same || question_.is_asked()) {
            if (question_.is_asked()) state.wake();
            return;
        }
        asked_ = wanted;
        asked_camera_ = camera_key(state);
        question_.ask(state.session, [at = *wanted, settings](const SessionAccess& access) {
            Found result;
            if (at.pane >= access.prepared.size() || access.prepared[at.pane] == nullptr)
                throw Error("the scene is not ready yet");
            result.pane = at.pane;
            result.width = settings.width, result.height = settings.height;
            result.pixel = probe_pixel(*access.prepared[at.pane], access.camera, access.scene, settings, at.x, at.y);
            return result;
        });
        state.wake();
    }

    void draw(ViewState& state) override
    {
        checkbox("Follow the mouse", follows_mouse_,
                 "Else the pixel that was clicked last. The camera ray goes through its centre");
        if (const std::string error = question_.error(); !error.empty()) warning(error);
        const auto found = question_.answer();
        if (found == nullptr) {
            paragraph("Move the mouse over the picture, or click into it.");
            return;
        }
        const PixelProbe& pixel = found->pixel;
        const ProbedVertex& v = pixel.first;
        fact("Pixel", fmt::format("{}, {}", pixel.x, pixel.y), "From the upper left corner of the pane");
        if (found->pane < state.panes.size() && state.panes[found->pane].shot != nullptr && found->width > 0) {
            const Film& film = state.panes[found->pane].shot->film;
            const PixelValue value =
                pixel_value(film, pixel.x * film.width / found->width, pixel.y * film.height / found->height);
            fact("Value", numbers(value.mean), "Radiance, scene-linear: the mean of the samples until now");
            fact("Samples", fmt::format("{}, error {:.2g}", value.samples, value.standard_error),
                 "Their number, and the standard error of the mean, on luminance");
            fact("Time", fmt::format("{:.3g} ms", 1e3 * static_cast<double>(value.seconds)),
                 "Of a thread, that went into this pixel; the pixels of a tile share its time alike");
        }
        fact("Traversal steps", fmt::format("{}", v.steps), "Nodes visited plus primitives tested by the camera ray");
        if (!v.is_surface) {
            paragraph("The camera ray meets nothing.");
            return;
        }
        ImGui::Separator();
        fact("Object", fmt::format("{}: {}", v.surface.object, pixel.object), "Number and name in the scene");
        if (!pixel.instance.empty()) fact("Instance", pixel.instance, "Which of the copies of its group");
        fact("Material",
             fmt::format("{}: {} ({})", v.surface.material, pixel.material, material_kind_name(v.material_kind)),
             "Number and name, and its scattering model (BSDF)");
        fact("Primitive", primitive_name(v.hit.primitive), "In the packed arrays that rays are tested against");
        fact("Distance", fmt::format("{:.5g}", pixel.depth), "Along the ray, in scene units");
        fact("Position", numbers(v.surface.position), "Of the hit point, in world space");
        fact("Geometric normal", numbers(v.surface.geometric_normal), "Of the triangle or sphere itself");
        fact("Shading normal", numbers(v.surface.shading_normal),
             "Interpolated between vertices, and bent by normal maps");
        fact("UV", fmt::format("{:.4g} {:.4g}", v.surface.uv.x, v.surface.uv.y), "Texture coordinates");
        fact("Barycentrics", fmt::format("{:.4g} {:.4g}", v.hit.u, v.hit.v),
             "Weights of the triangle's second and third vertex");
        fact("Albedo", numbers(pixel.albedo), "Part of the light that the material sends back");
    }

    std::optional<std::string> get(ViewState&, const std::string& wanted) override
    {
        const auto found = question_.answer();
        if (wanted.rfind("pixel.", 0) != 0) return std::nullopt;
        if (found == nullptr) return "none";
        if (wanted == "pixel.object") return found->pixel.object;
        if (wanted == "pixel.material") return found->pixel.material;
        if (wanted == "pixel.distance") return fmt::format("{}", found->pixel.depth);
        return std::nullopt;
    }

  private:
    using CameraKey = std::pair<std::array<float, 12>, CameraModel>;
    bool follows_mouse_ = true;
    std::optional<PickedPixel> asked_;
    CameraKey asked_camera_{};
    Question<Found> question_;

    static CameraKey camera_key(const ViewState& state)
    {
        const CameraDesc& c = state.camera;
        return {{c.eye.x, c.eye.y, c.eye.z, c.target.x, c.target.y, c.target.z, c.up.x, c.up.y, c.up.z, c.fov_degrees,
                 static_cast<float>(state.status.scene_version), static_cast<float>(state.opened)},
                c.model};
    }

    static std::optional<PickedPixel> under_mouse(const ViewState& state)
    {
        const ImGuiIO& io = ImGui::GetIO();
        if (io.WantCaptureMouse) return state.picked;
        for (std::size_t i = 0; i < state.panes.size(); ++i) {
            const Pane& pane = state.panes[i];
            const RenderSettings& settings = pane.request.settings;
            if (io.MousePos.x < pane.clip_x0 || io.MousePos.x >= pane.clip_x1 || io.MousePos.y < pane.y ||
                io.MousePos.y >= pane.y + pane.h)
                continue;
            const int x = static_cast<int>((io.MousePos.x - pane.x) / pane.w * static_cast<float>(settings.width));
            const int y = static_cast<int>((io.MousePos.y - pane.y) / pane.h * static_cast<float>(settings.height));
            return PickedPixel{i, std::clamp(x, 0, settings.width - 1), std::clamp(y, 0, settings.height - 1)};
        }
        return state.picked;
    }
};
} // namespace

std::unique_ptr<Panel> make_probe_panel()
{
    return std::make_unique<PixelPanel>();
}

} // namespace snell::view
