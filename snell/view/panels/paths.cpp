// The path inspector: the samples of a pixel, replayed vertex by vertex, as lines in space and as a table.
#include "snell/core/error.h"
#include "snell/kernel/record.h"
#include "snell/kernel/views.h"
#include "snell/lab/pixel_probe.h"
#include "snell/view/overlay.h"
#include "snell/view/question.h"
#include "snell/view/widgets.h"

#include <fmt/format.h>

#include <cmath>

namespace snell::view {

namespace {

constexpr int pieces = 8; // of a line: each is dimmed by itself where something hides it

// What is asked: frozen, so that the camera can move away while the paths stay.
struct Asked
{
    PickedPixel pixel;
    RenderSettings settings;
    CameraDesc camera;
    uint first = 0, count = 1;
};

struct Replayed
{
    Asked asked;
    std::vector<ProbedPath> paths;
    std::vector<std::vector<float>> through; // by path and vertex: luminance that this vertex and those behind it add
    float most = 0;                          // of all paths
    std::size_t exact = 0;                   // paths that the renderer gives as well, to the bit
    float radius = 1;                        // of the scene
};

// By path, vertex and piece of the line to that vertex: 1 if the viewer sees it.
struct Seen
{
    vec3 eye{0.0f};
    std::vector<std::uint8_t> pieces;
};

struct FilmCheck
{
    uint samples = 0;
    bool is_equal = false;
    vec3 replayed{0.0f}, film{0.0f};
};

vec3 end_of(const ProbedVertex& v, float radius)
{
    return v.is_surface ? v.surface.position : v.ray.origin + radius * normalize(v.ray.direction);
}

Replayed replay(const SessionAccess& access, const Asked& asked)
{
    if (asked.pixel.pane >= access.prepared.size() || access.prepared[asked.pixel.pane] == nullptr)
        throw Error("the scene is not ready yet");
    const Prepared& prepared = *access.prepared[asked.pixel.pane];
    Replayed result;
    result.asked = asked;
    result.radius = prepared.packed.radius;
    for (uint i = 0; i < asked.count; ++i) {
        const uint sample = asked.first + i;
        ProbedPath path = probe_path(prepared, asked.camera, asked.settings, asked.pixel.x, asked.pixel.y, sample);
        const vec3 rendered =
            render_sample(prepared, asked.camera, asked.settings, asked.pixel.x, asked.pixel.y, sample);
        result.exact += rendered == (is_finite3(path.radiance) ? path.radiance : vec3(0.0f));
        std::vector<float> through(path.vertices.size(), 0.0f);
        for (const Contribution& one : path.contributions)
            through[static_cast<std::size_t>(one.vertex)] += luminance(one.value);
        for (std::size_t k = through.size(); k-- > 1;) // parents come before their children
            through[static_cast<std::size_t>(path.vertices[k].parent)] += through[k];
        if (!through.empty() && is_finite(through[0])) result.most = std::max(result.most, through[0]);
        result.through.push_back(std::move(through));
        result.paths.push_back(std::move(path));
    }
    return result;
}

Seen look_at(const SessionAccess& access, const Replayed& replayed, vec3 eye)
{
    Seen seen;
    seen.eye = eye;
    std::vector<Ray> rays;
    for (const ProbedPath& path : replayed.paths)
        for (const ProbedVertex& v : path.vertices)
            for (int i = 0; i < pieces; ++i) {
                const vec3 to = end_of(v, replayed.radius);
                const vec3 middle = v.ray.origin + (to - v.ray.origin) * ((static_cast<float>(i) + 0.5f) / pieces);
                rays.push_back(make_ray(eye, middle - eye, 0.9995f));
            }
    seen.pieces.assign(rays.size(), 0);
    const std::size_t pane = replayed.asked.pixel.pane;
    if (pane < access.prepared.size() && access.prepared[pane] != nullptr)
        access.prepared[pane]->accel->occluded(rays, seen.pieces);
    for (std::uint8_t& one : seen.pieces) one = one == 0 ? 1 : 0;
    return seen;
}

// All samples that are in the film's pixel, summed as the film sums them.
FilmCheck compare_with_film(const SessionAccess& access, const Asked& asked, const ShotPtr& shot)
{
    constexpr uint most = 20'000; // a second or so
    if (asked.pixel.pane >= access.prepared.size() || access.prepared[asked.pixel.pane] == nullptr)
        throw Error("the scene is not ready yet");
    const Film& film = shot->film;
    if (film.width != asked.settings.width || film.height != asked.settings.height || shot->is_preview)
        throw Error("the picture is coarser than its pane now: wait until it rests");
    const std::size_t pixel = static_cast<std::size_t>(asked.pixel.y) * static_cast<std::size_t>(film.width) +
                              static_cast<std::size_t>(asked.pixel.x);
    FilmCheck check;
    check.samples = film.sample_count[pixel];
    if (check.samples == 0) throw Error("the pixel has no samples yet");
    if (check.samples > most)
        throw Error(fmt::format("the pixel has {} samples already: too many to replay", check.samples));
    Film one(1, 1, false);
    for (uint s = 0; s < check.samples; ++s)
        one.add_sample(0, probe_path(*access.prepared[asked.pixel.pane], asked.camera, asked.settings, asked.pixel.x,
                                     asked.pixel.y, asked.settings.first_sample + s)
                              .radiance);
    check.replayed = one.sum[0] / static_cast<float>(check.samples);
    check.film = film.sum[pixel] / static_cast<float>(check.samples);
    check.is_equal = one.sum[0] == film.sum[pixel];
    return check;
}

std::string numbers(vec3 v)
{
    return fmt::format("{:.3g} {:.3g} {:.3g}", v.x, v.y, v.z);
}

bool same_view(const CameraDesc& a, const CameraDesc& b)
{
    return a.eye == b.eye && a.target == b.target && a.up == b.up && a.fov_degrees == b.fov_degrees &&
           a.model == b.model;
}

class PathsPanel : public Panel
{
  public:
    const char* name() const override { return "Paths"; }
    const char* help() const override
    {
        return "Path inspector: the light paths of a pixel's samples in space, and vertex by vertex with densities and "
               "weights.";
    }
    bool floats_at_start() const override { return true; }

