// What pbrt files put into the scene: materials, lights, shapes, objects; and whole files.
#include "tests/io/pbrt_files.h"

#include <chrono>

namespace snell {
namespace {

using namespace test;

MaterialDesc material(const std::string& text, const std::string& after = {})
{
    return read_pbrt("WorldBegin Material " + text + a_triangle + after).materials.at(0);
}

TEST(PbrtMaterials, OfV4)
{
    EXPECT_EQ(read_pbrt(std::string("WorldBegin ") + a_triangle).materials.at(0).base_color, vec3(0.5f));
    const MaterialDesc glass = material("\"dielectric\" \"float eta\" 1.7 \"float roughness\" .04");
    EXPECT_EQ(glass.kind, material_dielectric);
    EXPECT_FLOAT_EQ(glass.ior, 1.7f);
    EXPECT_FLOAT_EQ(glass.alpha, 0.2f); // remapped: the root
    EXPECT_FLOAT_EQ(material("\"dielectric\" \"spectrum eta\" \"glass-BK7\"").ior, 1.5168f);
    const MaterialDesc metal = material("\"conductor\" \"rgb reflectance\" [.9 .9 .9] \"float roughness\" .15 "
                                        "\"bool remaproughness\" false");
    EXPECT_EQ(metal.kind, material_conductor);
    expect_near(metal.specular, vec3(1.0f), 1e-6f);
    expect_near(metal.absorption, vec3(6.0f), 1e-4f); // k = 2 sqrt(r / (1 - r))
    EXPECT_FLOAT_EQ(metal.alpha, 0.15f);
    const MaterialDesc brushed = material("\"conductor\" \"float uroughness\" .4 \"float vroughness\" .1 "
                                          "\"bool remaproughness\" \"false\"");
    EXPECT_EQ(brushed.kind, material_principled);
    const float a2 = brushed.principled.anisotropy * brushed.principled.anisotropy;
    const float alpha = brushed.principled.roughness * brushed.principled.roughness;
    EXPECT_NEAR(alpha, 0.1f, 1e-5f);
    EXPECT_NEAR(alpha + (1 - alpha) * a2, 0.4f, 1e-5f);
    const MaterialDesc coated = material("\"coateddiffuse\" \"rgb reflectance\" [.2 .3 .4] \"float roughness\" .0256");
    EXPECT_EQ(coated.kind, material_principled);
    EXPECT_NEAR(coated.principled.roughness, 0.4f, 1e-5f);
    expect_near(coated.base_color, vec3(.2f, .3f, .4f), 1e-6f);
    const MaterialDesc leaf =
        material("\"diffusetransmission\" \"rgb reflectance\" [.2 .3 .2] \"rgb transmittance\" [.1 .1 .1]");
    EXPECT_NEAR(leaf.principled.diffuse_transmission, 0.25f, 1e-5f);
    expect_near(leaf.base_color * 0.75f, vec3(.2f, .3f, .2f), 1e-5f);
    expect_near(leaf.principled.diffuse_transmission_color * 0.25f, vec3(.1f), 1e-5f);
    const MaterialDesc window = material("\"thindielectric\"");
    EXPECT_TRUE(window.principled.thin_walled);
    EXPECT_EQ(window.principled.transmission, 1.0f);
}

TEST(PbrtMaterials, OfV3)
{
    const std::string v3 = " WorldEnd";
    EXPECT_EQ(material("\"matte\" \"rgb Kd\" [.1 .2 .3]", v3).base_color, vec3(.1f, .2f, .3f));
    EXPECT_EQ(material("\"mirror\"", v3).kind, material_mirror);
    const MaterialDesc glass = material("\"glass\" \"float index\" 1.3 \"rgb Kt\" [0 0 0]", v3);
    EXPECT_EQ(glass.kind, material_dielectric);
    EXPECT_FLOAT_EQ(glass.ior, 1.3f);
    EXPECT_EQ(glass.base_color, vec3(0.0f));
    EXPECT_EQ(glass.alpha, 0.0f);
    const MaterialDesc metal = material("\"metal\" \"rgb eta\" [1 2 3] \"rgb k\" [4 5 6] \"float roughness\" .1", v3);
    EXPECT_EQ(metal.kind, material_conductor);
    EXPECT_EQ(metal.specular, vec3(1, 2, 3));
    EXPECT_EQ(metal.absorption, vec3(4, 5, 6));
    EXPECT_NEAR(metal.alpha, 0.4625f, 2e-3f); // v3's polynomial
    const MaterialDesc coat =
        material("\"substrate\" \"rgb Kd\" [.5 .5 .5] \"rgb Ks\" [.04 .04 .04] \"float uroughness\" .25 "
                 "\"float vroughness\" .25 \"bool remaproughness\" \"false\"",
                 v3);
    EXPECT_EQ(coat.kind, material_principled);
    EXPECT_NEAR(coat.ior, 1.5f, 1e-4f);
    EXPECT_NEAR(coat.principled.roughness, 0.5f, 1e-5f);
    const MaterialDesc holes = material("\"uber\" \"rgb Ks\" [0 0 0] \"rgb opacity\" [.25 .25 .25]", v3);
    EXPECT_EQ(holes.kind, material_diffuse);
    EXPECT_EQ(holes.coverage, coverage_blend);
    EXPECT_FLOAT_EQ(holes.opacity, 0.25f);
    EXPECT_EQ(material("\"plastic\"", v3).kind, material_principled);
    EXPECT_EQ(material("\"translucent\"", v3).principled.diffuse_transmission, 0.5f);
}

TEST(PbrtMaterials, NamedOnesMayBeMadeLater)
{
    const Scene scene = read_pbrt("WorldBegin NamedMaterial \"m\" Shape \"sphere\" "
                                  "MakeNamedMaterial \"m\" \"string type\" \"diffuse\" \"rgb reflectance\" [1 0 0] "
                                  "NamedMaterial \"n\" Shape \"sphere\"");
    ASSERT_EQ(scene.materials.size(), 2u);
    EXPECT_EQ(scene.materials[0].base_color, vec3(1, 0, 0));
    EXPECT_TRUE(has_note(scene, "'n' is used but not made"));
    EXPECT_EQ(warning_count(scene), 1u);
}

TEST(PbrtMaterials, Mixes)
{
    const std::string two =
        "WorldBegin MakeNamedMaterial \"a\" \"string type\" \"diffuse\" \"rgb reflectance\" [1 0 0] "
        "MakeNamedMaterial \"b\" \"string type\" \"diffuse\" \"rgb reflectance\" [0 1 0] "
        "MakeNamedMaterial \"c\" \"string type\" \"interface\" ";
    const auto mixed = [&](const std::string& rest) {
        return read_pbrt(two + "Material \"mix\" " + rest + a_triangle).materials.at(0);
    };
    expect_near(mixed("\"string materials\" [\"a\" \"b\"] \"float amount\" .25").base_color, vec3(.75f, .25f, 0),
                1e-6f);
    expect_near(mixed("\"string namedmaterial1\" \"a\" \"string namedmaterial2\" \"b\" \"rgb amount\" [.25 .25 .25]")
                    .base_color,
                vec3(.25f, .75f, 0), 1e-6f);
    const MaterialDesc holes = mixed("\"string materials\" [\"a\" \"c\"] \"float amount\" .25");
    EXPECT_EQ(holes.coverage, coverage_blend);
    EXPECT_FLOAT_EQ(holes.opacity, 0.75f);
}

TEST(PbrtMaterials, Ours)
{
    const MaterialDesc m = material(
        "\"principled\" \"rgb base_color\" [.1 .2 .3] \"float metallic\" .5 \"float roughness\" .25 \"float "
        "clearcoat\" 1 "
        "\"rgb sheen_color\" [.3 .2 .1] \"float transmission\" .75 \"bool thin_walled\" false \"float ior\" 1.4 "
        "\"rgb absorption\" [1 2 3] \"rgb emission\" [4 5 6] \"bool two_sided_emission\" true \"float opacity\" .5 "
        "\"string coverage\" \"mask\" \"float cutoff\" .25");
    EXPECT_EQ(m.kind, material_principled);
    EXPECT_EQ(m.base_color, vec3(.1f, .2f, .3f));
    EXPECT_EQ(m.principled.metallic, .5f);
    EXPECT_EQ(m.principled.roughness, .25f);
    EXPECT_EQ(m.principled.clearcoat, 1.0f);
    EXPECT_EQ(m.principled.sheen_color, vec3(.3f, .2f, .1f));
    EXPECT_EQ(m.principled.transmission, .75f);
    EXPECT_FALSE(m.principled.thin_walled);
    EXPECT_EQ(m.ior, 1.4f);
    EXPECT_EQ(m.absorption, vec3(1, 2, 3));
    EXPECT_EQ(m.emission, vec3(4, 5, 6));
    EXPECT_TRUE(m.two_sided_emission);
    EXPECT_EQ(m.coverage, coverage_mask);
    EXPECT_EQ(m.opacity, .5f);
    EXPECT_EQ(m.cutoff, .25f);
    EXPECT_EQ(material("\"unlit\" \"rgb color\" [1 0 1]").kind, material_unlit);
    EXPECT_EQ(material("\"diffuse_specular\" \"rgb specular\" [.1 .1 .1] \"float alpha\" .5").kind, material_mix);
}

TEST(PbrtMedia, AbsorptionWithinGlassIsExact)
{
    const Scene scene = read_pbrt(R"(MakeNamedMedium "ink" "string type" "homogeneous" "rgb sigma_a" [.1 .2 .3]
        "rgb sigma_s" [0 0 0] "float scale" 2   WorldBegin
        AttributeBegin MediumInterface "ink" "" Material "dielectric" Shape "sphere" AttributeEnd
        AttributeBegin MediumInterface "ink" "" Material "interface" Shape "sphere" AttributeEnd
        Material "interface" Shape "sphere")");
    ASSERT_EQ(scene.instances.size(), 2u);
    expect_near(scene.materials.at(0).absorption, vec3(.2f, .4f, .6f), 1e-6f);
    EXPECT_EQ(scene.materials.at(1).ior, 1.0f);
    expect_near(scene.materials.at(1).absorption, vec3(.2f, .4f, .6f), 1e-6f);
    EXPECT_EQ(warning_count(scene), 0u) << all_notes(scene);
}

TEST(PbrtLights, StandWhereTheyStand)
{
    const Scene scene = read_pbrt(R"(WorldBegin Translate 1 0 0
        LightSource "point" "point3 from" [0 2 0] "rgb I" [1 2 3] "float power" 12.5663706
        LightSource "spot" "point3 from" [0 5 0] "point3 to" [0 0 0] "float coneangle" 20 "float conedeltaangle" 8
        LightSource "distant" "point3 from" [0 0 0] "point3 to" [0 -2 0] "rgb L" [3 3 3] "float illuminance" 2
        LightSource "infinite" "rgb L" [.5 .5 .5]  LightSource "infinite" "rgb L" [.25 .5 1] "float scale" 2)");
    ASSERT_EQ(scene.lights.size(), 3u);
    EXPECT_EQ(scene.lights[0].position, vec3(1, 2, 0));
    expect_near(scene.lights[0].emission, vec3(1, 2, 3), 1e-5f);
    EXPECT_EQ(scene.lights[1].kind, light_spot);
    expect_near(normalize(scene.lights[1].direction), vec3(0, -1, 0), 1e-6f);
    EXPECT_FLOAT_EQ(scene.lights[1].outer_degrees, 20.0f);
    EXPECT_FLOAT_EQ(scene.lights[1].inner_degrees, 12.0f);
    EXPECT_EQ(scene.lights[2].kind, light_directional);
    expect_near(normalize(scene.lights[2].direction), vec3(0, -1, 0), 1e-6f);
    expect_near(scene.lights[2].emission, vec3(6.0f), 1e-5f);
    expect_near(scene.environment.radiance, vec3(1, 1.5f, 2.5f), 1e-5f);
}

// A float picture of one value.
std::string even_map(int width, int height, float value)
{
    std::string bytes = fmt::format("PF\n{} {}\n-1.0\n", width, height);
    for (int i = 0; i < 3 * width * height; ++i) bytes.append(reinterpret_cast<const char*>(&value), sizeof value);
    return bytes;
}

TEST(PbrtLights, EnvironmentMapsPointAsInPbrt)
{
    const Folder folder;
    folder.write("square.pfm", even_map(64, 64, 3.0f));
    folder.write("wide.pfm", even_map(4, 2, 3.0f));
    const auto towards = [](const Scene& scene, vec3 d) { return transform_vector(scene.environment.to_world, d); };
    const Scene v4 =
        read_pbrt(folder, R"(WorldBegin Rotate 90 1 0 0 LightSource "infinite" "string filename" "square.pfm"
        "float scale" .5  LightSource "infinite" "rgb L" [1 2 3])");
    EXPECT_EQ(v4.environment.mapping, environment_octahedral);
    expect_near(v4.environment.radiance, vec3(0.5f), 1e-6f);
    expect_near(towards(v4, vec3(0, 0, 1)), vec3(0, -1, 0), 1e-6f);
    // The even light is added to the texels.
    const Image& map = v4.images.at(v4.environment.image.value);
    for (std::size_t c = 0; c < 3; ++c) EXPECT_FLOAT_EQ(0.5f * map.floats[c], 1.5f + static_cast<float>(c) + 1.0f);
    const Scene lit = read_pbrt(folder, "WorldBegin LightSource \"infinite\" \"string filename\" \"square.pfm\" "
                                        "\"float illuminance\" 6");
    EXPECT_NEAR(lit.environment.radiance.x * 3 * 3.14159265f, 6.0f, 0.02f);

    // v3: +z is up; u runs from +x over +y, so that -x is in the middle and -y right of it.
    const Scene v3 = read_pbrt(folder, "WorldBegin LightSource \"infinite\" \"string mapname\" \"wide.pfm\" WorldEnd");
    EXPECT_EQ(v3.environment.mapping, environment_equirectangular);
    expect_near(towards(v3, vec3(0, 1, 0)), vec3(0, 0, 1), 1e-6f);
    expect_near(towards(v3, vec3(0, 0, -1)), vec3(-1, 0, 0), 1e-6f);
    expect_near(towards(v3, vec3(1, 0, 0)), vec3(0, -1, 0), 1e-6f);
    EXPECT_EQ(warning_count(v3), 0u) << all_notes(v3);
    const Scene missing =
        read_pbrt("WorldBegin LightSource \"infinite\" \"string filename\" \"none.exr\" \"float scale\" 2");
    EXPECT_EQ(missing.environment.radiance, vec3(2.0f));
    EXPECT_EQ(warning_count(missing), 1u);
}

TEST(PbrtLights, TheFilmsExposureScalesThem)
{
    const Scene scene = read_pbrt("Film \"rgb\" \"float iso\" 150 WorldBegin LightSource \"point\" "
                                  "LightSource \"infinite\" AreaLightSource \"diffuse\" Shape \"sphere\"");
    EXPECT_EQ(scene.lights[0].emission, vec3(1.5f));
    EXPECT_EQ(scene.environment.radiance, vec3(1.5f));
    EXPECT_EQ(scene.materials[0].emission, vec3(1.5f));
}

TEST(PbrtLights, AreaLightsShineFromTheSideOfTheNormal)
{
    const Scene scene = read_pbrt(R"(WorldBegin AttributeBegin AreaLightSource "diffuse" "rgb L" [2 4 6] "float scale" 2
        "bool twosided" true Shape "sphere" AttributeEnd Shape "sphere"
        AreaLightSource "diffuse" "rgb L" [1 1 1] ReverseOrientation Shape "disk" "float radius" 2
        Shape "sphere" "float radius" 3)");
    ASSERT_EQ(scene.instances.size(), 4u);
    ASSERT_EQ(scene.spheres.size(), 2u);
    expect_near(scene.materials[scene.spheres[0].material.value].emission, vec3(4, 8, 12), 1e-5f);
    EXPECT_TRUE(scene.materials[scene.spheres[0].material.value].two_sided_emission);
    EXPECT_EQ(scene.materials[scene.spheres[1].material.value].emission, vec3(0.0f));
    ASSERT_EQ(scene.meshes.size(), 2u);
    EXPECT_NEAR(mesh_area(scene.meshes[0]), 3.14159265 * 4, 1e-4); // the disk's own area, exactly
    EXPECT_LT(triangle_normal(scene.meshes[0], 0).z, -0.99f);
    EXPECT_LT(scene.meshes[0].normals[0].z, -0.99f);
    // The sphere shines inwards.
    const Mesh& shell = scene.meshes[1];
    EXPECT_LT(dot(triangle_normal(shell, 100), shell.positions[shell.triangles[100].x]), 0.0f);
}

TEST(PbrtLights, PowerIsThatOfEachTriangle)
{
    const Scene scene =
        read_pbrt("WorldBegin AreaLightSource \"diffuse\" \"float power\" 10 Scale 2 2 2 " + std::string(a_triangle));
    // area 2
    expect_near(scene.materials[scene.meshes[0].triangle_materials.at(0).value].emission,
                vec3(10 / (3.14159265f * 2.0f)), 1e-3f);
}

TEST(PbrtLights, PowerIsThatOfAWholeDiskPatchOrSphere)
{
    const char* const shapes[] = {"\"disk\" \"float radius\" 2",
                                  "\"bilinearmesh\" \"point3 P\" [0 0 0 2 0 0 0 3 0 2 3 0]",
                                  "\"sphere\" \"float radius\" 3"};
    const float areas[] = {4 * 3.14159265f, 6.0f, 36 * 3.14159265f};
    for (std::size_t i = 0; i < 3; ++i) {
        const Scene scene =
            read_pbrt(std::string("WorldBegin AreaLightSource \"diffuse\" \"float power\" 7 Shape ") + shapes[i]);
        ASSERT_EQ(scene.materials.size(), 1u) << shapes[i];
        EXPECT_NEAR(scene.materials[0].emission.x * areas[i] * 3.14159265f, 7.0f, 1e-3f) << shapes[i];
    }
}

TEST(PbrtShapes, Quadrics)
{
    const double pi = 3.14159265358979;
    const struct
    {
        const char* shape;
        double area;
    } cases[] = {{"\"sphere\" \"float radius\" 2 \"float zmin\" 0", 8 * pi},
                 {"\"sphere\" \"float phimax\" 90", pi},
                 {"\"cylinder\" \"float radius\" 2 \"float zmin\" 0 \"float zmax\" 3", 12 * pi},
                 {"\"disk\" \"float radius\" 2 \"float innerradius\" 1", 3 * pi},
                 {"\"cone\" \"float radius\" 3 \"float height\" 4", 15 * pi},
                 {"\"paraboloid\" \"float radius\" 1 \"float zmax\" 1", pi / 6 * (5 * std::sqrt(5.0) - 1)}};
    for (const auto& c : cases) {
        const Scene scene = read_pbrt(std::string("WorldBegin Shape ") + c.shape);
        ASSERT_EQ(scene.meshes.size(), 1u) << c.shape;
        const Mesh& mesh = scene.meshes[0];
        EXPECT_NEAR(mesh_area(mesh), c.area, 2e-3 * c.area) << c.shape;
        for (std::size_t i = 0; i < mesh.triangles.size(); ++i)
            ASSERT_GT(dot(triangle_normal(mesh, i), mesh.normals[mesh.triangles[i].x]), 0.9f) << c.shape << " " << i;
    }
}

TEST(PbrtShapes, LoopSubdivision)
{
    // A tetrahedron: every vertex p has three neighbours, whose sum is -p. The limit of one of valence 3 is
    // 2/5 p + 1/5 (sum of the ring), here p / 5.
    const Scene scene =
        read_pbrt("WorldBegin Shape \"loopsubdiv\" \"integer levels\" 3 \"point3 P\" [1 1 1 1 -1 -1 -1 1 -1 "
                  "-1 -1 1] \"integer indices\" [0 2 1 0 1 3 0 3 2 1 2 3]");
    const Mesh& mesh = scene.meshes.at(0);
    EXPECT_EQ(mesh.triangles.size(), 4u * 64);
    expect_near(mesh.positions[0], vec3(0.2f), 1e-5f);
    const float r = length(mesh.positions[0]);
    for (int v = 1; v < 4; ++v) EXPECT_NEAR(length(mesh.positions[static_cast<std::size_t>(v)]), r, 1e-5f);
    for (std::size_t i = 0; i < mesh.positions.size(); ++i) {
        ASSERT_NEAR(length(mesh.normals[i]), 1.0f, 1e-4f);
        ASSERT_GT(std::abs(dot(mesh.normals[i], normalize(mesh.positions[i]))), 0.8f) << i;
    }
    // One more level moves no point of the limit surface.
    const Scene finer =
        read_pbrt("WorldBegin Shape \"loopsubdiv\" \"integer levels\" 4 \"point3 P\" [1 1 1 1 -1 -1 -1 1 -1 "
                  "-1 -1 1] \"integer indices\" [0 2 1 0 1 3 0 3 2 1 2 3]");
    for (std::size_t i = 0; i < mesh.positions.size(); ++i)
        expect_near(finer.meshes[0].positions[i], mesh.positions[i], 1e-5f, fmt::format("vertex {}", i));
    // A flat sheet stays flat, with its border on the border.
    const Scene sheet =
        read_pbrt("WorldBegin Shape \"loopsubdiv\" \"integer nlevels\" 2 \"point P\" [0 0 0 1 0 0 2 0 0 0 1 0 "
                  "1 1 0 2 1 0 0 2 0 1 2 0 2 2 0] \"integer indices\" [0 1 4 0 4 3 1 2 5 1 5 4 3 4 7 3 7 6 "
                  "4 5 8 4 8 7]");
    for (const vec3 p : sheet.meshes.at(0).positions) EXPECT_EQ(p.z, 0.0f);
    for (const vec3 n : sheet.meshes[0].normals) EXPECT_NEAR(n.z, 1.0f, 1e-5f);
    EXPECT_NEAR(mesh_area(sheet.meshes[0]), 4.0, 0.4);
}

TEST(PbrtShapes, BilinearPatches)
{
    const Scene flat = read_pbrt("WorldBegin Shape \"bilinearmesh\" \"point3 P\" [0 0 0 2 0 0 0 1 0 2 1 0]");
    EXPECT_EQ(flat.meshes.at(0).triangles.size(), 2u);
    EXPECT_NEAR(mesh_area(flat.meshes[0]), 2.0, 1e-6);
    EXPECT_GT(triangle_normal(flat.meshes[0], 0).z, 0.99f);
    const Scene saddle = read_pbrt("WorldBegin Shape \"bilinearmesh\" \"point3 P\" [0 0 0 1 0 0 0 1 0 1 1 1]");
    for (std::size_t i = 0; i < saddle.meshes.at(0).positions.size(); ++i) {
        const vec3 p = saddle.meshes[0].positions[i];
        EXPECT_NEAR(p.z, p.x * p.y, 1e-6f);
    }
}

TEST(PbrtObjects, AreSharedAndPlacedByBothTransforms)
{
    const Scene scene = read_pbrt(R"(WorldBegin Translate 0 0 1 ObjectBegin "o" Scale 2 2 2 Shape "trianglemesh"
        "point3 P" [0 0 0 1 0 0 0 1 0] Shape "sphere" "float radius" .5 ObjectEnd
        Identity Translate 5 0 0 ObjectInstance "o" Scale -1 1 1 ObjectInstance "o" ObjectInstance "none")");
    ASSERT_EQ(scene.groups.size(), 2u);
    ASSERT_EQ(scene.instances.size(), 3u);
    EXPECT_EQ(scene.meshes.size(), 1u);
    EXPECT_EQ(scene.meshes[0].positions[1], vec3(2, 0, 1));
    EXPECT_EQ(scene.spheres.at(0).radius, 1.0f);
    EXPECT_EQ(scene.spheres[0].center, vec3(0, 0, 1));
    EXPECT_EQ(scene.instances[0].transform.x.w, 5.0f);
    EXPECT_EQ(scene.instances[1].transform.x.x, -1.0f);
    Scene copy = scene;
    validate(copy);
}

TEST(PbrtObjects, InstancesHaveNamesOfTheirOwn)
{
    const Scene scene = read_pbrt(R"(WorldBegin ObjectBegin "o" Shape "sphere" ObjectEnd ObjectInstance "o"
        AttributeBegin Attribute "shape" "string instance" "left" "string name" "ball" ObjectInstance "o" Shape "sphere"
        AttributeEnd Shape "sphere")");
    ASSERT_EQ(scene.instances.size(), 4u);
    EXPECT_EQ(scene.instances[0].name, "o");
    EXPECT_EQ(scene.instances[1].name, "left");
    EXPECT_EQ(scene.instances[2].name, "left");
    EXPECT_EQ(scene.spheres[1].name, "ball");
    EXPECT_NE(scene.spheres[2].name, "ball");
    EXPECT_EQ(scene.notes.size(), 0u) << all_notes(scene);
}

TEST(PbrtPly, FilesAreSharedAndMissingOnesSaid)
{
    const Folder folder;
    folder.write("t.ply",
                 "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n"
                 "element face 1\nproperty list uchar int vertex_indices\nend_header\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n");
    const Scene scene = read_pbrt(folder, R"(WorldBegin Shape "plymesh" "string filename" "t.ply"
        Translate 1 0 0 Shape "plymesh" "string filename" "t.ply"
        ReverseOrientation Shape "plymesh" "string filename" "t.ply"
        ObjectBegin "o" Scale 1 1 -1 Shape "plymesh" "string filename" "t.ply" ObjectEnd ObjectInstance "o"
        Shape "plymesh" "string filename" "none.ply")");
    ASSERT_EQ(scene.meshes.size(), 4u);
    EXPECT_EQ(scene.instances.size(), 5u);
    EXPECT_EQ(scene.instances[0].group, scene.instances[1].group);
    EXPECT_GT(triangle_normal(scene.meshes[0], 0).z, 0.99f);
    EXPECT_LT(triangle_normal(scene.meshes[1], 0).z, -0.99f); // reversed
    EXPECT_GT(triangle_normal(scene.meshes[2], 0).z, 0.99f);  // reversed and mirrored
    EXPECT_EQ(scene.meshes[2].positions[1].x, 2.0f);
    EXPECT_TRUE(scene.meshes[3].triangles.empty());
    EXPECT_EQ(warning_count(scene), 1u) << all_notes(scene);
}

// Whole files. The counts are of the files' own text and headers: shapes by counting directives, triangles from index
// lists and PLY headers, with polygons fanned.
struct Expected
{
    const char* file;
    std::size_t triangles, spheres, instances, lights, warnings;
};

TEST(PbrtFiles, OfOthersLoadAsTheyAre)
{
    const std::filesystem::path shared = std::filesystem::path(SNELL_SOURCE_DIR) / "../shared";
    if (!std::filesystem::exists(shared / "scenes/pbrt")) {
        std::cout << "left out: no ../shared/scenes/pbrt here\n";
        return;
    }
    const Expected all[] = {{"scenes/pbrt/bitterli-coffee/scene-v4.pbrt", 235271, 0, 23, 0, 1},
                            {"scenes/pbrt/bitterli-cornell-box/scene-v4.pbrt", 36, 0, 8, 0, 0},
                            {"scenes/pbrt/bitterli-veach-mis/scene-v4.pbrt", 52, 3, 9, 0, 0},
                            {"scenes/pbrt/caustic-glass/caustic-glass-v4.pbrt", 88066, 0, 2, 1, 1},
                            {"scenes/pbrt/cornell-box/cornell-box.pbrt", 32, 0, 8, 0, 0},
                            {"scenes/pbrt/cornell-box/cornell-box-silver.pbrt", 32, 0, 8, 0, 0},
                            {"scenes/pbrt/cornell-box/cornell-box-specular.pbrt", 22, 1, 8, 0, 0},
                            {"scenes/pbrt/cornell-box/cornell-box-volume.pbrt", 32, 0, 8, 0, 1},
                            {"scenes/pbrt/cornell-box/cornell-box-specular-volume.pbrt", 22, 1, 8, 0, 1},
                            {"scenes/pbrt/cornell-box/smallpt.pbrt", 10, 3, 8, 0, 0},
                            {"scenes/pbrt/cornell-box/volumetric-caustic.pbrt", 12, 1, 7, 0, 1},
                            {"scenes/pbrt/killeroos/killeroo-simple.pbrt", 66532, 1, 5, 0, 1},
                            {"scenes/pbrt/killeroos/killeroo-moving.pbrt", 66532, 1, 5, 0, 2},
                            {"scenes/pbrt/killeroos/killeroo-gold.pbrt", 532358, 0, 5, 1, 0},
                            {"scenes/pbrt/killeroos/killeroo-coated-gold.pbrt", 532358, 0, 5, 1, 1},
                            {"scenes/pbrt-v3/country-kitchen/scene.pbrt", 1443517, 0, 299, 0, 1},
                            {"reference/scenes/cornell.pbrt", 24, 1, 8, 0, 0},
                            {"reference/scenes/cornell_diffuse.pbrt", 36, 0, 8, 0, 0},
                            {"reference/scenes/env_bunny.pbrt", 69453, 2, 4, 0, 0},
                            {"reference/scenes/furnace_bunny.pbrt", 69451, 0, 1, 0, 0},
                            {"reference/scenes/glass_checker.pbrt", 512, 1, 3, 1, 0},
                            {"reference/scenes/veach_mis.pbrt", 12, 5, 11, 0, 0}};
    for (const Expected& e : all) {
        if (!std::filesystem::exists(shared / e.file)) {
            std::cout << "left out: no " << e.file << " here\n";
            continue;
        }
        const Scene scene = load_pbrt(shared / e.file);
        EXPECT_EQ(triangle_count(scene), e.triangles) << e.file;
        EXPECT_EQ(scene.spheres.size(), e.spheres) << e.file;
        EXPECT_EQ(scene.instances.size(), e.instances) << e.file;
        EXPECT_EQ(scene.lights.size(), e.lights) << e.file;
        EXPECT_EQ(warning_count(scene), e.warnings) << e.file << "\n" << all_notes(scene);
        EXPECT_EQ(scene.cameras.size(), 1u) << e.file;
    }
}

TEST(PbrtFiles, TheReferencesAreTheScenesTheySayTheyAre)
{
    const std::filesystem::path folder = std::filesystem::path(SNELL_SOURCE_DIR) / "../shared/reference/scenes";
    if (!std::filesystem::exists(folder / "glass_checker.pbrt")) {
        std::cout << "left out: no ../shared/reference here\n";
        return;
    }
    const Scene scene = load_pbrt(folder / "glass_checker.pbrt");
    EXPECT_FALSE(scene.cameras[0].mirrored);
    EXPECT_EQ(scene.lights[0].emission, vec3(20.0f));
    EXPECT_EQ(scene.environment.radiance, vec3(0.2f));
    const MaterialDesc& glass = scene.materials[scene.spheres[0].material.value];
    EXPECT_EQ(glass.kind, material_dielectric);
    EXPECT_EQ(glass.absorption, vec3(0.6f));
    EXPECT_EQ(scene.hints.max_depth, 1000u);
}

} // namespace
} // namespace snell
