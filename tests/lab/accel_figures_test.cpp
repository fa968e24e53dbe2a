// Ratios to Embree, on figures made up so that the answers are known.
#include "snell/lab/accel_figures.h"

#include <gtest/gtest.h>

#include <cmath>

namespace snell {
namespace {

AccelRow row(const char* name, YardstickQuality quality, unsigned packet, double build, std::size_t bytes,
             std::map<std::string, double> speeds)
{
    AccelRow r;
    r.name = name;
    r.quality = quality;
    r.packet = packet;
    r.build.median = build;
    r.bytes = bytes;
    for (const auto& [set, speed] : speeds) {
        r.traces[set].one.median = speed;
        r.traces[set].all.median = 2 * speed;
    }
    return r;
}

AccelScene made_up()
{
    AccelScene scene;
    using enum YardstickQuality;
    scene.rows.push_back(
        row("fast", ours, 1, 2.0, 100,
            {{"camera", 30}, {"shadow", 12}, {"ao", 8}, {"bounce1", 8}, {"bounce2", 6}, {"bounce3", 4}}));
    scene.rows.push_back(row("quick", ours, 1, 0.5, 90, {{"bounce1", 4}, {"bounce2", 4}, {"bounce3", 4}}));
    scene.rows.push_back(
        row("Embree", medium, 1, 1.0, 80,
            {{"camera", 10}, {"shadow", 4}, {"ao", 4}, {"bounce1", 4}, {"bounce2", 2}, {"bounce3", 1}}));
    scene.rows.push_back(
        row("Embree 16", medium, 16, 1.0, 80, {{"camera", 60}, {"shadow", 6}, {"ao", 1}, {"bounce1", 99}}));
    scene.rows.push_back(
        row("Embree HIGH", high, 1, 4.0, 85,
            {{"camera", 12}, {"shadow", 5}, {"ao", 3}, {"bounce1", 2}, {"bounce2", 3}, {"bounce3", 2}}));
    scene.rows.push_back(
        row("Embree LOW", low, 1, 0.1, 99, {{"camera", 900}, {"bounce1", 8}, {"bounce2", 8}, {"bounce3", 8}}));
    return scene;
}

TEST(AccelFigures, Spread)
{
    EXPECT_EQ(spread_of({3, 1, 2}).median, 2);
    EXPECT_EQ(spread_of({4, 1, 2, 3}).median, 2.5);
    EXPECT_EQ(spread_of({3, 1, 2}).low, 1);
    EXPECT_EQ(spread_of({3, 1, 2}).high, 3);
    EXPECT_EQ(spread_of({}).median, 0);
}

TEST(AccelFigures, RatiosAreToTheBetterOfEmbree)
{
    const AccelScene scene = made_up();
    const AccelRatios r = ratios_of(scene, scene.rows[0]);
    EXPECT_DOUBLE_EQ(r.camera.value(), 0.5);     // to the packets; LOW does not count
    EXPECT_DOUBLE_EQ(r.any_hit.value(), 2.0);    // 12 / 6 and 8 / 4
    EXPECT_DOUBLE_EQ(r.incoherent.value(), 2.0); // 8 / 4, 6 / 3, 4 / 2: packets do not count
    EXPECT_DOUBLE_EQ(r.bytes.value(), 0.8);      // to medium
    EXPECT_DOUBLE_EQ(set_ratio(scene, scene.rows[0], "shadow").value(), 2.0);
    EXPECT_DOUBLE_EQ(set_ratio(scene, scene.rows[0], "shadow", true).value(), 2.0);
    EXPECT_FALSE(set_ratio(scene, scene.rows[1], "shadow").has_value());
    EXPECT_FALSE(r.refit.has_value());
    AccelScene alone = scene;
    alone.rows.resize(2);
    EXPECT_FALSE(ratios_of(alone, alone.rows[0]).camera.has_value());
    EXPECT_FALSE(build_ratio(alone).has_value());
}

TEST(AccelFigures, BuildingIsComparedAtEqualSpeed)
{
    const AccelScene scene = made_up();
    EXPECT_NEAR(incoherent_speed(scene.rows[0]).value(), std::cbrt(8.0 * 6.0 * 4.0), 1e-12);
    // Medium (speed 2): "quick" is as fast and builds in half the time. HIGH (2.3): "quick" in an eighth. LOW (8) is
    // traced faster than any: "fast" reaches 0.72 in tracing but 0.05 in building, "quick" 0.5 and 0.2.
    EXPECT_NEAR(build_ratio(scene).value(), std::cbrt(2.0 * 8.0 * 0.2), 1e-12);
    EXPECT_FALSE(is_on_front(scene, scene.rows[0])) << "LOW is better in both";
    AccelScene without = scene;
    without.rows.pop_back();
    EXPECT_TRUE(is_on_front(without, without.rows[0]));
    EXPECT_TRUE(is_on_front(without, without.rows[1]));
    without.rows[1].build.median = 3;
    without.rows[1].traces["bounce1"].one.median = 0.1;
    EXPECT_FALSE(is_on_front(without, without.rows[1]));
}

TEST(AccelFigures, Means)
{
    AccelRatios a, b;
    a.camera = 1.0, b.camera = 4.0;
    a.refit = 3.0;
    const AccelRatios mean = mean_ratios(std::vector{a, b});
    EXPECT_DOUBLE_EQ(mean.camera.value(), 2.0);
    EXPECT_DOUBLE_EQ(mean.refit.value(), 3.0);
    EXPECT_FALSE(mean.path.has_value());
}

} // namespace
} // namespace snell
