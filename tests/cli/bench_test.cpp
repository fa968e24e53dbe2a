// snell bench accel and snell info --bvh, with so few rays that their figures mean nothing.
#include "program.h"

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <fstream>
#include <sstream>

namespace snell::test {
namespace {

using nlohmann::json;

std::string read(const std::filesystem::path& file)
{
    std::ostringstream text;
    text << std::ifstream(file).rdbuf();
    return text.str();
}

json read_json(const std::filesystem::path& file)
{
    return json::parse(read(file), nullptr, false);
}

const std::vector<std::string> sets = {"camera", "shadow", "ao", "bounce1", "bounce2", "bounce3"};

bool has_embree(const json& report)
{
    for (const json& row : report.at("scenes").at(0).at("rows"))
        if (row.at("kind") == "embree") return true;
    return false;
}

Outcome bench(Program& program, std::vector<std::string> more)
{
    std::vector<std::string> arguments = {"bench", "accel", "--rays", "2048", "--runs", "1", "--no-refit"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return program.run(arguments);
}

TEST(BenchAccel, MeasuresAllStructuresAndWritesThemDown)
{
    Program program;
    const Outcome outcome =
        bench(program, {"field:1000", "cornell", "--json", "a.json", "--html", "a.html", "--no-path"});
    ASSERT_EQ(outcome.code, 0) << outcome.err;
    for (const std::string& set : sets) EXPECT_NE(outcome.out.find(set), std::string::npos) << set;
    EXPECT_NE(outcome.out.find("Summary"), std::string::npos);

    const json report = read_json(program.folder() / "a.json");
    for (const char* key : {"version", "commit", "compiler", "threads", "runs", "quick", "summary",
                            "summary_all_threads", "scenes", "growth", "path", "refit", "failures"})
        EXPECT_TRUE(report.contains(key)) << key;
    EXPECT_EQ(report.at("failures"), json::array());
    ASSERT_EQ(report.at("scenes").size(), 2u);
    const json& scene = report.at("scenes").at(0);
    EXPECT_EQ(scene.at("scene"), "field:1000");
    EXPECT_GE(scene.at("triangles"), 1000);
    std::size_t ours = 0, builders = 0;
    for (const json& row : scene.at("rows")) {
        EXPECT_GT(row.at("bytes"), 0) << row.at("name");
        EXPECT_GT(row.at("build_seconds").at("median"), 0.0) << row.at("name");
        const json& figures = row.at("mrays_per_second");
        for (const std::string& set : sets) {
            if (!figures.contains(set)) {
                EXPECT_GT(row.at("rays_a_call"), 1) << "only packets are spared the bounces";
                continue;
            }
            const json& figure = figures.at(set);
            EXPECT_GT(figure.at("one_thread").at("median"), 0.0);
            EXPECT_GT(figure.at("all_threads").at("median"), 0.0);
            EXPECT_GT(figure.at("wall").at("median"), 0.0);
        }
        if (row.at("kind") != "snell") continue;
        ours += 1;
        builders += row.at("accel") == "bvh8" && row.at("traversal") == "auto";
        for (const std::string& set : sets) EXPECT_EQ(figures.at(set).at("disagreements"), 0) << row.at("name");
    }
    EXPECT_GE(ours, 5u);
    EXPECT_GE(builders, 1u);
    if (has_embree(report)) {
        for (const char* key : {"incoherent", "any_hit", "camera", "build", "bytes"}) {
            EXPECT_GT(report.at("summary").at(key), 0.0) << key;
            EXPECT_GT(scene.at("ratios").at(key), 0.0) << key;
        }
    }
    EXPECT_TRUE(report.at("summary").at("refit").is_null());
    EXPECT_TRUE(report.at("summary").at("path").is_null());

    const std::string page = read(program.folder() / "a.html");
    EXPECT_TRUE(page.starts_with("<!DOCTYPE html>"));
    EXPECT_TRUE(page.ends_with("</html>\n"));
    EXPECT_NE(page.find("<svg "), std::string::npos);
    for (const char* word : {"http:", "https:", "src=", "href=", "<script", "<link", "@import", "url("})
        EXPECT_EQ(page.find(word), std::string::npos) << word;
}

TEST(BenchAccel, TakesAChoiceOfStructures)
{
    Program program;
    const Outcome outcome =
        bench(program, {"cornell", "--builder", "binned", "--traversal", "single", "--traversal", "stream", "-D",
                        "reinsertion=0", "--no-embree", "--one-thread", "--room", "--json", "a.json"});
    ASSERT_EQ(outcome.code, 0) << outcome.err;
    const json report = read_json(program.folder() / "a.json");
    const json& rows = report.at("scenes").at(0).at("rows");
    ASSERT_EQ(rows.size(), 2u);
    EXPECT_EQ(rows.at(0).at("traversal"), "single");
    EXPECT_EQ(rows.at(1).at("traversal"), "stream");
    EXPECT_EQ(rows.at(0).at("builder"), "binned");
    EXPECT_EQ(rows.at(0).at("mrays_per_second").at("ao").at("all_threads").at("median"), 0.0);
    for (const json& ratio : report.at("summary")) EXPECT_TRUE(ratio.is_null());
}

TEST(BenchAccel, AWrongAnswerFailsTheRun)
{
    Program program;
    const Outcome ours = bench(program, {"cornell", "--traversal", "single", "--traversal", "stream", "--no-embree",
                                         "--falsify", "--json", "a.json"});
    EXPECT_EQ(ours.code, 1);
    EXPECT_NE(ours.err.find("disagrees with"), std::string::npos) << ours.err;
    EXPECT_NE(ours.err.find("ray 0 (origin "), std::string::npos) << "says which ray: " << ours.err;
    const json report = read_json(program.folder() / "a.json");
    EXPECT_EQ(report.at("failures").size(), sets.size());

    const Outcome embree =
        bench(program, {"cornell", "--traversal", "auto", "--no-path", "--falsify", "--json", "b.json"});
    const json other = read_json(program.folder() / "b.json");
    if (!has_embree(other)) GTEST_SKIP() << "built without Embree";
    EXPECT_EQ(embree.code, 1);
    EXPECT_NE(embree.err.find("Embree disagrees with"), std::string::npos) << embree.err;
}

TEST(BenchAccel, RefitsAndPathsAndGrowsInRatiosToEmbree)
{
    Program program;
    const Outcome outcome = program.run({"bench", "accel", "field:1000", "--quick", "--rays", "1024", "--runs", "1",
                                         "--refit-scene", "field:20000", "--one-thread", "--json", "a.json"});
    ASSERT_EQ(outcome.code, 0) << outcome.err;
    const json report = read_json(program.folder() / "a.json");
    EXPECT_GE(report.at("refit").at("triangles"), 20'000);
    EXPECT_GT(report.at("refit").at("seconds").at("median"), 0.0);
    if (!has_embree(report)) GTEST_SKIP() << "built without Embree";
    EXPECT_GT(report.at("summary").at("refit"), 0.0);
    EXPECT_GT(report.at("summary").at("path"), 0.0);
    EXPECT_EQ(report.at("path").at(0).at("rows").size(), 3u);
}

TEST(BenchAccel, SaysWhatIsWrong)
{
    Program program;
    for (const auto& [arguments, code, word] : std::vector<std::tuple<std::vector<std::string>, int, std::string>>{
             {{"--builder", "bined"}, 2, "'binned'"},
             {{"--accel", "bvh"}, 2, "bvh8"},
             {{"--traversal", "sngle"}, 2, "'single'"},
             {{"-D", "max_depth=3"}, 2, "max_depth"},
             {{"--rays", "0"}, 2, "--rays"},
             {{"--runs", "x"}, 2, "--runs"},
             {{"--hmtl", "x"}, 2, "'--html'"},
             {{"nosuchscene"}, 1, "nosuchscene"},
             {{"cornell", "--json", "nofolder/a.json"}, 1, "nofolder"},
             {{"cornell", "--html", "nofolder/a.html"}, 1, "nofolder"}}) {
        const Outcome outcome = bench(program, arguments);
        EXPECT_EQ(outcome.code, code) << outcome.err;
        EXPECT_NE(outcome.err.find(word), std::string::npos) << outcome.err;
        EXPECT_EQ(outcome.out, "") << "before anything was measured";
    }
    EXPECT_TRUE(program.files().empty());
    program.write("kept.json", "kept");
    EXPECT_EQ(bench(program, {"nosuchscene", "--json", "kept.json"}).code, 1);
    EXPECT_EQ(read(program.folder() / "kept.json"), "kept");
    const Outcome help = program.run({"bench", "accel", "--help"});
    EXPECT_EQ(help.code, 0);
    EXPECT_NE(help.out.find("Examples"), std::string::npos);
}

TEST(InfoBvh, ComparesTheBuilders)
{
    Program program;
    const Outcome outcome = program.run({"info", "field:1000", "--bvh", "--json"});
    ASSERT_EQ(outcome.code, 0) << outcome.err;
    EXPECT_EQ(line_count(outcome.out), 1u);
    const json info = json::parse(outcome.out, nullptr, false);
    ASSERT_GE(info.at("builders").size(), 3u);
    EXPECT_EQ(info.at("builders").at(0).at("builder"), "auto");
    for (const json& row : info.at("builders")) {
        for (const char* key : {"build_seconds", "bytes", "sah", "epo", "nodes", "leaves", "references", "depth",
                                "mean_leaf_depth", "mean_leaf_size"})
            EXPECT_GT(row.at(key), 0) << row.at("builder") << " " << key;
        for (const std::string& set : sets) EXPECT_GT(row.at("mrays_per_second").at(set), 0.0) << set;
        EXPECT_EQ(row.at("leaves").get<int>(), row.at("nodes").get<int>() + 1);
        EXPECT_GE(row.at("references"), info.at("triangles"));
    }
    const Outcome table = program.run({"info", "whitted", "--bvh", "-q"});
    EXPECT_EQ(table.code, 0);
    EXPECT_EQ(table.err, "");
    for (const char* word : {"builder", "binned", "SAH", "EPO", "bounce3"})
        EXPECT_NE(table.out.find(word), std::string::npos) << word;
}

} // namespace
} // namespace snell::test
