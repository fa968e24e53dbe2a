// The viewer's sessions: devices live.
#include "snell/render/session.h"
#include "tests/render/scenes.h"
#include "tests/vulkan/gpu_test.h"

#include <chrono>
#include <thread>

namespace snell::test {
namespace {

ShotPtr finished_shot(Session& session, std::uint64_t input)
{
    for (int i = 0; i < 6000; ++i) {
        const ShotPtr shot = session.shot(0);
        if (shot && shot->input >= input && shot->finished) return shot;
        if (session.status().phase == SessionStatus::Phase::failed) return nullptr;
        std::this_thread::sleep_for(std::chrono::milliseconds(10));
    }
    return nullptr;
}

double brightness(const Shot& shot)
{
    double sum = 0;
    for (const vec3& pixel : shot.film.sum) sum += static_cast<double>(luminance(pixel));
    return sum;
}

TEST(GpuSession, ChangesDevicesWhileItRuns)
{
    SNELL_NEEDS_GPU();
    Session session;
    session.open("mixed", [](const LoadProgressCallback&) { return mixed_scene(); });
    PaneRequest pane;
    pane.settings = small_picture("path");
    pane.settings.layers = false;
    pane.settings.accel = "bvh8q";
    const auto ask = [&](const std::string& device) {
        pane.settings.device = device;
        return finished_shot(session, session.set_panes({pane}));
    };
    const ShotPtr on_cpu = ask("cpu"), on_gpu = ask(test_device()), again = ask("cpu");
    ASSERT_TRUE(on_cpu && on_gpu && again) << session.status().what;
    EXPECT_TRUE(same_bits(on_cpu->film.sum, again->film.sum));
    ASSERT_EQ(on_gpu->film.sample_count, on_cpu->film.sample_count);
    const double cpu = brightness(*on_cpu);
    EXPECT_NEAR(brightness(*on_gpu), cpu, 0.01 * cpu);

    // An edit of the scene reaches the device.
    const std::uint64_t edit = session.edit([](Scene& scene) {
        scene.lights[0].emission = vec3(0.0f);
        return uint{change_lights};
    });
    ask(test_device());
    const ShotPtr darker = finished_shot(session, edit);
    ASSERT_TRUE(darker) << session.status().what;
    EXPECT_LT(brightness(*darker), 0.99 * cpu);
}

} // namespace
} // namespace snell::test
