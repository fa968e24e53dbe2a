#include "snell/core/text.h"

#include <gtest/gtest.h>

#include <vector>

namespace snell {
namespace {

TEST(Text, EditDistanceCountsTheFewestChanges)
{
    EXPECT_EQ(edit_distance("", ""), 0u);
    EXPECT_EQ(edit_distance("abc", ""), 3u);
    EXPECT_EQ(edit_distance("", "abc"), 3u);
    EXPECT_EQ(edit_distance("kitten", "sitting"), 3u);
    EXPECT_EQ(edit_distance("cornell", "CORNELL"), 0u);
    EXPECT_EQ(edit_distance("conrell", "cornell"), 1u); // one swap of neighbours
    EXPECT_EQ(edit_distance("corell", "cornell"), 1u);
}

TEST(Text, NearestFindsWhatWasMeantOrNothing)
{
    const std::vector<std::string> names = {"cornell", "whitted", "spheres", "sphereflake", "menger", "veach-mis"};
    EXPECT_EQ(nearest("cornel", names), "cornell");
    EXPECT_EQ(nearest("Whited", names), "whitted");
    EXPECT_EQ(nearest("sphere", names), "spheres");
    EXPECT_EQ(nearest("spherefalke", names), "sphereflake");
    EXPECT_EQ(nearest("veach", names), "veach-mis"); // a beginning, though far by edits
    EXPECT_EQ(nearest("xyzzy", names), "");
    EXPECT_EQ(nearest("", names), "");
    EXPECT_EQ(nearest("cornell", {}), "");
    EXPECT_EQ(nearest(std::string(100000, 'c'), names), "");
}

} // namespace
} // namespace snell
