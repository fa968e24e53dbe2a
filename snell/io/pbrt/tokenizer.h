// Words, strings and brackets of a pbrt file, each with its place.
#pragma once

#include "snell/core/error.h"

#include <string>
#include <string_view>

namespace snell::pbrt {

// A place in a file, small enough to go with every word. `file` outlives the loading.
struct Spot
{
    const std::string* file = nullptr;
    int line = 0, column = 0;

    Place place() const { return {file != nullptr ? *file : std::string(), line, column}; }
    // "file:line: ", for notes.
    std::string prefix() const { return file != nullptr ? fmt::format("{}:{}: ", *file, line) : std::string(); }
};

struct Token
{
    enum class Kind
    {
        end,
        word,   // a directive, a number, true or false
        string, // text is what stands between the quotes, escapes as they are
        open,   // [
        close   // ]
    };
    Kind kind = Kind::end;
    std::string_view text; // part of the file's text
    Spot spot;
};

// Splits a text that must outlive it. Comments (# to the end of the line) are skipped. Throws Error at a string that
// does not end on its line, and at a character that no pbrt file has.
class Tokenizer
{
  public:
    Tokenizer(const std::string& file, std::string_view text);

    // The next token, again and again Kind::end at the end.
    Token next();
    // The same without going on.
    const Token& peek();

  private:
    Token read();
    void skip_blanks();

    const std::string* file_;
    const char* p_;
    const char* end_;
    const char* line_start_;
    int line_ = 1;
    Token ahead_;
    bool has_ahead_ = false;
};

// A string's text without its escapes: \\ \" \'. Others stay as they are, for names with backslashes.
std::string unescape(std::string_view text);

} // namespace snell::pbrt
