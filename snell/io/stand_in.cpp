#include "snell/io/stand_in.h"

namespace snell {

Image checkerboard(const std::string& name)
{
    Image image;
    image.name = name;
    image.width = image.height = 8;
    for (uint y = 0; y < 8; ++y)
        for (uint x = 0; x < 8; ++x) {
            const std::uint8_t on = (x + y) % 2 == 0 ? 255 : 0;
            image.bytes.insert(image.bytes.end(), {on, 0, on, 255});
        }
    return image;
}

} // namespace snell
