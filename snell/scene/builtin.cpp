#include "snell/scene/builtin.h"

#include "snell/scene/builtin/makers.h"

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

std::span<const BuiltinScene> builtin_scenes()
{
    static constexpr BuiltinScene all[] = {
        {"cornell", "a box with coloured walls, two blocks and a square light: the classic of global illumination",
         make_cornell},
        {"whitted", "a hollow glass ball and a mirror ball over a checkerboard, after Whitted's picture of 1980",
         make_whitted},
        {"spheres", "all primitives and all materials side by side", make_spheres},
        {"sphereflake", "a fractal of 597,871 spheres (depth 6), after Haines's procedural databases",
         default_sphereflake},
        {"menger", "a Menger sponge of 8,000 cubes (depth 3) with a lamp in its middle", default_menger},
        {"veach-mis", "four plates of growing roughness and lamps of growing size: what MIS is for", make_veach_mis},
        {"many-lights", "a city of boxes lit by 400 coloured lamps", default_many_lights},
    };
    return all;
}

const BuiltinScene* find_builtin_scene(std::string_view name)
{
    for (const BuiltinScene& scene : builtin_scenes())
        if (scene.name == name) return &scene;
    return nullptr;
}

} // namespace snell
