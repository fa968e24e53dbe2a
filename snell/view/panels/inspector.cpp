// The editor of what is selected.
#include "snell/scene/keyframes.h"
#include "snell/view/panel.h"
#include "snell/view/panels/material_editor.h"
#include "snell/view/panels/transform_editor.h"
#include "snell/view/widgets.h"

#include <fmt/format.h>
#include <imgui.h>

#include <array>
#include <cmath>
#include <cstring>

namespace snell::view {
namespace {

class InspectorPanel final : public Panel
{
  public:
    const char* name() const override { return "Inspector"; }
    const char* help() const override
    {
        return "Edits what is selected: materials (BSDFs), lights, cameras, transforms, the environment.";
    }
    bool opens_at_start() const override { return true; }
    void draw(ViewState& state) override;

  private:
    void draw_selected(ViewState& state);
    void draw_name(ViewState& state, ScenePart part, const std::string& name);
    void draw_material(ViewState& state, uint index);
    void draw_mesh(ViewState& state, uint index);
    void draw_sphere(ViewState& state, uint index);
    void draw_plane(ViewState& state, uint index);
    void draw_instance(ViewState& state, uint index);
    void draw_node(ViewState& state, uint index);
    void draw_light(ViewState& state, uint index);
    void draw_camera(ViewState& state, uint index);
    void draw_environment(ViewState& state);
    // "apply" with what the selection is called as the label.
    void apply(ViewState& state, Edit edit, const Fields& fields)
    {
        if (!fields.changed()) return;
        state.document.apply(state, {std::move(edit)}, name_of(state.outline, state.document.selection),
                             fields.control());
    }
    float step(const ViewState& state) const
    {
        const float size = length(state.bounds.extent());
        return state.bounds.empty() || !(size > 0.0f) ? 0.01f : 0.001f * size;
    }

