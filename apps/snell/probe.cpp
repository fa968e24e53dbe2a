// snell probe: what is behind a pixel, and how one of its samples comes about.
#include "commands.h"
#include "console.h"
#include "render_job.h"
#include "usage.h"

#include "snell/core/parallel.h"
#include "snell/kernel/record.h"
#include "snell/lab/pixel_probe.h"
#include "snell/render/integrator.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <cmath>
#include <limits>

namespace snell::app {

using Json = nlohmann::ordered_json;

namespace {
struct ProbeJob
{
    RenderJob render;
    std::string pixel;
    uint sample = 0;
    bool json = false;
};

struct Probed
{
    const Scene& scene;
    const RenderSettings& settings;
    PixelProbe pixel;
    PixelValue value;
    ProbedPath path;
    bool is_exact = false; // render() gives the same sample, to the bit
};
} // namespace

static constexpr const char* examples =
    "Examples:\n"
    "  snell probe cornell --pixel 256,300                 what is there, and the vertices of sample 0\n"
    "  snell probe whitted --pixel 200,250 --integrator whitted\n"
    "  snell probe scene.glb --size 1280x720 --pixel 640,360 --sample 17 --json\n";

static std::optional<int> parse_probe(const Arguments& arguments, ProbeJob& job)
{
    Asked& asked = job.render.asked;
    Options options("probe", "Shows what a pixel sees, and one of its samples vertex by vertex: docs/probe.md.",
                    examples);
    options.positional("SCENE", scene_help, [&](const std::string& text) { job.render.scene.name = text; });
    options.group("Picture");
    options.value("--pixel", "X,Y", "The pixel; 0,0 is the upper left one",
                  [&](const std::string& text) { job.pixel = text; });
    options.value("--sample", "N", "Number of the sample whose path is shown [0]", [&](const std::string& text) {
        job.sample = static_cast<uint>(parse_integer("--sample", text, 0, std::numeric_limits<uint>::max() - 1));
    });
    options.value(
        "--spp,--samples", "N", "Samples that the pixel's value is the mean of [64]",
        [&](const std::string& text) { asked.spp = static_cast<uint>(parse_integer("--spp", text, 1, 1 << 24)); });
    options.value("--width", "W", "Pixels of the whole picture [512]", [&](const std::string& text) {
        asked.width = static_cast<int>(parse_integer("--width", text, 1, 65536));
    });
    options.value("--height", "H", "Likewise", [&](const std::string& text) {
        asked.height = static_cast<int>(parse_integer("--height", text, 1, 65536));
    });
    options.value("--size,--resolution", "WxH", "Both",
                  [&](const std::string& text) { std::tie(asked.width, asked.height) = parse_size("--size", text); });
    options.flag("--disable-pixel-jitter", "All samples through the pixel's centre",
                 [&] { job.render.settings.pixel_jitter = false; });
    options.flag("--json", "Print one JSON object", [&] { job.json = true; });
    options.flag("-q,--quiet", "Say nothing but errors", [] { console().level = Console::Level::quiet; });
    add_camera_options(options, job.render.camera);
    add_scene_options(options, job.render.scene);
    add_loading_options(options, job.render.scene);
    add_technique_options(options, job.render);
    if (const auto code = options.parse(arguments)) return code;
    if (job.pixel.empty()) throw UsageError("--pixel: which one? such as --pixel 256,300");
    asked.pixel = job.pixel;
    return std::nullopt;
}

// ---- text ----

static std::string numbers(vec3 v)
{
    return fmt::format("{:.6g} {:.6g} {:.6g}", v.x, v.y, v.z);
}

static void row(const char* name, const std::string& value)
{
    fmt::print("{:12} {}\n", name, value);
}

static void print_pixel(const Probed& probed)
{
    const PixelProbe& pixel = probed.pixel;
    const PixelValue& value = probed.value;
    row("pixel", fmt::format("{},{} of {}x{}, {}", pixel.x, pixel.y, probed.settings.width, probed.settings.height,
                             probed.settings.integrator));
    row("value", fmt::format("{}, mean of {} samples, standard error {:.3g} (luminance)", numbers(value.mean),
                             value.samples, value.standard_error));
    const ProbedVertex& v = pixel.first;
    if (!v.is_surface) {
        row("hit", fmt::format("nothing, after {} traversal steps", v.steps));
        return;
    }
    row("hit", fmt::format("{} of '{}'{}", primitive_name(v.hit.primitive), pixel.object,
                           pixel.instance.empty() ? "" : fmt::format(" in '{}'", pixel.instance)));
    row("material", fmt::format("{}: '{}', {}, albedo {}", v.surface.material, pixel.material,
                                material_kind_name(v.material_kind), numbers(pixel.albedo)));
    row("distance", fmt::format("{:.6g}, {} traversal steps", pixel.depth, v.steps));
    row("position", numbers(v.surface.position));
    row("normals", fmt::format("{} geometric, {} shading", numbers(v.surface.geometric_normal),
                               numbers(v.surface.shading_normal)));
    row("uv",
        fmt::format("{:.6g} {:.6g}, barycentrics {:.6g} {:.6g}", v.surface.uv.x, v.surface.uv.y, v.hit.u, v.hit.v));
}

static std::string density(float pdf, uint event)
{
    const bool is_specular = event == event_specular_reflection || event == event_specular_refraction;
    return is_specular ? fmt::format("probability {:.4g}", pdf) : fmt::format("pdf {:.4g}/sr", pdf);
}

static void print_light(const Probed& probed, const ProbedLight& light)
{
    const bool is_light = probed.settings.integrator != "ao";
    std::string text = !is_light             ? std::string("a direction")
                       : light.light == none ? std::string("the environment")
                                             : fmt::format("light {}", light.light);
    if (light.drawn.pdf == 0.0f) {
        fmt::print("    {:10} {}: no sample\n", "light", text);
        return;
    }
    if (is_light && light.drawn.is_infinite == 0u) text += fmt::format(" at {}", numbers(light.drawn.target));
    text += light.drawn.is_delta != 0u ? fmt::format(", chosen with probability {:.4g}", light.drawn.pdf)
                                       : fmt::format(", pdf {:.4g}/sr", light.drawn.pdf);
    if (light.bsdf_pdf > 0.0f)
        text += fmt::format(", BSDF pdf {:.4g}/sr, MIS weight {:.4g}", light.bsdf_pdf, light.weight);
    if (!light.was_traced)
        text += ": adds nothing, not traced";
    else if (light.is_blocked)
        text += fmt::format(": blocked at distance {:.6g}", light.blocked_at);
    else
        text += fmt::format(": visible, adds {} to {}", numbers(light.value), layer_name(light.layer));
    fmt::print("    {:10} {}\n", "light", text);
}

static void print_vertex(const Probed& probed, std::size_t number)
{
    const ProbedVertex& v = probed.path.vertices[number];
    const std::string from = v.parent < 0 ? std::string("the camera") : fmt::format("vertex {}", v.parent);
    const std::string medium =
        v.arriving.medium == none ? "" : fmt::format(", through '{}'", material_name(probed.scene, v.arriving.medium));
    const std::string holes = v.passed_holes ? ", through holes" : "";
    if (v.is_surface)
        fmt::print("  {}  {} of '{}', '{}' ({}), {:.6g} from {}{}{}, {} steps\n", number,
                   primitive_name(v.hit.primitive), object_name(probed.scene, v.surface.object),
                   material_name(probed.scene, v.surface.material), material_kind_name(v.material_kind), v.hit.t, from,
                   medium, holes, v.steps);
    else
        fmt::print("  {}  escaped from {}{}{}, {} steps\n", number, from, medium, holes, v.steps);
    if (v.is_surface)
        fmt::print("    {:10} {}, normal {}\n", "position", numbers(v.surface.position),
                   numbers(v.surface.shading_normal));
    fmt::print("    {:10} {}\n", "throughput", numbers(v.throughput));
    if (!is_black(v.emission)) {
        std::string text = numbers(v.emission);
        if (v.emission_pdf > 0.0f)
            text += fmt::format(", BSDF pdf {:.4g}/sr, light pdf {:.4g}/sr", v.arriving.pdf, v.emission_pdf);
        text += fmt::format(", MIS weight {:.4g}: adds {} to {}", v.emission_weight, numbers(v.emitted),
                            layer_name(v.layer));
        fmt::print("    {:10} {}\n", "emission", text);
    } else if (!is_black(v.emitted)) {
        fmt::print("    {:10} adds {} to {}\n", "value", numbers(v.emitted), layer_name(v.layer));
    }
    for (const ProbedLight& light : v.lights) print_light(probed, light);
    if (v.survival < 1.0f)
        fmt::print("    {:10} survival probability {:.4g}: {}\n", "roulette", v.survival,
                   v.ending == ending_roulette ? "ends here" : "goes on");
    for (const ProbedVertex::Continuation& c : v.continuations) {
        const std::string onward =
            c.vertex >= 0 ? fmt::format(": to vertex {} with throughput {}", c.vertex, numbers(c.throughput))
            : v.ending == ending_none ? std::string(": too faint, not followed")
                                      : std::string();
        fmt::print("    {:10} {}, {}, weight {}{}\n", "event", event_name(c.event), density(c.pdf, c.event),
                   numbers(c.weight), onward);
    }
    if (v.ending != ending_none && v.ending != ending_escaped)
        fmt::print("    {:10} {}\n", "end", ending_name(v.ending));
}

static void print_text(const Probed& probed)
{
    print_pixel(probed);
    const ProbedPath& path = probed.path;
    fmt::print("\nsample {} at {:.6g},{:.6g}: {} = emission {} + direct {} + indirect {}\n", path.sample,
               path.film_position.x, path.film_position.y, numbers(path.radiance), numbers(path.layers[layer_emission]),
               numbers(path.layers[layer_direct]), numbers(path.layers[layer_indirect]));
    for (std::size_t i = 0; i < path.vertices.size(); ++i) print_vertex(probed, i);
    fmt::print("{}\n", probed.is_exact ? "the renderer's value of this sample is the same, to the bit"
                                       : "the renderer's value of this sample DIFFERS: please report");
}

// ---- JSON; the keys are documented in docs/probe.md ----

static Json triple(vec3 v)
{
    return Json::array({v.x, v.y, v.z});
}

// JSON has no infinity; null stands for it, as for an index of nothing.
static Json number(float x)
{
    return is_finite(x) ? Json(x) : Json(nullptr);
}
static Json index(uint i)
{
    return i == none ? Json(nullptr) : Json(i);
}

static Json vertex_json(const Probed& probed, const ProbedVertex& v)
{
    Json json;
    json["parent"] = v.parent < 0 ? Json(nullptr) : Json(v.parent);
    json["origin"] = triple(v.ray.origin);
    json["direction"] = triple(v.ray.direction);
    json["steps"] = v.steps;
    json["medium"] = index(v.arriving.medium);
    json["passed_holes"] = v.passed_holes;
    if (v.is_surface) {
        json["distance"] = number(v.hit.t);
        json["primitive"] = primitive_name(v.hit.primitive);
        json["instance"] = index(v.hit.instance);
        json["object"] = v.surface.object;
        json["object_name"] = object_name(probed.scene, v.surface.object);
        json["material"] = v.surface.material;
        json["material_name"] = material_name(probed.scene, v.surface.material);
        json["material_kind"] = material_kind_name(v.material_kind);
        json["position"] = triple(v.surface.position);
        json["geometric_normal"] = triple(v.surface.geometric_normal);
        json["shading_normal"] = triple(v.surface.shading_normal);
        json["uv"] = Json::array({v.surface.uv.x, v.surface.uv.y});
        json["barycentrics"] = Json::array({v.hit.u, v.hit.v});
    }
    json["throughput"] = triple(v.throughput);
    json["arriving_pdf"] = v.arriving.pdf;
    json["emission"] = triple(v.emission);
    json["emission_light_pdf"] = v.emission_pdf;
    json["emission_mis_weight"] = v.emission_weight;
    json["emitted"] = triple(v.emitted);
    json["layer"] = layer_name(v.layer);
    json["lights"] = Json::array();
    for (const ProbedLight& light : v.lights)
        json["lights"].push_back(
            {{"light", index(light.light)},
             {"direction", triple(light.drawn.direction)},
             {"target", light.drawn.is_infinite != 0u ? Json(nullptr) : triple(light.drawn.target)},
             {"is_delta", light.drawn.is_delta != 0u},
             {"radiance", triple(light.drawn.radiance)},
             {"pdf", light.drawn.pdf},
             {"bsdf", triple(light.bsdf)},
             {"bsdf_pdf", light.bsdf_pdf},
             {"mis_weight", light.weight},
             {"was_traced", light.was_traced},
             {"is_blocked", light.is_blocked},
             {"value", triple(light.value)},
             {"layer", layer_name(light.layer)}});
    json["continuations"] = Json::array();
    for (const ProbedVertex::Continuation& c : v.continuations)
        json["continuations"].push_back({{"event", event_name(c.event)},
                                         {"pdf", c.pdf},
                                         {"weight", triple(c.weight)},
                                         {"throughput", triple(c.throughput)},
                                         {"vertex", c.vertex < 0 ? Json(nullptr) : Json(c.vertex)}});
    json["roulette_survival"] = v.survival;
    json["ending"] = ending_name(v.ending);
    return json;
}

static void print_json(const Probed& probed)
{
    const ProbedPath& path = probed.path;
    Json json;
    json["pixel"] = Json::array({path.x, path.y});
    json["size"] = Json::array({probed.settings.width, probed.settings.height});
    json["integrator"] = probed.settings.integrator;
    json["value"] = triple(probed.value.mean);
    json["spp"] = probed.value.samples;
    json["standard_error"] = probed.value.standard_error;
    json["first_hit"] = vertex_json(probed, probed.pixel.first);
    for (const char* key : {"throughput", "arriving_pdf", "emission", "emission_light_pdf", "emission_mis_weight",
                            "emitted", "layer", "lights", "continuations", "roulette_survival", "ending", "parent"})
        json["first_hit"].erase(key);
    json["first_hit"]["albedo"] = triple(probed.pixel.albedo);
    Json& sample = json["sample"];
    sample["number"] = path.sample;
    sample["position"] = Json::array({path.film_position.x, path.film_position.y});
    sample["radiance"] = triple(path.radiance);
    for (uint layer = 0; layer < layer_count; ++layer)
        sample[std::string(layer_name(layer))] = triple(path.layers[layer]);
    sample["is_exact"] = probed.is_exact;
    sample["vertices"] = Json::array();
    for (const ProbedVertex& v : path.vertices) sample["vertices"].push_back(vertex_json(probed, v));
    fmt::print("{}\n", json.dump(-1, ' ', false, Json::error_handler_t::replace));
}

int run_probe(const Arguments& arguments)
{
    ProbeJob job;
    if (const auto code = parse_probe(arguments, job)) return *code;
    if (!std::filesystem::path(job.render.scene.name).extension().string().starts_with(".pbrt")) {
        RenderJob trial = job.render; // what is wrong should be said before a large scene is read
        settle_settings(trial, {});
    }
    Scene scene = open_chosen(job.render.scene);
    settle_settings(job.render, scene.hints);
    RenderSettings settings = job.render.settings;
    const Region pixel = *settings.region;
    choose_camera(scene, job.render.camera, static_cast<float>(settings.width) / static_cast<float>(settings.height));
    hide_environment(scene, job.render.scene);
    console().notes(scene);
    settings.keep_motion = job.render.scene.time.has_value();
    const std::unique_ptr<Prepared> prepared = prepare(scene, settings);

    Probed probed{scene, settings, probe_pixel(*prepared, prepared->camera, scene, settings, pixel.x0, pixel.y0),
                  {},    {},       false};
    probed.value = pixel_value(render(*prepared, settings).film, pixel.x0, pixel.y0);
    probed.path = probe_path(*prepared, prepared->camera, settings, pixel.x0, pixel.y0, job.sample);
    const vec3 rendered = render_sample(*prepared, prepared->camera, settings, pixel.x0, pixel.y0, job.sample);
    // a sample that is not finite is left out of the picture
    const vec3 replayed = is_finite3(probed.path.radiance) ? probed.path.radiance : vec3(0.0f);
    probed.is_exact = replayed == rendered;
    if (job.json)
        print_json(probed);
    else
        print_text(probed);
    return 0;
}

} // namespace snell::app
