// Large files in pieces.
#pragma once

#include "snell/io/file.h"
#include "snell/io/gzip.h"
#include "snell/io/text_encoding.h"

#include <memory>
#include <optional>
#include <string_view>

namespace snell {

// A window that moves over a file from its beginning to its end, so that a mesh needs no memory for the file it comes
// from. What is packed with gzip is inflated, whatever the name; UTF-16 becomes UTF-8; byte order marks are skipped.
// Throws Error as InputFile and Gunzip do.
class ByteWindow
{
  public:
    static constexpr std::size_t usual_size = 4u << 20;

    explicit ByteWindow(const std::filesystem::path& file, std::size_t size = usual_size);

    // The bytes in the window that have not been taken; valid until the next more().
    std::string_view view() const { return {buffer_.get() + begin_, end_ - begin_}; }
    void take(std::size_t count) { begin_ += count; }

    // Brings more bytes in behind those in view, and makes the window larger if there is no room for any. False if the
    // file has ended; the view stays as it is.
    bool more();
    // Has all of the file come into view?
    bool at_end() const { return at_end_; }

    // The offset, in the content, of the view's first byte.
    std::uint64_t offset() const { return before_ + begin_; }
    // No more bytes than these are in view or will come: safe to allocate by. Exact for most files.
    std::uint64_t most_left() const;
    bool is_exact() const { return !gunzip_ && !decoder_; }

    // How far it is, in bytes of the file on disk.
    std::uint64_t disk_done() const { return disk_done_; }
    std::uint64_t disk_size() const { return in_.size(); }
    const std::string& name() const { return in_.name(); }

  private:
    std::size_t read(char* to, std::size_t size);
    std::size_t read_disk(char* to, std::size_t size);

    InputFile in_;
    std::uint64_t disk_done_ = 0, before_ = 0; // before_: bytes of the content before the buffer
    std::optional<Gunzip> gunzip_;
    std::optional<Utf16Decoder> decoder_;
    std::string peeked_; // read to look at it, not yet handed on
    std::string decoded_;
    std::size_t decoded_at_ = 0;
    std::unique_ptr<char[]> buffer_;
    std::size_t size_ = 0, begin_ = 0, end_ = 0;
    bool at_end_ = false;
};

} // namespace snell
