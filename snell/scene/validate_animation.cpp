#include "snell/scene/validate_animation.h"

#include "snell/core/error.h"
#include "snell/core/parallel.h"
#include "snell/scene/validate_mesh.h"

#include <algorithm>
#include <atomic>
#include <cmath>

namespace snell {

// ---- what has no meaning ----

template <class T>
static void check_index(const std::string& who, const char* what, Index<T> index, std::size_t count)
{
    if (index.value >= count)
        throw Error(fmt::format("{} refers to {} {} of {}", who, what, static_cast<std::int32_t>(index.value), count));
}

static void check_length(const std::string& who, const char* what, std::size_t given, std::size_t wanted)
{
    if (given != wanted) throw Error(fmt::format("{} has {} {}, and needs {}", who, given, what, wanted));
}

static void check_nodes(const Scene& scene)
{
    const std::size_t count = scene.nodes.size();
    for (std::size_t i = 0; i < count; ++i)
        if (scene.nodes[i].parent.valid() && scene.nodes[i].parent.value >= count)
            check_index(fmt::format("node {}", label(scene.nodes[i].name, i)), "parent", scene.nodes[i].parent, count);

    // Each walk up ends at a root, at what an earlier walk has passed, or where it has been itself.
    std::vector<uint> walk(count, 0);
    for (uint start = 0; start < count; ++start) {
        uint node = start;
        for (; node != none && walk[node] == 0; node = scene.nodes[node].parent.value) walk[node] = start + 1;
        if (node != none && walk[node] == start + 1)
            throw Error(fmt::format("node {} is its own ancestor", label(scene.nodes[node].name, node)),
                        "nodes must form trees");
    }
}

static void check_bindings(const Scene& scene)
{
    const auto check = [&](const char* kind, const auto& all) {
        for (std::size_t i = 0; i < all.size(); ++i)
            if (all[i].node.valid() && all[i].node.value >= scene.nodes.size())
                check_index(fmt::format("{} {}", kind, label(all[i].name, i)), "node", all[i].node, scene.nodes.size());
    };
    check("instance", scene.instances);
    check("light", scene.lights);
    check("camera", scene.cameras);
}

static void check_rig(const Scene& scene, const Rig& rig, std::size_t number)
{
    const std::string who = fmt::format("rig {}", number);
    check_index(who, "mesh", rig.mesh, scene.meshes.size());
    const Mesh& mesh = scene.meshes[rig.mesh.value];
    const std::size_t count = mesh.positions.size();
    check_length(who, "positions", rig.positions.size(), count);
    if (!rig.normals.empty()) check_length(who, "normals", rig.normals.size(), count);
    if (!rig.tangents.empty()) check_length(who, "tangents", rig.tangents.size(), count);
    for (const MorphTarget& target : rig.targets) {
        if (!target.positions.empty()) check_length(who, "positions in a morph target", target.positions.size(), count);
        if (!target.normals.empty()) check_length(who, "normals in a morph target", target.normals.size(), count);
        if (!target.tangents.empty()) check_length(who, "tangents in a morph target", target.tangents.size(), count);
    }
    if (rig.node.valid()) check_index(who, "node", rig.node, scene.nodes.size());
    if (!rig.skin.valid()) return;
    check_index(who, "skin", rig.skin, scene.skins.size());
    check_length(who, "sets of weights", rig.weights.size(), rig.joints.size());
    if (rig.joints.size() != count) check_length(who, "sets of joints", rig.joints.size(), 2 * count);
}

static std::size_t numbers_of(const Scene& scene, const AnimationChannel& channel)
{
    switch (channel.property) {
    case AnimatedProperty::rotation:
        return 4;
    case AnimatedProperty::weights:
        return scene.nodes[channel.node.value].weights.size();
    case AnimatedProperty::translation:
    case AnimatedProperty::scale:
        break;
    }
    return 3;
}

static std::string channel_name(const Scene& scene, std::size_t animation, std::size_t channel)
{
    return fmt::format("animation {}: channel {}", label(scene.animations[animation].name, animation), channel);
}

void check_animation(const Scene& scene)
{
    check_nodes(scene);
    check_bindings(scene);
    for (std::size_t i = 0; i < scene.skins.size(); ++i) {
        const Skin& skin = scene.skins[i];
        const auto who = [&] { return fmt::format("skin {}", label(skin.name, i)); };
        if (skin.inverse_bind.size() != skin.joints.size())
            check_length(who(), "inverse bind matrices", skin.inverse_bind.size(), skin.joints.size());
        for (const Index<Node> joint : skin.joints)
            if (joint.value >= scene.nodes.size()) check_index(who(), "node", joint, scene.nodes.size());
    }
    std::vector<bool> has_rig(scene.meshes.size(), false);
    for (std::size_t i = 0; i < scene.rigs.size(); ++i) {
        check_rig(scene, scene.rigs[i], i);
        const uint mesh = scene.rigs[i].mesh.value;
        if (has_rig[mesh]) throw Error(fmt::format("mesh {} has two rigs", label(scene.meshes[mesh].name, mesh)));
        has_rig[mesh] = true;
    }
    for (std::size_t a = 0; a < scene.animations.size(); ++a)
        for (std::size_t c = 0; c < scene.animations[a].channels.size(); ++c) {
            const AnimationChannel& channel = scene.animations[a].channels[c];
            if (channel.node.value >= scene.nodes.size())
                check_index(channel_name(scene, a, c), "node", channel.node, scene.nodes.size());
            const std::size_t sets = channel.times.size() * (channel.interpolation == Interpolation::cubic ? 3 : 1);
            if (channel.values.size() != sets * numbers_of(scene, channel))
                check_length(channel_name(scene, a, c), "numbers", channel.values.size(),
                             sets * numbers_of(scene, channel));
        }
}

// ---- what can be mended ----

template <class T>
static bool is_finite_all(const T& numbers)
{
    return std::all_of(numbers.begin(), numbers.end(), [](float x) { return std::isfinite(x); });
}

static void mend_nodes(Scene& scene)
{
    for (std::size_t i = 0; i < scene.nodes.size(); ++i) {
        Node& node = scene.nodes[i];
        std::string mended;
        const auto say = [&mended](const char* what) { mended += (mended.empty() ? "" : ", ") + std::string(what); };
        if (!is_seen(node.translation)) node.translation = vec3(0.0f), say("translation");
        if (!is_seen(node.scale)) node.scale = vec3(1.0f), say("scale");
        const float size2 = dot(node.rotation, node.rotation);
        if (!(size2 > 1e-12f && size2 < 1e12f)) node.rotation = Node{}.rotation, say("rotation");
        if (node.has_matrix && !is_usable(node.matrix)) node.matrix = identity_transform(), say("matrix");
        if (!is_finite_all(node.weights)) {
            for (float& weight : node.weights) weight = std::isfinite(weight) ? weight : 0.0f;
            say("weights");
        }
        if (!mended.empty())
            warn(scene, fmt::format("node {}: without meaning, reset: {}", label(node.name, i), mended));
    }
    std::size_t matrices = 0;
    for (Skin& skin : scene.skins)
        for (Transform& m : skin.inverse_bind)
            if (!is_usable(m)) m = identity_transform(), ++matrices;
    if (matrices > 0) warn(scene, fmt::format("{} inverse bind matrices of skins were not finite; reset", matrices));
}

static const char* fault_of(const Scene& scene, const AnimationChannel& channel)
{
    if (channel.times.empty()) return "it has no keys";
    if (!is_finite_all(channel.times) || !is_finite_all(channel.values)) return "it has numbers that are not finite";
    if (!std::is_sorted(channel.times.begin(), channel.times.end())) return "its times do not ascend";
    if (scene.nodes[channel.node.value].has_matrix && channel.property != AnimatedProperty::weights)
        return "its node has a matrix, which cannot be animated";
    return nullptr;
}

static void mend_channels(Scene& scene)
{
    for (std::size_t a = 0; a < scene.animations.size(); ++a) {
        Animation& animation = scene.animations[a];
        std::vector<AnimationChannel> kept;
        animation.duration = 0.0f;
        for (std::size_t c = 0; c < animation.channels.size(); ++c) {
            AnimationChannel& channel = animation.channels[c];
            if (const char* fault = fault_of(scene, channel)) {
                warn(scene, fmt::format("{} is left out: {}", channel_name(scene, a, c), fault));
                continue;
            }
            animation.duration = std::max(animation.duration, channel.times.back());
            kept.push_back(std::move(channel));
        }
        animation.channels = std::move(kept);
    }
}

// Weights of one vertex. Returns whether they changed by more than rounding.
static bool mend_weights(Rig& rig, std::size_t vertex)
{
    const std::size_t count = rig.positions.size();
    float sum = 0.0f;
    bool mended = false;
    for (std::size_t i = vertex; i < rig.weights.size(); i += count)
        for (int k = 0; k < 4; ++k) {
            float& weight = rig.weights[i][k];
            if (!(weight >= 0.0f) || weight > 1e18f) weight = 0.0f, mended = true;
            sum += weight;
        }
    if (!(sum > 0.0f)) {
        rig.weights[vertex].x = 1.0f;
        return true;
    }
    constexpr float rounding = 1e-6f, quantised = 0.02f; // of 8 bytes
    if (abs(sum - 1.0f) > rounding)
        for (std::size_t i = vertex; i < rig.weights.size(); i += count) rig.weights[i] /= sum;
    return mended || abs(sum - 1.0f) > quantised;
}

static void mend_rig(Scene& scene, std::size_t number)
{
    Rig& rig = scene.rigs[number];
    const std::string who = fmt::format("mesh {}", label(scene.meshes[rig.mesh.value].name, rig.mesh.value));
    if (rig.skin.valid()) {
        const Skin& skin = scene.skins[rig.skin.value];
        std::atomic<std::size_t> mended = 0, lost = 0;
        parallel_ranges(rig.positions.size(), 1 << 14, [&](std::size_t begin, std::size_t end) {
            std::size_t mended_here = 0, lost_here = 0;
            for (std::size_t vertex = begin; vertex < end; ++vertex) {
                mended_here += mend_weights(rig, vertex) ? 1 : 0;
                for (std::size_t i = vertex; i < rig.joints.size(); i += rig.positions.size())
                    for (int k = 0; k < 4; ++k) {
                        if (rig.joints[i][k] < skin.joints.size()) continue;
                        if (rig.weights[i][k] > 0.0f) ++lost_here;
                        rig.joints[i][k] = 0;
                    }
            }
            mended += mended_here;
            lost += lost_here;
        });
        if (lost > 0)
            throw Error(fmt::format("{}: {} vertices refer to joints beyond the {} of the skin", who, lost.load(),
                                    skin.joints.size()));
        if (mended > 0)
            warn(scene, fmt::format("{}: weights of joints at {} vertices were negative or did not sum to 1; mended",
                                    who, mended.load()));
    }
    // The mesh's own normals have been replaced (and that noted); pose() must not bring the old ones back.
    const bool broken = std::any_of(rig.normals.begin(), rig.normals.end(), [](vec3 n) {
        const float size2 = dot(n, n);
        return !(size2 > 1e-30f && size2 < 1e30f);
    });
    if (broken) {
        Mesh rest;
        rest.positions = rig.positions;
        rest.normals = std::move(rig.normals);
        rest.triangles = scene.meshes[rig.mesh.value].triangles;
        validate_mesh(rest, who, 1, false);
        rig.normals = std::move(rest.normals);
    }
}

void validate_animation(Scene& scene)
{
    check_animation(scene);
    mend_nodes(scene);
    mend_channels(scene);
    for (std::size_t i = 0; i < scene.rigs.size(); ++i) mend_rig(scene, i);
}

} // namespace snell
