// Textures: what they are in the file, folded where they are simple.
#include "snell/io/pbrt/bake.h"
#include "snell/io/pbrt/loader.h"
#include "snell/io/text_cursor.h"

#include <cmath>

namespace snell::pbrt {
namespace {

constexpr uint most_cost = 64; // look-ups for one value

uint add_node(Loader& loader, TextureNode node)
{
    loader.textures.push_back(std::move(node));
    return static_cast<uint>(loader.textures.size() - 1);
}

uint constant_node(Loader& loader, vec3 value, const Spot& spot)
{
    TextureNode node;
    node.value.factor = value;
    node.spot = spot;
    return add_node(loader, node);
}

const TextureValue* constant_of(const Loader& loader, uint texture)
{
    const TextureNode& node = loader.textures[texture];
    return node.kind == TextureNode::Kind::value && node.value.is_constant() ? &node.value : nullptr;
}

std::optional<vec3> color_of(Loader& loader, const Parameter& parameter, Use use)
{
    const std::optional<Spectrum> spectrum = loader.spectra.read(parameter, *loader.state.space, use);
    if (!spectrum) return {};
    if (use == Use::light) return light_rgb(*spectrum, loader.is_v3);
    return use == Use::reflectance ? reflectance_rgb(*spectrum) : plain_rgb(*spectrum);
}

uint find_texture(Loader& loader, const Parameter& parameter, bool is_number)
{
    if (parameter.strings.empty()) return none;
    const std::string& name = parameter.strings[0];
    const auto& first = is_number ? loader.number_textures : loader.color_textures;
    const auto& second = is_number ? loader.color_textures : loader.number_textures;
    if (const auto known = first.find(name); known != first.end()) return known->second;
    if (const auto known = second.find(name); known != second.end()) return known->second;
    loader.warn(
        parameter.spot, "texture " + name,
        fmt::format("the texture {} is not defined before its use; the usual value stands in for it", show_word(name)));
    return none;
}

// The map from surface coordinates to those of the texture.
void read_mapping(Loader& loader, const ParameterList& parameters, TextureNode& node)
{
    const std::string mapping = parameters.text("mapping", "uv");
    const float su = parameters.number("uscale", 1.0f), sv = parameters.number("vscale", 1.0f);
    const float du = parameters.number("udelta", 0.0f), dv = parameters.number("vdelta", 0.0f);
    node.row_u = vec3(su, 0, du), node.row_v = vec3(0, sv, dv);
    // ours: any affine map
    const auto row = [&](std::string_view name, vec3& into) {
        if (const auto r = parameters.numbers(name); r.size() == 3) into = vec3(r[0], r[1], r[2]);
    };
    row("row_u", node.row_u);
    row("row_v", node.row_v);
    if (mapping != "uv") {
        loader.warn(
            parameters.spot, "mapping " + mapping,
            fmt::format("the mapping {} is not there; the surface's own coordinates are taken", show_word(mapping)));
        node.row_u = vec3(1, 0, 0), node.row_v = vec3(0, 1, 0);
    }
    parameters.ignore({"v1", "v2"});
}

TextureNode image_node(Loader& loader, const ParameterList& parameters, bool is_number)
{
    TextureNode node;
    PendingImage image;
    image.spot = parameters.spot;
    image.is_number = is_number && !parameters.has("channel");
    image.is_inverted = parameters.flag("invert", false);
    const std::string encoding = parameters.text("encoding", "sRGB");
    const bool gamma = parameters.flag("gamma", true); // v3
    if (encoding == "linear" || !gamma)
        image.is_color = false;
    else if (encoding.starts_with("gamma ")) {
        const char* p = encoding.c_str() + 6;
        float value = 0;
        if (read_float(p, encoding.c_str() + encoding.size(), value) && value > 0.1f && value < 10.0f)
            image.is_color = false, image.gamma = value;
    } else if (encoding != "sRGB")
        loader.warn(parameters.spot, "encoding",
                    fmt::format("the encoding {} is unknown; sRGB is taken", show_word(encoding)));
    read_mapping(loader, parameters, node);

    TextureRef& ref = node.value.ref;
    const auto wrap = [&](std::string_view name, uint otherwise) {
        const std::string mode = parameters.text(name, "");
        if (mode.empty()) return otherwise;
        if (mode == "black")
            loader.warn(parameters.spot, "wrap black",
                        "a texture that is black outside its picture repeats its border there");
        return mode == "clamp" || mode == "black" ? wrap_clamp : mode == "mirror" ? wrap_mirror : wrap_repeat;
    };
    ref.wrap_u = ref.wrap_v = wrap("wrap", wrap_repeat);
    ref.wrap_u = wrap("wrap_u", ref.wrap_u);
    ref.wrap_v = wrap("wrap_v", ref.wrap_v);
    ref.filter = parameters.text("filter") == "point" ? filter_nearest : filter_bilinear;
    ref.uv_set = parameters.integer("uvset", 0) == 1 ? 1u : 0u;
    const std::string channel = parameters.text("channel", "r");
    ref.channel = channel == "g" ? 1u : channel == "b" ? 2u : channel == "a" ? 3u : 0u;
    ref.row_u = node.row_u, ref.row_v = node.row_v;
    node.value.factor = vec3(parameters.number("scale", 1.0f));
    parameters.ignore({"trilinear", "maxanisotropy"});

    const std::string name = parameters.text("filename");
    if (name.empty()) {
        loader.warn(parameters.spot, "no file", "an imagemap without a filename is grey");
        node.value = {vec3(0.5f), {}};
        return node;
    }
    image.path = loader.resolve(name, parameters.spot);
    ref.image = add_image(loader, std::move(image), parameters.text("name", name)); // ours: the picture's name
    return node;
}

} // namespace

uint texture_parameter(Loader& loader, const ParameterList& parameters, std::string_view name, bool is_number)
{
    const Parameter* parameter = parameters.find(name);
    if (parameter == nullptr) return none;
    if (parameter->type == Type::texture) return find_texture(loader, *parameter, is_number);
    if (is_number) {
        const std::optional<float> number = parameters.number(name);
        if (number) return constant_node(loader, vec3(*number), parameter->spot);
        const std::optional<vec3> color = color_of(loader, *parameter, Use::plain);
        return color ? constant_node(loader, vec3((color->x + color->y + color->z) / 3.0f), parameter->spot) : none;
    }
    const std::optional<vec3> color = color_of(loader, *parameter, Use::plain);
    return color ? constant_node(loader, *color, parameter->spot) : none;
}

std::optional<TextureValue> color_parameter(Loader& loader, const ParameterList& parameters, std::string_view name,
                                            Use use)
{
    const Parameter* parameter = parameters.find(name);
    if (parameter == nullptr) return {};
    if (parameter->type == Type::texture) {
        const uint texture = find_texture(loader, *parameter, false);
        if (texture == none) return {};
        return texture_value(loader, texture);
    }
    const std::optional<vec3> color = color_of(loader, *parameter, use);
    if (!color) return {};
    return TextureValue{*color, {}};
}

std::optional<TextureValue> number_parameter(Loader& loader, const ParameterList& parameters, std::string_view name)
{
    const uint texture = texture_parameter(loader, parameters, name, true);
    if (texture == none) return {};
    return texture_value(loader, texture);
}

void add_texture(Loader& loader, const std::string& name, const std::string& value_type, const std::string& type,
                 const ParameterList& parameters)
{
    const bool is_number = value_type == "float";
    if (!is_number && value_type != "spectrum" && value_type != "color")
        loader.warn(parameters.spot, "value " + value_type,
                    fmt::format("textures of type {} are unknown; it is taken as spectrum", show_word(value_type)));
    const auto input = [&](std::string_view parameter, vec3 otherwise) {
        const uint texture = texture_parameter(loader, parameters, parameter, is_number);
        return texture != none ? texture : constant_node(loader, otherwise, parameters.spot);
    };
    const auto mean_node = [&](uint a, uint b, float amount) {
        return mix(mean_of(loader, texture_value(loader, a)), mean_of(loader, texture_value(loader, b)), amount);
    };

    TextureNode node;
    if (type == "constant") {
        const uint value = input("value", vec3(1.0f));
        node.value = texture_value(loader, value);
    } else if (type == "imagemap") {
        node = image_node(loader, parameters, is_number);
    } else if (type == "scale") {
        const bool is_old = parameters.has("tex1") || parameters.has("tex2");
        uint a = input(is_old ? "tex1" : "tex", vec3(1.0f));
        // The scale is a number in v4; v3's second texture is of the same type.
        uint b = texture_parameter(loader, parameters, is_old ? "tex2" : "scale", is_old ? is_number : true);
        if (b == none) b = constant_node(loader, vec3(1.0f), parameters.spot);
        if (constant_of(loader, a) != nullptr) std::swap(a, b);
        if (const TextureValue* by = constant_of(loader, b)) {
            const vec3 factor = by->factor;
            node = loader.textures[a];
            if (node.kind == TextureNode::Kind::value)
                node.value.factor *= factor;
            else
                node.kind = TextureNode::Kind::scale, node.input = {a, b, none}, node.is_baked = false;
        } else {
            node.kind = TextureNode::Kind::scale, node.input = {a, b, none};
        }
    } else if (type == "mix" || type == "directionmix") {
        const uint a = input("tex1", vec3(0.0f)), b = input("tex2", vec3(1.0f));
        uint amount = texture_parameter(loader, parameters, "amount", true);
        if (type == "directionmix") {
            loader.warn(parameters.spot, "directionmix", "a directionmix texture becomes an even mix");
            parameters.ignore({"dir"});
            amount = none;
        }
        if (amount == none) amount = constant_node(loader, vec3(0.5f), parameters.spot);
        const TextureValue *ca = constant_of(loader, a), *cb = constant_of(loader, b),
                           *ct = constant_of(loader, amount);
        if (ca != nullptr && cb != nullptr && ct != nullptr)
            node.value.factor = ca->factor + (cb->factor - ca->factor) * ct->factor.x;
        else if (ct != nullptr && (ct->factor.x == 0.0f || ct->factor.x == 1.0f))
            node = loader.textures[ct->factor.x == 0.0f ? a : b];
        else
            node.kind = TextureNode::Kind::mix, node.input = {a, b, amount};
    } else if (type == "checkerboard") {
        node.kind = TextureNode::Kind::checkerboard;
        node.input = {input("tex1", vec3(1.0f)), input("tex2", vec3(0.0f)), none};
        read_mapping(loader, parameters, node);
        parameters.ignore({"aamode"});
        if (parameters.integer("dimension", 2) == 3) {
            loader.warn(parameters.spot, "solid checkerboard", "a checkerboard in space becomes its mean");
            const vec3 mean = mean_node(node.input[0], node.input[1], 0.5f);
            node = {};
            node.value.factor = mean;
        }
    } else if (type == "bilerp") {
        node.kind = TextureNode::Kind::bilerp;
        const std::string_view names[] = {"v00", "v01", "v10", "v11"};
        for (std::size_t i = 0; i < 4; ++i)
            node.corners[i] = mean_of(loader, texture_value(loader, input(names[i], vec3(i % 2 == 0 ? 0.0f : 1.0f))));
        read_mapping(loader, parameters, node);
    } else {
        loader.warn(
            parameters.spot, "texture type " + type,
            fmt::format("textures of type {} are not there; {} becomes a constant", show_word(type), show_word(name)));
        node.value.factor = vec3(0.5f);
        if (type == "dots")
            node.value.factor = mean_node(input("inside", vec3(1.0f)), input("outside", vec3(0.0f)), 0.6f);
        for (const Parameter& parameter : parameters.all()) parameter.used = true;
    }
    node.spot = parameters.spot;
    node.cost = 1;
    if (node.kind != TextureNode::Kind::value)
        for (const uint i : node.input)
            if (i != none) node.cost += loader.textures[i].cost;
    if (node.cost > most_cost) {
        // Its parts become pictures first, so that no texture takes long.
        node.cost = 1;
        for (uint& i : node.input) {
            if (i == none) continue;
            TextureNode part;
            part.value = texture_value(loader, i);
            part.spot = node.spot;
            i = add_node(loader, part);
            ++node.cost;
        }
    }
    parameters.report_unused(fmt::format("Texture \"{}\"", type.substr(0, 40)), loader.notes);
    (is_number ? loader.number_textures : loader.color_textures)[name] = add_node(loader, std::move(node));
}

TextureValue texture_value(Loader& loader, uint texture)
{
    TextureNode& node = loader.textures[texture]; // in a deque, so it stays where it is
    if (node.kind == TextureNode::Kind::value || node.is_baked) return node.value;
    node.value = bake(loader, texture);
    node.is_baked = true;
    return node.value;
}

} // namespace snell::pbrt
