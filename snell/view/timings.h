// How quickly the window answers: times between frames and from input to the picture that answers it.
#pragma once

#include <cstddef>
#include <deque>

namespace snell::view {

// The latest values of one kind, in milliseconds.
class TimingSeries
{
  public:
    void add(double ms);
    bool empty() const { return values_.empty(); }
    std::size_t count() const { return count_; } // of all that were ever added
    double last() const { return values_.empty() ? 0.0 : values_.back(); }
    // Of the latest 1000; p in [0, 1]: 0.5 is the median, 0.99 what one in a hundred exceeds. 0 if there are none.
    double percentile(double p) const;
    const std::deque<double>& values() const { return values_; }
    void clear() { values_.clear(), count_ = 0; }

  private:
    std::deque<double> values_;
    std::size_t count_ = 0;
};

struct Timings
{
    TimingSeries input_to_picture; // from an event to the end of the frame with the first picture that answers it
    TimingSeries frame;            // between pictures shown while things move
    TimingSeries ui;               // the user interface's own work in a frame: events, controls, upload, drawing
    TimingSeries convert;          // of it: from radiance to the texture
    double first_picture_ms = 0;   // from the start of the viewer to its first picture; 0: none yet
};

} // namespace snell::view
