// The difi program: verbs, and what the user is told when something goes wrong.
#include <cstdio>
#include <exception>
#include <new>
#include <string>
#include <system_error>

#include <CLI/CLI.hpp>

#include "cli/commands.h"
#include "cli/signals.h"
#include "cli/talk.h"
#include "cli/usage.h"
#include "difi/error.h"
#include "difi/version.h"

namespace difi::cli {
namespace {

int fail(ErrorCode code, std::string message) {
  for (char& c : message)
    if (c == '\n' || c == '\r') c = ' ';  // one error, one line, whatever a file is called
  std::fprintf(stderr, "difi: error: %s\n", message.c_str());
  return static_cast<int>(code);
}

void run(int argc, char** argv) {
  CLI::App program;
  set_up_help(program);
  for (const auto add : {add_compute, add_info, add_slice, add_verify, add_generate, add_convert, add_collide,
                         add_distance, add_sweep, add_fly})
    add(program);
  add_version_and_help(program);
  parse(program, argc, argv);
}

int guarded(int argc, char** argv) {
  try {
    run(argc, argv);
    return 0;
  } catch (const Error& error) {
    if (error.code() == ErrorCode::interrupted)
      return fail(error.code(), "interrupted; no partial file was left, run it again");
    return fail(error.code(), error.what());
  } catch (const std::bad_alloc&) {
    return fail(ErrorCode::limit,
                "out of memory; take fewer samples, a smaller thickness, or a machine with more memory");
  } catch (const std::exception& error) {
    return fail(ErrorCode::internal,
                "internal: " + std::string(error.what()) + "; this is a bug in difi, please report it");
  }
}

}  // namespace
}  // namespace difi::cli

int main(int argc, char** argv) {
  difi::cli::install_signal_handlers();
  return difi::cli::guarded(argc, argv);
}
