// What reading a file has to say, once a kind, and what reading it may cost.
#pragma once

#include "snell/core/error.h"
#include "snell/scene/scene.h"

#include <atomic>
#include <cstdint>
#include <string>
#include <vector>

namespace snell::gltf {

// Remarks of one kind are told as one note: the first one's text and how many more there were. Parallel work collects
// its own and appends them in the file's order.
class Remarks
{
  public:
    void warn(const std::string& kind, std::string text) { add({kind, std::move(text), Note::Kind::warning, 1}); }
    void info(const std::string& kind, std::string text) { add({kind, std::move(text), Note::Kind::info, 1}); }
    void append(const Remarks& others);
    void tell(Scene& scene, const std::string& file) const;

  private:
    struct Remark
    {
        std::string kind, text;
        Note::Kind level;
        std::size_t count;
    };
    void add(Remark remark);

    std::vector<Remark> all_;
};

// Limits what a file of n bytes can ask for: parts of it may be used again and again, are unpacked, or stand for zeros
// that are not there. The limit grows with the bytes read. Any thread may charge.
class Budget
{
  public:
    // The bytes of one more file.
    void allow(std::size_t file_bytes) { limit_ += 256 * static_cast<std::uint64_t>(file_bytes); }
    // Throws Error if the whole becomes more than the limit.
    void charge(std::size_t count, std::size_t item_bytes, const std::string& place)
    {
        const std::uint64_t most = limit_.load();
        // Each factor is checked by itself, so that no product runs over.
        if (count < most && spent_ + std::uint64_t{count} * item_bytes <= most) {
            if (spent_.fetch_add(std::uint64_t{count} * item_bytes) <= most) return;
        }
        throw Error(fmt::format("{}the file asks for more than {} MB of memory, out of proportion to its size", place,
                                most >> 20),
                    "it is broken, or made to do harm");
    }

  private:
    std::atomic<std::uint64_t> limit_ = std::uint64_t{1} << 28;
    std::atomic<std::uint64_t> spent_ = 0;
};

} // namespace snell::gltf
