// Scenes and pictures as files: opening, reading again, dropping, recent ones, screenshots.
#include "snell/view/app.h"

#include "snell/core/error.h"
#include "snell/core/version.h"
#include "snell/io/environment.h"
#include "snell/io/file.h"
#include "snell/io/image/write.h"
#include "snell/kernel/tone.h"
#include "snell/scene/builtin.h"
#include "snell/scene/outline.h"
#include "snell/view/camera_text.h"
#include "snell/view/navigation.h"

#include <SDL.h>

#include <algorithm>
#include <cstdlib>
#include <ctime>
#include <set>
#include <utility>

namespace snell::view {

using Phase = SessionStatus::Phase;

static std::filesystem::file_time_type time_of(const std::string& file)
{
    std::error_code ignored;
    const auto time = std::filesystem::last_write_time(file, ignored);
    return ignored ? std::filesystem::file_time_type{} : time;
}

// ---- scenes ----

void App::open(const std::string& name, bool keeps_camera)
{
    opening_ = name;
    keeps_camera_ = keeps_camera;
    opening_number_ = session_->open(
        name, [load = options_.load, name](const LoadProgressCallback& progress) { return load(name, progress); });
    opening_time_ = time_of(name);
    dismissed_failure_.clear();
    failed_.clear();
    state_.status = session_->status();
    state_.wake();
}

void App::follow_opening()
{
    const SessionStatus& status = state_.status;
    if (status.opened != 0 && status.opened != state_.opened && status.opened != asked_outline_) {
        asked_outline_ = status.opened;
        session_->query([arrived = arrived_](const SessionAccess& access) {
            Scene slim = outline(access.scene);
            const Bounds bounds = scene_bounds(access.scene);
            const std::lock_guard lock(arrived->mutex);
            arrived->outline = std::move(slim);
            arrived->notes = access.scene.notes;
            arrived->bounds = bounds;
            arrived->camera = access.camera;
            arrived->opened = access.scene_opened;
        });
    }

    if (status.phase == Phase::failed && !opening_.empty()) {
        failed_ = std::exchange(opening_, {});
        if (failed_ == state_.file) file_time_ = opening_time_; // not again until it changes once more
    }
    std::optional<Scene> slim;
    {
        const std::lock_guard lock(arrived_->mutex);
        if (arrived_->picked) {
            state_.picked_point = *arrived_->picked;
            arrived_->picked.reset();
            state_.wake();
        }
        if (arrived_->outline && arrived_->opened == status.opened) {
            slim = std::move(arrived_->outline);
            state_.notes = std::move(arrived_->notes);
            state_.bounds = arrived_->bounds;
            if (!keeps_camera_ || state_.opened == 0) state_.camera = arrived_->camera;
            state_.opened = arrived_->opened;
        }
        arrived_->outline.reset();
    }
    if (!slim) return;
    state_.outline = std::move(*slim);
    state_.file = opening_.empty() ? status.name : opening_;
    file_time_ = opening_time_;
    state_.picked.reset();
    state_.picked_point.reset();
    if (keeps_camera_) {
        show_camera(state_.camera, static_cast<double>(SDL_GetTicks64()) * 1e-3);
        state_.say("read again");
    } else {
        state_.speed = natural_speed(state_.bounds);
        state_.is_playing = false;
        camera_to_send_.reset();
    }
    keeps_camera_ = false;
    opening_.clear();
    window_.set_title("snell: " + std::filesystem::path(state_.file).filename().string());
    remember(state_.file);
    state_.wake();
}

// Reads the scene again when its file has changed, and rests until it is whole: who writes it may not be done.
void App::watch_file()
{
    if (state_.file.empty() || !opening_.empty() || state_.time - watched_at_ < 1.0) return;
    watched_at_ = state_.time;
    const auto time = time_of(state_.file);
    if (time == std::filesystem::file_time_type{} || time == file_time_) return;
    if (std::filesystem::file_time_type::clock::now() - time < std::chrono::milliseconds(300)) return;
    open(state_.file, true);
}

void App::drop(const std::string& file)
{
    static const std::set<std::string> scenes = {".gltf", ".glb", ".pbrt", ".obj", ".ply", ".stl", ".gz"};
    static const std::set<std::string> skies = {".hdr", ".exr", ".pfm"};
    static const std::set<std::string> pictures = {".png", ".jpg", ".jpeg", ".webp", ".tga", ".bmp"};
    const std::string ending = lower_extension(file);
    if (scenes.contains(ending)) {
        open(file);
    } else if (skies.contains(ending)) {
        if (state_.opened == 0) return state_.say("open a scene first; then a picture can light it");
        drop_environment(file);
    } else if (pictures.contains(ending)) {
        if (!state_.picked_point || state_.picked_point->material == none)
            return state_.say("click the surface that the picture is for, then drop it again");
        drop_texture(file, state_.picked_point->material);
    } else {
        state_.say(fmt::format("{}: neither a scene (.gltf .glb .pbrt .obj .ply .stl), nor an environment (.hdr .exr), "
                               "nor a texture (.png .jpg .webp)",
                               file));
    }
}

// ---- recent scenes ----

static std::filesystem::path recent_file()
{
    const char* config = std::getenv("XDG_CONFIG_HOME");
    const char* home = std::getenv("HOME");
    if (config != nullptr && *config == '/') return std::filesystem::path(config) / "snell/recent";
    if (home != nullptr && *home == '/') return std::filesystem::path(home) / ".config/snell/recent";
    return {};
}

constexpr std::size_t most_recent = 10;

void App::load_recent()
{
    std::error_code ignored;
    const std::filesystem::path file = recent_file();
    if (file.empty() || !std::filesystem::is_regular_file(file, ignored)) return;
    try {
        const std::string text = read_file(file);
        for (std::size_t begin = 0; begin < text.size() && state_.recent.size() < most_recent;) {
            const std::size_t end = std::min(text.find('\n', begin), text.size());
            if (end > begin) state_.recent.push_back(text.substr(begin, end - begin));
            begin = end + 1;
        }
    } catch (const Error& error) {
        state_.say(error.what());
    }
}

void App::remember(const std::string& name)
{
    std::error_code failed;
    std::string entry = name;
    if (std::filesystem::is_regular_file(name, failed)) {
        const auto whole = std::filesystem::absolute(name, failed);
        if (!failed) entry = whole.string();
    }
    if (entry.find('\n') != std::string::npos) return; // the file has one name a line
    std::erase(state_.recent, entry);
    state_.recent.insert(state_.recent.begin(), entry);
    if (state_.recent.size() > most_recent) state_.recent.resize(most_recent);
    const std::filesystem::path file = recent_file();
    if (!options_.keeps_recent || file.empty()) return;
    std::string text;
    for (const std::string& one : state_.recent) text += one + "\n";
    try {
        std::filesystem::create_directories(file.parent_path(), failed);
        write_atomically(file, text);
    } catch (const Error&) {
        // A list of what was opened is not worth a message each time.
    }
}

// ---- pictures ----

// How `snell render` makes the same picture.
static std::string render_command(const ViewState& state, const RenderSettings& settings, uint spp)
{
    std::string command = fmt::format("snell render {} --size {}x{} --spp {} --seed {} --integrator {} --sampler {} {}",
                                      state.file, settings.width, settings.height, spp, settings.seed,
                                      settings.integrator, settings.sampler, camera_options(state.camera));
    if (settings.device != "cpu") command += " --device " + settings.device;
    if (!settings.accel.empty()) command += " --accel " + settings.accel;
    for (const auto& [key, value] : settings.parameters) command += fmt::format(" -D {}={}", key, value);
    return command;
}

void App::save_screenshot(const std::filesystem::path& file)
{
    const Pane& pane = state_.panes[std::min(state_.active_pane, state_.panes.size() - 1)];
    if (pane.shot == nullptr) throw Error("there is no picture to be saved yet", "wait for the first one");
    const Shot& shot = *pane.shot;
    const RenderSettings& settings = pane.request.settings;
    Layers layers;
    layers.attributes = {{"version", fmt::format("snell {} ({})", version(), commit())},
                         {"commandLine", render_command(state_, settings, shot.spp)},
                         {"integrator", settings.integrator},
                         {"sampler", settings.sampler},
                         {"seed", std::to_string(settings.seed)},
                         {"camera", camera_options(state_.camera)}};
    layers.numbers = {{"spp", shot.spp}, {"seconds", shot.seconds}, {"exposure", state_.exposure_ev}};
    DisplayTransform display;
    if (!shot.is_data) display = {state_.exposure_ev, state_.curve};
    write_picture(file, shot.film.picture(), layers, display);
}

void App::take_screenshot()
{
    const std::time_t now = std::time(nullptr);
    std::tm local{};
    localtime_r(&now, &local);
    char stamp[32];
    std::strftime(stamp, sizeof stamp, "%Y%m%d-%H%M%S", &local);
    const std::string scene = state_.file.empty() ? "snell" : inner_stem(std::filesystem::path(state_.file).filename());
    std::string name = fmt::format("{}-{}", scene, stamp);
    std::replace(name.begin(), name.end(), ':', '-');
    std::error_code ignored;
    for (int again = 2; std::filesystem::exists(name + ".png", ignored); ++again)
        name = fmt::format("{}-{}-{}", scene, stamp, again);
    try {
        save_screenshot(name + ".png");
        save_screenshot(name + ".exr");
        state_.say(fmt::format("wrote {}.png and {}.exr", name, name));
    } catch (const Error& error) {
        state_.say(error.what());
    }
}

void App::copy_camera()
{
    const std::string text = camera_options(state_.camera) + "\n" + camera_pbrt(state_.camera) + "\n";
    fmt::print("{}", text);
    std::fflush(stdout);
    SDL_SetClipboardText(text.c_str());
    state_.say("copied: " + camera_options(state_.camera));
}

void App::write_timings() const
{
    const auto series = [](const TimingSeries& s) {
        return fmt::format("{{\"count\": {}, \"median\": {:.3f}, \"p99\": {:.3f}, \"worst\": {:.3f}}}", s.count(),
                           s.percentile(0.5), s.percentile(0.99), s.percentile(1.0));
    };
    const Timings& t = state_.timings;
    write_atomically(options_.timings,
                     fmt::format("{{\"scene\": \"{}\", \"first_picture_ms\": {:.3f}, \"input_to_picture_ms\": {}, "
                                 "\"frame_ms\": {}, \"ui_ms\": {}, \"convert_ms\": {}, \"frames\": {}}}\n",
                                 state_.file, t.first_picture_ms, series(t.input_to_picture), series(t.frame),
                                 series(t.ui), series(t.convert), frames_));
}

} // namespace snell::view
