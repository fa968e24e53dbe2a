#include "snell/io/pbrt/tokenizer.h"

#include "snell/io/text_cursor.h"

#include <limits>

namespace snell::pbrt {

Tokenizer::Tokenizer(const std::string& file, std::string_view text)
    : file_(&file), p_(text.data()), end_(text.data() + text.size()), line_start_(p_)
{
    if (text.starts_with("\xef\xbb\xbf")) p_ += 3; // a byte order mark
    line_start_ = p_;
}

Token Tokenizer::next()
{
    if (!has_ahead_) return read();
    has_ahead_ = false;
    return ahead_;
}

const Token& Tokenizer::peek()
{
    if (!has_ahead_) ahead_ = read(), has_ahead_ = true;
    return ahead_;
}

void Tokenizer::skip_blanks()
{
    while (p_ < end_) {
        if (*p_ == '\n') {
            ++p_;
            if (line_ < std::numeric_limits<int>::max()) ++line_;
            line_start_ = p_;
        } else if (is_space(*p_)) {
            ++p_;
        } else if (*p_ == '#') {
            while (p_ < end_ && *p_ != '\n') ++p_;
        } else {
            return;
        }
    }
}

Token Tokenizer::read()
{
    skip_blanks();
    Token token;
    constexpr std::ptrdiff_t most = std::numeric_limits<int>::max() - 1;
    token.spot = {file_, line_, static_cast<int>(std::min(p_ - line_start_, most)) + 1};
    if (p_ == end_) return token;

    const char* const start = p_++;
    if (*start == '[' || *start == ']') {
        token.kind = *start == '[' ? Token::Kind::open : Token::Kind::close;
        token.text = {start, 1};
    } else if (*start == '"') {
        while (p_ < end_ && *p_ != '"' && *p_ != '\n') p_ += *p_ == '\\' && p_ + 1 < end_ && p_[1] != '\n' ? 2 : 1;
        if (p_ >= end_ || *p_ != '"')
            throw Error(token.spot.place(), "the string that begins here does not end on its line",
                        "add the closing quote");
        token.kind = Token::Kind::string;
        token.text = {start + 1, static_cast<std::size_t>(p_ - start - 1)};
        ++p_;
    } else {
        const auto ends_word = [](char c) { return is_space(c) || c == '"' || c == '[' || c == ']' || c == '#'; };
        while (p_ < end_ && !ends_word(*p_)) ++p_;
        token.kind = Token::Kind::word;
        token.text = {start, static_cast<std::size_t>(p_ - start)};
        for (const char c : token.text)
            if (c < ' ' || c > '~')
                throw Error(token.spot.place(),
                            fmt::format("{} is neither a directive nor a number", show_word(token.text)),
                            "it is no pbrt file, or a damaged one: check it");
    }
    return token;
}

std::string unescape(std::string_view text)
{
    std::string plain;
    plain.reserve(text.size());
    for (std::size_t i = 0; i < text.size(); ++i) {
        const char next = i + 1 < text.size() ? text[i + 1] : '\0';
        if (text[i] == '\\' && (next == '\\' || next == '"' || next == '\'')) ++i;
        plain += text[i];
    }
    return plain;
}

} // namespace snell::pbrt
