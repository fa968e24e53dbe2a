// All parts of the scene by name; what is chosen is edited in the inspector.
#include "snell/core/error.h"
#include "snell/view/fields.h"
#include "snell/view/panel.h"
#include "snell/view/widgets.h"

#include <imgui.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <cstring>

namespace snell::view {
namespace {

using Kind = Selection::Kind;

bool contains(const std::string& text, const std::string& part)
{
    const auto same = [](char a, char b) {
        return std::tolower(static_cast<unsigned char>(a)) == std::tolower(static_cast<unsigned char>(b));
    };
    return std::search(text.begin(), text.end(), part.begin(), part.end(), same) != text.end();
}

class SceneTreePanel final : public Panel
{
  public:
    const char* name() const override { return "Scene"; }
    const char* help() const override
    {
        return "The scene graph: nodes, instances, meshes, materials, lights and cameras. Edits can be undone, and "
               "saved "
               "as pbrt.";
    }
    bool opens_at_start() const override { return true; }
    void draw(ViewState& state) override;
    void update(ViewState& state) override { state.document.follow(state); }
    bool click(ViewState& state, const PickedPixel& pixel) override
    {
        state.document.select_at(state, pixel.pane, pixel.x, pixel.y);
        return false; // others may want it as well
    }
    bool set(ViewState& state, const std::string& what, const std::string& value) override;
    std::optional<std::string> get(ViewState& state, const std::string& what) override;

  private:
    // Numbers of those parts of one kind whose names have the filter in them.
    struct List
    {
        const char* label;
        Kind kind;
        std::vector<uint> shown;
    };
    void refresh(const ViewState& state);
    void draw_buttons(ViewState& state);
    void draw_file(ViewState& state);
    void draw_list(ViewState& state, List& list);
    void draw_node(ViewState& state, uint node);
    void draw_item(ViewState& state, Selection item);
    void add_light(ViewState& state, uint kind);

