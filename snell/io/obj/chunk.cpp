#include "snell/io/obj/chunk.h"

#include "snell/io/text_cursor.h"

#include <cstring>

namespace snell::obj {
namespace {

constexpr int most_index_digits = 9;
constexpr const char* mend_line = "mend the line or write the file again";

std::string_view take_word(std::string_view& line)
{
    while (!line.empty() && is_blank(line.front())) line.remove_prefix(1);
    std::size_t length = 0;
    while (length < line.size() && !is_blank(line[length])) ++length;
    const std::string_view word = line.substr(0, length);
    line.remove_prefix(length);
    return word;
}

bool is_digit(char c)
{
    return c >= '0' && c <= '9';
}

enum class Number
{
    fine,
    not_finite,
    garbage
};

Number classify(std::string_view word)
{
    std::size_t i = 0, digits = 0;
    if (i < word.size() && (word[i] == '+' || word[i] == '-')) ++i;
    const std::string_view magnitude = word.substr(i);
    for (const std::string_view name : {"nan", "inf", "NaN", "Inf", "NAN", "INF", "1.#"})
        if (magnitude.starts_with(name)) return Number::not_finite; // as the C libraries of the world print them
    for (; i < word.size() && is_digit(word[i]); ++i) ++digits;
    if (i < word.size() && word[i] == '.')
        for (++i; i < word.size() && is_digit(word[i]); ++i) ++digits;
    if (digits == 0) return Number::garbage;
    if (i < word.size() && (word[i] == 'e' || word[i] == 'E')) {
        ++i;
        if (i < word.size() && (word[i] == '+' || word[i] == '-')) ++i;
        const std::size_t exponent = i;
        while (i < word.size() && is_digit(word[i])) ++i;
        if (i == exponent || i - exponent > 4) return Number::garbage;
    }
    return i == word.size() ? Number::fine : Number::garbage;
}

// One index of at most 9 digits at p; false, with p anywhere, if there is something else.
bool take_index(const char*& p, const char* end, int& index)
{
    const bool is_negative = p < end && *p == '-';
    if (p < end && (*p == '-' || *p == '+')) ++p;
    const char* const start = p;
    int value = 0;
    while (p < end && is_digit(*p) && p - start < most_index_digits) value = 10 * value + (*p++ - '0');
    if (p == start || (p < end && is_digit(*p))) return false;
    index = is_negative ? -value : value;
    return true;
}

struct Failure
{
    std::string_view word; // in the line; empty: all of it
    std::string message, remedy;
};

class Parser
{
  public:
    explicit Parser(Chunk& chunk) : out_(chunk)
    {
        for (Chunk::Reach& reach : out_.lowest) reach.index = 0;
    }

    void read(std::string_view text)
    {
        const bool has_returns = std::memchr(text.data(), '\r', text.size()) != nullptr;
        std::size_t offset = 0;
        while (offset < text.size()) {
            lines_in_last_ = 0;
            std::string_view line = next_line(text, offset, has_returns);
            if (line.ends_with('\\')) line = join(line, text, offset, has_returns);
            try {
                read_line(line);
            } catch (const Failure& failure) {
                out_.failed = true;
                out_.error_line = line_;
                // In a line joined from several, a column would mislead.
                if (!failure.word.empty() && lines_in_last_ == 1)
                    out_.error_column = static_cast<int>(failure.word.data() - line.data()) + 1;
                out_.message = failure.message;
                out_.remedy = failure.remedy;
                return;
            }
            line_ += lines_in_last_;
        }
        out_.lines = line_;
    }

  private:
    std::string_view next_line(std::string_view text, std::size_t& offset, bool has_returns)
    {
        const char* const start = text.data() + offset;
        const std::size_t left = text.size() - offset;
        // Files with carriage returns only: search for line feeds just as far as they matter.
        const auto* end = static_cast<const char*>(has_returns ? nullptr : std::memchr(start, '\n', left));
        if (has_returns) {
            std::size_t i = 0;
            while (i < left && start[i] != '\n' && start[i] != '\r') ++i;
            end = i < left ? start + i : nullptr;
        }
        ++lines_in_last_;
        if (!end) {
            offset = text.size();
            return {start, left};
        }
        offset = static_cast<std::size_t>(end - text.data()) + 1;
        if (*end == '\r' && offset < text.size() && text[offset] == '\n') ++offset;
        return {start, static_cast<std::size_t>(end - start)};
    }

