#include "snell/io/image/exr_check.h"

#include "snell/core/error.h"
#include "snell/io/image/codec.h"

#include <algorithm>
#include <cstring>
#include <optional>
#include <utility>

namespace fs = std::filesystem;

namespace snell {

namespace {

struct Window
{
    std::int64_t left = 0, top = 0, right = -1, bottom = -1; // inclusive
    std::int64_t width() const { return right - left + 1; }
    std::int64_t height() const { return bottom - top + 1; }
};

struct Part
{
    std::optional<Window> data_window, display_window;
    std::optional<std::uint32_t> compression;
    std::uint64_t texel_bytes = 0; // of all channels, as if none were subsampled
    std::uint64_t least_bits = 0;  // of a texel with subsampling
    std::uint64_t tile_width = 0, tile_height = 0;
};

class ExrHeaders
{
  public:
    ExrHeaders(const fs::path& file, std::string_view bytes) : file_(file), bytes_(bytes) {}

    void check()
    {
        std::uint32_t magic = number(), version = number();
        if (magic != 20000630u || (version & 0xff) != 2) fail("not an EXR file of version 2");
        if (version & 0x800)
            throw Error({file_.string()}, "EXR files with deep pixels are not supported", "flatten the picture first");
        bool is_multipart = version & 0x1000;
        do {
            check_part(header());
            if (is_multipart && at_ < bytes_.size() && bytes_[at_] == '\0') break; // an empty header ends the list
        } while (is_multipart);
    }

  private:
    [[noreturn]] void fail(const std::string& message) const
    {
        throw Error({file_.string()}, message, "write the file again");
    }

    std::string_view take(std::size_t count)
    {
        if (count > bytes_.size() - at_) fail("the EXR header is cut off");
        std::string_view taken = bytes_.substr(at_, count);
        at_ += count;
        return taken;
    }

    // Little-endian; from the header, or from an attribute's value.
    static std::uint32_t number(std::string_view value, std::size_t at)
    {
        std::uint32_t n = 0;
        for (std::size_t i = 0; i < 4; ++i) n |= std::uint32_t(static_cast<std::uint8_t>(value[at + i])) << (8 * i);
        return n;
    }
    std::uint32_t number() { return number(take(4), 0); }

    std::string_view text()
    {
        std::size_t end = bytes_.find('\0', at_);
        if (end == std::string_view::npos || end - at_ > 255) fail("the EXR header is broken or cut off");
        std::string_view result = take(end - at_);
        take(1);
        return result;
    }

    Part header()
    {
        Part part;
        for (;;) {
            std::string_view name = text();
            if (name.empty()) return part;
            std::string_view type = text();
            std::string_view value = take(number());
            check_size_of_type(type, value.size());
            if (name == "dataWindow" && type == "box2i") part.data_window = window(value);
            if (name == "displayWindow" && type == "box2i") part.display_window = window(value);
            if (name == "compression" && value.size() == 1) part.compression = static_cast<std::uint8_t>(value[0]);
            if (type == "chlist") { // OpenEXR reads each up to its end, wherever that is
                Part other;
                read_channels(value, name == "channels" ? part : other);
            }
            if (name == "tiles" && value.size() == 9) {
                part.tile_width = number(value, 0);
                part.tile_height = number(value, 4);
            }
        }
    }

    // OpenEXR reads as much as the type needs, whatever size stands before it, and would go on at the wrong place.
    void check_size_of_type(std::string_view type, std::size_t size) const
    {
        static constexpr std::pair<std::string_view, std::size_t> sizes[] = {
            {"box2i", 16},      {"box2f", 16},  {"chromaticities", 32},
            {"compression", 1}, {"double", 8},  {"envmap", 1},
            {"float", 4},       {"int", 4},     {"keycode", 28},
            {"lineOrder", 1},   {"m33f", 36},   {"m44f", 64},
            {"m33d", 72},       {"m44d", 128},  {"rational", 8},
            {"v2i", 8},         {"v2f", 8},     {"v2d", 16},
            {"v3i", 12},        {"v3f", 12},    {"v3d", 24},
            {"tiledesc", 9},    {"timecode", 8}};
        for (const auto& [known, bytes] : sizes)
            if (type == known && size != bytes) fail("the EXR header has an attribute of the wrong size");
    }

