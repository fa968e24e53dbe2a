#include "snell/scene/edit.h"

#include "snell/core/error.h"
#include "snell/scene/validate_material.h"
#include "snell/scene/validate_mesh.h"
#include "snell/scene/validate_parts.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace snell {

// ---- what is refused ----

static void check_number(const char* what, std::size_t number, std::size_t count)
{
    if (number >= count) throw Error(fmt::format("there is no {} {}: the scene has {}", what, number, count));
}

static bool shines(const MaterialDesc& material)
{
    return material.kind != material_unlit && !is_black(material.emission);
}

// Spheres that shine must stay spheres.
static void check_lamps(const Scene& scene)
{
    for (std::size_t i = 0; i < scene.instances.size(); ++i) {
        const InstanceDesc& instance = scene.instances[i];
        const Group& group = scene.groups[instance.group.value];
        if (group.spheres.empty() || uniform_scale(instance.transform) > 0.0f) continue;
        for (const Index<SphereDesc> index : group.spheres) {
            const SphereDesc& sphere = scene.spheres[index.value];
            if (!shines(scene.materials[sphere.material.value])) continue;
            throw Error(fmt::format("sphere {} would emit light, and instance {} makes it an ellipsoid",
                                    label(sphere.name, index.value), label(instance.name, i)),
                        "scale it uniformly, or use a mesh for a light of that shape");
        }
    }
}

static bool has_reflectances(const MaterialDesc& m, uint image)
{
    const PrincipledDesc& p = m.principled;
    const TextureRef* const refs[] = {&m.base_texture,
                                      &p.sheen_color_texture,
                                      &p.diffuse_transmission_color_texture,
                                      &p.specular_color_texture,
                                      &p.metallic_texture,
                                      &p.roughness_texture,
                                      &p.specular_texture,
                                      &p.clearcoat_texture,
                                      &p.clearcoat_roughness_texture,
                                      &p.clearcoat_normal_texture,
                                      &p.sheen_roughness_texture,
                                      &p.transmission_texture,
                                      &p.anisotropy_texture,
                                      &p.iridescence_texture,
                                      &p.iridescence_thickness_texture,
                                      &p.diffuse_transmission_texture};
    const std::size_t count = m.kind == material_principled ? std::size(refs) : 1;
    return std::any_of(refs, refs + count, [&](const TextureRef* ref) { return ref->image.value == image; });
}

// Pictures of floats may be brighter than a surface can be. validate() moves the texels of a material's inside [0, 1],
// but if it is light elsewhere that would change the light, and could not be undone.
static void check_reflectances(const Scene& scene, const MaterialDesc& material)
{
    for (uint i = 0; i < scene.images.size(); ++i) {
        if (scene.images[i].format != texels_rgba32f || !has_reflectances(material, i)) continue;
        const auto& all = scene.materials;
        const bool is_known =
            std::any_of(all.begin(), all.end(), [i](const MaterialDesc& m) { return has_reflectances(m, i); });
        const bool is_light = scene.environment.image.value == i ||
                              std::any_of(all.begin(), all.end(),
                                          [i](const MaterialDesc& m) { return m.emission_texture.image.value == i; });
        if (is_light && !is_known)
            throw Error(fmt::format("image {} holds light, not reflectances: its texels may be above 1",
                                    label(scene.images[i].name, i)),
                        "take another picture");
    }
}

static void check_hangs(const char* what, const std::string& name, std::size_t number, const Scene& scene,
                        Index<Node> node)
{
    throw Error(fmt::format("{} {} hangs on node {}, which places it", what, label(name, number),
                            label(scene.nodes[node.value].name, node.value)),
                "move the node");
}

// ---- what is done ----

namespace {
class Editor
{
  public:
    Editor(Scene& scene, const EditContext& context, bool checks) : scene_(scene), context_(context), checks_(checks) {}

    uint changes = change_none;
    std::string mended;
    bool may_stretch_lamps = false;

    // Each applies the edit, which it may mend, and returns the inverse.
    Edit operator()(SetMaterial& edit);
    Edit operator()(AddMaterial& edit);
    Edit operator()(RemoveMaterial&);
    Edit operator()(AssignMaterial& edit);
    Edit operator()(AddImage& edit);
    Edit operator()(RemoveImage&);
    Edit operator()(SetLight& edit);
    Edit operator()(AddLight& edit);
    Edit operator()(RemoveLight& edit);
    Edit operator()(SetCamera& edit);
    Edit operator()(AddCamera& edit);
    Edit operator()(RemoveCamera& edit);
    Edit operator()(SetEnvironment& edit);
    Edit operator()(SetTransform& edit);
    Edit operator()(SetNode& edit);
    Edit operator()(SetSphere& edit);
    Edit operator()(SetPlane& edit);
    Edit operator()(Rename& edit);

