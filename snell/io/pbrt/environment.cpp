#include "snell/io/pbrt/environment.h"

#include "snell/io/image/read.h"

#include <cmath>

namespace snell::pbrt {
namespace {

constexpr double pi = 3.14159265358979323846;

// The direction that a point of pbrt's equal-area octahedral map stands for (Clarberg 2008, Fast Equal-Area Mapping of
// the (Hemi)Sphere using SIMD), and of v3's map of latitudes.
glm::dvec3 octahedral_direction(double u, double v)
{
    const double x = 2 * u - 1, y = 2 * v - 1, ax = std::abs(x), ay = std::abs(y);
    const double signed_distance = 1 - (ax + ay), d = std::abs(signed_distance), r = 1 - d;
    const double phi = (r == 0 ? 1 : (ay - ax) / r + 1) * pi / 4;
    const double z = std::copysign(1 - r * r, signed_distance), s = r * std::sqrt(2 - r * r);
    return {std::copysign(std::cos(phi), x) * s, std::copysign(std::sin(phi), y) * s, z};
}

// The irradiance that the picture gives to a patch that faces the sky, +z of the light.
double irradiance(const Image& image, bool is_octahedral)
{
    double sum = 0;
    for (uint y = 0; y < image.height; ++y) {
        const double v = (y + 0.5) / image.height;
        const double solid_angle = is_octahedral
                                       ? 4 * pi / (double(image.width) * image.height)
                                       : 2 * pi * pi * std::sin(pi * v) / (double(image.width) * image.height);
        for (uint x = 0; x < image.width; ++x) {
            const double z = is_octahedral ? octahedral_direction((x + 0.5) / image.width, v).z : std::cos(pi * v);
            if (z <= 0) continue;
            const float* t = &image.floats[4 * (std::size_t{y} * image.width + x)];
            const double luminance = 0.2126 * double(t[0]) + 0.7152 * double(t[1]) + 0.0722 * double(t[2]);
            sum += luminance * z * solid_angle;
        }
    }
    return sum;
}

// In floats and linear: pictures of 8 bits as well.
Image read_map(const std::filesystem::path& path)
{
    const Picture picture = read_picture(path);
    Image image;
    image.width = static_cast<uint>(picture.width), image.height = static_cast<uint>(picture.height);
    image.format = texels_rgba32f;
    image.floats.reserve(4 * picture.pixels.size());
    for (const vec3 p : picture.pixels) {
        for (int c = 0; c < 3; ++c) image.floats.push_back(std::isfinite(p[c]) && p[c] > 0.0f ? p[c] : 0.0f);
        image.floats.push_back(1.0f);
    }
    return image;
}

// Directions of the environment to those of the world: the light's transform without its scale.
std::optional<Transform> rotation_of(const Matrix& m, bool is_latitudes)
{
    const std::optional<Matrix> inverse = invert(m);
    if (!inverse) return {};
    glm::dmat3 axes(m);
    for (int i = 0; i < 3; ++i)
        if (std::abs(glm::length(axes[i]) - 1.0) > 1e-6)
            axes[i] = glm::normalize(axes[i]); // else: as they are, exactly
    // v3: +z is up, and u grows with the angle from +x to +y; ours: +Y up, -Z in the middle, +X right of it.
    if (is_latitudes) axes = axes * glm::dmat3(glm::dvec3(0, -1, 0), glm::dvec3(0, 0, 1), glm::dvec3(1, 0, 0));
    Matrix turned(1.0);
    for (int i = 0; i < 3; ++i) turned[i] = glm::dvec4(axes[i], 0.0);
    return to_transform(turned);
}

} // namespace

void add_environment(Loader& loader, const ParameterList& parameters)
{
    EnvironmentDesc& environment = loader.scene.environment;
    vec3 radiance = light_parameter(loader, parameters, "L", vec3(1.0f));
    const float wanted = parameters.number("illuminance", 0.0f);
    environment.visible = parameters.flag("visible", environment.visible); // ours
    std::string name = parameters.text("filename", parameters.text("mapname"));
    const std::string mapping = parameters.text("mapping"); // ours
    if (parameters.find("portal") != nullptr)
        loader.inform(parameters.spot, "portal", "a portal of an infinite light is left out: all of it is sampled");

    if (name.empty()) {
        if (wanted > 0.0f) radiance *= wanted / static_cast<float>(pi);
        loader.even_light += radiance;
        return;
    }
    if (environment.image.valid()) {
        loader.warn(parameters.spot, "second environment",
                    "a second infinite light with a picture is left out: only the first one shines");
        return;
    }
    const std::filesystem::path path = loader.resolve(name, parameters.spot);
    Image image;
    try {
        image = read_map(path);
    } catch (const Error& error) {
        loader.warn(parameters.spot, "environment " + name,
                    fmt::format("{}; light of its colour comes evenly from everywhere instead", error.what()));
        loader.even_light += radiance;
        return;
    }
    image.name = parameters.text("name", name); // ours
    // v4 maps are square, those of v3 twice as wide as high.
    const bool is_square = image.width == image.height;
    const bool is_octahedral = mapping.empty() ? is_square && !loader.is_v3 : mapping == "octahedral";
    if (mapping.empty() && !is_octahedral && !loader.is_v3)
        loader.warn(parameters.spot, "environment shape",
                    "a picture of an infinite light that is not square is taken as a map of latitudes");
    std::optional<Transform> to_world = rotation_of(loader.ctm(), !is_octahedral && mapping.empty());
    if (!to_world) {
        loader.warn(parameters.spot, "singular", "the transform here has no inverse; none is taken");
        to_world = rotation_of(Matrix(1.0), !is_octahedral && mapping.empty());
    }
    if (wanted > 0.0f)
        if (const double given = irradiance(image, is_octahedral); given > 0)
            radiance *= static_cast<float>(static_cast<double>(wanted) / given);
    environment.mapping = is_octahedral ? environment_octahedral : environment_equirectangular;
    environment.to_world = *to_world;
    environment.radiance = radiance;
    environment.image = add(loader.scene, std::move(image));
    loader.images.resize(loader.scene.images.size());
}

void finish_environment(Loader& loader)
{
    EnvironmentDesc& environment = loader.scene.environment;
    if (!environment.image.valid()) {
        environment.radiance = loader.even_light;
        return;
    }
    if (loader.even_light == vec3(0.0f)) return;
    // On top of a picture: into its texels, which are multiplied with its radiance.
    Image& image = loader.scene.images[environment.image.value];
    for (std::size_t i = 0; i + 3 < image.floats.size(); i += 4)
        for (int c = 0; c < 3; ++c) {
            const float factor = environment.radiance[c];
            if (factor > 0.0f) image.floats[i + static_cast<std::size_t>(c)] += loader.even_light[c] / factor;
        }
}

} // namespace snell::pbrt
