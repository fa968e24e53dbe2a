// One pane of a session: its picture, from the first preview to the last sample.
#pragma once

#include "snell/core/timer.h"
#include "snell/render/rendering.h"
#include "snell/render/session.h"

#include <memory>
#include <mutex>

namespace snell {

// Shots that nobody looks at any more, whose memory is used again.
class ShotPool : public std::enable_shared_from_this<ShotPool>
{
  public:
    std::shared_ptr<Shot> take(int width, int height);

  private:
    void give(std::unique_ptr<Shot> shot);

    std::mutex mutex_;
    std::vector<std::unique_ptr<Shot>> free_;
};

// All of it is called on the session's thread. A picture begins with a preview, at the scale and depth that the
// governor allows. Then it comes at twice the scale, up to a half, at full depth, and at last at full size, in passes
// of 1, 1, 2, 4, ... samples. The work is cut into chunks of tiles.
class SessionPane
{
  public:
    using KeepGoing = std::function<bool()>;

    SessionPane(const PaneRequest& request, std::shared_ptr<ShotPool> pool);

    const RenderSettings& settings() const { return settings_; }
    // Other settings; the picture goes on if they only ask for more or fewer samples.
    void ask(const PaneRequest& request);
    bool is_rendered() const { return is_rendered_; }
    // null: nothing can be rendered, for that reason.
    void use(const Prepared* prepared, std::string error = {});
    const Prepared* prepared() const { return prepared_; }
    const std::string& error() const { return error_; }
    // The picture shows something else from now on. Nothing refers to prepared() until the next preview().
    void begin();
    // The same, where there was an error that may be gone now.
    void try_again();

    bool wants_preview() const { return prepared_ != nullptr && error_.empty() && stage_ == Stage::preview; }
    bool wants_more() const { return prepared_ != nullptr && error_.empty() && stage_ == Stage::refine; }
    // Seconds of rendering in this picture.
    double seconds() const { return seconds_; }
    // Renders the preview; false: keep_going() has stopped it, and `fraction` of it was done.
    bool preview(const CameraDesc& camera, const GovernorState& governor, const KeepGoing& keep_going);
    double fraction() const;
    // Renders for about `seconds`. If keep_going() stops it, the picture must begin() anew.
    void refine(const CameraDesc& camera, double seconds, const KeepGoing& keep_going);
    bool is_torn() const { return torn_; } // refine() was stopped: pixels are no longer what they should be

    // A picture to show, if there is a new one and it is time. is_awaited: the last one has been looked at. is_paused:
    // it stays as it is, though it could be refined.
    ShotPtr publish(std::uint64_t input, bool is_awaited, bool is_paused);
    // What was counted since the last call.
    RenderStats take_stats();
    double copy_seconds() const { return copy_seconds_; }

  private:
    enum class Stage
    {
        preview,
        refine,
        finished
    };

    void start(const CameraDesc& camera, float scale, uint max_depth);
    void start_next(const CameraDesc& camera);
    void add_samples(const Region& part, const KeepGoing& keep_going);
    void finish_pass();
    Region next_chunk(double seconds);
    uint pass_samples() const;
    int tile_size() const;
    int tiles(int pixels) const; // along a side
    void count();

    RenderSettings settings_;
    bool is_rendered_ = true;
    std::shared_ptr<ShotPool> pool_;
    const Prepared* prepared_ = nullptr;
    std::string error_;

    Stage stage_ = Stage::preview;
    std::uint64_t generation_ = 0;

    std::unique_ptr<Rendering> rendering_;
    float scale_ = 1.0f;   // of rendering_
    bool is_whole_ = true; // rendering_ is what was asked for, not less
    uint done_ = 0;        // samples that all pixels of rendering_ have
    int next_tile_ = 0;    // of the pass
    bool torn_ = false;
    double seconds_ = 0;        // that rendering_ has taken
    double sample_seconds_ = 0; // that one sample of one pixel has taken lately; 0: not known
    RenderStats counted_;       // of rendering_
    RenderStats uncounted_;     // for take_stats()

    bool is_new_ = false;    // there is something to publish
    bool is_urgent_ = false; // at once
    Timer since_published_;
    double copy_seconds_ = 0;
    std::uint64_t published_input_ = 0;
    ShotPtr last_complete_;
};

} // namespace snell
