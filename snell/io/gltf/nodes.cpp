#include "snell/io/gltf/nodes.h"

#include <algorithm>
#include <cmath>

namespace snell::gltf {
namespace {

template <std::size_t n>
bool has(const std::vector<double>& numbers, const std::string& who, const char* what)
{
    if (numbers.empty()) return false;
    if (numbers.size() != n)
        throw Error(fmt::format("{}: its {} has {} numbers, not {}", who, what, numbers.size(), n),
                    "write the file again");
    return true;
}

Node to_node(const tinygltf::Node& source, const std::string& who)
{
    Node node;
    node.name = source.name;
    const auto f = [](double value) { return static_cast<float>(value); };
    if (const auto& m = source.matrix; has<16>(m, who, "matrix")) { // by columns
        node.has_matrix = true;
        node.matrix = {{f(m[0]), f(m[4]), f(m[8]), f(m[12])},
                       {f(m[1]), f(m[5]), f(m[9]), f(m[13])},
                       {f(m[2]), f(m[6]), f(m[10]), f(m[14])}};
    }
    if (const auto& t = source.translation; has<3>(t, who, "translation"))
        node.translation = {f(t[0]), f(t[1]), f(t[2])};
    if (const auto& s = source.scale; has<3>(s, who, "scale")) node.scale = {f(s[0]), f(s[1]), f(s[2])};
    if (const auto& r = source.rotation; has<4>(r, who, "rotation")) {
        const double size = std::sqrt(r[0] * r[0] + r[1] * r[1] + r[2] * r[2] + r[3] * r[3]);
        if (size > 0.0 && std::isfinite(size))
            node.rotation = {f(r[0] / size), f(r[1] / size), f(r[2] / size), f(r[3] / size)};
    }
    return node;
}

// Weights of the morph targets of a node's mesh: its own or else the mesh's, as many as there are targets.
std::vector<float> weights_of(const Document& document, const tinygltf::Node& node, const std::string& who)
{
    if (node.mesh < 0) return {};
    const tinygltf::Mesh& mesh = checked(document.model.meshes, node.mesh, "mesh", who);
    std::size_t targets = 0;
    for (const auto& primitive : mesh.primitives) targets = std::max(targets, primitive.targets.size());
    const std::vector<double>& given = node.weights.empty() ? mesh.weights : node.weights;
    std::vector<float> weights(targets, 0.0f);
    for (std::size_t i = 0; i < std::min(targets, given.size()); ++i) weights[i] = static_cast<float>(given[i]);
    return weights;
}

// Calls visit(node) for a node and all below it, parents first.
template <class Visit>
void walk(const std::vector<tinygltf::Node>& nodes, std::size_t root, const Visit& visit)
{
    std::vector<std::size_t> waiting = {root};
    while (!waiting.empty()) {
        const std::size_t node = waiting.back();
        waiting.pop_back();
        if (!visit(node)) continue;
        for (const int child : nodes[node].children) waiting.push_back(static_cast<std::size_t>(child));
    }
}

// Sets the parents; returns the nodes, parents first.
std::vector<uint> link(const std::vector<tinygltf::Node>& sources, Scene& scene)
{
    for (std::size_t i = 0; i < sources.size(); ++i) {
        const std::string who = label("node", i, sources[i].name);
        for (const int child : sources[i].children) {
            checked(sources, child, "node", who);
            Index<Node>& parent = scene.nodes[static_cast<std::size_t>(child)].parent;
            if (parent.valid())
                throw Error(fmt::format("{} and node {} both have node {} as their child", who, parent.value, child),
                            "nodes must form trees");
            parent = {static_cast<uint>(i)};
        }
    }
    // With one parent each, what no root leads to goes round in circles.
    std::vector<bool> is_reached(sources.size(), false);
    std::vector<uint> order;
    for (std::size_t i = 0; i < sources.size(); ++i) {
        if (scene.nodes[i].parent.valid()) continue;
        walk(sources, i, [&](std::size_t node) {
            order.push_back(static_cast<uint>(node));
            return static_cast<bool>(is_reached[node] = true);
        });
    }
    const auto lost = std::find(is_reached.begin(), is_reached.end(), false);
    if (lost != is_reached.end())
        throw Error(fmt::format("node {} is its own ancestor", lost - is_reached.begin()), "nodes must form trees");
    return order;
}

} // namespace

Hierarchy read_nodes(const Document& document, Scene& scene, Remarks& remarks)
{
    const tinygltf::Model& model = document.model;
    const std::size_t count = model.nodes.size();
    scene.nodes.reserve(count);
    for (std::size_t i = 0; i < count; ++i) {
        const std::string who = label("node", i, model.nodes[i].name);
        Node node = to_node(model.nodes[i], who);
        node.weights = weights_of(document, model.nodes[i], who);
        scene.nodes.push_back(std::move(node));
    }
    Hierarchy hierarchy{std::vector<bool>(count, false), std::vector<bool>(count, false), link(model.nodes, scene)};
    const auto show = [&](std::size_t root) {
        walk(model.nodes, root, [&](std::size_t node) {
            if (hierarchy.is_shown[node]) return false;
            return static_cast<bool>(hierarchy.is_shown[node] = true);
        });
    };
    if (model.scenes.empty()) {
        remarks.info("scenes", "the file has no scene; all of its nodes are shown");
        for (std::size_t i = 0; i < count; ++i) show(i);
    } else {
        const int chosen = model.defaultScene < 0 ? 0 : model.defaultScene;
        const tinygltf::Scene& source = checked(model.scenes, chosen, "scene", "the file");
        if (!source.name.empty()) scene.name = source.name;
        for (const int root : source.nodes) {
            checked(model.nodes, root, "node", label("scene", static_cast<std::size_t>(chosen), source.name));
            show(static_cast<std::size_t>(root));
        }
        if (model.scenes.size() > 1)
            remarks.info("scenes", fmt::format("the file has {} scenes; {} is shown", model.scenes.size(),
                                               label("scene", static_cast<std::size_t>(chosen), source.name)));
    }
    for (const tinygltf::Animation& animation : model.animations)
        for (const tinygltf::AnimationChannel& channel : animation.channels) {
            if (channel.target_node < 0 || static_cast<std::size_t>(channel.target_node) >= count) continue;
            walk(model.nodes, static_cast<std::size_t>(channel.target_node), [&](std::size_t node) {
                if (hierarchy.is_moving[node]) return false;
                return static_cast<bool>(hierarchy.is_moving[node] = true);
            });
        }
    return hierarchy;
}

void read_skins(const Document& document, const Accessors& accessors, Scene& scene)
{
    for (std::size_t i = 0; i < document.model.skins.size(); ++i) {
        const tinygltf::Skin& source = document.model.skins[i];
        const std::string who = label("skin", i, source.name);
        Skin skin;
        skin.name = source.name;
        if (source.joints.empty()) throw Error(fmt::format("{} has no joints", who), "write the file again");
        for (const int joint : source.joints) {
            checked(document.model.nodes, joint, "node", who);
            skin.joints.push_back({static_cast<uint>(joint)});
        }
        skin.inverse_bind.assign(skin.joints.size(), identity_transform());
        if (source.inverseBindMatrices >= 0) {
            const std::vector<float> m = accessors.floats(source.inverseBindMatrices, 16, who);
            if (m.size() < 16 * skin.joints.size())
                throw Error(fmt::format("{} has {} joints and {} inverse bind matrices", who, skin.joints.size(),
                                        m.size() / 16),
                            "write the file again");
            for (std::size_t k = 0; k < skin.joints.size(); ++k) {
                const float* const c = m.data() + 16 * k; // by columns
                skin.inverse_bind[k] = {
                    {c[0], c[4], c[8], c[12]}, {c[1], c[5], c[9], c[13]}, {c[2], c[6], c[10], c[14]}};
            }
        }
        scene.skins.push_back(std::move(skin));
    }
}

void read_lights(const Document& document, const Hierarchy& hierarchy, Scene& scene, Remarks& remarks)
{
    constexpr double degrees = 180.0 / 3.14159265358979323846;
    for (std::size_t i = 0; i < document.model.nodes.size(); ++i) {
        const tinygltf::Node& node = document.model.nodes[i];
        const Fields fields(node.extensions, "KHR_lights_punctual");
        if (!fields.exists() || !hierarchy.is_shown[i]) continue;
        const std::string who = label("node", i, node.name);
        const int index = fields.integer("light", -1);
        const tinygltf::Light& source = checked(document.model.lights, index, "light", who);
        LightDesc light;
        light.name = source.name.empty() ? node.name : source.name;
        light.node = {static_cast<uint>(i)};
        vec3 color(1.0f);
        if (source.color.size() == 3) color = vec3(glm::dvec3(source.color[0], source.color[1], source.color[2]));
        light.emission = color * static_cast<float>(source.intensity);
        if (source.type == "directional") {
            light.kind = light_directional;
        } else if (source.type == "spot") {
            light.kind = light_spot;
            light.inner_degrees = static_cast<float>(source.spot.innerConeAngle * degrees);
            light.outer_degrees = static_cast<float>(source.spot.outerConeAngle * degrees);
        } else if (source.type != "point") {
            remarks.warn("light",
                         fmt::format("{}: a light of kind '{}' is not known; it is left out", who, source.type));
            continue;
        }
        add(scene, std::move(light));
    }
}

void read_cameras(const Document& document, const Hierarchy& hierarchy, Scene& scene, Remarks& remarks)
{
    constexpr double degrees = 180.0 / 3.14159265358979323846;
    for (std::size_t i = 0; i < document.model.nodes.size(); ++i) {
        const tinygltf::Node& node = document.model.nodes[i];
        if (node.camera < 0 || !hierarchy.is_shown[i]) continue;
        const std::string who = label("node", i, node.name);
        const tinygltf::Camera& source = checked(document.model.cameras, node.camera, "camera", who);
        CameraDesc camera;
        camera.name = source.name.empty() ? node.name : source.name;
        camera.node = {static_cast<uint>(i)};
        if (source.type == "orthographic") {
            camera.model.kind = camera_orthographic;
            const double half = std::min(std::abs(source.orthographic.xmag), std::abs(source.orthographic.ymag));
            if (half > 0.0 && half < 1e18)
                camera.model.half_side = static_cast<float>(half);
            else
                remarks.warn("orthographic",
                             fmt::format("{}: a camera that shows nothing; it shows as much as one with "
                                         "perspective would at its target",
                                         who));
        } else {
            // Ours is the angle of the shorter side: the height, unless the picture is upright.
            const double y = source.perspective.yfov, aspect = source.perspective.aspectRatio;
            const double angle = aspect > 0.0 && aspect < 1.0 ? 2.0 * std::atan(std::tan(0.5 * y) * aspect) : y;
            if (angle > 0.0 && angle * degrees < 180.0)
                camera.fov_degrees = static_cast<float>(angle * degrees);
            else
                remarks.warn("fov", fmt::format("{}: a field of view of {} radians; it becomes {} degrees", who, y,
                                                camera.fov_degrees));
        }
        add(scene, std::move(camera));
    }
}

} // namespace snell::gltf
