#include "snell/core/hash.h"
#include "snell/core/parallel.h"

#include <gtest/gtest.h>

#include <set>
#include <vector>

namespace snell::test {
namespace {

// What the author's program prints, as published with it: the empty text and texts of all tails.
TEST(Hash, IsMurmur3)
{
    const auto hash = [](const std::string& text, std::uint64_t seed = 0) {
        const Hash128 h = hash_bytes(text.data(), text.size(), seed);
        return h;
    };
    EXPECT_EQ(hash(""), (Hash128{0, 0}));
    EXPECT_EQ(hash("hello"), (Hash128{0xcbd8a7b341bd9b02u, 0x5b1e906a48ae1d19u}));
    EXPECT_EQ(hash("hello, world"), (Hash128{0x342fac623a5ebc8eu, 0x4cdcbc079642414du}));
    EXPECT_EQ(hash("19 Jan 2038 at 3:14:07 AM"), (Hash128{0xb89e5988b737affcu, 0x664fc2950231b2cbu}));
    EXPECT_EQ(hash("The quick brown fox jumps over the lazy dog."),
              (Hash128{0xcd99481f9ee902c9u, 0x695da1a38987b6e7u}));
    EXPECT_EQ(to_hex({1, 0xab}), "00000000000000ab0000000000000001");
}

// A hash of any length changes with every byte and with the length.
TEST(Hash, EveryByteCounts)
{
    std::vector<unsigned char> bytes(70, 7);
    std::set<std::string> seen;
    std::size_t made = 0;
    for (std::size_t size = 0; size <= bytes.size(); ++size, ++made)
        seen.insert(to_hex(hash_bytes(bytes.data(), size)));
    for (unsigned char& byte : bytes)
        for (int bit = 0; bit < 8; ++bit, ++made) {
            byte ^= static_cast<unsigned char>(1 << bit);
            seen.insert(to_hex(hash_bytes(bytes.data(), bytes.size())));
            byte ^= static_cast<unsigned char>(1 << bit);
        }
    EXPECT_EQ(seen.size(), made);
    EXPECT_NE(hash_bytes("a", 1, 1), hash_bytes("a", 1, 2));
}

TEST(Hash, InParallelIsTheSameForAnyNumberOfThreads)
{
    std::vector<unsigned char> bytes((std::size_t{5} << 20) + 3);
    for (std::size_t i = 0; i < bytes.size(); ++i) bytes[i] = static_cast<unsigned char>(i * i >> 7);
    set_thread_count(1);
    const Hash128 one = hash_in_parallel(bytes.data(), bytes.size());
    set_thread_count(5);
    EXPECT_EQ(hash_in_parallel(bytes.data(), bytes.size()), one);
    set_thread_count(0);
    for (const std::size_t at : {std::size_t{0}, std::size_t{1} << 20, bytes.size() - 1}) {
        bytes[at] ^= 1;
        EXPECT_NE(hash_in_parallel(bytes.data(), bytes.size()), one);
        bytes[at] ^= 1;
    }
    EXPECT_NE(hash_in_parallel(bytes.data(), bytes.size() - 1), one);
    EXPECT_NE(hash_in_parallel(nullptr, 0), one);
}

} // namespace
} // namespace snell::test
