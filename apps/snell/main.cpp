// The program: finds the subcommand and turns exceptions into one line and an exit code.
#include "commands.h"
#include "console.h"
#include "devices.h"
#include "usage.h"

#include "snell/core/error.h"
#include "snell/core/version.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <array>
#include <cstdio>
#include <new>

namespace snell::app {

struct Command
{
    const char* name;
    const char* summary;
    int (*run)(const Arguments&);
};

static const std::array commands = {
    Command{"render", "Render a picture of a scene", run_render},
    Command{"view", "Walk through a scene in a window", run_view},
    Command{"info", "Say what is in a scene and how much memory it takes", run_info},
    Command{"convert", "Write a scene as a pbrt file", run_convert},
    Command{"list", "List integrators, structures, samplers, built-in scenes and file formats", run_list},
    Command{"compare", "Measure how much two pictures differ", run_compare},
    Command{"probe", "Show what a pixel sees, and one of its samples vertex by vertex", run_probe},
    Command{"camera", "Measure what a camera or a lens does to the picture", run_camera},
    Command{"bench", "Measure the renderer's speed beside Embree", run_bench},
};

static void print_help()
{
    fmt::print("snell {}: a physically based ray tracer to experiment with\n\n"
               "Usage: snell COMMAND [OPTIONS]\n\nCommands:\n",
               version());
    for (const Command& command : commands) fmt::print("  {:10}{}\n", command.name, command.summary);
    fmt::print("\nOptions:\n"
               "  -h, --help      Show this help; `snell COMMAND --help` shows a command's options\n"
               "  --version       Show version, commit, compiler and instruction sets\n"
               "  --list-devices  Show what can render\n\n"
               "Examples:\n"
               "  snell render cornell                          the default scene, to cornell.png\n"
               "  snell render dragon.ply -o dragon.exr --spp 256\n"
               "  snell view cornell                            walk through it in a window\n"
               "  snell list                                    what there is to choose from\n");
}

static void print_version()
{
    fmt::print("snell {} (commit {})\nbuilt with {}\ninstruction sets: {}\n", version(), commit(), compiler(),
               fmt::join(instruction_sets(), ", "));
}

static int run(const Arguments& arguments)
{
    if (arguments.empty() || arguments[0] == "--help" || arguments[0] == "-h" || arguments[0] == "help") {
        print_help();
        return 0;
    }
    if (arguments[0] == "--version") {
        print_version();
        return 0;
    }
    if (arguments[0] == "--list-devices") {
        print_devices();
        return 0;
    }
    Arguments names;
    for (const Command& command : commands) {
        if (arguments[0] == command.name) return command.run({arguments.begin() + 1, arguments.end()});
        names.emplace_back(command.name);
    }
    if (arguments[0].starts_with('-')) {
        const Arguments options = {"--help", "--version", "--list-devices"};
        throw UsageError(fmt::format("unknown option '{}'{}; a command comes first: snell {}", arguments[0],
                                     did_you_mean(arguments[0], options), fmt::join(names, "|")));
    }
    check_name("command", arguments[0], names);
    return 2;
}

} // namespace snell::app

int main(int argc, char** argv)
{
    using namespace snell;
    app::Console& console = app::console();
    try {
        const int code = app::run({argv + 1, argv + argc});
        if (std::fflush(stdout) != 0) throw Error("cannot write to the standard output");
        return code;
    } catch (const app::UsageError& error) {
        console.error(error.what());
        return 2;
    } catch (const Error& error) {
        console.error(error.what());
    } catch (const std::bad_alloc&) {
        console.error("out of memory; try a smaller picture or a smaller scene");
    } catch (const std::exception& error) {
        console.error(error.what());
    }
    return 1;
}
