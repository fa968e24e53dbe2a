// The inspector of acceleration structures: boxes by level, one ray step by step, builders side by side.
#include "snell/bvh/options.h"
#include "snell/core/error.h"
#include "snell/render/integrator.h"
#include "snell/view/overlay.h"
#include "snell/view/panels/bvh_facts.h"
#include "snell/view/question.h"
#include "snell/view/widgets.h"

#include <fmt/format.h>

#include <algorithm>

namespace snell::view {

namespace {

std::string bytes_in_words(std::size_t bytes)
{
    const double b = static_cast<double>(bytes);
    return b < 1e6 ? fmt::format("{:.0f} KiB", b / 1024) : fmt::format("{:.1f} MiB", b / 1048576);
}

class BvhPanel : public Panel
{
  public:
    const char* name() const override { return "Trees"; }
    const char* help() const override
    {
        return "Bounding volume hierarchies: nodes by level, one ray through the tree, builders with build time, SAH, "
               "EPO and Mrays/s.";
    }
    bool floats_at_start() const override { return true; }

    bool click(ViewState& state, const PickedPixel& pixel) override
    {
        if (!is_open || !follows_) return false;
        to_follow_ = pixel;
        state.wake();
        return false;
    }

    void update(ViewState& state) override
    {
        if (!is_open || state.panes.empty() || state.opened == 0) return;
        const Which which = wanted(state);
        if (!facts_.is_asked() &&
            (!asked_ || !(*asked_ == which) || (!facts_.error().empty() && state.time > retry_at_))) {
            asked_ = which;
            retry_at_ = state.time + 0.3;
            facts_.ask(state.session, [which](const SessionAccess& access) { return gather_facts(access, which); });
        }
        const auto facts = facts_.answer();
        const bool is_current = facts != nullptr && facts->which == which;
        if (is_current && draws_level_ && !level_.is_asked()) {
            const auto level = level_.answer();
            if (level == nullptr || !(level->which == which) || level->tree != tree_ || level->depth != depth_)
                level_.ask(state.session, [which, tree = tree_, depth = depth_](const SessionAccess& access) {
                    return gather_level(access, which, tree, depth);
                });
        }
        if (to_follow_ && is_current && !walk_.is_asked()) {
            const PickedPixel pixel = *to_follow_;
            to_follow_.reset();
            step_ = 0;
            const RenderSettings settings = state.panes[std::min(pixel.pane, state.panes.size() - 1)].request.settings;
            walk_.ask(state.session, [which, pixel, settings](const SessionAccess& access) {
                return follow_ray(access, which, pixel, settings);
            });
        }
        measure_next(state);
        if (facts_.is_asked() || level_.is_asked() || walk_.is_asked() || measured_.is_asked() ||
            !facts_.error().empty())
            state.wake();
    }

    void draw(ViewState& state) override
    {
        if (state.opened == 0) {
            paragraph("Open a scene first.");
            return;
        }
        RenderSettings& settings = state.panes[std::min(state.active_pane, state.panes.size() - 1)].request.settings;
        draw_choice(settings);
        if (const std::string error = facts_.error(); !error.empty()) warning(error);
        if (const auto facts = facts_.answer()) {
            draw_facts(*facts);
            if (ImGui::CollapsingHeader("Levels", ImGuiTreeNodeFlags_DefaultOpen)) draw_levels(*facts);
            if (ImGui::CollapsingHeader("One ray", ImGuiTreeNodeFlags_DefaultOpen)) draw_walk();
        }
        if (ImGui::CollapsingHeader("Builders", ImGuiTreeNodeFlags_DefaultOpen)) draw_builders(state, settings);
    }

