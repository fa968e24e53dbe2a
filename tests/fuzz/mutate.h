// Damages files in ways that are the same on every run.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace snell::hostile {

// PCG XSH-RR (O'Neill 2014).
class Random
{
  public:
    explicit Random(std::uint64_t seed) : state_(seed * 6364136223846793005u + 1442695040888963407u) {}

    std::uint32_t next();
    std::size_t below(std::size_t bound) // [0, bound); 0 for 0
    {
        return static_cast<std::size_t>((std::uint64_t(next()) * static_cast<std::uint64_t>(bound)) >> 32);
    }
    bool one_in(std::size_t n) { return below(n) == 0; }

  private:
    std::uint64_t state_;
};

// One of the seeds, damaged one to four times: bits and bytes, counts, blocks removed, doubled and swapped, lines,
// words and numbers of text, pieces of other seeds. format: a name of formats(); PNG files get right check sums again
// and GLB files right lengths, most of the time, so that not every reader stops at the door.
std::string mutate(const std::string& format, const std::vector<std::string>& seeds, Random& random);

// The check sums and lengths alone.
std::string repair(const std::string& format, std::string bytes);

} // namespace snell::hostile
