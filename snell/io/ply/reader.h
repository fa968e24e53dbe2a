// Values from the body of a PLY file, one after the other, whatever its format.
#pragma once

#include "snell/io/ply/header.h"
#include "snell/io/text_cursor.h"

#include <bit>
#include <cstring>

namespace snell::ply {

static_assert(std::endian::native == std::endian::little);

class AsciiReader
{
  public:
    AsciiReader(const std::string& file, std::string_view bytes, std::size_t body) : in_(file, bytes, body) {}

    float number(Type) { return in_.number("a number"); }
    long long integer(Type) { return in_.integer("a whole number"); }
    void skip(Type, std::uint64_t count)
    {
        for (; count > 0; --count) in_.skip_word();
    }
    // Could the rest of the file hold that many values?
    bool can_hold(Type, std::uint64_t count) const { return count <= in_.bytes_left() / 2 + 1; }
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
    BinaryReader(const std::string& file, std::string_view bytes, std::size_t body)
        : file_(file), begin_(bytes.data()), p_(begin_ + body), end_(begin_ + bytes.size())
    {
    }

    float number(Type type)
    {
        if (type == Type::float32) return take<float>();
        if (type == Type::float64) return static_cast<float>(take<double>());
        return static_cast<float>(integer(type));
    }

    // Of an integer type.
    long long integer(Type type)
    {
        switch (type) {
        case Type::int8:
            return take<std::int8_t>();
        case Type::uint8:
            return take<std::uint8_t>();
        case Type::int16:
            return take<std::int16_t>();
        case Type::uint16:
            return take<std::uint16_t>();
        case Type::int32:
            return take<std::int32_t>();
        default:
            return take<std::uint32_t>();
        }
    }

    void skip(Type type, std::uint64_t count)
    {
        if (!can_hold(type, count)) fail_truncated();
        p_ += size_of(type) * count;
    }

    bool can_hold(Type type, std::uint64_t count) const
    {
        return count <= static_cast<std::uint64_t>(end_ - p_) / size_of(type);
    }
    bool at_end() const { return p_ == end_; }

    [[noreturn]] void fail(const std::string& message, const std::string& remedy)
    {
        throw Error({file_}, fmt::format("{}, at byte {}", message, p_ - begin_), remedy);
    }

  private:
    template <class T>
    T take()
    {
        if (static_cast<std::size_t>(end_ - p_) < sizeof(T)) fail_truncated();
        char raw[sizeof(T)];
        std::memcpy(raw, p_, sizeof(T));
        if constexpr (swaps) std::reverse(raw, raw + sizeof(T));
        p_ += sizeof(T);
        return std::bit_cast<T>(raw);
    }

    [[noreturn]] void fail_truncated() { fail("the file ends within a row", "it is truncated: get or write it again"); }

    std::string file_;
    const char* begin_;
    const char* p_;
    const char* end_;
};

} // namespace snell::ply
