#include "names.h"

#include "usage.h"

#include "snell/bvh/accel.h"
#include "snell/kernel/tone.h"
#include "snell/render/integrator.h"

namespace snell::app {

const std::vector<Named>& samplers()
{
    static const std::vector<Named> all = {
        {"sobol", "Owen-scrambled Sobol points (Burley 2020): noise falls faster than with independent numbers"},
        {"independent", "independent random numbers (PCG)"},
    };
    return all;
}

const std::vector<Named>& tone_curves()
{
    static_assert(tone_none == 0 && tone_reinhard == 1 && tone_aces == 2 && tone_aces_hill == 3 && tone_agx == 4 &&
                  tone_neutral == 5 && tone_count == 6);
    static const std::vector<Named> all = {
        {"none", "clip what is brighter than white"},
        {"reinhard", "x / (1 + x) on luminance"},
        {"aces-narkowicz", "Narkowicz's fit of the ACES curve; also called aces"},
        {"aces-hill", "Hill's fit of the ACES transforms: bright colours lose saturation"},
        {"agx", "Sobotka's AgX: a wide range, soft into white"},
        {"neutral", "Khronos PBR Neutral: colours below 0.8 stay as they are"},
    };
    return all;
}

static std::vector<std::string> names_of(const std::vector<Named>& all)
{
    std::vector<std::string> names;
    for (const Named& one : all) names.emplace_back(one.name);
    return names;
}

std::vector<std::string> sampler_names()
{
    return names_of(samplers());
}

std::vector<std::string> integrator_names()
{
    std::vector<std::string> names;
    for (const IntegratorInfo& info : integrators()) names.push_back(info.name);
    return names;
}

std::vector<std::string> accel_names()
{
    std::vector<std::string> names;
    for (const AccelInfo& info : accels()) names.emplace_back(info.name);
    return names;
}

std::vector<std::string> builder_names()
{
    std::vector<std::string> names;
    for (const BuilderInfo& info : builders()) names.emplace_back(info.name);
    return names;
}

std::vector<std::string> parameter_names(std::string_view integrator)
{
    std::vector<std::string> names;
    for (const std::string& parameter : find_integrator(integrator)->parameters)
        names.push_back(parameter.substr(0, parameter.find('=')));
    return names;
}

uint find_tone_curve(const std::string& name)
{
    std::vector<std::string> names = names_of(tone_curves());
    names.emplace_back("aces"); // the first of the two, from when there was one
    check_name("tone curve", name, names);
    if (name == names.back()) return tone_aces;
    uint curve = 0;
    while (names[curve] != name) ++curve;
    return curve;
}

} // namespace snell::app
