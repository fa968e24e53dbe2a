// Several panes: any two settings, a reference from a file, what differs, and by how much.
#include "snell/core/error.h"
#include "snell/io/image/read.h"
#include "snell/lab/difference.h"
#include "snell/lab/metrics.h"
#include "snell/render/integrator.h"
#include "snell/view/background.h"
#include "snell/view/panel.h"
#include "snell/view/script_values.h"
#include "snell/view/widgets.h"

#include <imgui.h>

#include <algorithm>
#include <charconv>
#include <limits>

namespace snell::view {

namespace {
enum class Shows : uint
{
    rendering,
    file,
    difference
};

// What a pane shows beside what its settings say.
struct Choice
{
    Shows shows = Shows::rendering;
    std::string file;
    ShotPtr picture; // of the file
    std::size_t picture_pane = 0, reference_pane = 1;
    Difference kind = Difference::signed_difference;
    float gain = 1.0f;
    std::string trouble; // why there is nothing to be seen
};

// A picture as a shot, for it to be shown like one. input: of the requests that it answers.
ShotPtr shot_of(Picture picture, bool is_data, std::uint64_t input)
{
    auto shot = std::make_shared<Shot>();
    shot->width = shot->film.width = picture.width;
    shot->height = shot->film.height = picture.height;
    shot->film.sample_count.assign(picture.pixels.size(), 1u);
    shot->film.sum = std::move(picture.pixels);
    shot->is_data = is_data;
    shot->input = input;
    shot->spp = 1;
    shot->finished = true;
    return shot;
}

bool is_comparable(const ShotPtr& shot)
{
    return shot && shot->spp > 0 && !shot->film.sum.empty();
}

class Compare : public Panel
{
  public:
    const char* name() const override { return "Compare"; }
    const char* help() const override
    {
        return "Two to four panes on the same camera, each with settings of its own; references, differences, errors.";
    }

    void update(ViewState& state) override
    {
        choices_.resize(std::max(choices_.size(), state.panes.size()));
        for (std::size_t i = 0; i < state.panes.size(); ++i) {
            Pane& pane = state.panes[i];
            Choice& choice = choices_[i];
            pane.request.is_rendered = choice.shows == Shows::rendering;
            if (choice.shows == Shows::rendering && mine_[i] && pane.instead == mine_[i]) pane.instead = nullptr;
            if (choice.shows == Shows::file) pane.instead = mine_[i] = choice.picture;
            pane.label = label_of(state, i);
        }
        update_differences(state);
        update_errors(state);
    }

    void draw(ViewState& state) override
    {
        draw_layout(state);
        for (std::size_t i = 0; i < state.panes.size() && state.panes.size() > 1; ++i) draw_pane(state, i);
        if (state.panes.size() > 1) draw_errors(state);
    }

    // panes N; arrangement side|divider; show PANE:rendering|file:NAME|difference:A:B:KIND; truth PANE. Panes are
    // counted from 1.
    bool set(ViewState& state, const std::string& name, const std::string& value) override;
    // panes; mse, relmse, psnr, or with a pane behind it: mse2. Of the pane against the reference.
    std::optional<std::string> get(ViewState& state, const std::string& name) override;

  private:
    static std::string label_of(const RenderSettings& s)
    {
        std::string label = fmt::format("{}, {}", s.integrator, s.sampler);
        if (!s.accel.empty()) label += ", " + s.accel;
        if (!s.device.empty() && s.device != "cpu") label += ", " + s.device;
        if (s.seed != 0) label += fmt::format(", seed {}", s.seed);
        for (const auto& [key, value] : s.parameters) label += fmt::format(", {}={}", key, value);
        return label;
    }

    std::string label_of(const ViewState& state, std::size_t i) const
    {
        const Choice& choice = choices_[i];
        if (choice.shows == Shows::file) return choice.file.empty() ? "no file" : choice.file;
        if (choice.shows == Shows::difference && !choice.trouble.empty()) return choice.trouble;
        if (choice.shows == Shows::difference)
            return fmt::format("{}: pane {} against {}", difference_names[static_cast<std::size_t>(choice.kind)],
                               choice.picture_pane + 1, choice.reference_pane + 1);
        return label_of(state.panes[i].request.settings);
    }

