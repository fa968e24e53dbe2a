// The C++ half of the twin test. A case is a block of kernel dialect after TWIN(...) in cases/*.inl; both compilers
// read the same text. It draws random inputs, calls kernel functions and gives away their results:
//
//     TWIN(luminance, 1e-6f, 0.0f, 0.0f) // relative and absolute tolerance, share of outliers allowed
//     {
//         vec3 c = color();
//         give(luminance(c));
//     }
//
// TWIN_BUILTIN instead of TWIN: a result comes through pow, exp, log or a trigonometric function, which both languages
// round as they like. All others must agree to the last bit in the exact build (see exact_builtins.glsl).
//
// Here an input is drawn and recorded; in twin.glsl the same call reads the recorded word, so both sides compute from
// the same bits. Each input is drawn in a statement of its own: C++ leaves the order of arguments open.
#pragma once

#include "snell/kernel/ray.h"
#include "snell/kernel/scene_view.h"

#include <cmath>
#include <cstdint>
#include <string>
#include <vector>

namespace snell {

struct TwinCase
{
    std::string name;
    float relative = 0.0f, absolute = 0.0f; // |a - b| <= absolute + relative * max(|a|, |b|)
    float outliers = 0.0f;                  // share of the items that may hold a value beyond it
    bool builtin = false;                   // not bit-equal in the exact build either
};

// What one run of a case records. Word w of item i is at [w * count + i].
class Twin
{
  public:
    // Cases are counted from 1 in the order of the file; 0: only list them.
    void start(std::uint32_t which, std::size_t items, std::uint64_t seed)
    {
        wanted = which;
        count = items;
        stream = seed;
        inputs.clear();
        outputs.clear();
        is_float.clear();
        cases.clear();
        given_words.assign(items, 0);
    }
    void next_item(std::size_t i)
    {
        item = i;
        entered = read_words = written_words = 0;
    }
    bool enter(const char* name, float relative, float absolute, float outliers, bool builtin)
    {
        ++entered;
        if (wanted == 0) cases.push_back({name, relative, absolute, outliers, builtin});
        return entered == wanted;
    }
    void end_item() { given_words[item] = written_words; }

    std::uint32_t record(std::uint32_t word)
    {
        const std::size_t at = read_words++ * count + item;
        if (at >= inputs.size()) inputs.resize(read_words * count, 0u);
        return inputs[at] = word;
    }
    void give(std::uint32_t word, bool as_float)
    {
        const std::size_t at = written_words++ * count + item;
        if (at >= outputs.size()) {
            outputs.resize(written_words * count, unwritten);
            is_float.resize(written_words * count, 0);
        }
        outputs[at] = word;
        is_float[at] = as_float;
    }
    // splitmix64 (Steele, Lea, Flood 2014); not the kernel's generators, which are under test.
    std::uint32_t random_word()
    {
        std::uint64_t z = stream += 0x9e3779b97f4a7c15u;
        z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
        z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
        return static_cast<std::uint32_t>((z ^ (z >> 31)) >> 32);
    }
    // In [0, 1), 24 bits.
    float random_unit() { return static_cast<float>(random_word() >> 8) * 0x1p-24f; }
    bool one_in(std::uint32_t n) { return random_word() % n == 0; }

    static constexpr std::uint32_t unwritten = 0xcdcdcdcdu;
    std::size_t count = 0;
    std::vector<std::uint32_t> inputs, outputs, given_words;
    std::vector<std::uint8_t> is_float;
    std::vector<TwinCase> cases;
    SceneView scene{};         // what `scene` means in a case
    const void* raw = nullptr; // what RAW means

