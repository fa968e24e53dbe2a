// How the error falls while pictures are rendered: a chart with laws fitted to it.
#include "snell/lab/convergence.h"
#include "snell/core/error.h"
#include "snell/io/file.h"
#include "snell/io/image/read.h"
#include "snell/view/background.h"
#include "snell/view/panel.h"
#include "snell/view/plot.h"
#include "snell/view/widgets.h"

#include <imgui.h>

namespace snell::view {

namespace {
// A point each time that a picture has become older by that factor: evenly spaced on the chart.
constexpr double spacing = 1.08;

class Convergence : public Panel
{
  public:
    const char* name() const override { return "Convergence"; }
    const char* help() const override
    {
        return "The error of each pane's picture against time, on logarithmic axes, with the slope: Monte Carlo's is "
               "-1/2.";
    }

    void update(ViewState& state) override
    {
        take_result(state);
        if (!is_open && !is_recording_) return;
        live_.resize(state.panes.size());
        for (std::size_t i = 0; i < state.panes.size(); ++i) {
            const Pane& pane = state.panes[i];
            if (pane.instead || !pane.shot || pane.shot->is_preview || pane.shot->is_data) continue;
            Live& live = live_[i];
            if (pane.shot->generation != live.generation) {
                live = {};
                live.generation = pane.shot->generation;
            }
            live.curve.name = curve_name(pane, i);
            const Shot& shot = *pane.shot;
            const bool is_due = shot.seconds >= spacing * live.last_seconds || shot.finished;
            if (shot.spp == 0 || shot.seconds <= live.last_seconds || !is_due || work_.is_busy()) continue;
            live.last_seconds = shot.seconds;
            measure(pane.shot, i);
        }
    }

    void draw(ViewState& state) override
    {
        std::vector<PlotSeries> series;
        std::size_t number = 0;
        const auto add = [&](const ConvergenceCurve& curve) {
            if (curve.points.empty()) return;
            const ImU32 color = curve_color(number++);
            PlotSeries line{curve.name, {}, {}, color, false};
            for (const ConvergencePoint& p : curve.points) line.x.push_back(p.seconds), line.y.push_back(p.rmse);
            const auto law = fit_time(curve);
            std::string text = fmt::format("{}: {:.3g}", curve.name, curve.points.back().rmse);
            if (law) {
                text += fmt::format(", slope {:.2f}", law->exponent);
                const double first = line.x.front(), last = line.x.back();
                series.push_back({"", {first, last}, {(*law)(first), (*law)(last)}, color, true});
            }
            series.push_back(std::move(line));
            ImGui::PushStyleColor(ImGuiCol_Text, color);
            paragraph(text);
            ImGui::PopStyleColor();
            tip("The last error, and the slope of the dashed line: the exponent of the power law that fits the last "
                "three "
                "quarters of the curve best. Independent samples have -1/2, stratified ones fall faster");
        };
        for (const ConvergenceCurve& curve : kept_) add(curve);
        for (const Live& live : live_) add(live.curve);
        if (number == 0) paragraph("The curves appear while a picture is rendered: two samples a pixel are needed.");
        plot_log_log("##convergence", series, "seconds of rendering",
                     reference_ ? "RMSE against the reference" : "RMSE expected from the variance",
                     14.0f * ImGui::GetFontSize());
        tip("Root of the mean squared error of the pixels' luminance, on logarithmic axes");
        draw_controls(state);
    }

    bool set(ViewState& state, const std::string& name, const std::string& value) override
    {
        if (name == "reference")
            load(state, value);
        else if (name == "record") { // also while the panel is closed; with nothing: no longer
            is_recording_ = !value.empty();
            if (is_recording_)
                file_ = value;
            else
                save(state);
        } else
            return false;
        return true;
    }

    std::optional<std::string> get(ViewState&, const std::string& name) override
    {
        if (name != "points" && name != "rmse" && name != "slope") return std::nullopt;
        if (live_.empty()) return "none";
        const ConvergenceCurve& curve = live_[0].curve;
        if (name == "points") return std::to_string(curve.points.size());
        if (name == "rmse") return fmt::format("{}", curve.points.empty() ? 0.0 : curve.points.back().rmse);
        const auto law = fit_time(curve);
        if (name == "slope") return fmt::format("{}", law ? law->exponent : 0.0);
        return std::nullopt;
    }

