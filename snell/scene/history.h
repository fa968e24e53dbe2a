// What was edited, so that it can be undone and done again.
#pragma once

#include "snell/scene/edit.h"

#include <deque>

namespace snell {

// One thing that the user did: edits that go together.
struct HistoryStep
{
    std::string label;            // what menus call it: "material 'brass'"
    std::vector<Edit> redo, undo; // for reapply(), each in its order
    std::uint64_t control = 0;    // that made it; 0: no dragging
    std::uint64_t state = 0;      // the scene's after it
};

class History
{
  public:
    // Forgets the oldest steps when all of them hold more than max_bytes; the newest one always stays.
    explicit History(std::size_t max_bytes = std::size_t{64} << 20) : max_bytes_(max_bytes) {}

    struct Done
    {
        std::vector<Edit> edits; // as they were applied: for reapply() to another copy of the scene
        uint changes = change_none;
        std::string mended;
    };

    // Applies the edits to the scene, all of them or, if one throws Error, none. With a `control` other than 0, which
    // edits the same things as the last step did, and no seal() in between, both become one step: while a slider is
    // dragged. What had been undone is forgotten.
    Done apply(Scene& scene, std::vector<Edit> edits, std::string label, std::uint64_t control = 0,
               const EditContext& context = {});

    // The last step is over: the next one is another, whatever made it.
    void seal() { is_open_ = false; }

    // Nothing to undo, or redo: no edits.
    Done undo(Scene& scene, const EditContext& context = {});
    Done redo(Scene& scene, const EditContext& context = {});

    // Labels of what undo() and redo() would do; null: nothing.
    const std::string* undo_label() const { return done_ > 0 ? &steps_[done_ - 1].label : nullptr; }
    const std::string* redo_label() const { return done_ < steps_.size() ? &steps_[done_].label : nullptr; }

    // Names the state that the scene is in: it is the same number again after undo() and redo() have led back to it.
    std::uint64_t state() const { return done_ > 0 ? steps_[done_ - 1].state : first_state_; }

    void clear();
    std::size_t bytes() const { return bytes_; }
    std::size_t size() const { return steps_.size(); }

  private:
    bool continues(const std::vector<Edit>& edits, std::uint64_t control) const;
    void forget();

    std::deque<HistoryStep> steps_;
    std::size_t done_ = 0; // of the steps; those after it were undone
    std::size_t bytes_ = 0;
    const std::size_t max_bytes_;
    std::uint64_t first_state_ = 0, last_state_ = 0;
    bool is_open_ = false;
};

} // namespace snell
