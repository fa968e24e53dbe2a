#include "snell/core/parallel.h"
#include "snell/io/gltf/nodes.h"
#include "snell/scene/keyframes.h"

#include <algorithm>
#include <atomic>
#include <mutex>

namespace snell::gltf {
namespace {

// What a mesh of the file is needed for.
struct Use
{
    std::size_t shown = 0; // by how many nodes
    bool is_skinned = false;
    std::vector<Primitive> primitives;
    Index<Group> group; // of those primitives that keep their shape, once made
};

bool has_triangles(const Primitive& primitive)
{
    return !primitive.mesh.triangles.empty();
}

class Placer
{
  public:
    Placer(const Document& document, const Buffers& buffers, const Accessors& accessors, Budget& budget,
           const Hierarchy& hierarchy, const std::function<Index<MaterialDesc>(std::size_t, std::size_t)>& material_of,
           Scene& scene, Remarks& remarks)
        : document_(document), buffers_(buffers), accessors_(accessors), budget_(budget), hierarchy_(hierarchy),
          material_of_(material_of), scene_(scene), remarks_(remarks), uses_(document.model.meshes.size())
    {
    }

    void run(const std::function<void(double)>& progress)
    {
        count_uses();
        read(progress);
        for (std::size_t i = 0; i < document_.model.nodes.size(); ++i)
            if (document_.model.nodes[i].mesh >= 0 && hierarchy_.is_shown[i]) place(i);
    }

  private:
    void count_uses()
    {
        for (std::size_t i = 0; i < document_.model.nodes.size(); ++i) {
            const tinygltf::Node& node = document_.model.nodes[i];
            if (node.mesh < 0 || !hierarchy_.is_shown[i]) continue;
            Use& use = checked(uses_, node.mesh, "mesh", label("node", i, node.name));
            ++use.shown;
            if (node.skin < 0) continue;
            checked(document_.model.skins, node.skin, "skin", label("node", i, node.name));
            use.is_skinned = true;
        }
    }

    void read(const std::function<void(double)>& progress)
    {
        std::vector<std::pair<std::size_t, std::size_t>> jobs; // mesh, primitive
        for (std::size_t mesh = 0; mesh < uses_.size(); ++mesh) {
            if (uses_[mesh].shown == 0) continue;
            uses_[mesh].primitives.resize(document_.model.meshes[mesh].primitives.size());
            for (std::size_t k = 0; k < uses_[mesh].primitives.size(); ++k) jobs.emplace_back(mesh, k);
        }
        std::mutex mutex;
        std::size_t done = 0;
        parallel_for(jobs.size(), [&](std::size_t i) {
            const auto [mesh, k] = jobs[i];
            uses_[mesh].primitives[k] =
                read_primitive(document_, buffers_, accessors_, budget_, mesh, k, uses_[mesh].is_skinned);
            const std::lock_guard lock(mutex);
            progress(static_cast<double>(++done) / static_cast<double>(jobs.size()));
        });
        for (const auto& [mesh, k] : jobs) {
            Primitive& primitive = uses_[mesh].primitives[k];
            remarks_.append(primitive.remarks);
            const std::string& name = document_.model.meshes[mesh].name;
            primitive.mesh.name = uses_[mesh].primitives.size() == 1 ? name : fmt::format("{}.{}", name, k);
            primitive.mesh.material = material_of_(mesh, k);
        }
    }

    // A copy of what is used again, the thing itself at its last use.
    template <class T>
    T take(T& thing, bool is_last)
    {
        if (is_last) return std::move(thing);
        return thing;
    }

    void charge_copy(const Primitive& primitive, const std::string& who)
    {
        const Mesh& mesh = primitive.mesh;
        const std::size_t vertices = mesh.positions.size();
        constexpr std::size_t vertex_bytes = 160; // mesh, rig and joints
        budget_.charge(vertices, vertex_bytes + 36 * primitive.targets.size(), who + ": ");
        budget_.charge(mesh.triangles.size(), sizeof(uvec3), who + ": ");
    }

