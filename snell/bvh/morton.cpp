#include "snell/bvh/morton.h"

#include "snell/bvh/extents.h"
#include "snell/core/error.h"
#include "snell/core/parallel.h"
#include "snell/kernel/lang.h"

#include <hwy/cache_control.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <vector>

namespace snell {
namespace {

constexpr std::size_t grain = 1 << 14;
constexpr std::size_t ahead = 32;           // references to ask for in advance: the hardware stops at every page
constexpr std::size_t sort_chunk = 1 << 16; // keys that are counted together
constexpr int digit_bits = 11;              // 2048 places to write to at once: about what the TLB and L1 bear
constexpr std::size_t digits = std::size_t{1} << digit_bits;
constexpr std::size_t tiny = 512; // below, the histograms would cost more than the sorting

Vec4 load_quarter(const PrimitiveRef& ref)
{
    const Vec4 quarter = hn::Set(Lanes4(), 0.25f);
    return hn::Add(hn::Mul(load3(ref.lower), quarter), hn::Mul(load3(ref.upper), quarter));
}

std::uint64_t digit_source(std::uint64_t key)
{
    return key;
}
std::uint64_t digit_source(const MortonKey& key)
{
    return key.code;
}

// One stable pass by up to digit_bits bits.
template <class Key>
void sort_digit(const Scratch<Key>& from, Scratch<Key>& to, int shift, int bits)
{
    const std::size_t chunks = (from.size() + sort_chunk - 1) / sort_chunk;
    const std::uint64_t mask = (std::uint64_t{1} << bits) - 1;
    using Places = std::array<std::uint32_t, digits>;
    std::vector<Places> places(chunks);
    const auto for_chunks = [&](const auto& body) {
        parallel_for(chunks, [&](std::size_t chunk) {
            const std::size_t begin = chunk * sort_chunk;
            body(places[chunk], std::span(from.data() + begin, std::min(sort_chunk, from.size() - begin)));
        });
    };
    for_chunks([&](Places& counts, std::span<const Key> keys) {
        for (const Key& key : keys) ++counts[digit_source(key) >> shift & mask];
    });
    std::uint32_t sum = 0;
    for (std::size_t digit = 0; digit <= mask; ++digit)
        for (Places& counts : places) sum += std::exchange(counts[digit], sum);
    for_chunks([&](Places& next, std::span<const Key> keys) {
        for (const Key& key : keys) to[next[digit_source(key) >> shift & mask]++] = key;
    });
}

template <class Key>
void radix_sort_keys(Scratch<Key>& keys, Scratch<Key>& scratch, int first, int count)
{
    SNELL_CHECK_EQ(keys.size(), scratch.size());
    const int passes = (count + digit_bits - 1) / digit_bits;
    for (int pass = 0; pass < passes; ++pass) {
        const int from = count * pass / passes, to = count * (pass + 1) / passes;
        sort_digit(keys, scratch, first + from, to - from);
        keys.swap(scratch);
    }
}

struct Survey
{
    Box quarters; // of quarter_centre()
    uint kinds = 0;
};

Survey survey(std::span<const PrimitiveRef> refs)
{
    std::vector<Survey> parts((refs.size() + grain - 1) / grain);
    parallel_for(parts.size(), [&](std::size_t part) {
        Vec4 lower = hn::Set(Lanes4(), infinity()), upper = hn::Neg(lower);
        uint kinds = 0;
        for (std::size_t i = part * grain; i < std::min(refs.size(), (part + 1) * grain); ++i) {
            hwy::Prefetch(&refs[std::min(i + ahead, refs.size() - 1)]);
            const Vec4 c = load_quarter(refs[i]);
            lower = hn::Min(lower, c);
            upper = hn::Max(upper, c);
            kinds |= 1u << static_cast<uint>(refs[i].kind);
        }
        alignas(16) float lo[4], hi[4];
        hn::Store(lower, Lanes4(), lo);
        hn::Store(upper, Lanes4(), hi);
        parts[part] = {{vec3(lo[0], lo[1], lo[2]), vec3(hi[0], hi[1], hi[2])}, kinds};
    });
    Survey all;
    for (const Survey& part : parts) {
        all.quarters.extend(part.quarters);
        all.kinds |= part.kinds;
    }
    return all;
}

template <class Key, class MakeKey>
Scratch<Key> make_keys(std::span<const PrimitiveRef> refs, const MakeKey& make_key)
{
    Scratch<Key> keys(refs.size());
    parallel_ranges(refs.size(), grain, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) {
            hwy::Prefetch(&refs[std::min(i + ahead, refs.size() - 1)]);
            keys[i] = make_key(i);
        }
    });
    return keys;
}

