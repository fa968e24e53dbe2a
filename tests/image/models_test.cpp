// Models whose own labels and marks say what they should look like (Khronos's glTF samples), against pictures that were
// looked at when they were kept. The models are not part of the project; SNELL_UPDATE_PICTURES=1 keeps new pictures.
#include "snell/core/error.h"
#include "snell/io/image/read.h"
#include "snell/io/image/write.h"
#include "snell/io/load.h"
#include "snell/render/render.h"
#include "snell/scene/animation.h"
#include "snell/scene/studio.h"
#include "tests/stat/chi_square.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>

namespace snell::test {
namespace {

struct Model
{
    const char* name;           // of the folder
    const char* file;           // in it
    vec3 eye, target;           // equal: the file's own camera
    const char* animation = ""; // "all": everything at once, as the model wants to be seen
    float seconds = 0.0f;
    bool noisy = false;  // needs more samples, and differs more all the same
    bool studio = false; // in the studio, though it has lights of its own
};

// clang-format off
const Model models[] = {
    {"AlphaBlendModeTest", "glTF-Binary/AlphaBlendModeTest.glb", {0, 1.6f, 9.2f}, {0, 1.0f, 0}},
    {"AnisotropyRotationTest", "glTF-Binary/AnisotropyRotationTest.glb", {0.2f, -0.5f, 11}, {0.2f, -0.5f, 0}},
    {"AttenuationTest", "glTF-Binary/AttenuationTest.glb", {0, 1, 28}, {0, 0, 0}, "", 0, true},
    {"BoxAnimated", "glTF/BoxAnimated.gltf", {1.4f, 2.2f, 2.6f}, {0, 0.4f, 0}, "all", 2.5f},
    {"Cameras", "glTF/Cameras.gltf", {}, {}},
    {"CesiumMan", "glTF-Binary/CesiumMan.glb", {1.0f, 1.2f, 2.3f}, {0, 0.75f, 0}, "all", 0.5f},
    {"ClearCoatTest", "glTF-Binary/ClearCoatTest.glb", {-2.1f, 0.3f, 19.5f}, {-2.1f, 0.3f, 0}},
    {"DispersionTest", "DispersionTest.glb", {-0.01f, 0.02f, 0.17f}, {-0.01f, 0.01f, 0}, "", 0, true},
    {"EmissiveStrengthTest", "glTF-Binary/EmissiveStrengthTest.glb", {0, 0.5f, 18}, {0, -1, 0}, "", 0, true},
    {"Fox", "glTF/Fox.gltf", {150, 90, 120}, {0, 40, -10}, "Run", 0.3f},
    {"InstanceTest", "InstanceTest.glb", {0.6f, 0.3f, 3.4f}, {0, 0, 0}, "", 0, true},
    {"InterpolationTest", "glTF-Binary/InterpolationTest.glb", {0, 5, 22}, {0, 4.5f, 0}, "all", 0.6f},
    {"IridescenceSuzanne", "glTF-Binary/IridescenceSuzanne.glb", {0, 0.5f, 9.5f}, {0, 0, 0}, "", 0, true, true},
    {"MetalRoughSpheresNoTextures", "glTF-Binary/MetalRoughSpheresNoTextures.glb",
     {0.0028f, 0.0027f, 0.0114f}, {0.0028f, 0.0027f, 0}},
    {"MorphStressTest", "glTF-Binary/MorphStressTest.glb", {0, 1.6f, 4.2f}, {0, 0.5f, 0}, "Individuals", 2.5f},
    {"NegativeScaleTest", "glTF/NegativeScaleTest.gltf", {0, 0, 13.2f}, {0, 0, 0}},
    {"NormalTangentMirrorTest", "glTF-Binary/NormalTangentMirrorTest.glb", {0, -0.07f, 3.25f}, {0, -0.07f, 0}},
    {"RiggedFigure", "glTF-Binary/RiggedFigure.glb", {1.2f, 1.1f, 2.2f}, {0, 0.7f, 0}, "all", 0.5f},
    {"SimpleInstancing", "glTF/SimpleInstancing.gltf", {5.5f, 8, 32}, {5.5f, 5.5f, 5.5f}, "", 0, true},
    {"SimpleMorph", "glTF/SimpleMorph.gltf", {0.5f, 0.75f, 2.4f}, {0.5f, 0.75f, 0}, "all", 1.0f},
    {"SimpleSkin", "glTF-Embedded/SimpleSkin.gltf", {0, 1, 3.3f}, {0, 1, 0}, "all", 1.0f},
    {"SimpleSparseAccessor", "glTF/SimpleSparseAccessor.gltf", {3, 2, 7.5f}, {3, 2, 0}},
    {"SpecularTest", "glTF-Binary/SpecularTest.glb", {-0.19f, 0, 1.3f}, {-0.19f, 0, 0}},
    {"TextureSettingsTest", "glTF-Binary/TextureSettingsTest.glb", {0, -0.6f, 14.5f}, {0, -0.6f, 0}},
    {"TextureTransformTest", "glTF/TextureTransformTest.gltf", {0, -0.05f, 3.4f}, {0, -0.05f, 0}},
    {"TransmissionRoughnessTest", "glTF-Binary/TransmissionRoughnessTest.glb", {-0.02f, 0, 1.5f}, {-0.02f, 0, 0},
     "", 0, true},
    {"TransmissionTest", "glTF-Binary/TransmissionTest.glb", {}, {}, "", 0, true},
    {"UnlitTest", "glTF-Binary/UnlitTest.glb", {0, 0.6f, 6}, {0, 0, 0}},
    {"VertexColorTest", "glTF-Binary/VertexColorTest.glb", {0, 0, 3}, {0, 0, 0}},
};
// clang-format on

constexpr int width = 112, height = 80, block = 8;

const std::filesystem::path folder = SNELL_SOURCE_DIR "/../shared/scenes/gltf";

std::filesystem::path kept_picture(const Model& model)
{
    return std::filesystem::path(SNELL_SOURCE_DIR "/tests/image/models") / (std::string(model.name) + ".png");
}

// The scene in the pose and with the camera of the picture.
Scene open_model(const Model& model)
{
    Scene scene = load_scene(folder / model.name / model.file);
    const std::string animation = model.animation;
    if (animation == "all")
        for (std::size_t i = 1; i < scene.animations.size(); ++i) {
            auto& all = scene.animations[0].channels;
            const auto& more = scene.animations[i].channels;
            all.insert(all.end(), more.begin(), more.end());
        }
    for (uint i = 0; i < scene.animations.size(); ++i)
        if (scene.animations[i].name == animation || (animation == "all" && i == 0)) pose(scene, {i}, model.seconds);
    if (model.eye != model.target) {
        CameraDesc camera;
        camera.eye = model.eye;
        camera.target = model.target;
        scene.cameras = {camera};
    }
    complete(scene, static_cast<float>(width) / height);
    if (model.studio) add_studio(scene);
    return scene;
}

uint spp(const Model& model)
{
    return model.noisy ? 64 : 16;
}

Picture render_model(const Scene& scene, uint samples, uint seed)
{
    RenderSettings settings;
    settings.width = width;
    settings.height = height;
    settings.spp = samples;
    settings.seed = seed;
    settings.strict = true;
    return render(scene, settings).film.picture();
}

// How far apart two pictures are, in display values of 0 to 255: of the means of blocks of 8 x 8 pixels, on average,
// and where they are furthest apart. Clipping to what can be displayed comes first, or a firefly would outweigh a lost
// texture.
struct Distance
{
    double mean = 0, worst = 0;
    int worst_x = 0, worst_y = 0;
};

vec3 shown(vec3 radiance)
{
    return 255.0f * display_value(radiance, 0.0f, tone_none);
}

Distance distance(const Picture& a, const Picture& b)
{
    Distance d;
    for (int y = 0; y < height; y += block)
        for (int x = 0; x < width; x += block) {
            vec3 sum(0.0f);
            for (int i = 0; i < block * block; ++i) {
                const int px = x + i % block, py = y + i / block;
                sum += shown(a.at(px, py)) - shown(b.at(px, py));
            }
            const vec3 block_mean = abs(sum) / static_cast<float>(block * block);
            const double difference = double{max3(block_mean)};
            d.mean += difference * block * block / (width * height);
            if (difference > d.worst) d = {d.mean, difference, x, y};
        }
    return d;
}

// Pictures of other seeds come to 1.2 on average and 9 at worst, the noisy ones to 2.5 and 14.
struct Bound
{
    double mean, worst;
};
Bound bound(const Model& model)
{
    return model.noisy ? Bound{3.0, 18.0} : Bound{1.5, 12.0};
}

bool is_update()
{
    const char* value = std::getenv("SNELL_UPDATE_PICTURES");
    return value != nullptr && *value == '1';
}

class HeavyModels : public testing::TestWithParam<Model>
{
  protected:
    void SetUp() override
    {
        if (!exists(folder)) GTEST_SKIP() << "left out: Khronos's models are not part of the project";
    }
};

INSTANTIATE_TEST_SUITE_P(, HeavyModels, testing::ValuesIn(models),
                         [](const auto& model) { return std::string(model.param.name); });

TEST_P(HeavyModels, LookAsWhenTheyWereLookedAt)
{
    const Model& model = GetParam();
    const Scene scene = open_model(model);
    if (is_update()) {
        write_picture(kept_picture(model), render_model(scene, 8 * spp(model), 1));
        return;
    }
    const Picture picture = render_model(scene, spp(model), static_cast<uint>(test_seed()));
    const Distance d = distance(picture, read_picture(kept_picture(model)));
    if (long_tests()) std::printf("%-30s mean %.2f, worst %.2f\n", model.name, d.mean, d.worst);
    EXPECT_LT(d.mean, bound(model).mean) << "of 255, on average";
    EXPECT_LT(d.worst, bound(model).worst) << "of 255, in the block at " << d.worst_x << "," << d.worst_y;
    if (HasFailure()) {
        const std::filesystem::path file = std::filesystem::temp_directory_path() / (std::string(model.name) + ".png");
        write_picture(file, picture);
        std::printf("see %s and %s\n", file.c_str(), kept_picture(model).c_str());
    }
}

// What a broken loader would make of a model is further from its picture than noise.
struct Mistake
{
    const char* what;
    const char* model;
    void (*make)(Scene&);
};

const Mistake mistakes[] = {
    {"TexturesUpsideDown", "TextureSettingsTest",
     [](Scene& scene) {
         for (Mesh& mesh : scene.meshes)
             for (vec2& uv : mesh.uvs) uv.y = 1.0f - uv.y;
     }},
    {"TexturesNotWrapped", "TextureSettingsTest",
     [](Scene& scene) {
         for (MaterialDesc& material : scene.materials)
             material.base_texture.wrap_u = material.base_texture.wrap_v = wrap_repeat;
     }},
    {"TexturesNotTransformed", "TextureTransformTest",
     [](Scene& scene) {
         for (MaterialDesc& material : scene.materials)
             material.base_texture.row_u = vec3(1, 0, 0), material.base_texture.row_v = vec3(0, 1, 0);
     }},
    {"NoVertexColors", "VertexColorTest",
     [](Scene& scene) {
         for (Mesh& mesh : scene.meshes) mesh.colors.clear();
     }},
    {"BacksSeen", "NegativeScaleTest",
     [](Scene& scene) {
         for (MaterialDesc& material : scene.materials) material.single_sided = false;
     }},
    {"NormalMapsUpsideDown", "NormalTangentMirrorTest",
     [](Scene& scene) {
         for (Mesh& mesh : scene.meshes)
             for (vec4& tangent : mesh.tangents) tangent.w = -tangent.w;
     }},
    {"NoCutoff", "AlphaBlendModeTest",
     [](Scene& scene) {
         for (MaterialDesc& material : scene.materials) material.cutoff = 0.5f;
     }},
    {"NoClearcoat", "ClearCoatTest",
     [](Scene& scene) {
         for (MaterialDesc& material : scene.materials) material.principled.clearcoat = 0.0f;
     }},
    {"NoSpecularColor", "SpecularTest",
     [](Scene& scene) {
         for (MaterialDesc& material : scene.materials) material.principled.specular_color = vec3(1.0f);
     }},
    {"NoTransmission", "TransmissionTest",
     [](Scene& scene) {
         for (MaterialDesc& material : scene.materials) material.principled.transmission = 0.0f;
     }},
    {"NoAttenuation", "AttenuationTest",
     [](Scene& scene) {
         for (MaterialDesc& material : scene.materials) material.absorption = vec3(0.0f);
     }},
    {"NoIridescence", "IridescenceSuzanne",
     [](Scene& scene) {
         for (MaterialDesc& material : scene.materials) material.principled.iridescence = 0.0f;
     }},
    {"NoAnisotropy", "AnisotropyRotationTest",
     [](Scene& scene) {
         for (MaterialDesc& material : scene.materials) material.principled.anisotropy = 0.0f;
     }},
    {"NoDispersion", "DispersionTest",
     [](Scene& scene) {
         for (MaterialDesc& material : scene.materials) material.principled.dispersion = 0.0f;
     }},
    {"Lit", "UnlitTest", [](Scene& scene) { add_studio(scene); }},
    {"AtRest", "CesiumMan", [](Scene& scene) { pose(scene, {}, 0.0f); }},
};

class HeavyModelMistakes : public testing::TestWithParam<Mistake>
{
};

INSTANTIATE_TEST_SUITE_P(, HeavyModelMistakes, testing::ValuesIn(mistakes),
                         [](const auto& mistake) { return std::string(mistake.param.what); });

TEST_P(HeavyModelMistakes, AreSeen)
{
    if (!exists(folder)) GTEST_SKIP() << "left out: Khronos's models are not part of the project";
    const Mistake& mistake = GetParam();
    const auto model = std::find_if(std::begin(models), std::end(models),
                                    [&](const Model& m) { return std::string(m.name) == mistake.model; });
    ASSERT_NE(model, std::end(models));
    Scene scene = open_model(*model);
    mistake.make(scene);
    const Picture picture = render_model(scene, spp(*model), static_cast<uint>(test_seed()));
    const Distance d = distance(picture, read_picture(kept_picture(*model)));
    if (long_tests()) std::printf("%-30s mean %.2f, worst %.2f\n", mistake.what, d.mean, d.worst);
    EXPECT_TRUE(d.mean > bound(*model).mean || d.worst > bound(*model).worst) << d.mean << ", worst " << d.worst;
}

} // namespace
} // namespace snell::test