  private:
    void check_material(MaterialDesc& material, std::size_t number)
    {
        mended = mend_material(scene_, material, number);
        check_reflectances(scene_, material);
    }
    std::string& name_of(ScenePart part, uint index);

    Scene& scene_;
    const EditContext& context_;
    const bool checks_;
};

template <class T>
std::ptrdiff_t place(const std::vector<T>&, uint at)
{
    return static_cast<std::ptrdiff_t>(at);
}
} // namespace

Edit Editor::operator()(SetMaterial& edit)
{
    check_number("material", edit.material.value, scene_.materials.size());
    MaterialDesc& material = scene_.materials[edit.material.value];
    if (checks_) check_material(edit.value, edit.material.value);
    may_stretch_lamps = shines(edit.value) && !shines(material);
    changes = change_materials;
    return SetMaterial{edit.material, std::exchange(material, edit.value)};
}

Edit Editor::operator()(AddMaterial& edit)
{
    if (checks_) check_material(edit.value, scene_.materials.size());
    changes = change_materials;
    scene_.materials.push_back(edit.value);
    return RemoveMaterial{};
}

Edit Editor::operator()(RemoveMaterial&)
{
    if (checks_) throw Error("a material can only be taken away by undoing its addition");
    changes = change_materials;
    AddMaterial inverse{std::move(scene_.materials.back())};
    scene_.materials.pop_back();
    return inverse;
}

Edit Editor::operator()(AssignMaterial& edit)
{
    check_number("mesh", edit.mesh.value, scene_.meshes.size());
    check_number("material", edit.to.value, scene_.materials.size());
    Mesh& mesh = scene_.meshes[edit.mesh.value];
    std::vector<Index<MaterialDesc>>& each = mesh.triangle_materials;
    const auto has = [&](Index<MaterialDesc> m) {
        return each.empty() ? mesh.material == m : std::find(each.begin(), each.end(), m) != each.end();
    };
    if (!has(edit.from))
        throw Error(
            fmt::format("mesh {} has nothing of material {}", label(mesh.name, edit.mesh.value), edit.from.value));
    if (edit.from != edit.to && has(edit.to))
        throw Error(fmt::format("mesh {} has triangles of material {} already", label(mesh.name, edit.mesh.value),
                                label(scene_.materials[edit.to.value].name, edit.to.value)),
                    "duplicate that material, and assign the copy");
    if (each.empty()) {
        mesh.material = edit.to;
        changes = change_materials;
    } else {
        std::replace(each.begin(), each.end(), edit.from, edit.to);
        if (context_.is_outline) std::sort(each.begin(), each.end(), [](auto a, auto b) { return a.value < b.value; });
        changes = change_everything; // triangles lie by material
    }
    return AssignMaterial{edit.mesh, edit.to, edit.from};
}

Edit Editor::operator()(AddImage& edit)
{
    if (checks_) {
        if (!edit.value) throw Error("there is no picture to add");
        check_image(*edit.value, scene_.images.size());
        Image copy;
        if (edit.value->format == texels_rgba32f) copy = *edit.value;
        const std::size_t count = mend_radiances(copy);
        if (count > 0) {
            edit.value = std::make_shared<const Image>(std::move(copy));
            mended = fmt::format("{} values that were negative, not finite or above 1e9", count);
        }
    }
    changes = change_images;
    if (context_.is_outline)
        scene_.images.push_back({edit.value->name, edit.value->width, edit.value->height, edit.value->format, {}, {}});
    else
        scene_.images.push_back(*edit.value);
    return RemoveImage{};
}

Edit Editor::operator()(RemoveImage&)
{
    if (checks_) throw Error("a picture can only be taken away by undoing its addition");
    changes = change_images;
    AddImage inverse{std::make_shared<const Image>(std::move(scene_.images.back()))};
    scene_.images.pop_back();
    return inverse;
}

Edit Editor::operator()(SetLight& edit)
{
    check_number("light", edit.light, scene_.lights.size());
    LightDesc& light = scene_.lights[edit.light];
    if (checks_) {
        if (light.node.valid() && (edit.value.position != light.position || edit.value.direction != light.direction))
            check_hangs("light", light.name, edit.light, scene_, light.node);
        edit.value.node = light.node;
        mended = mend_light(edit.value, edit.light);
    }
    changes = change_lights;
    return SetLight{edit.light, std::exchange(light, edit.value)};
}