    TransformEditor transform_;
    std::string picture_, typed_name_;
    Selection named_;
};

// One line of what the selection has to do with the rest, as a link.
bool link(const char* label, const std::string& name, const char* help)
{
    fact(label, "", nullptr);
    ImGui::SameLine();
    const bool pressed = ImGui::SmallButton((name + "##" + label).c_str());
    name_item(label);
    tip(help);
    return pressed;
}

} // namespace

void InspectorPanel::draw_name(ViewState& state, ScenePart part, const std::string& name)
{
    const Selection selection = state.document.selection;
    if (!(selection == named_)) typed_name_ = name, named_ = selection;
    const bool finished = text("Name", typed_name_, "What it is called here and in files. Enter takes it over.");
    if (!ImGui::IsItemActive() && !finished) typed_name_ = name;
    if (finished && typed_name_ != name)
        state.document.apply(state, {Rename{part, selection.index, typed_name_}}, "name");
}

// ---- materials, and what has them ----

void InspectorPanel::draw_material(ViewState& state, uint index)
{
    Document& document = state.document;
    draw_name(state, ScenePart::material, state.outline.materials[index].name);
    if (button("Duplicate", "Adds a copy of this material to the scene, to be assigned to something.")) {
        MaterialDesc copy = state.outline.materials[index];
        copy.name = shown_name(copy.name, index) + " copy";
        if (document.apply(state, {AddMaterial{copy}}, "copy of a material"))
            document.selection.index = static_cast<uint>(state.outline.materials.size() - 1);
        return;
    }
    SetMaterial set{{index}, state.outline.materials[index]};
    Fields fields;
    edit_material(fields, set.value, state.outline);
    apply(state, set, fields);
    if (ImGui::CollapsingHeader("Add a texture")) {
        text("Texture file", picture_, "A picture to read into the scene, for the maps above.", "picture.png");
        const bool colors = button("Read as colours", "Decoded from sRGB: for albedo, emission, tints.");
        ImGui::SameLine();
        const bool numbers = button("Read as numbers", "Not decoded: for normals, roughness, opacity.");
        if ((colors || numbers) && !picture_.empty()) document.load_texture(state, picture_, colors);
    }
}

void InspectorPanel::draw_mesh(ViewState& state, uint index)
{
    Document& document = state.document;
    const Mesh& mesh = state.outline.meshes[index];
    draw_name(state, ScenePart::mesh, mesh.name);
    if (index < document.meshes().size()) {
        const MeshFigures& f = document.meshes()[index];
        fact("Triangles", fmt::format("{}", f.triangles));
        fact("Vertices", fmt::format("{}", f.vertices), "Where corners meet; neighbours share them.");
        fact("Attributes",
             fmt::format("{}{}{}{}{}", f.has_normals ? "normals " : "", f.has_uvs ? "uv " : "",
                         f.has_tangents ? "tangents " : "", f.has_colors ? "colours " : "", f.is_rigged ? "rig" : ""),
             "What its vertices have beside a position.");
        if (!f.bounds.empty())
            fact("Size",
                 fmt::format("{:.4g} x {:.4g} x {:.4g}", f.bounds.extent().x, f.bounds.extent().y, f.bounds.extent().z),
                 "Of its bounding box, in its own space.");
    }
    std::vector<Index<MaterialDesc>> materials = mesh.triangle_materials;
    if (materials.empty()) materials = {mesh.material};
    for (std::size_t i = 0; i < materials.size(); ++i) {
        if (!materials[i].valid()) continue;
        ImGui::PushID(static_cast<int>(i));
        Index<MaterialDesc> chosen = materials[i];
        Fields fields;
        fields.material(i == 0 ? "Material" : "And", chosen, state.outline, "What its surface is made of (BSDF).");
        if (fields.changed() && chosen != materials[i])
            document.apply(state, {AssignMaterial{{index}, materials[i], chosen}}, "material of a mesh");
        ImGui::SameLine();
        if (ImGui::SmallButton("edit")) document.selection = {Selection::Kind::material, materials[i].value};
        tip("Selects this material.");
        ImGui::PopID();
    }
}

void InspectorPanel::draw_sphere(ViewState& state, uint index)
{
    draw_name(state, ScenePart::sphere, state.outline.spheres[index].name);
    SetSphere set{{index}, state.outline.spheres[index]};
    Fields fields;
    fields.vector("Centre", set.value.center, step(state), "In the space of its group.");
    fields.drag("Radius", set.value.radius, step(state), 1e-6f, 1e9f, "Of the sphere, in the space of its group.");
    fields.material("Material", set.value.material, state.outline, "What its surface is made of (BSDF).");
    apply(state, set, fields);
    if (link("Edit", "its material", "Selects the material."))
        state.document.selection = {Selection::Kind::material, state.outline.spheres[index].material.value};
}

void InspectorPanel::draw_plane(ViewState& state, uint index)
{
    draw_name(state, ScenePart::plane, state.outline.planes[index].name);
    SetPlane set{index, state.outline.planes[index]};
    Fields fields;
    fields.vector("Point", set.value.point, step(state), "A point that the infinite plane goes through.");
    fields.vector("Normal", set.value.normal, 0.01f, "Perpendicular to it; of any length.");
    fields.material("Material", set.value.material, state.outline, "What its surface is made of (BSDF).");
    apply(state, set, fields);
    if (link("Edit", "its material", "Selects the material."))
        state.document.selection = {Selection::Kind::material, state.outline.planes[index].material.value};
}

// ---- what is placed ----

void InspectorPanel::draw_instance(ViewState& state, uint index)
{
    const InstanceDesc& instance = state.outline.instances[index];
    draw_name(state, ScenePart::instance, instance.name);
    const Group& group = state.outline.groups[instance.group.value];
    if (instance.node.valid()) {
        if (link("Hangs on", shown_name(state.outline.nodes[instance.node.value].name, instance.node.value),
                 "The node of the hierarchy that places it: move that."))
            state.document.selection = {Selection::Kind::node, instance.node.value};
    } else {
        SetTransform set{index, instance.transform};
        Fields fields;
        transform_.edit(fields, set.value, step(state), (std::uint64_t{1} << 32) | index);
        apply(state, set, fields);
    }
    constexpr std::size_t most = 50;
    std::size_t shown = 0;
    for (const Index<Mesh> mesh : group.meshes) {
        if (shown++ == most) break;
        ImGui::PushID(static_cast<int>(shown));
        if (link("Mesh", shown_name(state.outline.meshes[mesh.value].name, mesh.value), "Selects the mesh."))
            state.document.selection = {Selection::Kind::mesh, mesh.value};
        ImGui::PopID();
    }
    for (const Index<SphereDesc> sphere : group.spheres) {
        if (shown++ >= most) break;
        ImGui::PushID(static_cast<int>(shown));
        if (link("Sphere", shown_name(state.outline.spheres[sphere.value].name, sphere.value), "Selects the sphere."))
            state.document.selection = {Selection::Kind::sphere, sphere.value};
        ImGui::PopID();
    }
    if (group.meshes.size() + group.spheres.size() > most)
        fact("", fmt::format("and {} more", group.meshes.size() + group.spheres.size() - most));
}

void InspectorPanel::draw_node(ViewState& state, uint index)
{
    const Node& node = state.outline.nodes[index];
    draw_name(state, ScenePart::node, node.name);
    if (node.posed) paragraph("An animation moves it: what is edited here is its place at rest.");
    SetNode set{{index}, node};
    Fields fields;
    if (node.has_matrix) {
        transform_.edit(fields, set.value.matrix, step(state), (std::uint64_t{2} << 32) | index);
    } else {
        Transform local = compose_trs(node.translation, unit_quaternion(node.rotation), node.scale);
        transform_.edit(fields, local, step(state), (std::uint64_t{2} << 32) | index);
        if (fields.changed()) {
            if (const std::optional<TransformParts> parts = take_apart(local)) {
                set.value.translation = parts->translation;
                set.value.scale = parts->scale;
                set.value.rotation = quaternion_of(parts->degrees);
            }
        }
    }
    for (std::size_t i = 0; i < set.value.weights.size(); ++i)
        fields.slide(fmt::format("Weight {}", i).c_str(), set.value.weights[i], -1.0f, 1.0f,
                     "How much of this morph target (blend shape) is added at rest.");
    apply(state, set, fields);
}

// ---- lights, cameras, the environment ----

void InspectorPanel::draw_light(ViewState& state, uint index)
{
    static constexpr std::array kinds = {"point", "directional", "spot"};
    draw_name(state, ScenePart::light, state.outline.lights[index].name);
    SetLight set{index, state.outline.lights[index]};
    LightDesc& l = set.value;
    Fields fields;
    fields.choice("Kind", l.kind, kinds, "A point light, a directional one (the sun), or a spot with a cone.");
    fields.light("Emission", l.emission,
                 l.kind == light_directional ? "Irradiance on a surface that faces it, W/m2." : "Intensity, W/sr.");
    if (l.node.valid()) {
        if (link("Hangs on", shown_name(state.outline.nodes[l.node.value].name, l.node.value),
                 "The node of the hierarchy that places and turns it: move that."))
            state.document.selection = {Selection::Kind::node, l.node.value};
    } else {
        if (l.kind != light_directional) fields.vector("Position", l.position, step(state), "Where it is.");
        if (l.kind != light_point) fields.vector("Direction", l.direction, 0.01f, "The way its light travels.");
    }
    if (l.kind == light_spot) {
        fields.slide("Inner angle", l.inner_degrees, 0.0f, 180.0f,
                     "Half angle of the cone of full intensity, degrees.");
        fields.slide("Outer angle", l.outer_degrees, 0.1f, 180.0f, "Half angle beyond which it is dark, degrees.");
    }
    apply(state, set, fields);
    if (button("Remove", "Takes this light out of the scene."))
        if (state.document.apply(state, {RemoveLight{index}}, "light removed")) state.document.selection = {};
}

void InspectorPanel::draw_camera(ViewState& state, uint index)
{
    draw_name(state, ScenePart::camera, state.outline.cameras[index].name);
    const CameraDesc before = state.outline.cameras[index];
    if (button("Look through", "Shows what this camera sees.")) state.look(before);
    SetCamera set{index, before};
    Fields fields;
    if (before.node.valid()) {
        if (link("Hangs on", shown_name(state.outline.nodes[before.node.value].name, before.node.value),
                 "The node of the hierarchy that carries it: move that."))
            state.document.selection = {Selection::Kind::node, before.node.value};
    } else {
        ImGui::SameLine();
        if (button("Take the view", "Puts this camera where the window looks from.")) {
            set.value = state.camera;
            set.value.name = before.name;
            fields.touch("view");
        }
        fields.vector("Camera eye", set.value.eye, step(state), "Where the camera is: the centre of projection.");
        fields.vector("Camera target", set.value.target, step(state), "What it looks at.");
        fields.vector("Camera up", set.value.up, 0.01f, "Which way is up in the picture.");
    }
    fields.slide("Camera fov", set.value.fov_degrees, 1.0f, 170.0f, "Full angle of the shorter side, degrees.");
    apply(state, set, fields);
    if (state.outline.cameras.size() > 1 && button("Remove", "Takes this camera out of the scene."))
        if (state.document.apply(state, {RemoveCamera{index}}, "camera removed")) state.document.selection = {};
}

// A rotation around +Y; what the map's picture brings along is `upright`, see set_environment().
static Transform upright_of(uint mapping)
{
    return mapping == environment_octahedral ? rotation(vec3(1, 0, 0), -90.0f) : identity_transform();
}

void InspectorPanel::draw_environment(ViewState& state)
{
    static constexpr std::array mappings = {"latitude-longitude", "octahedral"};
    SetEnvironment set{state.outline.environment};
    EnvironmentDesc& e = set.value;
    Fields fields;
    fields.light("Radiance", e.radiance, e.image.valid() ? "What the picture is multiplied with." : "From all sides.");
    fields.image("Picture", e.image, state.outline, "An environment map; none: the same light from everywhere.");
    if (e.image.valid()) {
        fields.choice("Mapping", e.mapping, mappings, "How the sphere of directions lies in the picture.");
        const Transform turned = compose(e.to_world, *inverse(upright_of(e.mapping)));
        float degrees = std::atan2(turned.z.x, turned.x.x) * (180.0f / 3.14159265f);
        const float before = degrees;
        Fields turn;
        turn.slide("Rotation", degrees, -180.0f, 180.0f, "Turns it about the vertical, degrees.");
        if (turn.changed()) {
            // Only about +Y: made anew, so that nothing adds up. Else turned on.
            const bool is_level = std::abs(turned.y.y - 1.0f) < 1e-4f && determinant(turned) > 0.0f;
            e.to_world = is_level ? compose(rotation(vec3(0, 1, 0), -degrees), upright_of(e.mapping))
                                  : compose(rotation(vec3(0, 1, 0), before - degrees), e.to_world);
            fields.touch("rotation");
        }
    }
    fields.flag("Visible", e.visible, "Whether the camera sees it; it lights the scene all the same.");
    apply(state, set, fields);
    text("Picture file", picture_, "An environment map to read: .exr, .hdr, .png, ...", "sky.exr");
    if (button("Read picture", "Reads the picture, and lights the scene with it.") && !picture_.empty())
        state.document.load_environment(state, picture_);
}

// ---- all of it ----

void InspectorPanel::draw_selected(ViewState& state)
{
    const Selection s = state.document.selection;
    switch (s.kind) {
    case Selection::Kind::material:
        return draw_material(state, s.index);
    case Selection::Kind::mesh:
        return draw_mesh(state, s.index);
    case Selection::Kind::sphere:
        return draw_sphere(state, s.index);
    case Selection::Kind::plane:
        return draw_plane(state, s.index);
    case Selection::Kind::instance:
        return draw_instance(state, s.index);
    case Selection::Kind::node:
        return draw_node(state, s.index);
    case Selection::Kind::light:
        return draw_light(state, s.index);
    case Selection::Kind::camera:
        return draw_camera(state, s.index);
    case Selection::Kind::environment:
        return draw_environment(state);
    case Selection::Kind::nothing:
        paragraph("Nothing is selected. Click something in the picture, or choose it in the scene tree.");
    }
}

void InspectorPanel::draw(ViewState& state)
{
    Document& document = state.document;
    if (!document.is_ready()) {
        paragraph("No scene is open yet.");
        return;
    }
    const Selection s = document.selection;
    if (s.kind != Selection::Kind::nothing) paragraph(name_of(state.outline, s));
    const Selection hit = document.hit_instance;
    if (s.kind == Selection::Kind::material && hit.kind == Selection::Kind::instance) {
        if (link("Part of", shown_name(state.outline.instances[hit.index].name, hit.index),
                 "The instance that the click has hit: select it to move it."))
            document.selection = hit;
    }
    ImGui::Separator();
    ImGui::PushID(static_cast<int>(s.kind));
    ImGui::PushID(static_cast<int>(s.index));
    draw_selected(state);
    ImGui::PopID();
    ImGui::PopID();
}

std::unique_ptr<Panel> make_inspector_panel()
{
    return std::make_unique<InspectorPanel>();
}

} // namespace snell::view
