#include "snell/core/hash.h"

#include "snell/core/parallel.h"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cstring>
#include <vector>

namespace snell {
namespace {

constexpr std::uint64_t c1 = 0x87c37b91114253d5u, c2 = 0x4cf5ad432745937fu;

// The algorithm reads little-endian words.
std::uint64_t load(const unsigned char* from, std::size_t size)
{
    std::uint64_t word = 0;
    if constexpr (std::endian::native == std::endian::little) {
        std::memcpy(&word, from, size);
    } else {
        for (std::size_t i = 0; i < size; ++i) word |= std::uint64_t{from[i]} << (8 * i);
    }
    return word;
}

std::uint64_t mix_low(std::uint64_t k)
{
    return std::rotl(k * c1, 31) * c2;
}

std::uint64_t mix_high(std::uint64_t k)
{
    return std::rotl(k * c2, 33) * c1;
}

// Every bit of the input changes every bit of the output with a probability of about one half.
std::uint64_t finish(std::uint64_t h)
{
    h = (h ^ (h >> 33)) * 0xff51afd7ed558ccdu;
    h = (h ^ (h >> 33)) * 0xc4ceb9fe1a85ec53u;
    return h ^ (h >> 33);
}

} // namespace

Hash128 hash_bytes(const void* bytes, std::size_t size, std::uint64_t seed)
{
    const auto* at = static_cast<const unsigned char*>(bytes);
    std::uint64_t low = seed, high = seed;
    std::size_t left = size;
    for (; left >= 16; at += 16, left -= 16) {
        low = (std::rotl(low ^ mix_low(load(at, 8)), 27) + high) * 5 + 0x52dce729;
        high = (std::rotl(high ^ mix_high(load(at + 8, 8)), 31) + low) * 5 + 0x38495ab5;
    }
    if (left > 8) high ^= mix_high(load(at + 8, left - 8));
    if (left > 0) low ^= mix_low(load(at, std::min<std::size_t>(left, 8)));
    low ^= size, high ^= size;
    low += high, high += low;
    low = finish(low), high = finish(high);
    low += high, high += low;
    return {low, high};
}

Hash128 hash_blocks(std::size_t count, const std::function<Hash128(std::size_t block)>& hash_block)
{
    std::vector<Hash128> blocks(count);
    parallel_for(count, [&](std::size_t i) { blocks[i] = hash_block(i); });
    return hash_bytes(blocks.data(), blocks.size() * sizeof(Hash128), count);
}

Hash128 hash_in_parallel(const void* bytes, std::size_t size)
{
    constexpr std::size_t block = std::size_t{1} << 20;
    const auto* first = static_cast<const unsigned char*>(bytes);
    return hash_blocks((size + block - 1) / block, [&](std::size_t i) {
        return hash_bytes(first + i * block, std::min(block, size - i * block), i);
    });
}

std::string to_hex(const Hash128& hash)
{
    return fmt::format("{:016x}{:016x}", hash.high, hash.low);
}

} // namespace snell