Edit Editor::operator()(AddLight& edit)
{
    check_number("place for a light", edit.at, scene_.lights.size() + 1);
    if (checks_) {
        if (edit.value.node.valid()) check_number("node", edit.value.node.value, scene_.nodes.size());
        mended = mend_light(edit.value, edit.at);
    }
    changes = change_lights;
    scene_.lights.insert(scene_.lights.begin() + place(scene_.lights, edit.at), edit.value);
    return RemoveLight{edit.at};
}

Edit Editor::operator()(RemoveLight& edit)
{
    check_number("light", edit.at, scene_.lights.size());
    changes = change_lights;
    AddLight inverse{edit.at, std::move(scene_.lights[edit.at])};
    scene_.lights.erase(scene_.lights.begin() + place(scene_.lights, edit.at));
    return inverse;
}

Edit Editor::operator()(SetCamera& edit)
{
    check_number("camera", edit.camera, scene_.cameras.size());
    CameraDesc& camera = scene_.cameras[edit.camera];
    if (checks_) {
        if (camera.node.valid() &&
            (edit.value.eye != camera.eye || edit.value.target != camera.target || edit.value.up != camera.up))
            check_hangs("camera", camera.name, edit.camera, scene_, camera.node);
        edit.value.node = camera.node;
        mended = mend_camera(edit.value, edit.camera);
    }
    changes = change_camera;
    return SetCamera{edit.camera, std::exchange(camera, edit.value)};
}

Edit Editor::operator()(AddCamera& edit)
{
    check_number("place for a camera", edit.at, scene_.cameras.size() + 1);
    if (checks_) {
        if (edit.value.node.valid()) check_number("node", edit.value.node.value, scene_.nodes.size());
        mended = mend_camera(edit.value, edit.at);
    }
    changes = change_camera;
    scene_.cameras.insert(scene_.cameras.begin() + place(scene_.cameras, edit.at), edit.value);
    return RemoveCamera{edit.at};
}

Edit Editor::operator()(RemoveCamera& edit)
{
    check_number("camera", edit.at, scene_.cameras.size());
    if (scene_.cameras.size() == 1) throw Error("this is the scene's only camera", "add another one first");
    changes = change_camera;
    AddCamera inverse{edit.at, std::move(scene_.cameras[edit.at])};
    scene_.cameras.erase(scene_.cameras.begin() + place(scene_.cameras, edit.at));
    return inverse;
}

Edit Editor::operator()(SetEnvironment& edit)
{
    if (checks_) mended = mend_environment(scene_, edit.value);
    changes = change_environment;
    return SetEnvironment{std::exchange(scene_.environment, edit.value)};
}

Edit Editor::operator()(SetTransform& edit)
{
    check_number("instance", edit.instance, scene_.instances.size());
    InstanceDesc& instance = scene_.instances[edit.instance];
    if (checks_) {
        if (instance.node.valid()) check_hangs("instance", instance.name, edit.instance, scene_, instance.node);
        InstanceDesc next = instance;
        next.transform = edit.value;
        check_instance(next, edit.instance);
        may_stretch_lamps = true;
    }
    changes = change_transforms;
    return SetTransform{edit.instance, std::exchange(instance.transform, edit.value)};
}

static bool is_finite_node(const Node& node)
{
    const vec4 r = node.rotation;
    const bool turns =
        std::isfinite(r.x) && std::isfinite(r.y) && std::isfinite(r.z) && std::isfinite(r.w) && dot(r, r) > 0.0f;
    return turns && is_seen(node.translation) && is_seen(node.scale) && (!node.has_matrix || is_usable(node.matrix)) &&
           std::all_of(node.weights.begin(), node.weights.end(), [](float w) { return std::isfinite(w); });
}

Edit Editor::operator()(SetNode& edit)
{
    check_number("node", edit.node.value, scene_.nodes.size());
    Node& node = scene_.nodes[edit.node.value];
    const std::string who = label(node.name, edit.node.value);
    if (checks_) {
        if (!is_finite_node(edit.value))
            throw Error(fmt::format("node {}: a number is NaN, infinite or beyond 1e18, or the rotation is zero", who));
        if (edit.value.weights.size() != node.weights.size())
            throw Error(
                fmt::format("node {} has {} weights, not {}", who, node.weights.size(), edit.value.weights.size()));
        may_stretch_lamps = true;
    }
    SetNode inverse{edit.node, node};
    edit.value.name = node.name;
    edit.value.parent = node.parent;
    edit.value.posed = node.posed;
    node = edit.value;
    pose(scene_, context_.animation, context_.seconds);
    changes = change_pose;
    return inverse;
}

