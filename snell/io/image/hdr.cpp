// Radiance pictures: 8-bit mantissas with a shared exponent (Ward, Real Pixels, Graphics Gems II, 1991). Read and
// written here rather than by stb_image because that accepts files that are cut off, and not the old run lengths.
#include "snell/core/error.h"
#include "snell/io/file.h"
#include "snell/io/image/codec.h"
#include "snell/kernel/lang.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>

namespace fs = std::filesystem;

namespace snell {

namespace {

using Rgbe = std::array<std::uint8_t, 4>;

class HdrReader
{
  public:
    HdrReader(const fs::path& file, std::string_view bytes) : file_(file), bytes_(bytes) {}

    Raster read()
    {
        double exposure = read_header();
        read_resolution();
        check_size(file_, width_, height_, 0, bytes_.size()); // before anything is multiplied
        // Even runs need 8 bytes for each 127 pixels of new run lengths; old ones reach further, but nobody's did.
        check_size(file_, width_, height_, static_cast<std::uint64_t>(width_ * height_) / 1024, bytes_.size());

        Raster raster;
        raster.width = static_cast<int>(width_);
        raster.height = static_cast<int>(height_);
        std::size_t w = static_cast<std::size_t>(width_), h = static_cast<std::size_t>(height_);
        raster.floats.resize(w * h * 4);
        std::size_t lines = columns_ ? w : h;
        std::vector<Rgbe> line(columns_ ? h : w);
        for (std::size_t i = 0; i < lines; ++i) {
            read_line(line);
            for (std::size_t j = 0; j < line.size(); ++j) {
                std::size_t x = columns_ ? i : j, y = columns_ ? j : i;
                if (right_to_left_) x = w - 1 - x;
                if (bottom_up_) y = h - 1 - y;
                const Rgbe& p = line[j];
                float* out = &raster.floats[4 * (y * w + x)];
                double scale = p[3] == 0 ? 0.0 : std::ldexp(1.0, int(p[3]) - (128 + 8)) / exposure;
                for (std::size_t c = 0; c < 3; ++c) out[c] = static_cast<float>(p[c] * scale);
                out[3] = 1.0f;
            }
        }
        return raster;
    }

  private:
    [[noreturn]] void fail(const std::string& message) const
    {
        throw Error({file_.string()}, message, "write the file again");
    }

    std::uint8_t next()
    {
        if (at_ >= bytes_.size()) fail("the picture is cut off");
        return static_cast<std::uint8_t>(bytes_[at_++]);
    }

    std::string_view header_line()
    {
        std::size_t end = bytes_.find('\n', at_);
        if (end == std::string_view::npos) fail("the header is cut off");
        std::string_view text = bytes_.substr(at_, end - at_);
        at_ = end + 1;
        if (text.ends_with('\r')) text.remove_suffix(1);
        return text;
    }

    // Returns the product of the exposures by which the pixels were multiplied.
    double read_header()
    {
        double exposure = 1.0;
        header_line(); // "#?RADIANCE", "#?RGBE": programs differ
        for (;;) {
            std::string_view text = header_line();
            if (text.empty()) return exposure;
            if (text.starts_with("FORMAT=") && text != "FORMAT=32-bit_rle_rgbe")
                throw Error({file_.string()}, fmt::format("pixels in {} are not supported", text.substr(7)),
                            "convert the file to 32-bit_rle_rgbe");
            if (text.starts_with("EXPOSURE=")) {
                std::string_view number = text.substr(9);
                while (number.starts_with(' ')) number.remove_prefix(1);
                double value = 0.0;
                std::from_chars(number.data(), number.data() + number.size(), value);
                exposure *= value;
                if (!(exposure > 1e-30) || !(exposure < 1e30)) fail("EXPOSURE in the header is not a positive number");
            }
        }
    }

    // "-Y 480 +X 640": which axis is the line's, and the directions, in all eight combinations.
    void read_resolution()
    {
        std::string_view text = header_line();
        bool has_x = false, has_y = false;
        for (int i = 0; i < 2; ++i) {
            while (text.starts_with(' ')) text.remove_prefix(1);
            if (text.size() < 4 || (text[0] != '+' && text[0] != '-') || text[2] != ' ') fail("bad resolution line");
            bool minus = text[0] == '-';
            char axis = text[1];
            text.remove_prefix(3);
            std::int64_t size = 0;
            auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), size);
            if (error != std::errc()) fail("bad resolution line");
            text.remove_prefix(static_cast<std::size_t>(end - text.data()));
            if (axis == 'X' && !has_x) {
                has_x = true;
                width_ = size;
                right_to_left_ = minus;
                columns_ = i == 0;
            } else if (axis == 'Y' && !has_y) {
                has_y = true;
                height_ = size;
                bottom_up_ = !minus;
            } else {
                fail("bad resolution line");
            }
        }
    }

