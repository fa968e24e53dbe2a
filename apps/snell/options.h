// The options of a subcommand: thin over CLI11, which is slow to compile and so stays in options.cpp.
#pragma once

#include "commands.h"

#include <functional>
#include <memory>
#include <optional>
#include <string>

namespace snell::app {

// Names are written as CLI11 takes them, "-o,--output,--outfile". Values are handed over as text, in the order of the
// options' declaration; what a callback throws comes out of parse(). An option that takes one value and is given twice
// has the last one.
class Options
{
  public:
    using Flag = std::function<void()>;
    using Value = std::function<void(const std::string&)>;

    // epilogue: what follows the options in the help, such as examples.
    Options(std::string name, std::string summary, std::string epilogue);
    ~Options();
    Options(const Options&) = delete;
    Options& operator=(const Options&) = delete;

    // Options declared from now on appear under this heading of the help.
    void group(std::string title);

    void positional(const std::string& name, std::string help, Value set, bool required = true);
    // Any number of them, none included: one call for each.
    void positionals(const std::string& name, std::string help, Value set);
    void flag(const std::string& names, std::string help, Flag set);
    // A flag that, as --help does, ends the program instead of starting its work: parse() returns 0 after `act`.
    void action(const std::string& names, std::string help, Flag act);
    void value(const std::string& names, const std::string& placeholder, std::string help, Value set);
    // As value, but every occurrence counts: one call for each.
    void values(const std::string& names, const std::string& placeholder, std::string help, Value set);
    // A flag that may have a value, only with '=': --stats or --stats=json. Without one, set gets "".
    void flag_or_value(const std::string& names, const std::string& placeholder, std::string help, Value set);

    // Exit code if that is all there is to do (--help was asked for). Throws UsageError; an unknown option's error
    // names the nearest known one.
    std::optional<int> parse(Arguments arguments);

  private:
    struct Parser;
    std::unique_ptr<Parser> parser_;
};

} // namespace snell::app
