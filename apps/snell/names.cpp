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
    static_assert(tone_none == 0 && tone_reinhard == 1 && tone_aces == 2);
    static const std::vector<Named> all = {
        {"none", "clip what is brighter than white"},
        {"reinhard", "x / (1 + x) on luminance"},
        {"aces", "Narkowicz's fit of the ACES curve"},
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
    const std::vector<std::string> names = names_of(tone_curves());
    check_name("tone curve", name, names);
    uint curve = 0;
    while (names[curve] != name) ++curve;
    return curve;
}

} // namespace snell::app
