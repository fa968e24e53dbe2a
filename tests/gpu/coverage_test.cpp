// Every function of snell/kernel/ must be called by some case of the twin test.
#include "snell/core/error.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <map>
#include <regex>
#include <set>
#include <sstream>

namespace snell {
namespace {
// Functions that need no case of their own. Keep this short, and say why.
const std::map<std::string, std::string> excused = {};

const std::string root = SNELL_SOURCE_DIR;

std::string read_without_comments(const std::filesystem::path& path)
{
    std::ifstream file(path);
    std::stringstream text;
    text << file.rdbuf();
    return std::regex_replace(text.str(), std::regex("//[^\n]*"), "");
}

std::set<std::string> matches(const std::string& text, const std::regex& pattern)
{
    std::set<std::string> found;
    for (std::sregex_iterator i(text.begin(), text.end(), pattern), end; i != end; ++i) found.insert((*i)[1]);
    return found;
}

TEST(TwinCoverage, EveryKernelFunctionHasACase)
{
    std::string cases = read_without_comments(root + "/tests/gpu/draw.h");
    for (const auto& entry : std::filesystem::directory_iterator(root + "/tests/gpu/cases"))
        if (entry.path().extension() == ".inl") cases += read_without_comments(entry.path());
    const std::set<std::string> called = matches(cases, std::regex("\\b([a-z]\\w*)\\s*\\("));

    std::size_t functions = 0;
    for (const auto& entry : std::filesystem::directory_iterator(root + "/snell/kernel")) {
        if (entry.path().extension() != ".h") continue;
        const std::string header = read_without_comments(entry.path());
        // SNELL_FN Type name(
        for (const std::string& name : matches(header, std::regex("\\bSNELL_FN(?:_COLD)?\\s+\\w+\\s+(\\w+)\\s*\\("))) {
            ++functions;
            if (excused.count(name)) continue;
            EXPECT_TRUE(called.count(name))
                << entry.path().filename() << ": " << name << " has no case in tests/gpu/cases; add one";
        }
    }
    EXPECT_GT(functions, 10u);
    for (const auto& [name, reason] : excused)
        EXPECT_FALSE(called.count(name)) << name << " is excused (" << reason << ") but has a case";
}
} // namespace
} // namespace snell
