#include "seeds.h"

#include <ImfChannelList.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfIO.h>
#include <ImfMultiPartOutputFile.h>
#include <ImfOutputFile.h>
#include <ImfOutputPart.h>
#include <ImfPartType.h>
#include <ImfRgbaFile.h>
#include <ImfStandardAttributes.h>
#include <ImfTiledRgbaFile.h>

namespace snell::hostile {

namespace {

constexpr int width = 10, height = 8; // even: chroma has half the resolution

class StringStream : public Imf::OStream
{
  public:
    explicit StringStream(std::string& bytes) : Imf::OStream("seed"), bytes_(bytes) {}

    void write(const char data[], int size) override
    {
        const auto n = static_cast<std::size_t>(size);
        if (bytes_.size() < at_ + n) bytes_.resize(at_ + n);
        bytes_.replace(at_, n, data, n);
        at_ += n;
    }
    std::uint64_t tellp() override { return at_; }
    void seekp(std::uint64_t position) override { at_ = position; }

  private:
    std::string& bytes_;
    std::size_t at_ = 0;
};

std::vector<Imf::Rgba> pixels()
{
    std::vector<Imf::Rgba> all;
    for (int i = 0; i < width * height; ++i)
        all.emplace_back(0.1f * static_cast<float>(i % width), 0.5f, static_cast<float>(i * 37 % 11), 1.0f);
    return all;
}

std::string scan_lines(Imf::Compression compression, Imf::RgbaChannels channels)
{
    std::string bytes;
    {
        StringStream stream(bytes);
        Imf::Header header(width, height, 1.0f, {0, 0}, 1.0f, Imf::INCREASING_Y, compression);
        if (compression == Imf::PIZ_COMPRESSION) {
            header.displayWindow().max = {width + 2, height}; // data and display differ
            Imf::addChromaticities(header, Imf::Chromaticities({0.7f, 0.3f}, {0.2f, 0.7f}, {0.1f, 0.1f}, {0.3f, 0.3f}));
        }
        const std::vector<Imf::Rgba> data = pixels();
        Imf::RgbaOutputFile out(stream, header, channels);
        out.setFrameBuffer(data.data(), 1, width);
        out.writePixels(height);
    }
    return bytes;
}

std::string tiles(Imf::LevelMode levels, Imf::Compression compression)
{
    std::string bytes;
    {
        StringStream stream(bytes);
        const std::vector<Imf::Rgba> data = pixels();
        Imf::Header header(width, height, 1.0f, {0, 0}, 1.0f, Imf::INCREASING_Y, compression);
        Imf::TiledRgbaOutputFile out(stream, header, Imf::WRITE_RGB, 4, 4, levels);
        out.setFrameBuffer(data.data(), 1, width);
        for (int ly = 0; ly < out.numYLevels(); ++ly)
            for (int lx = 0; lx < out.numXLevels(); ++lx)
                if (out.isValidLevel(lx, ly))
                    out.writeTiles(0, out.numXTiles(lx) - 1, 0, out.numYTiles(ly) - 1, lx, ly);
    }
    return bytes;
}

// Floats and unsigned integers, in two parts.
std::string parts()
{
    std::string bytes;
    {
        StringStream stream(bytes);
        std::vector<Imf::Header> headers(2, Imf::Header(width, height));
        for (std::size_t i = 0; i < 2; ++i) {
            headers[i].setName(i == 0 ? "ids" : "beauty");
            headers[i].setType(Imf::SCANLINEIMAGE);
            headers[i].compression() = i == 0 ? Imf::RLE_COMPRESSION : Imf::ZIPS_COMPRESSION;
        }
        headers[0].channels().insert("id", Imf::Channel(Imf::UINT));
        for (const char* name : {"layer.R", "layer.G", "layer.B"})
            headers[1].channels().insert(name, Imf::Channel(Imf::FLOAT));
        const std::vector<float> floats(static_cast<std::size_t>(width * height), 0.75f);
        Imf::MultiPartOutputFile out(stream, headers.data(), 2);
        for (int i = 0; i < 2; ++i) {
            Imf::FrameBuffer frame;
            for (auto c = headers[static_cast<std::size_t>(i)].channels().begin();
                 c != headers[static_cast<std::size_t>(i)].channels().end(); ++c)
                frame.insert(c.name(),
                             Imf::Slice(c.channel().type, reinterpret_cast<char*>(const_cast<float*>(floats.data())), 4,
                                        4 * width));
            Imf::OutputPart part(out, i);
            part.setFrameBuffer(frame);
            part.writePixels(height);
        }
    }
    return bytes;
}

} // namespace

std::vector<Seed> made_exr_seeds()
{
    std::vector<Seed> all;
    const char* const names[] = {"none", "rle", "zips", "zip", "piz", "pxr24", "b44", "b44a", "dwaa", "dwab"};
    for (int i = 0; i < Imf::NUM_COMPRESSION_METHODS; ++i)
        all.push_back(
            {names[i], scan_lines(static_cast<Imf::Compression>(i), i == 3 ? Imf::WRITE_RGBA : Imf::WRITE_RGB)});
    all.push_back({"luminance_chroma", scan_lines(Imf::ZIPS_COMPRESSION, Imf::WRITE_YC)});
    all.push_back({"tiles", tiles(Imf::ONE_LEVEL, Imf::ZIP_COMPRESSION)});
    all.push_back({"tiles_mipmap", tiles(Imf::MIPMAP_LEVELS, Imf::PIZ_COMPRESSION)});
    all.push_back({"tiles_ripmap", tiles(Imf::RIPMAP_LEVELS, Imf::RLE_COMPRESSION)});
    all.push_back({"parts", parts()});
    return all;
}

} // namespace snell::hostile
