// The document: what is edited in the outline is edited in the session's scene, in the same order.
#include "snell/core/error.h"
#include "snell/view/panel.h"
#include "tests/scene/edits.h"

#include <imgui.h>

#include <chrono>
#include <condition_variable>
#include <filesystem>
#include <functional>
#include <thread>

namespace snell::view {
namespace {

using namespace snell::test;

class DocumentTest : public ::testing::Test
{
  protected:
    DocumentTest()
    {
        ImGui::CreateContext();
        ImGuiIO& io = ImGui::GetIO();
        io.IniFilename = nullptr;
        io.DisplaySize = ImVec2(640, 480);
        unsigned char* pixels = nullptr;
        int width = 0, height = 0;
        io.Fonts->GetTexDataAsRGBA32(&pixels, &width, &height);
        state.say = [this](const std::string& text) { said = text; };
        state.look = [this](const CameraDesc& camera) { state.camera = camera; };
        state.wake = [] {};
        PaneRequest pane;
        pane.settings.width = 32;
        pane.settings.height = 24;
        pane.settings.spp = 1;
        pane.settings.keep_motion = true;
        session.set_panes({pane});
        state.panes.resize(1);
        state.panes[0].request = pane;
        open();
    }
    ~DocumentTest() override { ImGui::DestroyContext(); }

    void open()
    {
        const std::uint64_t number = session.open("test", [](const LoadProgressCallback&) { return editable_scene(); });
        wait([&] {
            state.status = session.status();
            return state.status.opened == number;
        });
        const Scene scene = scene_of_session();
        state.outline = snell::outline(scene);
        state.opened = number;
        state.camera = scene.cameras[0];
        frame();
        ASSERT_TRUE(document.is_ready());
    }

    static void wait(const std::function<bool()>& until)
    {
        const auto end = std::chrono::steady_clock::now() + std::chrono::seconds(60);
        while (!until()) {
            ASSERT_LT(std::chrono::steady_clock::now(), end) << "nothing happens";
            std::this_thread::sleep_for(std::chrono::milliseconds(1));
        }
    }

    void frame(double seconds = 0.01)
    {
        state.time += seconds;
        state.status = session.status();
        ImGui::GetIO().DeltaTime = static_cast<float>(seconds);
        ImGui::NewFrame();
        document.follow(state);
        ImGui::EndFrame();
    }

    // After all edits so far.
    Scene scene_of_session()
    {
        const auto answer = std::make_shared<Answer<Scene>>();
        session.query([answer](const SessionAccess& access) { answer->give(access.scene); });
        std::optional<Scene> scene;
        wait([&] {
            scene = answer->take();
            return scene.has_value();
        });
        return *scene;
    }

    void expect_same_scenes() { ASSERT_EQ(bytes(snell::outline(scene_of_session())), bytes(state.outline)); }

