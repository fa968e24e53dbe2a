#include "snell/io/gltf/nodes.h"

#include <algorithm>
#include <cmath>

namespace snell::gltf {
namespace {

// Why a channel is left out; empty: it is not.
std::string read_channel(const Document& document, const Accessors& accessors, const Scene& scene,
                         const tinygltf::Animation& animation, const tinygltf::AnimationChannel& source,
                         const std::string& who, AnimationChannel& channel)
{
    const tinygltf::AnimationSampler& sampler = checked(animation.samplers, source.sampler, "sampler", who);
    checked(document.model.nodes, source.target_node, "node", who);
    channel.node = {static_cast<uint>(source.target_node)};
    const Node& node = scene.nodes[channel.node.value];

    int numbers = 3;
    if (source.target_path == "translation") {
        channel.property = AnimatedProperty::translation;
    } else if (source.target_path == "rotation") {
        channel.property = AnimatedProperty::rotation;
        numbers = 4;
    } else if (source.target_path == "scale") {
        channel.property = AnimatedProperty::scale;
    } else if (source.target_path == "weights") {
        channel.property = AnimatedProperty::weights;
        numbers = 1; // one element a target
    } else {
        return fmt::format("it animates '{}'", source.target_path);
    }
    if (channel.property == AnimatedProperty::weights && node.weights.empty()) return "its node has no morph targets";
    if (channel.property != AnimatedProperty::weights && node.has_matrix) return "its node has a matrix";

    if (sampler.interpolation == "STEP")
        channel.interpolation = Interpolation::step;
    else if (sampler.interpolation == "CUBICSPLINE")
        channel.interpolation = Interpolation::cubic;
    else if (sampler.interpolation == "LINEAR" || sampler.interpolation.empty())
        channel.interpolation = Interpolation::linear;
    else
        return fmt::format("its interpolation '{}' is not known", sampler.interpolation);

    channel.times = accessors.floats(sampler.input, 1, who + ", times");
    channel.values = accessors.floats(sampler.output, numbers, who + ", values");
    const std::size_t keys = channel.times.size() * (channel.interpolation == Interpolation::cubic ? 3 : 1);
    const std::size_t a_key =
        channel.property == AnimatedProperty::weights ? node.weights.size() : static_cast<std::size_t>(numbers);
    if (channel.times.empty()) return "it has no keys";
    if (channel.values.size() != keys * a_key)
        return fmt::format("its {} keys need {} numbers, and it has {}", channel.times.size(), keys * a_key,
                           channel.values.size());
    const auto is_finite_all = [](const std::vector<float>& all) {
        return std::all_of(all.begin(), all.end(), [](float x) { return std::isfinite(x); });
    };
    if (!is_finite_all(channel.times) || !is_finite_all(channel.values)) return "it has numbers that are not finite";
    if (!std::is_sorted(channel.times.begin(), channel.times.end())) return "its times do not ascend";
    return {};
}

} // namespace

void read_animations(const Document& document, const Accessors& accessors, Scene& scene, Remarks& remarks)
{
    for (std::size_t i = 0; i < document.model.animations.size(); ++i) {
        const tinygltf::Animation& source = document.model.animations[i];
        const std::string name = label("animation", i, source.name);
        Animation animation;
        animation.name = source.name;
        for (std::size_t k = 0; k < source.channels.size(); ++k) {
            const std::string who = fmt::format("{}, channel {}", name, k);
            AnimationChannel channel;
            const std::string fault =
                read_channel(document, accessors, scene, source, source.channels[k], who, channel);
            if (!fault.empty()) {
                remarks.warn("channel", fmt::format("{} is left out: {}", who, fault));
                continue;
            }
            animation.duration = std::max(animation.duration, channel.times.back());
            animation.channels.push_back(std::move(channel));
        }
        scene.animations.push_back(std::move(animation));
    }
}

} // namespace snell::gltf
