#include "snell/render/session_pane.h"

#include "snell/core/error.h"
#include "snell/core/parallel.h"
#include "snell/render/render_stats.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <utility>

namespace snell {

// Seconds between pictures that are only better than the one before: while parts have no samples at all, and later.
constexpr double first_interval = 0.1, interval = 0.19;
// Copying pictures may take that part of the time.
constexpr double copy_share = 0.05;
// A whole sample a pixel that takes less is not worth pictures at lower scales.
constexpr double short_wait = 0.1;
constexpr uint most_samples_a_pass = 32;
constexpr std::size_t most_free_shots = 3;

std::shared_ptr<Shot> ShotPool::take(int width, int height)
{
    std::unique_ptr<Shot> shot;
    {
        const std::lock_guard lock(mutex_);
        const auto fits = std::find_if(free_.begin(), free_.end(), [&](const auto& free) {
            return free->film.width == width && free->film.height == height;
        });
        if (fits != free_.end()) {
            shot = std::move(*fits);
            free_.erase(fits);
        }
    }
    if (!shot) shot = std::make_unique<Shot>();
    return {shot.release(), [pool = shared_from_this()](Shot* s) { pool->give(std::unique_ptr<Shot>(s)); }};
}

void ShotPool::give(std::unique_ptr<Shot> shot)
{
    const ShotPtr under = std::move(shot->under); // which may come here as well, when this function has ended
    const std::lock_guard lock(mutex_);
    free_.push_back(std::move(shot));
    if (free_.size() > most_free_shots) free_.erase(free_.begin());
}

template <class T>
static void copy(const std::vector<T>& from, std::vector<T>& to)
{
    to.resize(from.size());
    parallel_ranges(from.size(), 1 << 16, [&](std::size_t begin, std::size_t end) {
        std::copy(from.begin() + static_cast<std::ptrdiff_t>(begin), from.begin() + static_cast<std::ptrdiff_t>(end),
                  to.begin() + static_cast<std::ptrdiff_t>(begin));
    });
}

// All but the excess, which only further samples would need.
static void copy_film(const Film& from, Film& to)
{
    to.width = from.width;
    to.height = from.height;
    copy(from.sum, to.sum);
    copy(from.square_sum, to.square_sum);
    copy(from.sample_count, to.sample_count);
    copy(from.seen_through, to.seen_through);
    to.layers = from.layers;
    to.dropped = from.dropped;
    to.dropped_samples = from.dropped_samples;
}

SessionPane::SessionPane(const PaneRequest& request, std::shared_ptr<ShotPool> pool)
    : settings_(request.settings), is_rendered_(request.is_rendered), pool_(std::move(pool))
{
}

void SessionPane::ask(const PaneRequest& request)
{
    const RenderSettings& settings = request.settings;
    if (settings == settings_ && request.is_rendered == is_rendered_) return;
    RenderSettings same = settings;
    same.spp = settings_.spp;
    const bool goes_on = same == settings_ && request.is_rendered == is_rendered_ && error_.empty() && rendering_ &&
                         is_whole_ && !torn_ && !settings.layers && settings.spp > 0;
    settings_ = settings;
    is_rendered_ = request.is_rendered;
    if (!goes_on) {
        error_.clear();
        begin();
        return;
    }
    stage_ = done_ < settings_.spp ? Stage::refine : Stage::finished;
    is_new_ = is_urgent_ = true; // it is finished now, or is no longer
}

void SessionPane::use(const Prepared* prepared, std::string error)
{
    if (prepared == prepared_ && error == error_) return;
    prepared_ = prepared;
    error_ = std::move(error);
    begin();
}

void SessionPane::begin()
{
    count();
    rendering_.reset();
    stage_ = Stage::preview;
    generation_ += 1;
    torn_ = is_new_ = is_urgent_ = false;
}

void SessionPane::try_again()
{
    if (prepared_ != nullptr) error_.clear();
    begin();
}

// The bounces to hold the integrator to, where it would make more; else 0.
static uint held_depth(const RenderSettings& settings, uint max_depth)
{
    const IntegratorInfo* integrator = find_integrator(settings.integrator);
    if (max_depth == 0 || integrator == nullptr) return 0;
    constexpr std::string_view key = "max_depth=";
    for (const std::string& line : integrator->parameters) {
        if (!line.starts_with(key)) continue;
        const auto given = settings.parameters.find("max_depth");
        const std::string text = given == settings.parameters.end() ? line.substr(key.size()) : given->second;
        uint asked = 0;
        if (std::from_chars(text.data(), text.data() + text.size(), asked).ec != std::errc()) return 0;
        const bool is_unlimited = asked == 0 && integrator->name != "whitted";
        return is_unlimited || asked > max_depth ? max_depth : 0;
    }
    return 0;
}

static int scaled(int side, float scale)
{
    return std::max(1, static_cast<int>(std::lround(static_cast<float>(side) * scale)));
}

static RenderSettings reduced(RenderSettings settings, float scale, uint depth)
{
    settings.spp = 1;
    settings.layers = false;
    settings.width = scaled(settings.width, scale);
    settings.height = scaled(settings.height, scale);
    if (settings.region) {
        Region& r = *settings.region;
        const auto down = [&](int x) { return static_cast<int>(std::floor(static_cast<float>(x) * scale)); };
        const auto up = [&](int x) { return static_cast<int>(std::ceil(static_cast<float>(x) * scale)); };
        r = {down(r.x0), down(r.y0), up(r.x1), up(r.y1)};
    }
    if (depth > 0) settings.parameters["max_depth"] = std::to_string(depth);
    return settings;
}

void SessionPane::start(const CameraDesc& camera, float scale, uint max_depth)
{
    count();
    const uint depth = held_depth(settings_, max_depth);
    scale_ = scale;
    is_whole_ = scale >= 1.0f && depth == 0;
    // A size that makes no sense is told as it was given.
    const bool has_pixels = settings_.width > 0 && settings_.height > 0 && settings_.spp > 0;
    rendering_.reset();
    rendering_ = std::make_unique<Rendering>(
        *prepared_, is_whole_ || !has_pixels ? settings_ : reduced(settings_, scale, depth), camera);
    counted_ = {};
    done_ = 0;
    next_tile_ = 0;
    torn_ = false;
    seconds_ = 0;
}

bool SessionPane::preview(const CameraDesc& camera, const GovernorState& governor, const KeepGoing& keep_going)
{
    is_new_ = is_urgent_ = false;
    try {
        start(camera, governor.scale, governor.max_depth);
        add_samples(rendering_->region(), keep_going);
    } catch (const std::exception& e) {
        error_ = e.what();
        begin();
        return true;
    }
    if (torn_) return false;
    finish_pass();
    return true;
}

double SessionPane::fraction() const
{
    if (!rendering_) return 0;
    const Region& r = rendering_->region();
    return static_cast<double>(rendering_->stats().samples) / (double(r.x1 - r.x0) * double(r.y1 - r.y0));
}

void SessionPane::refine(const CameraDesc& camera, double seconds, const KeepGoing& keep_going)
{
    try {
        if (!is_whole_ && done_ > 0) start_next(camera);
        const Region chunk = next_chunk(seconds);
        add_samples(chunk, keep_going);
    } catch (const std::exception& e) {
        error_ = e.what();
        begin();
        return;
    }
    if (torn_) return;
    is_new_ = is_whole_;
    const Region& r = rendering_->region();
    if (next_tile_ >= tiles(r.x1 - r.x0) * tiles(r.y1 - r.y0)) finish_pass();
}

// The next scale at which the picture is rendered.
void SessionPane::start_next(const CameraDesc& camera)
{
    const double full = sample_seconds_ * settings_.width * settings_.height;
    const bool stays_coarse = 2.0f * scale_ < 0.6f && full > short_wait;
    start(camera, stays_coarse ? 2.0f * scale_ : 1.0f, 0);
}

uint SessionPane::pass_samples() const
{
    if (!is_whole_ || done_ == 0) return 1;
    return std::min({done_, most_samples_a_pass, settings_.spp - done_});
}

void SessionPane::add_samples(const Region& part, const KeepGoing& keep_going)
{
    const uint samples = pass_samples();
    const Timer timer;
    set_thread_count(settings_.threads);
    rendering_->add_samples(part, done_, samples, [&] {
        torn_ = torn_ || !keep_going();
        return !torn_;
    });
    const double seconds = timer.seconds();
    seconds_ += seconds;
    sample_seconds_ = seconds / (double(part.x1 - part.x0) * double(part.y1 - part.y0) * samples);
}

int SessionPane::tile_size() const
{
    return std::max(16, settings_.tile_size);
}

int SessionPane::tiles(int pixels) const
{
    return (pixels + tile_size() - 1) / tile_size();
}

// Part of a row of tiles, or whole rows.
Region SessionPane::next_chunk(double seconds)
{
    const Region& r = rendering_->region();
    const int size = tile_size(), columns = tiles(r.x1 - r.x0), rows = tiles(r.y1 - r.y0);
    const double tile_seconds = sample_seconds_ * size * size * pass_samples();
    const double wanted = tile_seconds > 0 ? seconds / tile_seconds : 1.0;
    const double all = static_cast<double>(columns) * rows;
    const int count = static_cast<int>(std::clamp(wanted, std::min<double>(thread_count(), all), all));
    const int column = next_tile_ % columns, row = next_tile_ / columns;
    const int in_row = count >= columns ? columns : std::min(count, columns - column);
    const int down = column == 0 && in_row == columns ? std::min(count / columns, rows - row) : 1;
    next_tile_ += column == 0 && in_row == columns ? down * columns : std::min(in_row, columns - column);
    const int x0 = r.x0 + column * size, y0 = r.y0 + row * size;
    return {x0, y0, std::min(x0 + in_row * size, r.x1), std::min(y0 + down * size, r.y1)};
}

void SessionPane::finish_pass()
{
    const bool was_first = done_ == 0;
    done_ += pass_samples();
    next_tile_ = 0;
    bool is_finished = is_whole_ && done_ >= settings_.spp;
    if (is_whole_ && settings_.timeout_seconds > 0 && seconds_ > settings_.timeout_seconds) is_finished = true;
    if (is_whole_ && settings_.target_error > 0 &&
        rendering_->film.estimated_relmse(rendering_->region()) <= settings_.target_error)
        is_finished = true;
    stage_ = is_finished ? Stage::finished : Stage::refine;
    is_new_ = true;
    is_urgent_ = is_urgent_ || was_first || is_finished;
}

ShotPtr SessionPane::publish(std::uint64_t input, bool is_awaited, bool is_paused)
{
    // What asked for nothing new is answered as well.
    if (input > published_input_ && done_ > 0 && (is_paused || stage_ == Stage::finished)) is_new_ = is_urgent_ = true;
    if (!rendering_ || !is_new_ || torn_ || !error_.empty()) return nullptr;
    const double least = std::max(done_ == 0 ? first_interval : interval, copy_seconds_ / copy_share);
    if (!is_urgent_ && (!is_awaited || since_published_.seconds() < least)) return nullptr;

    const Timer timer;
    const Film& film = rendering_->film;
    const std::shared_ptr<Shot> shot = pool_->take(film.width, film.height);
    copy_film(film, shot->film);
    shot->width = settings_.width;
    shot->height = settings_.height;
    shot->is_data = rendering_->integrator.is_view;
    shot->input = input;
    shot->seconds = seconds_;
    shot->spp = done_;
    shot->stats = rendering_->stats();
    shot->stats.render_seconds = seconds_;
    shot->stats.pack_seconds = prepared_->pack_seconds;
    shot->stats.build_seconds = prepared_->build_seconds;
    shot->stats.updated = prepared_->updated;
    shot->stats.scene_bytes = prepared_->packed.bytes();
    shot->stats.accel_bytes = prepared_->accel->stats.bytes;
    shot->generation = generation_;
    shot->finished = stage_ == Stage::finished;
    shot->is_preview = !is_whole_;
    shot->under = done_ == 0 ? last_complete_ : nullptr;
    if (done_ > 0) last_complete_ = shot;
    copy_seconds_ = timer.seconds();
    since_published_ = Timer();
    published_input_ = input;
    is_new_ = is_urgent_ = false;
    return shot;
}

void SessionPane::count()
{
    if (!rendering_) return;
    const RenderStats now = rendering_->stats();
    add(uncounted_, difference(now, counted_));
    counted_ = now;
}

RenderStats SessionPane::take_stats()
{
    count();
    return std::exchange(uncounted_, {});
}

} // namespace snell
