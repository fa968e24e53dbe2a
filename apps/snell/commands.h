// The subcommands. To add one: a file with its function, a line here, and a line in main.cpp's table.
#pragma once

#include <string>
#include <vector>

namespace snell::app {

// What follows the subcommand's name. The result is the program's exit code: 0 done, 1 the job failed, 2 usage.
using Arguments = std::vector<std::string>;

int run_render(const Arguments& arguments);
int run_view(const Arguments& arguments);
int run_info(const Arguments& arguments);
int run_convert(const Arguments& arguments);
int run_list(const Arguments& arguments);
int run_probe(const Arguments& arguments);
int run_compare(const Arguments& arguments);
int run_camera(const Arguments& arguments);
int run_bench(const Arguments& arguments);

} // namespace snell::app
