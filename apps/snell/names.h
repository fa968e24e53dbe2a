// The names that the command line accepts, in the order in which `snell list` shows them.
#pragma once

#include "snell/core/vec.h"

#include <string>
#include <string_view>
#include <vector>

namespace snell::app {

struct Named
{
    std::string_view name, summary;
};

const std::vector<Named>& samplers();
const std::vector<Named>& tone_curves(); // by number, as in snell/kernel/tone.h

std::vector<std::string> sampler_names();
std::vector<std::string> integrator_names();
std::vector<std::string> accel_names();
std::vector<std::string> builder_names();
// The -D keys of an integrator, which must exist.
std::vector<std::string> parameter_names(std::string_view integrator);
// Throws UsageError if there is none of that name.
uint find_tone_curve(const std::string& name);

} // namespace snell::app
