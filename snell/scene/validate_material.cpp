#include "snell/scene/validate_material.h"

#include "snell/core/error.h"
#include "snell/scene/validate_mesh.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>

namespace snell {

// ---- pictures ----

void check_image(const Image& image, std::size_t number)
{
    const std::string who = fmt::format("image {}", label(image.name, number));
    if (image.format > texels_rgba32f) throw Error(fmt::format("{}: unknown texel format {}", who, image.format));
    const std::size_t wanted = std::size_t{4} * image.width * image.height;
    const bool is_float = image.format == texels_rgba32f;
    const std::size_t given = is_float ? image.floats.size() : image.bytes.size();
    if (wanted == 0) throw Error(fmt::format("{} has no texels: it is {} x {}", who, image.width, image.height));
    if (given != wanted)
        throw Error(fmt::format("{}: {} x {} texels need {} values, but there are {}", who, image.width, image.height,
                                wanted, given));
}

static void check_reference(const Scene& scene, const TextureRef& ref, const std::string& who)
{
    if (!ref.valid()) return;
    if (ref.image.value >= scene.images.size())
        throw Error(fmt::format("{} refers to image {} of {}", who, ref.image.value, scene.images.size()));
    if (ref.wrap_u > wrap_clamp || ref.wrap_v > wrap_clamp || ref.filter > filter_nearest || ref.channel > 3 ||
        ref.uv_set > 1)
        throw Error(fmt::format("{}: a texture with wrap modes {} and {}, filter {}, channel {}, coordinates {}", who,
                                ref.wrap_u, ref.wrap_v, ref.filter, ref.channel, ref.uv_set));
    if (!is_finite3(ref.row_u) || !is_finite3(ref.row_v))
        throw Error(fmt::format("{}: a texture's transform is NaN or infinite", who));
}

// A texture of reflectances stays in [0, 1]: more would create light.
static void mend_texels(Scene& scene, Image& image, std::size_t number)
{
    std::size_t mended = 0;
    for (float& value : image.floats) {
        const float legal = std::isfinite(value) ? std::clamp(value, 0.0f, 1.0f) : 0.0f;
        if (legal != value || std::isnan(value)) value = legal, ++mended;
    }
    if (mended > 0)
        warn(scene, fmt::format("image {}: {} values outside [0, 1] moved inside", label(image.name, number), mended));
}

// ---- materials ----

// Reflectances: not a number becomes the default, below 0 becomes 0, above 1 is scaled so that the hue stays.
static bool mend_reflectance(vec3& color, float otherwise)
{
    const vec3 before = color;
    if (!is_finite3(color)) {
        color = vec3(otherwise);
        return true;
    }
    color = max(color, vec3(0.0f));
    if (max3(color) > 1.0f) color = min(color / max3(color), vec3(1.0f));
    return color != before;
}

static bool mend_nonnegative(vec3& value)
{
    bool mended = false;
    for (int i = 0; i < 3; ++i)
        if (!std::isfinite(value[i]) || value[i] < 0.0f) value[i] = 0.0f, mended = true;
    return mended;
}

// Every texture of a principled material; those of reflectances are the first few.
static std::array<TextureRef*, 15> textures(PrincipledDesc& p)
{
    return {&p.sheen_color_texture,         &p.diffuse_transmission_color_texture,
            &p.specular_color_texture,      &p.metallic_texture,
            &p.roughness_texture,           &p.specular_texture,
            &p.clearcoat_texture,           &p.clearcoat_roughness_texture,
            &p.clearcoat_normal_texture,    &p.sheen_roughness_texture,
            &p.transmission_texture,        &p.anisotropy_texture,
            &p.iridescence_texture,         &p.iridescence_thickness_texture,
            &p.diffuse_transmission_texture};
}

// Moves a number into its range; what is not finite becomes `otherwise`.
static bool mend_number(float& value, float lower, float upper, float otherwise)
{
    const float mended = std::isfinite(value) ? std::clamp(value, lower, upper) : otherwise;
    const bool differs = !(mended == value);
    value = mended;
    return differs;
}

static void mend_principled(PrincipledDesc& p, const std::function<void(const char*)>& say)
{
    const PrincipledDesc d;
    const auto part = [&](float& value, float otherwise, const char* what) {
        if (mend_number(value, 0.0f, 1.0f, otherwise)) say(what);
    };
    part(p.metallic, d.metallic, "metallic");
    part(p.roughness, d.roughness, "roughness");
    part(p.specular, d.specular, "specular");
    part(p.clearcoat, d.clearcoat, "clearcoat");
    part(p.clearcoat_roughness, d.clearcoat_roughness, "clearcoat roughness");
    part(p.sheen_roughness, d.sheen_roughness, "sheen roughness");
    part(p.transmission, d.transmission, "transmission");
    part(p.anisotropy, d.anisotropy, "anisotropy");
    part(p.iridescence, d.iridescence, "iridescence");
    part(p.diffuse_transmission, d.diffuse_transmission, "diffuse transmission");
    constexpr float far = 1e6f;
    if (mend_number(p.clearcoat_normal_scale, -far, far, 1.0f)) say("scale of the clearcoat's normal map");
    if (mend_number(p.anisotropy_rotation, -far, far, 0.0f)) say("anisotropy's rotation");
    if (mend_number(p.iridescence_ior, 1.0f, 5.0f, d.iridescence_ior))
        say("index of refraction of the iridescent film");
    if (mend_number(p.iridescence_thickness_min, 0.0f, far, d.iridescence_thickness_min) ||
        mend_number(p.iridescence_thickness_max, 0.0f, far, d.iridescence_thickness_max))
        say("thickness of the iridescent film");
    if (mend_number(p.dispersion, 0.0f, 20.0f, 0.0f)) say("dispersion");
    if (mend_nonnegative(p.specular_color)) say("specular colour");
    if (mend_reflectance(p.sheen_color, 0.0f)) say("sheen colour");
    if (mend_reflectance(p.diffuse_transmission_color, 1.0f)) say("colour of the diffuse transmission");
}

std::string mend_material(const Scene& scene, MaterialDesc& m, std::size_t number)
{
    const std::string who = fmt::format("material {}", label(m.name, number));
    if (m.kind >= material_kinds) throw Error(fmt::format("{}: unknown kind {}", who, m.kind));
    if (m.coverage > coverage_blend) throw Error(fmt::format("{}: unknown coverage {}", who, m.coverage));
    for (const TextureRef* ref : {&m.base_texture, &m.emission_texture, &m.normal_texture, &m.opacity_texture})
        check_reference(scene, *ref, who);

    std::string mended;
    const auto say = [&mended](const char* what) { mended += (mended.empty() ? "" : ", ") + std::string(what); };
    if (mend_reflectance(m.base_color, MaterialDesc{}.base_color.x)) say("colour");
    if (mend_nonnegative(m.emission)) say("emission");
    if (!std::isfinite(m.alpha) || m.alpha < 0.0f || m.alpha > 1.0f) {
        m.alpha = m.alpha > 1.0f && std::isfinite(m.alpha) ? 1.0f : 0.0f;
        say("roughness");
    }
    if (!std::isfinite(m.ior) || m.ior <= 0.0f) m.ior = MaterialDesc{}.ior, say("index of refraction");
    if (m.kind == material_conductor) {
        // eta and k; without a usable pair the metal becomes one of reflectance 0.9.
        if (!is_finite3(m.specular) || !is_finite3(m.absorption) ||
            !(std::min({m.specular.x, m.specular.y, m.specular.z}) > 0.0f) ||
            std::min({m.absorption.x, m.absorption.y, m.absorption.z}) < 0.0f) {
            m.specular = vec3(1.0f);
            m.absorption = vec3(6.0f);
            say("eta and k");
        }
    } else {
        if (mend_reflectance(m.specular, 0.0f)) say("specular reflectance");
        if (mend_nonnegative(m.absorption)) say("absorption");
    }
    if (mend_number(m.opacity, 0.0f, 1.0f, 1.0f)) say("opacity");
    if (!std::isfinite(m.cutoff)) m.cutoff = 0.5f, say("opacity's cutoff");
    if (!std::isfinite(m.normal_scale)) m.normal_scale = 1.0f, say("scale of the normal map");
    if (m.kind == material_principled) {
        for (const TextureRef* ref : textures(m.principled)) check_reference(scene, *ref, who);
        mend_principled(m.principled, say);
    }
    if (m.kind == material_mix) {
        const float sum = max3(m.base_color + m.specular);
        constexpr float rounding = 1e-5f;
        if (sum > 1.0f + rounding) {
            m.base_color /= sum;
            m.specular /= sum;
            say("sum of diffuse and specular reflectance");
        }
    }
    return mended;
}

void validate_materials(Scene& scene)
{
    for (std::size_t i = 0; i < scene.images.size(); ++i) check_image(scene.images[i], i);
    std::vector<bool> mended(scene.images.size(), false);
    for (std::size_t i = 0; i < scene.materials.size(); ++i) {
        MaterialDesc& m = scene.materials[i];
        const std::string mended_numbers = mend_material(scene, m, i);
        if (!mended_numbers.empty())
            warn(scene, fmt::format("material {}: not physical, mended: {}", label(m.name, i), mended_numbers));
        std::vector<uint> reflectances = {m.base_texture.image.value};
        if (m.kind == material_principled)
            for (const TextureRef* ref : textures(m.principled)) reflectances.push_back(ref->image.value);
        for (const uint image : reflectances) {
            if (image == none || mended[image]) continue;
            mended[image] = true;
            mend_texels(scene, scene.images[image], image);
        }
    }
}

std::string mend_environment(const Scene& scene, EnvironmentDesc& e)
{
    const std::string mended =
        mend_nonnegative(e.radiance) ? "the environment's radiance was negative or not finite; that part is now 0" : "";
    if (e.mapping > environment_octahedral) throw Error(fmt::format("unknown environment mapping {}", e.mapping));
    const vec3 x(e.to_world.x), y(e.to_world.y), z(e.to_world.z);
    constexpr float tolerance = 1e-3f;
    if (!(abs(dot(x, x) - 1.0f) < tolerance && abs(dot(y, y) - 1.0f) < tolerance && abs(dot(z, z) - 1.0f) < tolerance &&
          abs(dot(x, y)) < tolerance && abs(dot(y, z)) < tolerance && abs(dot(z, x)) < tolerance))
        throw Error("the environment's transform is neither a rotation nor a mirrored one",
                    "give it axes of length 1 at right angles");
    if (e.image.valid() && e.image.value >= scene.images.size())
        throw Error(fmt::format("the environment refers to image {} of {}", e.image.value, scene.images.size()));
    return mended;
}

std::size_t mend_radiances(Image& image)
{
    std::size_t mended = 0;
    constexpr float brightest = 1e9f; // sums and squares of samples stay finite
    for (float& value : image.floats) {
        if (value >= 0.0f && value <= brightest) continue;
        value = value > brightest ? brightest : 0.0f;
        ++mended;
    }
    return mended;
}

void validate_environment(Scene& scene)
{
    EnvironmentDesc& e = scene.environment;
    const std::string mended_numbers = mend_environment(scene, e);
    if (!mended_numbers.empty()) warn(scene, mended_numbers);
    if (!e.image.valid()) return;
    Image& image = scene.images[e.image.value];
    const std::size_t mended = mend_radiances(image);
    if (mended > 0)
        warn(scene, fmt::format("environment image {}: {} values that were negative, not finite or above 1e9 were "
                                "replaced",
                                label(image.name, e.image.value), mended));
}

} // namespace snell
