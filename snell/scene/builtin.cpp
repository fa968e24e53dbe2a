#include "snell/scene/builtin.h"

#include "snell/core/error.h"
#include "snell/scene/builtin/makers.h"

#include <charconv>

namespace snell {

static Scene default_sphereflake()
{
    return make_sphereflake(6);
}

static Scene default_menger()
{
    return make_menger(3);
}

static Scene default_many_lights()
{
    return make_many_lights(400);
}

static Scene default_field()
{
    return make_field(20'000);
}

std::span<const BuiltinScene> builtin_scenes()
{
    static constexpr BuiltinScene all[] = {
        {"cornell", "a box with coloured walls, two blocks and a square light: the classic of global illumination",
         make_cornell},
        {"whitted", "a hollow glass ball and a mirror ball over a checkerboard, after Whitted's picture of 1980",
         make_whitted},
        {"spheres", "all primitives and all materials side by side", make_spheres},
        {"sphereflake", "a fractal of 597,871 spheres (depth 6), after Haines's procedural databases",
         default_sphereflake, make_sphereflake, "DEPTH", 0, sphereflake_deepest},
        {"menger", "a Menger sponge of 8,000 cubes (depth 3) with a lamp in its middle", default_menger, make_menger,
         "DEPTH", 0, menger_deepest},
        {"veach-mis", "four plates of growing roughness and lamps of growing size: what MIS is for", make_veach_mis},
        {"grid", "a checkered room with rulers, to look through lenses at", make_grid},
        {"many-lights", "a city of boxes lit by 400 coloured lamps", default_many_lights, make_many_lights, "COUNT", 1,
         many_lights_most},
        {"field", "boulders on rough ground in a closed hall, 20,000 triangles", default_field, make_field, "TRIANGLES",
         field_least, field_most},
    };
    return all;
}

const BuiltinScene* find_builtin_scene(std::string_view name)
{
    for (const BuiltinScene& scene : builtin_scenes())
        if (scene.name == name) return &scene;
    return nullptr;
}

std::optional<Scene> make_builtin_scene(std::string_view name)
{
    const std::size_t colon = name.find(':');
    const BuiltinScene* builtin = find_builtin_scene(name.substr(0, colon));
    if (builtin == nullptr) return std::nullopt;
    if (colon == std::string_view::npos) return builtin->make();

    if (builtin->make_with == nullptr)
        throw Error(fmt::format("the built-in scene '{}' takes no number", builtin->name),
                    fmt::format("say '{}' alone", builtin->name));
    const std::string_view text = name.substr(colon + 1);
    int number = 0;
    const auto [end, code] = std::from_chars(text.data(), text.data() + text.size(), number);
    const bool is_number = code == std::errc() && end == text.data() + text.size();
    if (!is_number || number < builtin->least || number > builtin->most)
        throw Error(fmt::format("'{}': {} cannot be '{}'", name, builtin->parameter, text),
                    fmt::format("give {}:{} with a whole number from {} to {}", builtin->name, builtin->parameter,
                                builtin->least, builtin->most));
    return builtin->make_with(number);
}

} // namespace snell
