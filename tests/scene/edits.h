// A scene with something of everything that can be edited, edits of it drawn at random, and scenes compared as a whole.
#pragma once

#include "snell/scene/edit.h"
#include "tests/scene/moving_scene.h"

#include <random>

namespace snell::test {

inline Image picture(const char* name, uint width, uint height, uint format, uint seed)
{
    std::mt19937 random(seed);
    Image image{name, width, height, format, {}, {}};
    for (uint i = 0; i < 4 * width * height; ++i) {
        const uint r = static_cast<uint>(random() >> 24);
        if (format == texels_rgba32f)
            image.floats.push_back(static_cast<float>(r) / 16.0f);
        else
            image.bytes.push_back(static_cast<std::uint8_t>(r));
    }
    return image;
}

// moving_scene() among planes, spheres (one textured, one squeezed to an ellipsoid), principled, glass and masked
// materials, a mesh that stands still in two materials, and a sky.
inline Scene editable_scene()
{
    Scene scene = moving_scene();
    const Index<Image> checks = add(scene, picture("checks", 4, 4, texels_rgba8_srgb, 1));
    const Index<Image> sky = add(scene, picture("sky", 16, 8, texels_rgba32f, 2));
    scene.environment.image = sky;
    scene.environment.radiance = vec3(0.2f);
    const auto material = [&](const char* name, uint kind) {
        MaterialDesc m;
        m.name = name;
        m.kind = kind;
        if (kind == material_conductor) m.specular = vec3(0.2f, 0.9f, 1.1f), m.absorption = vec3(3.9f, 2.5f, 2.1f);
        return add(scene, m);
    };
    const auto metal = material("metal", material_conductor), glass = material("glass", material_dielectric);
    const auto coat = material("coat", material_principled), leaf = material("leaf", material_diffuse);
    scene.materials[leaf.value].coverage = coverage_mask;
    scene.materials[leaf.value].opacity_texture.image = checks;
    scene.materials[coat.value].base_texture.image = checks;
    SphereDesc ball;
    ball.radius = 0.3f;
    for (const auto& [m, at] : {std::pair{metal, vec3(-2, 0, 0)}, {glass, vec3(2, 0, 0)}, {coat, vec3(0, 2, -1)}}) {
        ball.material = m;
        ball.center = at;
        place(scene, ball);
    }
    scene.instances.back().transform = rotation(vec3(0, 1, 0), 30.0f); // the textured one is turned: stays apart
    ball.material = glass;
    place(scene, ball);
    scene.instances.back().transform = compose(translation(vec3(1, 1, 1)), scaling(vec3(1, 2, 1)));
    Mesh two = make_torus("still two", 0.3f, 0.1f, 8, 6, leaf);
    for (std::size_t i = 0; i < two.triangles.size(); ++i) two.triangle_materials.push_back(i % 3 == 0 ? coat : leaf);
    place(scene, two, translation(vec3(-1, 1, 1)));
    PlaneDesc floor;
    floor.point = vec3(0, -1.5f, 0);
    floor.material = leaf;
    add(scene, floor);
    CameraDesc second = scene.cameras[0];
    second.eye = vec3(3, 1, 3);
    add(scene, second);
    validate(scene);
    return scene;
}

// ---- edits ----

class RandomEdits
{
  public:
    explicit RandomEdits(uint seed) : random_(seed) {}

    float number(float lower, float upper) { return std::uniform_real_distribution<float>(lower, upper)(random_); }
    vec3 vector(float lower, float upper) { return {number(lower, upper), number(lower, upper), number(lower, upper)}; }
    uint below(std::size_t count) { return static_cast<uint>(random_() % count); }

    MaterialDesc material(const Scene& scene, MaterialDesc m)
    {
        const auto texture = [&](TextureRef& ref) {
            ref = {};
            if (below(3) == 0) ref.image = {below(scene.images.size())};
            if (ref.valid() && scene.images[ref.image.value].format == texels_rgba32f) ref = {};
        };
        switch (below(7)) {
        case 0:
            m.kind = below(material_kinds);
            break;
        case 1:
            m.emission = below(2) == 0 ? vec3(0.0f) : vector(0.0f, 5.0f);
            m.two_sided_emission = below(2) == 0;
            break;
        case 2:
            texture(m.base_texture);
            texture(m.normal_texture);
            break;
        case 3:
            texture(m.emission_texture);
            m.single_sided = below(2) == 0;
            break;
        case 4:
            m.coverage = below(3);
            m.opacity = number(0.0f, 1.0f);
            texture(m.opacity_texture);
            break;
        case 5:
            m.kind = material_principled;
            m.principled.roughness = number(0.0f, 1.0f);
            m.principled.anisotropy = number(-1.0f, 1.0f);
            m.principled.transmission = number(-1.0f, 1.0f);
            m.principled.thin_walled = below(2) == 0;
            texture(m.principled.roughness_texture);
            break;
        default:
            m.base_color = vector(0.0f, 1.0f);
            m.alpha = number(0.0f, 1.0f);
            m.ior = below(2) == 0 ? 1.3f : 1.5f;
            m.absorption = vector(0.1f, 1.0f);
            m.specular = vector(0.1f, 1.0f);
        }
        return m;
    }

