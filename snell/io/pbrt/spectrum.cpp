#include "snell/io/pbrt/spectrum.h"

#include "snell/io/pbrt/named_spectra.h"
#include "snell/io/pbrt/notes.h"
#include "snell/io/text_cursor.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace snell::pbrt {
namespace {

constexpr int first_nm = 360, count_nm = 471; // to 830

// Planck's law without constant factors.
double blackbody(double nm, double kelvin)
{
    const double metres = nm * 1e-9;
    return 1e-25 / (metres * metres * metres * metres * metres * (std::expm1(1.438777e-2 / (metres * kelvin))));
}

struct Weights
{
    std::array<glm::dvec3, count_nm> reflectance; // sums to 1 a channel
    std::array<glm::dvec3, count_nm> observer;
    double luminance = 0; // of an equal-energy white of 1
};

const Weights& weights()
{
    static const Weights all = [] {
        Weights w;
        glm::dvec3 sum(0.0);
        for (int i = 0; i < count_nm; ++i) {
            const auto n = static_cast<std::size_t>(i);
            w.observer[n] = cie_1931(first_nm + i);
            w.luminance += w.observer[n].y;
            w.reflectance[n] = rec709_from_xyz(w.observer[n]) * blackbody(first_nm + i, 6504.0);
            sum += w.reflectance[n];
        }
        for (glm::dvec3& each : w.reflectance) each /= sum;
        return w;
    }();
    return all;
}

// Calls f(n, nanometres, value) for each wavelength, in one pass over the samples.
template <class F>
void for_each_wavelength(const Samples& samples, const F& f)
{
    std::size_t next = 0;
    for (int i = 0; i < count_nm; ++i) {
        const double nm = first_nm + i;
        while (next < samples.size() && static_cast<double>(samples[next].first) <= nm) ++next;
        double value = 0;
        if (samples.empty())
            value = 0;
        else if (next == 0)
            value = static_cast<double>(samples.front().second);
        else if (next == samples.size())
            value = static_cast<double>(samples.back().second);
        else {
            const auto& [x0, y0] = samples[next - 1];
            const auto& [x1, y1] = samples[next];
            const double t = (nm - static_cast<double>(x0)) / (static_cast<double>(x1) - static_cast<double>(x0));
            value = (1 - t) * static_cast<double>(y0) + t * static_cast<double>(y1);
        }
        f(static_cast<std::size_t>(i), nm, value);
    }
}

glm::dvec3 weighted(const Samples& samples)
{
    glm::dvec3 sum(0.0);
    for_each_wavelength(samples, [&](std::size_t n, double, double v) { sum += weights().reflectance[n] * v; });
    return sum;
}

// Fresnel's reflectance of a metal at normal incidence.
double normal_reflectance(double eta, double k)
{
    return ((eta - 1) * (eta - 1) + k * k) / ((eta + 1) * (eta + 1) + k * k);
}

} // namespace

double value_at(const Samples& samples, double nm)
{
    if (samples.empty()) return 0;
    const auto next = std::upper_bound(samples.begin(), samples.end(), nm, [](double x, const auto& sample) {
        return x < static_cast<double>(sample.first);
    });
    if (next == samples.begin()) return static_cast<double>(samples.front().second);
    if (next == samples.end()) return static_cast<double>(samples.back().second);
    const auto& [x0, y0] = *(next - 1);
    const auto& [x1, y1] = *next;
    const double t = (nm - static_cast<double>(x0)) / (static_cast<double>(x1) - static_cast<double>(x0));
    return (1 - t) * static_cast<double>(y0) + t * static_cast<double>(y1);
}

vec3 plain_rgb(const Spectrum& s)
{
    if (s.kind == Spectrum::Kind::sampled) return max(vec3(weighted(*s.samples)), vec3(0.0f));
    if (s.kind == Spectrum::Kind::blackbody) return light_rgb(s, false);
    return s.rgb;
}

vec3 reflectance_rgb(const Spectrum& s)
{
    return clamp(plain_rgb(s), 0.0f, 1.0f);
}

