// Shapes other than .ply files.
#include "snell/io/pbrt/loader.h"
#include "snell/io/pbrt/slots.h"
#include "snell/io/pbrt/subdivide.h"
#include "snell/io/pbrt/tessellate.h"
#include "snell/io/text_cursor.h"

#include <algorithm>
#include <cmath>

namespace snell::pbrt {
namespace {

constexpr float degree = 0.01745329252f;

// Segments of a whole turn; coarse when much has been cut into triangles already.
uint segments_for(Loader& loader, const Spot& spot, uint rings)
{
    constexpr uint fine = 128, coarse = 12;
    const std::size_t wanted = std::size_t{2} * fine * rings;
    if (wanted <= loader.triangles_left) {
        loader.triangles_left -= wanted;
        return fine;
    }
    loader.warn(spot, "coarse", "so many round shapes have been cut into triangles that later ones become coarse");
    return coarse;
}

// Vertices that shapes spell out: triangles' indices, normals and texture coordinates.
Mesh read_vertices(Loader& loader, const ParameterList& parameters)
{
    Mesh mesh;
    mesh.positions = parameters.points3("P");
    if (mesh.positions.empty()) throw Error(parameters.spot.place(), "the shape has no points", "give it \"point3 P\"");
    const auto keep = [&](auto& list, std::string_view what) {
        if (list.empty() || list.size() == mesh.positions.size()) return;
        loader.warn(
            parameters.spot, "length of " + std::string(what),
            fmt::format("there are {} {} for {} points; they are left out", list.size(), what, mesh.positions.size()));
        list.clear();
    };
    mesh.normals = parameters.points3("N");
    keep(mesh.normals, "normals");
    for (const std::string_view name : {"uv", "st"})
        if (mesh.uvs.empty()) mesh.uvs = parameters.points2(name);
    keep(mesh.uvs, "texture coordinates");
    mesh.uvs_1 = parameters.points2("uv1"); // this and what follows: ours
    keep(mesh.uvs_1, "second texture coordinates");
    const auto fours = [&](std::string_view name, std::vector<vec4>& into) {
        const std::span<const float> n = parameters.numbers(name);
        for (std::size_t i = 0; i + 3 < n.size(); i += 4) into.emplace_back(n[i], n[i + 1], n[i + 2], n[i + 3]);
        keep(into, name);
    };
    fours("colors", mesh.colors);
    fours("tangents", mesh.tangents);
    if (parameters.find("S") != nullptr)
        loader.inform(parameters.spot, "S", "tangents \"S\" are left out: they follow from the texture coordinates");
    return mesh;
}

void check_indices(const ParameterList& parameters, std::span<const int> indices, std::size_t points, std::size_t each)
{
    const Parameter* p = parameters.find("indices", {Type::integer});
    const Place place = (p != nullptr ? p->spot : parameters.spot).place();
    if (indices.size() % each != 0)
        throw Error(place, fmt::format("{} indices are no multiple of {}", indices.size(), each), "some are missing");
    for (std::size_t i = 0; i < indices.size(); ++i)
        if (indices[i] < 0 || static_cast<std::size_t>(indices[i]) >= points)
            throw Error(place, fmt::format("index {} (number {}) of {} points", indices[i], i, points),
                        "indices count from 0");
}

std::vector<uvec3> read_triangles(const ParameterList& parameters, std::size_t points)
{
    const std::span<const int> indices = parameters.integers("indices");
    std::vector<uvec3> triangles;
    if (indices.empty()) {
        if (points != 3)
            throw Error(parameters.spot.place(), "the shape has no triangles", "give it \"integer indices\"");
        return {uvec3(0, 1, 2)};
    }
    check_indices(parameters, indices, points, 3);
    triangles.reserve(indices.size() / 3);
    for (std::size_t i = 0; i + 2 < indices.size(); i += 3)
        triangles.emplace_back(indices[i], indices[i + 1], indices[i + 2]);
    return triangles;
}

bool is_textured(const MaterialDesc& m)
{
    return m.base_texture.valid() || m.normal_texture.valid() || m.opacity_texture.valid() ||
           m.principled.roughness_texture.valid();
}

// Whether it matters how a sphere is turned.
bool has_direction(const MaterialDesc& m, const MaterialUse& use, const Loader& loader)
{
    bool has = use.alpha != none || m.principled.anisotropy > 0.0f;
    if (use.area_light != none) has = has || loader.area_lights[use.area_light].image.valid();
    for_each_texture(m, [&](const TextureRef&) { has = true; });
    return has;
}

// Nothing but moved, and scaled evenly.
bool is_upright(const Transform& m)
{
    return m.x.x > 0.0f && m.y.y > 0.0f && m.z.z > 0.0f && m.x.y == 0.0f && m.x.z == 0.0f && m.y.x == 0.0f &&
           m.y.z == 0.0f && m.z.x == 0.0f && m.z.y == 0.0f && uniform_scale(m) > 0.0f;
}

void add_triangles(Loader& loader, const ParameterList& parameters)
{
    Mesh mesh = read_vertices(loader, parameters);
    mesh.name = fmt::format("trianglemesh {}", parameters.spot.line);
    mesh.triangles = read_triangles(parameters, mesh.positions.size());
    parameters.ignore({"faceIndices", "discarddegenerateUVs", "edgelength"});
    if (mesh.uvs.empty() && is_textured(loader.state.material->desc)) {
        // Without coordinates each triangle has corners (0, 0), (1, 0), (1, 1).
        Mesh apart;
        apart.name = mesh.name;
        for (uvec3& t : mesh.triangles) {
            const uint first = static_cast<uint>(apart.positions.size());
            for (int c = 0; c < 3; ++c) {
                apart.positions.push_back(mesh.positions[t[c]]);
                if (!mesh.normals.empty()) apart.normals.push_back(mesh.normals[t[c]]);
                apart.uvs.emplace_back(c > 0 ? 1.0f : 0.0f, c > 1 ? 1.0f : 0.0f);
            }
            apart.triangles.emplace_back(first, first + 1, first + 2);
        }
        mesh = std::move(apart);
    }
    place_mesh(loader, std::move(mesh), parameters);
}

void add_patches(Loader& loader, const ParameterList& parameters)
{
    const Mesh corners = read_vertices(loader, parameters);
    std::span<const int> indices = parameters.integers("indices");
    std::vector<uvec4> patches;
    if (indices.empty() && corners.positions.size() == 4)
        patches.emplace_back(0, 1, 2, 3);
    else if (indices.empty())
        throw Error(parameters.spot.place(), "the shape has no patches", "give it \"integer indices\"");
    check_indices(parameters, indices, corners.positions.size(), 4);
    for (std::size_t i = 0; i + 3 < indices.size(); i += 4)
        patches.emplace_back(indices[i], indices[i + 1], indices[i + 2], indices[i + 3]);
    std::size_t curved = 0;
    for (const uvec4 q : patches) curved += is_parallelogram(corners.positions, q) ? 0 : 1;
    uint cells = 8;
    while (cells > 1 && 2 * curved * cells * cells > loader.triangles_left) cells /= 2;
    loader.triangles_left -= std::min(loader.triangles_left, 2 * curved * cells * cells);
    Mesh mesh = tessellate_patches(corners.positions, corners.normals, corners.uvs, patches, cells);
    mesh.name = fmt::format("bilinearmesh {}", parameters.spot.line);
    if (parameters.find("emissionfilename") != nullptr)
        loader.warn(parameters.spot, "emissionfilename", "emissionfilename is left out: the light is even");
    parameters.ignore({"edgelength"});
    place_mesh(loader, std::move(mesh), parameters, {}, patches.size());
}

void add_loop(Loader& loader, const ParameterList& parameters)
{
    std::vector<vec3> points = parameters.points3("P");
    if (points.empty()) throw Error(parameters.spot.place(), "the shape has no points", "give it \"point3 P\"");
    const std::vector<uvec3> triangles = read_triangles(parameters, points.size());
    for (const uvec3 t : triangles)
        if (t.x == t.y || t.y == t.z || t.z == t.x)
            throw Error(parameters.spot.place(), "a triangle of a loopsubdiv has the same corner twice", "remove it");
    const int wanted = parameters.integer("levels", parameters.integer("nlevels", 3));
    parameters.ignore({"nlevels", "scheme"});
    uint levels = static_cast<uint>(std::clamp(wanted, 0, 12));
    while (levels > 0 && (triangles.size() << (2 * levels)) > loader.triangles_left) --levels;
    if (static_cast<int>(levels) < wanted)
        loader.warn(parameters.spot, "levels",
                    fmt::format("{} triangles are subdivided {} times instead of {}: more "
                                "would be too many",
                                triangles.size(), levels, wanted));
    if (levels > 0) loader.triangles_left -= triangles.size() << (2 * levels);
    Mesh mesh = subdivide(points, triangles, levels);
    mesh.name = fmt::format("loopsubdiv {}", parameters.spot.line);
    place_mesh(loader, std::move(mesh), parameters);
}

void add_revolved(Loader& loader, const std::string& type, std::vector<ProfilePoint> profile, float phi_max,
                  const ParameterList& parameters, bool keeps_area)
{
    const uint segments = segments_for(loader, parameters.spot, static_cast<uint>(profile.size() - 1));
    std::string key = fmt::format("{} {} {}", type, phi_max, segments);
    for (ProfilePoint& p : profile) {
        if (keeps_area && phi_max >= 360.0f) p.r *= equal_area_radius(segments);
        key += fmt::format(" {} {}", p.r, p.z);
    }
    Mesh mesh = revolve(profile, phi_max, segments);
    mesh.name = fmt::format("{} {}", type, parameters.spot.line);
    place_mesh(loader, std::move(mesh), parameters, key, 1);
}

void add_sphere(Loader& loader, const ParameterList& parameters)
{
    const float radius = std::abs(parameters.number("radius", 1.0f));
    float z0 = clamp(parameters.number("zmin", -radius), -radius, radius);
    float z1 = clamp(parameters.number("zmax", radius), -radius, radius);
    if (z0 > z1) std::swap(z0, z1);
    const float phi_max = clamp(parameters.number("phimax", 360.0f), 0.0f, 360.0f);
    if (!(radius > 0.0f) || !(phi_max > 0.0f) || z0 == z1) {
        loader.warn(parameters.spot, "no sphere", "a sphere without extent is left out");
        return;
    }
    const std::optional<MaterialUse> use = current_use(loader, parameters);
    if (!use) return;
    const MaterialDesc& look = loader.state.material->desc;
    const bool is_whole = z0 <= -radius && z1 >= radius && phi_max >= 360.0f;
    const bool has_sides = use->area_light != none || look.kind == material_dielectric ||
                           look.principled.transmission > 0.0f || look.principled.clearcoat > 0.0f;
    const bool is_turned = loader.state.reverse_orientation && has_sides;
    const float scale = uniform_scale(to_transform(loader.ctm()));
    // As exact spheres only what our spheres can do; lights must be round, and in objects there is no rotation for
    // textures.
    const bool fits = scale > 0.0f || (use->area_light == none && !loader.object.valid());
    // Our spheres have their pole along y and pbrt's along z, and their angles begin elsewhere.
    Matrix turn(1.0);
    turn[0] = glm::dvec4(0, -1, 0, 0), turn[1] = glm::dvec4(0, 0, 1, 0), turn[2] = glm::dvec4(-1, 0, 0, 0);
    const Transform placed = to_transform(loader.ctm() * turn);
    // One that looks the same however it is turned, or is not turned, is given by centre and radius alone.
    const bool is_plain = scale > 0.0f && (is_upright(placed) || !has_direction(look, *use, loader));
    if (is_whole && !is_turned && fits && (is_plain || !loader.object.valid() || !is_textured(look))) {
        MaterialUse lit = *use;
        if (use->area_light != none && loader.area_lights[use->area_light].power > 0.0f) {
            const AreaLight& light = loader.area_lights[use->area_light];
            const float area = 4.0f * 3.14159265f * radius * radius * scale * scale;
            lit.light_scale = light.power / (3.14159265f * area * (light.two_sided ? 2.0f : 1.0f));
        }
        SphereDesc sphere;
        sphere.name = parameters.text("name", fmt::format("sphere {}", parameters.spot.line));
        sphere.radius = radius;
        sphere.material = use_material(loader, loader.state.material, lit);
        if (loader.object.valid()) {
            sphere.center = transform_point(loader.ctm(), vec3(0.0f));
            sphere.radius = radius * scale;
            const Index<SphereDesc> index = add(loader.scene, sphere);
            loader.scene.groups[loader.object.value].spheres.push_back(index);
            return;
        }
        if (is_plain) {
            sphere.center = vec3(placed.x.w, placed.y.w, placed.z.w);
            sphere.radius = radius * scale;
            place(loader.scene, std::move(sphere));
            InstanceDesc& instance = loader.scene.instances.back();
            instance.name = parameters.text("instance", instance.name);
            return;
        }
        Index<Group>& group = loader.shared_groups[fmt::format("sphere {} {}", sphere.radius, sphere.material.value)];
        if (!group.valid()) {
            Group fresh;
            fresh.name = sphere.name;
            fresh.spheres.push_back(add(loader.scene, sphere));
            group = add(loader.scene, fresh);
        }
        InstanceDesc instance;
        instance.name = parameters.text("instance", loader.scene.groups[group.value].name);
        instance.group = group;
        instance.transform = placed;
        add(loader.scene, instance);
        return;
    }
    std::vector<ProfilePoint> profile;
    constexpr int rings = 48;
    const float from = std::acos(clamp(z0 / radius, -1.0f, 1.0f)), to = std::acos(clamp(z1 / radius, -1.0f, 1.0f));
    for (int i = 0; i <= rings; ++i) {
        const float theta = from + (to - from) * static_cast<float>(i) / rings;
        float s = std::sin(theta), c = std::cos(theta);
        if ((i == 0 && z0 <= -radius) || (i == rings && z1 >= radius)) s = 0.0f, c = i == 0 ? -1.0f : 1.0f;
        profile.push_back({radius * s, radius * c, s, c});
    }
    add_revolved(loader, "sphere", std::move(profile), phi_max, parameters, false);
}

void add_disk(Loader& loader, const ParameterList& parameters)
{
    const float height = parameters.number("height", 0.0f), radius = std::abs(parameters.number("radius", 1.0f));
    const float inner = clamp(parameters.number("innerradius", 0.0f), 0.0f, radius);
    const float phi_max = clamp(parameters.number("phimax", 360.0f), 0.0f, 360.0f);
    if (!(radius > inner) || !(phi_max > 0.0f)) return;
    add_revolved(loader, "disk", {{radius, height, 0, 1}, {inner, height, 0, 1}}, phi_max, parameters, true);
}

void add_cylinder(Loader& loader, const ParameterList& parameters)
{
    const float radius = std::abs(parameters.number("radius", 1.0f));
    float z0 = parameters.number("zmin", -1.0f), z1 = parameters.number("zmax", 1.0f);
    if (z0 > z1) std::swap(z0, z1);
    const float phi_max = clamp(parameters.number("phimax", 360.0f), 0.0f, 360.0f);
    if (!(radius > 0.0f) || z0 == z1 || !(phi_max > 0.0f)) return;
    add_revolved(loader, "cylinder", {{radius, z0, 1, 0}, {radius, z1, 1, 0}}, phi_max, parameters, false);
}

void add_cone(Loader& loader, const ParameterList& parameters)
{
    const float radius = std::abs(parameters.number("radius", 1.0f)), height = parameters.number("height", 1.0f);
    const float phi_max = clamp(parameters.number("phimax", 360.0f), 0.0f, 360.0f);
    const float l = std::sqrt(radius * radius + height * height);
    if (!(radius > 0.0f) || !(l > 0.0f) || !(phi_max > 0.0f)) return;
    const float nr = height / l, nz = radius / l;
    add_revolved(loader, "cone", {{radius, 0, nr, nz}, {0, height, nr, nz}}, phi_max, parameters, false);
}

void add_paraboloid(Loader& loader, const ParameterList& parameters)
{
    const float radius = std::abs(parameters.number("radius", 1.0f));
    const float z0 = parameters.number("zmin", 0.0f), z1 = parameters.number("zmax", 1.0f);
    const float phi_max = clamp(parameters.number("phimax", 360.0f), 0.0f, 360.0f);
    if (!(radius > 0.0f) || !(z1 > z0) || !(z0 >= 0.0f) || !(phi_max > 0.0f)) return;
    std::vector<ProfilePoint> profile;
    constexpr int rings = 24;
    for (int i = 0; i <= rings; ++i) {
        const float z = z0 + (z1 - z0) * static_cast<float>(i) / rings, r = radius * std::sqrt(z / z1);
        const float slope = radius * radius / (2.0f * z1); // r dr/dz
        const float l = std::sqrt(r * r + slope * slope);
        profile.push_back({r, z, r / l, -slope / l});
    }
    add_revolved(loader, "paraboloid", std::move(profile), phi_max, parameters, false);
}

void add_heights(Loader& loader, const ParameterList& parameters)
{
    const int nx = parameters.integer("nu", 0), ny = parameters.integer("nv", 0);
    const std::span<const float> heights = parameters.numbers("Pz");
    if (nx < 2 || ny < 2 || heights.size() != static_cast<std::size_t>(nx) * static_cast<std::size_t>(ny))
        throw Error(
            parameters.spot.place(),
            fmt::format("a heightfield of {} x {} needs as many heights, but there are {}", nx, ny, heights.size()),
            "mend nu, nv or Pz");
    Mesh mesh = tessellate_heights(heights, static_cast<uint>(nx), static_cast<uint>(ny));
    mesh.name = fmt::format("heightfield {}", parameters.spot.line);
    place_mesh(loader, std::move(mesh), parameters);
}

void add_plane(Loader& loader, const ParameterList& parameters)
{
    const vec3 point = parameters.point("P", vec3(0.0f)), normal = parameters.point("N", vec3(0, 1, 0));
    const std::optional<MaterialUse> use = current_use(loader, parameters);
    if (!use) return;
    if (loader.object.valid()) {
        loader.warn(parameters.spot, "plane in object", "planes cannot be part of objects; this one is left out");
        return;
    }
    const glm::dmat3 for_normals = glm::transpose(glm::inverse(glm::dmat3(loader.ctm())));
    PlaneDesc plane;
    plane.name = parameters.text("name", fmt::format("plane {}", parameters.spot.line));
    plane.point = transform_point(loader.ctm(), point);
    plane.normal = vec3(for_normals * glm::dvec3(normal)) * (loader.state.reverse_orientation ? -1.0f : 1.0f);
    plane.material = use_material(loader, loader.state.material, *use);
    if (!(length(plane.normal) > 0.0f))
        throw Error(parameters.spot.place(), "the plane's normal is 0", "give it \"normal N\"");
    add(loader.scene, plane);
}

} // namespace

void add_shape(Loader& loader, const std::string& type, const ParameterList& parameters)
{
    struct Maker
    {
        std::string_view type;
        void (*add)(Loader&, const ParameterList&);
    };
    static constexpr Maker makers[] = {
        {"plymesh", add_ply},           {"trianglemesh", add_triangles}, {"sphere", add_sphere},   {"disk", add_disk},
        {"cylinder", add_cylinder},     {"bilinearmesh", add_patches},   {"loopsubdiv", add_loop}, {"cone", add_cone},
        {"paraboloid", add_paraboloid}, {"heightfield", add_heights},    {"plane", add_plane}};
    if (!loader.in_world)
        loader.warn(parameters.spot, "before world", "a shape before WorldBegin is taken into the world");
    for (const Maker& maker : makers) {
        if (maker.type != type) continue;
        maker.add(loader, parameters);
        parameters.ignore({"alpha", "shadowalpha", "name", "instance"});
        parameters.report_unused(fmt::format("Shape \"{}\"", type), loader.notes);
        return;
    }
    loader.warn(parameters.spot, "shape " + type,
                fmt::format("shapes of type {} are not there; they are left out", show_word(type)));
}

} // namespace snell::pbrt