    LightDesc light(LightDesc l)
    {
        l.emission = vector(0.0f, 9.0f);
        if (l.node.valid()) return l;
        l.kind = below(3);
        l.position = vector(-3.0f, 3.0f);
        l.direction = vector(-1.0f, 1.0f);
        return l;
    }

    Transform transform()
    {
        const Transform turned = compose(translation(vector(-2.0f, 2.0f)), rotation(vector(-1.0f, 1.0f), 50.0f));
        if (below(3) == 0) return translation(vector(-2.0f, 2.0f));
        return compose(turned, scaling(below(2) == 0 ? vec3(number(0.5f, 2.0f)) : vector(-2.0f, -0.5f)));
    }

    // Of one of `kinds` kinds; some are refused by apply_edit().
    static constexpr uint kinds = 16;
    Edit edit(const Scene& scene, uint kind)
    {
        const Index<MaterialDesc> some_material{below(scene.materials.size())};
        switch (kind) {
        case 0:
            return AddMaterial{material(scene, scene.materials[some_material.value])};
        case 1: {
            const Index<Mesh> mesh{below(scene.meshes.size())};
            const auto& each = scene.meshes[mesh.value].triangle_materials;
            return AssignMaterial{mesh, each.empty() ? scene.meshes[mesh.value].material : each[0], some_material};
        }
        case 2:
            return AddImage{std::make_shared<const Image>(
                picture("added", 8, 4, below(2) == 0 ? texels_rgba8_srgb : texels_rgba32f, below(1000)))};
        case 3: {
            const uint i = below(scene.lights.size());
            return SetLight{i, light(scene.lights[i])};
        }
        case 4:
            return AddLight{below(scene.lights.size() + 1), light({})};
        case 5:
            if (scene.lights.size() < 2) return AddLight{0, light({})};
            return RemoveLight{below(scene.lights.size())};
        case 6: {
            const uint i = below(scene.cameras.size());
            SetCamera set{i, scene.cameras[i]};
            set.value.fov_degrees = number(20.0f, 80.0f);
            return set;
        }
        case 7:
            return AddCamera{below(scene.cameras.size() + 1), scene.cameras[0]};
        case 8:
            return RemoveCamera{below(scene.cameras.size())};
        case 9: {
            SetEnvironment set{scene.environment};
            EnvironmentDesc& e = set.value;
            e.radiance = below(4) == 0 ? vec3(0.0f) : vector(0.0f, 1.0f);
            e.visible = below(2) == 0;
            e.mapping = below(2);
            e.to_world = rotation(vec3(0, 1, 0), number(0.0f, 360.0f));
            e.image = {below(3) == 0 ? none : below(scene.images.size())};
            return set;
        }
        case 10: {
            const Index<Node> node{below(scene.nodes.size())};
            SetNode set{node, scene.nodes[node.value]};
            set.value.translation += vector(-0.5f, 0.5f);
            set.value.scale *= number(0.5f, 1.5f);
            return set;
        }
        case 11: {
            const Index<SphereDesc> sphere{below(scene.spheres.size())};
            SetSphere set{sphere, scene.spheres[sphere.value]};
            set.value.center += vector(-0.5f, 0.5f);
            set.value.radius *= number(0.5f, 1.5f);
            if (below(2) == 0) set.value.material = some_material;
            return set;
        }
        case 12: {
            const uint plane = below(scene.planes.size());
            SetPlane set{plane, scene.planes[plane]};
            set.value.normal = vector(-0.2f, 0.2f) + vec3(0, 1, 0);
            set.value.material = some_material;
            return set;
        }
        case 13:
            return Rename{ScenePart::material, some_material.value, "renamed"};
        case 14:
            return SetTransform{below(scene.instances.size()), transform()};
        default:
            return SetMaterial{some_material, material(scene, scene.materials[some_material.value])};
        }
    }
    // Of any kind, those of materials and transforms more often.
    Edit edit(const Scene& scene) { return edit(scene, below(2) == 0 ? below(kinds) : kinds - 1 - below(2)); }

  private:
    std::mt19937 random_;
};

// ---- comparison ----

// Everything that a scene consists of, one byte after the other.
class Bytes
{
  public:
    std::string text;

