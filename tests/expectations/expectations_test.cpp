// What `snell info` says is in a file, against what scripts find there that share nothing with our readers.
#include <gtest/gtest.h>

#include <sys/wait.h>

#include <array>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <iostream>
#include <string>

namespace snell {
namespace {

struct Outcome
{
    int code;
    std::string text; // stdout and stderr
};

// Runs check.py with these arguments.
Outcome check(const std::string& arguments)
{
    // No __pycache__ in the source tree.
    const std::string command = "PYTHONDONTWRITEBYTECODE=1 python3 '" SNELL_SOURCE_DIR
                                "/tests/expectations/check.py' '" SNELL_PROGRAM "' " +
                                arguments + " 2>&1";
    std::FILE* pipe = popen(command.c_str(), "r");
    if (pipe == nullptr) return {-1, "cannot start: " + command};
    Outcome outcome;
    std::array<char, 4096> buffer;
    for (std::size_t n; (n = std::fread(buffer.data(), 1, buffer.size(), pipe)) > 0;)
        outcome.text.append(buffer.data(), n);
    const int status = pclose(pipe);
    outcome.code = WIFEXITED(status) ? WEXITSTATUS(status) : -1;
    return outcome;
}

bool is_long()
{
    return std::getenv("SNELL_LONG") != nullptr;
}

// most_bytes: scenes larger than that are left out, but not in a long run.
void check_shared(const std::string& folder, const std::string& most_bytes, std::size_t least_scenes)
{
    const std::filesystem::path path = std::filesystem::path(SNELL_SOURCE_DIR) / ".." / folder;
    if (!std::filesystem::exists(path)) {
        std::cout << "left out: there is no ../" << folder << "\n";
        return;
    }
    const Outcome outcome = check("'" + path.string() + "'" + (is_long() ? "" : " --most-bytes " + most_bytes));
    EXPECT_EQ(outcome.code, 0) << outcome.text;
    // "N scenes, 0 of them differ": of which there must be many, or the script looked in the wrong place.
    const std::size_t at = outcome.text.rfind(" scenes, ");
    ASSERT_NE(at, std::string::npos) << outcome.text;
    const std::size_t line = outcome.text.rfind('\n', at) + 1; // 0 if there is none
    EXPECT_GE(std::stoul(outcome.text.substr(line, at - line)), least_scenes);
    std::cout << outcome.text;
}

TEST(Expectations, SmallScenesOfOurOwn)
{
    const Outcome outcome = check("own");
    EXPECT_EQ(outcome.code, 0) << outcome.text;
    EXPECT_NE(outcome.text.find("5 scenes, 0 of them differ"), std::string::npos) << outcome.text;
}

TEST(Expectations, ScenesBesideTheCheckout)
{
    check_shared("shared/scenes", "1e6", 80);
}

TEST(Expectations, ReferenceScenesBesideTheCheckout)
{
    check_shared("shared/reference/scenes", "1e8", 7);
}

} // namespace
} // namespace snell
