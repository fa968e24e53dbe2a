// The camera laboratory: which model maps directions to the picture, its parameters, and what it does to angles.
#include "snell/lab/camera_lab.h"
#include "snell/core/error.h"
#include "snell/io/calibration.h"
#include "snell/io/lens_file.h"
#include "snell/scene/camera_models.h"
#include "snell/view/navigation.h"
#include "snell/view/panel.h"
#include "snell/view/plot.h"
#include "snell/view/widgets.h"

#include <fmt/format.h>
#include <imgui.h>

#include <algorithm>
#include <cmath>

namespace snell::view {
namespace {

class CameraLab : public Panel
{
  public:
    const char* name() const override { return "Camera laboratory"; }
    const char* help() const override
    {
        return "The camera model (projection) and its parameters, with the distortion curve and the error of the way "
               "from the picture to the scene and back.";
    }

    void draw(ViewState& state) override
    {
        CameraDesc camera = state.camera;
        bool changed = draw_model(camera);
        changed |= draw_view(camera, state);
        changed |= draw_lens(camera, state);
        changed |= draw_distortion(camera);
        if (const std::string fault = camera_fault(camera); !fault.empty())
            warning("The camera would have " + fault); // what is shown stays
        else if (changed)
            state.look(camera);
        ImGui::Separator();
        draw_curves(state);
    }

    bool click(ViewState&, const PickedPixel&) override
    {
        is_waiting_ = focuses_;
        return false;
    }

    // The point under a click arrives some frames after it.
    void update(ViewState& state) override
    {
        const std::optional<vec3> point = state.picked_point ? std::optional(state.picked_point->point) : std::nullopt;
        if (is_waiting_ && point && point != last_point_) {
            CameraDesc camera = state.camera;
            camera.model.focus_distance =
                dot(*point - camera.eye, normalize(camera.target - camera.eye)); // planes are sharp, not spheres
            is_waiting_ = false;
            if (camera.model.focus_distance > 0.0f) state.look(camera);
        }
        last_point_ = point;
    }

    bool set(ViewState& state, const std::string& name, const std::string& value) override
    {
        CameraDesc camera = state.camera;
        if (name == "camera_model") {
            const CameraModelInfo* info = find_camera_model(value);
            if (info == nullptr) throw Error(fmt::format("there is no camera model '{}'", value));
            become(camera, info->kind);
        } else if (name == "focus_by_click") {
            focuses_ = value == "on";
            return true;
        } else {
            return false;
        }
        state.look(camera);
        return true;
    }

    std::optional<std::string> get(ViewState& state, const std::string& name) override
    {
        if (name == "camera_model") return std::string(camera_models()[state.camera.model.kind].name);
        if (name == "focus_distance") return fmt::format("{}", state.camera.model.focus_distance);
        if (name == "round_trip") {
            measure(state);
            return fmt::format("{}", trip_.worst);
        }
        return std::nullopt;
    }

  private:
    static void become(CameraDesc& camera, uint kind)
    {
        if (camera.model.kind == kind) return;
        const CameraModel before = camera.model;
        camera.model = usual_model(kind);
        camera.model.focus_distance = before.focus_distance;
        if (kind == camera_lens && !(before.focus_distance > 0.0f))
            camera.model.focus_distance = length(camera.target - camera.eye);
        if (kind != camera_orthographic) camera.fov_degrees = camera_models()[kind].usual_fov;
    }

    bool draw_model(CameraDesc& camera)
    {
        std::vector<std::string> names, summaries;
        for (const CameraModelInfo& info : camera_models())
            names.emplace_back(info.name), summaries.emplace_back(info.summary);
        std::string name = names[camera.model.kind];
        if (!choose("Model", name, names, "How the picture's points look into the scene: the projection", summaries))
            return false;
        become(camera, find_camera_model(name)->kind);
        return true;
    }

    static bool draw_view(CameraDesc& camera, const ViewState& state)
    {
        CameraModel& m = camera.model;
        const bool is_calibrated = m.calibrated_width > 0.0f;
        if (m.kind == camera_orthographic) {
            float size = m.half_side > 0.0f ? 2.0f * m.half_side : 0.0f;
            const float natural = std::max(length(state.bounds.extent()), 1e-6f);
            if (!slider("View size", size, 0.0f, 4.0f * natural,
                        "What the picture's shorter side shows, in the scene's units; 0: as much as a pinhole would at "
                        "the target"))
                return false;
            m.half_side = 0.5f * size;
            return true;
        }
        if (m.kind == camera_equirectangular || m.kind == camera_lens || is_calibrated) return false;
        const CameraModelInfo& info = camera_models()[m.kind];
        return slider("Angle of view", camera.fov_degrees, 1.0f, std::min(info.largest_fov - 0.1f, 359.9f),
                      "Full angle of the picture's shorter side (of one eye's half), in degrees", "%.1f deg");
    }

