// The scene as the window edits it: one apply() for the outline that is shown and the scene that is rendered.
#pragma once

#include "snell/scene/history.h"
#include "snell/scene/outline.h"

#include <filesystem>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace snell::view {

struct ViewState;

// What comes back from another thread.
template <class T>
struct Answer
{
    std::mutex mutex;
    std::optional<T> value;

    void give(T result)
    {
        const std::lock_guard lock(mutex);
        value = std::move(result);
    }
    // Once: nothing before it is there, and after it was taken.
    std::optional<T> take()
    {
        const std::lock_guard lock(mutex);
        return std::exchange(value, std::nullopt);
    }
};
template <class T>
using AnswerPtr = std::shared_ptr<Answer<T>>;

// One part of the scene; index: in the scene's list of such parts.
struct Selection
{
    enum class Kind
    {
        nothing,
        material,
        mesh,
        sphere,
        plane,
        instance,
        node,
        light,
        camera,
        environment
    };
    Kind kind = Kind::nothing;
    uint index = 0;
    bool operator==(const Selection&) const = default;
};

// Animations as time goes by.
struct Playback
{
    bool loops = true;
    float speed = 1.0f;         // seconds of the animation a second
    Index<Animation> animation; // not valid: at rest
    float seconds = 0.0f;
    uint camera = none; // that is looked through while it moves; none: the view stays
};

// Lives in the user interface's thread, and never waits for another.
class Document
{
  public:
    // Once a frame, before panels are drawn: follows what was opened, takes what was asked of other threads, and plays
    // the animation while ViewState::is_playing.
    void follow(ViewState& state);

    // False: nothing is open yet, or ViewState::outline is still another scene's. Nothing can be edited then.
    bool is_ready() const { return is_ready_; }

    // Applies edits to the outline and to the session's scene, as one step of the history. label: what the step is
    // called in menus. control: of the control that is being dragged, see History::apply(). An Error, or what was
    // mended, is said at the window's bottom; false: nothing has changed.
    bool apply(ViewState& state, std::vector<Edit> edits, std::string label, std::uint64_t control = 0);
    void undo(ViewState& state);
    void redo(ViewState& state);
    const History& history() const { return history_; }
    // Whether there are changes that are in no file.
    bool is_dirty() const { return is_ready_ && history_.state() != saved_state_; }

    // Puts the scene into another pose. Of many that come faster than pictures only the last counts.
    void pose(ViewState& state, Index<Animation> animation, float seconds);

    // Writes the scene, and the view that is shown as its first camera, as pbrt. What became of it is said later.
    // overwrite: also a file that was not written by snell.
    void save(ViewState& state, const std::filesystem::path& file, bool overwrite);
    bool is_saving() const { return saving_ != nullptr; }
    const std::filesystem::path& file() const { return file_; } // that it was saved as; empty: none yet

    // The selection (or, if nothing is selected, the whole scene) as pbrt text, to the clipboard.
    void copy(ViewState& state);

    // Reads a picture and makes it the environment. What became of it is said later.
    void load_environment(ViewState& state, const std::filesystem::path& file);
    // Reads a picture into the scene's list, for materials. is_color: or numbers. material: if valid, it becomes this
    // one's base colour map.
    void load_texture(ViewState& state, const std::filesystem::path& file, bool is_color,
                      Index<MaterialDesc> material = {});
    bool is_loading() const { return loading_ != nullptr; }

    // Finds what is seen in a pixel of a pane, and selects it: its material and instance are in `hit`.
    void select_at(ViewState& state, std::size_t pane, int x, int y);

    // Of the meshes of the outline; empty until they are counted.
    const std::vector<MeshFigures>& meshes() const { return meshes_; }

    Selection selection;
    Selection hit_instance; // where the last select_at() has hit; nothing: it lies apart
    Playback playback;

  private:
    struct Counted
    {
        std::uint64_t opened;
        std::vector<MeshFigures> meshes;
    };
    struct Saved
    {
        std::filesystem::path file;
        std::uint64_t state;
        std::string error; // empty: it is written
        std::vector<Note> notes;
    };
    struct Loaded
    {
        std::shared_ptr<const Image> image;
        EnvironmentDesc environment;
        bool is_environment;
        Index<MaterialDesc> material;
        std::uint64_t opened; // the scene that it was meant for
        std::string name, error;
    };
    struct Hit
    {
        Selection surface, instance;
    };
    struct PoseRequest
    {
        std::mutex mutex;
        Index<Animation> animation;
        float seconds = 0.0f;
        bool is_taken = false;
    };

    EditContext context(bool is_outline) const;
    void post(ViewState& state, History::Done done);
    void take_over(ViewState& state);
    void take_answers(ViewState& state);
    void play(ViewState& state);
    void load(ViewState& state, const std::filesystem::path& file, bool is_environment, bool is_color,
              Index<MaterialDesc> material);
    void take_picture(ViewState& state, const Loaded& loaded);

    bool is_ready_ = false;
    std::uint64_t opened_ = 0; // ViewState::opened
    History history_;
    std::uint64_t saved_state_ = 0;
    std::filesystem::path file_;
    std::vector<MeshFigures> meshes_;
    double last_time_ = 0.0;
    Index<Animation> posed_;
    float posed_seconds_ = 0.0f;
    std::shared_ptr<PoseRequest> pose_request_; // posted, and perhaps not yet taken
    AnswerPtr<Counted> counting_;
    AnswerPtr<Saved> saving_;
    AnswerPtr<Loaded> loading_;
    AnswerPtr<std::string> copying_;
    AnswerPtr<Hit> hitting_;
};

// Of materials, lights, ...: the name, or what it is and its number.
std::string name_of(const Scene& scene, Selection selection);

} // namespace snell::view