    void set_count(ViewState& state, std::size_t count)
    {
        const Pane from = state.panes[std::min(state.active_pane, state.panes.size() - 1)];
        while (state.panes.size() > count) state.panes.pop_back();
        while (state.panes.size() < count) {
            Pane pane;
            pane.request = from.request;
            pane.request.is_rendered = true;
            state.panes.push_back(std::move(pane));
            choices_.resize(std::max(choices_.size(), state.panes.size()));
            choices_[state.panes.size() - 1] = {};
        }
        state.active_pane = std::min(state.active_pane, count - 1);
        state.wake();
    }

    void draw_layout(ViewState& state)
    {
        int count = static_cast<int>(state.panes.size());
        if (slider("Panes", count, 1, 4,
                   "Pictures beside each other, on the same camera. A new one begins with the "
                   "settings of the active pane; click a pane to make it the active one, whose "
                   "settings the panel Rendering changes"))
            set_count(state, static_cast<std::size_t>(count));
        if (state.panes.size() != 2) return;
        constexpr const char* names[] = {"side by side", "divider"};
        uint arrangement = static_cast<uint>(state.arrangement);
        if (choose("Arrangement", arrangement, names,
                   "Two pictures beside each other, or one on each side of a line that "
                   "can be dragged (a split view)"))
            state.arrangement = static_cast<Arrangement>(arrangement);
    }

    void load(ViewState& state, Choice& choice) const
    {
        choice.picture = nullptr;
        choice.trouble.clear();
        if (choice.file.empty()) return;
        try {
            choice.picture = shot_of(read_picture(choice.file), false, std::numeric_limits<std::uint64_t>::max());
        } catch (const Error& error) {
            choice.trouble = error.what();
        }
        state.wake();
    }

    static bool choose_pane(const char* label, std::size_t& pane, std::size_t count, const char* help)
    {
        constexpr const char* names[] = {"pane 1", "pane 2", "pane 3", "pane 4"};
        uint value = static_cast<uint>(pane);
        const bool changed = choose(label, value, std::span(names).first(count), help);
        pane = value;
        return changed;
    }

    void draw_pane(ViewState& state, std::size_t i)
    {
        Choice& choice = choices_[i];
        RenderSettings& settings = state.panes[i].request.settings;
        // Controls have names of their own, by which scripts find them.
        const auto own = [i](const char* label) { return fmt::format("{} {}", label, i + 1); };
        ImGui::Separator();
        ImGui::Text("Pane %zu", i + 1);
        tip(state.panes[i].label);
        constexpr const char* kinds[] = {"rendering", "picture from a file", "difference of two panes"};
        uint shows = static_cast<uint>(choice.shows);
        if (choose(own("Shows").c_str(), shows, kinds,
                   "A pane shows what it renders, a reference that was rendered before, or how two "
                   "other panes differ")) {
            choice.shows = static_cast<Shows>(shows);
            choice.trouble.clear();
            choice.picture_pane = i == 0 ? 1 : 0;
            choice.reference_pane = i == 1 ? 2 : 1;
            state.panes[i].instead = mine_[i] = nullptr;
        }
        if (choice.shows == Shows::rendering) {
            std::vector<std::string> names, summaries;
            for (const IntegratorInfo& info : integrators())
                names.push_back(info.name), summaries.push_back(info.summary);
            if (choose(own("Integrator").c_str(), settings.integrator, names,
                       "How light is computed; more in the panel Rendering", summaries))
                std::erase_if(settings.parameters, [](const auto& p) { return !is_structure(p.first); });
            static const std::vector<std::string> samplers = {"sobol", "independent"};
            choose(own("Sampler").c_str(), settings.sampler, samplers, "Where random numbers come from");
        } else if (choice.shows == Shows::file) {
            if (text(own("File").c_str(), choice.file, "A picture (.exr .pfm .hdr .png .jpg); Enter loads it",
                     "reference.exr"))
                load(state, choice);
        } else {
            choose_pane(own("Picture").c_str(), choice.picture_pane, state.panes.size(),
                        "The picture x whose error is looked at");
            choose_pane(own("Reference").c_str(), choice.reference_pane, state.panes.size(),
                        "The picture r that it is compared with");
            std::vector<const char*> names;
            for (const std::string_view kind : difference_names) names.push_back(kind.data());
            uint kind = static_cast<uint>(choice.kind);
            if (choose(own("Difference").c_str(), kind, names,
                       "Signed: grey is equal, x - r in colour. Absolute: |x - r|. Relative: "
                       "|x - r| / (r + 0.01) as heat. Squared error: (x - r)^2 as heat"))
                choice.kind = static_cast<Difference>(kind);
            slider(own("Gain").c_str(), choice.gain, 0.1f, 100.0f, "Differences are multiplied with it", "%.1f", true);
        }
        if (!choice.trouble.empty()) warning(choice.trouble);
    }

