// Scenes for kernels that look things up: made of words, so that the GPU gets the same bytes.
#pragma once

#include "snell/kernel/scene_view.h"
#include "tests/gpu/scene_sizes.h"
#include "tests/gpu/vulkan_harness.h"

#include <array>
#include <cstring>
#include <vector>

namespace snell::test {

// The arrays of a SceneView in the order of its pointers, which are its first members.
class SceneWords
{
  public:
    static constexpr std::size_t array_count = offsetof(SceneView, light_count) / sizeof(void*);

    template <class Array, class T>
    void set(Array SceneView::*member, const std::vector<T>& values)
    {
        auto& words = arrays[place(member)];
        words.resize(values.size() * sizeof(T) / sizeof(std::uint32_t));
        if (!values.empty()) std::memcpy(words.data(), values.data(), values.size() * sizeof(T));
    }
    template <class Array>
    std::size_t place(Array SceneView::*member) const
    {
        const auto at = reinterpret_cast<const char*>(&(tail.*member)) - reinterpret_cast<const char*>(&tail);
        return static_cast<std::size_t>(at) / sizeof(void*);
    }
    SceneView view() const
    {
        return with_addresses([&](std::size_t i) { return reinterpret_cast<std::uint64_t>(arrays[i].data()); });
    }

    std::array<std::vector<std::uint32_t>, array_count> arrays;
    SceneView tail{}; // what follows the pointers

    template <class AddressOf>
    SceneView with_addresses(AddressOf address_of) const
    {
        SceneView view = tail;
        for (std::size_t i = 0; i < array_count; ++i) {
            const std::uint64_t address = address_of(i);
            std::memcpy(reinterpret_cast<char*>(&view) + i * sizeof(void*), &address, sizeof(address));
        }
        return view;
    }
};

// The same scene in the GPU's memory.
struct GpuScene
{
    GpuScene(const Gpu& gpu, const SceneWords& scene);

    std::vector<std::unique_ptr<GpuBuffer>> arrays;
    std::unique_ptr<GpuBuffer> view; // a SceneView of addresses
};

// A small scene with every kind of primitive, surface attribute, material, light and texture, drawn at random within
// the contracts of scene_view.h.
SceneWords random_scene();

// Arrays in which every word differs from its neighbours and is an ordinary number both as float and as uint.
SceneWords pattern_scene();
std::uint32_t pattern_word(std::size_t i);

} // namespace snell::test
