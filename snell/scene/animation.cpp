#include "snell/scene/animation.h"

#include "snell/core/error.h"
#include "snell/scene/keyframes.h"
#include "snell/scene/rig.h"
#include "snell/scene/scene.h"
#include "snell/scene/validate_animation.h"
#include "snell/scene/validate_mesh.h"

#include <algorithm>
#include <cmath>

namespace snell {

// What is flattened stays that much of its size.
static constexpr float flattened = 1e-6f;

// ---- nodes ----

namespace {
// A node's own movement at one moment.
struct Local
{
    vec3 translation;
    vec4 rotation;
    vec3 scale;
    std::vector<float> weights;
    bool moved = false; // by a channel; weights alone do not count
};
} // namespace

// An axis that shrinks to nothing would make the map singular.
static vec3 keep_invertible(vec3 scale, vec3 rest)
{
    const float size = max3(abs(rest));
    const float least = flattened * (size > 0.0f ? size : 1.0f);
    for (int i = 0; i < 3; ++i)
        if (!(abs(scale[i]) >= least)) scale[i] = scale[i] < 0.0f ? -least : least;
    return scale;
}

static std::vector<Local> locals_at(const Scene& scene, const Animation* animation, float seconds)
{
    std::vector<Local> locals;
    locals.reserve(scene.nodes.size());
    for (const Node& node : scene.nodes)
        locals.push_back({node.translation, node.rotation, node.scale, node.weights, false});
    if (animation == nullptr) return locals;
    for (const AnimationChannel& channel : animation->channels) {
        if (channel.times.empty()) continue;
        const Node& node = scene.nodes[channel.node.value];
        Local& local = locals[channel.node.value];
        switch (channel.property) {
        case AnimatedProperty::translation:
            sample_keys(channel, seconds, {&local.translation.x, 3});
            break;
        case AnimatedProperty::rotation:
            sample_keys(channel, seconds, {&local.rotation.x, 4});
            break;
        case AnimatedProperty::scale:
            sample_keys(channel, seconds, {&local.scale.x, 3});
            break;
        case AnimatedProperty::weights:
            sample_keys(channel, seconds, local.weights);
            continue;
        }
        local.moved = local.moved || !node.has_matrix;
    }
    return locals;
}

static Transform local_to_parent(const Node& node)
{
    if (node.posed) return *node.posed;
    if (node.has_matrix) return node.matrix;
    return compose_trs(node.translation, unit_quaternion(node.rotation), keep_invertible(node.scale, node.scale));
}

// The maps of all nodes to the world, whatever their order.
static std::vector<Transform> worlds_of(const Scene& scene)
{
    const std::size_t count = scene.nodes.size();
    std::vector<Transform> worlds(count);
    std::vector<std::uint8_t> known(count, 0);
    std::vector<uint> waiting; // a node, its parent, that one's parent, ... as long as they are not known
    for (uint start = 0; start < count; ++start) {
        for (uint node = start; node != none && known[node] == 0; node = scene.nodes[node].parent.value)
            waiting.push_back(node);
        for (; !waiting.empty(); waiting.pop_back()) {
            const uint node = waiting.back();
            const Index<Node> parent = scene.nodes[node].parent;
            const Transform local = local_to_parent(scene.nodes[node]);
            worlds[node] = parent.valid() ? compose(worlds[parent.value], local) : local;
            known[node] = 1;
        }
    }
    return worlds;
}

Transform node_to_world(const Scene& scene, Index<Node> node)
{
    SNELL_CHECK_LT(node.value, scene.nodes.size());
    Transform world = local_to_parent(scene.nodes[node.value]);
    std::size_t steps = 0;
    for (Index<Node> up = scene.nodes[node.value].parent; up.valid(); up = scene.nodes[up.value].parent) {
        SNELL_CHECK_LT(up.value, scene.nodes.size());
        if (++steps > scene.nodes.size())
            throw Error(fmt::format("node {} is its own ancestor", label(scene.nodes[up.value].name, up.value)),
                        "nodes must form trees");
        world = compose(local_to_parent(scene.nodes[up.value]), world);
    }
    return world;
}

// ---- what hangs on them ----

// Instances must be invertible. Several flattening ancestors can still make a map that is not: then nothing of it can
// be seen, and it becomes a speck.
static Transform placed(const Transform& world)
{
    if (inverse(world)) return world;
    const vec3 at(world.x.w, world.y.w, world.z.w);
    return compose(is_seen(at) ? translation(at) : identity_transform(), scaling(vec3(flattened)));
}

static vec3 column(const Transform& m, int i)
{
    return {m.x[i], m.y[i], m.z[i]};
}

// The direction of v, or `otherwise` if it has none.
static vec3 direction_of(vec3 v, vec3 otherwise)
{
    const float size = max3(abs(v));
    return size > 0.0f && std::isfinite(size) ? normalize(v / size) : otherwise;
}

static void move_light(LightDesc& light, const Transform& world)
{
    light.position = column(world, 3);
    light.direction = direction_of(-column(world, 2), light.direction);
}

static void move_camera(CameraDesc& camera, const Transform& world)
{
    camera.eye = column(world, 3);
    const vec3 forward = direction_of(-column(world, 2), vec3(0.0f, 0.0f, -1.0f));
    // Far from the origin a target one unit away would be rounded to another direction.
    camera.target = camera.eye + std::max(1.0f, max3(abs(camera.eye))) * forward;
    camera.up = direction_of(column(world, 1), vec3(0.0f, 1.0f, 0.0f));
}

static void move_rig(Scene& scene, const Rig& rig, const std::vector<Local>& locals,
                     const std::vector<Transform>& worlds)
{
    std::vector<Transform> joints;
    if (rig.skin.valid()) {
        const Skin& skin = scene.skins[rig.skin.value];
        joints.reserve(skin.joints.size());
        for (std::size_t i = 0; i < skin.joints.size(); ++i)
            joints.push_back(compose(worlds[skin.joints[i].value], skin.inverse_bind[i]));
    }
    static const std::vector<float> no_weights;
    deform(rig, rig.node.valid() ? locals[rig.node.value].weights : no_weights, joints, scene.meshes[rig.mesh.value]);
}

void pose(Scene& scene, Index<Animation> animation, float seconds)
{
    check_animation(scene);
    const Animation* moving = nullptr;
    if (animation.valid()) {
        SNELL_CHECK_LT(animation.value, scene.animations.size());
        moving = &scene.animations[animation.value];
    }
    const std::vector<Local> locals = locals_at(scene, moving, seconds);
    for (std::size_t i = 0; i < scene.nodes.size(); ++i) {
        Node& node = scene.nodes[i];
        node.posed.reset();
        if (locals[i].moved)
            node.posed = compose_trs(locals[i].translation, unit_quaternion(locals[i].rotation),
                                     keep_invertible(locals[i].scale, node.scale));
    }
    const std::vector<Transform> worlds = worlds_of(scene);
    for (InstanceDesc& instance : scene.instances)
        if (instance.node.valid()) instance.transform = placed(worlds[instance.node.value]);
    for (LightDesc& light : scene.lights)
        if (light.node.valid()) move_light(light, worlds[light.node.value]);
    for (CameraDesc& camera : scene.cameras)
        if (camera.node.valid()) move_camera(camera, worlds[camera.node.value]);
    for (const Rig& rig : scene.rigs) move_rig(scene, rig, locals, worlds);
}

} // namespace snell
