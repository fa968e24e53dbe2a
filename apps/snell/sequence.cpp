#include "sequence.h"

#include "usage.h"

#include <fmt/format.h>

namespace snell::app {

std::filesystem::path FramePattern::file(uint frame) const
{
    return before + fmt::format("{:0{}}", frame, digits) + after;
}

// The conversion that begins behind the '%' at text[at - 1]; at: moved behind it. -1: none.
static int parse_digits(const std::string& text, std::size_t& at)
{
    int digits = 0;
    const bool zeros = at < text.size() && text[at] == '0';
    if (zeros) ++at;
    const std::size_t begin = at;
    for (; at < text.size() && text[at] >= '0' && text[at] <= '9' && at < begin + 2; ++at)
        digits = 10 * digits + (text[at] - '0');
    // "%4d" would put blanks into names.
    if (at >= text.size() || text[at] != 'd' || (digits > 0 && !zeros) || digits > 20) return -1;
    ++at;
    return digits;
}

FramePattern parse_frame_pattern(const std::string& output)
{
    FramePattern pattern;
    int numbers = 0;
    for (std::size_t i = 0; i < output.size();) {
        std::string& part = numbers == 0 ? pattern.before : pattern.after;
        const char c = output[i++];
        if (c != '%') {
            part += c;
        } else if (i < output.size() && output[i] == '%') {
            part += '%';
            ++i;
        } else {
            const int digits = parse_digits(output, i);
            if (digits < 0 || ++numbers > 1)
                throw UsageError(fmt::format("-o: '{}' {}; give one number, such as out.%04d.exr, and %% for a percent "
                                             "sign",
                                             output, digits < 0 ? "has a % that is no number" : "has two numbers"));
            pattern.digits = digits;
        }
    }
    if (numbers == 1) return pattern;
    const std::filesystem::path plain = pattern.before;
    const std::string ending = plain.extension().string();
    pattern.before = pattern.before.substr(0, pattern.before.size() - ending.size()) + ".";
    pattern.after = ending;
    pattern.digits = 4;
    pattern.changed = true;
    return pattern;
}

} // namespace snell::app
