// snell list: everything that has a name.
#include "commands.h"
#include "names.h"
#include "options.h"

#include "snell/bvh/accel.h"
#include "snell/bvh/options.h"
#include "snell/render/gpu_options.h"
#include "snell/render/integrator.h"
#include "snell/scene/builtin.h"
#include "snell/scene/camera_models.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

namespace snell::app {

namespace {
struct Entry
{
    std::string name, summary;
    std::vector<std::string> parameters;
};

struct Section
{
    std::string key, title; // key: in JSON
    std::vector<Entry> entries;
};
} // namespace

static std::vector<Section> sections()
{
    std::vector<Section> all;
    Section& integrator = all.emplace_back(Section{"integrators", "Integrators (--integrator, -D)", {}});
    for (const IntegratorInfo& info : integrators())
        integrator.entries.push_back({info.name, info.summary, info.parameters});

    Section& accel = all.emplace_back(Section{"accels", "Acceleration structures (--accel)", {}});
    for (const AccelInfo& info : accels())
        accel.entries.push_back({std::string(info.name), std::string(info.summary), {}});
    Section& builder = all.emplace_back(Section{"builders", "Builders of trees (-D builder)", {}});
    for (const BuilderInfo& info : builders())
        builder.entries.push_back({std::string(info.name), std::string(info.summary), {}});
    Section& option = all.emplace_back(Section{"accel_parameters", "What structures take (-D)", {}});
    const auto add_parameters = [](Section& section, std::span<const std::string> lines) {
        for (const std::string& line : lines) {
            const std::size_t end = line.find("  ");
            section.entries.push_back({line.substr(0, end), line.substr(end + 2), {}});
        }
    };
    add_parameters(option, accel_parameters());
    add_parameters(all.emplace_back(Section{"gpu_parameters", "How GPUs work (-D)", {}}), gpu_parameters());

    const auto add_named = [&](const char* key, const char* title, const std::vector<Named>& names) {
        Section& section = all.emplace_back(Section{key, title, {}});
        for (const Named& one : names) section.entries.push_back({std::string(one.name), std::string(one.summary), {}});
    };
    Section& camera = all.emplace_back(Section{"camera_models", "Camera models (--camera-model)", {}});
    for (const CameraModelInfo& info : camera_models())
        camera.entries.push_back({std::string(info.name), std::string(info.summary), {}});
    add_named("samplers", "Samplers (--sampler)", samplers());
    add_named("tone_curves", "Tone curves (--tone)", tone_curves());

    Section& scene = all.emplace_back(Section{"scenes", "Built-in scenes", {}});
    for (const BuiltinScene& builtin : builtin_scenes()) {
        std::string summary(builtin.summary);
        if (builtin.make_with != nullptr)
            summary += fmt::format("; {}:{} for another, {} to {}", builtin.name, builtin.parameter, builtin.least,
                                   builtin.most);
        scene.entries.push_back({std::string(builtin.name), std::move(summary), {}});
    }

    add_named("scene_formats", "Scene files",
              {{".gltf", "glTF 2.0, with animations, skins and material variants"},
               {".glb", "the same in one file"},
               {".pbrt", "pbrt-v4, and v3's names"},
               {".obj", "Wavefront OBJ with MTL materials; also .obj.gz"},
               {".ply", "Stanford PLY, ASCII and binary; also .ply.gz"},
               {".stl", "STL, ASCII and binary; also .stl.gz"}});
    add_named("texture_formats", "Texture files",
              {{".png", "8 and 16 bit"},
               {".jpg", "JPEG"},
               {".tga", "Targa"},
               {".bmp", "BMP"},
               {".hdr", "Radiance, linear"},
               {".exr", "OpenEXR, linear"}});
    add_named("picture_formats", "Picture files (-o)",
              {{".exr", "OpenEXR, 32-bit float, linear, with layers and attributes"},
               {".png", "8 bit, exposure and tone curve applied, sRGB, dithered"},
               {".hdr", "Radiance, linear"},
               {".pfm", "portable float map, linear"}});
    return all;
}

static void print_text(const std::vector<Section>& all)
{
    bool first = true;
    for (const Section& section : all) {
        fmt::print("{}{}:\n", first ? "" : "\n", section.title);
        first = false;
        for (const Entry& entry : section.entries) {
            fmt::print("  {:20} {}\n", entry.name, entry.summary);
            for (const std::string& parameter : entry.parameters) fmt::print("  {:20}   -D {}\n", "", parameter);
        }
    }
}

static void print_json(const std::vector<Section>& all)
{
    nlohmann::ordered_json json;
    for (const Section& section : all) {
        auto& list = json[section.key] = nlohmann::ordered_json::array();
        for (const Entry& entry : section.entries) {
            nlohmann::ordered_json one = {{"name", entry.name}, {"summary", entry.summary}};
            if (section.key == "integrators") one["parameters"] = entry.parameters;
            list.push_back(std::move(one));
        }
    }
    fmt::print("{}\n", json.dump());
}

int run_list(const Arguments& arguments)
{
    bool json = false;
    Options options("list", "Lists everything that has a name.", "Examples:\n  snell list\n  snell list --json\n");
    options.flag("--json", "Print one JSON object", [&] { json = true; });
    if (const auto code = options.parse(arguments)) return *code;
    if (json)
        print_json(sections());
    else
        print_text(sections());
    return 0;
}

} // namespace snell::app