    void place(std::size_t number)
    {
        const tinygltf::Node& node = document_.model.nodes[number];
        Use& use = uses_[static_cast<std::size_t>(node.mesh)];
        const bool is_last = --use.shown == 0;
        const std::string who = label("node", number, node.name);
        const std::string& name = document_.model.meshes[static_cast<std::size_t>(node.mesh)].name;

        Group still{name, {}, {}}, morphing{name, {}, {}}, skinned{name, {}, {}};
        for (Primitive& primitive : use.primitives) {
            if (!has_triangles(primitive)) continue;
            const bool hangs = node.skin >= 0 && !primitive.joints.empty();
            if (!hangs && primitive.targets.empty()) {
                // One mesh for all nodes; it is moved into the scene by the first.
                if (use.group.valid()) continue;
                if (!use.is_skinned || is_last)
                    still.meshes.push_back(add(scene_, std::move(primitive.mesh)));
                else
                    still.meshes.push_back((charge_copy(primitive, who), add(scene_, primitive.mesh)));
                continue;
            }
            if (!is_last) charge_copy(primitive, who);
            Primitive own = take(primitive, is_last);
            (hangs ? skinned : morphing).meshes.push_back(add_rigged(std::move(own), number, hangs ? node.skin : -1));
        }
        if (!use.group.valid() && !still.meshes.empty()) use.group = add(scene_, std::move(still));
        if (use.group.valid()) place_group(use.group, number);
        if (!morphing.meshes.empty()) place_group(add(scene_, std::move(morphing)), number);
        // A skinned mesh is where its joints are, wherever its node is.
        if (!skinned.meshes.empty())
            add(scene_, InstanceDesc{node.name, add(scene_, std::move(skinned)), identity_transform(), {}});
    }

    Index<Mesh> add_rigged(Primitive primitive, std::size_t node, int skin)
    {
        Rig rig;
        rig.node = {static_cast<uint>(node)};
        rig.positions = primitive.mesh.positions;
        rig.normals = primitive.mesh.normals;
        rig.tangents = primitive.mesh.tangents;
        rig.targets = std::move(primitive.targets);
        if (skin >= 0) {
            rig.skin = {static_cast<uint>(skin)};
            rig.joints = std::move(primitive.joints);
            rig.weights = std::move(primitive.weights);
            mend_joints(rig, primitive.mesh.name);
        }
        rig.mesh = add(scene_, std::move(primitive.mesh));
        scene_.rigs.push_back(std::move(rig));
        return scene_.rigs.back().mesh;
    }

    // Joints that are none get no weight, and the rest makes up for it.
    void mend_joints(Rig& rig, const std::string& mesh)
    {
        const std::size_t count = scene_.skins[rig.skin.value].joints.size(), vertices = rig.positions.size();
        std::atomic<std::size_t> lost = 0;
        parallel_ranges(vertices, 1 << 14, [&](std::size_t begin, std::size_t end) {
            for (std::size_t v = begin; v < end; ++v) {
                float sum = 0.0f;
                for (std::size_t i = v; i < rig.joints.size(); i += vertices)
                    for (int k = 0; k < 4; ++k) {
                        float& weight = rig.weights[i][k];
                        if (rig.joints[i][k] >= count) {
                            if (weight != 0.0f) ++lost;
                            rig.joints[i][k] = 0;
                            weight = 0.0f;
                        }
                        weight = weight >= 0.0f && weight < 1e18f ? weight : 0.0f;
                        sum += weight;
                    }
                if (!(sum > 0.0f)) rig.weights[v] = vec4(1, 0, 0, 0), sum = 1.0f;
                for (std::size_t i = v; i < rig.joints.size(); i += vertices) rig.weights[i] /= sum;
            }
        });
        if (lost > 0)
            remarks_.warn("lost joints",
                          fmt::format("mesh '{}': {} weights are for joints that its skin of {} does not "
                                      "have; they are ignored",
                                      mesh, lost.load(), count));
    }