    bool draw_lens(CameraDesc& camera, const ViewState& state)
    {
        CameraModel& m = camera.model;
        if (m.kind != camera_pinhole && m.kind != camera_lens) return false;
        const float natural = std::max(length(state.bounds.extent()), 1e-6f);
        bool changed = false;
        if (m.kind == camera_pinhole) {
            changed |= slider("Lens radius", m.lens_radius, 0.0f, 0.05f * natural,
                              "Of the thin lens's aperture, in the scene's units: the larger, the less is sharp (depth "
                              "of field). 0: a pinhole",
                              "%.4g");
            int blades = static_cast<int>(m.blades);
            if (slider("Blades", blades, 0, 12, "Corners of the aperture, as blurred lights show it (bokeh); 0: round"))
                m.blades = static_cast<uint>(std::max(blades, 0)), changed = true;
            changed |= slider("Blade rotation", m.blade_rotation_degrees, 0.0f, 180.0f,
                              "Turns the aperture counter-clockwise, in degrees", "%.0f deg");
        } else {
            changed |= draw_glass(m);
        }
        float focus = m.focus_distance > 0.0f ? m.focus_distance : length(camera.target - camera.eye);
        if (slider("Focus distance", focus, 1e-3f * natural, 10.0f * natural,
                   "Where it is sharp: along the axis, in the scene's units", "%.4g", true))
            m.focus_distance = focus, changed = true;
        checkbox("Focus by click", focuses_, "A click into the picture makes sharp what lies there");
        return changed;
    }

    bool draw_glass(CameraModel& m)
    {
        std::vector<std::string> names;
        for (const LensPrescription& lens : known_lenses()) names.push_back(lens.name);
        std::string name = m.lens.name;
        bool changed = false;
        if (choose("Lens", name, names, "A photographic lens that rays are traced through, surface by surface"))
            m.lens = *find_lens(name), changed = true;
        text("Lens file", file_, "A prescription: radius, thickness, index and diameter of one surface a line, in mm",
             "lenses/fisheye.txt");
        if (button("Load lens", "Look through the lens of that file"))
            changed |= load([&] { m.lens = load_lens(file_); });
        float stop = m.stop_diameter > 0.0f ? m.stop_diameter : stop_diameter(m.lens);
        if (slider("Stop", stop, 0.02f * stop_diameter(m.lens), stop_diameter(m.lens),
                   "Diameter of the aperture stop: smaller is sharper farther off; the exposure stays", "%.2f mm"))
            m.stop_diameter = stop, changed = true;
        changed |=
            slider("Film", m.film_diagonal, 5.0f, 100.0f, "The film's diagonal: 43.3 is that of 35 mm film", "%.1f mm");
        changed |=
            slider("Millimetre", m.millimetre, 1e-6f, 10.0f,
                   "In the scene's units: 0.001 where they are metres. It sizes the lens in the scene", "%.4g", true);
        if (!error_.empty()) warning(error_);
        const Cardinal c = cardinal(m.lens);
        const double open = static_cast<double>(stop / stop_diameter(m.lens));
        fact("Focal length", fmt::format("{:.2f} mm, f/{:.2g}", c.focal_length, c.f_number() / open),
             "Of rays near the axis, and over the diameter of the entrance pupil (f-number)");
        return changed;
    }

    bool draw_distortion(CameraDesc& camera)
    {
        CameraModel& m = camera.model;
        bool changed = false;
        const auto coefficient = [&](const char* label, std::size_t i, float most, const char* help) {
            changed |= slider(label, m.k[i], -most, most, help, "%.4f");
        };
        if (m.kind == camera_kannala_brandt) {
            const char* const labels[] = {"k1", "k2", "k3", "k4"};
            for (std::size_t i = 0; i < 4; ++i)
                coefficient(labels[i], i, 0.2f, "Kannala and Brandt: R = f theta (1 + k1 theta^2 + k2 theta^4 + ...)");
        } else if (m.kind == camera_brown_conrady) {
            const char* const labels[] = {"k1", "k2", "k3", "k4", "k5", "k6", "p1", "p2"};
            for (std::size_t i = 0; i < 8; ++i)
                coefficient(labels[i], i, i < 6 ? 0.5f : 0.05f,
                            i < 3   ? "Radial distortion (Brown-Conrady), as OpenCV has it"
                            : i < 6 ? "Radial distortion, in the denominator"
                                    : "Tangential distortion: a lens that is off its axis or tilted");
        } else if (m.kind == camera_hmd) {
            changed |= slider("Eye distance", m.eye_distance, 0.0f, 0.2f,
                              "Between the pupils (IPD), in the scene's units, which should be metres", "%.4f");
            const char* const labels[] = {"red k1",   "red k2",  "red k3",  "green k1", "green k2",
                                          "green k3", "blue k1", "blue k2", "blue k3"};
            for (std::size_t i = 0; i < 9; ++i)
                coefficient(labels[i], i, 1.0f,
                            "What the display shows at r appears at tan(theta) = r (1 + k1 r^2 + k2 r^4 + k3 r^6) of "
                            "this colour");
        }
        if (m.kind != camera_kannala_brandt && m.kind != camera_brown_conrady) return changed;
        text("Calibration", file_, "A file that OpenCV's calibration has written (.yml, .xml, .json)",
             "calibration.yml");
        if (button("Load calibration", "Take model, focal lengths and distortion from that file"))
            changed |= load([&] { m = load_calibration(file_); });
        if (!error_.empty()) warning(error_);
        if (m.calibrated_width > 0.0f && button("Drop calibration", "Back to an angle of view; coefficients stay"))
            m.calibrated_width = m.calibrated_height = 0.0f, changed = true;
        return changed;
    }