    static bool is_structure(const std::string& key);

    // ---- what is computed beside the user interface ----

    struct Shown
    {
        std::size_t pane = 0;
        ShotPtr a, b, result;
        Difference kind = Difference::absolute;
        float gain = 1;
    };

    void update_differences(ViewState& state)
    {
        if (auto done = difference_.take(); done && done->pane < state.panes.size() && done->result) {
            if (choices_[done->pane].shows == Shows::difference)
                state.panes[done->pane].instead = mine_[done->pane] = done->result;
            shown_[done->pane] = *done;
        }
        for (std::size_t step = 0; step < state.panes.size(); ++step) {
            const std::size_t i = (next_ + step) % state.panes.size(); // each gets its turn
            Choice& choice = choices_[i];
            if (choice.shows != Shows::difference) continue;
            const std::size_t a = choice.picture_pane, b = choice.reference_pane;
            const std::size_t count = state.panes.size();
            if (a >= count || b >= count || a == i || b == i) {
                choice.trouble = "choose two other panes: their pictures are compared here";
                state.panes[i].instead = mine_[i] = nullptr;
                continue;
            }
            const ShotPtr x = state.panes[a].shot, r = state.panes[b].shot;
            if (!is_comparable(x) || !is_comparable(r)) continue;
            if (x->film.width != r->film.width || x->film.height != r->film.height) {
                // While things move or begin, sizes differ for moments; a file's stays.
                if (!x->is_preview && !r->is_preview)
                    choice.trouble = fmt::format("{}x{} pixels against {}x{}: only pictures of the same size can be "
                                                 "compared",
                                                 x->film.width, x->film.height, r->film.width, r->film.height);
                continue;
            }
            choice.trouble.clear();
            const Shown& last = shown_[i];
            if ((last.a == x && last.b == r && last.kind == choice.kind && last.gain == choice.gain &&
                 state.panes[i].instead == last.result) ||
                difference_.is_busy())
                continue;
            difference_.start([job = Shown{i, x, r, nullptr, choice.kind, choice.gain}]() mutable {
                Picture picture =
                    picture_of_difference(job.a->film.picture(), job.b->film.picture(), job.kind, job.gain);
                job.result = shot_of(std::move(picture), true, std::min(job.a->input, job.b->input));
                return job;
            });
            next_ = i + 1;
        }
    }

    struct Errors
    {
        std::vector<ShotPtr> shots;
        std::size_t reference = 0;
        std::vector<std::optional<PictureError>> errors; // by pane
    };

    void update_errors(ViewState& state)
    {
        if (auto done = measuring_.take()) errors_ = std::move(*done);
        const std::size_t count = state.panes.size();
        if (count < 2 || measuring_.is_busy()) return;
        Errors job;
        job.reference = std::min(reference_, count - 1);
        for (std::size_t i = 0; i < count; ++i)
            job.shots.push_back(choices_[i].shows == Shows::difference ? nullptr : state.panes[i].shot);
        if (job.shots == errors_.shots && job.reference == errors_.reference) return;
        measuring_.start([job]() mutable {
            const ShotPtr& r = job.shots[job.reference];
            job.errors.resize(job.shots.size());
            if (!is_comparable(r) || r->is_preview) return job;
            const Picture truth = r->film.picture();
            for (std::size_t i = 0; i < job.shots.size(); ++i) {
                const ShotPtr& x = job.shots[i];
                if (i == job.reference || !is_comparable(x) || x->is_preview || x->film.width != r->film.width ||
                    x->film.height != r->film.height)
                    continue;
                job.errors[i] = compare_pictures(x->film.picture(), truth);
            }
            return job;
        });
    }

