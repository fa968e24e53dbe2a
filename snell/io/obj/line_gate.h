// What stands between an OBJ file and tinyobjloader.
#pragma once

#include "snell/io/obj/parse.h"

#include <streambuf>
#include <string_view>
#include <unordered_map>

namespace snell::obj {

// A stream of the lines that tinyobjloader may see, and the keeper of what it does not know: the line number, smoothing
// groups, vertex colours, names with spaces.
//
// tinyobjloader (2.0 rc 10) reads a damaged number as 0, has undefined behaviour for large exponents and indices, knows
// no continued lines, and blows up on some tags; so every number is checked here, only `v`, `vt`, `vn` and `f` lines
// are handed on, and the others are dealt with here. It asks for the next line only when it is done with the last one:
// during its callbacks, what this class says is about the line that the callback is for.
class LineGate : public std::streambuf
{
  public:
    LineGate(const std::string& file, std::string& text, Document& document);

    int line() const { return line_; }
    // The numbers of this line are not all finite; tinyobjloader reads those that are not as 0.
    bool is_finite() const { return non_finite_ == 0; }
    // The vertex of this line has a colour, or not.
    bool has_color() const { return has_color_; }
    vec3 color() const { return color_; }
    uint object() const { return object_; }
    uint material() const { return material_; }
    uint smoothing() const { return smoothing_; }

    // Puts one warning of each kind into the document: where it happened first and how often.
    void report();

    [[noreturn]] void fail(const std::string& message, const std::string& remedy) const;

  protected:
    int_type underflow() override;

  private:
    struct Tally
    {
        const char* what;
        int first_line = 0;
        std::size_t count = 0;
    };

    bool next_line();
    void show_joined();
    bool admit(std::string_view line);
    bool handle(std::string_view keyword, std::string_view rest);
    int check_numbers(std::string_view rest, int least, int most);
    bool check_indices(std::string_view rest);
    void rewrite_face(std::string_view rest);
    void check_vertex(std::string_view rest);
    void set_smoothing(std::string_view rest);
    void count(Tally& tally);
    uint number_of(std::vector<std::string>& names, std::unordered_map<std::string, uint>& numbers,
                   std::string_view name);
    [[noreturn]] void fail_at(std::string_view word, const std::string& message, const std::string& remedy) const;

    std::string file_;
    std::string& text_;
    Document& document_;
    std::size_t offset_ = 0;    // of the next line in the text
    std::size_t next_feed_ = 0; // of the first line feed from there on
    std::string joined_;        // a line that is not in the text as it is handed on
    std::string_view shown_;    // the line at hand
    int line_ = 0, lines_in_last_ = 1;

    int non_finite_ = 0;
    bool has_color_ = false;
    vec3 color_{1.0f};
    uint object_ = 0, material_ = 0, smoothing_ = 0;
    bool has_objects_ = false;
    std::unordered_map<std::string, uint> object_numbers_, material_numbers_;

    Tally undrawn_{"lines and points are not drawn"};
    Tally free_form_{"free-form curves and surfaces are not supported and left out"};
    Tally unknown_{"unknown keywords are skipped"};
    Tally not_finite_{"numbers that are not finite"};
};

} // namespace snell::obj