    template <class Load>
    bool load(const Load& load_it)
    {
        try {
            load_it();
            error_.clear();
            return true;
        } catch (const Error& error) {
            error_ = error.what();
            return false;
        }
    }

    // When the camera has become another one, or the picture has another shape.
    void measure(const ViewState& state)
    {
        const RenderSettings& s = state.panes[0].request.settings;
        const vec2 size(static_cast<float>(std::max(s.width, 1)), static_cast<float>(std::max(s.height, 1)));
        const bool is_same = measured_ && measured_->model == state.camera.model && size == measured_size_ &&
                             measured_->fov_degrees == state.camera.fov_degrees &&
                             measured_->target - measured_->eye == state.camera.target - state.camera.eye;
        if (is_same) return;
        measured_ = state.camera, measured_size_ = size;
        const ReadyCamera camera = make_camera(state.camera, static_cast<int>(size.x), static_cast<int>(size.y));
        const float scene = std::max(0.5f * length(state.bounds.extent()), 1e-6f);
        curve_ = distortion_curve(camera, 49);
        fov_ = field_of_view(camera);
        trip_ = round_trip(camera, camera.glass ? 15 : 41, scene);
        errors_ = round_trip_curve(camera, 49, scene);
        dark_ = camera.glass ? vignetting(camera.lens, 25, 24) : std::vector<VignettingPoint>{};
    }

    void draw_curves(const ViewState& state)
    {
        measure(state);
        fact("Sees", fmt::format("{:.1f} x {:.1f} deg, {:.1f} across", fov_.horizontal, fov_.vertical, fov_.diagonal),
             "Full angles of the picture, measured with rays: width, height and diagonal");
        fact("Round trip", fmt::format("{:.2g} pixels at worst", trip_.worst),
             "From pixels to rays to points on them and back: how exactly the inverse undoes the projection");
        if (trip_.unseeing > 0)
            fact("Sees nothing", fmt::format("{} of {} places", trip_.unseeing, trip_.unseeing + trip_.points / 3),
                 "Parts of the picture outside the circle that the lens draws");
        const float height = 9.0f * ImGui::GetFontSize();
        PlotSeries angle{"", {}, {}, curve_color(0), false}, straight{"", {}, {}, curve_color(5), true};
        for (const CurvePoint& p : curve_)
            if (p.angle)
                angle.x.push_back(static_cast<double>(p.radius)), angle.y.push_back(static_cast<double>(*p.angle));
        if (angle.x.size() > 3 && angle.y[2] > 0.0) { // R = f tan(theta) with the same middle
            const double f = angle.x[2] / std::tan(angle.y[2] * degree);
            for (const double x : angle.x) straight.x.push_back(x), straight.y.push_back(std::atan(x / f) / degree);
        }
        const PlotSeries both[] = {straight, angle};
        plot_lines("##distortion", both, "radius [pixels]", "angle from the axis [degrees]", height);
        tip("The distortion curve, from the axis to the lower right corner. Dashed: rectilinear, R = f tan(theta)");

        PlotSeries error{"", {}, {}, curve_color(1), false};
        for (const vec2& p : errors_)
            error.x.push_back(static_cast<double>(p.x)), error.y.push_back(static_cast<double>(p.y));
        plot_lines("##round_trip", {&error, 1}, "radius [pixels]", "round trip error [pixels]", height);
        tip("How far from where it began the way pixel, ray, point, pixel ends, along the same diagonal");
        if (dark_.empty()) return;
        PlotSeries light{"", {}, {}, curve_color(2), false}, cos4{"", {}, {}, curve_color(5), true};
        for (const VignettingPoint& p : dark_) {
            light.x.push_back(static_cast<double>(p.radius)), light.y.push_back(static_cast<double>(p.light));
            cos4.x.push_back(static_cast<double>(p.radius)), cos4.y.push_back(static_cast<double>(p.cos4));
        }
        const PlotSeries shade[] = {cos4, light};
        plot_lines("##vignetting", shade, "radius on the film [mm]", "light, 1 in the middle", height);
        tip("Vignetting: what arrives on the film of surroundings of constant light. Dashed: cos^4 of the angle at the "
            "film, which a small pupil alone would leave");
    }

    static constexpr double degree = 3.14159265358979 / 180.0;

    bool focuses_ = false, is_waiting_ = false;
    std::optional<vec3> last_point_;
    std::string file_, error_;

    std::optional<CameraDesc> measured_;
    vec2 measured_size_{0.0f};
    std::vector<CurvePoint> curve_;
    std::vector<vec2> errors_; // radius and error
    std::vector<VignettingPoint> dark_;
    FieldOfView fov_;
    RoundTrip trip_;
};

} // namespace

std::unique_ptr<Panel> make_camera_lab_panel()
{
    return std::make_unique<CameraLab>();
}

} // namespace snell::view
