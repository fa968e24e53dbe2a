// Meshes, spheres and planes, and where they are placed.
#include "snell/io/pbrt/slots.h"
#include "snell/io/pbrt/write_parts.h"
#include "snell/io/ply/write.h"

#include <algorithm>
#include <numeric>
#include <span>

namespace snell::pbrt {
namespace {

constexpr std::size_t most_in_text = 64; // vertices and triangles of a mesh that needs no file

// A shape without its place.
struct Shape
{
    std::string name;
    uint material = none;
    std::string text;
};

template <class T>
std::vector<T> gathered(const std::vector<T>& from, std::span<const uint> vertices)
{
    std::vector<T> to;
    if (from.empty()) return to;
    to.reserve(vertices.size());
    for (const uint v : vertices) to.push_back(from[v]);
    return to;
}

// Some triangles of a mesh with the vertices that they use, in their order. scratch: as long as the mesh has vertices,
// and none everywhere, before and after.
Mesh part_of(const Mesh& mesh, std::span<const uint> triangles, std::vector<uint>& scratch)
{
    std::vector<uint> vertices;
    for (const uint i : triangles)
        for (int k = 0; k < 3; ++k) {
            uint& number = scratch[mesh.triangles[i][k]];
            if (number != none) continue;
            number = 0;
            vertices.push_back(mesh.triangles[i][k]);
        }
    std::sort(vertices.begin(), vertices.end());
    for (std::size_t v = 0; v < vertices.size(); ++v) scratch[vertices[v]] = static_cast<uint>(v);
    Mesh part;
    part.positions = gathered(mesh.positions, vertices);
    part.normals = gathered(mesh.normals, vertices);
    part.tangents = gathered(mesh.tangents, vertices);
    part.uvs = gathered(mesh.uvs, vertices);
    part.uvs_1 = gathered(mesh.uvs_1, vertices);
    part.colors = gathered(mesh.colors, vertices);
    part.triangles.reserve(triangles.size());
    for (const uint i : triangles) {
        const uvec3 t = mesh.triangles[i];
        part.triangles.emplace_back(scratch[t.x], scratch[t.y], scratch[t.z]);
    }
    for (const uint v : vertices) scratch[v] = none;
    return part;
}

template <class T>
void append_list(std::string& text, const char* what, const std::vector<T>& list)
{
    if (list.empty()) return;
    text += fmt::format(" \"{}\" [", what);
    for (const T& item : list)
        for (int k = 0; k < T::length(); ++k) fmt::format_to(std::back_inserter(text), " {}", item[k]);
    text += " ]";
}

std::string in_text(const Mesh& mesh)
{
    std::string text = "Shape \"trianglemesh\"";
    append_list(text, "integer indices", mesh.triangles);
    append_list(text, "point3 P", mesh.positions);
    append_list(text, "normal N", mesh.normals);
    append_list(text, "point2 uv", mesh.uvs);
    append_list(text, "point2 uv1", mesh.uvs_1);
    append_list(text, "float tangents", mesh.tangents);
    append_list(text, "float colors", mesh.colors);
    return text;
}

bool has_texture(const MaterialDesc& desc)
{
    bool has = false;
    for_each_texture(desc, [&](const TextureRef&) { has = true; });
    return has;
}

class ShapeWriter
{
  public:
    explicit ShapeWriter(Writer& writer) : w_(writer), of_mesh_(writer.scene.meshes.size()) {}

    void run()
    {
        for (std::size_t g = 0; g < w_.scene.groups.size(); ++g)
            if (w_.plan.is_object[g]) object(static_cast<uint>(g));
        for (const InstanceDesc& instance : w_.scene.instances) place(instance);
        for (const PlaneDesc& plane : w_.scene.planes)
            put({plane.name, plane.material.value,
                 fmt::format("Shape \"plane\" \"point3 P\" [ {} ] \"normal N\" [ {} ]", show(plane.point),
                             show(plane.normal))},
                nullptr, {});
    }

  private:
    Shape mesh_shape(const Mesh& mesh, const std::string& name, uint material)
    {
        // pbrt gives triangles without texture coordinates some of its own, but not those of PLY files.
        const bool is_small = mesh.positions.size() <= most_in_text && mesh.triangles.size() <= most_in_text &&
                              !(mesh.uvs.empty() && has_texture(w_.scene.materials[material]));
        if (is_small) return {name, material, in_text(mesh)};
        const SideFolder::Slot slot = w_.meshes.next(".ply");
        if (w_.writes_files) write_ply(slot.path, mesh);
        return {name, material, fmt::format("Shape \"plymesh\" \"string filename\" {}", in_quotes(slot.reference))};
    }

