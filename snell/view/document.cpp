#include "snell/view/document.h"

#include "snell/core/error.h"
#include "snell/io/environment.h"
#include "snell/io/image/read.h"
#include "snell/io/pbrt/write.h"
#include "snell/view/panel.h"
#include "snell/view/picking.h"

#include <imgui.h>

#include <algorithm>
#include <cmath>
#include <thread>

namespace snell::view {

std::string name_of(const Scene& scene, Selection s)
{
    const auto find = [&](const char* what, const auto& all) {
        if (s.index >= all.size() || all[s.index].name.empty()) return fmt::format("{} {}", what, s.index);
        return fmt::format("{} '{}'", what, all[s.index].name);
    };
    switch (s.kind) {
    case Selection::Kind::material:
        return find("material", scene.materials);
    case Selection::Kind::mesh:
        return find("mesh", scene.meshes);
    case Selection::Kind::sphere:
        return find("sphere", scene.spheres);
    case Selection::Kind::plane:
        return find("plane", scene.planes);
    case Selection::Kind::instance:
        return find("instance", scene.instances);
    case Selection::Kind::node:
        return find("node", scene.nodes);
    case Selection::Kind::light:
        return find("light", scene.lights);
    case Selection::Kind::camera:
        return find("camera", scene.cameras);
    case Selection::Kind::environment:
        return "environment";
    case Selection::Kind::nothing:
        break;
    }
    return "nothing";
}

static bool exists(const Scene& scene, Selection s)
{
    const std::size_t counts[] = {1,
                                  scene.materials.size(),
                                  scene.meshes.size(),
                                  scene.spheres.size(),
                                  scene.planes.size(),
                                  scene.instances.size(),
                                  scene.nodes.size(),
                                  scene.lights.size(),
                                  scene.cameras.size(),
                                  1};
    return s.index < counts[static_cast<std::size_t>(s.kind)];
}

// ---- edits ----

EditContext Document::context(bool is_outline) const
{
    return {is_outline, posed_, posed_seconds_};
}

// The same edits for the scene that is rendered.
void Document::post(ViewState& state, History::Done done)
{
    if (!exists(state.outline, selection)) selection = {};
    if (done.edits.empty()) return;
    pose_request_.reset(); // a later pose must come after these edits
    state.session.edit([edits = std::move(done.edits), where = context(false)](Scene& scene) {
        uint changes = change_none;
        for (const Edit& edit : edits) changes |= reapply(scene, edit, where);
        return changes;
    });
}

bool Document::apply(ViewState& state, std::vector<Edit> edits, std::string label, std::uint64_t control)
{
    if (!is_ready_) return false;
    try {
        History::Done done = history_.apply(state.outline, std::move(edits), std::move(label), control, context(true));
        if (!done.mended.empty()) state.say("not physical, mended: " + done.mended);
        post(state, std::move(done));
    } catch (const Error& error) {
        state.say(error.what());
        return false;
    }
    return true;
}

void Document::undo(ViewState& state)
{
    if (!is_ready_) return;
    const std::string* label = history_.undo_label();
    state.say(label != nullptr ? "undone: " + *label : "there is nothing to undo");
    post(state, history_.undo(state.outline, context(true)));
}

void Document::redo(ViewState& state)
{
    if (!is_ready_) return;
    const std::string* label = history_.redo_label();
    state.say(label != nullptr ? "done again: " + *label : "there is nothing to do again");
    post(state, history_.redo(state.outline, context(true)));
}

// ---- poses ----

void Document::pose(ViewState& state, Index<Animation> animation, float seconds)
{
    if (!is_ready_) return;
    posed_ = animation;
    posed_seconds_ = seconds;
    snell::pose(state.outline, animation, seconds);
    if (pose_request_) {
        const std::lock_guard lock(pose_request_->mutex);
        pose_request_->animation = animation;
        pose_request_->seconds = seconds;
        if (!pose_request_->is_taken) return;
    }
    pose_request_ = std::make_shared<PoseRequest>();
    pose_request_->animation = animation;
    pose_request_->seconds = seconds;
    state.session.edit([request = pose_request_](Scene& scene) -> uint {
        Index<Animation> wanted;
        float at = 0.0f;
        {
            const std::lock_guard lock(request->mutex);
            wanted = request->animation;
            at = request->seconds;
            request->is_taken = true;
        }
        snell::pose(scene, wanted, at);
        return change_pose;
    });
}

void Document::play(ViewState& state)
{
    const double passed = std::clamp(state.time - last_time_, 0.0, 0.5);
    last_time_ = state.time;
    Playback& p = playback;
    if (!is_ready_ || !p.animation.valid()) state.is_playing = false;
    if (!state.is_playing) return;
    state.wake();
    const float duration = state.outline.animations[p.animation.value].duration;
    p.seconds += p.speed * static_cast<float>(passed);
    if (p.loops && duration > 0.0f) {
        p.seconds = std::fmod(p.seconds, duration);
        if (p.seconds < 0.0f) p.seconds += duration;
    } else if (p.seconds < 0.0f || p.seconds > duration) {
        p.seconds = std::clamp(p.seconds, 0.0f, duration);
        state.is_playing = false;
    }
    pose(state, p.animation, p.seconds);
    if (p.camera < state.outline.cameras.size()) state.look(state.outline.cameras[p.camera]);
}

// ---- saving, copying, loading ----

void Document::save(ViewState& state, const std::filesystem::path& file, bool overwrite)
{
    if (!is_ready_ || saving_) return;
    saving_ = std::make_shared<Answer<Saved>>();
    state.session.query([answer = saving_, file, overwrite, camera = state.camera, now = history_.state(),
                         opened = opened_](const SessionAccess& access) {
        Saved saved{file, now, {}, {}};
        if (access.scene_opened != opened) saved.error = "another scene was opened meanwhile: nothing was saved";
        if (saved.error.empty() && !access.scene.cameras.empty()) {
            CameraDesc& first = access.scene.cameras.front();
            const CameraDesc before = first;
            first = camera;
            first.name = before.name;
            try {
                saved.notes = write_pbrt(access.scene, file, {overwrite});
            } catch (const std::exception& error) {
                saved.error = error.what();
            }
            first = before;
        }
        answer->give(std::move(saved));
    });
}

void Document::copy(ViewState& state)
{
    if (!is_ready_) return;
    const Scene& scene = state.outline;
    std::string text;
    switch (selection.kind) {
    case Selection::Kind::material:
        text = pbrt_text(scene, Index<MaterialDesc>{selection.index});
        break;
    case Selection::Kind::light:
        text = pbrt_text(scene.lights[selection.index]);
        break;
    case Selection::Kind::camera:
        text = pbrt_text(scene.cameras[selection.index]);
        break;
    case Selection::Kind::environment:
        text = pbrt_text(scene, scene.environment);
        break;
    default:
        copying_ = std::make_shared<Answer<std::string>>();
        state.session.query([answer = copying_](const SessionAccess& access) {
            std::string all;
            try {
                all = pbrt_text(access.scene);
            } catch (const std::exception&) { // a folder that is in the way
            }
            answer->give(std::move(all));
        });
        return;
    }
    ImGui::SetClipboardText(text.c_str());
    state.say(fmt::format("{} is in the clipboard, as pbrt has it", name_of(scene, selection)));
}

// On a thread of its own, which nobody waits for: it holds all that it writes to.
void Document::load(ViewState& state, const std::filesystem::path& file, bool is_environment, bool is_color,
                    Index<MaterialDesc> material)
{
    if (!is_ready_) return;
    if (loading_) {
        state.say("a picture is being read already");
        return;
    }
    loading_ = std::make_shared<Answer<Loaded>>();
    std::thread([answer = loading_, file, is_environment, is_color, material, opened = opened_] {
        Loaded loaded{nullptr, {}, is_environment, material, opened, file.filename().string(), {}};
        try {
            Image image;
            if (is_environment) {
                Scene scene;
                set_environment(scene, file);
                loaded.environment = scene.environment;
                image = std::move(scene.images.front());
            } else {
                image = read_texture(file, is_color);
                for (float& value : image.floats) value = std::clamp(value, 0.0f, 1.0f); // reflectances
            }
            if (image.name.empty()) image.name = loaded.name;
            loaded.image = std::make_shared<const Image>(std::move(image));
        } catch (const std::exception& error) {
            loaded.error = error.what();
        }
        answer->give(std::move(loaded));
    }).detach();
    state.say(fmt::format("reading {}", file.filename().string()));
}

void Document::load_environment(ViewState& state, const std::filesystem::path& file)
{
    load(state, file, true, true, {});
}

void Document::load_texture(ViewState& state, const std::filesystem::path& file, bool is_color,
                            Index<MaterialDesc> material)
{
    load(state, file, false, is_color, material);
}

void Document::select_at(ViewState& state, std::size_t pane, int x, int y)
{
    if (!is_ready_ || pane >= state.panes.size()) return;
    hitting_ = std::make_shared<Answer<Hit>>();
    state.session.query([answer = hitting_, pane, x, y, camera = state.camera](const SessionAccess& access) {
        Hit hit;
        if (pane < access.prepared.size() && access.prepared[pane] != nullptr)
            if (const std::optional<PickedSurface> picked =
                    pick_surface(*access.prepared[pane], camera, access.panes[pane].settings, x, y)) {
                hit.surface = {Selection::Kind::material, picked->material};
                if (picked->instance != none) hit.instance = {Selection::Kind::instance, picked->instance};
            }
        answer->give(hit);
    });
}

// ---- each frame ----

void Document::take_over(ViewState& state)
{
    is_ready_ = state.opened != 0 && state.opened == state.status.opened;
    if (!is_ready_ || state.opened == opened_) return;
    opened_ = state.opened;
    history_.clear();
    saved_state_ = history_.state();
    file_.clear();
    selection = hit_instance = {};
    playback = {};
    if (!state.outline.animations.empty()) playback.animation = {0};
    posed_ = {};
    posed_seconds_ = 0.0f;
    pose_request_.reset();
    meshes_.clear();
    counting_ = std::make_shared<Answer<Counted>>();
    state.session.query([answer = counting_](const SessionAccess& access) {
        answer->give({access.scene_opened, mesh_figures(access.scene)});
    });
}

template <class T>
static std::optional<T> take(AnswerPtr<T>& from)
{
    std::optional<T> value;
    if (from) value = from->take();
    if (value) from.reset();
    return value;
}

void Document::take_picture(ViewState& state, const Loaded& loaded)
{
    if (!loaded.error.empty()) {
        state.say(loaded.error);
        return;
    }
    if (!is_ready_ || loaded.opened != opened_) return; // another scene has come meanwhile
    const Index<Image> image{static_cast<uint>(state.outline.images.size())};
    std::vector<Edit> edits = {AddImage{loaded.image}};
    Selection chosen = selection;
    if (loaded.is_environment) {
        SetEnvironment set{loaded.environment};
        set.value.image = image;
        set.value.visible = state.outline.environment.visible;
        edits.emplace_back(set);
        chosen = {Selection::Kind::environment, 0};
    } else if (loaded.material.value < state.outline.materials.size()) {
        SetMaterial set{loaded.material, state.outline.materials[loaded.material.value]};
        set.value.base_texture = {};
        set.value.base_texture.image = image;
        edits.emplace_back(set);
        chosen = {Selection::Kind::material, loaded.material.value};
    }
    if (!apply(state, std::move(edits), fmt::format("picture '{}'", loaded.name))) return;
    selection = chosen;
    state.say(fmt::format("{} is part of the scene now", loaded.name));
}

void Document::take_answers(ViewState& state)
{
    if (std::optional<Counted> counted = take(counting_))
        if (counted->opened == opened_) meshes_ = std::move(counted->meshes);
    if (const std::optional<Saved> saved = take(saving_)) {
        if (saved->error.empty()) {
            saved_state_ = saved->state;
            file_ = saved->file;
            state.say(fmt::format("saved as {}{}", saved->file.string(),
                                  saved->notes.empty() ? "" : "; " + saved->notes.front().text));
        } else {
            state.say(saved->error);
        }
    }
    if (const std::optional<std::string> text = take(copying_)) {
        ImGui::SetClipboardText(text->c_str());
        state.say(fmt::format("the scene is in the clipboard, {} kB of pbrt", text->size() / 1000));
    }
    if (const std::optional<Loaded> loaded = take(loading_)) take_picture(state, *loaded);
    if (const std::optional<Hit> hit = take(hitting_)) {
        selection = exists(state.outline, hit->surface) ? hit->surface : Selection{};
        hit_instance = exists(state.outline, hit->instance) ? hit->instance : Selection{};
    }
}

void Document::follow(ViewState& state)
{
    take_over(state);
    take_answers(state);
    if (!ImGui::IsAnyItemActive()) history_.seal(); // nothing is being dragged
    if (hitting_) state.wake();                     // who has clicked waits for it
    play(state);
}

} // namespace snell::view
