#include "snell/io/image/write.h"

#include "snell/core/error.h"
#include "snell/io/file.h"
#include "snell/io/image/codec.h"

namespace fs = std::filesystem;

namespace snell {

namespace {

enum class Format
{
    exr,
    png,
    hdr,
    pfm
};

Format format_of(const fs::path& file)
{
    std::string ending = lower_extension(file);
    if (ending == ".exr") return Format::exr;
    if (ending == ".png") return Format::png;
    if (ending == ".hdr") return Format::hdr;
    if (ending == ".pfm") return Format::pfm;
    throw Error({file.string()},
                ending.empty() ? std::string("the name has no ending that says which kind of picture to write")
                               : fmt::format("pictures of the kind '{}' cannot be written", ending),
                "use .exr, .png, .hdr or .pfm");
}

} // namespace

void check_writable(const fs::path& file)
{
    format_of(file);
    check_can_write(file);
}

void write_picture(const fs::path& file, const Picture& picture, const Layers& layers, const DisplayTransform& display)
{
    Format format = format_of(file);
    SNELL_CHECK_LT(0, picture.width);
    SNELL_CHECK_LT(0, picture.height);
    SNELL_CHECK_EQ(picture.pixels.size(),
                   static_cast<std::size_t>(picture.width) * static_cast<std::size_t>(picture.height));
    switch (format) {
    case Format::exr:
        return write_exr(file, picture, layers);
    case Format::png:
        return write_png(file, picture, layers, display);
    case Format::hdr:
        return write_hdr(file, picture);
    case Format::pfm:
        return write_pfm(file, picture);
    }
}

} // namespace snell
