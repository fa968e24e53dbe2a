#include "options.h"

#include "usage.h"

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include <algorithm>
#include <cstdio>

namespace snell::app {

struct Options::Parser
{
    CLI::App app;
    std::string name, group = "Options";
    std::vector<std::string> known;    // "--output", "-o", ...
    std::vector<std::string> valued;   // those of them that take a value
    std::vector<std::string> optional; // those that may take one
};

// What parse() adds; no one types a line break.
static const std::string no_value = "\n";

Options::Options(std::string name, std::string summary, std::string epilogue) : parser_(std::make_unique<Parser>())
{
    parser_->name = name;
    parser_->app.name("snell " + name);
    parser_->app.description(std::move(summary));
    parser_->app.footer("\n" + std::move(epilogue));
    parser_->app.get_formatter()->column_width(38);
    parser_->app.get_formatter()->label("REQUIRED", "");
    parser_->app.set_help_flag("-h,--help", "Show this help");
    parser_->known = {"--help", "-h"};
}

Options::~Options() = default;

void Options::group(std::string title)
{
    parser_->group = std::move(title);
}

static void remember(std::vector<std::string>& list, const std::string& names)
{
    for (std::size_t begin = 0; begin < names.size();) {
        const std::size_t end = std::min(names.find(',', begin), names.size());
        list.push_back(names.substr(begin, end - begin));
        begin = end + 1;
    }
}

void Options::positional(const std::string& name, std::string help, Value set, bool required)
{
    CLI::Option* option = parser_->app.add_option_function<std::string>(name, std::move(set), std::move(help));
    option->type_name("")->required(required);
}

static std::function<void(const std::vector<std::string>&)> for_each(Options::Value set)
{
    return [set = std::move(set)](const std::vector<std::string>& all) {
        for (const std::string& one : all) set(one);
    };
}

void Options::positionals(const std::string& name, std::string help, Value set)
{
    parser_->app.add_option_function<std::vector<std::string>>(name, for_each(std::move(set)), std::move(help))
        ->type_name("");
}

void Options::flag(const std::string& names, std::string help, Flag set)
{
    remember(parser_->known, names);
    parser_->app
        .add_flag_function(
            names, [set = std::move(set)](std::int64_t) { set(); }, std::move(help))
        ->group(parser_->group)
        ->disable_flag_override();
}

void Options::action(const std::string& names, std::string help, Flag act)
{
    flag(names, std::move(help), [act = std::move(act)] {
        act();
        throw CLI::Success(); // before CLI11 looks for missing arguments
    });
}

void Options::value(const std::string& names, const std::string& placeholder, std::string help, Value set)
{
    remember(parser_->known, names);
    remember(parser_->valued, names);
    parser_->app.add_option_function<std::string>(names, std::move(set), std::move(help))
        ->type_name(placeholder)
        ->multi_option_policy(CLI::MultiOptionPolicy::TakeLast)
        ->group(parser_->group);
}

void Options::values(const std::string& names, const std::string& placeholder, std::string help, Value set)
{
    remember(parser_->known, names);
    remember(parser_->valued, names);
    parser_->app.add_option_function<std::vector<std::string>>(names, for_each(std::move(set)), std::move(help))
        ->type_name(placeholder)
        ->expected(1)             // or the help would promise several after one name
        ->allow_extra_args(false) // or it would swallow the positional arguments after its value
        ->multi_option_policy(CLI::MultiOptionPolicy::TakeAll)
        ->group(parser_->group);
}

void Options::flag_or_value(const std::string& names, const std::string& placeholder, std::string help, Value set)
{
    // For CLI11 this is an option with a value; parse() adds one where it is missing.
    value(names, placeholder, std::move(help),
          [set = std::move(set)](const std::string& text) { set(text == no_value ? std::string() : text); });
    const std::size_t count = static_cast<std::size_t>(std::count(names.begin(), names.end(), ',')) + 1;
    for (std::size_t i = 0; i < count; ++i) {
        parser_->optional.push_back(parser_->valued.back());
        parser_->valued.pop_back();
    }
}

std::optional<int> Options::parse(Arguments arguments)
{
    const auto among = [](const std::vector<std::string>& list, const std::string& word) {
        return std::find(list.begin(), list.end(), word) != list.end();
    };
    Arguments joined;
    for (std::size_t i = 0; i < arguments.size(); ++i) {
        const std::string& word = arguments[i];
        if (word == "--") { // the rest is positional
            joined.insert(joined.end(), arguments.begin() + static_cast<std::ptrdiff_t>(i), arguments.end());
            break;
        }
        const std::string option = word.substr(0, word.find('='));
        if (word.starts_with("--") && !among(parser_->known, option))
            throw UsageError(fmt::format("unknown option '{}'{}; `snell {} --help` lists all", option,
                                         did_you_mean(option, parser_->known), parser_->name));
        // A value may begin with a minus, as in --eye -1,2,3: bind it to its option, lest it be taken for one.
        if (among(parser_->valued, word)) {
            if (i + 1 == arguments.size()) throw UsageError(fmt::format("{} needs a value", word));
            joined.push_back(word.starts_with("--") ? word + "=" + arguments[++i] : word + arguments[++i]);
        } else if (among(parser_->optional, word)) {
            joined.push_back(word + "=" + no_value);
        } else {
            joined.push_back(word);
        }
    }

    std::reverse(joined.begin(), joined.end()); // CLI11 takes them from the back
    try {
        parser_->app.parse(std::move(joined));
    } catch (const CLI::CallForHelp&) {
        std::string help = parser_->app.help();
        for (std::size_t at; (at = help.find("\n\n\n")) != std::string::npos;) help.erase(at, 1);
        std::fputs(help.c_str(), stdout);
        return 0;
    } catch (const CLI::Success&) {
        return 0;
    } catch (const CLI::ParseError& error) {
        std::string message = error.what();
        std::replace(message.begin(), message.end(), '\n', ' ');
        throw UsageError(fmt::format("{}; `snell {} --help` lists all options", message, parser_->name));
    }
    return std::nullopt;
}

} // namespace snell::app
