// snell bench accel.
#pragma once

#include "commands.h"

namespace snell::app {

int run_bench_accel(const Arguments& arguments); // those after "accel"

} // namespace snell::app
