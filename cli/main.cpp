// SPDX-License-Identifier: Apache-2.0
// The standoff program: its verbs.
#include <CLI/CLI.hpp>

#include "cli/console.h"
#include "cli/process.h"
#include "cli/verb.h"

namespace standoff::cli {
namespace {

void run(int argc, char** argv) {
  CLI::App program;
  set_up_help(program);
#define STANDOFF_ROW(verb) add_##verb(program);
  STANDOFF_VERBS(STANDOFF_ROW)
#undef STANDOFF_ROW
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
