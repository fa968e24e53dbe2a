// A small scene with something of everything, and pictures compared bit for bit.
#pragma once

#include "snell/core/error.h"
#include "snell/render/render.h"

#include <gtest/gtest.h>

#include <cstring>
#include <string>

namespace snell::test {

// Glass, metal, mirror and mix on a plane, a textured quad, an area light, a point light, instances, a dim sky.
inline Scene mixed_scene()
{
    Scene scene;
    scene.environment.radiance = vec3(0.1f, 0.15f, 0.2f);
    const auto material = [&](uint kind, vec3 color, float alpha) {
        MaterialDesc m;
        m.kind = kind;
        m.base_color = color;
        m.alpha = alpha;
        if (kind == material_conductor) m.specular = vec3(0.2f, 0.9f, 1.1f), m.absorption = vec3(3.9f, 2.5f, 2.1f);
        if (kind == material_mix) m.specular = vec3(0.3f);
        return m;
    };
    PlaneDesc floor;
    floor.point = vec3(0.0f, -1.0f, 0.0f);
    floor.material = add(scene, material(material_diffuse, vec3(0.6f, 0.5f, 0.4f), 0.0f));
    add(scene, floor);
    MaterialDesc tinted = material(material_dielectric, vec3(1.0f), 0.0f);
    tinted.absorption = vec3(0.1f, 0.5f, 0.9f);
    const MaterialDesc balls[] = {
        tinted, material(material_conductor, vec3(1.0f), 0.2f), material(material_mirror, vec3(0.9f), 0.0f),
        material(material_mix, vec3(0.1f, 0.2f, 0.6f), 0.0f), material(material_dielectric, vec3(0.9f), 0.3f)};
    float x = -2.0f;
    for (const MaterialDesc& m : balls) {
        SphereDesc ball;
        ball.center = vec3(x, -0.5f, 0.3f * x);
        ball.radius = 0.5f;
        ball.material = add(scene, m);
        place(scene, ball);
        x += 1.0f;
    }
    Image image;
    image.width = image.height = 2;
    image.bytes = {255, 0, 0, 255, 0, 255, 0, 255, 0, 0, 255, 255, 255, 255, 255, 255};
    MaterialDesc picture = material(material_diffuse, vec3(1.0f), 0.0f);
    picture.base_texture.image = add(scene, image);
    Mesh back;
    back.positions = {{-3, -1, -2}, {3, -1, -2}, {3, 2, -2}, {-3, 2, -2}};
    back.uvs = {{0, 0}, {2, 0}, {2, 2}, {0, 2}};
    back.triangles = {{0, 1, 2}, {0, 2, 3}};
    back.material = add(scene, picture);
    place(scene, back);
    MaterialDesc glow = material(material_diffuse, vec3(0.0f), 0.0f);
    glow.emission = vec3(8.0f, 7.0f, 6.0f);
    Mesh lamp;
    lamp.positions = {{-0.5f, 0, -0.5f}, {0.5f, 0, -0.5f}, {0.5f, 0, 0.5f}, {-0.5f, 0, 0.5f}};
    lamp.triangles = {{0, 1, 2}, {0, 2, 3}};
    lamp.material = add(scene, glow);
    Group lamps;
    lamps.meshes = {add(scene, lamp)};
    InstanceDesc hung;
    hung.group = add(scene, lamps);
    hung.transform = translation(vec3(-1.0f, 2.0f, 0.5f));
    add(scene, hung);
    hung.transform = compose(translation(vec3(1.0f, 2.0f, 0.5f)), rotation(vec3(1.0f, 0.0f, 0.0f), 20.0f));
    add(scene, hung);
    LightDesc point;
    point.position = vec3(2.0f, 3.0f, 3.0f);
    point.emission = vec3(5.0f);
    add(scene, point);
    CameraDesc camera;
    camera.eye = vec3(0.0f, 1.0f, 6.0f);
    camera.target = vec3(0.0f, -0.2f, 0.0f);
    add(scene, camera);
    validate(scene);
    return scene;
}

// The same with principled materials, dispersion and a sheet that is half there.
inline Scene principled_scene()
{
    Scene scene = mixed_scene();
    MaterialDesc glass;
    glass.kind = material_principled;
    glass.base_color = vec3(0.95f);
    glass.ior = 1.5f;
    glass.principled.transmission = 1.0f;
    glass.principled.roughness = 0.0f;
    glass.principled.metallic = 0.0f;
    glass.principled.thin_walled = false;
    glass.principled.dispersion = 1.0f;
    MaterialDesc coated;
    coated.kind = material_principled;
    coated.base_color = vec3(0.8f, 0.3f, 0.1f);
    coated.principled.metallic = 0.5f;
    coated.principled.roughness = 0.4f;
    coated.principled.clearcoat = 1.0f;
    coated.principled.sheen_color = vec3(0.3f);
    float x = -1.5f;
    for (const MaterialDesc& m : {glass, coated, glass}) {
        SphereDesc ball;
        ball.center = vec3(x, 0.5f, 1.5f);
        ball.radius = 0.6f;
        ball.material = add(scene, m);
        place(scene, ball);
        x += 1.5f;
    }
    MaterialDesc sheet;
    sheet.base_color = vec3(0.2f, 0.5f, 0.2f);
    sheet.coverage = coverage_blend;
    sheet.opacity = 0.4f;
    Mesh mesh;
    mesh.positions = {{-3, -1, 2.5f}, {3, -1, 2.5f}, {3, 0.3f, 2.5f}, {-3, 0.3f, 2.5f}};
    mesh.triangles = {{0, 1, 2}, {0, 2, 3}};
    mesh.material = add(scene, sheet);
    place(scene, mesh);
    validate(scene);
    return scene;
}

inline RenderSettings small_picture(const std::string& integrator)
{
    RenderSettings settings;
    settings.width = 37; // no multiple of any tile size
    settings.height = 29;
    settings.spp = 11;
    settings.integrator = integrator;
    settings.layers = true;
    return settings;
}

template <class T>
bool same_bits(const std::vector<T>& a, const std::vector<T>& b)
{
    return a.size() == b.size() && (a.empty() || std::memcmp(a.data(), b.data(), a.size() * sizeof(T)) == 0);
}

inline void expect_same_film(const Film& a, const Film& b)
{
    ASSERT_EQ(a.width, b.width);
    ASSERT_EQ(a.height, b.height);
    EXPECT_TRUE(same_bits(a.sum, b.sum)) << "sum";
    EXPECT_TRUE(same_bits(a.square_sum, b.square_sum)) << "square_sum";
    EXPECT_TRUE(same_bits(a.excess, b.excess)) << "excess";
    EXPECT_EQ(a.sample_count, b.sample_count);
    EXPECT_EQ(a.dropped, b.dropped);
    EXPECT_EQ(a.dropped_samples, b.dropped_samples);
    const FilmLayers &p = a.layers, &q = b.layers;
    EXPECT_TRUE(same_bits(p.albedo, q.albedo)) << "albedo";
    EXPECT_TRUE(same_bits(p.normal, q.normal)) << "normal";
    EXPECT_TRUE(same_bits(p.geometric_normal, q.geometric_normal)) << "geometric_normal";
    EXPECT_TRUE(same_bits(p.position, q.position)) << "position";
    EXPECT_TRUE(same_bits(p.direct, q.direct)) << "direct";
    EXPECT_TRUE(same_bits(p.indirect, q.indirect)) << "indirect";
    EXPECT_TRUE(same_bits(p.emission, q.emission)) << "emission";
    EXPECT_TRUE(same_bits(p.uv, q.uv)) << "uv";
    EXPECT_TRUE(same_bits(p.depth, q.depth)) << "depth";
    EXPECT_TRUE(same_bits(p.steps, q.steps)) << "steps";
    EXPECT_EQ(p.object, q.object);
    EXPECT_EQ(p.material, q.material);
    EXPECT_EQ(p.hit_count, q.hit_count);
    EXPECT_EQ(p.sample_count, q.sample_count);
}

} // namespace snell::test
