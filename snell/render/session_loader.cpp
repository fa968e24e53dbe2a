#include "snell/render/session_loader.h"

#include "snell/core/error.h"
#include "snell/core/parallel.h"
#include "snell/core/timer.h"
#include "snell/scene/bounds.h"

namespace snell {

constexpr std::size_t most_boxes = 1000;

SceneLoader::SceneLoader(std::function<void(std::unique_ptr<LoadedScene>)> deliver) : deliver_(std::move(deliver))
{
    thread_ = std::thread([this] { run(); });
}

void SceneLoader::open(Job job)
{
    {
        const std::lock_guard lock(mutex_);
        cancel_ = true;
        status_ = {};
        status_.is_busy = true;
        status_.number = job.number;
        status_.name = job.name;
        next_ = std::move(job);
    }
    wake_.notify_one();
}

void SceneLoader::cancel()
{
    const std::lock_guard lock(mutex_);
    cancel_ = true;
    next_.reset();
    status_ = {};
}

void SceneLoader::stop()
{
    if (!thread_.joinable()) return;
    {
        const std::lock_guard lock(mutex_);
        stop_ = true;
        cancel_ = true;
    }
    wake_.notify_one();
    thread_.join();
}

bool SceneLoader::is_busy() const
{
    const std::lock_guard lock(mutex_);
    return status_.is_busy;
}

LoadStatus SceneLoader::status() const
{
    const std::lock_guard lock(mutex_);
    return status_;
}

void SceneLoader::run()
{
    for (;;) {
        Job job;
        {
            std::unique_lock lock(mutex_);
            wake_.wait(lock, [&] { return stop_ || next_; });
            if (stop_) return;
            job = std::move(*next_);
            next_.reset();
            cancel_ = false;
        }
        std::unique_ptr<LoadedScene> loaded;
        std::string error;
        try {
            const CancelScope scope(cancel_);
            loaded = load(job);
        } catch (const Cancelled&) {
        } catch (const std::exception& e) {
            error = e.what();
        }
        {
            const std::lock_guard lock(mutex_);
            if (cancel_) continue; // somebody has asked for something else: that has the status now
            status_.error = error;
        }
        deliver_(std::move(loaded)); // first: as long as this is busy, there is a scene to wait for
        const std::lock_guard lock(mutex_);
        if (cancel_) continue;
        status_.is_busy = status_.is_preparing = false;
        status_.sketch.reset();
    }
}

static std::shared_ptr<const SceneSketch> sketch(const Scene& scene, const SceneLoader::Job& job)
{
    auto result = std::make_shared<SceneSketch>();
    result->name = job.name;
    result->opened = job.number;
    result->camera = scene.cameras.front();
    std::vector<std::optional<Bounds>> meshes(scene.meshes.size());
    for (const InstanceDesc& instance : scene.instances) {
        const Group& group = scene.groups[instance.group.value];
        for (const Index<Mesh> mesh : group.meshes) {
            std::optional<Bounds>& own = meshes[mesh.value];
            if (!own) own = group_bounds(scene, Group{{}, {mesh}, {}}, identity_transform());
            if (own->empty()) continue;
            const Bounds box = transformed(*own, instance.transform);
            extend(result->bounds, box);
            if (result->boxes.size() < most_boxes) result->boxes.push_back(box);
        }
        if (group.spheres.empty()) continue;
        const Bounds box = group_bounds(scene, Group{{}, {}, group.spheres}, instance.transform);
        extend(result->bounds, box);
        if (result->boxes.size() < most_boxes) result->boxes.push_back(box);
    }
    return result;
}

std::unique_ptr<LoadedScene> SceneLoader::load(const Job& job)
{
    const auto tell = [&](const auto& write) {
        const std::lock_guard lock(mutex_);
        if (cancel_) throw Cancelled();
        write(status_);
    };
    const Timer timer;
    auto loaded = std::make_unique<LoadedScene>();
    loaded->name = job.name;
    loaded->opened = job.number;
    loaded->scene = std::make_unique<Scene>(job.load([&](const LoadProgress& progress) {
        tell([&](LoadStatus& status) {
            status.what = progress.what;
            status.fraction = progress.fraction;
        });
    }));
    tell([&](LoadStatus& status) {
        status.is_preparing = true;
        status.what = "looking through the scene";
        status.fraction = 1;
    });
    Scene& scene = *loaded->scene;
    validate(scene);
    const bool has_size = !job.settings.empty() && job.settings[0].width > 0 && job.settings[0].height > 0;
    complete(scene, has_size ? static_cast<float>(job.settings[0].width) / static_cast<float>(job.settings[0].height)
                             : 16.0f / 9.0f);
    loaded->load_seconds = timer.seconds();
    const auto boxes = sketch(scene, job);
    tell([&](LoadStatus& status) {
        status.sketch = boxes;
        status.what = "building trees";
    });
    prepare(*loaded, job.settings);
    tell([](LoadStatus&) {});
    return loaded;
}

// Settings that make no sense are the panes' trouble, and the scene comes all the same; one that cannot be prepared at
// all is not opened.
void SceneLoader::prepare(LoadedScene& loaded, const std::vector<RenderSettings>& settings) const
{
    bool any = false;
    for (const RenderSettings& s : settings) {
        try {
            loaded.prepared.get(*loaded.scene, s);
            any = true;
        } catch (const Error&) {
            continue; // the pane will be told when it tries
        }
    }
    if (!any) loaded.prepared.get(*loaded.scene, {});
}

} // namespace snell
