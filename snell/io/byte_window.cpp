#include "snell/io/byte_window.h"

#include "snell/core/error.h"

#include <algorithm>
#include <cstring>
#include <utility>

namespace snell {

ByteWindow::ByteWindow(const std::filesystem::path& file, std::size_t size) : in_(file), size_(std::max(size, 16ul))
{
    // No larger than the file; 1 byte more, so that its end is seen in the first step.
    if (in_.size() > 0 && in_.size() < size_) size_ = static_cast<std::size_t>(in_.size()) + 1;

    peeked_.resize(3);
    peeked_.resize(read_disk(peeked_.data(), peeked_.size()));
    if (is_gzip(peeked_)) {
        std::string start = std::exchange(peeked_, {});
        const auto source = [this, start = std::move(start)](char* to, std::size_t room) mutable {
            const std::size_t n = std::min(room, start.size());
            if (n == 0) return read_disk(to, room);
            std::memcpy(to, start.data(), n);
            start.erase(0, n);
            return n;
        };
        gunzip_.emplace(in_.name(), source, gzip_limit(in_.size()));
        size_ = std::max(size_, std::min<std::size_t>(size, 16 * size_));
    }
    std::string start(4, '\0');
    start.resize(read(start.data(), start.size()));
    std::size_t mark = 0;
    const Encoding encoding = detect_encoding(start, mark);
    peeked_ = start.substr(mark) + peeked_;
    before_ = mark;
    if (encoding != Encoding::bytes) decoder_.emplace(encoding == Encoding::utf16_big);
    buffer_ = std::make_unique_for_overwrite<char[]>(size_);
    more();
}

std::size_t ByteWindow::read_disk(char* to, std::size_t size)
{
    const std::size_t n = in_.read(to, size);
    disk_done_ += n;
    return n;
}

// As the file has it, inflated.
std::size_t ByteWindow::read(char* to, std::size_t size)
{
    const std::size_t first = std::min(size, peeked_.size());
    std::memcpy(to, peeked_.data(), first);
    peeked_.erase(0, first);
    if (first == size) return size;
    return first + (gunzip_ ? gunzip_->read(to + first, size - first) : read_disk(to + first, size - first));
}

bool ByteWindow::more()
{
    if (at_end_) return false;
    std::memmove(buffer_.get(), buffer_.get() + begin_, end_ - begin_);
    before_ += begin_;
    end_ -= begin_;
    begin_ = 0;
    if (end_ == size_) {
        std::unique_ptr<char[]> larger = std::make_unique_for_overwrite<char[]>(2 * size_);
        std::memcpy(larger.get(), buffer_.get(), end_);
        buffer_ = std::move(larger);
        size_ *= 2;
    }
    const std::size_t before = end_;
    while (end_ < size_) {
        char* const to = buffer_.get() + end_;
        const std::size_t room = size_ - end_;
        std::size_t n = 0;
        if (!decoder_) {
            n = read(to, room);
        } else {
            if (decoded_at_ == decoded_.size()) {
                char raw[1 << 14];
                decoded_.clear();
                decoded_at_ = 0;
                const std::size_t count = read(raw, sizeof raw);
                decoder_->decode({raw, count}, decoded_);
                if (count == 0) decoder_->finish(decoded_);
                if (count > 0 && decoded_.empty()) continue;
            }
            n = std::min(room, decoded_.size() - decoded_at_);
            std::memcpy(to, decoded_.data() + decoded_at_, n);
            decoded_at_ += n;
        }
        if (n == 0) {
            at_end_ = true;
            break;
        }
        end_ += n;
    }
    return end_ > before;
}

std::uint64_t ByteWindow::most_left() const
{
    const std::uint64_t here = end_ - begin_;
    if (at_end_) return here;
    // A file whose size the system does not know has at least what is in view; it may be read, but not announced.
    std::uint64_t coming = in_.size() > disk_done_ ? in_.size() - disk_done_ : 0;
    if (gunzip_) {
        constexpr std::uint64_t packed_ahead = 1 << 17; // read from the disk, not yet inflated
        coming = std::min((coming + packed_ahead) * 1032, gzip_limit(in_.size()) - gunzip_->done());
    }
    coming += peeked_.size();
    if (decoder_) coming += coming / 2 + decoded_.size() - decoded_at_;
    return here + coming;
}

} // namespace snell
