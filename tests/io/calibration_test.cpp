// Calibrations as OpenCV writes them, whole and broken.
#include "snell/core/error.h"
#include "snell/io/calibration.h"

#include <gtest/gtest.h>

#include <fstream>

namespace snell {
namespace {

CameraModel read_calibration(const std::string& text, const char* name = "calibration.yml")
{
    const std::filesystem::path file = std::filesystem::path(testing::TempDir()) / name;
    std::ofstream(file, std::ios::binary) << text;
    return load_calibration(file);
}

const std::string yaml_start = "%YAML:1.0\n---\nimage_width: 640\nimage_height: 480\n";
const std::string yaml_matrix = "camera_matrix: !!opencv-matrix\n   rows: 3\n   cols: 3\n   dt: d\n"
                                "   data: [ 5.3e+02, 0., 319.5, 0., 5.4e+02, 239.5, 0., 0., 1. ]\n";
const std::string yaml_five = "distortion_coefficients: !!opencv-matrix\n   rows: 5\n   cols: 1\n   dt: d\n"
                              "   data: [ -0.2, 0.05, 0.001, -0.002, 0.01 ]\n";

void expect_the_camera(const CameraModel& m)
{
    EXPECT_EQ(m.kind, camera_brown_conrady);
    EXPECT_EQ(m.calibrated_width, 640.0f);
    EXPECT_EQ(m.calibrated_height, 480.0f);
    EXPECT_EQ(m.focal, vec2(530.0f, 540.0f));
    EXPECT_EQ(m.center, vec2(320.0f, 240.0f)); // half a pixel on: OpenCV counts from the middle of the first one
    const float k[8] = {-0.2f, 0.05f, 0.01f, 0, 0, 0, 0.001f, -0.002f};
    for (std::size_t i = 0; i < 8; ++i) EXPECT_EQ(m.k[i], k[i]) << i;
}

TEST(Calibration, YamlAndXml)
{
    expect_the_camera(read_calibration(yaml_start + yaml_matrix + yaml_five));
    expect_the_camera(read_calibration(
        "<?xml version=\"1.0\"?>\n<opencv_storage>\n<image_width>640</image_width>\n<image_height>480</image_height>\n"
        "<cameraMatrix type_id=\"opencv-matrix\">\n  <rows>3</rows>\n  <cols>3</cols>\n  <dt>d</dt>\n  <data>\n"
        "    530. 0. 319.5 0. 540. 239.5 0. 0. 1.</data></cameraMatrix>\n"
        "<distCoeffs type_id=\"opencv-matrix\">\n  <rows>5</rows>\n  <cols>1</cols>\n  <dt>d</dt>\n  <data>\n"
        "    -0.2 0.05 0.001 -0.002 0.01</data></distCoeffs>\n</opencv_storage>\n",
        "calibration.xml"));
}

TEST(Calibration, FisheyesSaySo)
{
    const std::string four = "D: !!opencv-matrix\n   rows: 4\n   cols: 1\n   dt: d\n   data: [ 0.01, 0.002, 0., 0. ]\n";
    EXPECT_EQ(read_calibration(yaml_start + yaml_matrix + four).kind, camera_brown_conrady);
    const CameraModel m = read_calibration(yaml_start + "fisheye_model: 1\n" + yaml_matrix + four);
    EXPECT_EQ(m.kind, camera_kannala_brandt);
    EXPECT_EQ(m.k[1], 0.002f);
}

TEST(Calibration, BrokenOnesAreErrors)
{
    const std::string broken[] = {
        "",
        "not a calibration",
        yaml_start,
        yaml_start + yaml_matrix,
        yaml_matrix + yaml_five,
        yaml_start + "camera_matrix:\n   data: [ 1., 2. ]\n" + yaml_five,
        yaml_start + "camera_matrix:\n   data: [ 530, 0, x, 0, 540, 1, 0, 0, 1 ]\n" + yaml_five,
        yaml_start + "camera_matrix:\n   data: [ nan, 0, 1, 0, 540, 1, 0, 0, 1 ]\n" + yaml_five,
        yaml_start + "camera_matrix:\n   data: [ -530, 0, 1, 0, 540, 1, 0, 0, 1 ]\n" + yaml_five,
        yaml_start + "camera_matrix:\n   data: [ 530, 3, 1, 0, 540, 1, 0, 0, 1 ]\n" + yaml_five,
        yaml_start + yaml_matrix + "D:\n   data: [ 1, 2, 3, 4, 5, 6 ]\n",
        yaml_start + yaml_matrix + "D:\n",
        "image_width: 0\nimage_height: 480\n" + yaml_matrix + yaml_five,
        "image_width:\nimage_height: 480\n" + yaml_matrix + yaml_five,
    };
    for (const std::string& text : broken) {
        SCOPED_TRACE(text);
        try {
            read_calibration(text);
            ADD_FAILURE() << "was taken for a calibration";
        } catch (const Error& error) {
            EXPECT_NE(std::string(error.what()).find("calibration.yml"), std::string::npos) << error.what();
        }
    }
    EXPECT_THROW(load_calibration("no/such/file.yml"), Error);
    try { // where it is
        read_calibration("%YAML:1.0\n---\nimage_width: 640\nimage_height: 0\n" + yaml_matrix + yaml_five);
        ADD_FAILURE();
    } catch (const Error& error) {
        EXPECT_NE(std::string(error.what()).find("calibration.yml:4: a picture without pixels"), std::string::npos)
            << error.what();
    }
}

// Whatever is cut off, it ends in a camera or an Error.
TEST(Calibration, TruncatedAnywhere)
{
    const std::string text = yaml_start + yaml_matrix + yaml_five;
    int errors = 0;
    for (std::size_t size = 0; size < text.size(); ++size) try {
            read_calibration(text.substr(0, size));
        } catch (const Error&) {
            ++errors;
        }
    EXPECT_GT(errors, static_cast<int>(text.size() * 3 / 4));
}

} // namespace
} // namespace snell
