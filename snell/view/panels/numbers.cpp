// What the renderer and the window achieve, in numbers; also as a file.
#include "snell/core/error.h"
#include "snell/io/file.h"
#include "snell/lab/csv.h"
#include "snell/lab/rates.h"
#include "snell/view/panel.h"
#include "snell/view/widgets.h"

#include <imgui.h>
#include <unistd.h>

#include <cmath>
#include <fstream>

namespace snell::view {

namespace {
constexpr double record_interval = 0.1;

// Of this process, now; 0: the system does not say.
double resident_bytes()
{
    std::ifstream file("/proc/self/statm");
    double pages = 0, resident = 0;
    if (!(file >> pages >> resident)) return 0;
    return resident * static_cast<double>(sysconf(_SC_PAGESIZE));
}

void heading(const char* text)
{
    ImGui::Separator();
    ImGui::TextUnformatted(text);
}

std::string bytes_text(double bytes)
{
    return bytes < 1e9 ? fmt::format("{:.1f} MB", 1e-6 * bytes) : fmt::format("{:.2f} GB", 1e-9 * bytes);
}

std::string millions(double a_second)
{
    return fmt::format("{:.2f} M/s", 1e-6 * a_second);
}

double frames_a_second(double ms)
{
    return ms > 0 ? 1000.0 / ms : 0.0;
}

// The number that a script asks for; nothing: there is none of that name.
std::optional<double> number_called(const std::string& name, const ViewState& state, const RenderRates& rates)
{
    const Timings& t = state.timings;
    if (name == "rays_per_second") return rates.rays();
    if (name == "samples_per_second") return rates.samples;
    if (name == "frame_ms") return t.frame.percentile(0.5);
    if (name == "frame_ms_99") return t.frame.percentile(0.99);
    if (name == "input_to_picture_ms") return t.input_to_picture.percentile(0.5);
    if (name == "input_to_picture_ms_99") return t.input_to_picture.percentile(0.99);
    if (name == "ui_ms") return t.ui.percentile(0.5);
    if (name == "scale") return static_cast<double>(state.status.governor.scale);
    if (name == "depth") return state.status.governor.max_depth;
    if (name == "memory_mb") return 1e-6 * resident_bytes();
    return std::nullopt;
}

class Numbers : public Panel
{
  public:
    const char* name() const override { return "Numbers"; }
    const char* help() const override
    {
        return "Rays a second by kind, time in each stage, frame times with their 1% low, latency, memory.";
    }

    void update(ViewState& state) override
    {
        meter_.add(state.time, state.status.stats);
        if (!table_ || state.time < next_row_) return;
        next_row_ = state.time + record_interval;
        record(state);
    }

    void draw(ViewState& state) override
    {
        draw_rates(state);
        draw_stages();
        draw_frames(state);
        draw_governor(state);
        draw_memory(state);
        draw_recording(state);
    }

    // record FILE: begins; record with nothing: ends, and writes it.
    bool set(ViewState& state, const std::string& name, const std::string& value) override
    {
        if (name != "record") return false;
        if (table_) stop(state);
        if (!value.empty()) file_ = value, start(state);
        return true;
    }

    std::optional<std::string> get(ViewState& state, const std::string& name) override
    {
        if (name == "recorded_rows") return std::to_string(table_ ? table_->rows() : 0);
        const auto value = number_called(name, state, meter_.rates());
        if (!value) return std::nullopt;
        return fmt::format("{}", *value);
    }

  private:
    void draw_rates(const ViewState& state) const
    {
        const RenderRates rates = meter_.rates();
        fact("Rays", millions(rates.rays()),
             "Of all kinds, over the last two seconds. A ray is one query to the structure");
        fact("  camera", millions(rates.camera_rays), "Primary rays: from the camera through a pixel");
        fact("  extension", millions(rates.extension_rays), "Indirect rays: the paths' continuations (bounces)");
        fact("  shadow", millions(rates.shadow_rays), "Connections to lights: next event estimation");
        fact("Samples", millions(rates.samples), "Finished paths: samples of pixels");
        const RenderStats& all = state.status.stats;
        fact("In all",
             fmt::format("{:.1f} M rays, {:.1f} M samples", 1e-6 * static_cast<double>(all.rays()),
                         1e-6 * static_cast<double>(all.samples)),
             "Since the scene was opened");
    }

    void draw_stages() const
    {
        const RenderRates rates = meter_.rates();
        heading("Stages");
        constexpr const char* helps[] = {"Camera rays are made", "Nearest hits are found: traversal of the tree",
                                         "Surfaces, lights and scattering: what each hit is worth",
                                         "Shadow rays are tested: any-hit traversal", "Samples are added to the film"};
        for (std::size_t i = 0; i < stage_names.size(); ++i) {
            ImGui::ProgressBar(static_cast<float>(rates.stages[i]), ImVec2(-1.0f, 0.0f),
                               fmt::format("{}  {:.0f}%", stage_names[i], 100 * rates.stages[i]).c_str());
            tip(fmt::format("{}. Its part of the threads' time, over the last two seconds", helps[i]));
        }
    }

    static void draw_series(const char* id, const TimingSeries& series)
    {
        std::vector<float> values(series.values().begin(), series.values().end());
        float most = 1.0f;
        for (const float value : values) most = std::max(most, value);
        ImGui::PlotLines(id, values.data(), static_cast<int>(values.size()), 0,
                         fmt::format("0 to {:.0f} ms", most).c_str(), 0.0f, most,
                         ImVec2(ImGui::GetContentRegionAvail().x, 3.0f * ImGui::GetFontSize()));
    }

