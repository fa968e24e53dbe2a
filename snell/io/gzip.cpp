#include "snell/io/gzip.h"

#include "snell/core/error.h"

#include <zlib.h>

#include <algorithm>
#include <cstring>

namespace snell {

bool is_gzip(std::string_view start)
{
    return start.starts_with("\x1f\x8b\x08");
}

std::uint64_t gzip_limit(std::uint64_t packed_size)
{
    constexpr std::uint64_t always = 64u << 20, ratio = 200;
    return std::max(always, packed_size > UINT64_MAX / ratio ? UINT64_MAX : ratio * packed_size);
}

struct Gunzip::State
{
    std::string file;
    Source source;
    std::uint64_t limit = 0, done = 0;
    z_stream stream = {};
    bool is_open = false;   // inflateInit2 was called
    bool in_member = false; // between a member's first and last byte
    bool source_ends = false;
    char packed[1 << 16];

    ~State()
    {
        if (is_open) ::inflateEnd(&stream);
    }

    [[noreturn]] void fail(const std::string& message, const std::string& remedy) const
    {
        throw Error({file}, message, remedy);
    }

    void fetch()
    {
        const std::size_t n = source(packed, sizeof packed);
        stream.next_in = reinterpret_cast<Bytef*>(packed);
        stream.avail_in = static_cast<uInt>(n);
        source_ends = n == 0;
    }

    // False if there is no further member.
    bool begin_member()
    {
        // Tapes and some writers pad with zeros.
        for (;;) {
            while (stream.avail_in > 0 && *stream.next_in == 0 && is_open) ++stream.next_in, --stream.avail_in;
            if (stream.avail_in > 0 || source_ends) break;
            fetch();
        }
        if (stream.avail_in == 0) {
            if (!is_open) fail("is empty where gzip data should begin", "get or write it again");
            return false;
        }
        constexpr int gzip_only = 15 + 16;
        const int result = is_open ? ::inflateReset(&stream) : ::inflateInit2(&stream, gzip_only);
        if (result != Z_OK) fail("there is no memory for inflating it", "close other programs");
        is_open = in_member = true;
        return true;
    }
};

Gunzip::Gunzip(std::string file, Source source, std::uint64_t limit) : state_(std::make_unique<State>())
{
    state_->file = std::move(file);
    state_->source = std::move(source);
    state_->limit = limit;
}

Gunzip::~Gunzip() = default;
Gunzip::Gunzip(Gunzip&&) noexcept = default;

std::uint64_t Gunzip::done() const
{
    return state_->done;
}

std::size_t Gunzip::read(char* to, std::size_t size)
{
    State& s = *state_;
    std::size_t filled = 0;
    while (filled < size) {
        if (!s.in_member && !s.begin_member()) break;
        if (s.stream.avail_in == 0) s.fetch();
        if (s.source_ends)
            s.fail(fmt::format("the gzip data ends early, after {} inflated bytes", s.done + filled),
                   "the file is truncated: get or write it again");
        const std::size_t room = std::min<std::size_t>(size - filled, 1u << 30);
        s.stream.next_out = reinterpret_cast<Bytef*>(to + filled);
        s.stream.avail_out = static_cast<uInt>(room);
        const int result = ::inflate(&s.stream, Z_NO_FLUSH);
        filled += room - s.stream.avail_out;
        if (s.done + filled > s.limit)
            s.fail(fmt::format("inflates to more than {} bytes, 200 times its size", s.limit),
                   "unpack it yourself if you trust it");
        if (result == Z_STREAM_END)
            s.in_member = false;
        else if (result != Z_OK && result != Z_BUF_ERROR)
            s.fail(fmt::format("the gzip data is damaged after {} inflated bytes ({})", s.done + filled,
                               s.stream.msg != nullptr ? s.stream.msg : "no reason given"),
                   "get or write it again");
    }
    s.done += filled;
    return filled;
}

std::string gunzip(const std::string& file, std::string_view packed)
{
    std::string_view rest = packed;
    const auto source = [&rest](char* to, std::size_t size) {
        const std::size_t n = std::min(size, rest.size());
        std::memcpy(to, rest.data(), n);
        rest.remove_prefix(n);
        return n;
    };
    Gunzip in(file, source, gzip_limit(packed.size()));
    std::string out;
    constexpr std::size_t piece = 1 << 18;
    for (;;) {
        const std::size_t before = out.size();
        if (before == out.capacity()) out.reserve(2 * before + piece);
        out.resize(std::min(out.capacity(), before + 4 * piece));
        const std::size_t n = in.read(out.data() + before, out.size() - before);
        out.resize(before + n);
        if (n == 0) return out;
    }
}

} // namespace snell
