// SPDX-License-Identifier: Apache-2.0
// The standoff program: its verbs.
#include <CLI/CLI.hpp>

#include "cli/commands.h"
#include "cli/console.h"
#include "cli/failure.h"
#include "cli/signals.h"
#include "cli/usage.h"

namespace standoff::cli {
namespace {

void run(int argc, char** argv) {
  CLI::App program;
  set_up_help(program);
  for (const auto add :
       {add_compute, add_info, add_slice, add_render, add_view, add_verify, add_generate, add_convert, add_iso,
        add_points, add_crossings, add_voxels, add_build, add_collide, add_distance, add_sweep, add_fly, add_devices})
    add(program);
  add_version_and_help(program);
  parse(program, argc, argv);
}

}  // namespace
}  // namespace standoff::cli

int main(int argc, char** argv) {
  standoff::cli::install_signal_handlers();
  standoff::cli::tell_of_pipes();
  return standoff::cli::exit_code_of([=] { standoff::cli::run(argc, argv); });
}
