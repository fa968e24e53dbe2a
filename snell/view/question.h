// A question that a panel puts to the session's thread, and the latest answer: the user interface never waits for it.
#pragma once

#include "snell/render/session.h"

#include <exception>
#include <functional>
#include <memory>
#include <mutex>
#include <string>

namespace snell::view {

// Used from the user interface's thread. One question is under way at a time.
template <class Answer>
class Question
{
  public:
    bool is_asked() const
    {
        const std::lock_guard lock(shared_->mutex);
        return shared_->is_asked;
    }

    // Not while one is under way. What `answer` captures must own what it needs: the panel may be gone by then.
    void ask(Session& session, std::function<Answer(const SessionAccess&)> answer)
    {
        {
            const std::lock_guard lock(shared_->mutex);
            shared_->is_asked = true;
        }
        session.query([shared = shared_, answer = std::move(answer)](const SessionAccess& access) {
            std::shared_ptr<const Answer> found;
            std::string error;
            try {
                found = std::make_shared<const Answer>(answer(access));
            } catch (const std::exception& e) {
                error = e.what();
            }
            const std::lock_guard lock(shared->mutex);
            if (found != nullptr) shared->answer = std::move(found);
            shared->error = std::move(error);
            shared->is_asked = false;
            ++shared->count;
        });
    }

    // The latest; null: none yet.
    std::shared_ptr<const Answer> answer() const
    {
        const std::lock_guard lock(shared_->mutex);
        return shared_->answer;
    }
    // Why the last question has no answer; empty: it has.
    std::string error() const
    {
        const std::lock_guard lock(shared_->mutex);
        return shared_->error;
    }
    std::size_t count() const // of questions that were answered
    {
        const std::lock_guard lock(shared_->mutex);
        return shared_->count;
    }
    void forget()
    {
        const std::lock_guard lock(shared_->mutex);
        shared_->answer = nullptr;
        shared_->error.clear();
    }

  private:
    struct Shared
    {
        std::mutex mutex;
        std::shared_ptr<const Answer> answer;
        std::string error;
        std::size_t count = 0;
        bool is_asked = false;
    };
    std::shared_ptr<Shared> shared_ = std::make_shared<Shared>();
};

} // namespace snell::view
