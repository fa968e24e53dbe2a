// The scenes that come with snell, made in code.
#pragma once

#include "snell/scene/scene.h"

#include <span>
#include <string_view>

namespace snell {

struct BuiltinScene
{
    std::string_view name;
    std::string_view summary; // one line for `snell list`
    Scene (*make)();
};

std::span<const BuiltinScene> builtin_scenes();

// nullptr if there is none of that name.
const BuiltinScene* find_builtin_scene(std::string_view name);

// The parametric ones, for programs that want other sizes than the built-in ones.
Scene make_sphereflake(int depth); // 1 + 9 + ... + 9^depth spheres, by instancing beyond depth 3
Scene make_menger(int depth);      // 20^depth cubes
Scene make_many_lights(int count); // point and area lights over a floor of boxes

} // namespace snell
