// Reading numbers and words from text in memory, with places for errors.
#pragma once

#include "snell/core/error.h"
#include "snell/io/byte_window.h"
#include "snell/io/read_number.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <string>
#include <string_view>
#include <system_error>

namespace snell {

inline bool is_blank(char c)
{
    return c == ' ' || c == '\t';
}

inline bool is_space(char c)
{
    return c == ' ' || (c >= '\t' && c <= '\r');
}

inline std::string_view trim(std::string_view text)
{
    while (!text.empty() && is_space(text.front())) text.remove_prefix(1);
    while (!text.empty() && is_space(text.back())) text.remove_suffix(1);
    return text;
}

// Where `at`, a part of `text`, begins; counts the lines before it, so only for errors.
inline Place place_in(const std::string& file, std::string_view text, const char* at)
{
    const std::string_view before = text.substr(0, static_cast<std::size_t>(at - text.data()));
    const std::size_t start = before.rfind('\n');
    const auto column = start == std::string_view::npos ? before.size() : before.size() - start - 1;
    constexpr std::ptrdiff_t most = std::numeric_limits<int>::max() - 1;
    const std::ptrdiff_t line = std::min<std::ptrdiff_t>(most, std::count(before.begin(), before.end(), '\n'));
    return {file, static_cast<int>(line) + 1, static_cast<int>(std::min<std::size_t>(column, most)) + 1};
}

// What to print of a word of unknown length and content.
inline std::string show_word(std::string_view word)
{
    std::string shown = "'";
    for (const char c : word.substr(0, 40)) shown += c >= ' ' && c <= '~' ? c : '?';
    return shown + (word.size() > 40 ? "...'" : "'");
}

// A file's text that is read word by word; line ends are spaces like any other. What is returned is valid until the
// next call.
class TextCursor
{
  public:
    // Reads on from the window's view. line: the number of the line that it begins in.
    explicit TextCursor(ByteWindow& window, int line = 1) : window_(window), line_(line), line_start_(window.offset())
    {
        look();
    }

    bool at_end()
    {
        skip_spaces();
        return p_ == end_;
    }

    // The next word; empty at the end.
    std::string_view word()
    {
        skip_spaces();
        for (std::size_t length = 0;; ++length) {
            if (p_ + length == end_ && !fetch()) length = static_cast<std::size_t>(end_ - p_);
            if (p_ + length == end_ || is_space(p_[length])) {
                p_ += length;
                return {p_ - length, length};
            }
        }
    }

    std::string_view rest_of_line()
    {
        for (std::size_t length = 0;; ++length) {
            if (p_ + length == end_ && !fetch()) length = static_cast<std::size_t>(end_ - p_);
            if (p_ + length == end_ || p_[length] == '\n' || p_[length] == '\r') {
                p_ += length;
                return trim({p_ - length, length});
            }
        }
    }

    // `what`: what the number is, for the error.
    float number(std::string_view what)
    {
        skip_spaces();
        float value = 0;
        // Nearly always the number and what ends it are in view.
        const char* behind = read_plain_float(p_, end_, value);
        if (behind && behind < end_ && is_space(*behind)) {
            p_ = behind;
            return value;
        }
        const std::string_view found = word();
        const char* p = found.data();
        if (!read_float(p, found.data() + found.size(), value) || p != found.data() + found.size()) fail(found, what);
        return value;
    }

    long long integer(std::string_view what)
    {
        skip_spaces();
        const char* p = p_;
        unsigned value = 0;
        constexpr int safe_digits = 9;
        while (p < end_ && p - p_ < safe_digits && *p >= '0' && *p <= '9')
            value = 10 * value + static_cast<unsigned>(*p++ - '0');
        if (p > p_ && p < end_ && is_space(*p)) {
            p_ = p;
            return value;
        }
        const std::string_view found = word();
        long long number = 0;
        const auto result = std::from_chars(found.data(), found.data() + found.size(), number);
        if (result.ec != std::errc() || result.ptr != found.data() + found.size()) fail(found, what);
        return number;
    }

    void skip_word()
    {
        if (const std::string_view found = word(); found.empty()) fail(found, "a value");
    }

    // At most so many bytes are still to come.
    std::uint64_t most_left() const { return window_.most_left() - static_cast<std::uint64_t>(p_ - start_); }
    // Where a word of the last call begins; counts lines, so only for errors.
    Place place(std::string_view at) const
    {
        Place place = place_in(window_.name(), window_.view(), at.data());
        if (place.line == 1) place.column += static_cast<int>(window_.offset() - line_start_);
        place.line += line_ - 1;
        return place;
    }
    Place place() const { return place({p_, 0}); }

  private:
    void look()
    {
        start_ = p_ = window_.view().data();
        end_ = p_ + window_.view().size();
    }

    // Brings more text into view. False if there is none.
    bool fetch()
    {
        const std::string_view gone(start_, static_cast<std::size_t>(p_ - start_));
        line_ += static_cast<int>(std::count(gone.begin(), gone.end(), '\n'));
        if (const std::size_t last = gone.rfind('\n'); last != std::string_view::npos)
            line_start_ = window_.offset() + last + 1;
        window_.take(gone.size());
        const bool has_more = window_.more();
        look();
        return has_more;
    }

    void skip_spaces()
    {
        for (;;) {
            while (p_ < end_ && is_space(*p_)) ++p_;
            if (p_ < end_ || !fetch()) return;
        }
    }

    [[noreturn]] void fail(std::string_view found, std::string_view what) const
    {
        if (found.empty())
            throw Error(place(), fmt::format("the file ends where {} should be", what),
                        "it is truncated: get or write it again");
        throw Error(place(found), fmt::format("{} should be here, but there is {}", what, show_word(found)),
                    "mend the file or write it again");
    }

    ByteWindow& window_;
    const char* start_; // of the view
    const char* p_;
    const char* end_;
    int line_;                 // of the view's beginning
    std::uint64_t line_start_; // offset of that line
};

} // namespace snell