    bool click(ViewState& state, const PickedPixel& pixel) override
    {
        if (!is_open || pixel.pane >= state.panes.size()) return false;
        Asked asked;
        asked.pixel = pixel;
        asked.settings = state.panes[pixel.pane].request.settings;
        asked.camera = state.camera;
        asked_ = asked;
        to_ask_ = true;
        selected_ = 0;
        check_.forget();
        return false; // the camera may turn around the point as well
    }

    void update(ViewState& state) override
    {
        if (!is_open || !asked_) return;
        if (!is_frozen_ && !same_view(asked_->camera, state.camera)) {
            asked_->camera = state.camera;
            to_ask_ = true;
        }
        if (to_ask_ && !replay_.is_asked()) {
            to_ask_ = false;
            asked_->first = static_cast<uint>(first_), asked_->count = static_cast<uint>(count_);
            replay_.ask(state.session,
                        [asked = *asked_](const SessionAccess& access) { return replay(access, asked); });
        }
        const auto found = replay_.answer();
        if (found != nullptr && !seen_.is_asked() && (found != seen_of_ || seen_from_ != state.camera.eye)) {
            seen_of_ = found;
            seen_from_ = state.camera.eye;
            seen_.ask(state.session, [found, eye = state.camera.eye](const SessionAccess& access) {
                return look_at(access, *found, eye);
            });
        }
        if (replay_.is_asked() || seen_.is_asked() || check_.is_asked() || to_ask_) state.wake();
    }

