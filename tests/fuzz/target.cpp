// libFuzzer's entry: FUZZ_FORMAT names the format. A crash, a leak, a report of a sanitizer, any exception but Error,
// and whatever takes too long or too much memory ends it; tests/fuzz/run shows how it is called.
//
// FUZZ_SEEDS=FOLDER writes the format's seeds there and ends.
#include "formats.h"
#include "mutate.h"
#include "seeds.h"

#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <fstream>

namespace hostile = snell::hostile;

extern "C" std::size_t LLVMFuzzerMutate(std::uint8_t* data, std::size_t size, std::size_t max_size);

// OpenEXR 3.1's RgbaInputFile loses what it has allocated, some kilobytes, when its constructor throws: not ours to
// mend.
extern "C" const char* __lsan_default_suppressions();
extern "C" const char* __lsan_default_suppressions()
{
    return "leak:Imf_3_1::RgbaInputFile::RgbaInputFile\n";
}

static const hostile::Format& chosen()
{
    static const hostile::Format* const format = [] {
        const char* const name = std::getenv("FUZZ_FORMAT");
        const hostile::Format* const found = name != nullptr ? hostile::find_format(name) : nullptr;
        if (found == nullptr) {
            std::string names;
            for (const hostile::Format& f : hostile::formats()) names += " " + f.name;
            std::fprintf(stderr, "set FUZZ_FORMAT to one of:%s\n", names.c_str());
            std::exit(2);
        }
        return found;
    }();
    return *format;
}

extern "C" int LLVMFuzzerInitialize(int*, char***)
{
    chosen();
    if (const char* const folder = std::getenv("FUZZ_SEEDS")) {
        std::filesystem::create_directories(folder);
        for (const hostile::Seed& seed : hostile::seeds(chosen()))
            std::ofstream(std::filesystem::path(folder) / seed.name, std::ios::binary) << seed.bytes;
        std::exit(0);
    }
    return 0;
}

extern "C" std::size_t LLVMFuzzerCustomMutator(std::uint8_t* data, std::size_t size, std::size_t max_size,
                                               unsigned seed)
{
    // Half libFuzzer's changes, half our own, which know of numbers, words and lines.
    hostile::Random random(seed);
    std::string bytes;
    if (random.one_in(2)) {
        bytes = hostile::mutate(chosen().name, {{reinterpret_cast<const char*>(data), size}}, random);
    } else {
        const std::size_t changed = LLVMFuzzerMutate(data, size, max_size);
        bytes.assign(reinterpret_cast<const char*>(data), changed);
        if (!random.one_in(8)) bytes = hostile::repair(chosen().name, std::move(bytes));
    }
    const std::size_t result = std::min(max_size, bytes.size());
    std::memcpy(data, bytes.data(), result);
    return result;
}

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size)
{
    static const hostile::Nest nest(chosen());
    nest.put({reinterpret_cast<const char*>(data), size});
    (void)nest.open();
    return 0;
}