vec3 light_rgb(const Spectrum& s, bool is_v3)
{
    if (s.kind == Spectrum::Kind::rgb || s.kind == Spectrum::Kind::light_rgb) return s.rgb;
    glm::dvec3 xyz(0.0);
    double scale = 1.0;
    if (s.kind == Spectrum::Kind::sampled) {
        for_each_wavelength(*s.samples, [&](std::size_t n, double, double v) { xyz += weights().observer[n] * v; });
    } else {
        const double kelvin = static_cast<double>(s.kelvin);
        // v3 takes Planck's curve relative to its peak, which Wien's law knows.
        const double peak = blackbody(2.8977721e6 / kelvin, kelvin);
        for (int i = 0; i < count_nm; ++i)
            xyz += weights().observer[static_cast<std::size_t>(i)] * (blackbody(first_nm + i, kelvin) / peak);
        scale = static_cast<double>(s.scale);
    }
    const double divisor = is_v3 ? weights().luminance : xyz.y;
    if (!(divisor > 0)) return vec3(0.0f);
    // Saturated lights lie outside Rec.709, which has no negative light.
    return max(vec3(rec709_from_xyz(xyz * (scale / divisor))), vec3(0.0f));
}

float index_of_refraction(const Spectrum& s)
{
    if (s.kind == Spectrum::Kind::sampled) return static_cast<float>(value_at(*s.samples, 587.6));
    return (s.rgb.x + s.rgb.y + s.rgb.z) / 3.0f;
}

Metal metal_rgb(const Spectrum& eta, const Spectrum& k)
{
    if (eta.kind != Spectrum::Kind::sampled || k.kind != Spectrum::Kind::sampled)
        return {max(plain_rgb(eta), vec3(1e-3f)), plain_rgb(k)};
    std::array<double, count_nm> etas{};
    for_each_wavelength(*eta.samples, [&](std::size_t n, double, double v) { etas[n] = v; });
    glm::dvec3 reflectance(0.0);
    for_each_wavelength(*k.samples, [&](std::size_t n, double, double v) {
        reflectance += weights().reflectance[n] * normal_reflectance(etas[n], v);
    });
    // k as it is where each channel sees most; then the eta that gives the channel its reflectance.
    Metal metal{};
    constexpr double channel_nm[] = {615, 545, 455};
    for (int c = 0; c < 3; ++c) {
        const double nm = channel_nm[c];
        const double r = std::clamp(reflectance[c], 0.0, 0.999);
        const double middle = (1 + r) / (1 - r);
        const double most_k = std::sqrt(std::max(0.0, middle * middle - 1));
        const double kc = std::clamp(value_at(*k.samples, nm), 0.0, most_k);
        // eta^2 - 2 eta middle + 1 + k^2 = 0, and of its two solutions the one nearer to the metal's eta.
        const double root = std::sqrt(std::max(0.0, middle * middle - 1 - kc * kc));
        const double low = (1 + kc * kc) / (middle + root), high = middle + root;
        const double there = value_at(*eta.samples, nm);
        metal.eta[c] = static_cast<float>(std::abs(low - there) < std::abs(high - there) ? low : high);
        metal.k[c] = static_cast<float>(kc);
    }
    return metal;
}

Metal named_metal(std::string_view name)
{
    const auto eta = find_named_spectrum(fmt::format("metal-{}-eta", name));
    const auto k = find_named_spectrum(fmt::format("metal-{}-k", name));
    if (!eta || !k) return named_metal("Cu");
    return {eta->rgb, k->rgb};
}

std::optional<Spectrum> SpectrumReader::named(const std::string& name, const Spot& spot)
{
    Spectrum s;
    if (const auto known = find_named_spectrum(name)) {
        s.rgb = known->rgb;
        s.kind = known->is_light ? Spectrum::Kind::light_rgb : Spectrum::Kind::rgb;
        return s;
    }
    s.samples = file(name, spot);
    if (!s.samples) return {};
    s.kind = Spectrum::Kind::sampled;
    return s;
}

