// Point, spot, distant and area lights.
#include "snell/io/pbrt/environment.h"
#include "snell/io/pbrt/loader.h"
#include "snell/io/text_cursor.h"

#include <cmath>

namespace snell::pbrt {
namespace {

constexpr float pi = 3.14159265f;

vec3 direction_between(Loader& loader, const ParameterList& parameters)
{
    const vec3 from = parameters.point("from", vec3(0.0f)), to = parameters.point("to", vec3(0, 0, 1));
    vec3 direction = to - from;
    if (!(length(direction) > 0.0f)) {
        loader.warn(parameters.spot, "light direction",
                    "a light from and to the same point has no direction; it shines along +z");
        direction = vec3(0, 0, 1);
    }
    direction = transform_vector(loader.ctm(), direction);
    // As it is where its square is far from overflow: the length of a direction says nothing.
    const float size = length(direction);
    return size > 1e-9f && size < 1e9f ? direction : vec3(glm::normalize(glm::dvec3(direction)));
}

// What a light of luminous power `power` is multiplied with, if it is given; power_of_one: of intensity 1.
float power_scale(const ParameterList& parameters, float power_of_one)
{
    const float power = parameters.number("power", 0.0f);
    return power > 0.0f && power_of_one > 0.0f ? power / power_of_one : 1.0f;
}

void add_point(Loader& loader, const ParameterList& parameters)
{
    LightDesc light;
    light.kind = light_point;
    light.name = parameters.text("name"); // ours, as for the others
    light.position = transform_point(loader.ctm(), parameters.point("from", vec3(0.0f)));
    light.emission = light_parameter(loader, parameters, "I", vec3(1.0f)) * power_scale(parameters, 4.0f * pi);
    add(loader.scene, light);
}

void add_spot(Loader& loader, const ParameterList& parameters)
{
    LightDesc light;
    light.kind = light_spot;
    light.name = parameters.text("name");
    light.position = transform_point(loader.ctm(), parameters.point("from", vec3(0.0f)));
    light.direction = direction_between(loader, parameters);
    const float cone = clamp(parameters.number("coneangle", 30.0f), 0.01f, 180.0f);
    const float delta = clamp(parameters.number("conedeltaangle", 5.0f), 0.0f, cone);
    light.outer_degrees = cone;
    light.inner_degrees = clamp(parameters.number("innerangle", cone - delta), 0.0f, cone); // ours: the angle itself
    const float inner = std::cos(light.inner_degrees * pi / 180.0f), outer = std::cos(cone * pi / 180.0f);
    light.emission = light_parameter(loader, parameters, "I", vec3(1.0f)) *
                     power_scale(parameters, 2.0f * pi * ((1.0f - inner) + 0.5f * (inner - outer)));
    add(loader.scene, light);
}

void add_distant(Loader& loader, const ParameterList& parameters)
{
    LightDesc light;
    light.kind = light_directional;
    light.name = parameters.text("name");
    light.direction = direction_between(loader, parameters);
    light.emission = light_parameter(loader, parameters, "L", vec3(1.0f));
    if (const float wanted = parameters.number("illuminance", 0.0f); wanted > 0.0f) light.emission *= wanted;
    add(loader.scene, light);
}

void add_pictured(Loader& loader, const std::string& type, const ParameterList& parameters)
{
    loader.warn(parameters.spot, "light " + type,
                fmt::format("the {} light shines evenly: its picture is left out", type));
    parameters.ignore({"filename", "mapname"});
    if (type == "projection") {
        LightDesc light;
        light.kind = light_spot;
        light.position = transform_point(loader.ctm(), vec3(0.0f));
        light.direction = normalize(transform_vector(loader.ctm(), vec3(0, 0, 1)));
        light.outer_degrees = clamp(0.5f * parameters.number("fov", 90.0f), 0.01f, 89.0f);
        light.inner_degrees = 0.95f * light.outer_degrees;
        light.emission = light_parameter(loader, parameters, "I", vec3(1.0f));
        add(loader.scene, light);
        return;
    }
    add_point(loader, parameters);
}

} // namespace

vec3 light_parameter(Loader& loader, const ParameterList& parameters, std::string_view name, vec3 otherwise)
{
    vec3 value = otherwise;
    const auto read = [&](const Parameter& p, vec3 usual) {
        const auto spectrum = loader.spectra.read(p, *loader.state.space, Use::light);
        return spectrum ? light_rgb(*spectrum, loader.is_v3) : usual;
    };
    if (const Parameter* p = parameters.find(name)) value = read(*p, otherwise);
    // v3's scale may be a colour.
    if (const Parameter* p = parameters.find("scale")) value *= read(*p, vec3(1.0f));
    for (int c = 0; c < 3; ++c)
        if (!(value[c] >= 0.0f) || !std::isfinite(value[c])) {
            loader.warn(parameters.spot, "light value", "a light that is negative or not finite becomes dark");
            value[c] = 0.0f;
        }
    return value;
}

void add_light(Loader& loader, const std::string& type, const ParameterList& parameters)
{
    if (type == "point")
        add_point(loader, parameters);
    else if (type == "spot")
        add_spot(loader, parameters);
    else if (type == "distant")
        add_distant(loader, parameters);
    else if (type == "infinite" || type == "exinfinite")
        add_environment(loader, parameters);
    else if (type == "goniometric" || type == "projection")
        add_pictured(loader, type, parameters);
    else {
        loader.warn(parameters.spot, "light " + type,
                    fmt::format("lights of type {} are not there; it is left out", show_word(type)));
        return;
    }
    parameters.ignore({"nsamples", "samples"});
    parameters.report_unused(fmt::format("LightSource \"{}\"", type.substr(0, 40)), loader.notes);
}

void set_area_light(Loader& loader, const std::string& type, const ParameterList& parameters)
{
    if (type != "diffuse" && type != "area")
        loader.warn(parameters.spot, "area light " + type,
                    fmt::format("area lights of type {} are taken as diffuse", show_word(type)));
    AreaLight light;
    light.radiance = light_parameter(loader, parameters, "L", vec3(1.0f));
    light.two_sided = parameters.flag("twosided", false);
    light.power = max(parameters.number("power", 0.0f), 0.0f);
    if (const std::string name = parameters.text("filename"); !name.empty()) {
        PendingImage image;
        image.path = loader.resolve(name, parameters.spot);
        image.spot = parameters.spot;
        light.image.image = add_image(loader, std::move(image), name);
        light.image.wrap_u = light.image.wrap_v = wrap_clamp;
    }
    parameters.ignore({"nsamples", "samples"});
    parameters.report_unused("AreaLightSource \"diffuse\"", loader.notes);
    // Equal ones are one, so that what they make of a material is, too.
    const vec3 l = light.radiance;
    const auto [known, is_new] = loader.known_area_lights.emplace(
        std::tuple(l.x, l.y, l.z, light.image.image.value, light.two_sided, light.power),
        static_cast<uint>(loader.area_lights.size()));
    if (is_new) loader.area_lights.push_back(light);
    loader.state.area_light = known->second;
}

} // namespace snell::pbrt