    Window window(std::string_view value) const
    {
        if (value.size() != 16) fail("the EXR header has a broken window");
        auto coordinate = [&](std::size_t i) {
            auto n = static_cast<std::int32_t>(number(value, 4 * i));
            if (n < -(1 << 29) || n > 1 << 29) fail("the EXR header has a window that is out of bounds");
            return std::int64_t(n);
        };
        return {coordinate(0), coordinate(1), coordinate(2), coordinate(3)};
    }

    void read_channels(std::string_view value, Part& part) const
    {
        std::size_t at = 0;
        while (at < value.size() && value[at] != '\0') {
            std::size_t end = value.find('\0', at);
            if (end == std::string_view::npos || value.size() - end < 17) fail("the EXR channel list is cut off");
            std::uint64_t size = number(value, end + 1) == 1 ? 2 : 4; // half, or uint and float
            std::uint64_t x_step = std::max(1u, number(value, end + 9)), y_step = std::max(1u, number(value, end + 13));
            part.texel_bytes += size;
            part.least_bits += 8 * size / std::min<std::uint64_t>(x_step * y_step, 8 * size);
            at = end + 17;
        }
        if (at + 1 != value.size()) fail("the EXR channel list ends at the wrong place");
    }

    void check_part(const Part& part) const
    {
        if (!part.data_window || !part.display_window || !part.compression || part.texel_bytes == 0)
            fail("the EXR header lacks its windows, compression or channels");
        const Window& data = *part.data_window;
        check_size(file_, data.width(), data.height(), 0, bytes_.size());

        // A window larger than its data is legitimate (a crop), but only up to the size of usual pictures.
        const Window& display = *part.display_window;
        check_size(file_, display.width(), display.height(), 0, bytes_.size());
        constexpr std::uint64_t usual = 1 << 24;
        std::uint64_t display_texels = static_cast<std::uint64_t>(display.width() * display.height());
        if (display_texels > usual)
            check_size(file_, display.width(), display.height(), display_texels / 4096, bytes_.size());

        static constexpr std::uint64_t lines_of[] = {1, 1, 1, 16, 32, 16, 32, 32, 32, 256}; // a chunk, by compression
        if (*part.compression >= std::size(lines_of)) fail("the EXR file has an unknown compression");
        std::uint64_t width = static_cast<std::uint64_t>(data.width());
        std::uint64_t height = static_cast<std::uint64_t>(data.height());
        std::uint64_t lines = lines_of[*part.compression];

        // Deflate packs at most 1032 to 1, others less; DWA deflates one value of each 8 x 8 block.
        std::uint64_t ratio = *part.compression <= 1 ? 64 : *part.compression >= 8 ? 64 * 1032 : 1400;
        check_size(file_, data.width(), data.height(), width * height * part.least_bits / 8 / ratio, bytes_.size());

        std::uint64_t chunks = (height + lines - 1) / lines, chunk_bytes = width * lines * part.texel_bytes;
        if (part.tile_width != 0 || part.tile_height != 0) {
            if (part.tile_width < 1 || part.tile_height < 1 || part.tile_width > max_side ||
                part.tile_height > max_side)
                fail("the EXR file has tiles of an impossible size");
            chunks = ((width + part.tile_width - 1) / part.tile_width) *
                     ((height + part.tile_height - 1) / part.tile_height);
            chunk_bytes = part.tile_width * part.tile_height * part.texel_bytes;
        }
        // Each chunk has an entry of 8 bytes in a table in the file, and is unpacked as a whole.
        if (chunks * 8 > bytes_.size()) fail("the EXR file is too short for its table of chunks");
        constexpr std::uint64_t harmless = 1 << 26;
        if (chunk_bytes > harmless && chunk_bytes / 4096 > bytes_.size())
            fail("the EXR file is too short for the size of its chunks");
    }

    const fs::path& file_;
    std::string_view bytes_;
    std::size_t at_ = 0;
};

} // namespace

void check_exr_headers(const fs::path& file, std::string_view bytes)
{
    ExrHeaders(file, bytes).check();
}

} // namespace snell
