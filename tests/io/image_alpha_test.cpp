// Alpha in pictures: multiplied into the colours in EXR and in memory, not in PNG.
#include "snell/io/image/read.h"
#include "snell/io/image/write.h"
#include "tests/io/image_helpers.h"

namespace snell {
namespace {

TEST(PictureAlpha, PngColoursAreThoseOfWhatCovers)
{
    const TemporaryFolder folder;
    const float white = 1.0f, mid = 0.21586f; // the sRGB byte 128
    Picture picture{4, 1, {vec3(mid), 0.5f * vec3(mid), 0.25f * vec3(white), vec3(0.0f)}};
    Layers layers;
    layers.alpha = {1.0f, 0.5f, 0.25f, 0.0f};
    write_picture(folder / "a.png", picture, layers);
    const Image image = read_texture(folder / "a.png", true);
    ASSERT_EQ(image.bytes.size(), 16u);
    const int expected[4][2] = {{128, 255}, {128, 128}, {255, 64}, {0, 0}}; // colour, alpha
    for (std::size_t i = 0; i < 4; ++i) {
        for (std::size_t c = 0; c < 3; ++c) EXPECT_NEAR(image.bytes[4 * i + c], expected[i][0], 1) << i;
        EXPECT_EQ(image.bytes[4 * i + 3], expected[i][1]) << i;
    }
    write_picture(folder / "b.png", picture); // opaque: no alpha channel, the colours as they are
    const Image opaque = read_texture(folder / "b.png", true);
    EXPECT_NEAR(opaque.bytes[4], 92, 1);
    EXPECT_EQ(opaque.bytes[7], 255);
}

} // namespace
} // namespace snell