    void draw(ViewState& state) override
    {
        to_ask_ |= slider("Samples", count_, 1, 64, "How many samples of the pixel are replayed and drawn");
        to_ask_ |= slider("First sample", first_, 0, 4096, "Number of the first of them; the sampler's index");
        checkbox("Frozen", is_frozen_,
                 "The paths stay those of the camera at the time of the click, so that it can move away");
        ImGui::SameLine();
        checkbox("Hidden lines", shows_hidden_, "Draw, dimmed, what surfaces hide");
        if (const std::string error = replay_.error(); !error.empty()) warning(error);
        const auto found = replay_.answer();
        if (!asked_ || found == nullptr || found->paths.empty()) {
            paragraph("Click into the picture to see the paths of that pixel.");
            return;
        }
        fact("Pixel", fmt::format("{}, {}", found->asked.pixel.x, found->asked.pixel.y), "That was clicked");
        fact("Exact",
             fmt::format("{} of {} equal the renderer's samples, bit for bit", found->exact, found->paths.size()),
             "Each sample is also rendered on its own and compared");
        selected_ = std::clamp(selected_, 0, static_cast<int>(found->paths.size()) - 1);
        slider("Shown", selected_, 0, static_cast<int>(found->paths.size()) - 1,
               "The sample of the table, drawn thick");
        draw_check(state, *found);
        draw_table(state, found->paths[static_cast<std::size_t>(selected_)]);
    }

    void draw_over(ViewState& state, const Pane& pane, ImDrawList& list) override
    {
        const auto found = replay_.answer();
        if (!is_open || found == nullptr || state.ui_hidden) return;
        const auto seen = seen_.answer();
        const Overlay overlay(state, pane, list);
        std::size_t piece = 0;
        const float thin = 1.2f * state.ui_scale, thick = 2.6f * state.ui_scale;
        for (std::size_t p = 0; p < found->paths.size(); ++p) {
            const bool is_selected = static_cast<int>(p) == selected_;
            for (std::size_t k = 0; k < found->paths[p].vertices.size(); ++k) {
                const ProbedVertex& v = found->paths[p].vertices[k];
                const vec3 from = v.ray.origin, to = end_of(v, found->radius);
                const float part = found->most > 0 ? std::sqrt(found->through[p][k] / found->most) : 0.0f;
                const vec3 color = heat_color(0.25f + 0.75f * part);
                for (int i = 0; i < pieces; ++i, ++piece) {
                    const bool is_seen = seen == nullptr || piece >= seen->pieces.size() || seen->pieces[piece] != 0;
                    if (!is_seen && !shows_hidden_) continue;
                    const float a = static_cast<float>(i) / pieces, b = static_cast<float>(i + 1) / pieces;
                    overlay.line(from + (to - from) * a, from + (to - from) * b,
                                 overlay_color(color, is_seen ? 1.0f : 0.35f), is_selected ? thick : thin);
                }
                if (v.is_surface) overlay.dot_at(to, is_selected ? 2.0f * thick : thick, overlay_color(color));
                if (is_selected) draw_lights(overlay, v, found->radius, thin);
                if (is_selected && v.is_surface)
                    if (const auto at = overlay.point(to))
                        list.AddText(ImVec2(at->x + 6.0f, at->y - 6.0f), IM_COL32(255, 255, 255, 255),
                                     std::to_string(k).c_str());
            }
        }
    }

    bool set(ViewState&, const std::string& wanted, const std::string& value) override
    {
        int* const number = wanted == "paths.samples" ? &count_
                            : wanted == "paths.first" ? &first_
                            : wanted == "paths.shown" ? &selected_
                                                      : nullptr;
        if (number == nullptr) return false;
        *number = std::clamp(std::atoi(value.c_str()), number == &count_ ? 1 : 0, number == &count_ ? 64 : 4096);
        to_ask_ = true;
        return true;
    }

    std::optional<std::string> get(ViewState&, const std::string& wanted) override
    {
        const auto found = replay_.answer();
        if (wanted.rfind("paths.", 0) != 0) return std::nullopt;
        if (found == nullptr) return "none";
        if (wanted == "paths.count") return std::to_string(found->paths.size());
        if (wanted == "paths.exact") return std::to_string(found->exact);
        const auto at = static_cast<std::size_t>(std::clamp(selected_, 0, static_cast<int>(found->paths.size()) - 1));
        if (wanted == "paths.vertices") return std::to_string(found->paths[at].vertices.size());
        return std::nullopt;
    }

