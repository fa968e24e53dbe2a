// Pictures of all built-in scenes do not depend on whose tree it is.
#ifdef SNELL_HAS_EMBREE
#include "snell/scene/builtin.h"
#include "tests/render/scenes.h"

namespace snell::test {
namespace {

// Bit for bit but for the samples whose paths graze an edge: few, and as bright as they should be.
TEST(EmbreePictures, AgreeWithOurs)
{
    RenderSettings settings;
    settings.width = settings.height = 64;
    settings.spp = 4;
    settings.parameters["max_depth"] = "6";
    for (const BuiltinScene& builtin : builtin_scenes()) {
        SCOPED_TRACE(builtin.name);
        Scene scene = builtin.make();
        validate(scene);
        complete(scene, 1.0f);
        settings.accel = "bvh8";
        const Film ours = render(scene, settings).film;
        settings.accel = "embree";
        const Film theirs = render(scene, settings).film;
        std::size_t different = 0;
        double sum_ours = 0, sum_theirs = 0;
        for (std::size_t i = 0; i < ours.sum.size(); ++i) {
            different += ours.sum[i] != theirs.sum[i] ? 1 : 0;
            sum_ours += double{luminance(ours.sum[i])}, sum_theirs += double{luminance(theirs.sum[i])};
        }
        EXPECT_GT(sum_ours, 0.0);
        EXPECT_LE(different, ours.sum.size() / 500);
        EXPECT_NEAR(sum_theirs / sum_ours, 1.0, 0.002);
    }
}

} // namespace
} // namespace snell::test
#endif
