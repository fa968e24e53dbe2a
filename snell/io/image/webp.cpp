// WebP through libwebp, lossy and lossless.
#include "snell/core/error.h"
#include "snell/io/image/codec.h"

#include <webp/decode.h>

namespace fs = std::filesystem;

namespace snell {

Raster decode_webp(const fs::path& file, std::string_view bytes)
{
    const auto* const data = reinterpret_cast<const std::uint8_t*>(bytes.data());
    WebPBitstreamFeatures features = {};
    if (WebPGetFeatures(data, bytes.size(), &features) != VP8_STATUS_OK)
        throw Error({file.string()}, "not a good WebP file", "write the file again");
    if (features.has_animation)
        throw Error({file.string()}, "an animated WebP file", "save one of its pictures by itself");
    // A picture of one colour takes a few dozen bytes at any size; larger ones than usual must have more to show.
    constexpr std::uint64_t usual = 1 << 24;
    const std::uint64_t texels =
        static_cast<std::uint64_t>(features.width) * static_cast<std::uint64_t>(features.height);
    check_size(file, features.width, features.height, texels > usual ? texels / 4096 : 0, bytes.size());

    Raster raster;
    raster.width = features.width;
    raster.height = features.height;
    raster.bytes.resize(static_cast<std::size_t>(texels) * 4);
    if (!WebPDecodeRGBAInto(data, bytes.size(), raster.bytes.data(), raster.bytes.size(), raster.width * 4))
        throw Error({file.string()}, "the WebP file is cut off or broken", "write the file again");
    return raster;
}

} // namespace snell
