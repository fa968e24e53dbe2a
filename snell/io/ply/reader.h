// Values from the body of a PLY file, one after the other, whatever its format.
#pragma once

#include "snell/io/byte_window.h"
#include "snell/io/ply/header.h"
#include "snell/io/text_cursor.h"

#include <bit>
#include <cstring>

namespace snell::ply {

static_assert(std::endian::native == std::endian::little);

// A value in a binary file, which need not be aligned.
template <class T, bool swaps>
T load_value(const char* from)
{
    char raw[sizeof(T)];
    std::memcpy(raw, from, sizeof(T));
    if constexpr (swaps) std::reverse(raw, raw + sizeof(T));
    return std::bit_cast<T>(raw);
}

// Calls use(T()) with the C++ type for `type`.
template <class Use>
auto with_type(Type type, const Use& use)
{
    switch (type) {
    case Type::int8:
        return use(std::int8_t{});
    case Type::uint8:
        return use(std::uint8_t{});
    case Type::int16:
        return use(std::int16_t{});
    case Type::uint16:
        return use(std::uint16_t{});
    case Type::int32:
        return use(std::int32_t{});
    case Type::uint32:
        return use(std::uint32_t{});
    case Type::float32:
        return use(float{});
    case Type::float64:
        break;
    }
    return use(double{});
}

class AsciiReader
{
  public:
    static constexpr bool is_binary = false;

    // line: of the body's beginning.
    AsciiReader(ByteWindow& window, int line) : in_(window, line) {}

    float number(Type) { return in_.number("a number"); }
    long long integer(Type) { return in_.integer("a whole number"); }
    void skip(Type, std::uint64_t count)
    {
        for (; count > 0; --count) in_.skip_word();
    }
    // Could the rest of the file hold that many values?
    bool can_hold(Type, std::uint64_t count) const { return count <= in_.most_left() / 2 + 1; }
    bool at_end() { return in_.at_end(); }

    [[noreturn]] void fail(const std::string& message, const std::string& remedy)
    {
        throw Error(in_.place(), message, remedy);
    }

  private:
    TextCursor in_;
};

template <bool swaps>
class BinaryReader
{
  public:
    static constexpr bool is_binary = true;
    static constexpr bool swaps_bytes = swaps;

    BinaryReader(ByteWindow& window, int) : window_(window) {}

    float number(Type type)
    {
        return with_type(type, [this](auto t) { return static_cast<float>(take<decltype(t)>()); });
    }

    // Of an integer type.
    long long integer(Type type)
    {
        return with_type(type, [this](auto t) { return static_cast<long long>(take<decltype(t)>()); });
    }

    void skip(Type type, std::uint64_t count)
    {
        if (!can_hold(type, count)) fail_truncated();
        for (std::uint64_t left = size_of(type) * count; left > 0;) {
            if (window_.view().empty() && !window_.more()) fail_truncated();
            const std::uint64_t step = std::min<std::uint64_t>(left, window_.view().size());
            window_.take(static_cast<std::size_t>(step));
            left -= step;
        }
    }

    bool can_hold(Type type, std::uint64_t count) const { return count <= window_.most_left() / size_of(type); }
    bool at_end() { return window_.view().empty() && !window_.more(); }

    // Whole rows of `row` bytes each that are in view, at least one if the file has it; not taken yet.
    std::string_view rows(std::size_t row)
    {
        while (window_.view().size() < row && window_.more()) {
        }
        return window_.view().substr(0, window_.view().size() / row * row);
    }
    void take_bytes(std::size_t count) { window_.take(count); }

    // ahead: how many bytes behind the next value the trouble is.
    [[noreturn]] void fail(const std::string& message, const std::string& remedy, std::ptrdiff_t ahead = 0)
    {
        throw Error({window_.name()},
                    fmt::format("{}, at byte {}", message, static_cast<std::ptrdiff_t>(window_.offset()) + ahead),
                    remedy);
    }
    [[noreturn]] void fail_truncated() { fail("the file ends within a row", "it is truncated: get or write it again"); }

  private:
    template <class T>
    T take()
    {
        while (window_.view().size() < sizeof(T))
            if (!window_.more()) fail_truncated();
        const T value = load_value<T, swaps>(window_.view().data());
        window_.take(sizeof(T));
        return value;
    }

    ByteWindow& window_;
};

} // namespace snell::ply
