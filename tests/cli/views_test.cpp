// Views write their numbers as they are: exposure and tone curve are for light.
#include "program.h"

#include "snell/io/image/read.h"

#include <gtest/gtest.h>

namespace snell::test {
namespace {

std::vector<vec3> png_of(Program& program, const std::string& integrator, const std::vector<std::string>& more)
{
    std::vector<std::string> arguments = {"render", "spheres", "--size",      "24x16",        "--spp",
                                          "2",      "-o",      "picture.png", "--integrator", integrator};
    arguments.insert(arguments.end(), more.begin(), more.end());
    const Outcome outcome = program.run(arguments);
    EXPECT_EQ(outcome.code, 0) << outcome.err;
    // A tone curve that is left out is worth a line.
    const bool told = outcome.err.find("leave the view '" + integrator + "' as it is") != std::string::npos;
    EXPECT_EQ(told, integrator != "path" && !more.empty()) << outcome.err;
    return read_picture(program.folder() / "picture.png").pixels;
}

TEST(Views, BypassExposureAndToneCurve)
{
    Program program;
    for (const char* view : {"normals", "geometric-normals", "facing", "uv", "barycentrics", "depth", "albedo",
                             "object", "instance", "material", "primitive", "steps"}) {
        const std::vector<vec3> plain = png_of(program, view, {});
        EXPECT_EQ(png_of(program, view, {"--exposure", "2", "--tone", "aces"}), plain) << view;
        vec3 most(0.0f);
        for (const vec3& pixel : plain) most = max(most, pixel);
        EXPECT_GT(max3(most), 0.05f) << view << " is black, which nothing can change";
    }
    EXPECT_NE(png_of(program, "path", {"--exposure", "2", "--tone", "aces"}), png_of(program, "path", {}));
}

} // namespace
} // namespace snell::test
