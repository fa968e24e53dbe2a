// A city of boxes lit by hundreds of small coloured lamps: choosing the right one matters.
#include "snell/core/error.h"
#include "snell/scene/builtin.h"
#include "snell/scene/builtin/makers.h"
#include "snell/scene/shapes.h"

#include <cmath>

namespace snell {

// Reproducible numbers in [0, 1): one step of PCG (O'Neill 2014), output RXS-M-XS of 32 bits.
static float random_number(uint& state)
{
    state = state * 747796405u + 2891336453u;
    const uint word = ((state >> ((state >> 28u) + 4u)) ^ state) * 277803737u;
    return static_cast<float>(((word >> 22u) ^ word) >> 8u) * 0x1p-24f;
}

// A saturated colour for a hue in [0, 1), about as bright to the eye as any other.
static vec3 lamp_color(float hue)
{
    const vec3 phase = vec3(hue) + vec3(0.0f, 1.0f / 3.0f, 2.0f / 3.0f);
    const vec3 wave = 0.5f + 0.5f * cos(2.0f * pi * phase);
    const vec3 color = 0.02f + wave * wave * wave;
    return color / (0.3f * luminance(color) + 0.7f * max3(color));
}

Scene make_many_lights(int count)
{
    if (count < 1 || count > many_lights_most)
        throw Error(fmt::format("a scene of {} lights", count),
                    fmt::format("give a number from 1 to {}", many_lights_most));
    Scene scene;
    scene.name = "many-lights";
    scene.environment.radiance = vec3(0.012f, 0.016f, 0.030f);
    const auto stone = add(scene, mix_of("stone", vec3(0.55f), vec3(0.12f), 0.3f));
    const auto floor = add(scene, mix_of("wet floor", vec3(0.25f), vec3(0.35f), 0.12f));
    add(scene, PlaneDesc{"floor", vec3(0.0f), {0, 1, 0}, floor});

    // Blocks on a grid with streets between them, the higher the further from the front.
    constexpr int blocks = 12;
    constexpr float pitch = 1.0f, width = 0.56f;
    uint state = 1980u;
    const Index<Mesh> box = add(scene, make_box("block", {-0.5f, 0, -0.5f}, {0.5f, 1, 0.5f}, stone));
    const Index<Group> group = add(scene, Group{"block", {box}, {}});
    for (int row = 0; row < blocks; ++row) {
        for (int column = 0; column < blocks; ++column) {
            const float x = (static_cast<float>(column) - 0.5f * (blocks - 1)) * pitch;
            const float z = -static_cast<float>(row) * pitch;
            const float tower = random_number(state), storeys = random_number(state);
            const float height = 0.25f + 0.14f * static_cast<float>(row) * tower + 0.5f * storeys;
            add(scene, InstanceDesc{"", group, compose(translation({x, 0, z}), scaling({width, height, width}))});
        }
    }

    // Lamps hang in the streets at random; their powers add up to the same however many they are. Every second one is
    // a small ball, the others are points.
    const float total = 100.0f;
    const float intensity = total / static_cast<float>(count);
    constexpr float radius = 0.045f;
    constexpr int hues = 16;
    std::vector<Index<MaterialDesc>> glows;
    for (int i = 0; i < hues; ++i) {
        const vec3 color = lamp_color(static_cast<float>(i) / hues);
        glows.push_back(add(scene, emitter("glow", intensity / (pi * radius * radius) * color)));
    }
    Group balls;
    balls.name = "lamps";
    for (int i = 0; i < count; ++i) {
        const float along = random_number(state), which = random_number(state);
        const float rise = random_number(state);
        const float height = 0.2f + 0.9f * rise;
        const bool lengthwise = random_number(state) < 0.5f;
        const float hue = random_number(state);
        const float extent = blocks * pitch;
        const float street = std::floor(which * (blocks + 1)) * pitch - 0.5f * extent;
        const float way = along * extent - 0.5f * extent;
        const float middle = -0.5f * (blocks - 1) * pitch;
        const vec3 position = lengthwise ? vec3(street, height, middle + way) : vec3(way, height, middle + street);
        if (i % 2 == 0) {
            const auto glow = glows[static_cast<std::size_t>(hue * hues)];
            balls.spheres.push_back(add(scene, SphereDesc{"", position, radius, glow}));
        } else {
            LightDesc lamp;
            lamp.position = position;
            lamp.emission = intensity * lamp_color(hue);
            add(scene, lamp);
        }
    }
    add(scene, InstanceDesc{"lamps", add(scene, balls), identity_transform()});
    add(scene, CameraDesc{"above the streets", {2.2f, 4.4f, 4.6f}, {0.2f, 0.0f, -3.6f}, {0, 1, 0}, 46.0f});
    return scene;
}

} // namespace snell
