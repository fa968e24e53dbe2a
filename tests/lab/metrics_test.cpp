#include "snell/lab/metrics.h"

#include "snell/core/error.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace snell {
namespace {

Picture flat(int width, int height, vec3 color)
{
    Picture picture;
    picture.width = width;
    picture.height = height;
    picture.pixels.assign(static_cast<std::size_t>(width) * static_cast<std::size_t>(height), color);
    return picture;
}

TEST(Metrics, EqualPicturesDoNotDiffer)
{
    const Picture picture = flat(3, 2, {0.25f, 0.5f, 2.0f});
    const PictureError error = compare_pictures(picture, picture);
    EXPECT_EQ(error.mse, 0.0);
    EXPECT_EQ(error.relmse, 0.0);
    EXPECT_TRUE(std::isinf(error.psnr) && error.psnr > 0.0);
    EXPECT_EQ(error.pixels, 6u);
    EXPECT_EQ(error.bad_pixels + error.bad_reference_pixels, 0u);
}

TEST(Metrics, KnownValues)
{
    // One of four pixels is 0.1 too bright in red alone: mse = 0.01 / 12.
    const Picture reference = flat(2, 2, vec3(0.5f));
    Picture picture = reference;
    picture.at(1, 0).x += 0.1f;
    const PictureError error = compare_pictures(picture, reference);
    EXPECT_NEAR(error.mse, 0.01 / 12.0, 1e-9);
    EXPECT_NEAR(error.psnr, 10.0 * std::log10(12.0 / 0.01), 1e-4);
    EXPECT_NEAR(error.relmse, std::pow(0.2126 * 0.1, 2.0) / (0.25 + 0.01) / 4.0, 1e-9);
}

TEST(Metrics, RelativeToTheSecondPicture)
{
    const Picture dark = flat(1, 1, vec3(0.0f)), bright = flat(1, 1, vec3(1.0f));
    EXPECT_NEAR(compare_pictures(bright, dark).relmse, 1.0 / 0.01, 1e-6);
    EXPECT_NEAR(compare_pictures(dark, bright).relmse, 1.0 / 1.01, 1e-6);
    EXPECT_NEAR(compare_pictures(dark, bright).mse, 1.0, 1e-12);
    EXPECT_NEAR(compare_pictures(dark, bright).psnr, 0.0, 1e-9);
}

TEST(Metrics, PixelsThatAreNotFiniteAreCountedAndLeftOut)
{
    Picture picture = flat(2, 2, vec3(0.5f)), reference = picture;
    picture.at(0, 0).y = std::numeric_limits<float>::quiet_NaN();
    picture.at(0, 1).z = std::numeric_limits<float>::infinity();
    reference.at(1, 0).x = -std::numeric_limits<float>::infinity();
    picture.at(1, 1) = vec3(0.6f);
    const PictureError error = compare_pictures(picture, reference);
    EXPECT_EQ(error.bad_pixels, 2u);
    EXPECT_EQ(error.bad_reference_pixels, 1u);
    EXPECT_EQ(error.pixels, 1u);
    EXPECT_NEAR(error.mse, 0.01, 1e-7);
}

TEST(Metrics, NothingToCompareIsNotANumber)
{
    const Picture nan = flat(2, 1, vec3(std::numeric_limits<float>::quiet_NaN()));
    const PictureError error = compare_pictures(nan, nan);
    EXPECT_EQ(error.pixels, 0u);
    EXPECT_TRUE(std::isnan(error.mse));
    EXPECT_TRUE(std::isnan(error.relmse));
}

TEST(Metrics, SizesMustAgree)
{
    EXPECT_THROW(compare_pictures(flat(2, 3, vec3(0.0f)), flat(3, 2, vec3(0.0f))), Error);
    EXPECT_THROW(difference_picture(flat(2, 3, vec3(0.0f)), flat(2, 2, vec3(0.0f))), Error);
    EXPECT_THROW(compare_pictures(Picture{}, Picture{}), Error);
}

TEST(Metrics, DifferenceIsAbsolute)
{
    const Picture difference = difference_picture(flat(1, 1, {0.25f, 1.0f, 0.5f}), flat(1, 1, {0.5f, 0.5f, 0.5f}));
    EXPECT_EQ(difference.at(0, 0).x, 0.25f);
    EXPECT_EQ(difference.at(0, 0).y, 0.5f);
    EXPECT_EQ(difference.at(0, 0).z, 0.0f);
}

} // namespace
} // namespace snell
