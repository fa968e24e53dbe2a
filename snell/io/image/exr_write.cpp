#include "snell/core/error.h"
#include "snell/core/parallel.h"
#include "snell/io/file.h"
#include "snell/io/image/codec.h"

#include <ImfChannelList.h>
#include <ImfFloatAttribute.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfIO.h>
#include <ImfOutputFile.h>
#include <ImfStandardAttributes.h>
#include <ImfStringAttribute.h>
#include <ImfThreading.h>

#include <algorithm>
#include <fstream>

namespace fs = std::filesystem;

namespace snell {

namespace {

// OpenEXR's own stream says nothing of what fails when the file is closed; this one is asked.
class FileStream : public Imf::OStream
{
  public:
    explicit FileStream(const fs::path& file) : Imf::OStream(file.c_str()), out_(file, std::ios::binary) { check(); }

    void write(const char bytes[], int count) override
    {
        out_.write(bytes, count);
        check();
    }
    uint64_t tellp() override { return static_cast<uint64_t>(std::streamoff(out_.tellp())); }
    void seekp(uint64_t position) override
    {
        out_.seekp(static_cast<std::streamoff>(position));
        check();
    }
    void close()
    {
        out_.close();
        check();
    }

  private:
    void check() const
    {
        if (!out_) throw std::runtime_error("the disk takes no more");
    }

    std::ofstream out_;
};

void set_matrix(const std::vector<float>& values, Imf::Header& header, void (*add)(Imf::Header&, const Imath::M44f&))
{
    if (values.empty()) return;
    SNELL_CHECK_EQ(values.size(), std::size_t(16));
    Imath::M44f m;
    std::copy(values.begin(), values.end(), &m[0][0]);
    add(header, m);
}

Imf::Header make_header(const Picture& picture, const Layers& layers)
{
    Imf::Header header(picture.width, picture.height);
    header.compression() = Imf::ZIP_COMPRESSION;
    header.zipCompressionLevel() = 4;                      // about half the time of the default's 6, at the same size
    Imf::addChromaticities(header, Imf::Chromaticities()); // Rec.709, D65
    for (const auto& [name, value] : layers.attributes) header.insert(name, Imf::StringAttribute(value));
    for (const auto& [name, value] : layers.numbers)
        header.insert(name, Imf::FloatAttribute(static_cast<float>(value)));
    if (!layers.views.empty()) Imf::addMultiView(header, layers.views);
    set_matrix(layers.world_to_camera, header, Imf::addWorldToCamera);
    set_matrix(layers.world_to_ndc, header, Imf::addWorldToNDC);
    return header;
}

// Threads for compression.
int exr_thread_count()
{
#ifdef __SANITIZE_THREAD__
    return 0; // the packaged library's atomics are not instrumented: its tasks look like races
#else
    return thread_count();
#endif
}

} // namespace

void write_exr(const fs::path& file, const Picture& picture, const Layers& layers)
{
    std::size_t width = static_cast<std::size_t>(picture.width), height = static_cast<std::size_t>(picture.height);
    std::vector<float> opaque;
    if (layers.alpha.empty())
        opaque.assign(width, 1.0f);
    else
        SNELL_CHECK_EQ(layers.alpha.size(), width * height);

    write_atomically(file, [&](const fs::path& temporary) {
        try {
            Imf::Header header = make_header(picture, layers);
            Imf::FrameBuffer frame;
            // OpenEXR only reads from these, whatever the type of the pointer.
            auto insert = [&](const std::string& name, Imf::PixelType type, const void* data, std::size_t x_stride,
                              std::size_t y_stride) {
                SNELL_CHECK_EQ(header.channels().findChannel(name.c_str()) == nullptr, true); // a name given twice
                header.channels().insert(name, Imf::Channel(type));
                frame.insert(name, Imf::Slice(type, static_cast<char*>(const_cast<void*>(data)), x_stride, y_stride));
            };
            const char* rgb[] = {"R", "G", "B"};
            for (std::size_t c = 0; c < 3; ++c)
                insert(rgb[c], Imf::FLOAT, reinterpret_cast<const float*>(picture.pixels.data()) + c, sizeof(vec3),
                       sizeof(vec3) * width);
            if (layers.alpha.empty())
                insert("A", Imf::FLOAT, opaque.data(), sizeof(float), 0); // one row serves all
            else
                insert("A", Imf::FLOAT, layers.alpha.data(), sizeof(float), sizeof(float) * width);
            for (const Channel& channel : layers.channels) {
                bool is_float = !channel.floats.empty();
                SNELL_CHECK_EQ(is_float ? channel.floats.size() : channel.ids.size(), width * height);
                const void* data = is_float ? static_cast<const void*>(channel.floats.data()) : channel.ids.data();
                insert(channel.name, is_float ? Imf::FLOAT : Imf::UINT, data, 4, 4 * width);
            }

            int threads = exr_thread_count();
            if (Imf::globalThreadCount() == 0) Imf::setGlobalThreadCount(threads);
            FileStream stream(temporary);
            {
                Imf::OutputFile out(stream, header, threads);
                out.setFrameBuffer(frame);
                out.writePixels(picture.height);
            }
            stream.close(); // the destructor above writes too, and keeps its errors to itself
        } catch (const std::exception& e) {
            throw Error({file.string()}, fmt::format("writing the EXR file failed: {}", e.what()),
                        "check the disk's free space, and the names of the attributes");
        }
    });
}

} // namespace snell
