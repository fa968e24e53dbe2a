// Errors come in three kinds: a bug is a check that prints both values and stops the program; bad input is an Error,
// thrown with a place and a remedy; an expected failure is a return value.
#pragma once

#include <fmt/format.h>

#include <stdexcept>
#include <string>

namespace snell {

// Where in a file something is wrong. Lines and columns count from 1; 0 is "not known".
struct Place
{
    std::string file;
    int line = 0;
    int column = 0;
};

// Bad input. what() reads "file:line:column: message; remedy".
class Error : public std::runtime_error
{
  public:
    // message: what is wrong; remedy: what the user can do about it, may be empty.
    Error(Place place, const std::string& message, const std::string& remedy = {});
    explicit Error(const std::string& message, const std::string& remedy = {}) : Error(Place{}, message, remedy) {}

    const Place place;
};

// Prints the message and aborts. For bugs in snell itself, never for bad input.
[[noreturn]] void fail_check(const char* file, int line, const std::string& message);

} // namespace snell

// Stop unless `a op b`; both values are printed. Checks stay in release builds: keep them out of inner loops.
#define SNELL_CHECK_OP(a, op, b)                                                                                       \
    do {                                                                                                               \
        const auto& snell_check_a = (a);                                                                               \
        const auto& snell_check_b = (b);                                                                               \
        if (!(snell_check_a op snell_check_b))                                                                         \
            ::snell::fail_check(                                                                                       \
                __FILE__, __LINE__,                                                                                    \
                fmt::format("{} {} {} does not hold: {} against {}", #a, #op, #b, snell_check_a, snell_check_b));      \
    } while (false)
#define SNELL_CHECK_EQ(a, b) SNELL_CHECK_OP(a, ==, b)
#define SNELL_CHECK_LT(a, b) SNELL_CHECK_OP(a, <, b)
#define SNELL_CHECK_LE(a, b) SNELL_CHECK_OP(a, <=, b)
