// Lens prescriptions as text, whole and broken.
#include "snell/core/error.h"
#include "snell/io/lens_file.h"

#include <gtest/gtest.h>

#include <fstream>

namespace snell {
namespace {

LensPrescription read_lens(const std::string& text)
{
    const std::filesystem::path file = std::filesystem::path(testing::TempDir()) / "lens.txt";
    std::ofstream(file, std::ios::binary) << text;
    return load_lens(file);
}

TEST(LensFile, TheFilesOfTheProjectAreTheLensesItKnows)
{
    for (const LensPrescription& known : known_lenses()) {
        SCOPED_TRACE(known.name);
        const LensPrescription lens =
            load_lens(std::filesystem::path(SNELL_SOURCE_DIR) / "lenses" / (known.name + ".txt"));
        EXPECT_EQ(lens.name, known.name);
        ASSERT_EQ(lens.surfaces.size(), known.surfaces.size());
        for (std::size_t i = 0; i < lens.surfaces.size(); ++i) {
            EXPECT_EQ(lens.surfaces[i].radius, known.surfaces[i].radius) << i;
            EXPECT_EQ(lens.surfaces[i].thickness, known.surfaces[i].thickness) << i;
            EXPECT_EQ(lens.surfaces[i].eta, known.surfaces[i].eta) << i;
            EXPECT_EQ(lens.surfaces[i].diameter, known.surfaces[i].diameter) << i;
        }
    }
}

TEST(LensFile, WhatIsWrittenComesBack)
{
    for (LensPrescription lens : known_lenses()) {
        lens.name = "two\nlines";
        lens.surfaces[0].thickness = 1.0f / 3.0f; // takes all the digits that a float may
        lens.surfaces[0].diameter = 25.100002f;
        const std::filesystem::path file = std::filesystem::path(testing::TempDir()) / "written.txt";
        write_lens(lens, file);
        const LensPrescription back = load_lens(file);
        EXPECT_EQ(back.name, "written");
        EXPECT_EQ(back.surfaces, lens.surfaces);
    }
}

TEST(LensFile, CommentsGapsAndLineEndings)
{
    const LensPrescription lens = read_lens("# a lens\r\n\r\n100, 2 1.5\t40 # front\r\n-100 95 0 40");
    ASSERT_EQ(lens.surfaces.size(), 2u);
    EXPECT_EQ(lens.surfaces[0].radius, 100.0f);
    EXPECT_EQ(lens.surfaces[1].eta, 1.0f); // 0 is air
    EXPECT_EQ(lens.surfaces[1].diameter, 40.0f);
}

TEST(LensFile, BrokenOnesSayWhere)
{
    const std::pair<const char*, const char*> broken[] = {
        {"", "no surface"},
        {"# only words\n\n", "no surface"},
        {"100 2 1.5 40\n100 2 1.5\n", "lens.txt:2: a surface with 3 numbers"},
        {"100 2 1.5 40 7\n", "lens.txt:1: this is no surface"},
        {"100 2 glass 40\n", "lens.txt:1: this is no surface"},
        {"100 2 1.5x 40\n", "lens.txt:1: this is no surface"},
        {"100 nan 1.5 40\n", "lens.txt:1: this is no surface"},
        {"100 1e39 1.5 40\n", "lens.txt:1: this is no surface"},
        {"100 2 0.5 40\n", "lens.txt:1: an index of refraction of 0.5"},
        {"100 2 9 40\n", "lens.txt:1: an index of refraction of 9"},
        {"100 2 1.5 0\n", "lens.txt:1: a diameter of 0"},
        {"100 2 1.5 -3\n", "lens.txt:1: a diameter of -3"},
        {"10 2 1.5 40\n", "lens.txt:1: a diameter of 40 on a sphere of radius 10"},
        {"1e30 2 1.5 40\n", "lens.txt:1: a radius or thickness"},
        {"-100 2 1.5 40\n100 2 1 40\n", "does not gather light"},
        {"0 2 1 40\n", "does not gather light"},
    };
    for (const auto& [text, message] : broken) {
        SCOPED_TRACE(text);
        try {
            read_lens(text);
            ADD_FAILURE() << "was taken for a lens";
        } catch (const Error& error) {
            EXPECT_NE(std::string(error.what()).find(message), std::string::npos) << error.what();
        }
    }
    std::string many;
    for (int i = 0; i < 300; ++i) many += "100 2 1.5 40\n";
    EXPECT_THROW(read_lens(many), Error);
    EXPECT_THROW(load_lens("no/such/lens.txt"), Error);
}

} // namespace
} // namespace snell