    void draw_over(ViewState& state, const Pane& pane, ImDrawList& list) override
    {
        if (!is_open || state.ui_hidden) return;
        const Overlay overlay(state, pane, list);
        if (const auto level = level_.answer(); level != nullptr && draws_level_) {
            for (const auto& box : level->nodes) overlay.box(box, IM_COL32(90, 190, 255, 170), state.ui_scale);
            for (const auto& box : level->leaves) overlay.box(box, IM_COL32(255, 170, 60, 170), state.ui_scale);
        }
        const auto walk = walk_.answer();
        if (walk == nullptr || !follows_ || walk->walk.steps.empty()) return;
        const auto at = static_cast<std::size_t>(std::clamp(step_, 0, static_cast<int>(walk->walk.steps.size()) - 1));
        for (std::size_t i = 0; i < at; ++i)
            if (has_box(walk->walk.steps[i])) overlay.box(walk->boxes[i], IM_COL32(220, 220, 220, 60), state.ui_scale);
        const WalkStep& step = walk->walk.steps[at];
        const ImU32 color = step.what == WalkStep::What::leaf      ? IM_COL32(255, 170, 60, 255)
                            : step.what == WalkStep::What::skipped ? IM_COL32(230, 60, 50, 255)
                                                                   : IM_COL32(90, 190, 255, 255);
        if (has_box(step)) overlay.box(walk->boxes[at], color, 2.5f * state.ui_scale);
        overlay.line(walk->ray.origin, walk->ray.origin + walk->length * walk->ray.direction,
                     IM_COL32(255, 255, 120, 255), 2.0f * state.ui_scale);
        if (is_finite(step.best) && is_hit(walk->walk.hit))
            overlay.dot_at(walk->ray.origin + step.best * walk->ray.direction, 4.0f * state.ui_scale,
                           IM_COL32(120, 220, 120, 255));
    }

    bool set(ViewState& state, const std::string& wanted_name, const std::string& value) override
    {
        if (wanted_name == "trees.level") {
            draws_level_ = true;
            depth_ = std::max(0, std::atoi(value.c_str()));
        } else if (wanted_name == "trees.step") {
            step_ = std::max(0, std::atoi(value.c_str()));
        } else if (wanted_name == "trees.follow") {
            follows_ = value != "0";
        } else {
            return false;
        }
        state.wake();
        return true;
    }

    std::optional<std::string> get(ViewState&, const std::string& wanted_name) override
    {
        const auto facts = facts_.answer();
        const auto walk = walk_.answer();
        if (wanted_name == "trees.measured") return fmt::format("{}", rows_.size());
        if (wanted_name == "trees.mrays") return facts == nullptr ? "none" : fmt::format("{}", facts->speed.camera);
        if (wanted_name == "trees.nodes") return facts == nullptr ? "none" : fmt::format("{}", facts->stats.nodes);
        if (wanted_name == "trees.steps") return walk == nullptr ? "none" : fmt::format("{}", walk->walk.steps.size());
        return std::nullopt;
    }

  private:
    std::optional<Which> asked_;
    double retry_at_ = 0;
    bool draws_level_ = false, follows_ = true;
    int tree_ = 0, depth_ = 3, step_ = 0;
    std::optional<PickedPixel> to_follow_;
    Question<Facts> facts_;
    Question<Level> level_;
    Question<Walk> walk_;
    Question<StructureFigures> measured_;
    std::vector<std::string> queue_; // builders to be measured
    std::size_t taken_ = 0;          // answers of measured_ that are in the table
    std::vector<StructureFigures> rows_;
    std::uint64_t rows_scene_ = 0;
    std::string rows_accel_;

    static bool has_box(const WalkStep& step) { return step.what != WalkStep::What::planes && !step.box.empty(); }

    static Which wanted(const ViewState& state)
    {
        Which which;
        which.pane = std::min(state.active_pane, state.panes.size() - 1);
        const RenderSettings& settings = state.panes[which.pane].request.settings;
        which.accel = settings.accel;
        const auto builder = settings.parameters.find("builder");
        if (builder != settings.parameters.end()) which.builder = builder->second;
        which.scene = state.status.scene_version;
        return which;
    }

