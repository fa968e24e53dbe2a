#include "snell/core/error.h"

#include <cstdio>
#include <cstdlib>

namespace snell {

static std::string compose(const Place& place, const std::string& message, const std::string& remedy)
{
    std::string text = place.file;
    if (place.line > 0) text += fmt::format(":{}", place.line);
    if (place.line > 0 && place.column > 0) text += fmt::format(":{}", place.column);
    if (!text.empty()) text += ": ";
    text += message;
    if (!remedy.empty()) text += "; " + remedy;
    return text;
}

Error::Error(Place where, const std::string& message, const std::string& remedy)
    : std::runtime_error(compose(where, message, remedy)), place(std::move(where))
{
}

void fail_check(const char* file, int line, const std::string& message)
{
    std::fprintf(stderr, "snell: a bug, please report it: %s:%d: %s\n", file, line, message.c_str());
    std::abort();
}

} // namespace snell