    std::string filter_, refreshed_filter_;
    std::uint64_t refreshed_opened_ = 0, refreshed_state_ = 0;
    std::array<List, 7> lists_ = {List{"Materials", Kind::material, {}}, List{"Lights", Kind::light, {}},
                                  List{"Cameras", Kind::camera, {}},     List{"Instances", Kind::instance, {}},
                                  List{"Meshes", Kind::mesh, {}},        List{"Spheres", Kind::sphere, {}},
                                  List{"Planes", Kind::plane, {}}};
    // By node: what hangs on it.
    std::vector<std::vector<uint>> children_, instances_, lights_, cameras_;
    std::vector<uint> roots_;
    std::string file_;
    bool overwrites_ = false;
};

} // namespace

static std::size_t count_of(const Scene& scene, Kind kind)
{
    switch (kind) {
    case Kind::material:
        return scene.materials.size();
    case Kind::light:
        return scene.lights.size();
    case Kind::camera:
        return scene.cameras.size();
    case Kind::instance:
        return scene.instances.size();
    case Kind::mesh:
        return scene.meshes.size();
    case Kind::sphere:
        return scene.spheres.size();
    case Kind::plane:
        return scene.planes.size();
    case Kind::node:
        return scene.nodes.size();
    default:
        return 0;
    }
}

static const std::string& plain_name(const Scene& scene, Selection s)
{
    static const std::string empty;
    switch (s.kind) {
    case Kind::material:
        return scene.materials[s.index].name;
    case Kind::light:
        return scene.lights[s.index].name;
    case Kind::camera:
        return scene.cameras[s.index].name;
    case Kind::instance:
        return scene.instances[s.index].name;
    case Kind::mesh:
        return scene.meshes[s.index].name;
    case Kind::sphere:
        return scene.spheres[s.index].name;
    case Kind::plane:
        return scene.planes[s.index].name;
    case Kind::node:
        return scene.nodes[s.index].name;
    default:
        return empty;
    }
}

// Looks at all names only when one of them, or the filter, may have changed: a scene can have a million instances.
void SceneTreePanel::refresh(const ViewState& state)
{
    const std::uint64_t edited = state.document.history().state();
    const bool is_new = refreshed_opened_ != state.opened;
    if (!is_new && refreshed_state_ == edited && refreshed_filter_ == filter_) return;
    refreshed_opened_ = state.opened;
    refreshed_state_ = edited;
    refreshed_filter_ = filter_;
    const Scene& scene = state.outline;
    for (List& list : lists_) {
        list.shown.clear();
        const std::size_t count = count_of(scene, list.kind);
        for (uint i = 0; i < count; ++i)
            if (filter_.empty() || contains(plain_name(scene, {list.kind, i}), filter_)) list.shown.push_back(i);
    }
    for (auto* by_node : {&children_, &instances_, &lights_, &cameras_}) {
        by_node->clear();
        by_node->resize(scene.nodes.size());
    }
    roots_.clear();
    for (uint i = 0; i < scene.nodes.size(); ++i) {
        const Index<Node> parent = scene.nodes[i].parent;
        (parent.valid() ? children_[parent.value] : roots_).push_back(i);
    }
    const auto hang = [](const auto& all, std::vector<std::vector<uint>>& by_node) {
        for (uint i = 0; i < all.size(); ++i)
            if (all[i].node.valid()) by_node[all[i].node.value].push_back(i);
    };
    hang(scene.instances, instances_);
    hang(scene.lights, lights_);
    hang(scene.cameras, cameras_);
}

// ---- what is drawn ----

void SceneTreePanel::draw_item(ViewState& state, Selection item)
{
    const Scene& scene = state.outline;
    ImGui::PushID(static_cast<int>(item.kind));
    ImGui::PushID(static_cast<int>(item.index));
    if (item.kind == Kind::material) {
        const MaterialDesc& m = scene.materials[item.index];
        const vec3 shown = is_black(m.emission) ? m.base_color : m.emission / max3(m.emission);
        ImGui::ColorButton("##colour", ImVec4(shown.x, shown.y, shown.z, 1.0f),
                           ImGuiColorEditFlags_NoTooltip | ImGuiColorEditFlags_NoPicker,
                           ImVec2(ImGui::GetFontSize(), ImGui::GetFontSize()));
        ImGui::SameLine();
    }
    const std::string name = shown_name(plain_name(scene, item), item.index);
    if (ImGui::Selectable(name.c_str(), state.document.selection == item)) state.document.selection = item;
    name_item(name);
    tip(name_of(scene, item) + ": select it, to edit it in the inspector.");
    ImGui::PopID();
    ImGui::PopID();
}

void SceneTreePanel::draw_list(ViewState& state, List& list)
{
    const std::size_t count = count_of(state.outline, list.kind);
    if (count == 0) return;
    const std::string label = filter_.empty()
                                  ? fmt::format("{} ({})###{}", list.label, count, list.label)
                                  : fmt::format("{} ({} of {})###{}", list.label, list.shown.size(), count, list.label);
    const bool unfolded = ImGui::TreeNodeEx(label.c_str(), ImGuiTreeNodeFlags_SpanAvailWidth);
    name_item(list.label);
    tip("Opens the list of these parts of the scene.");
    if (!unfolded) return;
    ImGuiListClipper clipper;
    clipper.Begin(static_cast<int>(list.shown.size()));
    while (clipper.Step())
        for (int i = clipper.DisplayStart; i < clipper.DisplayEnd; ++i)
            draw_item(state, {list.kind, list.shown[static_cast<std::size_t>(i)]});
    ImGui::TreePop();
}

void SceneTreePanel::draw_node(ViewState& state, uint node)
{
    const Selection item{Kind::node, node};
    const std::string name = shown_name(state.outline.nodes[node].name, node);
    ImGuiTreeNodeFlags flags = ImGuiTreeNodeFlags_OpenOnArrow | ImGuiTreeNodeFlags_SpanAvailWidth;
    if (state.document.selection == item) flags |= ImGuiTreeNodeFlags_Selected;
    if (children_[node].empty() && instances_[node].empty() && lights_[node].empty() && cameras_[node].empty())
        flags |= ImGuiTreeNodeFlags_Leaf;
    ImGui::PushID(static_cast<int>(node));
    const bool unfolded = ImGui::TreeNodeEx(name.c_str(), flags);
    if (ImGui::IsItemClicked() && !ImGui::IsItemToggledOpen()) state.document.selection = item;
    name_item(name);
    tip("A node of the hierarchy: moving it moves all that hangs on it.");
    if (unfolded) {
        for (const uint i : instances_[node]) draw_item(state, {Kind::instance, i});
        for (const uint i : lights_[node]) draw_item(state, {Kind::light, i});
        for (const uint i : cameras_[node]) draw_item(state, {Kind::camera, i});
        for (const uint child : children_[node]) draw_node(state, child);
        ImGui::TreePop();
    }
    ImGui::PopID();
}

void SceneTreePanel::add_light(ViewState& state, uint kind)
{
    static constexpr std::array names = {"point light", "sun", "spot"};
    LightDesc light;
    light.kind = kind;
    light.name = names[kind];
    // Beside the camera, where it certainly lights something; as bright as a surface there can use.
    const vec3 view = state.camera.target - state.camera.eye;
    const float distance = std::max(length(view), 1e-3f);
    light.position = state.camera.eye + 0.2f * distance * normalize(state.camera.up);
    light.direction = normalize(view);
    light.emission = vec3(kind == light_directional ? 3.0f : 3.0f * distance * distance);
    const uint at = static_cast<uint>(state.outline.lights.size());
    if (state.document.apply(state, {AddLight{at, light}}, "light added")) state.document.selection = {Kind::light, at};
}

void SceneTreePanel::draw_buttons(ViewState& state)
{
    Document& document = state.document;
    const std::string* undo = document.history().undo_label();
    const std::string* redo = document.history().redo_label();
    ImGui::BeginDisabled(undo == nullptr);
    if (button("Undo", undo != nullptr ? ("Undoes: " + *undo).c_str() : "There is nothing to undo."))
        document.undo(state);
    ImGui::EndDisabled();
    ImGui::SameLine();
    ImGui::BeginDisabled(redo == nullptr);
    if (button("Redo", redo != nullptr ? ("Does again: " + *redo).c_str() : "There is nothing to do again."))
        document.redo(state);
    ImGui::EndDisabled();
    ImGui::SameLine();
    if (button("Copy",
               "The selection (a material, a light, a camera, the environment) or, if there is none of these, the "
               "whole scene, as pbrt text to the clipboard."))
        document.copy(state);
    if (button("+ Point light", "Adds an isotropic point light, near the camera.")) add_light(state, light_point);
    ImGui::SameLine();
    if (button("+ Sun", "Adds a directional light, along the view.")) add_light(state, light_directional);
    ImGui::SameLine();
    if (button("+ Spot", "Adds a spot light, along the view.")) add_light(state, light_spot);
    ImGui::SameLine();
    if (button("+ Camera", "Adds a camera that sees what the window shows.")) {
        const uint at = static_cast<uint>(state.outline.cameras.size());
        CameraDesc camera = state.camera;
        camera.name = fmt::format("view {}", at);
        camera.node = {};
        if (document.apply(state, {AddCamera{at, camera}}, "camera added")) document.selection = {Kind::camera, at};
    }
}

void SceneTreePanel::draw_file(ViewState& state)
{
    Document& document = state.document;
    if (file_.empty() && !document.file().empty()) file_ = document.file().string();
    text("Save as", file_, "A .pbrt file: the scene as it is now, seen as the window shows it.", "scene.pbrt");
    checkbox("Overwrite", overwrites_, "Also a file that snell has not written itself.");
    ImGui::BeginDisabled(document.is_saving() || file_.empty());
    if (button(document.is_saving() ? "Saving ..." : "Save",
               "Writes the scene in pbrt's format, atomically: all or none."))
        document.save(state, file_, overwrites_);
    ImGui::EndDisabled();
    if (document.is_dirty()) {
        ImGui::SameLine();
        ImGui::TextDisabled("changed since it was read or saved");
    }
}

void SceneTreePanel::draw(ViewState& state)
{
    if (!state.document.is_ready()) {
        paragraph("No scene is open yet.");
        return;
    }
    refresh(state);
    draw_buttons(state);
    text("Filter", filter_, "Shows only what has this in its name. Enter takes it over.", "part of a name");
    // In a window of its own it takes what there is.
    const float rest = ImGui::GetContentRegionAvail().y - 2.5f * ImGui::GetFontSize();
    ImGui::BeginChild(
        "tree", ImVec2(0.0f, is_floating ? std::max(rest, 9.0f * ImGui::GetFontSize()) : 11.0f * ImGui::GetFontSize()));
    if (ImGui::Selectable("Environment", state.document.selection.kind == Kind::environment))
        state.document.selection = {Kind::environment, 0};
    name_item("Environment");
    tip("Light from infinitely far away: image-based lighting, or a constant sky.");
    for (List& list : lists_) draw_list(state, list);
    if (!roots_.empty()) {
        const bool unfolded = ImGui::TreeNodeEx(fmt::format("Nodes ({})###Nodes", state.outline.nodes.size()).c_str(),
                                                ImGuiTreeNodeFlags_SpanAvailWidth);
        name_item("Nodes");
        tip("The hierarchy of transforms (scene graph) that animations move.");
        if (unfolded) {
            for (const uint root : roots_) draw_node(state, root);
            ImGui::TreePop();
        }
    }
    ImGui::EndChild();
    if (ImGui::CollapsingHeader("File")) draw_file(state);
    name_item("File");
}

// ---- scripts ----

bool SceneTreePanel::set(ViewState& state, const std::string& what, const std::string& value)
{
    static constexpr std::pair<const char*, Kind> kinds[] = {
        {"material", Kind::material}, {"mesh", Kind::mesh}, {"sphere", Kind::sphere}, {"plane", Kind::plane},
        {"instance", Kind::instance}, {"node", Kind::node}, {"light", Kind::light},   {"camera", Kind::camera}};
    if (what == "save") {
        state.document.save(state, value, true);
        return true;
    }
    if (what == "filter") {
        filter_ = value;
        return true;
    }
    if (what != "select") return false;
    if (value == "environment") {
        state.document.selection = {Kind::environment, 0};
        return true;
    }
    for (const auto& [word, kind] : kinds)
        if (value.rfind(std::string(word) + " ", 0) == 0) {
            const std::string name = value.substr(std::strlen(word) + 1);
            for (uint i = 0; i < count_of(state.outline, kind); ++i)
                if (shown_name(plain_name(state.outline, {kind, i}), i) == name || std::to_string(i) == name) {
                    state.document.selection = {kind, i};
                    return true;
                }
        }
    throw Error(fmt::format("there is no '{}' in the scene", value),
                "select 'environment', or 'material NAME', 'light NAME', ...");
}

std::optional<std::string> SceneTreePanel::get(ViewState& state, const std::string& what)
{
    const Document& document = state.document;
    if (what == "selection") return name_of(state.outline, document.selection);
    if (what == "undo") return document.history().undo_label() != nullptr ? *document.history().undo_label() : "";
    if (what == "redo") return document.history().redo_label() != nullptr ? *document.history().redo_label() : "";
    if (what == "dirty") return document.is_dirty() ? "1" : "0";
    if (what == "saving") return document.is_saving() ? "1" : "0";
    if (what == "lights") return std::to_string(state.outline.lights.size());
    if (what == "base_red" && document.selection.kind == Kind::material)
        return fmt::format("{:.3f}", state.outline.materials[document.selection.index].base_color.x);
    return std::nullopt;
}

std::unique_ptr<Panel> make_scene_tree_panel()
{
    return std::make_unique<SceneTreePanel>();
}

} // namespace snell::view