    static void draw_choice(RenderSettings& settings)
    {
        std::vector<std::string> accel_names, accel_help, builder_names, builder_help;
        for (const AccelInfo& info : accels())
            accel_names.emplace_back(info.name), accel_help.emplace_back(info.summary);
        for (const BuilderInfo& info : builders())
            builder_names.emplace_back(info.name), builder_help.emplace_back(info.summary);
        std::string accel = settings.accel.empty() ? accel_names.front() : settings.accel;
        if (choose("Structure", accel, accel_names, "The acceleration structure that this pane traces with",
                   accel_help))
            settings.accel = accel == accel_names.front() ? "" : accel;
        const auto found = settings.parameters.find("builder");
        std::string builder = found == settings.parameters.end() ? builder_names.front() : found->second;
        if (choose("Builder of trees", builder, builder_names, "Which algorithm makes the binary tree", builder_help))
            use(settings, builder);
    }

    static void use(RenderSettings& settings, const std::string& builder)
    {
        if (builder == builders().front().name)
            settings.parameters.erase("builder");
        else
            settings.parameters["builder"] = builder;
    }

    static void draw_facts(const Facts& facts)
    {
        fact("Built in", fmt::format("{:.1f} ms", 1e3 * facts.stats.build_seconds), "With all threads");
        fact("Memory", bytes_in_words(facts.stats.bytes), "Of the structure; the scene's own arrays are not counted");
        fact("Mrays/s", fmt::format("camera {:.2f}, bounce {:.2f}", facts.speed.camera, facts.speed.bounce),
             "Millions of rays a second of one thread: this view's camera rays, and one diffuse bounce from what they "
             "hit");
        if (!facts.has_trees) {
            paragraph("This structure has no tree that could be shown.");
            return;
        }
        fact("SAH cost", fmt::format("{:.2f}", facts.stats.sah_cost),
             "Surface area heuristic: visits of nodes that a random ray through the scene's box is expected to make");
        fact("Nodes, leaves", fmt::format("{}, {}", facts.stats.nodes, facts.stats.leaves), "Of all trees");
    }

    void draw_levels(const Facts& facts)
    {
        if (facts.trees.empty()) return;
        tree_ = std::clamp(tree_, 0, static_cast<int>(facts.trees.size()) - 1);
        if (facts.trees.size() > 1) {
            std::vector<std::string> names;
            for (const Tree& tree : facts.trees) names.push_back(tree.name);
            std::string name = names[static_cast<std::size_t>(tree_)];
            if (choose("Tree", name, names,
                       "The world's own, the one over the instances, or that of a group of meshes"))
                tree_ = static_cast<int>(std::find(names.begin(), names.end(), name) - names.begin());
        }
        const TreeFigures& figures = facts.trees[static_cast<std::size_t>(tree_)].figures;
        checkbox("Draw a level", draws_level_,
                 "Boxes of the nodes (blue) and leaves (orange) of one level over the picture");
        depth_ = std::clamp(depth_, 0, static_cast<int>(figures.levels.size()) - 1);
        if (slider("Level", depth_, 0, static_cast<int>(figures.levels.size()) - 1,
                   "Depth below the root, which has 0"))
            draws_level_ = true;
        if (const auto level = level_.answer(); level != nullptr && draws_level_ && level->count > most_boxes)
            paragraph(
                fmt::format("{} of {} boxes are drawn.", level->nodes.size() + level->leaves.size(), level->count));
        if (!ImGui::BeginTable("levels", 5, ImGuiTableFlags_Borders | ImGuiTableFlags_RowBg | ImGuiTableFlags_ScrollY,
                               ImVec2(0.0f, 8.0f * ImGui::GetTextLineHeightWithSpacing())))
            return;
        header({{"level", "Depth below the root"},
                {"nodes", "Inner nodes"},
                {"leaves", "Leaves; an instance counts as one"},
                {"primitives", "In these leaves"},
                {"area",
                 "Surface of all boxes over the root's: visits that a random ray is expected to make on this level"}});
        for (std::size_t i = 0; i < figures.levels.size(); ++i) {
            const LevelFigures& level = figures.levels[i];
            row({std::to_string(i), std::to_string(level.nodes), std::to_string(level.leaves),
                 std::to_string(level.primitives), fmt::format("{:.2f}", level.area)});
        }
        ImGui::EndTable();
    }