    // The shapes that a mesh becomes, one for each material; made once.
    const std::vector<Shape>& shapes_of(Index<Mesh> index)
    {
        std::vector<Shape>& shapes = of_mesh_[index.value];
        const std::vector<uint>& materials = w_.plan.of_mesh[index.value];
        if (!shapes.empty() || materials.empty()) return shapes;
        const Mesh& mesh = w_.scene.meshes[index.value];
        if (materials.size() == 1) {
            shapes.push_back(mesh_shape(mesh, mesh.name, materials[0]));
            return shapes;
        }
        std::vector<uint> order(mesh.triangles.size());
        std::iota(order.begin(), order.end(), 0u);
        std::stable_sort(order.begin(), order.end(), [&](uint a, uint b) {
            return mesh.triangle_materials[a].value < mesh.triangle_materials[b].value;
        });
        std::vector<uint> scratch(mesh.positions.size(), none);
        for (std::size_t begin = 0; begin < order.size();) {
            const uint material = mesh.triangle_materials[order[begin]].value;
            std::size_t end = begin;
            while (end < order.size() && mesh.triangle_materials[order[end]].value == material) ++end;
            shapes.push_back(
                mesh_shape(part_of(mesh, std::span(order).subspan(begin, end - begin), scratch), mesh.name, material));
            begin = end;
        }
        return shapes;
    }

    Shape sphere_shape(const SphereDesc& sphere) const
    {
        return {sphere.name, sphere.material.value, fmt::format("Shape \"sphere\" \"float radius\" {}", sphere.radius)};
    }

    // Ours have their pole along y and pbrt's along z; where this matters, the sphere is turned.
    std::string sphere_place(const SphereDesc& sphere) const
    {
        const MaterialDesc& desc = w_.scene.materials[sphere.material.value];
        if (has_texture(desc) || desc.principled.anisotropy > 0.0f) {
            Transform turned = {{0, -1, 0, sphere.center.x}, {0, 0, 1, sphere.center.y}, {-1, 0, 0, sphere.center.z}};
            return "Transform " + show(turned);
        }
        return sphere.center == vec3(0.0f) ? std::string() : "Translate " + show(sphere.center);
    }

    // One shape at its place, in the world or an object.
    void put(const Shape& shape, const std::string* instance, const std::string& place)
    {
        const bool is_lamp = w_.plan.is_lamp[shape.material];
        w_.line("AttributeBegin");
        if (!shape.name.empty()) w_.line("  Attribute \"shape\" \"string name\" {}", in_quotes(shape.name));
        if (instance != nullptr && !instance->empty() && *instance != shape.name)
            w_.line("  Attribute \"shape\" \"string instance\" {}", in_quotes(*instance));
        if (!place.empty()) w_.line("  {}", place);
        w_.line("  NamedMaterial {}", in_quotes(w_.plan.material[shape.material]));
        const MaterialDesc& desc = w_.scene.materials[shape.material];
        if (is_lamp)
            w_.line("  AreaLightSource \"diffuse\" \"rgb L\" [ {} ]{}", show(desc.emission),
                    desc.two_sided_emission ? " \"bool twosided\" true" : "");
        w_.line("  {}\nAttributeEnd", shape.text);
    }

    void put_all(const Group& group, const std::string* instance, const std::string& at)
    {
        for (const Index<Mesh> mesh : group.meshes)
            for (const Shape& shape : shapes_of(mesh)) put(shape, instance, at);
        for (const Index<SphereDesc> index : group.spheres) {
            const SphereDesc& sphere = w_.scene.spheres[index.value];
            put(sphere_shape(sphere), instance, sphere_place(sphere));
        }
    }

    void object(uint number)
    {
        w_.line("ObjectBegin {}", in_quotes(w_.plan.object[number]));
        put_all(w_.scene.groups[number], nullptr, {});
        w_.line("ObjectEnd");
    }

    void place(const InstanceDesc& instance)
    {
        const Group& group = w_.scene.groups[instance.group.value];
        const std::string at =
            is_identity(instance.transform) ? std::string() : "Transform " + show(instance.transform);
        if (!w_.plan.is_object[instance.group.value]) {
            put_all(group, &instance.name, at);
            return;
        }
        const std::string& name = w_.plan.object[instance.group.value];
        w_.line("AttributeBegin");
        if (!instance.name.empty() && instance.name != name)
            w_.line("  Attribute \"shape\" \"string instance\" {}", in_quotes(instance.name));
        if (!at.empty()) w_.line("  {}", at);
        w_.line("  ObjectInstance {}\nAttributeEnd", in_quotes(name));
    }

    Writer& w_;
    std::vector<std::vector<Shape>> of_mesh_;
};

} // namespace

void write_shapes(Writer& w)
{
    ShapeWriter(w).run();
}

} // namespace snell::pbrt
