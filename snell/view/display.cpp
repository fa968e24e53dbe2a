#include "snell/view/display.h"

#include "snell/core/parallel.h"
#include "snell/kernel/tone.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>

namespace snell::view {

// ---- sRGB, by table ----

namespace {
// The sRGB byte of a value in [0, 1), by the upper bits of its float: 2^11 entries an octave keep it within 0.06 of a
// step. What is below the first octave is black.
class SrgbTable
{
  public:
    SrgbTable()
    {
        for (std::size_t i = 0; i < size; ++i) {
            const std::uint32_t low = first + (static_cast<std::uint32_t>(i) << shift);
            const float middle = std::bit_cast<float>(low + (1u << (shift - 1)));
            bytes_[i] = static_cast<std::uint8_t>(std::lround(255.0f * srgb_encode(middle)));
        }
    }

    std::uint32_t operator()(float x) const
    {
        // Also false for NaN.
        if (!(x >= smallest)) return 0;
        if (x >= 1.0f) return 255;
        return bytes_[(std::bit_cast<std::uint32_t>(x) - first) >> shift];
    }

  private:
    static constexpr int octaves = 13, shift = 12; // 23 - 11
    static constexpr float smallest = 1.0f / (1 << octaves);
    static constexpr std::uint32_t first = std::bit_cast<std::uint32_t>(smallest);
    static constexpr std::size_t size = (std::bit_cast<std::uint32_t>(1.0f) - first) >> shift;
    std::array<std::uint8_t, size> bytes_{};
};
} // namespace

static const SrgbTable& srgb_table()
{
    static const SrgbTable table;
    return table;
}

static std::uint32_t pack(const SrgbTable& table, vec3 linear)
{
    return table(linear.x) | table(linear.y) << 8 | table(linear.z) << 16 | 0xff000000u;
}

namespace {
// AgX by tables: powers and logarithms for each pixel would take ten times as long.
class AgxTables
{
  public:
    AgxTables()
    {
        for (std::size_t i = 0; i < curve_.size(); ++i) {
            const float x = std::bit_cast<float>(first + (static_cast<std::uint32_t>(i) << shift));
            curve_[i] = agx_sigmoid(clamp((std::log2(x) + 12.47393f) / 16.5f, 0.0f, 1.0f));
        }
        for (std::size_t i = 0; i < bytes_.size(); ++i) {
            const float y = (static_cast<float>(i) + 0.5f) / static_cast<float>(bytes_.size());
            bytes_[i] = static_cast<std::uint8_t>(std::lround(255.0f * srgb_encode(std::pow(y, 2.2f))));
        }
    }

    // The same matrices as tone_curve_agx().
    std::uint32_t operator()(vec3 c) const
    {
        const float x = curve(0.842479062f * c.x + 0.0784336f * c.y + 0.0792237451f * c.z);
        const float y = curve(0.0423282422f * c.x + 0.878468637f * c.y + 0.0791661275f * c.z);
        const float z = curve(0.0423756549f * c.x + 0.0784336f * c.y + 0.879142974f * c.z);
        return byte(1.196879f * x - 0.0980208811f * y - 0.0990297441f * z) |
               byte(-0.0528968518f * x + 1.15190313f * y - 0.0989611768f * z) << 8 |
               byte(-0.0529716355f * x - 0.0980434501f * y + 1.15107367f * z) << 16 | 0xff000000u;
    }

  private:
    float curve(float x) const
    {
        if (!(x > smallest)) return curve_[0];
        if (x >= largest) return 1.0f;
        const std::uint32_t bits = std::bit_cast<std::uint32_t>(x) - first;
        const float u = static_cast<float>(bits & ((1u << shift) - 1)) * (1.0f / (1u << shift));
        const std::size_t at = bits >> shift;
        return curve_[at] + u * (curve_[at + 1] - curve_[at]);
    }
    std::uint32_t byte(float y) const
    {
        const float at = clamp(y, 0.0f, 1.0f) * static_cast<float>(bytes_.size());
        return bytes_[std::min(static_cast<std::size_t>(at), bytes_.size() - 1)];
    }

