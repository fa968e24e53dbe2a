#include "snell/vulkan/device_film.h"

#include "snell/core/error.h"
#include "snell/core/parallel.h"
#include "snell/render/film_samples.h"

#include <algorithm>
#include <cstring>

namespace snell {

constexpr auto on_device = GpuBuffer::Placement::device, for_host = GpuBuffer::Placement::readback;
static_assert(max_dropped_pixels == dropped_pixels);

static std::size_t width(const Region& r)
{
    return static_cast<std::size_t>(r.x1 - r.x0);
}

static std::size_t height(const Region& r)
{
    return static_cast<std::size_t>(r.y1 - r.y0);
}

DeviceFilm::DeviceFilm(const std::shared_ptr<Gpu>& gpu, std::size_t pixels, bool with_layers)
    : dropped(*gpu, sizeof(GpuDropped), on_device, "the picture"), capacity_(pixels),
      sums_(*gpu, pixels * sizeof(PixelSums), on_device, "the picture"),
      seen_sums_(*gpu, pixels * sizeof(PixelSums), for_host, "the picture")
{
    if (!with_layers) return;
    const std::size_t bytes = pixels * sizeof(GpuPixelLayers);
    layers_ = std::make_unique<GpuBuffer>(*gpu, bytes, on_device, "the layers of the picture");
    seen_layers_ = std::make_unique<GpuBuffer>(*gpu, bytes, for_host, "the layers of the picture");
}

void DeviceFilm::begin(const Region& area)
{
    SNELL_CHECK_LE(width(area) * height(area), capacity_);
    area_ = part_ = area;
    is_empty_ = true;
    parallel_for(height(area), [&](std::size_t row) {
        const std::size_t first = row * width(area_), count = width(area_);
        std::memset(static_cast<void*>(sums() + first), 0, count * sizeof(PixelSums));
        if (layers_) std::memset(static_cast<void*>(layers() + first), 0, count * sizeof(GpuPixelLayers));
    });
}

GpuFilm DeviceFilm::describe() const
{
    GpuFilm film{};
    film.sums.address = sums_.address;
    if (layers_) film.layers.address = layers_->address;
    film.dropped.address = dropped.address;
    film.x0 = static_cast<uint>(area_.x0);
    film.y0 = static_cast<uint>(area_.y0);
    film.columns = static_cast<uint>(width(area_));
    film.has_layers = layers_ ? 1u : 0u;
    return film;
}

std::size_t DeviceFilm::pixel_at(std::size_t row) const
{
    return (static_cast<std::size_t>(part_.y0 - area_.y0) + row) * width(area_) +
           static_cast<std::size_t>(part_.x0 - area_.x0);
}

void DeviceFilm::copy_rows(Gpu::Commands& commands, const GpuBuffer& from, const GpuBuffer& to, std::size_t pixel_bytes,
                           const std::vector<std::size_t>& rows) const
{
    std::vector<VkBufferCopy> copies;
    const VkDeviceSize bytes = width(part_) * pixel_bytes;
    for (const std::size_t row : rows) {
        const VkDeviceSize at = pixel_at(row) * pixel_bytes;
        if (!copies.empty() && copies.back().srcOffset + copies.back().size == at)
            copies.back().size += bytes;
        else
            copies.push_back({at, at, bytes});
    }
    if (!copies.empty())
        vkCmdCopyBuffer(commands.handle, from.handle, to.handle, static_cast<std::uint32_t>(copies.size()),
                        copies.data());
}

void DeviceFilm::follow(Gpu::Commands& commands, const Film& film, const Region& part)
{
    SNELL_CHECK_EQ(part.x0 >= area_.x0 && part.y0 >= area_.y0 && part.x1 <= area_.x1 && part.y1 <= area_.y1, true);
    // What has not come to the host, for somebody has given up, is not in the film: all of it is made anew.
    if (changed_.begin != changed_.end || fetched_.begin != fetched_.end) begin(area_);
    part_ = part;
    changed_ = fetched_ = {};
    if (is_empty_) {
        const VkDeviceSize pixels = width(area_) * height(area_);
        vkCmdFillBuffer(commands.handle, sums_.handle, 0, pixels * sizeof(PixelSums), 0);
        if (layers_) vkCmdFillBuffer(commands.handle, layers_->handle, 0, pixels * sizeof(GpuPixelLayers), 0);
        is_empty_ = false;
    }
    counted_ = {};
    std::fill(std::begin(counted_.pixels), std::end(counted_.pixels), none);
    vkCmdUpdateBuffer(commands.handle, dropped.handle, 0, sizeof(counted_), &counted_);
    commands.barrier();

    std::vector<std::uint8_t> differs(height(part), 0);
    parallel_for(height(part), [&](std::size_t row) {
        const std::size_t there = pixel_at(row);
        const std::size_t here = (static_cast<std::size_t>(part.y0) + row) * static_cast<std::size_t>(film.width) +
                                 static_cast<std::size_t>(part.x0);
        for (std::size_t x = 0; x < width(part); ++x) {
            PixelSums pixel = film.sums(here + x);
            // The device counts what is seen through whether or not the film does.
            if (film.seen_through.empty()) pixel.seen_through = sums()[there + x].seen_through;
            if (std::memcmp(&pixel, sums() + there + x, sizeof(pixel)) != 0) differs[row] = 1;
            sums()[there + x] = pixel;
            if (!layers_) continue;
            const GpuPixelLayers more = {film.layers.light(here + x), film.layers.hits(here + x)};
            if (std::memcmp(&more, layers() + there + x, sizeof(more)) != 0) differs[row] = 1;
            layers()[there + x] = more;
        }
    });
    std::vector<std::size_t> rows;
    for (std::size_t row = 0; row < differs.size(); ++row)
        if (differs[row] != 0) rows.push_back(row);
    copy_rows(commands, seen_sums_, sums_, sizeof(PixelSums), rows);
    if (layers_) copy_rows(commands, *seen_layers_, *layers_, sizeof(GpuPixelLayers), rows);
    bytes_up += rows.size() * width(part) * (sizeof(PixelSums) + (layers_ ? sizeof(GpuPixelLayers) : 0));
    commands.barrier();
}

void DeviceFilm::note_changed(std::size_t first_pixel, std::size_t pixels)
{
    const std::size_t begin = first_pixel / width(part_), end = (first_pixel + pixels - 1) / width(part_) + 1;
    changed_ = changed_.begin == changed_.end ? Rows{begin, end}
                                              : Rows{std::min(begin, changed_.begin), std::max(end, changed_.end)};
}

void DeviceFilm::fetch(Gpu::Commands& commands)
{
    std::vector<std::size_t> rows;
    for (std::size_t row = changed_.begin; row < changed_.end; ++row) rows.push_back(row);
    commands.barrier();
    copy_rows(commands, sums_, seen_sums_, sizeof(PixelSums), rows);
    if (layers_) copy_rows(commands, *layers_, *seen_layers_, sizeof(GpuPixelLayers), rows);
    bytes_down += rows.size() * width(part_) * (sizeof(PixelSums) + (layers_ ? sizeof(GpuPixelLayers) : 0));
    commands.barrier();
    fetched_ = changed_;
    changed_ = {};
}

void DeviceFilm::take(Film& film, const GpuDropped& now)
{
    parallel_for(fetched_.end - fetched_.begin, [&](std::size_t i) {
        const std::size_t row = fetched_.begin + i, there = pixel_at(row);
        const std::size_t here = (static_cast<std::size_t>(part_.y0) + row) * static_cast<std::size_t>(film.width) +
                                 static_cast<std::size_t>(part_.x0);
        for (std::size_t x = 0; x < width(part_); ++x) {
            film.set(here + x, sums()[there + x]);
            if (!layers_) continue;
            film.layers.set(here + x, layers()[there + x].light);
            film.layers.set(here + x, layers()[there + x].hits);
        }
    });
    fetched_ = {};
    std::vector<std::uint64_t> pixels;
    for (const uint pixel : now.pixels) {
        if (pixel == none) break;
        pixels.push_back((static_cast<std::uint64_t>(area_.y0) + pixel / width(area_)) *
                             static_cast<std::uint64_t>(film.width) +
                         static_cast<std::uint64_t>(area_.x0) + pixel % width(area_));
    }
    note_dropped(film, now.samples - counted_.samples, pixels);
    counted_ = now;
}

} // namespace snell