    Session session;
    ViewState state{session};
    Document& document = state.document;
    std::string said;
};

TEST_F(DocumentTest, RandomEditsUndoneAndRedone)
{
    RandomEdits random(8);
    std::vector<std::string> states = {bytes(state.outline)};
    for (int i = 0; i < 40; ++i) {
        frame();
        if (document.apply(state, {random.edit(state.outline)}, "step")) states.push_back(bytes(state.outline));
        if (i % 10 == 0) expect_same_scenes();
    }
    ASSERT_GT(states.size(), 15u);
    EXPECT_TRUE(document.is_dirty());
    expect_same_scenes();
    for (std::size_t i = states.size() - 1; i-- > 0;) {
        document.undo(state);
        ASSERT_EQ(bytes(state.outline), states[i]);
    }
    EXPECT_FALSE(document.is_dirty());
    expect_same_scenes();
    document.undo(state);
    EXPECT_EQ(said, "there is nothing to undo");
    for (std::size_t i = 1; i < states.size(); ++i) document.redo(state);
    EXPECT_EQ(bytes(state.outline), states.back());
    expect_same_scenes();
}

TEST_F(DocumentTest, ErrorsAreSaidAndChangeNothing)
{
    const std::string before = bytes(state.outline);
    EXPECT_FALSE(document.apply(state, {SetTransform{999, {}}}, "nonsense"));
    EXPECT_NE(said.find("there is no instance 999"), std::string::npos);
    EXPECT_EQ(bytes(state.outline), before);
    SetMaterial set{{0}, state.outline.materials[0]};
    set.value.base_color = vec3(2.0f);
    EXPECT_TRUE(document.apply(state, {set}, "too bright"));
    EXPECT_NE(said.find("mended"), std::string::npos);
    expect_same_scenes();
}

TEST_F(DocumentTest, PosesAndEditsKeepTheirOrder)
{
    RandomEdits random(4);
    for (int i = 0; i < 30; ++i) {
        for (int k = 0; k < 5; ++k) document.pose(state, first_animation, random.number(0.0f, 2.0f));
        const Index<Node> node{random.below(state.outline.nodes.size())};
        SetNode set{node, state.outline.nodes[node.value]};
        set.value.translation += random.vector(-0.1f, 0.1f);
        document.apply(state, {set}, "node");
        for (int k = 0; k < 3; ++k) document.pose(state, first_animation, random.number(0.0f, 2.0f));
        if (i % 5 == 0) expect_same_scenes();
    }
    expect_same_scenes();
}

TEST_F(DocumentTest, TimePassesWhileItPlays)
{
    document.playback.animation = first_animation;
    document.playback.speed = 2.0f;
    state.is_playing = true;
    for (int i = 0; i < 10; ++i) frame(0.05);
    EXPECT_NEAR(document.playback.seconds, 1.0f, 1e-3f);
    expect_same_scenes();
    for (int i = 0; i < 15; ++i) frame(0.05);
    EXPECT_NEAR(document.playback.seconds, 0.5f, 1e-3f) << "it lasts 2 seconds, and loops";
    document.playback.loops = false;
    for (int i = 0; i < 30; ++i) frame(0.05);
    EXPECT_EQ(document.playback.seconds, 2.0f);
    EXPECT_FALSE(state.is_playing);
    expect_same_scenes();
}

TEST_F(DocumentTest, SavedAndReadAgain)
{
    const std::filesystem::path folder = std::filesystem::path(::testing::TempDir()) / "document_test";
    std::filesystem::create_directories(folder);
    const std::filesystem::path file = folder / "saved.pbrt";
    std::filesystem::remove(file);
    LightDesc light;
    light.name = "added";
    document.apply(state, {AddLight{0, light}}, "light");
    EXPECT_TRUE(document.is_dirty());
    state.camera.eye = vec3(1, 2, 9);
    document.save(state, file, false);
    document.apply(state, {Rename{ScenePart::light, 0, "later"}}, "name");
    wait([&] {
        frame();
        return !document.is_saving();
    });
    EXPECT_NE(said.find("saved as"), std::string::npos) << said;
    EXPECT_TRUE(document.is_dirty()) << "what came after it is not in the file";
    document.undo(state);
    EXPECT_FALSE(document.is_dirty());
    const Scene back = load_scene(file);
    ASSERT_FALSE(back.lights.empty());
    EXPECT_EQ(back.lights[0].name, "added");
    EXPECT_EQ(back.cameras[0].eye, vec3(1, 2, 9)) << "the view that is shown";
    EXPECT_NE(scene_of_session().cameras[0].eye, vec3(1, 2, 9)) << "saving changes nothing";
    document.save(state, folder / "wrong.png", false);
    wait([&] {
        frame();
        return !document.is_saving();
    });
    EXPECT_NE(said.find("does not end in .pbrt"), std::string::npos);
    EXPECT_EQ(document.file(), file);
}

TEST_F(DocumentTest, PicturesThatCannotBeReadAreSaid)
{
    document.load_environment(state, "there_is_no_such_picture.exr");
    wait([&] {
        frame();
        return !document.is_loading();
    });
    EXPECT_NE(said.find("there_is_no_such_picture.exr"), std::string::npos);
    EXPECT_FALSE(document.is_dirty());
}

TEST_F(DocumentTest, AClickSelects)
{
    const auto select = [&](int x, int y) {
        document.selection = {Selection::Kind::environment, 0};
        document.select_at(state, 0, x, y);
        wait([&] {
            frame();
            return document.selection.kind != Selection::Kind::environment;
        });
    };
    select(16, 18); // the floor, or what stands on it
    EXPECT_EQ(document.selection.kind, Selection::Kind::material);
    EXPECT_EQ(document.hit_instance.kind, Selection::Kind::instance);
    select(1, 1); // the sky
    EXPECT_EQ(document.selection.kind, Selection::Kind::nothing);
}

TEST_F(DocumentTest, AnotherSceneForgetsTheHistory)
{
    document.apply(state, {AddLight{}}, "light");
    document.selection = {Selection::Kind::light, 0};
    open();
    EXPECT_EQ(document.history().undo_label(), nullptr);
    EXPECT_FALSE(document.is_dirty());
    EXPECT_EQ(document.selection, Selection{});
    expect_same_scenes();
}

TEST_F(DocumentTest, TextGoesToTheClipboard)
{
    document.selection = {Selection::Kind::light, 1};
    document.copy(state);
    EXPECT_NE(std::string(ImGui::GetClipboardText()).find("LightSource"), std::string::npos);
    document.selection = {};
    document.copy(state);
    wait([&] {
        frame();
        return std::string(ImGui::GetClipboardText()).find("WorldBegin") != std::string::npos;
    });
}

} // namespace
} // namespace snell::view
