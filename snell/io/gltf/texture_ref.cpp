#include "snell/io/gltf/texture_ref.h"

#include <cmath>

namespace snell::gltf {
namespace {

constexpr const char* transform_extension = "KHR_texture_transform";

uint wrap_mode(int mode)
{
    if (mode == TINYGLTF_TEXTURE_WRAP_CLAMP_TO_EDGE) return wrap_clamp;
    return mode == TINYGLTF_TEXTURE_WRAP_MIRRORED_REPEAT ? wrap_mirror : wrap_repeat;
}

} // namespace

TextureUse::TextureUse(const tinygltf::TextureInfo& info)
    : texture(info.index), set(info.texCoord), transform(info.extensions, transform_extension)
{
}

TextureUse::TextureUse(const tinygltf::NormalTextureInfo& info)
    : texture(info.index), set(info.texCoord), scale(static_cast<float>(info.scale)),
      transform(info.extensions, transform_extension)
{
}

TextureUse::TextureUse(const Fields& parent, const char* key)
{
    const Fields info = parent.object(key);
    if (!info.exists()) return;
    texture = info.integer("index", -1);
    set = info.integer("texCoord", 0);
    scale = static_cast<float>(info.number("scale", 1.0));
    transform = info.object("extensions").object(transform_extension);
}

TextureRef TextureRefs::make(const TextureUse& use, Content content, uint channel)
{
    TextureRef ref;
    if (!use.exists()) return ref;
    ref.image = images_.of_texture(use.texture, content, who_);
    ref.channel = channel;
    set_lookup(ref, use);
    return ref;
}

TextureRef TextureRefs::make_roughness(const TextureUse& use, float glossiness)
{
    TextureRef ref;
    if (!use.exists()) return ref;
    ref.image = images_.roughness_of_texture(use.texture, glossiness, who_);
    ref.channel = 1;
    set_lookup(ref, use);
    return ref;
}

void TextureRefs::set_lookup(TextureRef& ref, const TextureUse& use)
{
    const int sampler = document_.model.textures[static_cast<std::size_t>(use.texture)].sampler;
    if (sampler >= 0) {
        const tinygltf::Sampler& s = checked(document_.model.samplers, sampler, "sampler", who_);
        ref.wrap_u = wrap_mode(s.wrapS);
        ref.wrap_v = wrap_mode(s.wrapT);
        if (s.magFilter == TINYGLTF_TEXTURE_FILTER_NEAREST) ref.filter = filter_nearest;
    }
    const int set = use.transform.integer("texCoord", use.set);
    if (set == 0 || set == 1)
        ref.uv_set = static_cast<uint>(set);
    else
        remarks_.warn("texture set",
                      fmt::format("{} wants TEXCOORD_{}; of a mesh's texture coordinates only 0 and 1 are kept, so 0 "
                                  "is used",
                                  who_, set));
    if (!use.transform.exists()) return;

    const std::vector<double> offset = use.transform.numbers("offset"), scale = use.transform.numbers("scale");
    const double ox = offset.size() == 2 ? offset[0] : 0.0, oy = offset.size() == 2 ? offset[1] : 0.0;
    const double sx = scale.size() == 2 ? scale[0] : 1.0, sy = scale.size() == 2 ? scale[1] : 1.0;
    const double angle = use.transform.number("rotation", 0.0);
    const double c = std::cos(angle), s = std::sin(angle);
    // Scaled, turned counter-clockwise, moved; with glTF's v, which points down, that is
    //   u' =  c sx u + s sy v + ox,   v' = -s sx u + c sy v + oy.
    // Ours points up: v = 1 - v_up, on both sides.
    ref.row_u = vec3(glm::dvec3(c * sx, -s * sy, s * sy + ox));
    ref.row_v = vec3(glm::dvec3(s * sx, c * sy, 1.0 - c * sy - oy));
}

} // namespace snell::gltf
