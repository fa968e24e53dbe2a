// Tests of the viewer as a user has it: a window on a display of its own, driven by scripts.
#pragma once

#include "../cli/program.h"
#include "display.h"

#include "snell/io/image/read.h"

#include <gtest/gtest.h>

#include <cstdlib>
#include <memory>

namespace snell::test {

class Viewer : public testing::Test
{
  protected:
    static void SetUpTestSuite() { display_ = std::make_unique<Display>(); }
    static void TearDownTestSuite() { display_.reset(); }
    void SetUp() override { setenv("XDG_CONFIG_HOME", (program_.folder() / "config").c_str(), 1); }

    // Runs a script to its end.
    Outcome script(const std::string& text, std::vector<std::string> arguments = {})
    {
        program_.write("script.txt", text);
        arguments.insert(arguments.begin(), {"view", "--script", "script.txt", "--scale", "1"});
        return program_.run(arguments);
    }

    Picture picture(const std::string& file) const { return read_picture(program_.folder() / file); }

    // Of all pixels, or of the rectangle [x0, x1) x [y0, y1) in parts of the picture's width and height.
    vec3 mean(const std::string& file, float x0 = 0, float y0 = 0, float x1 = 1, float y1 = 1) const
    {
        const Picture p = picture(file);
        const auto at = [](float part, int size) { return static_cast<int>(part * static_cast<float>(size)); };
        glm::dvec3 sum(0.0);
        double count = 0;
        for (int y = at(y0, p.height); y < at(y1, p.height); ++y)
            for (int x = at(x0, p.width); x < at(x1, p.width); ++x, ++count)
                sum += glm::dvec3(p.pixels[static_cast<std::size_t>(y) * static_cast<std::size_t>(p.width) +
                                           static_cast<std::size_t>(x)]);
        return vec3(sum / count);
    }

    Program program_;

  private:
    inline static std::unique_ptr<Display> display_;
};

} // namespace snell::test
