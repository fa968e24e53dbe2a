// snell convert: a scene into a file of another format.
#include "commands.h"
#include "console.h"
#include "options.h"
#include "scene_choice.h"
#include "usage.h"

#include "snell/io/file.h"
#include "snell/io/pbrt/write.h"

#include <fmt/format.h>

#include <filesystem>

namespace snell::app {

int run_convert(const Arguments& arguments)
{
    SceneChoice choice;
    std::filesystem::path output;
    WriteOptions write;
    Options options("convert", "Writes a scene as a pbrt-v4 file, which reads back the same.",
                    "Larger meshes go to the folder NAME_meshes beside NAME.pbrt, pictures to NAME_textures; what is\n"
                    "there is replaced. What pbrt has no words for is written in ours (docs/pbrt.md).\n\n"
                    "Examples:\n"
                    "  snell convert helmet.glb helmet.pbrt\n"
                    "  snell convert fox.glb fox.pbrt --animation Run --time 0.4\n"
                    "  snell convert cornell cornell.pbrt\n");
    options.positional("SCENE", scene_help, [&](const std::string& text) { choice.name = text; });
    options.positional("OUTPUT", "The file to write: .pbrt", [&](const std::string& text) { output = text; });
    options.flag("--overwrite", "Replace OUTPUT even if snell convert has not written it",
                 [&] { write.overwrite = true; });
    options.flag("-q,--quiet", "Say nothing but errors", [] { console().level = Console::Level::quiet; });
    options.flag("-v,--verbose", "Say more", [] { console().level = Console::Level::verbose; });
    add_scene_options(options, choice);
    add_loading_options(options, choice);
    if (const auto code = options.parse(arguments)) return *code;

    // What is wrong should be said before a large scene is read.
    if (lower_extension(output) != ".pbrt")
        throw UsageError(
            fmt::format("OUTPUT '{}' does not end in .pbrt, the one format that is written", output.string()));
    std::error_code error;
    if (std::filesystem::equivalent(choice.name, output, error))
        throw UsageError(fmt::format("'{}' cannot be written while it is read; give another OUTPUT", output.string()));
    check_pbrt_output(output, write);

    Scene scene = open_chosen(choice);
    hide_environment(scene, choice);
    console().notes(scene);
    for (const Note& note : write_pbrt(scene, output, write)) console().info(note.text);
    console().info(fmt::format("wrote {}", output.string()));
    return 0;
}

} // namespace snell::app
