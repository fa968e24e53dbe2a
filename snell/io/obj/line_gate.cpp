#include "snell/io/obj/line_gate.h"

#include "snell/io/text_cursor.h"

#include <cstring>

namespace snell::obj {
namespace {

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

// Is it a number that tinyobjloader reads as it is meant?
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

// One index of at most 9 digits at the start of `word`; takes it off. False if it is something else.
bool take_index(std::string_view& word)
{
    std::size_t i = 0;
    if (i < word.size() && (word[i] == '-' || word[i] == '+')) ++i;
    const std::size_t start = i;
    while (i < word.size() && is_digit(word[i])) ++i;
    if (i == start || i - start > 9) return false;
    word.remove_prefix(i);
    return true;
}

// i, i/j, i//k, i/j/k; slashes without a number behind them are forgiven, for some exporters write them.
bool is_corner(std::string_view word)
{
    if (!take_index(word)) return false;
    for (int part = 0; part < 2 && !word.empty(); ++part) {
        if (word.front() != '/') return false;
        word.remove_prefix(1);
        if (!word.empty() && word.front() != '/' && !take_index(word)) return false;
    }
    return word.empty();
}

} // namespace

LineGate::LineGate(const std::string& file, std::string& text, Document& document)
    : file_(file), text_(text), document_(document)
{
    next_feed_ = text_.find('\n');
    if (text_.starts_with("\xEF\xBB\xBF")) offset_ = 3; // a byte order mark
    material_ = number_of(document_.materials, material_numbers_, "");
    object_ = number_of(document_.objects, object_numbers_, "");
}

LineGate::int_type LineGate::underflow()
{
    while (next_line())
        if (admit(shown_)) return traits_type::to_int_type(*gptr());
    return traits_type::eof();
}

// Moves to the next line of the file, continued lines joined, and makes it the stream's content.
bool LineGate::next_line()
{
    line_ += lines_in_last_;
    lines_in_last_ = 0;
    if (offset_ >= text_.size()) return false;

    joined_.clear();
    for (;;) {
        // find_first_of would call memchr for every character. In files with carriage returns only, the next line feed
        // is at the end of the text: look for it once.
        if (next_feed_ < offset_) next_feed_ = text_.find('\n', offset_);
        std::size_t end = next_feed_;
        const char* const first = text_.data() + offset_;
        if (const void* r = std::memchr(first, '\r', std::min(end, text_.size()) - offset_))
            end = offset_ + static_cast<std::size_t>(static_cast<const char*>(r) - first);
        const bool has_end = end != std::string::npos;
        if (!has_end) end = text_.size();
        const std::string_view line(text_.data() + offset_, end - offset_);
        char* const start = text_.data() + offset_;
        std::size_t after = has_end ? end + 1 : end;
        if (has_end && text_[end] == '\r' && after < text_.size() && text_[after] == '\n') ++after;
        offset_ = after;
        ++lines_in_last_;

        if (line.ends_with('\\') && after < text_.size() && !trim(line).starts_with('#')) {
            joined_ += line.substr(0, line.size() - 1);
            joined_ += ' ';
            continue;
        }
        if (joined_.empty() && has_end && text_[after - 1] == '\n') {
            shown_ = line;
            setg(start, start, text_.data() + after);
        } else {
            joined_ += line;
            show_joined();
        }
        return true;
    }
}

void LineGate::show_joined()
{
    joined_ += '\n';
    shown_ = std::string_view(joined_).substr(0, joined_.size() - 1);
    setg(joined_.data(), joined_.data(), joined_.data() + joined_.size());
}

// Checks the line; true if tinyobjloader is to see it.
bool LineGate::admit(std::string_view line)
{
    non_finite_ = 0;
    has_color_ = false;
    std::string_view rest = line;
    const std::string_view keyword = take_word(rest);
    if (keyword.empty() || keyword.front() == '#') return false;
    if (keyword == "v") return check_vertex(rest), true;
    if (keyword == "vn") return check_numbers(rest, 3, 3), true;
    if (keyword == "vt") return check_numbers(rest, 1, 3), true;
    if (keyword == "f" || keyword == "fo") { // as faces were called before version 3
        if (check_indices(rest) && keyword == "f") return true;
        rewrite_face(rest);
        return true;
    }
    if (!handle(keyword, rest)) count(unknown_);
    return false;
}

bool LineGate::handle(std::string_view keyword, std::string_view rest)
{
    const std::string_view name = trim(rest);
    if (keyword == "usemtl") {
        material_ = number_of(document_.materials, material_numbers_, name);
    } else if (keyword == "o") {
        has_objects_ = true;
        object_ = number_of(document_.objects, object_numbers_, name);
    } else if (keyword == "g") {
        // Groups within objects are not told apart: objects are what people see in their editor's outline.
        if (!has_objects_) object_ = number_of(document_.objects, object_numbers_, name);
    } else if (keyword == "s") {
        set_smoothing(rest);
    } else if (keyword == "mtllib") {
        document_.libraries.push_back({std::string(name), line_});
    } else if (keyword == "l" || keyword == "p") {
        count(undrawn_);
    } else if (keyword == "vp" || keyword == "cstype" || keyword == "curv" || keyword == "curv2" || keyword == "surf" ||
               keyword == "deg" || keyword == "parm" || keyword == "trim" || keyword == "hole" || keyword == "bmat" ||
               keyword == "step" || keyword == "scrv" || keyword == "sp" || keyword == "end" || keyword == "con") {
        count(free_form_);
    } else {
        // Hints for renderers of its time, which change no surface.
        for (const std::string_view hint : {"mg", "lod", "bevel", "c_interp", "d_interp", "usemap", "maplib",
                                            "shadow_obj", "trace_obj", "ctech", "stech", "vw"})
            if (keyword == hint) return true;
        return false;
    }
    return true;
}

// Returns how many numbers there are. Others than least to most: an Error.
int LineGate::check_numbers(std::string_view rest, int least, int most)
{
    int numbers = 0;
    for (std::string_view word = take_word(rest); !word.empty(); word = take_word(rest)) {
        if (word.front() == '#') break; // a comment behind the numbers
        const Number kind = classify(word);
        if (kind == Number::garbage)
            fail_at(word, fmt::format("a number should be here, but there is {}", show_word(word)),
                    "mend the line or write the file again");
        if (++numbers > most) fail_at(word, fmt::format("more than {} numbers", most), "remove what is too much");
        if (kind == Number::not_finite) ++non_finite_;
    }
    if (numbers < least)
        fail(fmt::format("{} numbers where there should be {}", numbers, least),
             "mend the line or write the file again");
    if (non_finite_ > 0) count(not_finite_);
    return numbers;
}

// x y z, x y z w, x y z r g b, or x y z r g b a.
void LineGate::check_vertex(std::string_view rest)
{
    if (check_numbers(rest, 3, 7) < 6) return;
    has_color_ = true;
    for (int i = 0; i < 3; ++i) take_word(rest);
    for (int i = 0; i < 3; ++i) {
        const std::string_view word = take_word(rest);
        const char* p = word.data();
        float value = 0;
        if (!read_float(p, word.data() + word.size(), value) || !std::isfinite(value)) value = 0;
        color_[i] = value;
    }
}

// False if tinyobjloader would misread the line: it takes a comment's words for corners, and in "1/ 2/ 3" the next
// corner for what is missing behind the slash.
bool LineGate::check_indices(std::string_view rest)
{
    bool is_plain = true;
    for (std::string_view word = take_word(rest); !word.empty(); word = take_word(rest)) {
        if (word.front() == '#') return false;
        if (!is_corner(word))
            fail_at(
                word,
                fmt::format("a face's corner should be here, like 1, 1/2 or 1/2/3, but there is {}", show_word(word)),
                "mend the line or write the file again");
        is_plain = is_plain && word.back() != '/';
    }
    return is_plain;
}

void LineGate::rewrite_face(std::string_view rest)
{
    std::string plain = "f";
    for (std::string_view word = take_word(rest); !word.empty() && word.front() != '#'; word = take_word(rest)) {
        while (word.back() == '/') word.remove_suffix(1);
        plain.append(" ").append(word);
    }
    joined_ = plain;
    show_joined();
}

void LineGate::set_smoothing(std::string_view rest)
{
    const std::string_view group = take_word(rest);
    smoothing_ = 0;
    if (group == "on")
        smoothing_ = 1;
    else if (group != "off" && !group.empty()) {
        const auto result = std::from_chars(group.data(), group.data() + group.size(), smoothing_);
        if (result.ec != std::errc() || result.ptr != group.data() + group.size())
            fail_at(group, fmt::format("a smoothing group should be here, but there is {}", show_word(group)),
                    "write a number or 'off'");
    }
}

void LineGate::count(Tally& tally)
{
    if (tally.count++ == 0) tally.first_line = line_;
}

void LineGate::report()
{
    for (const Tally* tally : {&undrawn_, &free_form_, &unknown_, &not_finite_})
        if (tally->count > 0)
            document_.warnings.push_back(fmt::format("{}:{}: {} ({} such line{})", file_, tally->first_line,
                                                     tally->what, tally->count, tally->count == 1 ? "" : "s"));
}

uint LineGate::number_of(std::vector<std::string>& names, std::unordered_map<std::string, uint>& numbers,
                         std::string_view name)
{
    const auto [entry, is_new] = numbers.try_emplace(std::string(name), static_cast<uint>(names.size()));
    if (is_new) names.emplace_back(name);
    return entry->second;
}

void LineGate::fail(const std::string& message, const std::string& remedy) const
{
    throw Error({file_, line_, 0}, message, remedy);
}

void LineGate::fail_at(std::string_view word, const std::string& message, const std::string& remedy) const
{
    // In a line joined from several, a column would mislead.
    const int column = lines_in_last_ > 1 ? 0 : static_cast<int>(word.data() - shown_.data()) + 1;
    throw Error({file_, line_, column}, message, remedy);
}

} // namespace snell::obj
