// What stands before the world, and lights.
#include "snell/io/lens_file.h"
#include "snell/io/pbrt/loader.h"
#include "snell/io/pbrt/write_parts.h"
#include "snell/scene/camera_models.h"

#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <span>

namespace snell::pbrt {
namespace {

void write_film(Writer& w)
{
    const RenderHints& hints = w.scene.hints;
    const auto lens = std::find_if(w.scene.cameras.begin(), w.scene.cameras.end(),
                                   [](const CameraDesc& c) { return c.model.kind == camera_lens; });
    const bool has_lens = lens != w.scene.cameras.end();
    if (!hints.width && !hints.height && !hints.crop_window && !hints.output && !has_lens) return;
    std::string text = "Film \"rgb\"";
    if (hints.width) text += fmt::format(" \"integer xresolution\" {}", *hints.width);
    if (hints.height) text += fmt::format(" \"integer yresolution\" {}", *hints.height);
    if (hints.crop_window) {
        const auto& c = *hints.crop_window;
        text += fmt::format(" \"float cropwindow\" [ {} {} {} {} ]", c[0], c[1], c[2], c[3]);
    }
    if (hints.output) text += fmt::format(" \"string filename\" {}", in_quotes(*hints.output));
    if (has_lens) text += fmt::format(" \"float diagonal\" {}", lens->model.film_diagonal);
    w.line("{}", text);
}

void write_sampler(Writer& w)
{
    const RenderHints& hints = w.scene.hints;
    if (hints.spp || hints.sampler) {
        std::string text =
            fmt::format("Sampler \"{}\"", hints.sampler == std::string("independent") ? "independent" : "zsobol");
        constexpr uint usual = 64;
        if (!hints.spp) w.inform(fmt::format("the sampler has a number of samples now: {}", usual));
        text += fmt::format(" \"integer pixelsamples\" {}", hints.spp.value_or(usual));
        if (hints.seed) text += fmt::format(" \"integer seed\" {}", static_cast<int>(*hints.seed));
        w.line("{}", text);
    } else if (hints.seed) {
        w.line("Option \"integer seed\" {}", static_cast<int>(*hints.seed));
    }
}

void write_integrator(Writer& w)
{
    const RenderHints& hints = w.scene.hints;
    const std::string name = hints.integrator.value_or("path");
    if (name == "ao") {
        w.line("Integrator \"ambientocclusion\"");
        return;
    }
    // Without a number pbrt ends paths after 5 bounces; ours go on.
    const uint depth = hints.max_depth.value_or(name == "whitted" ? 12 : 1000);
    w.line("Integrator \"{}\" \"integer maxdepth\" {}", name == "whitted" ? "whitted" : "volpath", depth);
}

void write_lens_camera(Writer& w, const CameraDesc& c)
{
    const CameraModel& m = c.model;
    std::string reference = m.lens.name;
    if (w.writes_files || find_lens(reference) == nullptr) {
        const SideFolder::Slot slot = w.lenses.next(".txt");
        reference = slot.reference;
        w.files.emplace_back([path = slot.path, &m] { write_lens(m.lens, path); });
    }
    // pbrt's apertures are never "as wide as they are".
    const float stop = m.stop_diameter > 0.0f ? m.stop_diameter : stop_diameter(m.lens);
    const float focus = m.focus_distance > 0.0f ? m.focus_distance : length(c.target - c.eye);
    w.line("Camera \"realistic\" \"string lensfile\" {} \"float aperturediameter\" {} \"float focusdistance\" {}{}",
           in_quotes(reference), stop, focus,
           m.millimetre != 0.001f ? fmt::format(" \"float millimetre\" {}", m.millimetre) : "");
    if (m.millimetre != 0.001f) w.inform("a lens in other units than metres is snell's own; pbrt takes metres");
}

void write_camera_model(Writer& w, const CameraDesc& c)
{
    const CameraModel& m = c.model;
    if (m.kind == camera_orthographic) {
        const float half =
            m.half_side > 0.0f ? m.half_side : length(c.target - c.eye) * std::tan(c.fov_degrees * (pi / 360.0f));
        const float aspect = static_cast<float>(w.scene.hints.width.value_or(1280)) /
                             static_cast<float>(w.scene.hints.height.value_or(720));
        const float x = half * std::max(aspect, 1.0f), y = half * std::max(1.0f / aspect, 1.0f);
        w.line("Camera \"orthographic\" \"float screenwindow\" [ {} {} {} {} ]", -x, x, -y, y);
        return;
    }
    if (m.kind == camera_lens) return write_lens_camera(w, c);
    if (m.kind == camera_equirectangular) {
        w.line("Camera \"spherical\" \"string mapping\" \"equirectangular\"");
        return;
    }
    if (m.kind == camera_pinhole) {
        std::string lens;
        if (m.lens_radius > 0.0f) {
            const float focus = m.focus_distance > 0.0f ? m.focus_distance : length(c.target - c.eye);
            lens = fmt::format(" \"float lensradius\" {} \"float focaldistance\" {}", m.lens_radius, focus);
            if (m.blades > 2)
                lens += fmt::format(" \"integer blades\" {} \"float bladerotation\" {}", m.blades,
                                    m.blade_rotation_degrees);
        }
        w.line("Camera \"perspective\" \"float fov\" {}{}", c.fov_degrees, lens);
        return;
    }
    std::string line = m.kind == camera_hmd ? fmt::format("Camera \"hmd\" \"float ipd\" {}", m.eye_distance)
                                            : fmt::format("Camera \"fisheye\" \"string projection\" \"{}\"",
                                                          camera_models()[m.kind].name);
    line += fmt::format(" \"float fov\" {}", c.fov_degrees);
    if (const std::vector<float> k = distortion_of(m); !k.empty())
        line += fmt::format(" \"float distortion\" [ {} ]", fmt::join(k, " "));
    if (m.calibrated_width > 0.0f)
        line += fmt::format(" \"float calibration\" [ {} {} {} {} {} {} ]", m.calibrated_width, m.calibrated_height,
                            m.focal.x, m.focal.y, m.center.x, m.center.y);
    w.line("{}", line);
    w.inform("fisheye and hmd are cameras of snell's own; pbrt does not know them");
}

} // namespace

void write_cameras(Writer& w)
{
    const std::vector<CameraDesc>& cameras = w.scene.cameras;
    for (std::size_t i = 0; i < cameras.size(); ++i) {
        const CameraDesc& c = cameras[i];
        if (i > 0) w.line("Identity");
        // pbrt's cameras look into a left-handed space.
        if (!c.mirrored) w.line("Scale -1 1 1");
        w.line("LookAt {}  {}  {}", show(c.eye), show(c.target), show(c.up));
        // A name as a parameter would stop pbrt.
        const std::string name = c.name.empty() && cameras.size() > 1 ? fmt::format("camera {}", i) : c.name;
        if (!name.empty()) w.line("CoordinateSystem {}", in_quotes(fmt::format("{}{}", camera_mark, name)));
        write_camera_model(w, c);
    }
    if (cameras.size() > 1) w.inform("the file has several cameras: snell takes the first one, pbrt the last");
}

namespace {

void write_light(Writer& w, const LightDesc& light)
{
    const bool is_distant = light.kind == light_directional;
    w.line("AttributeBegin");
    if (!light.name.empty()) w.line("  Attribute \"light\" \"string name\" {}", in_quotes(light.name));
    // At the origin of its own space, so that the direction is not rounded.
    if (light.kind == light_spot) w.line("  Translate {}", show(light.position));
    const std::string aim = fmt::format("\"point3 from\" [ 0 0 0 ] \"point3 to\" [ {} ]", show(light.direction));
    if (light.kind == light_point) {
        w.line("  LightSource \"point\" \"point3 from\" [ {} ] \"rgb I\" [ {} ]", show(light.position),
               show(light.emission));
    } else if (is_distant) {
        w.line("  LightSource \"distant\" {} \"rgb L\" [ {} ]", aim, show(light.emission));
    } else {
        const float delta = light.outer_degrees - light.inner_degrees;
        if (light.outer_degrees - delta != light.inner_degrees)
            w.line("  Attribute \"light\" \"float innerangle\" {}", light.inner_degrees);
        w.line("  LightSource \"spot\" {} \"rgb I\" [ {} ] \"float coneangle\" {} \"float conedeltaangle\" {}", aim,
               show(light.emission), light.outer_degrees, delta);
    }
    w.line("AttributeEnd");
}

void write_environment(Writer& w)
{
    const EnvironmentDesc& e = w.scene.environment;
    if (!e.image.valid()) {
        if (e.radiance == vec3(0.0f) && e.visible) return;
        w.line("LightSource \"infinite\" \"rgb L\" [ {} ]{}", show(e.radiance),
               e.visible ? "" : " \"bool visible\" false");
        return;
    }
    const Image& image = w.scene.images[e.image.value];
    w.line("AttributeBegin");
    if (!image.name.empty()) w.line("  Attribute \"light\" \"string name\" {}", in_quotes(image.name));
    if (!is_identity(e.to_world)) w.line("  Transform {}", show(e.to_world));
    std::string text = fmt::format("  LightSource \"infinite\" \"string filename\" {}",
                                   in_quotes(write_picture_file(w, e.image, true)));
    // pbrt takes either a picture or a colour.
    const vec3 r = e.radiance;
    const bool is_even = r.x == r.y && r.y == r.z;
    if (is_even && r.x != 1.0f) text += fmt::format(" \"float scale\" {}", r.x);
    if (!is_even) text += fmt::format(" \"rgb L\" [ {} ]", show(r));
    const bool is_octahedral = e.mapping == environment_octahedral;
    if (!is_octahedral || image.width != image.height)
        text += fmt::format(" \"string mapping\" \"{}\"", is_octahedral ? "octahedral" : "equirectangular");
    if (!e.visible) text += " \"bool visible\" false";
    w.line("{}\nAttributeEnd", text);
}

} // namespace

void write_options(Writer& w)
{
    write_film(w);
    write_sampler(w);
    write_integrator(w);
    write_cameras(w);
}

void write_lights(Writer& w)
{
    write_environment(w);
    for (const LightDesc& light : w.scene.lights) write_light(w, light);
}

} // namespace snell::pbrt
