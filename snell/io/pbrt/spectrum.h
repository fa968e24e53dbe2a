// Spectra as pbrt files have them, and what is left of them in RGB.
#pragma once

#include "snell/io/pbrt/color.h"
#include "snell/io/pbrt/parameters.h"

#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <utility>

namespace snell::pbrt {

// (nanometres, value), by wavelength; linear in between, constant beyond the ends.
using Samples = std::vector<std::pair<float, float>>;

double value_at(const Samples& samples, double nanometres);

struct Spectrum
{
    enum class Kind
    {
        rgb,       // given as RGB, or known only as that; already linear Rec.709
        light_rgb, // the colour of a standard illuminant, luminance 1
        sampled,
        blackbody
    };
    Kind kind = Kind::rgb;
    vec3 rgb{0.0f};
    std::shared_ptr<const Samples> samples;
    float kelvin = 0.0f, scale = 1.0f; // scale: of v3's blackbodies
};

// What a colour is for, which decides how it is taken from a wider RGB space.
enum class Use
{
    reflectance,
    light,
    plain // coefficients and indices of refraction
};

// Names a file and reads it; the reader of the scene knows where files are.
using ReadFile = std::function<std::string(const std::string& reference, const Spot& spot, std::string& file_name)>;

// Reads spectra; .spd files once each.
class SpectrumReader
{
  public:
    SpectrumReader(Notes& notes, ReadFile read_file) : notes_(notes), read_file_(std::move(read_file)) {}

    // Of a parameter of type spectrum, rgb, xyz, blackbody or float; empty, with a note, if it says nothing usable.
    // Throws Error for an .spd file that is no list of numbers.
    std::optional<Spectrum> read(const Parameter& parameter, const ColorSpace& space, Use use);

  private:
    std::optional<Spectrum> named(const std::string& name, const Spot& spot);
    std::shared_ptr<const Samples> file(const std::string& name, const Spot& spot);

    Notes& notes_;
    ReadFile read_file_;
    std::map<std::string, std::shared_ptr<const Samples>> files_;
};

// The colour of a surface of that reflectance in white light (a blackbody of 6504 K stands for D65), in [0, 1].
vec3 reflectance_rgb(const Spectrum& spectrum);

// The colour of a light: a spectrum's luminance becomes 1 as in pbrt-v4, or keeps its value relative to an equal-energy
// white of 1 as in v3.
vec3 light_rgb(const Spectrum& spectrum, bool is_v3);

// Coefficients, such as absorption: the same weights as for reflectances, without upper limit.
vec3 plain_rgb(const Spectrum& spectrum);

// At the d line, 587.6 nm; of RGB the mean.
float index_of_refraction(const Spectrum& spectrum);

// A metal's index eta + i k in RGB. From spectra it is made so that the reflectance at normal incidence is exactly that
// of the spectra, reduced to RGB.
struct Metal
{
    vec3 eta, k;
};
Metal metal_rgb(const Spectrum& eta, const Spectrum& k);

// eta and k of the metal called "metal-`name`-eta" and "-k"; copper if there is no such.
Metal named_metal(std::string_view name);

} // namespace snell::pbrt
