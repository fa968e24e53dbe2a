// Views of data in place of light: what the renderer knows of first hits, and what a film knows of itself.
#include "snell/core/error.h"
#include "snell/lab/film_views.h"
#include "snell/render/integrator.h"
#include "snell/view/overlay.h"
#include "snell/view/widgets.h"

#include <fmt/format.h>

#include <map>

namespace snell::view {

namespace {
class ViewsPanel : public Panel
{
  public:
    const char* name() const override { return "Data views"; }
    const char* help() const override
    {
        return "Debug views: normals, texture coordinates, depth, ids, traversal steps; sample count, error and time "
               "of the film.";
    }

    void update(ViewState& state) override
    {
        for (std::size_t i = 0; i < state.panes.size(); ++i) show_film_view(state, i);
    }

    void draw(ViewState& state) override
    {
        Pane& pane = state.panes[std::min(state.active_pane, state.panes.size() - 1)];
        const std::size_t number = static_cast<std::size_t>(&pane - state.panes.data());
        RenderSettings& settings = pane.request.settings;
        const IntegratorInfo* info = find_integrator(settings.integrator);
        const bool is_view = info != nullptr && info->is_view;
        paragraph("Of the first hit:");
        for (const IntegratorInfo& one : integrators()) {
            if (!one.is_view) continue;
            bool is_on = settings.integrator == one.name;
            if (checkbox(one.name.c_str(), is_on, one.summary.c_str())) choose_view(state, pane, is_on ? one.name : "");
        }
        if (is_view && settings.integrator == "steps") {
            float most = most_steps(settings);
            if (slider("Bright end", most, 10.0f, 2000.0f, "Traversal steps at the bright end of the heat map", "%.0f",
                       true))
                settings.parameters["max_steps"] = fmt::format("{:.0f}", most);
        }
        ImGui::Separator();
        paragraph("Of the film:");
        const auto chosen = film_views_.find(number);
        for (int i = 0; i < film_view_count; ++i) {
            const auto view = static_cast<FilmView>(i);
            bool is_on = chosen != film_views_.end() && chosen->second.view == view;
            const std::string label(info_of(view).name), summary(info_of(view).summary);
            if (!checkbox(label.c_str(), is_on, summary.c_str())) continue;
            choose_film_view(state, number, is_on ? std::optional(view) : std::nullopt);
            break;
        }
        if (button("Back to light", "The integrator that was there before, without any view")) {
            choose_film_view(state, number, std::nullopt);
            choose_view(state, pane, "");
        }
    }

    void draw_over(ViewState& state, const Pane& pane, ImDrawList& list) override
    {
        const std::size_t number = static_cast<std::size_t>(&pane - state.panes.data());
        const auto chosen = film_views_.find(number);
        if (chosen != film_views_.end() && chosen->second.shown != nullptr && pane.instead == chosen->second.shown) {
            const FilmViewInfo& info = info_of(chosen->second.view);
            draw_legend(pane, list, info.name, static_cast<double>(chosen->second.most), info.unit, state.ui_scale);
        } else if (pane.instead == nullptr && pane.request.settings.integrator == "steps") {
            draw_legend(pane, list, "traversal steps", static_cast<double>(most_steps(pane.request.settings)),
                        "nodes and primitives", state.ui_scale);
        }
    }

    bool set(ViewState& state, const std::string& wanted, const std::string& value) override
    {
        if (wanted != "view") return false;
        Pane& pane = state.panes[std::min(state.active_pane, state.panes.size() - 1)];
        const std::size_t number = static_cast<std::size_t>(&pane - state.panes.data());
        choose_film_view(state, number, std::nullopt);
        for (int i = 0; i < film_view_count; ++i)
            if (info_of(static_cast<FilmView>(i)).name == value) {
                choose_film_view(state, number, static_cast<FilmView>(i));
                return true;
            }
        const IntegratorInfo* info = find_integrator(value);
        if (value != "light" && (info == nullptr || !info->is_view))
            throw Error(fmt::format("there is no view '{}'", value), "`snell list` names them; light is none");
        choose_view(state, pane, value == "light" ? "" : value);
        return true;
    }

  private:
    struct Before // it was a view
    {
        std::string integrator;
        std::map<std::string, std::string> parameters;
    };
    struct Shown
    {
        FilmView view = FilmView::sample_count;
        ShotPtr of, shown; // the heat map of a shot
        float most = 1;
        double made_at = -1;
    };
    std::map<std::size_t, Shown> film_views_; // by pane
    std::map<std::size_t, Before> before_;

    static float most_steps(const RenderSettings& settings)
    {
        const auto found = settings.parameters.find("max_steps");
        return found == settings.parameters.end() ? 100.0f
                                                  : std::max(1.0f, std::strtof(found->second.c_str(), nullptr));
    }

    void choose_view(ViewState& state, Pane& pane, const std::string& view)
    {
        const std::size_t number = static_cast<std::size_t>(&pane - state.panes.data());
        RenderSettings& settings = pane.request.settings;
        const IntegratorInfo* info = find_integrator(settings.integrator);
        const bool is_view = info != nullptr && info->is_view;
        if (view.empty()) {
            if (!is_view) return;
            const auto found = before_.find(number);
            settings.integrator = found == before_.end() ? "path" : found->second.integrator;
            if (found == before_.end())
                settings.parameters.erase("max_steps");
            else
                settings.parameters = found->second.parameters;
        } else {
            if (!is_view) before_[number] = {settings.integrator, settings.parameters};
            settings.integrator = view;
            for (const char* key : {"max_depth", "nee", "mis", "rr", "distance", "max_steps"})
                settings.parameters.erase(key);
        }
        state.wake();
    }

    void choose_film_view(ViewState& state, std::size_t number, std::optional<FilmView> view)
    {
        if (const auto found = film_views_.find(number); found != film_views_.end()) {
            Pane& pane = state.panes[number];
            if (pane.instead == found->second.shown) pane.instead = nullptr;
            film_views_.erase(found);
        }
        if (view) film_views_[number].view = *view;
        state.wake();
    }

    // A few times a second: a map of a million pixels takes some milliseconds.
    void show_film_view(ViewState& state, std::size_t number)
    {
        const auto found = film_views_.find(number);
        if (found == film_views_.end()) return;
        Shown& shown = found->second;
        const ShotPtr shot = state.session.shot(number);
        if (shot == nullptr || shot == shown.of || state.time - shown.made_at < 0.15) return;
        Pane& pane = state.panes[number];
        if (pane.instead != nullptr && pane.instead != shown.shown) return; // somebody else shows something
        const Film& film = shot->film;
        const HeatMap map = heat_map(film.width, film.height, film_values(film, shown.view));
        auto made = std::make_shared<Shot>();
        made->film = Film(film.width, film.height, false);
        made->film.sum = map.picture.pixels;
        made->film.sample_count.assign(map.picture.pixels.size(), 1u);
        made->width = shot->width, made->height = shot->height;
        made->is_data = true;
        made->input = shot->input;
        made->spp = 1;
        made->generation = shot->generation;
        shown.of = shot;
        shown.shown = made;
        shown.most = map.most;
        shown.made_at = state.time;
        pane.instead = shown.shown;
        state.wake();
    }
};
} // namespace

std::unique_ptr<Panel> make_views_panel()
{
    return std::make_unique<ViewsPanel>();
}

} // namespace snell::view
