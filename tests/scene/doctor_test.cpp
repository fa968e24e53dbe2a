// Each check of the scene report on a scene that has exactly that fault, and on healthy ones.
#include "snell/scene/doctor.h"

#include "snell/scene/builtin.h"
#include "snell/scene/shapes.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <limits>

namespace snell {
namespace {

using Severity = Finding::Severity;

Index<MaterialDesc> add_grey(Scene& scene)
{
    MaterialDesc grey;
    grey.name = "grey";
    return add(scene, grey);
}

Index<MaterialDesc> add_glass(Scene& scene, const char* name = "glass")
{
    MaterialDesc glass;
    glass.name = name;
    glass.kind = material_dielectric;
    glass.base_color = vec3(1.0f);
    return add(scene, glass);
}

// A camera and light, so that their absence is no finding.
void furnish(Scene& scene)
{
    add(scene, CameraDesc{});
    add(scene, LightDesc{});
}

Scene scene_with(const std::function<void(Scene&)>& build)
{
    Scene scene;
    furnish(scene);
    build(scene);
    validate(scene);
    return scene;
}

std::string all_of(const SceneReport& report)
{
    std::string text;
    for (const Finding& f : report.findings)
        text += fmt::format("[{}] {} x{}: {}\n", f.kind, to_string(f.severity), f.count, f.text);
    return text;
}

SceneReport examined(const std::function<void(Scene&)>& build)
{
    return examine(scene_with(build));
}

// The scene has one finding, and it is this.
void expect_only(const SceneReport& report, std::string_view kind, Severity severity, std::string_view part,
                 std::size_t count = 1)
{
    ASSERT_EQ(report.findings.size(), 1u) << all_of(report);
    const Finding& f = report.findings[0];
    EXPECT_EQ(f.kind, kind);
    EXPECT_EQ(f.severity, severity) << all_of(report);
    EXPECT_NE(f.text.find(part), std::string::npos) << f.text;
    EXPECT_EQ(f.count, count) << f.text;
    EXPECT_EQ(report.doubtful, severity == Severity::doubtful ? 1u : 0u);
    EXPECT_EQ(report.repaired, severity == Severity::repaired ? 1u : 0u);
    EXPECT_EQ(report.infos, severity == Severity::info ? 1u : 0u);
}

void expect_healthy(const SceneReport& report)
{
    EXPECT_EQ(all_of(report), "");
    EXPECT_EQ(report.infos + report.repaired + report.doubtful + report.errors, 0u);
}

void turn_over(Mesh& mesh)
{
    for (uvec3& t : mesh.triangles) std::swap(t.y, t.z);
}

// Every corner a vertex of its own, as STL and flat-shaded glTF files have them.
Mesh shattered(const Mesh& mesh)
{
    Mesh result = mesh;
    result.positions.clear();
    result.triangles.clear();
    for (const uvec3 t : mesh.triangles) {
        const uint first = static_cast<uint>(result.positions.size());
        for (int k = 0; k < 3; ++k) result.positions.push_back(mesh.positions[t[k]]);
        result.triangles.push_back(uvec3(first, first + 1, first + 2));
    }
    return result;
}

Image make_image(uint width, uint height, uint format, std::array<std::uint8_t, 4> texel)
{
    Image image;
    image.name = "picture";
    image.width = width;
    image.height = height;
    image.format = format;
    for (std::size_t i = 0; i < std::size_t{width} * height; ++i)
        image.bytes.insert(image.bytes.end(), texel.begin(), texel.end());
    return image;
}

// ---- healthy scenes ----

TEST(Doctor, FindsNothingInHealthyScenes)
{
    expect_healthy(examined([](Scene& s) { place(s, make_box("box", vec3(0), vec3(1), add_grey(s))); }));
    expect_healthy(examined([](Scene& s) { place(s, make_box("glass box", vec3(0), vec3(1), add_glass(s))); }));
    expect_healthy(examined([](Scene& s) { place(s, make_torus("ring", 1.0f, 0.3f, 24, 12, add_glass(s))); }));
    expect_healthy(examined([](Scene& s) { place(s, shattered(make_box("b", vec3(0), vec3(1), add_glass(s)))); }));
    expect_healthy(examined([](Scene& s) {
        SphereDesc sphere;
        sphere.material = add_glass(s);
        place(s, sphere);
    }));
    expect_healthy(examined([](Scene& s) {
        Group group;
        group.meshes = {add(s, make_box("box", vec3(0), vec3(1), add_glass(s)))};
        const auto index = add(s, group);
        for (int i = 0; i < 100; ++i)
            add(s, InstanceDesc{"copy", index, translation(vec3(1.5f * static_cast<float>(i), 0, 0))});
    }));
}

TEST(Doctor, FindsNothingInATexturedModelWithANormalMap)
{
    expect_healthy(examined([](Scene& s) {
        MaterialDesc m;
        m.kind = material_principled;
        m.base_color = vec3(1.0f);
        m.base_texture.image = add(s, make_image(4, 4, texels_rgba8_srgb, {200, 100, 50, 255}));
        m.normal_texture.image = add(s, make_image(4, 4, texels_rgba8_linear, {128, 128, 255, 255}));
        m.principled.roughness_texture.image = add(s, make_image(4, 4, texels_rgba8_linear, {0, 128, 0, 255}));
        place(s, make_torus("ring", 1.0f, 0.3f, 24, 12, add(s, m)));
    }));
}

TEST(Doctor, HasNoDoubtsAboutTheBuiltinScenes)
{
    for (const BuiltinScene& builtin : builtin_scenes()) {
        Scene scene = builtin.make();
        validate(scene);
        const SceneReport report = examine(scene);
        EXPECT_EQ(report.doubtful + report.errors + report.repaired, 0u) << builtin.name << "\n" << all_of(report);
    }
}

// ---- counts ----

TEST(Doctor, CountsWhatThereIs)
{
    const SceneReport report = examined([](Scene& s) {
        const auto grey = add_grey(s), glass = add_glass(s);
        MaterialDesc shining;
        shining.emission = vec3(3.0f);
        shining.base_texture.image = add(s, make_image(8, 2, texels_rgba8_srgb, {255, 255, 255, 255}));
        const auto lamp = add(s, shining);
        Group group;
        group.meshes = {add(s, make_box("box", vec3(0), vec3(1), grey))};
        SphereDesc ball;
        ball.center = vec3(5.0f);
        ball.material = glass;
        group.spheres = {add(s, ball)};
        const auto index = add(s, group);
        add(s, InstanceDesc{"one", index, identity_transform()});
        add(s, InstanceDesc{"two", index, compose(translation(vec3(20, 0, 0)), scaling(vec3(-1, 1, 1)))});
        place(s, make_quad("lamp", vec3(0, 9, 0), vec3(1, 9, 0), vec3(1, 9, 1), vec3(0, 9, 1), lamp));
    });
    EXPECT_EQ(report.mesh_triangles, 14u);
    EXPECT_EQ(report.placed_triangles, 26u);
    EXPECT_EQ(report.placed_spheres, 2u);
    EXPECT_EQ(report.mirrored_instances, 1u);
    EXPECT_EQ(report.materials, (SceneReport::Tally{{"diffuse", 2}, {"dielectric", 1}}));
    EXPECT_EQ(report.lights, (SceneReport::Tally{{"point", 1}, {"triangle", 2}}));
    EXPECT_EQ(report.light_count, 3u);
    ASSERT_EQ(report.textures.size(), 1u);
    EXPECT_EQ(report.textures[0].width, 8u);
    EXPECT_EQ(report.textures[0].format, "rgba8-srgb");
    EXPECT_EQ(report.textures[0].bytes, 64u);
    EXPECT_EQ(report.texture_bytes, 64u);
    EXPECT_EQ(report.bounds.upper.x, 20.0f);
    EXPECT_GT(report.scene_bytes, 14u * 12 + 12 * 8 + 64);
    EXPECT_GT(report.packed_bytes, 0u);
    EXPECT_GT(report.accel_bytes, 0u);
    EXPECT_GT(report.peak_bytes, report.scene_bytes + report.packed_bytes + report.accel_bytes);
    expect_only(report, "mirrored-instances", Severity::info, "1 instance is mirrored");
}

TEST(Doctor, ListsTwentyOfAKindAndCountsTheRest)
{
    const SceneReport report = examined([](Scene& s) {
        const auto glass = add_glass(s);
        for (int i = 0; i < 31; ++i) {
            const float x = 3.0f * static_cast<float>(i);
            place(s, make_quad("pane", vec3(x, 0, 0), vec3(x + 1, 0, 0), vec3(x + 1, 1, 0), vec3(x, 1, 0), glass));
        }
    });
    ASSERT_EQ(report.findings.size(), 21u);
    EXPECT_EQ(report.doubtful, 31u);
    EXPECT_EQ(report.findings.back().count, 44u); // open edges
    EXPECT_NE(report.findings.back().text.find("11 more"), std::string::npos);
}

// ---- notes ----

TEST(Doctor, TakesOverWhatWasRepaired)
{
    expect_only(examined([](Scene& s) {
                    Mesh box = make_box("box", vec3(0), vec3(1), add_grey(s));
                    box.triangles.push_back(uvec3(0, 0, 1));
                    box.triangles.push_back(uvec3(2, 2, 2));
                    place(s, box);
                }),
                "degenerate-triangles", Severity::repaired, "dropped 2 triangles without area", 2);
    expect_only(examined([](Scene& s) {
                    Mesh box = make_box("box", vec3(0), vec3(1), add_grey(s));
                    box.positions.push_back(vec3(std::numeric_limits<float>::quiet_NaN()));
                    box.triangles.push_back(uvec3(0, 1, 8));
                    place(s, box);
                }),
                "non-finite-vertices", Severity::repaired, "dropped 1 triangle");
    expect_only(examined([](Scene& s) {
                    Mesh ring = make_torus("ring", 1.0f, 0.3f, 24, 12, add_grey(s));
                    ring.normals[3] = ring.normals[4] = vec3(0.0f);
                    place(s, ring);
                }),
                "zero-normals", Severity::repaired, "replaced 2 zero", 2);
    expect_only(examined([](Scene& s) {
                    MaterialDesc bright;
                    bright.base_color = vec3(2.0f, 1.0f, 1.0f);
                    place(s, make_box("box", vec3(0), vec3(1), add(s, bright)));
                }),
                "unphysical-material", Severity::repaired, "colour");
    expect_only(examined([](Scene& s) { place(s, make_box("box", vec3(0), vec3(1), {})); }), "no-material",
                Severity::repaired, "grey");
}

TEST(Doctor, SortsTheReadersNotesByTheirWords)
{
    Scene scene = scene_with([](Scene& s) { place(s, make_box("box", vec3(0), vec3(1), add_grey(s))); });
    const auto kind_of = [&](Note::Kind kind, const char* text) {
        scene.notes = {{kind, text}};
        const SceneReport report = examine(scene);
        EXPECT_EQ(report.findings.size(), 1u);
        return fmt::format("{} {}", report.findings.at(0).kind, to_string(report.findings.at(0).severity));
    };
    const auto warning = Note::Kind::warning, info = Note::Kind::info;
    EXPECT_EQ(kind_of(warning, "a.mtl:3: cannot read x.png; a magenta checkerboard stands in for it"),
              "missing-texture doubtful");
    EXPECT_EQ(kind_of(warning, "a.obj:1: the material library a.mtl is not there; its materials become grey"),
              "missing-material doubtful");
    EXPECT_EQ(kind_of(warning, "a.gltf: uses extensions that are not known and ignored: X"),
              "ignored-extension doubtful");
    EXPECT_EQ(kind_of(warning, "something unheard of"), "warning doubtful");
    EXPECT_EQ(kind_of(info, "something unheard of"), "note info");
    EXPECT_EQ(kind_of(info, "a.pbrt:4: this is ignored"), "ignored info");
}

// ---- glass and facing ----

TEST(Doctor, SeesOpenGlass)
{
    const auto open = [](Scene& s, Index<MaterialDesc> material) {
        Mesh box = make_box("tumbler", vec3(0), vec3(1), material);
        box.triangles.pop_back();
        place(s, box);
    };
    const auto report = examined([&](Scene& s) { open(s, add_glass(s)); });
    expect_only(report, "open-glass", Severity::doubtful, "mesh 'tumbler'", 3);
    EXPECT_NE(report.findings[0].text.find("'glass'"), std::string::npos);
    expect_only(examined([&](Scene& s) { open(s, add_glass(s)); }), "open-glass", Severity::doubtful, "3 edges open",
                3);

    MaterialDesc solid;
    solid.kind = material_principled;
    solid.principled.transmission = 0.9f;
    solid.principled.thin_walled = false;
    expect_only(examined([&](Scene& s) { open(s, add(s, solid)); }), "open-glass", Severity::doubtful, "tumbler", 3);
    MaterialDesc thin = solid;
    thin.principled.thin_walled = true;
    expect_healthy(examined([&](Scene& s) { open(s, add(s, thin)); }));
    expect_healthy(examined([&](Scene& s) { open(s, add_grey(s)); }));
}

TEST(Doctor, JudgesTheGlassOfAMeshOfSeveralMaterials)
{
    const auto two_boxes = [](Scene& s, bool open) {
        const auto grey = add_grey(s), glass = add_glass(s);
        Mesh mesh = make_box("both", vec3(0), vec3(1), grey);
        const Mesh other = make_box("", vec3(2), vec3(3), glass);
        mesh.positions.insert(mesh.positions.end(), other.positions.begin(), other.positions.end());
        mesh.triangle_materials.assign(12, grey);
        for (const uvec3 t : other.triangles) {
            mesh.triangles.push_back(t + uvec3(8));
            mesh.triangle_materials.push_back(glass);
        }
        if (open) mesh.triangles.pop_back(), mesh.triangle_materials.pop_back();
        place(s, mesh);
    };
    expect_healthy(examined([&](Scene& s) { two_boxes(s, false); }));
    expect_only(examined([&](Scene& s) { two_boxes(s, true); }), "open-glass", Severity::doubtful, "both", 3);
}

TEST(Doctor, TakesGlassThatIsCutIntoMeshesOfOneGroupAsOne)
{
    expect_healthy(examined([](Scene& s) {
        const Mesh box = make_box("", vec3(0), vec3(1), add_glass(s));
        Mesh first = box, second = box;
        first.triangles.resize(5);
        second.triangles.erase(second.triangles.begin(), second.triangles.begin() + 5);
        Group group;
        group.meshes = {add(s, first), add(s, second)};
        add(s, InstanceDesc{"whole", add(s, group), identity_transform()});
    }));
}

TEST(Doctor, SeesWhatIsInsideOut)
{
    const auto box = [](Scene& s, Index<MaterialDesc> material) {
        Mesh mesh = make_box("cube", vec3(0), vec3(1), material);
        turn_over(mesh);
        place(s, mesh);
    };
    expect_only(examined([&](Scene& s) { box(s, add_glass(s)); }), "inside-out-glass", Severity::doubtful, "cube", 12);
    expect_only(examined([&](Scene& s) { box(s, add_grey(s)); }), "inside-out", Severity::info, "cube", 12);
    MaterialDesc front;
    front.single_sided = true;
    expect_only(examined([&](Scene& s) { box(s, add(s, front)); }), "inside-out", Severity::info, "looks through", 12);
    expect_only(examined([&](Scene& s) {
                    Mesh mesh = make_box("cube", vec3(0), vec3(1), add_glass(s));
                    std::swap(mesh.triangles[0].x, mesh.triangles[0].y);
                    place(s, mesh);
                }),
                "mixed-winding-glass", Severity::doubtful, "3 edges", 3);
}

TEST(Doctor, VertexNormalsSayWhatIsOutside)
{
    // Wound inwards, but with normals that point outwards.
    expect_only(examined([](Scene& s) {
                    Mesh ring = make_torus("ring", 1.0f, 0.3f, 24, 12, add_glass(s));
                    turn_over(ring);
                    place(s, ring);
                }),
                "normals-against-winding", Severity::doubtful, "576 of 576", 576);
    expect_only(examined([](Scene& s) {
                    Mesh ring = make_torus("ring", 1.0f, 0.3f, 24, 12, add_glass(s));
                    turn_over(ring);
                    for (vec3& n : ring.normals) n = -n;
                    place(s, ring);
                }),
                "inside-out-glass", Severity::doubtful, "ring", 576);
}

TEST(Doctor, SeesOverlappingAndNestedGlass)
{
    const auto two = [](vec3 lower, vec3 upper) {
        return [=](Scene& s) {
            const auto glass = add_glass(s);
            place(s, make_box("first", vec3(0), vec3(1), glass));
            place(s, make_box("second", lower, upper, glass));
        };
    };
    expect_only(examined(two(vec3(0.5f), vec3(1.5f))), "overlapping-dielectrics", Severity::doubtful,
                "mesh 'first' and mesh 'second'");
    expect_only(examined(two(vec3(0.4f, 0.4f, -5.0f), vec3(0.6f, 0.6f, 6.0f))), "overlapping-dielectrics",
                Severity::doubtful, "second"); // neither has a corner in the other
    expect_only(examined(two(vec3(0.25f), vec3(0.75f))), "nested-dielectrics", Severity::info, "inside the other");
    expect_healthy(examined(two(vec3(1, 0.25f, 0.25f), vec3(2, 0.75f, 0.75f)))); // face to face
    expect_healthy(examined(two(vec3(1.5f), vec3(2.0f))));
}

TEST(Doctor, BoundingBoxesThatOverlapAreNotEnough)
{
    expect_healthy(examined([](Scene& s) {
        const auto glass = add_glass(s);
        place(s, make_torus("ring", 1.0f, 0.2f, 48, 16, glass));
        SphereDesc ball; // in the hole
        ball.radius = 0.6f;
        ball.material = glass;
        place(s, ball);
    }));
    expect_only(examined([](Scene& s) {
                    const auto glass = add_glass(s);
                    place(s, make_torus("ring", 1.0f, 0.2f, 48, 16, glass));
                    SphereDesc ball;
                    ball.name = "ball";
                    ball.radius = 0.95f;
                    ball.material = glass;
                    place(s, ball);
                }),
                "overlapping-dielectrics", Severity::doubtful, "sphere 'ball'");
}

TEST(Doctor, SeesOverlapsOfTurnedAndScaledInstances)
{
    const auto balls = [](float apart) {
        return [=](Scene& s) {
            SphereDesc ball;
            ball.material = add_glass(s);
            Group group;
            group.spheres = {add(s, ball)};
            const auto index = add(s, group);
            add(s, InstanceDesc{"a", index, scaling(vec3(2))});
            add(s, InstanceDesc{"b", index, compose(translation(vec3(apart, 0, 0)), rotation(vec3(1, 1, 1), 40))});
        };
    };
    expect_only(examined(balls(2.5f)), "overlapping-dielectrics", Severity::doubtful, "instances 0 and 1");
    expect_healthy(examined(balls(3.1f)));
}

TEST(Doctor, GivesUpInTimeOnSolidsThatAllOverlap)
{
    const SceneReport report = examined([](Scene& s) {
        const auto glass = add_glass(s);
        Group group;
        for (int i = 0; i < 3000; ++i) {
            SphereDesc ball;
            ball.center = vec3(1e-4f * static_cast<float>(i), 0, 0);
            ball.material = glass;
            group.spheres.push_back(add(s, ball));
        }
        add(s, InstanceDesc{"all", add(s, group), identity_transform()});
    });
    EXPECT_GT(report.doubtful, 100u);
    EXPECT_EQ(report.findings.back().kind, "partly-examined");
    EXPECT_EQ(report.findings.size(), SceneReport::listed_of_a_kind + 2);
}

// ---- faces twice ----

TEST(Doctor, SeesFacesThatAreThereTwice)
{
    const auto walls = [](bool same_material, bool turned) {
        return [=](Scene& s) {
            const auto grey = add_grey(s);
            const auto other = same_material ? grey : add_grey(s);
            place(s, make_quad("wall", vec3(0), vec3(1, 0, 0), vec3(1, 1, 0), vec3(0, 1, 0), grey));
            Mesh poster = make_quad("poster", vec3(0), vec3(1, 0, 0), vec3(1, 1, 0), vec3(0, 1, 0), other);
            if (turned) turn_over(poster);
            place(s, poster);
        };
    };
    expect_only(examined(walls(false, false)), "double-faces", Severity::doubtful, "mesh 'wall' and mesh 'poster'", 2);
    expect_only(examined(walls(false, true)), "double-faces", Severity::doubtful, "back to back", 2);
    expect_only(examined(walls(true, false)), "double-faces", Severity::info, "2 triangles in the same place", 2);

    // Two materials back to back are no fault if each is seen from its side only.
    const auto cards = [](bool single_sided) {
        return [=](Scene& s) {
            MaterialDesc face;
            face.single_sided = single_sided;
            place(s, make_quad("front", vec3(0), vec3(1, 0, 0), vec3(1, 1, 0), vec3(0, 1, 0), add(s, face)));
            Mesh back = make_quad("back", vec3(0), vec3(1, 0, 0), vec3(1, 1, 0), vec3(0, 1, 0), add(s, face));
            turn_over(back);
            place(s, back);
        };
    };
    expect_only(examined(cards(true)), "double-faces", Severity::info, "back to back", 2);
    expect_only(examined(cards(false)), "double-faces", Severity::doubtful, "back to back", 2);

    // In one mesh, the second time beginning at another corner.
    expect_only(examined([](Scene& s) {
                    MaterialDesc lamp;
                    lamp.emission = vec3(1.0f);
                    lamp.two_sided_emission = true;
                    Mesh quad = make_quad("lamp", vec3(0), vec3(1, 0, 0), vec3(1, 1, 0), vec3(0, 1, 0), add(s, lamp));
                    quad.triangles.push_back(uvec3(quad.triangles[0].y, quad.triangles[0].z, quad.triangles[0].x));
                    place(s, quad);
                }),
                "double-faces", Severity::doubtful, "1 triangle there twice");
}

TEST(Doctor, SeesInstancesThatAreThereTwice)
{
    expect_only(examined([](Scene& s) {
                    Group group;
                    group.meshes = {add(s, make_box("box", vec3(0), vec3(1), add_grey(s)))};
                    const auto index = add(s, group);
                    add(s, InstanceDesc{"a", index, translation(vec3(1, 2, 3))});
                    add(s, InstanceDesc{"b", index, translation(vec3(1, 2, 4))});
                    add(s, InstanceDesc{"c", index, translation(vec3(1, 2, 3))});
                }),
                "double-instance", Severity::doubtful, "instances 'a' and 'c'");
}

// ---- lamps ----

// A room without a front, and a lamp just under its ceiling.
void add_room(Scene& s, const std::function<void(Mesh&, MaterialDesc&)>& change)
{
    const auto grey = add_grey(s);
    place(s, make_quad("floor", vec3(0, 0, 0), vec3(0, 0, 4), vec3(4, 0, 4), vec3(4, 0, 0), grey));
    place(s, make_quad("ceiling", vec3(0, 4, 0), vec3(4, 4, 0), vec3(4, 4, 4), vec3(0, 4, 4), grey));
    place(s, make_quad("back", vec3(0, 0, 0), vec3(4, 0, 0), vec3(4, 4, 0), vec3(0, 4, 0), grey));
    place(s, make_box("thing", vec3(1, 0, 1), vec3(2, 1, 2), grey));
    MaterialDesc shining;
    shining.name = "light";
    shining.emission = vec3(10.0f);
    Mesh lamp = make_quad("lamp", vec3(1, 3.99f, 1), vec3(3, 3.99f, 1), vec3(3, 3.99f, 3), vec3(1, 3.99f, 3), {});
    change(lamp, shining);
    lamp.material = add(s, shining);
    place(s, lamp);
}

TEST(Doctor, SeesLampsThatFaceAway)
{
    expect_healthy(examined([](Scene& s) { add_room(s, [](Mesh&, MaterialDesc&) {}); }));
    expect_only(examined([](Scene& s) { add_room(s, [](Mesh& lamp, MaterialDesc&) { turn_over(lamp); }); }),
                "lamp-faces-away", Severity::doubtful, "mesh 'lamp' (material 'light')", 2);
    expect_healthy(examined([](Scene& s) {
        add_room(s, [](Mesh& lamp, MaterialDesc& material) {
            turn_over(lamp);
            material.two_sided_emission = true;
        });
    }));
}

TEST(Doctor, ALampShinesToTheSideOfItsVertexNormals)
{
    const auto room = [](float y, bool turned) {
        return [=](Scene& s) {
            add_room(s, [=](Mesh& lamp, MaterialDesc&) {
                lamp.normals.assign(4, vec3(0, y, 0));
                if (turned) turn_over(lamp);
            });
        };
    };
    const auto kinds = [](const SceneReport& report) {
        std::string all;
        for (const Finding& f : report.findings) all += f.kind + " ";
        return all;
    };
    EXPECT_EQ(kinds(examined(room(-1, false))), "");
    EXPECT_EQ(kinds(examined(room(-1, true))), "normals-against-winding ");
    EXPECT_EQ(kinds(examined(room(1, true))), "lamp-faces-away ");
    EXPECT_EQ(kinds(examined(room(1, false))), "lamp-faces-away normals-against-winding ");
}

TEST(Doctor, AMirroringTransformDoesNotTurnALampOver)
{
    const auto room = [](bool turned) {
        return [=](Scene& s) {
            add_room(s, [=](Mesh& lamp, MaterialDesc&) {
                if (turned) turn_over(lamp);
            });
            for (InstanceDesc& instance : s.instances) instance.transform = scaling(vec3(-1, 1, 1));
        };
    };
    EXPECT_EQ(examined(room(false)).doubtful, 0u);
    EXPECT_EQ(examined(room(true)).doubtful, 1u);
}

TEST(Doctor, SeesLampsInTheSameMeshAsWhatTheyLight)
{
    const auto joined = [](bool turned) {
        return [=](Scene& s) {
            const auto grey = add_grey(s);
            MaterialDesc shining;
            shining.emission = vec3(10.0f);
            const auto light = add(s, shining);
            Mesh mesh = make_checkerboard("all", 20, 20, 0.2f, grey, grey);
            mesh.triangle_materials.assign(mesh.triangles.size(), grey);
            Mesh lamp = make_quad("", vec3(-1, 2, -1), vec3(1, 2, -1), vec3(1, 2, 1), vec3(-1, 2, 1), light);
            if (turned) turn_over(lamp);
            const uint first = static_cast<uint>(mesh.positions.size());
            mesh.positions.insert(mesh.positions.end(), lamp.positions.begin(), lamp.positions.end());
            mesh.normals.clear();
            mesh.uvs.clear();
            for (const uvec3 t : lamp.triangles) {
                mesh.triangles.push_back(t + uvec3(first));
                mesh.triangle_materials.push_back(light);
            }
            place(s, mesh);
        };
    };
    expect_healthy(examined(joined(false)));
    expect_only(examined(joined(true)), "lamp-faces-away", Severity::doubtful, "all", 2);
}

TEST(Doctor, SeesClosedLampsThatShineIntoThemselves)
{
    const auto bulb = [](bool turned) {
        return [=](Scene& s) {
            MaterialDesc shining;
            shining.emission = vec3(10.0f);
            Mesh box = make_box("bulb", vec3(0), vec3(1), add(s, shining));
            if (turned) turn_over(box);
            place(s, box);
            place(s, make_box("thing", vec3(0, -3, 0), vec3(1, -2, 1), add_grey(s)));
        };
    };
    expect_healthy(examined(bulb(false)));
    expect_only(examined(bulb(true)), "hidden-lamp", Severity::doubtful, "bulb", 12);
}

// ---- extents ----

TEST(Doctor, SeesExtentsWherePrecisionEnds)
{
    const auto box = [](vec3 lower, float size) {
        return [=](Scene& s) { place(s, make_box("box", lower, lower + vec3(size), add_grey(s))); };
    };
    expect_only(examined(box(vec3(2e4f, 0, 0), 1.0f)), "far-from-origin", Severity::doubtful, "origin");
    expect_only(examined(box(vec3(0), 1e-4f)), "tiny-scene", Severity::doubtful, "scale it up");
    expect_only(examined(box(vec3(0), 2e4f)), "huge-scene", Severity::info, "millimetre");
    expect_healthy(examined(box(vec3(100, 0, 0), 1.0f)));
}

TEST(Doctor, SeesTrianglesSmallerThanFloatsCanTell)
{
    expect_only(examined([](Scene& s) {
                    const auto grey = add_grey(s);
                    place(s, make_quad("ground", vec3(-1e3f, 0, -1e3f), vec3(-1e3f, 0, 1e3f), vec3(1e3f, 0, 1e3f),
                                       vec3(1e3f, 0, -1e3f), grey));
                    place(s, make_torus("ring", 2e-3f, 1e-3f, 24, 12, grey), translation(vec3(999, 1, 0)));
                }),
                "tiny-triangles", Severity::doubtful, "mesh 'ring': 576 of 576", 576);
}

TEST(Doctor, SeesStrayVertices)
{
    expect_only(examined([](Scene& s) {
                    Mesh ring = make_torus("ring", 1.0f, 0.3f, 24, 12, add_grey(s));
                    ring.positions.push_back(vec3(0, 8e3f, 0));
                    ring.normals.push_back(vec3(0, 1, 0));
                    ring.uvs.push_back(vec2(0));
                    const uint last = static_cast<uint>(ring.positions.size() - 1);
                    ring.triangles.push_back(uvec3(0, 1, last));
                    place(s, ring);
                }),
                "stray-vertices", Severity::doubtful, "mesh 'ring': 1 triangle reaches");
}

TEST(Doctor, SaysWhatIsMissing)
{
    Scene bare;
    place(bare, make_box("box", vec3(0), vec3(1), add_grey(bare)));
    const SceneReport report = examine(bare);
    EXPECT_EQ(report.findings.size(), 2u) << all_of(report);
    EXPECT_NE(all_of(report).find("[no-camera] info"), std::string::npos);
    EXPECT_NE(all_of(report).find("[no-light] info"), std::string::npos);

    expect_only(examined([](Scene&) {}), "empty-scene", Severity::doubtful, "nothing to see");
    expect_only(examined([](Scene& s) {
                    const auto grey = add_grey(s);
                    place(s, make_box("box", vec3(0), vec3(1), grey));
                    add(s, make_box("spare", vec3(0), vec3(1), grey));
                }),
                "unplaced-mesh", Severity::info, "'spare'");
}

TEST(Doctor, ReportsAScenePackRefuses)
{
    const SceneReport report = examined([](Scene& s) {
        MaterialDesc shining;
        shining.emission = vec3(1.0f);
        SphereDesc ball;
        ball.material = add(s, shining);
        Group group;
        group.spheres = {add(s, ball)};
        add(s, InstanceDesc{"egg", add(s, group), scaling(vec3(1, 2, 1))});
    });
    ASSERT_EQ(report.errors, 1u);
    EXPECT_EQ(report.findings[0].kind, "cannot-render");
    EXPECT_NE(report.findings[0].text.find("egg"), std::string::npos);
}

// ---- materials ----

TEST(Doctor, SeesOddMaterials)
{
    const auto box_of = [](const std::function<void(Scene&, MaterialDesc&)>& change, bool uvs = true) {
        return [=](Scene& s) {
            MaterialDesc m;
            m.name = "paint";
            m.kind = material_principled;
            change(s, m);
            Mesh ring = make_torus("ring", 1.0f, 0.3f, 24, 12, add(s, m));
            if (!uvs) ring.uvs.clear();
            place(s, ring);
        };
    };
    const auto white = [](Scene&, MaterialDesc& m) { m.base_color = vec3(1.0f); };
    expect_only(examined(box_of(white)), "white-albedo", Severity::info, "'paint'");

    const auto textured = [](Scene& s, MaterialDesc& m) {
        m.base_texture.image = add(s, make_image(4, 4, texels_rgba8_srgb, {200, 100, 50, 255}));
    };
    expect_healthy(examined(box_of(textured)));
    expect_only(examined(box_of(textured, false)), "texture-without-uv", Severity::doubtful, "mesh 'ring' has none");
    const auto second_set = [&](Scene& s, MaterialDesc& m) {
        textured(s, m);
        m.base_texture.uv_set = 1;
    };
    expect_only(examined(box_of(second_set)), "texture-without-uv", Severity::doubtful, "second set");

    const auto srgb_normals = [](Scene& s, MaterialDesc& m) {
        m.normal_texture.image = add(s, make_image(4, 4, texels_rgba8_srgb, {128, 128, 255, 255}));
    };
    expect_only(examined(box_of(srgb_normals)), "srgb-data", Severity::doubtful, "normal map");
    const auto srgb_roughness = [](Scene& s, MaterialDesc& m) {
        m.principled.roughness_texture.image = add(s, make_image(4, 4, texels_rgba8_srgb, {0, 128, 0, 255}));
    };
    expect_only(examined(box_of(srgb_roughness)), "srgb-data", Severity::doubtful, "roughness");
    const auto height_map = [](Scene& s, MaterialDesc& m) {
        m.normal_texture.image = add(s, make_image(4, 4, texels_rgba8_linear, {90, 90, 90, 255}));
    };
    expect_only(examined(box_of(height_map)), "odd-normal-map", Severity::doubtful, "grey");

    const auto unused = [](Scene& s, MaterialDesc&) { add_grey(s); };
    expect_only(examined(box_of(unused)), "unused-material", Severity::info, "'grey'");
}

} // namespace
} // namespace snell