  private:
    std::uint32_t wanted = 0, entered = 0;
    std::size_t item = 0;
    std::uint32_t read_words = 0, written_words = 0;
    std::uint64_t stream = 0;
};

inline Twin twin;

// Inputs -------------------------------------------------------------------------------------------------------------

inline float record(float x)
{
    return uintBitsToFloat(twin.record(floatBitsToUint(x)));
}
inline vec3 record(vec3 v)
{
    record(v.x), record(v.y), record(v.z);
    return v;
}

// Any 32 bits; one in eight is special.
inline uint word()
{
    const uint special[] = {0u, 1u, 0xffffffffu, 0x80000000u, 0x7fffffffu, 0xfffffffeu};
    return twin.record(twin.one_in(8) ? special[twin.random_word() % 6] : twin.random_word());
}
// Of [0, n).
inline uint index_below(uint n)
{
    return twin.record(twin.random_word() % n);
}

// Of [low, high]; one in eight is special: the ends and their neighbours, 0, -0, 1, -1 and tiny numbers inside.
inline float range(float low, float high)
{
    if (twin.one_in(8)) {
        const float special[] = {low,
                                 high,
                                 std::nextafter(low, high),
                                 std::nextafter(high, low),
                                 0.0f,
                                 -0.0f,
                                 1.0f,
                                 -1.0f,
                                 1e-30f,
                                 -1e-30f,
                                 1e-7f,
                                 0.5f};
        const float x = special[twin.random_word() % 12];
        if (x >= low && x <= high) return record(x);
    }
    return record(low + (high - low) * twin.random_unit());
}
// Of [low, high], both > 0, evenly over the orders of magnitude; one in 16 is an end.
inline float magnitude(float low, float high)
{
    if (twin.one_in(16)) return record(twin.one_in(2) ? low : high);
    return record(std::min(high, low * std::exp(twin.random_unit() * std::log(high / low))));
}
// Random numbers as samplers make them: [0, 1), with the ends.
inline float unit()
{
    const float special[] = {0.0f, 1.0f - 0x1p-24f, 0.5f, 0x1p-24f, 0.25f, 0.75f};
    return record(twin.one_in(8) ? special[twin.random_word() % 6] : twin.random_unit());
}
inline vec2 unit2()
{
    const float x = unit();
    const float y = unit();
    return vec2(x, y);
}
// In the box [-size, size]^3.
inline vec3 point(float size)
{
    const float x = range(-size, size);
    const float y = range(-size, size);
    const float z = range(-size, size);
    return vec3(x, y, z);
}
inline vec2 point2(float size)
{
    const float x = range(-size, size);
    const float y = range(-size, size);
    return vec2(x, y);
}
// In [0, 1]^3; one in 16 is black or white.
inline vec3 color()
{
    if (twin.one_in(16)) return record(vec3(twin.one_in(2) ? 0.0f : 1.0f));
    const float x = range(0.0f, 1.0f);
    const float y = range(0.0f, 1.0f);
    const float z = range(0.0f, 1.0f);
    return vec3(x, y, z);
}
// Of unit length; one in eight lies along an axis or is grazing (|z| down to 1e-4).
inline vec3 direction()
{
    const float two_pi = 6.2831853f;
    float z = 2.0f * twin.random_unit() - 1.0f;
    const float turn = twin.random_unit();
    if (twin.one_in(8)) {
        const vec3 axes[] = {{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}};
        if (twin.one_in(2)) return record(axes[twin.random_word() % 6]);
        z *= std::pow(10.0f, -4.0f * twin.random_unit());
    }
    const float r = std::sqrt(1.0f - z * z);
    return record(normalize(vec3(r * std::cos(two_pi * turn), r * std::sin(two_pi * turn), z)));
}
// The same with z > 0.
inline vec3 upper_direction()
{
    const float z = std::max(twin.random_unit(), 1e-4f);
    const float turn = twin.random_unit();
    if (twin.one_in(16)) return record(vec3(0.0f, 0.0f, 1.0f));
    const float r = std::sqrt(1.0f - z * z);
    return record(normalize(vec3(r * std::cos(6.2831853f * turn), r * std::sin(6.2831853f * turn), z)));
}

// Results ------------------------------------------------------------------------------------------------------------

inline void give(uint x)
{
    twin.give(x, false);
}
inline void give(int x)
{
    twin.give(static_cast<uint>(x), false);
}
inline void give(bool x)
{
    twin.give(x ? 1u : 0u, false);
}
inline void give(float x)
{
    twin.give(floatBitsToUint(x), true);
}
inline void give(vec2 v)
{
    give(v.x), give(v.y);
}
inline void give(vec3 v)
{
    give(v.x), give(v.y), give(v.z);
}
inline void give(vec4 v)
{
    give(v.x), give(v.y), give(v.z), give(v.w);
}
inline void give(uvec2 v)
{
    give(v.x), give(v.y);
}
inline void give(uvec3 v)
{
    give(v.x), give(v.y), give(v.z);
}
inline void give(const Hit& h)
{
    give(h.t), give(h.u), give(h.v), give(h.primitive), give(h.instance);
}
inline void give(const Ray& r)
{
    give(r.origin), give(r.t_min), give(r.direction), give(r.t_max);
}

// A pattern of words (see twin_test.cpp) seen as an array type of SNELL_ARRAY.
template <class Array>
Array raw_as()
{
    Array array;
    array.at = static_cast<decltype(array.at)>(twin.raw);
    return array;
}
#define RAW(Array) raw_as<Array>()

#define TWIN(name, relative, absolute, outliers) if (twin.enter(#name, relative, absolute, outliers, false))
#define TWIN_BUILTIN(name, relative, absolute, outliers) if (twin.enter(#name, relative, absolute, outliers, true))

} // namespace snell