// Whether most neighbours lie in the same cell. A few are no harm: indices often run along the surface too, and no code
// tells the halves of a rectangle apart.
bool is_crowded(const Scratch<std::uint64_t>& keys, int index_bits)
{
    std::vector<std::size_t> same((keys.size() + grain - 1) / grain);
    parallel_for(same.size(), [&](std::size_t part) {
        const std::size_t end = std::min(keys.size(), (part + 1) * grain);
        for (std::size_t i = std::max<std::size_t>(part * grain, 1); i < end; ++i)
            same[part] += ((keys[i] ^ keys[i - 1]) >> index_bits) == 0;
    });
    std::size_t sum = 0;
    for (const std::size_t s : same) sum += s;
    return sum > keys.size() / 2;
}

} // namespace

MortonGrid::MortonGrid(const Box& quarters, int bits) : bits_(bits)
{
    SNELL_CHECK_LT(0, bits);
    SNELL_CHECK_LT(bits, 64);
    int used[3] = {};
    double cell[3];
    for (int axis = 0; axis < 3; ++axis) cell[axis] = quarters.empty() ? 0 : quarters.extent()[axis];
    std::array<int, 64> axis_of{}; // by bit of the code
    for (int bit = bits - 1; bit >= 0; --bit) {
        int longest = -1;
        for (int axis = 0; axis < 3; ++axis)
            if (used[axis] < bits_per_axis && (longest < 0 || cell[axis] > cell[longest])) longest = axis;
        axis_of[static_cast<std::size_t>(bit)] = longest;
        cell[longest] /= 2;
        ++used[longest];
    }
    spread_ = {};
    int seen[3] = {};
    for (int bit = 0; bit < bits; ++bit) {
        const auto axis = static_cast<std::size_t>(axis_of[static_cast<std::size_t>(bit)]);
        const int own = seen[axis]++; // the bit of the cell's number along the axis
        auto& table = spread_[axis][static_cast<std::size_t>(own / 8)];
        for (std::size_t value = 0; value < 256; ++value)
            if (value >> (own % 8) & 1) table[value] |= std::uint64_t{1} << bit;
    }
    for (int axis = 0; axis < 3; ++axis) {
        const float cells = std::ldexp(1.0f, used[axis]), width = quarters.extent()[axis];
        const float scale = cells / width;
        origin_[axis] = quarters.empty() ? 0.0f : quarters.lower[axis];
        scale_[axis] = width > 0.0f && is_finite(width) && is_finite(scale) ? scale : 0.0f;
        last_[axis] = cells - 1.0f;
    }
}

std::uint64_t MortonGrid::code(const PrimitiveRef& ref) const
{
    const hn::RebindToSigned<Lanes4> di;
    const Vec4 x = hn::Mul(hn::Sub(load_quarter(ref), hn::Load(Lanes4(), origin_)), hn::Load(Lanes4(), scale_));
    alignas(16) std::int32_t cell[4];
    hn::Store(hn::ConvertTo(di, hn::Max(hn::Min(x, hn::Load(Lanes4(), last_)), hn::Zero(Lanes4()))), di, cell);
    std::uint64_t code = 0;
    for (std::size_t axis = 0; axis < 3; ++axis) {
        const auto c = static_cast<std::uint32_t>(cell[axis]);
        code |= spread_[axis][0][c & 255] | spread_[axis][1][c >> 8 & 255] | spread_[axis][2][c >> 16];
    }
    return code;
}

MortonOrder sort_by_morton(std::span<const PrimitiveRef> refs)
{
    SNELL_CHECK_LT(refs.size(), std::size_t{1} << 30);
    MortonOrder order;
    if (refs.empty()) return order;
    const auto [quarters, kinds] = survey(refs);
    order.kinds = kinds;
    order.index_bits = static_cast<int>(std::bit_width(refs.size() - 1));
    const int room = 64 - order.index_bits;
    const MortonGrid grid(quarters, std::min(room, refs.size() < (1 << 18) ? 3 * digit_bits : 4 * digit_bits));
    order.packed = make_keys<std::uint64_t>(refs, [&](std::size_t i) {
        // The shift is below 64: one reference alone has no bits of index, but its code has far fewer than 64.
        return grid.code(refs[i]) << order.index_bits | i;
    });
    if (refs.size() <= tiny) {
        std::sort(order.packed.data(), order.packed.data() + refs.size());
    } else {
        Scratch<std::uint64_t> scratch(refs.size());
        radix_sort(order.packed, scratch, order.index_bits, grid.bits());
    }
    if (!is_crowded(order.packed, order.index_bits)) return order;

    const MortonGrid fine(quarters, 63);
    order.wide = make_keys<MortonKey>(refs, [&](std::size_t i) {
        return MortonKey{fine.code(refs[i]), static_cast<std::uint32_t>(i)};
    });
    order.packed = {};
    Scratch<MortonKey> scratch(refs.size());
    radix_sort(order.wide, scratch, 0, fine.bits());
    return order;
}

void radix_sort(Scratch<std::uint64_t>& keys, Scratch<std::uint64_t>& scratch, int first, int count)
{
    radix_sort_keys(keys, scratch, first, count);
}

void radix_sort(Scratch<MortonKey>& keys, Scratch<MortonKey>& scratch, int first, int count)
{
    radix_sort_keys(keys, scratch, first, count);
}

} // namespace snell
