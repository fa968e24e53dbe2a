// The editor of one material: of its kind, only the fields that have an effect.
#pragma once

#include "snell/view/fields.h"

namespace snell::view {

void edit_material(Fields& fields, MaterialDesc& material, const Scene& scene);

} // namespace snell::view
