// Files that others have made: what the loader finds in them against what a script that knows nothing of it has found
// (it reads the JSON and the positions, and follows the nodes of the default scene).
#include "tests/io/gltf_files.h"

#include <set>

namespace snell {
namespace {

using namespace test;

struct Expectation
{
    const char* file;
    std::size_t triangles, instances, materials, lights, cameras, skins, animations, variants; // triangles: as placed
    std::vector<float> bounds; // lower, upper; empty: packed, skinned, or morphed at rest
};

// clang-format off
const Expectation expectations[] = {
    {"AlphaBlendModeTest/glTF-Binary/AlphaBlendModeTest.glb", 61, 9, 6, 0, 0, 0, 0, 0, {-4.3, -0.1, -0.75, 4.3, 2.29953, 0.55}},
    {"AnimatedMorphCube/glTF-Binary/AnimatedMorphCube.glb", 12, 1, 1, 0, 0, 0, 1, 0, {-1, -1, -1, 1, 1, 1}},
    {"AnimatedMorphCube/glTF-Quantized/AnimatedMorphCube.gltf", 12, 1, 1, 0, 0, 0, 1, 0, {-1.00002, -1.00002, -1.00001, 1, 1, 1.00001}},
    {"AnisotropyBarnLamp/glTF-KTX2-Basisu/AnisotropyBarnLamp.gltf", 10203, 3, 3, 0, 0, 0, 0, 0, {-0.104619, -0.198292, -2.43596e-06, 0.0861901, 0.0569467, 0.226539}},
    {"AnisotropyRotationTest/glTF-Binary/AnisotropyRotationTest.glb", 13876, 11, 6, 0, 0, 0, 0, 0, {-5.55602, -3.53637, -1, 6.67531, 2.4714, 1}},
    {"AttenuationTest/glTF-Binary/AttenuationTest.glb", 292, 23, 18, 0, 0, 0, 0, 0, {-10, -10, -2, 10, 10, 2}},
    {"Box With Spaces/glTF/Box With Spaces.gltf", 12, 1, 1, 0, 0, 0, 0, 0, {-1, -1, -1, 1, 1, 1}},
    {"Box/glTF-Binary/Box.glb", 12, 1, 1, 0, 0, 0, 0, 0, {-0.5, -0.5, -0.5, 0.5, 0.5, 0.5}},
    {"Box/glTF-Draco/Box.gltf", 12, 1, 1, 0, 0, 0, 0, 0, {}},
    {"Box/glTF-Embedded/Box.gltf", 12, 1, 1, 0, 0, 0, 0, 0, {-0.5, -0.5, -0.5, 0.5, 0.5, 0.5}},
    {"Box/glTF/Box.gltf", 12, 1, 1, 0, 0, 0, 0, 0, {-0.5, -0.5, -0.5, 0.5, 0.5, 0.5}},
    {"BoxAnimated/glTF/BoxAnimated.gltf", 254, 2, 2, 0, 0, 0, 1, 0, {-0.5, -0.5, -0.5, 0.5, 0.5, 0.5}},
    {"BoxMeshopt/BoxMeshopt.glb", 12, 1, 1, 0, 0, 0, 0, 0, {}},
    {"BoxMeshopt/BoxMeshopt.gltf", 12, 1, 1, 0, 0, 0, 0, 0, {}},
    {"BoxVertexColors/glTF/BoxVertexColors.gltf", 12, 1, 0, 0, 0, 0, 0, 0, {0, 0, 0, 1, 1, 1}},
    {"Cameras/glTF/Cameras.gltf", 2, 1, 0, 0, 2, 0, 0, 0, {0, 0, -0.707592, 1, 0.706622, 0}},
    {"CesiumMan/glTF-Binary/CesiumMan.glb", 4672, 1, 1, 0, 0, 1, 1, 0, {}},
    {"CesiumMan/glTF-Draco/CesiumMan.gltf", 4672, 1, 1, 0, 0, 1, 1, 0, {}},
    {"CesiumMilkTruck/glTF/CesiumMilkTruck.gltf", 3624, 3, 4, 0, 0, 0, 1, 0, {-1.396, 0.00145183, -2.43091, 1.396, 2.58437, 2.438}},
    {"ClearCoatTest/glTF-Binary/ClearCoatTest.glb", 37116, 27, 19, 0, 0, 0, 0, 0, {-7.3578, -6.25, -0.06, 3.1, 6.85452, 1.05}},
    {"DamagedHelmet/glTF-Binary/DamagedHelmet.glb", 15452, 1, 1, 0, 0, 0, 0, 0, {-0.947459, -0.900974, -1.18716, 0.942495, 0.900995, 0.812845}},
    {"DispersionTest/DispersionTest.glb", 51827, 27, 27, 0, 0, 0, 0, 0, {-0.122874, -0.0471659, -0.0509314, 0.0936744, 0.0645696, 0.13797}},
    {"EmissiveStrengthTest/glTF-Binary/EmissiveStrengthTest.glb", 90, 6, 6, 0, 0, 0, 0, 0, {-8.00261, -6.00107, -2, 8.00111, 4.0094, 1.99893}},
    {"Fox/glTF/Fox.gltf", 576, 1, 1, 0, 0, 1, 3, 0, {}},
    {"InstanceTest/InstanceTest.glb", 200000, 2500, 0, 0, 0, 0, 0, 0, {}},
    {"InterpolationTest/glTF-Binary/InterpolationTest.glb", 110, 10, 10, 0, 0, 0, 9, 0, {-4.38678, -2.15946, -1, 4.34834, 7.95891, 1.00894}},
    {"IridescenceSuzanne/glTF-Binary/IridescenceSuzanne.glb", 11808, 3, 3, 1, 0, 0, 0, 0, {-4.32593, -0.970486, -0.778266, 4.32593, 0.939236, 0.82232}},
    {"LightsPunctualLamp/glTF/LightsPunctualLamp.gltf", 6000, 3, 3, 5, 0, 0, 0, 0, {-0.312009, 0.0110623, -0.361917, 0.814978, 1.87462, 0.359687}},
    {"MetalRoughSpheresNoTextures/glTF-Binary/MetalRoughSpheresNoTextures.glb", 1040409, 102, 98, 0, 0, 0, 0, 0, {-0.000924316, -0.0010105, -0.00334996, 0.00647656, 0.00649414, 0.000349959}},
    {"MetalRoughSpheresNoTextures/glTF/MetalRoughSpheresNoTextures.gltf", 1040409, 102, 98, 0, 0, 0, 0, 0, {-0.000924316, -0.0010105, -0.00334996, 0.00647656, 0.00649414, 0.000349959}},
    {"MorphStressTest/glTF-Binary/MorphStressTest.glb", 2412, 1, 2, 0, 0, 0, 3, 0, {-2, -0.1, -0.5, 2, 0.5, 0.5}},
    {"NegativeScaleTest/glTF/NegativeScaleTest.gltf", 7724, 11, 6, 0, 0, 0, 0, 0, {-5.16167, -4.45354, -0.5, 5.16167, 4.45354, 0.5}},
    {"NormalTangentMirrorTest/glTF-Binary/NormalTangentMirrorTest.glb", 5240, 1, 1, 0, 0, 0, 0, 0, {-1.42463, -1.2, -0.00999995, 1.41388, 1.04675, 0.0805001}},
    {"RiggedFigure/glTF-Binary/RiggedFigure.glb", 256, 1, 1, 0, 0, 1, 1, 0, {}},
    {"RiggedFigure/glTF-Draco/RiggedFigure.gltf", 256, 1, 1, 0, 0, 1, 1, 0, {}},
    {"SheenChair/glTF/SheenChair.gltf", 39936, 4, 6, 0, 0, 0, 0, 2, {-0.414022, -6.97779e-05, -0.276725, 0.412536, 0.686177, 0.29354}},
    {"SimpleInstancing/glTF-Binary/SimpleInstancing.glb", 1500, 125, 0, 0, 0, 0, 0, 0, {}},
    {"SimpleInstancing/glTF/SimpleInstancing.gltf", 1500, 125, 0, 0, 0, 0, 0, 0, {}},
    {"SimpleMorph/glTF/SimpleMorph.gltf", 1, 1, 0, 0, 0, 0, 1, 0, {}},
    {"SimpleSkin/glTF-Embedded/SimpleSkin.gltf", 8, 1, 0, 0, 0, 1, 1, 0, {}},
    {"SimpleSparseAccessor/glTF-Embedded/SimpleSparseAccessor.gltf", 12, 1, 0, 0, 0, 0, 0, 0, {}},
    {"SimpleSparseAccessor/glTF/SimpleSparseAccessor.gltf", 12, 1, 0, 0, 0, 0, 0, 0, {}},
    {"SpecularTest/glTF-Binary/SpecularTest.glb", 44828, 24, 24, 0, 0, 0, 0, 0, {-0.750846, -0.38, -0.05, 0.375, 0.38, 0.05}},
    {"SunglassesKhronos/SunglassesKhronos.glb", 13396, 8, 5, 0, 0, 0, 0, 0, {-0.0752388, -1.52914e-05, -0.157096, 0.0752622, 0.0576071, 0.00436661}},
    {"TextureSettingsTest/glTF-Binary/TextureSettingsTest.glb", 72, 10, 10, 0, 0, 0, 0, 0, {-5.16167, -5.61856, -0.15, 5.16167, 4.45354, 0.1}},
    {"TextureTransformTest/glTF/TextureTransformTest.gltf", 24, 12, 9, 0, 0, 0, 0, 0, {-1.6, -1.14127, 0, 1.6, 1.05, 0.01}},
    {"TransmissionRoughnessTest/glTF-Binary/TransmissionRoughnessTest.glb", 77792, 9, 9, 0, 0, 0, 0, 0, {-1, -0.45, -0.15, 1, 0.45, 0.35}},
    {"TransmissionTest/glTF-Binary/TransmissionTest.glb", 128775, 22, 14, 0, 1, 0, 0, 0, {-0.976367, -0.4, -0.521006, 0.826243, 0.620546, 1.36801}},
    {"Triangle/glTF/Triangle.gltf", 1, 1, 0, 0, 0, 0, 0, 0, {0, 0, 0, 1, 1, 0}},
    {"UnlitTest/glTF-Binary/UnlitTest.glb", 88, 2, 2, 0, 0, 0, 0, 0, {-2.2, -1, -1, 2.2, 1, 1}},
    {"VertexColorTest/glTF-Binary/VertexColorTest.glb", 36, 2, 2, 0, 0, 0, 0, 0, {-1, -1, -0.0127411, 1, 1, 0.0613663}},
    {"meshopt_pirate/pirate.glb", 5010, 1, 1, 0, 0, 0, 0, 0, {}},
};
// clang-format on

// What these have to say, they deserve.
const std::set<std::string> noted = {
    "AnisotropyBarnLamp/glTF-KTX2-Basisu/AnisotropyBarnLamp.gltf", // its pictures are KTX2
};

TEST(GltfFiles, HoldWhatTheirJsonSays)
{
    const std::filesystem::path folder = SNELL_SOURCE_DIR "/../shared/scenes/gltf";
    if (!std::filesystem::exists(folder)) {
        std::cout << "left out: there are no scenes in " << folder << '\n';
        GTEST_SKIP();
    }
    for (const Expectation& e : expectations) {
        SCOPED_TRACE(e.file);
        const Scene scene = load_gltf(folder / e.file, {});
        std::size_t triangles = 0;
        for (const InstanceDesc& instance : scene.instances)
            for (const Index<Mesh> mesh : scene.groups[instance.group.value].meshes)
                triangles += scene.meshes[mesh.value].triangles.size();
        EXPECT_EQ(triangles, e.triangles);
        EXPECT_EQ(scene.instances.size(), e.instances);
        // One more where a primitive has none.
        EXPECT_LE(scene.materials.size() - e.materials, 1u);
        EXPECT_EQ(scene.lights.size(), e.lights);
        EXPECT_EQ(scene.cameras.size(), e.cameras);
        EXPECT_EQ(scene.skins.size(), e.skins);
        EXPECT_EQ(scene.animations.size(), e.animations);
        EXPECT_EQ(scene.variants.size(), e.variants);
        EXPECT_EQ(notes_of(scene).empty(), noted.count(e.file) == 0) << notes_of(scene);
        const Bounds bounds = scene_bounds(scene);
        const float size = length(bounds.extent());
        for (std::size_t i = 0; i < e.bounds.size(); ++i) {
            const int axis = static_cast<int>(i % 3);
            EXPECT_NEAR(i < 3 ? bounds.lower[axis] : bounds.upper[axis], e.bounds[i], 1e-5f * size) << i;
        }
    }
}

// The same model, packed in different ways.
TEST(GltfFiles, PackedModelsAreTheSame)
{
    const std::filesystem::path folder = SNELL_SOURCE_DIR "/../shared/scenes/gltf";
    if (!std::filesystem::exists(folder)) GTEST_SKIP() << "there are no scenes in " << folder;
    const std::pair<const char*, const char*> pairs[] = {
        {"CesiumMan/glTF-Binary/CesiumMan.glb", "CesiumMan/glTF-Draco/CesiumMan.gltf"},
        {"RiggedFigure/glTF-Binary/RiggedFigure.glb", "RiggedFigure/glTF-Draco/RiggedFigure.gltf"},
        {"Box/glTF/Box.gltf", "Box/glTF-Draco/Box.gltf"},
        {"Box/glTF/Box.gltf", "BoxMeshopt/BoxMeshopt.glb"},
        {"Box/glTF/Box.gltf", "BoxMeshopt/BoxMeshopt.gltf"},
        {"AnimatedMorphCube/glTF-Binary/AnimatedMorphCube.glb",
         "AnimatedMorphCube/glTF-Quantized/AnimatedMorphCube.gltf"},
    };
    for (const auto& [plain, packed] : pairs) {
        const Scene a = load_gltf(folder / plain, {}), b = load_gltf(folder / packed, {});
        const Bounds in = scene_bounds(a), out = scene_bounds(b);
        const float size = length(in.extent());
        for (int k = 0; k < 3; ++k) {
            EXPECT_NEAR(in.lower[k], out.lower[k], 1e-3f * size) << packed;
            EXPECT_NEAR(in.upper[k], out.upper[k], 1e-3f * size) << packed;
        }
        EXPECT_EQ(a.meshes[0].uvs.empty(), b.meshes[0].uvs.empty());
        EXPECT_EQ(a.meshes[0].normals.empty(), b.meshes[0].normals.empty());
        EXPECT_NEAR(
            mesh_area(a.meshes[0]),
            mesh_area(b.meshes[0]) *
                std::pow(determinant(a.instances[0].transform) / determinant(b.instances[0].transform), -2.0f / 3.0f),
            2e-2 * mesh_area(a.meshes[0]))
            << packed;
    }
}

} // namespace
} // namespace snell