    void draw_errors(ViewState& state)
    {
        ImGui::Separator();
        choose_pane("Truth", reference_, state.panes.size(), "The pane that the others are measured against");
        if (!ImGui::BeginTable("errors", 5, ImGuiTableFlags_RowBg | ImGuiTableFlags_SizingStretchProp)) return;
        for (const char* column : {"pane", "spp", "MSE", "relMSE", "PSNR"}) ImGui::TableSetupColumn(column);
        ImGui::TableHeadersRow();
        tip("Mean squared error; relative MSE, (x - r)^2 / (r^2 + 0.01) on luminance; peak signal-to-noise ratio for a "
            "peak "
            "of 1, in dB");
        for (std::size_t i = 0; i < state.panes.size(); ++i) {
            ImGui::TableNextColumn();
            ImGui::Text("%zu", i + 1);
            tip(state.panes[i].label);
            ImGui::TableNextColumn();
            const ShotPtr& shot = state.panes[i].shot;
            if (shot && choices_[i].shows == Shows::rendering) ImGui::Text("%u", shot->spp);
            const bool has = i < errors_.errors.size() && errors_.errors[i];
            for (int column = 0; column < 3; ++column) {
                ImGui::TableNextColumn();
                if (!has) {
                    ImGui::TextDisabled("-");
                    continue;
                }
                const PictureError& e = *errors_.errors[i];
                if (column == 2)
                    ImGui::Text("%.1f dB", e.psnr);
                else
                    ImGui::Text("%.3g", column == 0 ? e.mse : e.relmse);
            }
        }
        ImGui::EndTable();
    }

    std::vector<Choice> choices_ = std::vector<Choice>(4);
    std::array<ShotPtr, 4> mine_; // what this panel has put in place of a pane's pictures
    std::array<Shown, 4> shown_;
    std::size_t next_ = 0;
    Background<Shown> difference_;
    std::size_t reference_ = 1;
    Errors errors_;
    Background<Errors> measuring_;
};

// ---- for scripts ----

bool Compare::is_structure(const std::string& key)
{
    return key == "builder" || key == "update";
}

bool Compare::set(ViewState& state, const std::string& name, const std::string& given)
{
    std::string value = given;
    if (name == "panes") {
        std::size_t count = 0;
        std::from_chars(value.data(), value.data() + value.size(), count);
        if (count < 1 || count > 4) throw Error(fmt::format("'{}' panes", value), "there can be 1 to 4");
        set_count(state, count);
    } else if (name == "arrangement") {
        if (value != "side" && value != "divider")
            throw Error(fmt::format("there is no arrangement '{}'", value), "there are side and divider");
        state.arrangement = value == "side" ? Arrangement::side_by_side : Arrangement::divider;
    } else if (name == "truth") {
        reference_ = take_pane(state, value);
    } else if (name == "show") {
        const std::size_t pane = take_pane(state, value);
        Choice& choice = choices_[pane];
        choice.trouble.clear();
        if (value == "rendering") {
            choice.shows = Shows::rendering;
        } else if (value.starts_with("file:")) {
            choice.shows = Shows::file;
            choice.file = value.substr(5);
            load(state, choice);
            if (!choice.trouble.empty()) throw Error(choice.trouble);
        } else if (value.starts_with("difference:")) {
            value.erase(0, 11);
            choice.shows = Shows::difference;
            choice.picture_pane = take_pane(state, value);
            choice.reference_pane = take_pane(state, value);
            const auto kind = std::find_if(std::begin(difference_names), std::end(difference_names),
                                           [&](std::string_view kind_name) { return kind_name.starts_with(value); });
            if (value.empty() || kind == std::end(difference_names))
                throw Error(fmt::format("there is no difference '{}'", value),
                            "there are signed, absolute, relative, squared");
            choice.kind = static_cast<Difference>(kind - std::begin(difference_names));
        } else
            throw Error(fmt::format("a pane cannot show '{}'", value),
                        "it can show rendering, file:NAME, difference:PANE:PANE:KIND");
    } else
        return false;
    state.wake();
    return true;
}

std::optional<std::string> Compare::get(ViewState& state, const std::string& name)
{
    if (name == "panes") return std::to_string(state.panes.size());
    for (const std::string_view kind : {"relmse", "mse", "psnr"}) {
        if (!name.starts_with(kind)) continue;
        std::string digits = name.substr(kind.size());
        const std::size_t pane = digits.empty() ? 0 : take_pane(state, digits);
        if (pane >= errors_.errors.size() || !errors_.errors[pane]) return "none";
        const PictureError& e = *errors_.errors[pane];
        return fmt::format("{}", kind == "mse" ? e.mse : kind == "relmse" ? e.relmse : e.psnr);
    }
    return std::nullopt;
}
} // namespace

std::unique_ptr<Panel> make_compare_panel()
{
    return std::make_unique<Compare>();
}

} // namespace snell::view