    void draw_walk()
    {
        checkbox("Follow clicks", follows_, "A click into the picture sends that pixel's camera ray through the tree");
        if (const std::string error = walk_.error(); !error.empty()) warning(error);
        const auto walk = walk_.answer();
        if (walk == nullptr || walk->walk.steps.empty()) {
            paragraph(
                "Click into the picture to follow that pixel's ray; then move the camera to see it from the side.");
            return;
        }
        fact("Steps", fmt::format("{}; {} nodes and primitives", walk->walk.steps.size(), walk->walk.counted),
             "In the order of the traversal");
        const int last = static_cast<int>(walk->walk.steps.size()) - 1;
        step_ = std::clamp(step_, 0, last);
        slider("Step", step_, 0, last, "The one whose box is drawn bright; those before it are faint");
        if (!ImGui::BeginTable("walk", 6, ImGuiTableFlags_Borders | ImGuiTableFlags_RowBg | ImGuiTableFlags_ScrollY,
                               ImVec2(0.0f, 10.0f * ImGui::GetTextLineHeightWithSpacing())))
            return;
        header(
            {{"step", "Number"},
             {"what",
              "Node: its children's boxes are tested. Leaf: its primitives. Skipped: behind the nearest hit by then"},
             {"enters", "Distance at which the ray enters the box"},
             {"leaves", "And leaves it; at most the nearest hit by then"},
             {"met", "Children that the ray meets, or primitives that became the nearest hit, of those tested"},
             {"nearest", "Distance of the nearest hit afterwards"}});
        for (int i = 0; i <= last; ++i) {
            const WalkStep& step = walk->walk.steps[static_cast<std::size_t>(i)];
            ImGui::TableNextRow();
            ImGui::TableNextColumn();
            const std::string label = std::to_string(i);
            if (ImGui::Selectable(label.c_str(), i == step_, ImGuiSelectableFlags_SpanAllColumns)) step_ = i;
            const auto cell = [](const std::string& text) {
                ImGui::TableNextColumn();
                ImGui::TextUnformatted(text.c_str());
            };
            cell(std::string(word_of(step.what)));
            cell(fmt::format("{:.4g}", step.enter));
            cell(fmt::format("{:.4g}", step.leave));
            cell(step.tested > 0 ? fmt::format("{} of {}", step.met, step.tested) : "");
            cell(is_finite(step.best) ? fmt::format("{:.4g}", step.best) : "none");
        }
        ImGui::EndTable();
    }

    // One builder after the other: between them pictures go on being refined.
    void measure_next(ViewState& state)
    {
        if (measured_.count() > taken_) {
            taken_ = measured_.count();
            if (const auto row = measured_.answer(); row != nullptr && measured_.error().empty()) rows_.push_back(*row);
        }
        if (queue_.empty() || measured_.is_asked()) return;
        const std::string builder = queue_.front();
        queue_.erase(queue_.begin());
        const std::size_t pane = std::min(state.active_pane, state.panes.size() - 1);
        measured_.ask(state.session, [pane, builder, accel = rows_accel_](const SessionAccess& access) {
            if (pane >= access.prepared.size() || access.prepared[pane] == nullptr)
                throw Error("the scene is not ready yet");
            const Prepared& prepared = *access.prepared[pane];
            const ViewRays rays = make_view_rays(prepared, access.camera, access.panes[pane].settings, rays_of_set);
            return measure_structure(prepared, accel, builder, rays, burst_seconds);
        });
    }

