// `direct` is the path tracer with one bounce, to the bit, with the same switches.
#include "tests/render/scenes.h"

namespace snell::test {
namespace {

TEST(Direct, IsThePathTracerWithOneBounce)
{
    for (const char* off : {"none", "nee", "mis"}) {
        SCOPED_TRACE(off);
        RenderSettings settings = small_picture("direct");
        if (off != std::string("none")) settings.parameters[off] = "0";
        const Film direct = render(mixed_scene(), settings).film;
        settings.integrator = "path";
        EXPECT_FALSE(same_bits(direct.sum, render(mixed_scene(), settings).film.sum));
        settings.parameters["max_depth"] = "1";
        expect_same_film(direct, render(mixed_scene(), settings).film);
        for (const vec3& v : direct.layers.indirect) ASSERT_EQ(v, vec3(0.0f));
    }
}

TEST(Direct, HasNoDepthToChoose)
{
    RenderSettings settings = small_picture("direct");
    settings.parameters["max_depth"] = "2";
    EXPECT_THROW(render(mixed_scene(), settings), Error);
}

} // namespace
} // namespace snell::test
