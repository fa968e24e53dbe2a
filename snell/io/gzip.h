// Files packed with gzip.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <string_view>

namespace snell {

// Do these bytes begin a gzip file?
bool is_gzip(std::string_view start);

// How many bytes a gzip file may become. Deflate reaches 1032 to 1; meshes and scenes as text reach 3 to 50, so what
// becomes more than 200 times as large, and more than 64 MiB, was made to fill memories.
std::uint64_t gzip_limit(std::uint64_t packed_size);

// Inflates a stream of gzip members, one behind the other, piece by piece.
class Gunzip
{
  public:
    // Fills up to `size` bytes with what is packed and returns how many; 0 at the end.
    using Source = std::function<std::size_t(char* to, std::size_t size)>;

    // file: named in errors. limit: inflating more bytes is an Error.
    Gunzip(std::string file, Source source, std::uint64_t limit);
    ~Gunzip();
    Gunzip(Gunzip&&) noexcept;
    Gunzip& operator=(Gunzip&&) = delete;

    // Fills up to `size` bytes and returns how many; fewer only at the end. Throws Error if the data is damaged (its
    // checksum included), truncated or beyond the limit. Zeros behind the last member are padding.
    std::size_t read(char* to, std::size_t size);

    std::uint64_t done() const;

  private:
    struct State;
    std::unique_ptr<State> state_;
};

// A whole gzip file's content. Throws Error.
std::string gunzip(const std::string& file, std::string_view packed);

} // namespace snell