    static constexpr int shift = 15; // 256 pieces an octave
    static constexpr float smallest = 1.0f / 8192.0f, largest = 32.0f;
    static constexpr std::uint32_t first = std::bit_cast<std::uint32_t>(smallest);
    std::array<float, ((std::bit_cast<std::uint32_t>(largest) - first) >> shift) + 1> curve_{};
    std::array<std::uint8_t, 8192> bytes_{};
};
} // namespace

static const AgxTables& agx_tables()
{
    static const AgxTables tables;
    return tables;
}

// Calls with(f), where f is the curve without a test of which one it is.
template <class With>
static void with_curve(uint curve, const With& with)
{
    switch (curve) {
    case tone_reinhard:
        return with([](vec3 c) { return tone_curve(c, tone_reinhard); });
    case tone_aces:
        return with([](vec3 c) { return tone_curve(c, tone_aces); });
    case tone_aces_hill:
        return with([](vec3 c) { return tone_curve_aces_hill(c); });
    case tone_neutral:
        return with([](vec3 c) { return tone_curve_neutral(c); });
    default:
        return with([](vec3 c) { return c; });
    }
}

void to_screen(const vec3* radiance, std::size_t count, const DisplaySettings& settings, std::uint32_t* to)
{
    const SrgbTable& table = srgb_table();
    const float scale = std::exp2(settings.exposure_ev);
    if (settings.curve == tone_agx) {
        const AgxTables& agx = agx_tables();
        for (std::size_t i = 0; i < count; ++i) to[i] = agx(scale * max(radiance[i], vec3(0.0f)));
        return;
    }
    with_curve(settings.curve, [&](auto&& curve) {
        for (std::size_t i = 0; i < count; ++i) to[i] = pack(table, curve(scale * max(radiance[i], vec3(0.0f))));
    });
}

// ---- from films ----

static vec3 mean(const Film& film, std::size_t pixel)
{
    const uint n = film.sample_count[pixel];
    return n == 0 ? vec3(0.0f) : film.sum[pixel] * (1.0f / static_cast<float>(n));
}

// Bilinear, at (x, y) in [0, 1].
static vec3 enlarged(const Film& film, float x, float y)
{
    const float px = std::clamp(x * static_cast<float>(film.width) - 0.5f, 0.0f, static_cast<float>(film.width - 1));
    const float py = std::clamp(y * static_cast<float>(film.height) - 0.5f, 0.0f, static_cast<float>(film.height - 1));
    const int x0 = static_cast<int>(px), y0 = static_cast<int>(py);
    const int x1 = std::min(x0 + 1, film.width - 1), y1 = std::min(y0 + 1, film.height - 1);
    const float u = px - static_cast<float>(x0), v = py - static_cast<float>(y0);
    const auto at = [&](int column, int row) {
        return mean(film, static_cast<std::size_t>(row) * static_cast<std::size_t>(film.width) +
                              static_cast<std::size_t>(column));
    };
    return mix(mix(at(x0, y0), at(x1, y0), u), mix(at(x0, y1), at(x1, y1), u), v);
}

void to_screen(const Shot& shot, const DisplaySettings& settings, ScreenPicture& to)
{
    const Film& film = shot.film;
    to.width = film.width, to.height = film.height;
    const auto width = static_cast<std::size_t>(film.width), height = static_cast<std::size_t>(film.height);
    to.texels.resize(width * height);
    const DisplaySettings shown = shot.is_data ? DisplaySettings{} : settings;
    const Film* under = shot.spp == 0 && shot.under != nullptr ? &shot.under->film : nullptr;
    constexpr std::size_t rows = 32; // a piece of work worth handing to a thread
    parallel_ranges(height, rows, [&](std::size_t begin, std::size_t end) {
        std::vector<vec3> row(width);
        for (std::size_t y = begin; y < end; ++y) {
            const std::size_t first = y * width;
            for (std::size_t x = 0; x < width; ++x) {
                if (under != nullptr && film.sample_count[first + x] == 0)
                    row[x] = enlarged(*under, (static_cast<float>(x) + 0.5f) / static_cast<float>(width),
                                      (static_cast<float>(y) + 0.5f) / static_cast<float>(height));
                else
                    row[x] = mean(film, first + x);
            }
            to_screen(row.data(), width, shown, to.texels.data() + first);
        }
    });
}

} // namespace snell::view
