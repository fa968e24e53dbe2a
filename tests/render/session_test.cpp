// A session shows what render() would, answers soon, and never makes its caller wait.
#include "snell/core/parallel.h"
#include "tests/render/sessions.h"
#include "tests/scene/moving_scene.h"

#include <atomic>

namespace snell::test {
namespace {

TEST(Session, ARestedPictureIsWhatRenderMakes)
{
    for (const uint spp : {1u, 2u, 7u, 70u}) {
        SCOPED_TRACE(spp);
        Session session;
        PaneRequest pane = pane_of("path", 67, 41, spp);
        session.set_panes({pane});
        const ShotPtr shot = rested(session, open(session));
        expect_rendered(shot, rendered(mixed_scene(), pane));
        EXPECT_EQ(shot->spp, spp);
        EXPECT_FALSE(shot->is_preview);
        EXPECT_FALSE(shot->under);
        EXPECT_EQ(shot->width, 67);
        EXPECT_EQ(shot->stats.samples, 67u * 41u * spp);
        EXPECT_TRUE(wait_until([&] { return session.status().phase == Phase::resting; }));
    }
}

TEST(Session, PanesHaveSettingsOfTheirOwn)
{
    std::vector<PaneRequest> panes = {pane_of("path"), pane_of("normals", 33, 20, 3), pane_of("whitted", 40, 30, 4),
                                      pane_of("path", 40, 30, 3)};
    panes[0].settings.layers = true;
    panes[2].settings.accel = "brute";
    panes[3].settings.force_diffuse = true;
    panes[3].settings.sampler = "independent";
    panes[3].settings.seed = 5;
    panes[3].settings.region = Region{3, 5, 30, 21};
    Session session;
    session.set_panes(panes);
    const std::uint64_t number = open(session);
    for (std::size_t i = 0; i < panes.size(); ++i) {
        SCOPED_TRACE(i);
        const ShotPtr shot = rested(session, number, i);
        expect_rendered(shot, rendered(mixed_scene(), panes[i]));
        EXPECT_EQ(shot->is_data, i == 1);
    }
    EXPECT_FALSE(session.shot(4));
    // and one of them goes on where only its number of samples changes
    panes[0].settings.layers = false;
    rested(session, session.set_panes(panes));
    const ShotPtr before = session.shot(1);
    panes[0].settings.spp = 9;
    const ShotPtr more = rested(session, session.set_panes({panes[0]}));
    expect_rendered(more, rendered(mixed_scene(), panes[0]));
    EXPECT_FALSE(session.shot(1));
}

TEST(Session, APaneThatShowsSomethingElseCostsNothing)
{
    std::vector<PaneRequest> panes = {pane_of("path"), pane_of("nothing"), endless};
    panes[1].is_rendered = panes[2].is_rendered = false;
    Session session;
    session.set_panes(panes);
    rested(session, open(session));
    EXPECT_TRUE(wait_until([&] { return session.status().phase == Phase::resting; }));
    EXPECT_FALSE(session.shot(1) || session.shot(2));
    panes[2].is_rendered = true;
    session.set_panes(panes);
    EXPECT_TRUE(wait_until([&] { return session.shot(2) != nullptr; }));
    panes[2].is_rendered = false;
    session.set_panes(panes);
    EXPECT_TRUE(wait_until([&] { return session.status().phase == Phase::resting; }));
}

TEST(Session, PicturesFollowEachOtherFromPreviewToFinished)
{
    Session session;
    session.set_panes({pane_of("path", 320, 200, 4)});
    open(session);
    std::uint64_t generation = 0;
    uint spp = 0;
    int pictures = 0;
    ShotPtr last;
    EXPECT_TRUE(wait_until([&] {
        const ShotPtr shot = session.shot(0);
        if (!shot || shot == last) return last && last->finished;
        pictures += 1;
        EXPECT_GE(shot->generation, generation);
        EXPECT_TRUE(shot->is_preview || !last || last->is_preview || shot->spp >= spp);
        if (shot->spp == 0) {
            EXPECT_TRUE(shot->under && shot->under->spp > 0);
        } else
            EXPECT_EQ(std::count(shot->film.sample_count.begin(), shot->film.sample_count.end(), 0u), 0);
        generation = shot->generation;
        spp = shot->spp;
        last = shot;
        return shot->finished;
    }));
    EXPECT_GE(pictures, 2);
}

TEST(Session, TheCameraIsFollowed)
{
    Session session;
    session.set_panes({pane_of("path")});
    open(session);
    Scene scene = mixed_scene();
    CameraDesc camera = scene.cameras[0];
    EXPECT_TRUE(wait_until([&] { return session.status().opened != 0; }));
    for (int i = 0; i < 5; ++i) {
        camera.eye.x += 0.3f;
        const std::uint64_t number = session.set_camera(camera);
        if (i == 2) {
            scene.cameras[0] = camera;
            expect_rendered(rested(session, number), rendered(scene, pane_of("path")));
        }
    }
    scene.cameras[0] = camera;
    const std::uint64_t number = session.set_camera(camera);
    EXPECT_TRUE(session.status().is_moving);
    expect_rendered(rested(session, number), rendered(scene, pane_of("path")));
    EXPECT_TRUE(wait_until([&] { return !session.status().is_moving; }));
}

TEST(Session, EditsAreMadeInOrderAndShown)
{
    Session session;
    const std::vector<PaneRequest> panes = {pane_of("path"), pane_of("normals")};
    session.set_panes(panes);
    open(session);
    Scene scene = moving_scene();
    complete(scene, 40.0f / 30.0f);
    const std::uint64_t second = open(session, moving_scene, "moving");
    EXPECT_TRUE(wait_until([&] { return session.status().opened == second; }));
    const std::uint64_t version = session.status().scene_version;
    // each of them depends on the one before
    const std::function<uint(Scene&)> edits[] = {
        [](Scene& s) { return pose(s, first_animation, 0.7f), uint{change_pose}; },
        [](Scene& s) { return s.materials[0].base_color = vec3(0.9f, 0.1f, 0.2f), uint{change_materials}; },
        [](Scene& s) { return s.materials[0].base_color *= 0.5f, uint{change_materials}; },
        [](Scene& s) { return s.environment.radiance = vec3(0.4f), uint{change_environment}; },
        [](Scene& s) { return s.instances[0].transform = translation(vec3(0.2f, 0, 0)), uint{change_transforms}; },
        [](Scene& s) { return add(s, LightDesc{}), uint{change_lights}; },
        [](Scene& s) { return s.meshes[0].positions[0] += vec3(0.1f), uint{change_everything}; },
        [](Scene&) { return uint{change_none}; },
    };
    std::uint64_t number = 0;
    for (const auto& edit : edits) {
        number = session.edit(edit);
        edit(scene);
    }
    for (std::size_t i = 0; i < panes.size(); ++i)
        expect_rendered(rested(session, number, i), rendered(scene, panes[i]));
    EXPECT_TRUE(wait_until([&] { return session.status().phase == Phase::resting; }));
    EXPECT_EQ(session.status().scene_version, version + std::size(edits));
    // and one by one
    for (const auto& edit : edits) {
        edit(scene);
        expect_rendered(rested(session, session.edit(edit)), rendered(scene, panes[0]));
    }
}

TEST(Session, AnEditForAnotherSceneIsLeftOut)
{
    Session session;
    session.set_panes({pane_of("normals")});
    std::atomic<bool> go = false;
    const std::uint64_t first = open(session);
    EXPECT_TRUE(wait_until([&] { return session.status().opened == first; }));
    const std::uint64_t second = session.open("other", [&](const LoadProgressCallback&) {
        wait_until([&] { return go.load(); });
        return moving_scene();
    });
    std::atomic<int> early = 0, late = 0;
    session.edit([&](Scene& s) { return early = static_cast<int>(s.spheres.size()), uint{change_none}; });
    go = true;
    // nobody looks at the status until the new scene is there
    std::atomic<bool> is_there = false;
    EXPECT_TRUE(wait_until([&] {
        session.query([&](const SessionAccess& access) { is_there = access.scene_opened == second; });
        return is_there.load();
    }));
    const std::uint64_t number = session.edit([&](Scene&) { return late = 1, uint{change_everything}; });
    rested(session, number);
    EXPECT_EQ(early, 5);
    EXPECT_EQ(late, 0);
    EXPECT_EQ(session.status().opened, second);
}

TEST(Session, EditsWaitForTheFirstScene)
{
    Session session;
    session.set_panes({pane_of("normals")});
    open(session);
    std::atomic<int> seen = 0;
    session.edit([&](Scene& s) { return seen = static_cast<int>(s.spheres.size()), uint{change_none}; });
    EXPECT_TRUE(wait_until([&] { return seen != 0; }));
    EXPECT_EQ(seen, 5);
}

TEST(Session, QueriesSeeWhatIsShown)
{
    Session session;
    session.set_panes({endless, pane_of("normals")});
    std::atomic<bool> before = false;
    session.query([&](const SessionAccess& access) { before = access.prepared.size() == 2 && !access.prepared[0]; });
    EXPECT_TRUE(wait_until([&] { return before.load(); }));
    open(session);
    EXPECT_TRUE(wait_until([&] { return session.shot(0) != nullptr; }));
    session.edit([](Scene& s) { return s.environment.radiance = vec3(7.0f), uint{change_environment}; });
    std::atomic<float> scene = 0, packed = 0;
    std::atomic<bool> same = false;
    session.query([&](const SessionAccess& access) {
        same = access.prepared[0] == access.prepared[1] && access.prepared[0] != nullptr;
        packed = access.prepared[0]->packed.environment.radiance.x;
        scene = access.scene.environment.radiance.x;
    });
    EXPECT_TRUE(wait_until([&] { return scene != 0; }));
    EXPECT_EQ(scene, 7.0f);
    EXPECT_EQ(packed, 7.0f) << "what was derived follows first";
    EXPECT_TRUE(same) << "panes share what they can";
}

TEST(Session, QueriesDoNotDisturbThePicture)
{
    Session session;
    const PaneRequest pane = pane_of("path", 200, 120, 8);
    session.set_panes({pane});
    const std::uint64_t number = open(session);
    std::atomic<int> answered = 0;
    ShotPtr shot;
    EXPECT_TRUE(wait_until([&] {
        session.query([&](const SessionAccess&) { ++answered; });
        shot = session.shot(0);
        return shot && shot->finished && shot->input >= number;
    }));
    expect_rendered(shot, rendered(mixed_scene(), pane));
    EXPECT_GT(answered, 3);
}

} // namespace
} // namespace snell::test
