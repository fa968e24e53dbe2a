// Text files that are not ASCII or UTF-8.
#pragma once

#include <string>
#include <string_view>

namespace snell {

enum class Encoding
{
    bytes, // ASCII, UTF-8, Latin-1, or no text at all: left as it is
    utf16_little,
    utf16_big
};

// Tells by a file's first four bytes: a byte order mark of UTF-16 with an ASCII character behind it (so that no binary
// file is taken for a text), or two ASCII characters in UTF-16 without a mark. `mark` becomes the length of the byte
// order mark, that of UTF-8 too, which is to be skipped.
Encoding detect_encoding(std::string_view start, std::size_t& mark);

// UTF-16 into UTF-8, piece by piece. Half a pair of surrogates becomes U+FFFD.
class Utf16Decoder
{
  public:
    explicit Utf16Decoder(bool is_big) : is_big_(is_big) {}

    // Appends what `bytes` say; half a character at their end is kept for the next call.
    void decode(std::string_view bytes, std::string& to);
    // After the last piece: says what is still kept.
    void finish(std::string& to);

  private:
    void add(unsigned unit, std::string& to);

    bool is_big_;
    int odd_ = -1;      // the first byte of a unit whose second one has not come
    unsigned high_ = 0; // the first half of a pair of surrogates
};

// A whole text as UTF-8, without byte order mark.
std::string to_utf8(std::string bytes);

} // namespace snell
