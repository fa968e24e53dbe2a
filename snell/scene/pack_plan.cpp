#include "snell/scene/pack_plan.h"

#include "snell/core/error.h"
#include "snell/scene/pack_parts.h"

#include <algorithm>

namespace snell {

static constexpr std::size_t max_primitives = std::size_t{1} << 30; // two bits of Hit::primitive hold the kind

// ---- what moves ----

// Nodes that some animation moves, by themselves or with an ancestor.
static std::vector<std::uint8_t> moving_nodes(const Scene& scene)
{
    const std::size_t count = scene.nodes.size();
    std::vector<std::uint8_t> moves(count, 0), known(count, 0);
    for (const Animation& animation : scene.animations)
        for (const AnimationChannel& channel : animation.channels)
            if (channel.property != AnimatedProperty::weights)
                moves[channel.node.value] = known[channel.node.value] = 1;
    std::vector<uint> waiting;
    for (uint start = 0; start < count; ++start) {
        uint node = start;
        for (; node != none && known[node] == 0; node = scene.nodes[node].parent.value) waiting.push_back(node);
        const std::uint8_t carried = node != none ? moves[node] : std::uint8_t{0};
        for (; !waiting.empty(); waiting.pop_back()) {
            moves[waiting.back()] = carried;
            known[waiting.back()] = 1;
        }
    }
    return moves;
}

std::vector<std::uint8_t> moving_groups(const Scene& scene)
{
    const std::vector<std::uint8_t> nodes = moving_nodes(scene);
    std::vector<std::uint8_t> has_weights(scene.nodes.size(), 0), meshes(scene.meshes.size(), 0);
    for (const Animation& animation : scene.animations)
        for (const AnimationChannel& channel : animation.channels)
            if (channel.property == AnimatedProperty::weights) has_weights[channel.node.value] = 1;
    for (const Rig& rig : scene.rigs) {
        bool moves = rig.node.valid() && has_weights[rig.node.value] != 0;
        if (rig.skin.valid())
            for (const Index<Node> joint : scene.skins[rig.skin.value].joints) moves = moves || nodes[joint.value] != 0;
        if (moves) meshes[rig.mesh.value] = 1;
    }

    std::vector<std::uint8_t> groups(scene.groups.size(), 0);
    for (std::size_t g = 0; g < scene.groups.size(); ++g)
        for (const Index<Mesh> mesh : scene.groups[g].meshes)
            if (meshes[mesh.value] != 0) groups[g] = 1;
    for (const InstanceDesc& instance : scene.instances)
        if (instance.node.valid() && nodes[instance.node.value] != 0) groups[instance.group.value] = 1;
    return groups;
}

// ---- the plan ----

static bool is_unrotated(const Transform& m)
{
    return m.x.x > 0.0f && m.y.y > 0.0f && m.z.z > 0.0f && m.x.y == 0.0f && m.x.z == 0.0f && m.y.x == 0.0f &&
           m.y.z == 0.0f && m.z.x == 0.0f && m.z.y == 0.0f;
}

// A map that makes spheres ellipsoids, or that turns textured ones, cannot be applied beforehand.
static bool can_be_baked(const Scene& scene, const std::vector<std::uint8_t>& textured, const InstanceDesc& instance)
{
    const Group& group = scene.groups[instance.group.value];
    if (group.spheres.empty()) return true;
    if (uniform_scale(instance.transform) == 0.0f) return false;
    if (is_unrotated(instance.transform)) return true;
    return std::none_of(group.spheres.begin(), group.spheres.end(), [&](Index<SphereDesc> sphere) {
        return textured[scene.spheres[sphere.value].material.value] != 0;
    });
}

std::vector<std::uint8_t> textured_materials(const std::vector<Material>& materials)
{
    std::vector<std::uint8_t> textured;
    textured.reserve(materials.size());
    for (const Material& material : materials) textured.push_back(is_textured(material) ? 1 : 0);
    return textured;
}

std::vector<uint> baked_instances(const Scene& scene, const std::vector<std::uint8_t>& textured,
                                  std::vector<std::uint8_t>& stays)
{
    std::vector<std::size_t> uses(scene.groups.size(), 0);
    for (const InstanceDesc& instance : scene.instances) ++uses[instance.group.value];
    std::vector<uint> baked;
    for (std::size_t i = 0; i < scene.instances.size(); ++i) {
        const InstanceDesc& instance = scene.instances[i];
        const uint g = instance.group.value;
        if (stays[g] != 0 || uses[g] > 1 || !can_be_baked(scene, textured, instance))
            stays[g] = 1;
        else
            baked.push_back(static_cast<uint>(i));
    }
    return baked;
}

namespace {
class Planner
{
  public:
    Planner(const Scene& scene, const std::vector<Material>& materials) : scene_(scene), materials_(materials)
    {
        plan_.meshes.resize(scene.meshes.size());
    }

    PackPlan run(std::vector<std::uint8_t> stays);

  private:
    void plan_mesh(uint mesh);
    PackedGroup add_group(const Group& group, uint baked, uint number);

