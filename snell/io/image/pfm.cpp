// Portable float map: a text header, then rows of floats from the bottom up; the sign of the scale is the byte order.
#include "snell/core/error.h"
#include "snell/io/file.h"
#include "snell/io/image/codec.h"

#include <bit>
#include <charconv>
#include <cmath>
#include <cstring>

namespace fs = std::filesystem;

namespace snell {

namespace {

bool is_space(char c)
{
    return c == ' ' || c == '\t' || c == '\n' || c == '\r';
}

// The next word of the header; what follows begins at the one white space after it.
std::string_view next_word(const fs::path& file, std::string_view bytes, std::size_t& at)
{
    while (at < bytes.size() && is_space(bytes[at])) ++at;
    std::size_t begin = at;
    while (at < bytes.size() && !is_space(bytes[at]) && at - begin < 64) ++at;
    if (at == begin || at >= bytes.size() || !is_space(bytes[at]))
        throw Error({file.string()}, "the PFM header is cut off or broken", "write the file again");
    return bytes.substr(begin, at - begin);
}

template <class T>
T next_number(const fs::path& file, std::string_view bytes, std::size_t& at)
{
    std::string_view word = next_word(file, bytes, at);
    if (!word.empty() && word[0] == '+') word.remove_prefix(1);
    T value = {};
    auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
    if (error != std::errc() || end != word.data() + word.size())
        throw Error({file.string()}, fmt::format("'{}' in the PFM header is not a number", word),
                    "write the file again");
    return value;
}

} // namespace

Raster decode_pfm(const fs::path& file, std::string_view bytes)
{
    std::size_t at = 0;
    std::string_view kind = next_word(file, bytes, at);
    if (kind != "PF" && kind != "Pf")
        throw Error({file.string()}, fmt::format("a PFM file begins with PF or Pf, not '{}'", kind),
                    "write the file again");
    std::size_t channels = kind == "PF" ? 3 : 1;
    auto width = next_number<std::int64_t>(file, bytes, at);
    auto height = next_number<std::int64_t>(file, bytes, at);
    auto scale = next_number<double>(file, bytes, at);
    if (!(std::abs(scale) > 0.0) || !std::isfinite(scale))
        throw Error({file.string()}, "the scale in the PFM header must be a number other than 0",
                    "write the file again, with scale -1.0");
    ++at;
    check_size(file, width, height, 0, bytes.size());
    std::size_t w = static_cast<std::size_t>(width), h = static_cast<std::size_t>(height);
    check_size(file, width, height, at + w * h * channels * 4, bytes.size());

    Raster raster;
    raster.width = static_cast<int>(width);
    raster.height = static_cast<int>(height);
    raster.floats.resize(w * h * 4);
    bool swapped = (scale < 0.0) != (std::endian::native == std::endian::little);
    float factor = static_cast<float>(std::abs(scale));
    const char* next = bytes.data() + at;
    for (std::size_t y = h; y-- > 0;) {
        float* out = &raster.floats[y * w * 4];
        for (std::size_t x = 0; x < w; ++x, out += 4) {
            for (std::size_t c = 0; c < channels; ++c, next += 4) {
                std::uint32_t bits;
                std::memcpy(&bits, next, 4);
                if (swapped) bits = __builtin_bswap32(bits);
                out[c] = std::bit_cast<float>(bits);
                // Only if it says something: a product would quieten a signalling NaN.
                if (factor != 1.0f) out[c] *= factor;
            }
            if (channels == 1) out[1] = out[2] = out[0];
            out[3] = 1.0f;
        }
    }
    return raster;
}

void write_pfm(const fs::path& file, const Picture& picture)
{
    std::string bytes = fmt::format("PF\n{} {}\n{}\n", picture.width, picture.height,
                                    std::endian::native == std::endian::little ? "-1.0" : "1.0");
    static_assert(sizeof(vec3) == 12);
    std::size_t row = static_cast<std::size_t>(picture.width) * sizeof(vec3);
    std::size_t at = bytes.size();
    bytes.resize(at + row * static_cast<std::size_t>(picture.height));
    for (int y = picture.height; y-- > 0; at += row) std::memcpy(&bytes[at], &picture.at(0, y), row);
    write_atomically(file, bytes);
}

} // namespace snell