    void place_group(Index<Group> group, std::size_t number)
    {
        const tinygltf::Node& node = document_.model.nodes[number];
        const Fields instancing(node.extensions, "EXT_mesh_gpu_instancing");
        if (!instancing.exists()) {
            add(scene_, InstanceDesc{node.name, group, identity_transform(), {static_cast<uint>(number)}});
            return;
        }
        place_many(group, number, instancing.object("attributes"));
    }

    // The map of a node that does not move. All are found at once: walking up from each would take time in proportion
    // to the square of the depth.
    const Transform& world_of(std::size_t number)
    {
        if (worlds_.empty()) {
            worlds_.resize(document_.model.nodes.size());
            for (const uint i : hierarchy_.order) {
                const Node& node = scene_.nodes[i];
                const Transform local =
                    node.has_matrix ? node.matrix : compose_trs(node.translation, node.rotation, node.scale);
                worlds_[i] = node.parent.valid() ? compose(worlds_[node.parent.value], local) : local;
            }
        }
        return worlds_[number];
    }

    void place_many(Index<Group> group, std::size_t number, const Fields& attributes)
    {
        const std::string& name = document_.model.nodes[number].name;
        const std::string who = label("node", number, name) + ", instances";
        const int translation = attributes.integer("TRANSLATION", -1), rotation = attributes.integer("ROTATION", -1),
                  scale = attributes.integer("SCALE", -1);
        std::vector<vec3> translations, scales;
        std::vector<vec4> rotations;
        if (translation >= 0) translations = accessors_.vec3s(translation, who);
        if (rotation >= 0) rotations = accessors_.vec4s(rotation, who);
        if (scale >= 0) scales = accessors_.vec3s(scale, who);
        const std::size_t count = std::max({translations.size(), rotations.size(), scales.size()});
        for (const std::size_t given : {translations.size(), rotations.size(), scales.size()})
            if (given != 0 && given != count)
                throw Error(fmt::format("{} have {} and {} elements", who, given, count), "write the file again");

        const bool is_moving = hierarchy_.is_moving[number];
        budget_.charge(count, sizeof(InstanceDesc) + (is_moving ? sizeof(Node) : 0), who + ": ");
        const Index<Node> parent{static_cast<uint>(number)};
        const Transform world = world_of(number);
        std::size_t flat = 0;
        for (std::size_t i = 0; i < count; ++i) {
            Node own;
            own.parent = parent;
            if (!translations.empty()) own.translation = translations[i];
            if (!rotations.empty()) own.rotation = unit_quaternion(rotations[i]);
            if (!scales.empty()) own.scale = scales[i];
            InstanceDesc instance{name, group, identity_transform(), {}};
            if (is_moving) {
                instance.node = {static_cast<uint>(scene_.nodes.size())};
                scene_.nodes.push_back(std::move(own));
            } else {
                instance.transform = compose(world, compose_trs(own.translation, own.rotation, own.scale));
                if (!inverse(instance.transform)) { // nothing of it can be seen
                    ++flat;
                    continue;
                }
            }
            add(scene_, std::move(instance));
        }
        if (flat > 0)
            remarks_.warn("flat instances",
                          fmt::format("{}: {} of {} are flattened to nothing and left out", who, flat, count));
    }

    const Document& document_;
    const Buffers& buffers_;
    const Accessors& accessors_;
    Budget& budget_;
    const Hierarchy& hierarchy_;
    const std::function<Index<MaterialDesc>(std::size_t, std::size_t)>& material_of_;
    Scene& scene_;
    Remarks& remarks_;
    std::vector<Use> uses_;         // by mesh
    std::vector<Transform> worlds_; // by node, once they are needed
};

} // namespace

void read_meshes(const Document& document, const Buffers& buffers, const Accessors& accessors, Budget& budget,
                 const Hierarchy& hierarchy,
                 const std::function<Index<MaterialDesc>(std::size_t, std::size_t)>& material_of,
                 const std::function<void(double)>& progress, Scene& scene, Remarks& remarks)
{
    Placer(document, buffers, accessors, budget, hierarchy, material_of, scene, remarks).run(progress);
}

} // namespace snell::gltf
