// --accel embree and --accel-cache.
#include "program.h"

#include <gtest/gtest.h>

#include <fstream>

namespace snell::test {
namespace {

namespace fs = std::filesystem;

// A scene whose tree is large enough to be kept.
const std::vector<std::string> render_field = {"render", "field:6000", "--size", "16x16", "--spp",
                                               "1",      "-o",         "a.pfm",  "-v",    "--accel-cache"};

Outcome render_with(Program& program, const std::string& folder)
{
    std::vector<std::string> arguments = render_field;
    arguments.push_back(folder);
    return program.run(arguments);
}

std::string read(const fs::path& file)
{
    std::ifstream in(file, std::ios::binary);
    return {std::istreambuf_iterator<char>(in), {}};
}

TEST(AccelCache, KeepsTreesAndReplacesDamagedOnes)
{
    Program program;
    const Outcome first = render_with(program, "trees");
    ASSERT_EQ(first.code, 0) << first.err;
    EXPECT_EQ(first.err.find("from the cache"), std::string::npos) << first.err;
    const std::string picture = read(program.folder() / "a.pfm");
    std::vector<fs::path> trees;
    for (const auto& entry : fs::directory_iterator(program.folder() / "trees")) trees.push_back(entry.path());
    ASSERT_EQ(trees.size(), 1u);
    EXPECT_EQ(trees[0].extension(), ".snelltree");

    const Outcome second = render_with(program, "trees");
    ASSERT_EQ(second.code, 0) << second.err;
    EXPECT_NE(second.err.find("trees from the cache: 1"), std::string::npos) << second.err;
    EXPECT_EQ(read(program.folder() / "a.pfm"), picture);

    fs::resize_file(trees[0], fs::file_size(trees[0]) / 2);
    const Outcome third = render_with(program, "trees");
    ASSERT_EQ(third.code, 0) << third.err;
    EXPECT_NE(third.err.find("damaged files in the cache of trees, now replaced: 1"), std::string::npos) << third.err;
    EXPECT_EQ(read(program.folder() / "a.pfm"), picture);
    EXPECT_NE(render_with(program, "trees").err.find("trees from the cache: 1"), std::string::npos);
}

TEST(AccelCache, FolderThatCannotBeWrittenIsNamed)
{
    Program program;
    program.write("file", "not a folder");
    const Outcome outcome = render_with(program, "file");
    EXPECT_EQ(outcome.code, 1);
    EXPECT_NE(outcome.err.find("file: the folder for trees cannot be made"), std::string::npos) << outcome.err;
}

TEST(Embree, RendersOrSaysWhatToInstall)
{
    Program program;
    const Outcome list = program.run({"list"});
    EXPECT_NE(list.out.find("  embree "), std::string::npos) << list.out;
    const Outcome outcome =
        program.run({"render", "cornell", "--size", "16x16", "--spp", "1", "--accel", "embree", "-o", "a.pfm"});
#ifdef SNELL_HAS_EMBREE
    ASSERT_EQ(outcome.code, 0) << outcome.err;
    ASSERT_EQ(program.run({"render", "cornell", "--size", "16x16", "--spp", "1", "-o", "b.pfm"}).code, 0);
    EXPECT_EQ(read(program.folder() / "a.pfm"), read(program.folder() / "b.pfm"));
#else
    EXPECT_EQ(outcome.code, 1);
    EXPECT_NE(outcome.err.find("libembree-dev"), std::string::npos) << outcome.err;
    EXPECT_EQ(program.files(), std::vector<std::string>{});
#endif
}

} // namespace
} // namespace snell::test
