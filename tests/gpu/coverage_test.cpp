// Nothing in snell/kernel/ escapes the twin test: every function is called by a case, every struct with a SNELL_LAYOUT
// is read back in cases/layout.inl.
#include <gtest/gtest.h>

#include <cctype>
#include <filesystem>
#include <fstream>
#include <map>
#include <set>
#include <sstream>
#include <string>
#include <vector>

namespace snell {
namespace {
// Functions that need no case of their own. Keep this short, and say why.
const std::map<std::string, std::string> excused = {};

const std::filesystem::path root = SNELL_SOURCE_DIR;

// The words and punctuation marks of a file, comments left out.
std::vector<std::string> tokens_of(const std::filesystem::path& path)
{
    std::ifstream file(path);
    EXPECT_TRUE(file) << path;
    std::vector<std::string> tokens;
    std::string line;
    while (std::getline(file, line)) {
        line = line.substr(0, line.find("//"));
        bool in_word = false;
        for (char c : line) {
            const bool word = std::isalnum(static_cast<unsigned char>(c)) || c == '_';
            if (word && in_word)
                tokens.back() += c;
            else if (!std::isspace(static_cast<unsigned char>(c)))
                tokens.emplace_back(1, c);
            in_word = word;
        }
    }
    return tokens;
}

// Words that stand before an opening parenthesis.
std::set<std::string> called_in(const std::vector<std::string>& tokens)
{
    std::set<std::string> names;
    for (std::size_t i = 1; i < tokens.size(); ++i)
        if (tokens[i] == "(") names.insert(tokens[i - 1]);
    return names;
}

std::vector<std::filesystem::path> files_in(const char* folder, const char* extension)
{
    std::vector<std::filesystem::path> paths;
    for (const auto& entry : std::filesystem::directory_iterator(root / folder))
        if (entry.path().extension() == extension) paths.push_back(entry.path());
    return paths;
}

TEST(TwinCoverage, EveryKernelFunctionHasACase)
{
    std::set<std::string> called = called_in(tokens_of(root / "tests/gpu/draw.h"));
    for (const auto& path : files_in("tests/gpu/cases", ".inl")) called.merge(called_in(tokens_of(path)));

    std::size_t functions = 0;
    for (const auto& path : files_in("snell/kernel", ".h")) {
        const std::vector<std::string> tokens = tokens_of(path);
        for (std::size_t i = 1; i + 3 < tokens.size(); ++i) { // SNELL_FN Type name (
            if ((tokens[i] != "SNELL_FN" && tokens[i] != "SNELL_FN_COLD") || tokens[i - 1] == "define") continue;
            EXPECT_EQ(tokens[i + 3], "(") << path.filename() << ": cannot read the function after " << tokens[i + 2];
            const std::string& name = tokens[i + 2];
            ++functions;
            EXPECT_TRUE(called.count(name) || excused.count(name))
                << path.filename() << ": " << name << " has no case in tests/gpu/cases; add one";
        }
    }
    EXPECT_GT(functions, 100u);
    for (const auto& [name, reason] : excused)
        EXPECT_FALSE(called.count(name)) << name << " is excused (" << reason << ") but has a case";
}

TEST(TwinCoverage, EveryStructThatCrossesIsReadBack)
{
    const std::vector<std::string> layout = tokens_of(root / "tests/gpu/cases/layout.inl");
    const std::set<std::string> named(layout.begin(), layout.end());
    std::size_t structs = 0;
    for (const auto& path : files_in("snell/kernel", ".h")) {
        const std::vector<std::string> tokens = tokens_of(path);
        for (std::size_t i = 1; i + 2 < tokens.size(); ++i) {
            if (tokens[i] != "SNELL_LAYOUT" || tokens[i - 1] == "define") continue;
            ++structs;
            EXPECT_TRUE(named.count(tokens[i + 2]))
                << path.filename() << ": " << tokens[i + 2] << " has no case in tests/gpu/cases/layout.inl; add one";
        }
    }
    EXPECT_GT(structs, 10u);
}
} // namespace
} // namespace snell