    void read_line(std::vector<Rgbe>& line)
    {
        std::size_t size = line.size();
        Rgbe first = {next(), next(), next(), next()};
        if (first[0] == 2 && first[1] == 2 && first[2] < 128 && size >= 8 && size < 32768) {
            if (std::size_t(first[2]) * 256 + first[3] != size) fail("a scan line has the wrong length");
            for (std::size_t c = 0; c < 4; ++c) read_component(line, c);
            return;
        }
        // Old run lengths: (1, 1, 1, n) repeats the pixel before it; runs on end are digits of one number.
        int shift = 0;
        for (std::size_t x = 0; x < size;) {
            Rgbe p = first;
            if (x > 0 || shift > 0) p = {next(), next(), next(), next()};
            if (p[0] == 1 && p[1] == 1 && p[2] == 1) {
                if (x == 0) fail("a scan line begins with a repetition");
                if (shift > 16) fail("a run is too long");
                std::size_t count = std::size_t(p[3]) << shift;
                if (count > size - x) fail("a run is longer than its scan line");
                std::fill_n(line.begin() + static_cast<std::ptrdiff_t>(x), count, line[x - 1]);
                x += count;
                shift += 8;
            } else {
                line[x++] = p;
                shift = 0;
            }
        }
    }

    void read_component(std::vector<Rgbe>& line, std::size_t c)
    {
        for (std::size_t x = 0; x < line.size();) {
            std::size_t code = next();
            bool is_run = code > 128;
            std::size_t count = is_run ? code - 128 : code;
            if (count == 0 || count > line.size() - x) fail("a run does not fit into its scan line");
            std::uint8_t value = is_run ? next() : std::uint8_t(0);
            for (std::size_t end = x + count; x < end; ++x) line[x][c] = is_run ? value : next();
        }
    }

    const fs::path& file_;
    std::string_view bytes_;
    std::size_t at_ = 0;
    std::int64_t width_ = 0, height_ = 0;
    bool columns_ = false, right_to_left_ = false, bottom_up_ = false;
};

// Rounded to nearest, so that the mean error is zero for readers that take a mantissa as it is (most do).
Rgbe encode(vec3 radiance)
{
    const float largest = 255.0f * 6.6461399789245794e35f; // mantissa 255, exponent 255
    float rgb[3] = {radiance.x, radiance.y, radiance.z};
    float greatest = 0.0f;
    for (float& v : rgb) {
        v = v > 0.0f ? std::min(v, largest) : 0.0f; // NaN becomes 0, infinity the largest
        greatest = std::max(greatest, v);
    }
    if (greatest < 1e-38f) return {0, 0, 0, 0};
    int exponent;
    std::frexp(greatest, &exponent); // greatest = m * 2^exponent, m in [1/2, 1)
    if (std::lround(std::ldexp(greatest, 8 - exponent)) > 255) ++exponent;
    Rgbe p;
    for (std::size_t c = 0; c < 3; ++c) p[c] = static_cast<std::uint8_t>(std::lround(std::ldexp(rgb[c], 8 - exponent)));
    p[3] = static_cast<std::uint8_t>(exponent + 128);
    return p;
}

void append_component(std::string& bytes, const std::vector<Rgbe>& line, std::size_t c)
{
    constexpr std::size_t worthwhile = 4; // shorter runs cost more than they save
    std::size_t size = line.size();
    auto run_length = [&](std::size_t x) {
        std::size_t n = 1;
        while (n < 127 && x + n < size && line[x + n][c] == line[x][c]) ++n;
        return n;
    };
    for (std::size_t x = 0; x < size;) {
        std::size_t run = run_length(x);
        if (run >= worthwhile) {
            bytes += static_cast<char>(128 + run);
            bytes += static_cast<char>(line[x][c]);
            x += run;
            continue;
        }
        std::size_t begin = x;
        while (x < size && x - begin < 128) {
            run = run_length(x);
            if (run >= worthwhile) break;
            x = std::min(x + run, begin + 128);
        }
        bytes += static_cast<char>(x - begin);
        for (std::size_t i = begin; i < x; ++i) bytes += static_cast<char>(line[i][c]);
    }
}

} // namespace

Raster decode_hdr(const fs::path& file, std::string_view bytes)
{
    return HdrReader(file, bytes).read();
}

void write_hdr(const fs::path& file, const Picture& picture)
{
    std::string bytes =
        fmt::format("#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y {} +X {}\n", picture.height, picture.width);
    std::size_t width = static_cast<std::size_t>(picture.width);
    std::vector<Rgbe> line(width);
    for (int y = 0; y < picture.height; ++y) {
        for (int x = 0; x < picture.width; ++x) line[static_cast<std::size_t>(x)] = encode(picture.at(x, y));
        if (width < 8 || width > 32767) { // the format has no run lengths for these
            for (const Rgbe& p : line) bytes.append(p.begin(), p.end());
            continue;
        }
        bytes += {2, 2, static_cast<char>(width >> 8), static_cast<char>(width & 255)};
        for (std::size_t c = 0; c < 4; ++c) append_component(bytes, line, c);
    }
    write_atomically(file, bytes);
}

} // namespace snell