    void add(const Scene& s)
    {
        add(s.name);
        each(s.images,
             [&](const Image& i) { add(i.name), raw(i.width, i.height, i.format), all(i.bytes), all(i.floats); });
        each(s.materials, [&](const MaterialDesc& m) { add(m); });
        each(s.meshes, [&](const Mesh& m) {
            add(m.name), all(m.positions), all(m.normals), all(m.tangents), all(m.uvs), all(m.uvs_1), all(m.colors);
            all(m.triangles), all(m.triangle_materials), raw(m.material);
        });
        each(s.spheres, [&](const SphereDesc& d) { add(d.name), raw(d.center, d.radius, d.material); });
        each(s.planes, [&](const PlaneDesc& d) { add(d.name), raw(d.point, d.normal, d.material); });
        each(s.groups, [&](const Group& g) { add(g.name), all(g.meshes), all(g.spheres); });
        each(s.instances, [&](const InstanceDesc& i) { add(i.name), raw(i.group, i.transform, i.node); });
        each(s.lights, [&](const LightDesc& l) {
            add(l.name), raw(l.kind, l.position, l.direction, l.emission, l.inner_degrees, l.outer_degrees, l.node);
        });
        each(s.cameras,
             [&](const CameraDesc& c) { add(c.name), raw(c.eye, c.target, c.up, c.fov_degrees, c.mirrored, c.node); });
        const EnvironmentDesc& e = s.environment;
        raw(e.radiance, e.image, e.mapping, e.to_world, e.visible);
        each(s.nodes, [&](const Node& n) {
            add(n.name), raw(n.parent, n.translation, n.rotation, n.scale, n.has_matrix, n.matrix), all(n.weights);
            raw(n.posed.has_value(), n.posed.value_or(Transform{}));
        });
        each(s.skins, [&](const Skin& k) { add(k.name), all(k.joints), all(k.inverse_bind); });
        each(s.rigs, [&](const Rig& r) {
            raw(r.mesh, r.node, r.skin), all(r.positions), all(r.normals), all(r.tangents), all(r.joints),
                all(r.weights);
            each(r.targets, [&](const MorphTarget& t) { all(t.positions), all(t.normals), all(t.tangents); });
        });
        each(s.animations, [&](const Animation& a) {
            add(a.name), raw(a.duration);
            each(a.channels, [&](const AnimationChannel& c) {
                raw(c.node, c.property, c.interpolation), all(c.times), all(c.values);
            });
        });
        each(s.variants, [&](const std::string& v) { add(v); });
        each(s.notes, [&](const Note& n) { raw(n.kind), add(n.text); });
    }

  private:
    template <class... T>
    void raw(const T&... values)
    {
        (text.append(reinterpret_cast<const char*>(&values), sizeof(T)), ...);
    }
    template <class T>
    void all(const std::vector<T>& items)
    {
        raw(items.size());
        text.append(reinterpret_cast<const char*>(items.data()), items.size() * sizeof(T));
    }
    template <class T, class F>
    void each(const std::vector<T>& items, const F& f)
    {
        raw(items.size());
        for (const T& item : items) f(item);
    }
    void add(const std::string& s)
    {
        raw(s.size());
        text += s;
    }
    void add(const TextureRef& t) { raw(t.image, t.uv_set, t.wrap_u, t.wrap_v, t.filter, t.channel, t.row_u, t.row_v); }
    void add(const MaterialDesc& m)
    {
        add(m.name);
        raw(m.kind, m.base_color, m.emission, m.two_sided_emission, m.alpha, m.specular, m.ior, m.absorption,
            m.texture_tints_specular, m.normal_scale, m.coverage, m.opacity, m.cutoff, m.single_sided);
        for (const TextureRef* t : {&m.base_texture, &m.emission_texture, &m.normal_texture, &m.opacity_texture})
            add(*t);
        const PrincipledDesc& p = m.principled;
        raw(p.metallic, p.roughness, p.specular, p.specular_color, p.clearcoat, p.clearcoat_roughness,
            p.clearcoat_normal_scale, p.sheen_color, p.sheen_roughness, p.transmission, p.thin_walled, p.anisotropy,
            p.anisotropy_rotation, p.iridescence, p.iridescence_ior, p.iridescence_thickness_min,
            p.iridescence_thickness_max, p.dispersion, p.diffuse_transmission, p.diffuse_transmission_color);
        for (const TextureRef* t : {&p.metallic_texture, &p.roughness_texture, &p.specular_texture}) add(*t);
    }
};

inline std::string bytes(const Scene& scene)
{
    Bytes b;
    b.add(scene);
    return b.text;
}

} // namespace snell::test