    std::string_view join(std::string_view line, std::string_view text, std::size_t& offset, bool has_returns)
    {
        if (trim(line).starts_with('#')) return line;
        joined_.clear();
        while (line.ends_with('\\') && offset < text.size()) {
            joined_.append(line.substr(0, line.size() - 1)).push_back(' ');
            line = next_line(text, offset, has_returns);
        }
        joined_ += line;
        return joined_;
    }

    void read_line(std::string_view line)
    {
        std::string_view rest = line;
        const std::string_view keyword = take_word(rest);
        if (keyword.empty() || keyword.front() == '#') return;
        if (keyword == "v")
            read_vertex(rest);
        else if (keyword == "vn")
            read_normal(rest);
        else if (keyword == "vt")
            read_uv(rest);
        else if (keyword == "f" || keyword == "fo") // as faces were called before version 3
            read_face(rest);
        else if (!read_statement(keyword, rest))
            count(skipped_unknown);
    }

    // Reads numbers until the line or a comment; returns how many. Others than least to most: a Failure. All of them
    // are finite, or is_finite_ is false.
    int read_numbers(std::string_view rest, int least, int most, float* numbers)
    {
        is_finite_ = true;
        const char* p = rest.data();
        const char* const end = p + rest.size();
        int n = 0;
        for (;; ++n) {
            while (p < end && is_blank(*p)) ++p;
            if (p == end || *p == '#') break;
            float value = 0;
            const char* behind = read_plain_float(p, end, value);
            if (!behind || (behind < end && !is_blank(*behind))) {
                std::string_view tail(p, static_cast<std::size_t>(end - p));
                const std::string_view word = take_word(tail);
                value = read_odd_number(word);
                behind = word.data() + word.size();
            }
            if (n == most)
                throw Failure{{p, static_cast<std::size_t>(behind - p)},
                              fmt::format("more than {} numbers", most),
                              "remove what is too much"};
            numbers[n] = value;
            p = behind;
        }
        if (n < least) throw Failure{{}, fmt::format("{} numbers where there should be {}", n, least), mend_line};
        if (!is_finite_) count(skipped_not_finite);
        return n;
    }

    float read_odd_number(std::string_view word)
    {
        const Number kind = classify(word);
        if (kind == Number::garbage)
            throw Failure{word, fmt::format("a number should be here, but there is {}", show_word(word)), mend_line};
        float value = 0;
        const char* p = word.data();
        if (kind == Number::fine && read_float(p, word.data() + word.size(), value) && std::isfinite(value))
            return value;
        is_finite_ = false;
        return std::numeric_limits<float>::quiet_NaN();
    }

    // x y z, x y z w, x y z r g b, or x y z r g b a.
    void read_vertex(std::string_view rest)
    {
        float n[7];
        const bool has_color = read_numbers(rest, 3, 7, n) >= 6;
        if (out_.positions.size() >= most_elements) throw Failure{{}, "too many vertices", "split the file"};
        if (has_color && out_.colors.empty()) out_.colors.assign(out_.positions.size(), vec3(1.0f));
        out_.positions.push_back(vec3(n[0], n[1], n[2]));
        if (has_color)
            out_.colors.push_back(vec3(finite_or_0(n[3]), finite_or_0(n[4]), finite_or_0(n[5])));
        else if (!out_.colors.empty())
            out_.colors.push_back(vec3(1.0f));
    }

    static float finite_or_0(float value) { return std::isfinite(value) ? value : 0.0f; }

    void read_normal(std::string_view rest)
    {
        float n[3];
        read_numbers(rest, 3, 3, n);
        if (out_.normals.size() >= most_elements) throw Failure{{}, "too many normals", "split the file"};
        out_.normals.push_back(vec3(n[0], n[1], n[2]));
    }

    void read_uv(std::string_view rest)
    {
        float n[3] = {};
        read_numbers(rest, 1, 3, n);
        if (out_.uvs.size() >= most_elements) throw Failure{{}, "too many texture coordinates", "split the file"};
        out_.uvs.push_back(is_finite_ ? vec2(n[0], n[1]) : vec2(0.0f));
    }

