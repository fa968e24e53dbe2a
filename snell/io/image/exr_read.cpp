#include "snell/core/error.h"
#include "snell/io/image/codec.h"
#include "snell/io/image/exr_check.h"

#include <ImfChannelList.h>
#include <ImfChromaticities.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfIO.h>
#include <ImfInputPart.h>
#include <ImfMultiPartInputFile.h>
#include <ImfPartType.h>
#include <ImfRgba.h>
#include <ImfRgbaFile.h>
#include <ImfStandardAttributes.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <optional>

namespace fs = std::filesystem;

namespace snell {

namespace {

class MemoryStream : public Imf::IStream
{
  public:
    MemoryStream(const fs::path& file, std::string_view bytes) : Imf::IStream(file.c_str()), bytes_(bytes) {}

    bool read(char out[], int count) override
    {
        auto n = static_cast<std::size_t>(count);
        if (count < 0 || at_ > bytes_.size() || n > bytes_.size() - at_)
            throw std::runtime_error("the file is cut off");
        std::memcpy(out, bytes_.data() + at_, n);
        at_ += n;
        return at_ < bytes_.size();
    }
    uint64_t tellg() override { return at_; }
    void seekg(uint64_t position) override { at_ = position; }

  private:
    std::string_view bytes_;
    std::size_t at_ = 0;
};

// The channels that become R, G, B, A; an empty name is a channel that the file lacks.
struct Selection
{
    std::array<std::string, 4> names;
    bool is_luminance_chroma = false;
};

bool has(const Imf::ChannelList& channels, const std::string& name)
{
    return channels.findChannel(name.c_str()) != nullptr;
}

std::optional<Selection> select_channels(const Imf::ChannelList& channels)
{
    auto if_there = [&](const std::string& name) { return has(channels, name) ? name : std::string(); };
    if (has(channels, "R") || has(channels, "G") || has(channels, "B"))
        return Selection{{if_there("R"), if_there("G"), if_there("B"), if_there("A")}};
    if (has(channels, "Y")) {
        bool is_luminance_chroma = has(channels, "RY") && has(channels, "BY");
        return Selection{{"Y", "Y", "Y", if_there("A")}, is_luminance_chroma};
    }
    // A single layer of colour, or a single channel of whatever kind, is what is meant.
    std::vector<std::string> layers;
    int count = 0;
    std::string only;
    for (auto c = channels.begin(); c != channels.end(); ++c, ++count) {
        only = c.name();
        if (!only.ends_with(".R")) continue;
        std::string layer = only.substr(0, only.size() - 1);
        if (has(channels, layer + "G") && has(channels, layer + "B")) layers.push_back(layer);
    }
    if (layers.size() == 1)
        return Selection{{layers[0] + "R", layers[0] + "G", layers[0] + "B", if_there(layers[0] + "A")}};
    if (count == 1) return Selection{{only, only, only, ""}};
    return std::nullopt;
}

std::size_t width_of(const Imath::Box2i& box)
{
    return static_cast<std::size_t>(box.max.x - box.min.x + 1);
}
std::size_t height_of(const Imath::Box2i& box)
{
    return static_cast<std::size_t>(box.max.y - box.min.y + 1);
}

// Fills RGBA of the data window.
void read_channels(Imf::InputPart& part, const Selection& selection, std::vector<float>& rgba)
{
    const Imath::Box2i& window = part.header().dataWindow();
    Imf::FrameBuffer frame;
    // A channel that serves several outputs (grey) is read into the first and copied.
    std::array<std::size_t, 4> source = {0, 1, 2, 3};
    for (std::size_t c = 0; c < 4; ++c) {
        const std::string& name = selection.names[c];
        for (std::size_t before = c; before-- > 0 && !name.empty();) {
            if (selection.names[before] == name) source[c] = before;
        }
        if (name.empty() || source[c] != c) continue;
        frame.insert(name, Imf::Slice::Make(Imf::FLOAT, &rgba[c], window, 4 * sizeof(float),
                                            4 * sizeof(float) * width_of(window)));
    }
    part.setFrameBuffer(frame);
    part.readPixels(window.min.y, window.max.y);
    for (std::size_t i = 0; i < rgba.size(); i += 4) {
        for (std::size_t c = 1; c < 4; ++c) rgba[i + c] = rgba[i + source[c]];
    }
}

// Luminance and subsampled chroma; OpenEXR reconstructs them in half precision.
void read_luminance_chroma(Imf::IStream& stream, std::vector<float>& rgba)
{
    stream.seekg(0);
    Imf::RgbaInputFile input(stream, 0);
    const Imath::Box2i& window = input.dataWindow();
    std::size_t width = width_of(window);
    std::vector<Imf::Rgba> row(width);
    for (int y = window.min.y; y <= window.max.y; ++y) {
        auto offset = reinterpret_cast<std::uintptr_t>(row.data()) -
                      static_cast<std::uintptr_t>(static_cast<std::intptr_t>(window.min.x)) * sizeof(Imf::Rgba);
        input.setFrameBuffer(reinterpret_cast<Imf::Rgba*>(offset), 1, 0);
        input.readPixels(y);
        float* out = &rgba[static_cast<std::size_t>(y - window.min.y) * width * 4];
        for (const Imf::Rgba& p : row) {
            for (Imath::half v : {p.r, p.g, p.b, p.a}) *out++ = v;
        }
    }
}

// Converts to Rec.709 if the header names other primaries; a different white is adapted (Bradford), so that white
// stays white.
void convert_primaries(const Imf::Header& header, std::vector<float>& rgba)
{
    if (!Imf::hasChromaticities(header)) return;
    const Imf::Chromaticities& from = Imf::chromaticities(header);
    const Imf::Chromaticities to; // Rec.709, D65
    const Imath::V2f* given[] = {&from.red, &from.green, &from.blue, &from.white};
    const Imath::V2f* wanted[] = {&to.red, &to.green, &to.blue, &to.white};
    bool is_same = true, is_usable = true;
    for (int i = 0; i < 4; ++i) {
        is_same = is_same && given[i]->equalWithAbsError(*wanted[i], 1e-3f);
        is_usable = is_usable && std::abs(given[i]->x) < 10.0f && std::abs(given[i]->y) < 10.0f;
    }
    if (is_same || !is_usable || from.white.y < 0.01f) return;

    // Row vectors times matrices, as everywhere in Imath.
    const Imath::M44f cone(0.8951f, -0.7502f, 0.0389f, 0, 0.2664f, 1.7135f, -0.0685f, 0, -0.1614f, 0.0367f, 1.0296f, 0,
                           0, 0, 0, 1);
    auto cone_response = [&](const Imath::V2f& white) {
        return Imath::V3f(white.x / white.y, 1.0f, (1.0f - white.x - white.y) / white.y) * cone;
    };
    Imath::V3f response = cone_response(from.white);
    if (std::abs(response.x) < 1e-3f || std::abs(response.y) < 1e-3f || std::abs(response.z) < 1e-3f) return;
    Imath::M44f scale;
    scale.setScale(cone_response(to.white) / response);
    Imath::M44f m = Imf::RGBtoXYZ(from, 1.0f) * cone * scale * cone.inverse() * Imf::XYZtoRGB(to, 1.0f);
    for (int i = 0; i < 3; ++i) {
        for (int j = 0; j < 3; ++j) {
            if (!std::isfinite(m[i][j])) return; // primaries without area
        }
    }
    for (std::size_t i = 0; i < rgba.size(); i += 4) {
        Imath::V3f c = Imath::V3f(rgba[i], rgba[i + 1], rgba[i + 2]) * m;
        rgba[i] = c.x, rgba[i + 1] = c.y, rgba[i + 2] = c.z;
    }
}

// The picture is the display window: data outside of it is cut, what has no data is black and transparent.
Raster place_in_window(std::vector<float>&& rgba, const Imath::Box2i& data, const Imath::Box2i& display)
{
    Raster raster;
    raster.width = static_cast<int>(width_of(display));
    raster.height = static_cast<int>(height_of(display));
    if (data == display) {
        raster.floats = std::move(rgba);
        return raster;
    }
    raster.floats.resize(width_of(display) * height_of(display) * 4);
    int left = std::max(data.min.x, display.min.x), right = std::min(data.max.x, display.max.x);
    int top = std::max(data.min.y, display.min.y), bottom = std::min(data.max.y, display.max.y);
    if (left > right) return raster;
    for (int y = top; y <= bottom; ++y) {
        auto index = [&](const Imath::Box2i& box) {
            return 4 * (static_cast<std::size_t>(y - box.min.y) * width_of(box) +
                        static_cast<std::size_t>(left - box.min.x));
        };
        std::copy_n(&rgba[index(data)], 4 * static_cast<std::size_t>(right - left + 1), &raster.floats[index(display)]);
    }
    return raster;
}

Raster read_exr(const fs::path& file, std::string_view bytes, bool is_color)
{
    MemoryStream stream(file, bytes);
    std::vector<float> rgba;
    auto allocate = [&](const Imf::Header& header) {
        rgba.resize(width_of(header.dataWindow()) * height_of(header.dataWindow()) * 4);
        for (std::size_t i = 3; i < rgba.size(); i += 4) rgba[i] = 1.0f;
    };

    Imf::MultiPartInputFile input(stream);
    std::string all_names;
    for (int i = 0; i < input.parts(); ++i) {
        Imf::Header header = input.header(i);
        bool is_flat = !header.hasType() || header.type() == Imf::SCANLINEIMAGE || header.type() == Imf::TILEDIMAGE;
        if (!is_flat) continue;
        std::optional<Selection> selection = select_channels(header.channels());
        for (auto c = header.channels().begin(); c != header.channels().end(); ++c)
            all_names.append(all_names.empty() ? "" : " ").append(c.name());
        if (!selection) continue;

        allocate(header);
        if (selection->is_luminance_chroma && input.parts() > 1)
            throw Error({file.string()}, "luminance and chroma in a file of several parts are not supported",
                        "save the picture as RGB");
        if (selection->is_luminance_chroma) {
            read_luminance_chroma(stream, rgba);
        } else {
            Imf::InputPart part(input, i);
            read_channels(part, *selection, rgba);
        }
        if (is_color) convert_primaries(header, rgba);
        return place_in_window(std::move(rgba), header.dataWindow(), header.displayWindow());
    }
    if (all_names.size() > 300) all_names = all_names.substr(0, 300) + " ...";
    throw Error({file.string()}, fmt::format("the EXR file has no colour; its channels are: {}", all_names),
                "save it with channels R, G, B or Y");
}

} // namespace

Raster decode_exr(const fs::path& file, std::string_view bytes, bool is_color)
{
    check_exr_headers(file, bytes);
    try {
        return read_exr(file, bytes, is_color);
    } catch (const Error&) {
        throw;
    } catch (const std::bad_alloc&) {
        throw;
    } catch (const std::exception& e) {
        throw Error({file.string()}, fmt::format("not a good EXR file: {}", e.what()), "write the file again");
    }
}

} // namespace snell
