// EXR files: what we write, OpenEXR itself reads back; what OpenEXR writes in all its kinds, we read.
#include "snell/io/image/read.h"
#include "snell/io/image/write.h"

#include "image_helpers.h"

#include <ImfChannelList.h>
#include <ImfFloatAttribute.h>
#include <ImfFrameBuffer.h>
#include <ImfInputFile.h>
#include <ImfMultiPartOutputFile.h>
#include <ImfOutputFile.h>
#include <ImfOutputPart.h>
#include <ImfPartType.h>
#include <ImfRgbaFile.h>
#include <ImfStandardAttributes.h>
#include <ImfStringAttribute.h>
#include <ImfTiledOutputFile.h>
#include <ImfTiledRgbaFile.h>

#include <sys/resource.h>

#include <bit>
#include <cmath>
#include <csignal>
#include <cstring>
#include <numeric>

namespace snell {

namespace {

template <class T>
std::vector<T> read_channel(Imf::InputFile& in, const char* name, Imf::PixelType type)
{
    Imath::Box2i window = in.header().dataWindow();
    std::size_t width = static_cast<std::size_t>(window.max.x - window.min.x + 1);
    std::vector<T> values(width * static_cast<std::size_t>(window.max.y - window.min.y + 1));
    Imf::FrameBuffer frame;
    frame.insert(name, Imf::Slice::Make(type, values.data(), window, 4, 4 * width));
    in.setFrameBuffer(frame);
    in.readPixels(window.min.y, window.max.y);
    return values;
}

// A float file of the named channels, channel c of pixel i being 100 c + i.
std::vector<std::vector<float>> write_channels(const fs::path& file, const std::vector<std::string>& names,
                                               Imf::Header header)
{
    Imath::Box2i window = header.dataWindow();
    std::size_t width = static_cast<std::size_t>(window.max.x - window.min.x + 1);
    std::size_t count = width * static_cast<std::size_t>(window.max.y - window.min.y + 1);
    std::vector<std::vector<float>> data;
    Imf::FrameBuffer frame;
    for (const std::string& name : names) {
        data.emplace_back(count);
        std::iota(data.back().begin(), data.back().end(), 100.0f * static_cast<float>(data.size() - 1));
        header.channels().insert(name, Imf::Channel(Imf::FLOAT));
    }
    for (std::size_t c = 0; c < names.size(); ++c)
        frame.insert(names[c], Imf::Slice::Make(Imf::FLOAT, data[c].data(), window, 4, 4 * width));
    if (header.hasTileDescription()) {
        Imf::TiledOutputFile out(file.c_str(), header);
        out.setFrameBuffer(frame);
        out.writeTiles(0, out.numXTiles() - 1, 0, out.numYTiles() - 1);
    } else {
        Imf::OutputFile out(file.c_str(), header);
        out.setFrameBuffer(frame);
        out.writePixels(window.max.y - window.min.y + 1);
    }
    return data;
}

Imf::Header header_of(Imath::Box2i display, Imath::Box2i data)
{
    return Imf::Header(display, data);
}

Imath::Box2i box(int left, int top, int right, int bottom)
{
    return {{left, top}, {right, bottom}};
}

} // namespace

TEST(Exr, layers_ids_and_attributes_are_exact)
{
    TemporaryFolder folder;
    int width = 37, height = 19;
    std::size_t count = 37 * 19;
    Picture picture = test_picture(width, height);
    picture.at(5, 5) = vec3(NAN, infinity(), -0.0f);
    picture.at(6, 5) = vec3(1e-42f, -infinity(), 3e38f);
    Layers layers;
    layers.channels.push_back({"Albedo.R", std::vector<float>(count), {}});
    layers.channels.push_back({"ObjectID.I", {}, std::vector<std::uint32_t>(count)});
    layers.channels.push_back({"Z", std::vector<float>(count), {}});
    for (std::size_t i = 0; i < count; ++i) {
        layers.channels[0].floats[i] = 0.1f * static_cast<float>(i);
        layers.channels[1].ids[i] = 0xffffffffu - static_cast<std::uint32_t>(i * 7919);
        layers.channels[2].floats[i] = i % 3 == 0 ? infinity() : std::sqrt(static_cast<float>(i));
        layers.alpha.push_back(static_cast<float>(i) / static_cast<float>(count));
    }
    layers.attributes = {{"version", "snell 0.1"}, {"commandLine", "render --spp 4 \xc3\xa4.obj"}, {"empty", ""}};
    layers.numbers = {{"spp", 64.0}, {"seconds", 1.25}};
    for (int i = 0; i < 16; ++i) {
        layers.world_to_camera.push_back(static_cast<float>(i) + 0.5f);
        layers.world_to_ndc.push_back(static_cast<float>(-i));
    }
    write_picture(folder / "a.EXR", picture, layers);

    Imf::InputFile in((folder / "a.EXR").c_str());
    const Imf::Header& header = in.header();
    EXPECT_EQ(header.compression(), Imf::ZIP_COMPRESSION);
    EXPECT_EQ(header.dataWindow(), box(0, 0, 36, 18));
    EXPECT_EQ(header.displayWindow(), box(0, 0, 36, 18));
    EXPECT_TRUE(Imf::hasChromaticities(header));
    EXPECT_TRUE(Imf::chromaticities(header) == Imf::Chromaticities());
    EXPECT_EQ(header.typedAttribute<Imf::StringAttribute>("version").value(), "snell 0.1");
    EXPECT_EQ(header.typedAttribute<Imf::StringAttribute>("commandLine").value(), "render --spp 4 \xc3\xa4.obj");
    EXPECT_EQ(header.typedAttribute<Imf::StringAttribute>("empty").value(), "");
    EXPECT_EQ(header.typedAttribute<Imf::FloatAttribute>("spp").value(), 64.0f);
    EXPECT_EQ(header.typedAttribute<Imf::FloatAttribute>("seconds").value(), 1.25f);
    EXPECT_EQ(Imf::worldToCamera(header)[0][1], 1.5f);
    EXPECT_EQ(Imf::worldToCamera(header)[3][0], 12.5f);
    EXPECT_EQ(Imf::worldToNDC(header)[1][2], -6.0f);
    std::string names;
    for (auto c = header.channels().begin(); c != header.channels().end(); ++c) {
        names += std::string(c.name()) + " ";
        EXPECT_EQ(c.channel().type, std::string(c.name()) == "ObjectID.I" ? Imf::UINT : Imf::FLOAT);
    }
    EXPECT_EQ(names, "A Albedo.R B G ObjectID.I R Z ");

    const char* rgb[] = {"R", "G", "B"};
    for (int c = 0; c < 3; ++c) {
        std::vector<float> values = read_channel<float>(in, rgb[c], Imf::FLOAT);
        for (std::size_t i = 0; i < count; ++i)
            ASSERT_EQ(std::bit_cast<std::uint32_t>(values[i]), std::bit_cast<std::uint32_t>(picture.pixels[i][c]));
    }
    EXPECT_EQ(read_channel<float>(in, "A", Imf::FLOAT), layers.alpha);
    EXPECT_EQ(read_channel<float>(in, "Albedo.R", Imf::FLOAT), layers.channels[0].floats);
    EXPECT_EQ(read_channel<float>(in, "Z", Imf::FLOAT), layers.channels[2].floats);
    EXPECT_EQ(read_channel<std::uint32_t>(in, "ObjectID.I", Imf::UINT), layers.channels[1].ids);

    Picture back = read_picture(folder / "a.EXR");
    ASSERT_EQ(back.width, width);
    ASSERT_EQ(back.height, height);
    EXPECT_EQ(std::memcmp(back.pixels.data(), picture.pixels.data(), count * sizeof(vec3)), 0);
    EXPECT_EQ(folder.entries(), 1u);
}

TEST(Exr, alpha_is_one_unless_given)
{
    TemporaryFolder folder;
    write_picture(folder / "a.exr", test_picture(20, 40));
    Imf::InputFile in((folder / "a.exr").c_str());
    EXPECT_EQ(read_channel<float>(in, "A", Imf::FLOAT), std::vector<float>(800, 1.0f));
}

TEST(Exr, failed_write_leaves_the_old_file_and_nothing_else)
{
    TemporaryFolder folder;
    put(folder / "a.exr", "old");
    Layers layers;
    layers.attributes = {{"compression", "taken by OpenEXR"}};
    std::string message = error_of([&] { write_picture(folder / "a.exr", test_picture(9, 9), layers); });
    EXPECT_TRUE(contains(message, "writing the EXR file failed")) << message;
    // As on a full disk.
    auto handler = std::signal(SIGXFSZ, SIG_IGN);
    rlimit before = {};
    ASSERT_EQ(getrlimit(RLIMIT_FSIZE, &before), 0);
    for (rlim_t limit : {rlim_t(100), rlim_t(20000)}) {
        rlimit small = before;
        small.rlim_cur = limit;
        ASSERT_EQ(setrlimit(RLIMIT_FSIZE, &small), 0);
        message = error_of([&] { write_picture(folder / "a.exr", test_picture(100, 100)); });
        ASSERT_EQ(setrlimit(RLIMIT_FSIZE, &before), 0);
        EXPECT_TRUE(contains(message, "writing the EXR file failed")) << message;
    }
    std::signal(SIGXFSZ, handler);
    EXPECT_EQ(get(folder / "a.exr"), "old");
    EXPECT_EQ(folder.entries(), 1u);
}

TEST(Exr, display_window_is_the_picture)
{
    TemporaryFolder folder;
    // Data reaches over the left and lower borders, and leaves the right and the top empty.
    write_channels(folder / "a.exr", {"R", "G", "B"}, header_of(box(10, 20, 13, 22), box(8, 21, 11, 24)));
    Picture picture = read_picture(folder / "a.exr");
    ASSERT_EQ(picture.width, 4);
    ASSERT_EQ(picture.height, 3);
    EXPECT_EQ(picture.at(0, 0), vec3(0.0f));
    EXPECT_EQ(picture.at(0, 1), vec3(2.0f, 102.0f, 202.0f));
    EXPECT_EQ(picture.at(1, 1), vec3(3.0f, 103.0f, 203.0f));
    EXPECT_EQ(picture.at(2, 1), vec3(0.0f));
    EXPECT_EQ(picture.at(1, 2), vec3(7.0f, 107.0f, 207.0f));
    write_channels(folder / "b.exr", {"R", "G", "B"}, header_of(box(0, 0, 1, 0), box(5, 5, 6, 6)));
    EXPECT_EQ(read_picture(folder / "b.exr").pixels, (std::vector<vec3>{vec3(0.0f), vec3(0.0f)}));
}

TEST(Exr, negative_windows_compressions_and_tiles)
{
    TemporaryFolder folder;
    for (Imf::Compression compression : {Imf::NO_COMPRESSION, Imf::RLE_COMPRESSION, Imf::ZIPS_COMPRESSION,
                                         Imf::ZIP_COMPRESSION, Imf::PIZ_COMPRESSION}) {
        for (bool is_tiled : {false, true}) {
            Imf::Header header = header_of(box(-70, -5, -1, 44), box(-70, -5, -1, 44));
            header.compression() = compression;
            if (is_tiled) header.setTileDescription(Imf::TileDescription(32, 16));
            auto data = write_channels(folder / "a.exr", {"R", "G", "B", "A"}, header);
            Picture picture = read_picture(folder / "a.exr");
            ASSERT_EQ(picture.width, 70);
            ASSERT_EQ(picture.height, 50);
            for (std::size_t i = 0; i < 3500; ++i) {
                for (std::size_t c = 0; c < 3; ++c) ASSERT_EQ(picture.pixels[i][static_cast<int>(c)], data[c][i]);
            }
            EXPECT_EQ(read_texture(folder / "a.exr", true).floats[4 * 1234 + 3], data[3][1234]);
        }
    }
}

TEST(Exr, grey_layers_and_single_channels)
{
    TemporaryFolder folder;
    Imf::Header header(3, 2);
    write_channels(folder / "y.exr", {"Y"}, header);
    EXPECT_EQ(read_picture(folder / "y.exr").at(2, 1), vec3(5.0f));
    write_channels(folder / "z.exr", {"depth.Z"}, header);
    EXPECT_EQ(read_picture(folder / "z.exr").at(1, 1), vec3(4.0f));
    write_channels(folder / "layer.exr", {"View.Combined.R", "View.Combined.G", "View.Combined.B", "Depth.Z"}, header);
    EXPECT_EQ(read_picture(folder / "layer.exr").at(1, 0), vec3(1.0f, 101.0f, 201.0f));
    write_channels(folder / "rg.exr", {"R", "G"}, header);
    EXPECT_EQ(read_picture(folder / "rg.exr").at(1, 0), vec3(1.0f, 101.0f, 0.0f));
    Image image = read_texture(folder / "y.exr", true);
    EXPECT_EQ(image.floats[0 + 4], 1.0f);
    EXPECT_EQ(image.floats[3 + 4], 1.0f); // no alpha: opaque
    write_channels(folder / "none.exr", {"U", "V"}, header);
    EXPECT_TRUE(contains(error_of([&] { read_picture(folder / "none.exr"); }), "no colour; its channels are: U V"));
}

TEST(Exr, unsigned_channels)
{
    TemporaryFolder folder;
    std::vector<std::uint32_t> ids = {0, 1, 70000, 16777216};
    Imf::Header header(4, 1);
    header.channels().insert("R", Imf::Channel(Imf::UINT));
    Imf::FrameBuffer frame;
    frame.insert("R", Imf::Slice(Imf::UINT, reinterpret_cast<char*>(ids.data()), 4, 16));
    {
        Imf::OutputFile out((folder / "a.exr").c_str(), header);
        out.setFrameBuffer(frame);
        out.writePixels(1);
    }
    Picture picture = read_picture(folder / "a.exr");
    for (std::size_t i = 0; i < 4; ++i) EXPECT_EQ(picture.pixels[i], vec3(static_cast<float>(ids[i]), 0.0f, 0.0f));
}

TEST(Exr, half_and_luminance_chroma)
{
    TemporaryFolder folder;
    std::vector<Imf::Rgba> pixels;
    for (int y = 0; y < 32; ++y) {
        for (int x = 0; x < 64; ++x)
            pixels.emplace_back(0.5f + 0.005f * static_cast<float>(x), 0.4f, 0.3f + 0.01f * static_cast<float>(y),
                                0.5f);
    }
    for (Imf::RgbaChannels channels : {Imf::WRITE_RGBA, Imf::WRITE_YCA, Imf::WRITE_YC, Imf::WRITE_Y}) {
        Imath::Box2i window = box(-4, 6, 59, 37); // chroma wants even corners
        {
            Imf::RgbaOutputFile out((folder / "a.exr").c_str(), window, window, channels);
            out.setFrameBuffer(pixels.data() + 4 - 6 * 64, 1, 64);
            out.writePixels(32);
        }
        Image image = read_texture(folder / "a.exr", true);
        ASSERT_EQ(image.width, 64u);
        ASSERT_EQ(image.height, 32u);
        bool has_alpha = channels & Imf::WRITE_A, is_grey = channels == Imf::WRITE_Y;
        float tolerance = channels == Imf::WRITE_RGBA ? 0.0f : 0.02f; // chroma is filtered, and rounded to 5 bits
        for (std::size_t i = 0; i < pixels.size(); ++i) {
            vec3 expected(pixels[i].r, pixels[i].g, pixels[i].b);
            if (is_grey) expected = vec3(0.2126f * expected.x + 0.7152f * expected.y + 0.0722f * expected.z);
            for (int c = 0; c < 3; ++c)
                ASSERT_NEAR(image.floats[4 * i + static_cast<std::size_t>(c)], expected[c], tolerance) << channels;
            ASSERT_EQ(image.floats[4 * i + 3], has_alpha ? 0.5f : 1.0f);
        }
    }
}

TEST(Exr, other_primaries_are_converted_for_colour_only)
{
    TemporaryFolder folder;
    // ACES AP0 with its own white; white must stay white, and its green is far outside of Rec.709.
    Imf::Chromaticities ap0({0.7347f, 0.2653f}, {0.0f, 1.0f}, {0.0001f, -0.077f}, {0.32168f, 0.33767f});
    Imf::Rgba pixels[] = {{1, 1, 1}, {0, 1, 0}, {0.25f, 0.25f, 0.25f}};
    {
        Imf::Header header(3, 1);
        Imf::addChromaticities(header, ap0);
        Imf::RgbaOutputFile out((folder / "a.exr").c_str(), header, Imf::WRITE_RGB);
        out.setFrameBuffer(pixels, 1, 3);
        out.writePixels(1);
    }
    Picture picture = read_picture(folder / "a.exr");
    // The matrix of the ACES documents: AP0 to linear sRGB with Bradford adaptation, second column.
    vec3 expected[] = {vec3(1.0f), vec3(-1.134f, 1.3757f, -0.1522f), vec3(0.25f)};
    for (int x = 0; x < 3; ++x) {
        for (int c = 0; c < 3; ++c) EXPECT_NEAR(picture.at(x, 0)[c], expected[x][c], 0.01f) << x << c;
    }
    EXPECT_EQ(read_texture(folder / "a.exr", false).floats[4], 0.0f);
    EXPECT_EQ(read_texture(folder / "a.exr", false).floats[5], 1.0f);
}

TEST(Exr, first_part_of_colour_counts)
{
    TemporaryFolder folder;
    std::vector<Imf::Header> headers(3, Imf::Header(2, 1));
    const char* names[] = {"notes", "left", "right"};
    const char* first[] = {"U", "R", "R"};
    const char* second[] = {"V", "G", "G"};
    for (std::size_t i = 0; i < 3; ++i) {
        headers[i].setName(names[i]);
        headers[i].setType(Imf::SCANLINEIMAGE);
        headers[i].channels().insert(first[i], Imf::Channel(Imf::FLOAT));
        headers[i].channels().insert(second[i], Imf::Channel(Imf::FLOAT));
    }
    {
        Imf::MultiPartOutputFile out((folder / "a.exr").c_str(), headers.data(), 3);
        for (int i = 0; i < 3; ++i) {
            float values[] = {10.0f * static_cast<float>(i), 10.0f * static_cast<float>(i) + 1.0f};
            Imf::FrameBuffer frame;
            for (const char* name : {first[i], second[i]})
                frame.insert(name, Imf::Slice(Imf::FLOAT, reinterpret_cast<char*>(values), 4, 8));
            Imf::OutputPart part(out, i);
            part.setFrameBuffer(frame);
            part.writePixels(1);
        }
    }
    Picture picture = read_picture(folder / "a.exr");
    EXPECT_EQ(picture.at(0, 0), vec3(10.0f, 10.0f, 0.0f));
    EXPECT_EQ(picture.at(1, 0), vec3(11.0f, 11.0f, 0.0f));
}

TEST(Exr, mipmaps_give_their_finest_level)
{
    TemporaryFolder folder;
    std::vector<Imf::Rgba> pixels(64 * 32, Imf::Rgba(1, 2, 3));
    {
        Imf::TiledRgbaOutputFile out((folder / "a.exr").c_str(), 64, 32, 16, 16, Imf::MIPMAP_LEVELS, Imf::ROUND_DOWN,
                                     Imf::WRITE_RGB);
        for (int level = 0; level < out.numLevels(); ++level) {
            out.setFrameBuffer(pixels.data(), 1, 64);
            out.writeTiles(0, out.numXTiles(level) - 1, 0, out.numYTiles(level) - 1, level);
        }
    }
    Picture picture = read_picture(folder / "a.exr");
    EXPECT_EQ(picture.width, 64);
    EXPECT_EQ(picture.height, 32);
    EXPECT_EQ(picture.at(63, 31), vec3(1, 2, 3));
}

} // namespace snell