    const Scene& scene_;
    const std::vector<Material>& materials_;
    PackPlan plan_;
};
} // namespace

void Planner::plan_mesh(uint index)
{
    MeshPlan& plan = plan_.meshes[index];
    if (plan.planned) return;
    plan.planned = true;
    const Mesh& mesh = scene_.meshes[index];
    if (!mesh.uvs.empty()) {
        plan.uv_base = static_cast<uint>(plan_.uvs);
        plan_.uvs += mesh.uvs.size();
    }
    if (!mesh.uvs_1.empty()) {
        plan.uv_1_base = static_cast<uint>(plan_.uvs);
        plan_.uvs += mesh.uvs_1.size();
    }
    if (!mesh.colors.empty()) {
        plan.color_base = static_cast<uint>(plan_.colors);
        plan_.colors += mesh.colors.size();
    }
    if (mesh.triangles.empty()) return;
    if (mesh.triangle_materials.empty()) {
        plan.runs = {{mesh.material.value, static_cast<uint>(mesh.triangles.size())}};
        return;
    }
    // Count neighbours of one material together first: what is then sorted is short for ordinary meshes.
    for (const Index<MaterialDesc> material : mesh.triangle_materials) {
        if (plan.runs.empty() || plan.runs.back().material != material.value) plan.runs.push_back({material.value, 0});
        ++plan.runs.back().count;
    }
    std::sort(plan.runs.begin(), plan.runs.end(),
              [](const MaterialRun& a, const MaterialRun& b) { return a.material < b.material; });
    std::size_t kept = 0;
    for (std::size_t i = 1; i < plan.runs.size(); ++i) {
        if (plan.runs[i].material == plan.runs[kept].material)
            plan.runs[kept].count += plan.runs[i].count;
        else
            plan.runs[++kept] = plan.runs[i];
    }
    plan.runs.resize(kept + 1);
    plan.runs.shrink_to_fit();
}

// Appends the group's primitives. number: where the group will be in PackedScene::groups.
PackedGroup Planner::add_group(const Group& group, uint baked, uint number)
{
    PackedGroup result;
    result.first_triangle = static_cast<uint>(plan_.triangles);
    result.first_sphere = static_cast<uint>(plan_.sphere_placements.size());
    for (const Index<Mesh> index : group.meshes) {
        const Mesh& mesh = scene_.meshes[index.value];
        if (mesh.triangles.empty()) continue;
        MeshPlan& plan = plan_.meshes[index.value];
        const bool is_first = !plan.planned;
        plan_mesh(index.value);

        const bool is_shared = baked == none && plan.object_positions != none;
        const auto base = [is_shared](uint shared, std::size_t next) {
            return is_shared ? shared : static_cast<uint>(next);
        };
        MeshPlacement p = {};
        p.mesh = index.value;
        p.baked = baked;
        p.group = number;
        p.writes_vertices = !is_shared;
        p.writes_uvs = is_first;
        p.first_vertex = base(plan.object_positions, plan_.positions);
        p.normal_base = mesh.normals.empty() ? none : base(plan.object_normals, plan_.normals);
        p.tangent_base = mesh.tangents.empty() ? none : base(plan.object_tangents, plan_.tangents);
        p.first_triangle = static_cast<uint>(plan_.triangles);
        p.first_surface = static_cast<uint>(plan_.surfaces);
        plan_.mesh_placements.push_back(p);
        if (baked == none) {
            plan.object_positions = p.first_vertex;
            plan.object_normals = p.normal_base;
            plan.object_tangents = p.tangent_base;
        }
        if (!is_shared) {
            plan_.positions += mesh.positions.size();
            plan_.normals += mesh.normals.size();
            plan_.tangents += mesh.tangents.size();
        }
        plan_.triangles += mesh.triangles.size();
        plan_.surfaces += plan.runs.size();
        if (plan_.triangles >= max_primitives || plan_.positions >= none)
            throw Error(fmt::format("the scene has more than {} triangles or {} vertices, the most that one can hold",
                                    max_primitives - 1, none - 1));
    }
    for (const Index<SphereDesc> sphere : group.spheres) plan_.sphere_placements.push_back({sphere.value, baked});
    if (plan_.sphere_placements.size() >= max_primitives)
        throw Error(fmt::format("the scene has more than {} spheres, the most that one can hold", max_primitives - 1));
    result.triangle_count = static_cast<uint>(plan_.triangles) - result.first_triangle;
    result.sphere_count = static_cast<uint>(plan_.sphere_placements.size()) - result.first_sphere;
    return result;
}

PackPlan Planner::run(std::vector<std::uint8_t> stays)
{
    plan_.baked = baked_instances(scene_, textured_materials(materials_), stays);
    for (const uint i : plan_.baked) add_group(scene_.groups[scene_.instances[i].group.value], i, none);
    plan_.world.triangle_count = static_cast<uint>(plan_.triangles);
    plan_.world.sphere_count = static_cast<uint>(plan_.sphere_placements.size());

    std::vector<uint> group_number(scene_.groups.size(), none);
    for (std::size_t i = 0; i < scene_.instances.size(); ++i) {
        const uint g = scene_.instances[i].group.value;
        if (stays[g] == 0) continue;
        if (group_number[g] == none) {
            group_number[g] = static_cast<uint>(plan_.groups.size());
            plan_.groups.push_back({g, add_group(scene_.groups[g], none, group_number[g])});
        }
        const PackedGroup& group = plan_.groups[group_number[g]].packed;
        if (group.triangle_count == 0 && group.sphere_count == 0) continue;
        plan_.instances.push_back({static_cast<uint>(i), group_number[g]});
    }
    return std::move(plan_);
}

PackPlan plan_pack(const Scene& scene, const std::vector<Material>& materials, const std::vector<std::uint8_t>& stays)
{
    return Planner(scene, materials).run(stays);
}

} // namespace snell
