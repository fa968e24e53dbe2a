// Opens scenes for a session, on a thread of its own.
#pragma once

#include "snell/render/session.h"
#include "snell/render/session_prepared.h"

#include <atomic>
#include <condition_variable>
#include <mutex>
#include <optional>
#include <thread>

namespace snell {

// A scene with all that is needed to show it.
struct LoadedScene
{
    std::unique_ptr<Scene> scene;
    PreparedSet prepared;
    std::string name;
    std::uint64_t opened = 0;
    double load_seconds = 0;
};

struct LoadStatus
{
    std::uint64_t number = 0; // of the open()
    bool is_busy = false, is_preparing = false;
    std::string name, what, error; // error: why the last one could not be opened
    double fraction = 0;
    std::shared_ptr<const SceneSketch> sketch;
};

class SceneLoader
{
  public:
    struct Job
    {
        std::uint64_t number = 0;
        std::string name;
        std::function<Scene(const LoadProgressCallback&)> load;
        std::vector<RenderSettings> settings; // of the panes: to prepare for
    };

    // deliver: called on the loader's thread, with null when there is no scene to come any more.
    explicit SceneLoader(std::function<void(std::unique_ptr<LoadedScene>)> deliver);
    ~SceneLoader() { stop(); }
    SceneLoader(const SceneLoader&) = delete;
    SceneLoader& operator=(const SceneLoader&) = delete;

    void open(Job job); // instead of what is being opened now
    void cancel();
    void stop(); // and waits
    bool is_busy() const;
    LoadStatus status() const;

  private:
    void run();
    std::unique_ptr<LoadedScene> load(const Job& job);
    void prepare(LoadedScene& loaded, const std::vector<RenderSettings>& settings) const;

    const std::function<void(std::unique_ptr<LoadedScene>)> deliver_;
    mutable std::mutex mutex_; // of what follows
    std::condition_variable wake_;
    std::optional<Job> next_;
    LoadStatus status_;
    bool stop_ = false;
    std::atomic<bool> cancel_ = false; // the job that is under way
    std::thread thread_;
};

} // namespace snell
