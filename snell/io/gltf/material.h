// glTF's materials.
#pragma once

#include "snell/io/gltf/images.h"

namespace snell::gltf {

// Material `index` of the file with all its extensions; its textures are asked of `images`. Throws Error if it refers
// to what is not there.
MaterialDesc to_material(const Document& document, std::size_t index, Images& images, Remarks& remarks);

// What a primitive without a material has.
MaterialDesc default_material();

} // namespace snell::gltf