  private:
    struct Live
    {
        ConvergenceCurve curve;
        std::uint64_t generation = 0;
        double last_seconds = 0;
    };
    struct Measured
    {
        std::size_t pane = 0;
        std::uint64_t generation = 0, reference = 0;
        ConvergencePoint point;
        std::optional<double> rmse;
    };

    static std::string curve_name(const Pane& pane, std::size_t number)
    {
        const RenderSettings& s = pane.request.settings;
        return pane.label.empty() ? fmt::format("{} {}, {}", number + 1, s.integrator, s.sampler) : pane.label;
    }

    void measure(const ShotPtr& shot, std::size_t pane)
    {
        work_.start([shot, pane, reference = reference_, number = reference_number_] {
            Measured m;
            m.pane = pane;
            m.generation = shot->generation;
            m.reference = number;
            m.point = {shot->seconds, static_cast<double>(shot->spp), 0};
            m.rmse = reference ? rmse_against(shot->film, *reference) : expected_rmse(shot->film);
            return m;
        });
    }

    void take_result(ViewState& state)
    {
        const auto measured = work_.take();
        if (!measured || !measured->rmse || measured->pane >= live_.size()) return;
        Live& live = live_[measured->pane];
        if (live.generation != measured->generation || measured->reference != reference_number_) return;
        live.curve.points.push_back(measured->point);
        live.curve.points.back().rmse = *measured->rmse;
        if (is_open) state.wake();
    }

    void use_reference(std::shared_ptr<const Picture> picture)
    {
        reference_ = std::move(picture);
        reference_number_ += 1;
        live_.clear();
        kept_.clear(); // they are errors against something else
    }

    void load(ViewState& state, const std::string& file)
    {
        try {
            use_reference(file.empty() ? nullptr : std::make_shared<Picture>(read_picture(file)));
        } catch (const Error& error) {
            state.say(error.what());
        }
    }

    void save(ViewState& state) const
    {
        std::vector<ConvergenceCurve> curves = kept_;
        for (const Live& live : live_) curves.push_back(live.curve);
        try {
            write_atomically(file_, convergence_csv(curves));
            state.say(fmt::format("the curves were written to {}", file_));
        } catch (const Error& error) {
            state.say(error.what());
        }
    }

    void draw_controls(ViewState& state)
    {
        if (button("Restart panes", "Render all panes anew, from their first sample")) state.session.restart();
        ImGui::SameLine();
        if (button("Keep", "Keep these curves in the chart, to compare other settings with them"))
            for (const Live& live : live_) kept_.push_back(live.curve);
        ImGui::SameLine();
        if (button("Forget", "Remove the curves that were kept")) kept_.clear();

        if (text("Reference file", reference_file_,
                 "A picture (.exr .pfm .hdr .png) of the same size: the error is measured against it. Enter loads it; "
                 "empty: what the variance of the samples lets expect",
                 "none: expected error"))
            load(state, reference_file_);
        const ShotPtr& shot = state.panes[std::min(state.active_pane, state.panes.size() - 1)].shot;
        ImGui::BeginDisabled(!shot || shot->spp == 0 || shot->is_preview);
        if (button("Take this picture",
                   "The active pane's picture, as it is now, becomes the reference. Let it have many "
                   "more samples than what you measure, and then change the seed"))
            use_reference(std::make_shared<Picture>(shot->film.picture()));
        ImGui::EndDisabled();
        if (reference_) {
            ImGui::SameLine();
            if (button("No reference", "Measure the expected error again"))
                use_reference(nullptr), reference_file_.clear();
            const RenderSettings& s = state.panes[0].request.settings;
            if (reference_->width != s.width || reference_->height != s.height)
                warning(fmt::format("the reference has {}x{} pixels, the pane {}x{}: they cannot be compared",
                                    reference_->width, reference_->height, s.width, s.height));
        }
        text("Curves file", file_, "Where the curves are written: name, seconds, spp and RMSE of each point",
             "convergence.csv");
        if (button("Write curves", "Write the curves as comma-separated values")) save(state);
    }

    std::vector<Live> live_;
    std::vector<ConvergenceCurve> kept_;
    std::shared_ptr<const Picture> reference_;
    std::uint64_t reference_number_ = 0;
    std::string reference_file_, file_ = "convergence.csv";
    bool is_recording_ = false;
    Background<Measured> work_;
};
} // namespace

std::unique_ptr<Panel> make_convergence_panel()
{
    return std::make_unique<Convergence>();
}

} // namespace snell::view