    static void draw_frames(const ViewState& state)
    {
        heading("Frames while things move");
        const Timings& t = state.timings;
        if (t.frame.empty() && t.input_to_picture.empty()) {
            paragraph("Move the camera: the times between pictures, and from input to picture, appear here.");
            return;
        }
        const double median = t.frame.percentile(0.5), slow = t.frame.percentile(0.99);
        fact("Frame time", fmt::format("{:.1f} ms ({:.0f} fps)", median, frames_a_second(median)),
             "Between pictures shown while things move: the median of the latest thousand");
        fact("1% low", fmt::format("{:.1f} ms ({:.0f} fps)", slow, frames_a_second(slow)),
             "One frame in a hundred takes longer: the 99th percentile");
        draw_series("##frames", t.frame);
        tip("Frame times, the latest at the right");
        fact("Input to picture",
             fmt::format("{:.1f} ms, 1% {:.1f} ms", t.input_to_picture.percentile(0.5),
                         t.input_to_picture.percentile(0.99)),
             "Latency: from an event of mouse or keyboard to the end of the frame that shows a picture which answers "
             "it. "
             "Median, and what one in a hundred exceeds");
        draw_series("##latency", t.input_to_picture);
        tip("Latencies, the latest at the right");
        fact("Interface",
             fmt::format("{:.1f} ms, of it conversion {:.1f} ms", t.ui.percentile(0.5), t.convert.percentile(0.5)),
             "The user interface's own work in a frame, and the part that turns radiance into the screen's 8 bits");
        fact("First picture", fmt::format("{:.2f} s", 1e-3 * t.first_picture_ms), "After the window was opened");
    }

    static void draw_governor(const ViewState& state)
    {
        heading("Governor");
        const GovernorState& g = state.status.governor;
        fact("Decision",
             fmt::format("{:.0f}% of the width, {}", 100.0f * g.scale,
                         g.max_depth == 0 ? "all bounces" : fmt::format("{} bounces", g.max_depth)),
             "What a picture gets while things move: it takes resolution first, then the depth of paths");
        fact("Last picture", fmt::format("{:.1f} ms of {:.0f} ms", g.measured_ms, state.governor.target_ms),
             "What it took, and the target");
        fact("Copying", fmt::format("{:.1f} ms", 1e3 * state.status.copy_seconds),
             "What handing the last picture from the renderer to the window has cost");
    }

    static void draw_memory(const ViewState& state)
    {
        heading("Scene and memory");
        const SessionStatus& s = state.status;
        fact("Triangles", fmt::format("{}", s.scene_triangles),
             "Of meshes, each counted once however often it is placed");
        fact("Loading", fmt::format("{:.2f} s", s.stats.load_seconds), "Reading, checking and completing the scene");
        fact("Packing", fmt::format("{:.2f} s", s.stats.pack_seconds), "Into the flat arrays that kernels read");
        fact("Building", fmt::format("{:.2f} s", s.stats.build_seconds), "The bounding volume hierarchies");
        fact("Last update", fmt::format("{:.1f} ms", 1e3 * s.update_seconds), "What following the last edit has taken");
        fact("Scene", bytes_text(static_cast<double>(s.stats.scene_bytes)), "The packed arrays");
        fact("Structures", bytes_text(static_cast<double>(s.stats.accel_bytes)), "Of all panes, what they share once");
        fact("Process",
             fmt::format("{}, at most {}", bytes_text(resident_bytes()),
                         bytes_text(static_cast<double>(s.peak_memory_bytes))),
             "Resident memory now, and its peak");
    }

    void draw_recording(ViewState& state)
    {
        heading("Recording");
        text("Table file", file_, "Where the table is written: comma-separated values, a row each tenth of a second",
             "numbers.csv");
        if (!table_) {
            if (button("Record", "Write down all these numbers from now on")) start(state);
            return;
        }
        if (button("Stop and write", "End the recording and write the file")) return stop(state);
        ImGui::SameLine();
        ImGui::Text("%zu rows", table_->rows());
    }

    void start(ViewState& state)
    {
        if (file_.empty()) file_ = "numbers.csv";
        try {
            check_can_write(file_);
        } catch (const Error& error) {
            state.say(error.what());
            return;
        }
        table_.emplace(std::vector<std::string>{
            "seconds", "generation", "spp", "picture_seconds", "is_moving", "camera_rays_per_second",
            "extension_rays_per_second", "shadow_rays_per_second", "samples_per_second", "scale", "max_depth",
            "picture_ms", "frame_ms", "input_to_picture_ms", "ui_ms", "resident_bytes"});
        next_row_ = 0;
    }

    void record(const ViewState& state)
    {
        const RenderRates rates = meter_.rates();
        const ShotPtr& shot = state.panes[0].shot;
        const GovernorState& g = state.status.governor;
        table_->row({state.time, shot ? static_cast<double>(shot->generation) : 0.0, shot ? shot->spp : 0.0,
                     shot ? shot->seconds : 0.0, state.status.is_moving ? 1.0 : 0.0, rates.camera_rays,
                     rates.extension_rays, rates.shadow_rays, rates.samples, static_cast<double>(g.scale),
                     static_cast<double>(g.max_depth), g.measured_ms, state.timings.frame.last(),
                     state.timings.input_to_picture.last(), state.timings.ui.last(), resident_bytes()});
    }

    void stop(ViewState& state)
    {
        const CsvTable table = std::move(*table_);
        table_.reset();
        try {
            write_atomically(file_, table.text());
            state.say(fmt::format("{} rows written to {}", table.rows(), file_));
        } catch (const Error& error) {
            state.say(error.what());
        }
    }

    RateMeter meter_{2.0};
    std::string file_;
    std::optional<CsvTable> table_;
    double next_row_ = 0;
};
} // namespace

std::unique_ptr<Panel> make_numbers_panel()
{
    return std::make_unique<Numbers>();
}

} // namespace snell::view
