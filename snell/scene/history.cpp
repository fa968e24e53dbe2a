#include "snell/scene/history.h"

#include "snell/core/error.h"

#include <algorithm>
#include <iterator>

namespace snell {

static std::size_t bytes_of(const HistoryStep& step)
{
    std::size_t bytes = sizeof(HistoryStep) + step.label.size();
    for (const std::vector<Edit>* edits : {&step.redo, &step.undo})
        for (const Edit& edit : *edits) bytes += bytes_of(edit);
    return bytes;
}

// Whether these edits can become part of the last step.
bool History::continues(const std::vector<Edit>& edits, std::uint64_t control) const
{
    if (!is_open_ || control == 0 || done_ == 0 || done_ != steps_.size()) return false;
    const HistoryStep& last = steps_.back();
    return last.control == control && std::equal(last.redo.begin(), last.redo.end(), edits.begin(), edits.end(),
                                                 [](const Edit& a, const Edit& b) { return sets_the_same(a, b); });
}

History::Done History::apply(Scene& scene, std::vector<Edit> edits, std::string label, std::uint64_t control,
                             const EditContext& context)
{
    Done done;
    HistoryStep step;
    for (Edit& edit : edits) {
        try {
            AppliedEdit applied = apply_edit(scene, std::move(edit), context);
            done.changes |= applied.changes;
            if (!applied.mended.empty()) done.mended += (done.mended.empty() ? "" : ", ") + applied.mended;
            step.redo.push_back(std::move(applied.edit));
            step.undo.push_back(std::move(applied.inverse));
        } catch (const Error&) {
            for (auto inverse = step.undo.rbegin(); inverse != step.undo.rend(); ++inverse)
                reapply(scene, *inverse, context);
            throw;
        }
    }
    if (step.redo.empty()) return done;
    done.edits = step.redo;
    std::reverse(step.undo.begin(), step.undo.end());
    const bool joins = continues(step.redo, control);
    step.control = control;
    step.state = ++last_state_;
    step.label = std::move(label);
    while (steps_.size() > done_) {
        bytes_ -= bytes_of(steps_.back());
        steps_.pop_back();
    }
    if (joins) {
        step.undo = std::move(steps_.back().undo);
        steps_.back().undo.clear();
        bytes_ -= bytes_of(steps_.back());
        for (const Edit& edit : step.undo) bytes_ -= snell::bytes_of(edit);
        steps_.pop_back();
    }
    bytes_ += bytes_of(step);
    steps_.push_back(std::move(step));
    done_ = steps_.size();
    is_open_ = true;
    forget();
    return done;
}

void History::forget()
{
    while (bytes_ > max_bytes_ && steps_.size() > 1) {
        first_state_ = steps_.front().state;
        bytes_ -= bytes_of(steps_.front());
        steps_.pop_front();
        --done_;
    }
}

static History::Done reapply_all(Scene& scene, const std::vector<Edit>& edits, const EditContext& context)
{
    History::Done done;
    done.edits = edits;
    for (const Edit& edit : edits) done.changes |= reapply(scene, edit, context);
    return done;
}

History::Done History::undo(Scene& scene, const EditContext& context)
{
    if (done_ == 0) return {};
    is_open_ = false;
    return reapply_all(scene, steps_[--done_].undo, context);
}

History::Done History::redo(Scene& scene, const EditContext& context)
{
    if (done_ == steps_.size()) return {};
    is_open_ = false;
    return reapply_all(scene, steps_[done_++].redo, context);
}

void History::clear()
{
    steps_.clear();
    done_ = bytes_ = 0;
    first_state_ = ++last_state_;
    is_open_ = false;
}

} // namespace snell