    void draw_builders(ViewState& state, RenderSettings& settings)
    {
        if (rows_scene_ != state.status.scene_version) rows_.clear();
        if (button("Measure all builders",
                   "Builds the tree with each of them and traces this view's rays: pictures wait meanwhile")) {
            rows_.clear();
            rows_scene_ = state.status.scene_version;
            rows_accel_ = settings.accel.empty() || settings.accel == "brute" || settings.accel == "embree"
                              ? std::string(accels().front().name)
                              : settings.accel;
            queue_.clear();
            for (const BuilderInfo& info : builders()) queue_.emplace_back(info.name);
        }
        if (const std::string error = measured_.error(); !error.empty()) warning(error);
        if (!queue_.empty() || measured_.is_asked()) paragraph(fmt::format("measuring: {} to go", queue_.size() + 1));
        if (rows_.empty()) return;
        if (!ImGui::BeginTable(
                "builders", 10,
                ImGuiTableFlags_Borders | ImGuiTableFlags_RowBg | ImGuiTableFlags_ScrollX |
                    ImGuiTableFlags_SizingFixedFit,
                ImVec2(0.0f, static_cast<float>(rows_.size() + 3) * ImGui::GetTextLineHeightWithSpacing())))
            return;
        header({{"builder", "Click one to use it"},
                {"build ms", "With all threads"},
                {"memory", "Of the structure"},
                {"SAH", "Surface area heuristic, of the binary tree"},
                {"EPO", "End-point overlap (Aila, Karras, Laine 2013): surface in boxes that it does not belong to"},
                {"nodes", "Of the structure"},
                {"leaves", "Of the structure"},
                {"depth", "Of the binary tree's deepest leaf"},
                {"camera", "Mrays/s of one thread, camera rays of this view"},
                {"bounce", "Mrays/s of one thread, one diffuse bounce"}});
        const auto used = settings.parameters.find("builder");
        for (const StructureFigures& one : rows_) {
            ImGui::TableNextRow();
            ImGui::TableNextColumn();
            const bool is_used =
                one.builder == (used == settings.parameters.end() ? builders().front().name : used->second);
            if (ImGui::Selectable(one.builder.c_str(), is_used, ImGuiSelectableFlags_SpanAllColumns))
                use(settings, one.builder);
            name_item("use " + one.builder);
            const auto cell = [](const std::string& text) {
                ImGui::TableNextColumn();
                ImGui::TextUnformatted(text.c_str());
            };
            cell(fmt::format("{:.1f}", 1e3 * one.build_seconds));
            cell(bytes_in_words(one.stats.bytes));
            cell(fmt::format("{:.2f}", one.quality.sum.sah));
            cell(one.has_epo ? fmt::format("{:.2f}", one.quality.sum.epo) : "-");
            cell(std::to_string(one.stats.nodes));
            cell(std::to_string(one.stats.leaves));
            cell(std::to_string(one.quality.sum.depth));
            cell(fmt::format("{:.2f}", one.speed.camera));
            cell(fmt::format("{:.2f}", one.speed.bounce));
        }
        ImGui::EndTable();
    }

    struct Column
    {
        const char *name, *help;
    };
    static void header(std::initializer_list<Column> columns)
    {
        ImGui::TableSetupScrollFreeze(0, 1);
        for (const Column& column : columns) ImGui::TableSetupColumn(column.name);
        ImGui::TableNextRow(ImGuiTableRowFlags_Headers);
        int i = 0;
        for (const Column& column : columns) {
            ImGui::TableSetColumnIndex(i++);
            ImGui::TableHeader(column.name);
            tip(column.help);
        }
    }
    static void row(std::initializer_list<std::string> cells)
    {
        ImGui::TableNextRow();
        for (const std::string& text : cells) {
            ImGui::TableNextColumn();
            ImGui::TextUnformatted(text.c_str());
        }
    }
};
} // namespace

std::unique_ptr<Panel> make_bvh_panel()
{
    return std::make_unique<BvhPanel>();
}

} // namespace snell::view
