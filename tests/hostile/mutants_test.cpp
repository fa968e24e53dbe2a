// Broken files of every format: never a crash, a hang or a huge allocation, always a scene, a picture, or an Error that
// says which file and where. SNELL_LONG=1 takes 50 times as many.
#include "mutate.h"
#include "opened.h"
#include "seeds.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <regex>

namespace snell::hostile {

namespace {

// "file:12: ...", or a part of a glTF file: "file; accessor 3 ...".
bool has_place(const Error& error)
{
    static const std::regex place("^[^:;]*(:[0-9]+:|; ?[a-z ]+ [0-9]+)");
    return error.place.line > 0 || std::regex_search(error.what(), place);
}

std::size_t mutant_count()
{
    return std::getenv("SNELL_LONG") != nullptr ? 10000 : 240;
}

} // namespace

class Broken : public testing::TestWithParam<std::string>
{
};

TEST_P(Broken, seeds_are_good)
{
    const Format& format = *find_format(GetParam());
    const Nest nest(format);
    for (const Seed& seed : seeds(format)) {
        const Opened opened = open_checked(format, nest, seed.bytes, seed.name);
        if (seed.is_good && opened.error) ADD_FAILURE() << seed.name << ": " << opened.error->what();
    }
}

TEST_P(Broken, cut_off_anywhere)
{
    const Format& format = *find_format(GetParam());
    const Nest nest(format);
    const std::vector<Seed> all = seeds(format);
    const std::size_t cuts = std::max<std::size_t>(8, mutant_count() / all.size());
    for (const Seed& seed : all) {
        const std::size_t step = std::max<std::size_t>(1, seed.bytes.size() / cuts);
        for (std::size_t size = 0; size < seed.bytes.size(); size += step)
            open_checked(format, nest, seed.bytes.substr(0, size), seed.name + " cut at " + std::to_string(size));
    }
}

TEST_P(Broken, mutants)
{
    const Format& format = *find_format(GetParam());
    const Nest nest(format);
    std::vector<std::string> from;
    for (const Seed& seed : seeds(format)) from.push_back(seed.bytes);
    std::size_t good = 0, bad = 0, without_place = 0, peak = 0;
    double longest = 0;
    std::string example; // of an error without a place
    for (std::size_t i = 0; i < mutant_count(); ++i) {
        Random random(i);
        const std::string bytes = mutate(format.name, from, random);
        const Opened opened = open_checked(format, nest, bytes, "mutant " + std::to_string(i));
        peak = std::max(peak, opened.peak_bytes);
        longest = std::max(longest, opened.seconds);
        ++(opened.error ? bad : good);
        if (opened.error && format.is_text && !has_place(*opened.error)) {
            ++without_place;
            example = opened.error->what();
        }
    }
    std::cout << format.name << ": " << good << " opened, " << bad << " refused, at most " << peak / 1024 << " KiB and "
              << longest * 1000 << " ms" << std::endl;
    // What is wrong with a file as a whole, such as one without faces, has no place in it.
    EXPECT_LE(without_place * 2, bad) << without_place << " of " << bad
                                      << " errors have no place, such as: " << example;
    // Both must happen, or the mutants are too wild or too tame to test anything.
    EXPECT_GT(good, 0u);
    const bool is_lenient = format.name == "mtl"; // what is no material there becomes a note
    EXPECT_EQ(bad > 0, !is_lenient);
}

INSTANTIATE_TEST_SUITE_P(Formats, Broken, testing::ValuesIn([] {
                             std::vector<std::string> names;
                             for (const Format& format : formats()) names.push_back(format.name);
                             return names;
                         }()),
                         [](const auto& format) { return format.param; });

} // namespace snell::hostile