  private:
    std::optional<Asked> asked_;
    bool to_ask_ = false, is_frozen_ = true, shows_hidden_ = true;
    int first_ = 0, count_ = 8, selected_ = 0;
    Question<Replayed> replay_;
    Question<Seen> seen_;
    Question<FilmCheck> check_;
    std::shared_ptr<const Replayed> seen_of_;
    vec3 seen_from_{0.0f};

    static void draw_lights(const Overlay& overlay, const ProbedVertex& v, float radius, float thickness)
    {
        for (const ProbedLight& light : v.lights) {
            if (!light.was_traced) continue;
            const vec3 direction = normalize(light.ray.direction);
            const float whole = is_finite(light.ray.t_max) ? light.ray.t_max * length(light.ray.direction) : radius;
            const vec3 end = light.ray.origin + direction * (light.is_blocked ? light.blocked_at : whole);
            overlay.line(light.ray.origin, end,
                         light.is_blocked ? IM_COL32(230, 60, 50, 220) : IM_COL32(120, 220, 120, 220), thickness);
            if (light.is_blocked) overlay.dot_at(end, 3.0f * thickness, IM_COL32(230, 60, 50, 255));
        }
    }

    void draw_check(ViewState& state, const Replayed& found)
    {
        const std::size_t pane = found.asked.pixel.pane;
        if (button("Compare with the film",
                   "Replay every sample of the pixel and compare the sum with the picture's pixel, bit for bit") &&
            !check_.is_asked()) {
            const ShotPtr shot = state.session.shot(pane);
            if (shot == nullptr || !same_view(state.camera, found.asked.camera))
                state.say("The camera has moved: click into the picture again, then compare");
            else
                check_.ask(state.session, [asked = found.asked, shot](const SessionAccess& access) {
                    return compare_with_film(access, asked, shot);
                });
        }
        if (const std::string error = check_.error(); !error.empty()) {
            warning(error);
        } else if (const auto check = check_.answer()) {
            if (check->is_equal)
                paragraph(fmt::format("{} samples replayed: {}, equal to the film bit for bit", check->samples,
                                      numbers(check->replayed)));
            else
                warning(fmt::format("{} samples replayed: {}; the film has {}", check->samples,
                                    numbers(check->replayed), numbers(check->film)));
        }
    }

    struct Column
    {
        const char *name, *help;
    };

    static void draw_table(const ViewState& state, const ProbedPath& path)
    {
        static constexpr Column columns[] = {
            {"vertex", "Number; and where its ray comes from"},
            {"event", "The part of the BSDF that was drawn, or why the path ends"},
            {"object", "And its material"},
            {"position", "Of the vertex, in world space"},
            {"throughput", "What light from here is multiplied with, on arrival"},
            {"BSDF pdf",
             "Density per steradian of the direction that the path goes on in; a probability if it is specular"},
            {"light", "Chosen by next event estimation, and whether the shadow ray reached it"},
            {"light pdf", "Density per steradian of that light sample"},
            {"MIS light", "Weight of light sampling in multiple importance sampling"},
            {"MIS BSDF", "Weight of BSDF sampling, for emission that the ray has found"},
            {"roulette", "Probability of surviving Russian roulette"},
            {"medium", "What the ray came through: absorption follows it"},
            {"steps", "Of traversal: nodes visited plus primitives tested"},
            {"emission", "What emission found here adds to the sample"},
            {"direct", "What the light sample adds"},
            {"layer", "Which part of the pixel's value the light goes to"}};
        fact("Sample",
             fmt::format("{} at {:.2f}, {:.2f}: {}", path.sample, path.film_position.x, path.film_position.y,
                         numbers(path.radiance)),
             "Its number, where in the picture, and its radiance");
        fact("Layers",
             fmt::format("emission {} + direct {} + indirect {}", numbers(path.layers[layer_emission]),
                         numbers(path.layers[layer_direct]), numbers(path.layers[layer_indirect])),
             "The sums of the contributions below");
        constexpr ImGuiTableFlags flags = ImGuiTableFlags_Borders | ImGuiTableFlags_RowBg | ImGuiTableFlags_ScrollX |
                                          ImGuiTableFlags_ScrollY | ImGuiTableFlags_SizingFixedFit |
                                          ImGuiTableFlags_Resizable;
        const float height = ImGui::GetTextLineHeightWithSpacing() *
                             static_cast<float>(std::min<std::size_t>(path.vertices.size(), 16) + 3);
        if (!ImGui::BeginTable("vertices", static_cast<int>(std::size(columns)), flags, ImVec2(0.0f, height))) return;
        ImGui::TableSetupScrollFreeze(1, 1);
        for (const Column& column : columns) ImGui::TableSetupColumn(column.name);
        ImGui::TableNextRow(ImGuiTableRowFlags_Headers);
        for (int i = 0; i < static_cast<int>(std::size(columns)); ++i) {
            ImGui::TableSetColumnIndex(i);
            ImGui::TableHeader(columns[i].name);
            tip(columns[i].help);
        }
        for (std::size_t k = 0; k < path.vertices.size(); ++k) draw_row(state, path.vertices[k], k);
        ImGui::EndTable();
    }

