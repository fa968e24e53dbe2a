// The scenes that come with snell, made in code.
#pragma once

#include "snell/scene/scene.h"

#include <optional>
#include <span>
#include <string_view>

namespace snell {

struct BuiltinScene
{
    std::string_view name;
    std::string_view summary; // one line for `snell list`
    Scene (*make)();

    // Of the parametric ones, which go by name:number as well; nullptr and 0 for the others.
    Scene (*make_with)(int number) = nullptr;
    std::string_view parameter = {}; // what the number is, such as "DEPTH"
    int least = 0, most = 0;         // make_with throws Error outside
};

std::span<const BuiltinScene> builtin_scenes();

// nullptr if there is none of that name.
const BuiltinScene* find_builtin_scene(std::string_view name);

// The scene of that name, or of name:number for a parametric one, such as "sphereflake:4"; nothing if no built-in scene
// has the name. Throws Error, naming the range, if the number is none, out of range, or for a scene that takes none.
std::optional<Scene> make_builtin_scene(std::string_view name);

// The greatest numbers that the parametric ones take.
constexpr int sphereflake_deepest = 9; // 4 * 10^8 spheres in half a million instances
constexpr int menger_deepest = 6;      // 6.4 * 10^7 cubes in 160,000 instances
constexpr int many_lights_most = 1'000'000;
constexpr int field_least = 1000, field_most = 50'000'000;

// The parametric ones; each throws Error if the number is out of range.
Scene make_sphereflake(int depth); // from 0: 1 + 9 + ... + 9^depth spheres, by instancing beyond depth 3
Scene make_menger(int depth);      // from 0: 20^depth cubes
Scene make_many_lights(int count); // from 1: point and area lights over a floor of boxes
Scene make_field(int count);       // that many triangles, or a little more, of rough ground and boulders

} // namespace snell