Edit Editor::operator()(SetSphere& edit)
{
    check_number("sphere", edit.sphere.value, scene_.spheres.size());
    SphereDesc& sphere = scene_.spheres[edit.sphere.value];
    if (checks_) {
        check_number("material", edit.value.material.value, scene_.materials.size());
        if (!is_sphere(edit.value))
            throw Error(fmt::format("sphere {}: radius {}, centre {}, {}, {}", label(sphere.name, edit.sphere.value),
                                    edit.value.radius, edit.value.center.x, edit.value.center.y, edit.value.center.z),
                        "give a positive radius and a finite centre");
        may_stretch_lamps = shines(scene_.materials[edit.value.material.value]);
    }
    const bool moves = edit.value.center != sphere.center || edit.value.radius != sphere.radius;
    changes = (moves ? change_shapes : change_none) |
              (edit.value.material != sphere.material ? change_materials : change_none);
    return SetSphere{edit.sphere, std::exchange(sphere, edit.value)};
}

Edit Editor::operator()(SetPlane& edit)
{
    check_number("plane", edit.plane, scene_.planes.size());
    PlaneDesc& plane = scene_.planes[edit.plane];
    if (checks_) {
        check_number("material", edit.value.material.value, scene_.materials.size());
        check_plane(edit.value, edit.plane);
    }
    changes = change_shapes;
    return SetPlane{edit.plane, std::exchange(plane, edit.value)};
}

std::string& Editor::name_of(ScenePart part, uint index)
{
    const auto find = [index](const char* what, auto& all) -> std::string& {
        check_number(what, index, all.size());
        return all[index].name;
    };
    switch (part) {
    case ScenePart::image:
        return find("image", scene_.images);
    case ScenePart::material:
        return find("material", scene_.materials);
    case ScenePart::mesh:
        return find("mesh", scene_.meshes);
    case ScenePart::sphere:
        return find("sphere", scene_.spheres);
    case ScenePart::plane:
        return find("plane", scene_.planes);
    case ScenePart::group:
        return find("group", scene_.groups);
    case ScenePart::instance:
        return find("instance", scene_.instances);
    case ScenePart::light:
        return find("light", scene_.lights);
    case ScenePart::camera:
        return find("camera", scene_.cameras);
    case ScenePart::node:
        return find("node", scene_.nodes);
    case ScenePart::animation:
        break;
    }
    return find("animation", scene_.animations);
}

Edit Editor::operator()(Rename& edit)
{
    return Rename{edit.part, edit.index, std::exchange(name_of(edit.part, edit.index), edit.name)};
}

// ---- ----

AppliedEdit apply_edit(Scene& scene, Edit edit, const EditContext& context)
{
    Editor editor(scene, context, true);
    Edit inverse = std::visit(editor, edit);
    if (editor.may_stretch_lamps) {
        try {
            check_lamps(scene);
        } catch (const Error&) {
            reapply(scene, inverse, context);
            throw;
        }
    }
    return {std::move(edit), std::move(inverse), editor.changes, std::move(editor.mended)};
}

uint reapply(Scene& scene, const Edit& edit, const EditContext& context)
{
    Editor editor(scene, context, false);
    Edit copy = edit;
    std::visit(editor, copy);
    return editor.changes;
}

namespace {
// What an edit sets; -1: it does more than set.
struct TargetOf
{
    std::int64_t operator()(const SetMaterial& e) const { return e.material.value; }
    std::int64_t operator()(const SetLight& e) const { return e.light; }
    std::int64_t operator()(const SetCamera& e) const { return e.camera; }
    std::int64_t operator()(const SetEnvironment&) const { return 0; }
    std::int64_t operator()(const SetTransform& e) const { return e.instance; }
    std::int64_t operator()(const SetNode& e) const { return e.node.value; }
    std::int64_t operator()(const SetSphere& e) const { return e.sphere.value; }
    std::int64_t operator()(const SetPlane& e) const { return e.plane; }
    std::int64_t operator()(const Rename& e) const
    {
        return (static_cast<std::int64_t>(e.part) << 32) | static_cast<std::int64_t>(e.index);
    }
    template <class Other>
    std::int64_t operator()(const Other&) const
    {
        return -1;
    }
};
} // namespace

bool sets_the_same(const Edit& a, const Edit& b)
{
    const std::int64_t target = std::visit(TargetOf(), a);
    return a.index() == b.index() && target >= 0 && target == std::visit(TargetOf(), b);
}

std::size_t bytes_of(const Edit& edit)
{
    std::size_t more = 0; // beyond the struct; names are short
    if (const auto* image = std::get_if<AddImage>(&edit); image != nullptr && image->value)
        more = image->value->bytes.size() + image->value->floats.size() * sizeof(float);
    if (const auto* node = std::get_if<SetNode>(&edit)) more = node->value.weights.size() * sizeof(float);
    if (const auto* rename = std::get_if<Rename>(&edit)) more = rename->name.size();
    return sizeof(Edit) + more;
}

} // namespace snell