    static void draw_row(const ViewState& state, const ProbedVertex& v, std::size_t number)
    {
        const auto cell = [](const std::string& text) {
            ImGui::TableNextColumn();
            ImGui::TextUnformatted(text.c_str());
        };
        const auto per_light = [&](const auto& text) {
            std::string all;
            for (const ProbedLight& light : v.lights) all += (all.empty() ? "" : "\n") + text(light);
            cell(all);
        };
        const auto per_continuation = [&](const auto& text) {
            std::string all;
            for (const ProbedVertex::Continuation& c : v.continuations) all += (all.empty() ? "" : "\n") + text(c);
            return all;
        };
        ImGui::TableNextRow();
        cell(v.parent < 0 ? fmt::format("{}", number) : fmt::format("{} from {}", number, v.parent));
        std::string events = per_continuation([](const auto& c) { return std::string(event_name(c.event)); });
        if (v.ending != ending_none) events += (events.empty() ? "" : ", then ") + std::string(ending_name(v.ending));
        cell(events);
        cell(v.is_surface ? fmt::format("{}, {}", object_name(state.outline, v.surface.object),
                                        material_name(state.outline, v.surface.material))
                          : "environment");
        cell(v.is_surface ? numbers(v.surface.position) : "");
        cell(numbers(v.throughput));
        cell(per_continuation([](const auto& c) { return fmt::format("{:.4g}", c.pdf); }));
        per_light([](const ProbedLight& light) {
            const std::string which = light.light == none ? "environment" : fmt::format("light {}", light.light);
            return which + (!light.was_traced ? " (nothing)" : light.is_blocked ? " (blocked)" : " (visible)");
        });
        per_light([](const ProbedLight& light) { return fmt::format("{:.4g}", light.drawn.pdf); });
        per_light([](const ProbedLight& light) { return fmt::format("{:.4f}", light.weight); });
        cell(is_black(v.emission) ? "" : fmt::format("{:.4f}", v.emission_weight));
        cell(v.survival < 1.0f ? fmt::format("{:.3f}", v.survival) : "");
        cell(v.arriving.medium == none ? "" : material_name(state.outline, v.arriving.medium));
        cell(std::to_string(v.steps));
        cell(is_black(v.emitted) ? "" : numbers(v.emitted));
        per_light([](const ProbedLight& light) {
            return light.was_traced && !light.is_blocked ? numbers(light.value) : std::string("0");
        });
        std::string layers;
        if (!is_black(v.emitted)) layers = std::string(layer_name(v.layer));
        for (const ProbedLight& light : v.lights)
            if (light.was_traced && !light.is_blocked)
                layers += (layers.empty() ? "" : ", ") + std::string(layer_name(light.layer));
        cell(layers);
    }
};
} // namespace

std::unique_ptr<Panel> make_paths_panel()
{
    return std::make_unique<PathsPanel>();
}

} // namespace snell::view