std::shared_ptr<const Samples> SpectrumReader::file(const std::string& name, const Spot& spot)
{
    const auto known = files_.find(name);
    if (known != files_.end()) return known->second;
    std::string file_name;
    std::string text;
    try {
        text = read_file_(name, spot, file_name);
    } catch (const Error& error) {
        notes_.warn(spot, "spectrum " + name,
                    fmt::format("the spectrum {} is neither a known name nor a file that can be read ({}); it is "
                                "left out",
                                show_word(name), error.what()));
        return files_[name] = nullptr;
    }
    auto samples = std::make_shared<Samples>();
    std::vector<float> numbers;
    std::size_t start = 0;
    int line = 0;
    while (start < text.size()) {
        std::size_t end = std::min(text.find('\n', start), text.size());
        std::string_view rest(text.data() + start, end - start);
        start = end + 1;
        ++line;
        rest = trim(rest.substr(0, rest.find('#')));
        while (!rest.empty()) {
            const char* p = rest.data();
            float value = 0;
            if (!read_float(p, rest.data() + rest.size(), value) || !std::isfinite(value))
                throw Error({file_name, line, 0},
                            fmt::format("a number should be here, but there is {}", show_word(rest)),
                            "an .spd file has a wavelength in nanometres and a value on each line");
            numbers.push_back(value);
            rest.remove_prefix(static_cast<std::size_t>(p - rest.data()));
            while (!rest.empty() && (is_space(rest.front()) || rest.front() == ',')) rest.remove_prefix(1);
        }
    }
    for (std::size_t i = 0; i + 1 < numbers.size(); i += 2) samples->emplace_back(numbers[i], numbers[i + 1]);
    if (samples->empty() || numbers.size() % 2 != 0)
        throw Error({file_name}, "is no list of pairs of wavelength and value",
                    "an .spd file has a wavelength in nanometres and a value on each line");
    std::stable_sort(samples->begin(), samples->end(), [](const auto& a, const auto& b) { return a.first < b.first; });
    return files_[name] = std::move(samples);
}

std::optional<Spectrum> SpectrumReader::read(const Parameter& parameter, const ColorSpace& space, Use use)
{
    for (const float number : parameter.numbers)
        if (!std::isfinite(number)) {
            notes_.warn(parameter.spot, "not finite", "a colour is not finite; it is left out");
            return {};
        }
    Spectrum s;
    const std::vector<float>& n = parameter.numbers;
    switch (parameter.type) {
    case Type::rgb:
        if (n.size() < 3) break;
        s.rgb = vec3(n[0], n[1], n[2]);
        if (use != Use::plain) s.rgb = (use == Use::light ? space.light : space.reflectance) * s.rgb;
        return s;
    case Type::xyz:
        if (n.size() < 3) break;
        s.rgb = vec3(rec709_from_xyz({n[0], n[1], n[2]}));
        return s;
    case Type::number:
        if (n.empty()) break;
        s.rgb = vec3(n[0]);
        return s;
    case Type::blackbody:
        if (n.empty() || !(n[0] >= 100.0f) || n[0] > 1e6f) break;
        s.kind = Spectrum::Kind::blackbody;
        s.kelvin = n[0];
        if (n.size() > 1) s.scale = n[1];
        return s;
    case Type::spectrum: {
        if (!parameter.strings.empty()) return named(parameter.strings[0], parameter.spot);
        if (n.size() == 1) {
            s.rgb = vec3(n[0]);
            return s;
        }
        if (n.empty() || n.size() % 2 != 0) break;
        auto samples = std::make_shared<Samples>();
        for (std::size_t i = 0; i + 1 < n.size(); i += 2) samples->emplace_back(n[i], n[i + 1]);
        std::stable_sort(samples->begin(), samples->end(),
                         [](const auto& a, const auto& b) { return a.first < b.first; });
        s.kind = Spectrum::Kind::sampled;
        s.samples = std::move(samples);
        return s;
    }
    default:
        break;
    }
    notes_.warn(parameter.spot, "colour " + parameter.name,
                fmt::format("\"{} {}\" is no colour; it is left out", parameter.type_name, parameter.name));
    return {};
}

} // namespace snell::pbrt