    void read_face(std::string_view rest)
    {
        const std::size_t first = out_.corners.size();
        const char* p = rest.data();
        const char* const end = p + rest.size();
        for (;;) {
            while (p < end && is_blank(*p)) ++p;
            if (p == end || *p == '#') break;
            const char* const start = p;
            int index[kind_count] = {};
            if (!read_corner(p, end, index)) {
                std::string_view tail(start, static_cast<std::size_t>(end - start));
                const std::string_view word = take_word(tail);
                throw Failure{word,
                              fmt::format("a face's corner should be here, like 1, 1/2 or 1/2/3, but there is {}",
                                          show_word(word)),
                              mend_line};
            }
            if (index[kind_position] == 0)
                throw Failure{{start, static_cast<std::size_t>(p - start)},
                              "vertex 0 is referred to, but vertices count from 1",
                              mend_line};
            out_.corners.push_back({{resolve(index[kind_position], kind_position, out_.positions.size()),
                                     resolve(index[kind_uv], kind_uv, out_.uvs.size()),
                                     resolve(index[kind_normal], kind_normal, out_.normals.size())}});
        }
        const std::size_t size = out_.corners.size() - first;
        if (size < 3) {
            out_.corners.resize(first);
            count(skipped_small_face);
            return;
        }
        if (size > std::numeric_limits<uint>::max()) throw Failure{{}, "a face of too many corners", "split it"};
        out_.face_sizes.push_back(static_cast<uint>(size));
        out_.has_polygons = out_.has_polygons || size != 3;
    }

    // i, i/j, i//k, i/j/k; slashes without a number behind them are forgiven, for some exporters write them.
    static bool read_corner(const char*& p, const char* end, int (&index)[kind_count])
    {
        if (!take_index(p, end, index[kind_position])) return false;
        for (int part = 0; part < 2 && p < end && !is_blank(*p); ++part) {
            if (*p != '/') return false;
            ++p;
            constexpr Kind order[2] = {kind_uv, kind_normal};
            if (p < end && !is_blank(*p) && *p != '/' && !take_index(p, end, index[order[part]])) return false;
        }
        return p == end || is_blank(*p);
    }

    // `written` counts from 1, or back from -1; 0 is none given.
    int resolve(int written, Kind kind, std::size_t count_so_far)
    {
        if (written >= 0) {
            Chunk::Reach& reach = out_.highest[kind];
            if (written - 1 > reach.index) reach = {written - 1, line_, written, count_so_far};
            return written - 1;
        }
        const int index = static_cast<int>(count_so_far) + written;
        Chunk::Reach& reach = out_.lowest[kind];
        if (index < reach.index) reach = {index, line_, written, count_so_far};
        out_.has_relative = true;
        return relative_zero + index;
    }

    bool read_statement(std::string_view keyword, std::string_view rest)
    {
        const std::string_view name = trim(rest);
        if (keyword == "usemtl") {
            add_event(Event::What::material, name);
        } else if (keyword == "o") {
            add_event(Event::What::object, name);
        } else if (keyword == "g") {
            add_event(Event::What::group, name);
        } else if (keyword == "s") {
            add_event(Event::What::smoothing, {}, smoothing_group(rest));
        } else if (keyword == "mtllib") {
            add_event(Event::What::library, name);
        } else if (keyword == "l" || keyword == "p") {
            count(skipped_undrawn);
        } else {
            for (const std::string_view free_form : {"vp", "cstype", "curv", "curv2", "surf", "deg", "parm", "trim",
                                                     "hole", "bmat", "step", "scrv", "sp", "end", "con"})
                if (keyword == free_form) return count(skipped_free_form), true;
            // Hints for renderers of its time, which change no surface.
            for (const std::string_view hint : {"mg", "lod", "bevel", "c_interp", "d_interp", "usemap", "maplib",
                                                "shadow_obj", "trace_obj", "ctech", "stech", "vw"})
                if (keyword == hint) return true;
            return false;
        }
        return true;
    }

    void add_event(Event::What what, std::string_view name, uint smoothing = 0)
    {
        out_.events.push_back({what, out_.face_sizes.size(), out_.corners.size(), line_, std::string(name), smoothing});
    }

    static uint smoothing_group(std::string_view rest)
    {
        const std::string_view group = take_word(rest);
        if (group == "on") return 1;
        if (group == "off" || group.empty()) return 0;
        uint number = 0;
        const auto result = std::from_chars(group.data(), group.data() + group.size(), number);
        if (result.ec != std::errc() || result.ptr != group.data() + group.size())
            throw Failure{group, fmt::format("a smoothing group should be here, but there is {}", show_word(group)),
                          "write a number or 'off'"};
        return number;
    }

    void count(Skipped what)
    {
        Tally& tally = out_.skipped[what];
        if (tally.count++ == 0) tally.first_line = line_;
    }

    // So that they can be told apart from indices that count from the file's beginning.
    static constexpr std::size_t most_elements = (1u << 30) - 2;

    Chunk& out_;
    std::string joined_;
    int line_ = 0, lines_in_last_ = 0;
    bool is_finite_ = true;
};

} // namespace

Chunk parse_chunk(std::string_view text)
{
    Chunk chunk;
    Parser(chunk).read(text);
    return chunk;
}

} // namespace snell::obj
