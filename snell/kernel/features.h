// What there is in the scene that kernels run on.
//
// A backend that compiles kernels for each scene defines SNELL_FEATURES beforehand as a constant of the compilation,
// and the code for what the scene does not have falls away: its registers, and on devices that run all branches of a
// kernel for some lane or other its time. Everywhere else all there is may be there, and the questions cost nothing.
#ifndef SNELL_KERNEL_FEATURES_H
#define SNELL_KERNEL_FEATURES_H
#include "snell/kernel/lang.h"
SNELL_BEGIN

#ifndef SNELL_FEATURES
#define SNELL_FEATURES 0xffffffffu
#endif

// Bits 0 to 7: a material of that kind (material_* of scene_view.h).
SNELL_CONST uint feature_textures = 0x100u; // material textures
SNELL_CONST uint feature_tangents = 0x200u; // material_needs_tangents
SNELL_CONST uint feature_environment_cells = 0x400u;
SNELL_CONST uint feature_spheres = 0x800u;
SNELL_CONST uint feature_planes = 0x1000u;
SNELL_CONST uint feature_instances = 0x2000u;
SNELL_CONST uint feature_environment_texture = 0x4000u;
// Of principled materials.
SNELL_CONST uint feature_clearcoat = 0x10000u;
SNELL_CONST uint feature_sheen = 0x20000u;
SNELL_CONST uint feature_glass = 0x40000u;
SNELL_CONST uint feature_iridescence = 0x80000u;
SNELL_CONST uint feature_anisotropy = 0x100000u;
SNELL_CONST uint feature_dispersion = 0x200000u;

// False: the scene has nothing of the kind.
SNELL_FN bool may_have(uint feature)
{
    return (SNELL_FEATURES & feature) != 0u;
}

// kind == which, and known to be false where no material of the scene is of that kind.
SNELL_FN bool is_material(uint kind, uint which)
{
    return may_have(1u << which) && kind == which;
}

SNELL_END
#endif
