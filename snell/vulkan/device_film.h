// The film of a picture on the device, with the copy that the host has of it.
#pragma once

#include "snell/render/film.h"
#include "snell/vulkan/gpu.h"
#include "snell/vulkan/shaders/job.h"

namespace snell {

class DeviceFilm
{
  public:
    // Room for so many pixels. Throws Error if the device has not enough memory.
    DeviceFilm(const std::shared_ptr<Gpu>& gpu, std::size_t pixels, bool with_layers);

    bool has_room(std::size_t pixels, bool with_layers) const
    {
        return pixels <= capacity_ && (layers_ != nullptr) == with_layers;
    }

    // From now on it holds these pixels of a picture, and they are empty.
    void begin(const Region& area);
    GpuFilm describe() const;

    // Records what makes the device have what `film` has in `part`, which lies in the area: copies of the rows that it
    // has otherwise. Those to follow are of this part. Nothing that changes or fetches it may be under way.
    void follow(Gpu::Commands& commands, const Film& film, const Region& part);
    // Kernels that were recorded change these pixels, counted in the rows of the part.
    void note_changed(std::size_t first_pixel, std::size_t pixels);
    // Records copies to the host of what has changed since the last time.
    void fetch(Gpu::Commands& commands);
    // When those have run, and before it is fetched again: puts what was fetched into the film. `dropped`: as the
    // device had it by then, of all since follow().
    void take(Film& film, const GpuDropped& dropped);

    const GpuBuffer dropped; // GpuDropped

    // Bytes that were copied so far, for tests: to the device and to the host.
    std::size_t bytes_up = 0, bytes_down = 0;

  private:
    struct Rows
    {
        std::size_t begin = 0, end = 0; // of the part
    };
    std::size_t pixel_at(std::size_t row) const; // where a row of the part begins in the area
    void copy_rows(Gpu::Commands& commands, const GpuBuffer& from, const GpuBuffer& to, std::size_t pixel_bytes,
                   const std::vector<std::size_t>& rows) const;
    PixelSums* sums() const { return static_cast<PixelSums*>(seen_sums_.data); }
    GpuPixelLayers* layers() const { return static_cast<GpuPixelLayers*>(seen_layers_->data); }

    const std::size_t capacity_;
    const GpuBuffer sums_, seen_sums_;
    std::unique_ptr<GpuBuffer> layers_, seen_layers_;
    Region area_, part_;
    bool is_empty_ = false; // to be filled with zeros before anything else
    Rows changed_, fetched_;
    GpuDropped counted_{}; // what the film knows of since follow()
};

} // namespace snell
