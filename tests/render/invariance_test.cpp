// A picture is a function of scene and settings: threads, tiles, crops and interruptions do not change a bit.
#include "tests/render/scenes.h"

#include <algorithm>

namespace snell::test {
namespace {

const char* const all_integrators[] = {"path",         "direct", "whitted",  "ao",       "furnace",           "normals",
                                       "uv",           "depth",  "albedo",   "steps",    "geometric-normals", "facing",
                                       "barycentrics", "object", "instance", "material", "primitive"};

class Invariance : public testing::TestWithParam<const char*>
{
  protected:
    void SetUp() override
    {
        settings_ = small_picture(GetParam());
        prepared_ = prepare(mixed_scene(), settings_);
        settings_.threads = 1;
        reference_ = render(*prepared_, settings_).film;
    }

    RenderSettings settings_;
    std::unique_ptr<Prepared> prepared_;
    Film reference_;
};

INSTANTIATE_TEST_SUITE_P(, Invariance, testing::ValuesIn(all_integrators), [](const auto& integrator) {
    std::string name = integrator.param;
    std::replace(name.begin(), name.end(), '-', '_');
    return name;
});

TEST_P(Invariance, PictureShowsSomething)
{
    int lit = 0;
    for (const vec3& v : reference_.sum) lit += is_black(v) ? 0 : 1;
    EXPECT_GT(lit, 100);
    for (const uint n : reference_.sample_count) ASSERT_EQ(n, settings_.spp);
    EXPECT_EQ(reference_.dropped_samples, 0u);
}

TEST_P(Invariance, ThreadsAndTiles)
{
    for (const int threads : {1, 2, 4})
        for (const int tile : {1, 7, 16, 64}) {
            SCOPED_TRACE(testing::Message() << threads << " threads, tiles of " << tile);
            settings_.threads = threads;
            settings_.tile_size = tile;
            expect_same_film(render(*prepared_, settings_).film, reference_);
        }
}

TEST_P(Invariance, PreparedAgain)
{
    settings_.threads = 2;
    expect_same_film(render(mixed_scene(), settings_).film, reference_);
}

TEST_P(Invariance, CropIsAPartOfTheWhole)
{
    const Region crop{5, 3, 30, 17};
    settings_.region = crop;
    settings_.threads = 2;
    const Film part = render(*prepared_, settings_).film;
    ASSERT_EQ(part.width, reference_.width);
    for (int y = 0; y < part.height; ++y)
        for (int x = 0; x < part.width; ++x) {
            const auto i = static_cast<std::size_t>(y * part.width + x);
            if (x >= crop.x0 && x < crop.x1 && y >= crop.y0 && y < crop.y1) {
                ASSERT_EQ(part.sum[i], reference_.sum[i]) << x << "," << y;
                ASSERT_EQ(part.sample_count[i], settings_.spp);
                ASSERT_EQ(part.layers.albedo[i], reference_.layers.albedo[i]);
                ASSERT_EQ(part.layers.object[i], reference_.layers.object[i]);
            } else {
                ASSERT_EQ(part.sample_count[i], 0u);
                ASSERT_EQ(part.sum[i], vec3(0.0f));
            }
        }
}

// Two machines, each with a share of the samples.
TEST_P(Invariance, SharesOfTheSamplesAddUp)
{
    settings_.spp = 16;
    const Film whole = render(*prepared_, settings_).film;
    settings_.spp = 8;
    const Film first = render(*prepared_, settings_).film;
    settings_.first_sample = 8;
    const Film second = render(*prepared_, settings_).film;
    EXPECT_FALSE(same_bits(first.sum, second.sum) && std::string(GetParam()) != "normals") << "the same samples twice";
    for (std::size_t i = 0; i < whole.sum.size(); ++i) {
        ASSERT_EQ(first.sample_count[i] + second.sample_count[i], whole.sample_count[i]);
        for (int c = 0; c < 3; ++c) { // but for the order of additions
            const float sum = first.sum[i][c] + second.sum[i][c];
            ASSERT_NEAR(sum, whole.sum[i][c], 2e-6f * sum) << "pixel " << i;
        }
    }
}

TEST_P(Invariance, OtherStructuresGiveTheSamePicture)
{
    if (std::string(GetParam()) == "steps") return; // the picture of the structure itself
    for (const AccelInfo& info : accels()) {
        if (!info.exact) continue;
        RenderSettings other = settings_;
        other.accel = std::string(info.name);
        other.threads = 2;
        SCOPED_TRACE(other.accel);
        Film film = render(mixed_scene(), other).film;
        film.layers.steps = reference_.layers.steps;
        expect_same_film(film, reference_);
    }
}

TEST(Seeds, GiveOtherPicturesOfTheSameScene)
{
    RenderSettings settings = small_picture("path");
    const auto prepared = prepare(mixed_scene(), settings);
    const Film a = render(*prepared, settings).film;
    settings.seed = 1;
    const Film b = render(*prepared, settings).film;
    int different = 0;
    double sum_a = 0, sum_b = 0;
    for (std::size_t i = 0; i < a.sum.size(); ++i) {
        different += a.sum[i] != b.sum[i] ? 1 : 0;
        sum_a += double{luminance(a.sum[i])}, sum_b += double{luminance(b.sum[i])};
    }
    EXPECT_GT(different, static_cast<int>(a.sum.size()) * 9 / 10);
    EXPECT_NEAR(sum_a / sum_b, 1, 0.05);

    settings.sampler = "independent";
    EXPECT_FALSE(same_bits(render(*prepared, settings).film.sum, b.sum));
}

TEST(Jitter, CanBeSwitchedOff)
{
    RenderSettings settings = small_picture("depth");
    settings.pixel_jitter = false;
    settings.spp = 4;
    const Film film = render(mixed_scene(), settings).film;
    // four times the same ray: no variance
    for (std::size_t i = 0; i < film.sum.size(); ++i) {
        const float mean = film.sum[i].y / 4.0f;
        ASSERT_NEAR(film.square_sum[i] / 4.0f, mean * mean, 1e-5f * mean * mean + 1e-12f);
    }
}

TEST(Overrides, ForceDiffuseAndNoTextures)
{
    RenderSettings settings = small_picture("albedo");
    const Film plain = render(mixed_scene(), settings).film;
    settings.image_textures = false;
    const Film untextured = render(mixed_scene(), settings).film;
    int changed = 0;
    for (std::size_t i = 0; i < plain.sum.size(); ++i) changed += plain.sum[i] != untextured.sum[i] ? 1 : 0;
    EXPECT_GT(changed, 100);

    // without mirrors and glass a path sees no emitter but at its first hit
    settings.integrator = "whitted";
    settings.force_diffuse = true;
    const Film flat = render(mixed_scene(), settings).film;
    for (const vec3& v : flat.layers.indirect) ASSERT_EQ(v, vec3(0.0f));
}

// Very many samples: a constant stays the constant, and the variance that of what was drawn.
TEST(Film, LongSumsStayExact)
{
    Film film(1, 1, false);
    constexpr int n = 3'000'000;
    double squares = 0;
    for (int i = 0; i < n; ++i) {
        const float x = i % 2 == 0 ? 0.19f : 0.21f;
        film.add_sample(0, vec3(0.2f, x, 0.2f));
        const auto l = static_cast<double>(luminance(vec3(0.2f, x, 0.2f)));
        squares += l * l;
    }
    const vec3 mean = film.picture().pixels[0];
    EXPECT_NEAR(mean.x, 0.2f, 1e-7f);
    EXPECT_NEAR(mean.y, 0.2f, 1e-7f);
    EXPECT_NEAR(film.square_sum[0] / squares, 1, 1e-6);
}

} // namespace
} // namespace snell::test
