// A hash of many bytes, for telling contents apart; no protection against somebody who wants two to be alike.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <string>

namespace snell {

struct Hash128
{
    std::uint64_t low = 0, high = 0;
    bool operator==(const Hash128&) const = default;
};

// MurmurHash3_x64_128 (Appleby 2011, who has put it into the public domain), with a seed for both halves.
Hash128 hash_bytes(const void* bytes, std::size_t size, std::uint64_t seed = 0);

// A hash of the hashes of blocks, which are computed in parallel; the same for any number of threads.
Hash128 hash_blocks(std::size_t count, const std::function<Hash128(std::size_t block)>& hash_block);

// hash_bytes() in blocks of one MiB: another number than hash_bytes(), in a part of the time.
Hash128 hash_in_parallel(const void* bytes, std::size_t size);

// 32 digits, the high half first.
std::string to_hex(const Hash128& hash);

} // namespace snell
