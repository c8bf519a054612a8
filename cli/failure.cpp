// SPDX-License-Identifier: Apache-2.0
#include "cli/failure.h"

#include <cstdio>
#include <exception>
#include <new>
#include <string>

#include "cli/signals.h"
#include "cli/text.h"
#include "standoff/error.h"

namespace standoff::cli {
namespace {

int fail(ErrorCode code, const std::string& message) {
  std::fprintf(stderr, "standoff: error: %s\n", message_line(message).c_str());
  return static_cast<int>(code);
}

// The library speaks of itself. What its user types to follow its advice is the program's to say.
std::string with_options(const Error& error) {
  const std::string message = error.what();
  if (error.code() != ErrorCode::device || message.find("--device") != std::string::npos) return message;
  return message + " (standoff devices lists what there is; --device cpu takes the CPU)";
}

}  // namespace

int exit_code_of(const std::function<void()>& run) {
  try {
    run();
    return 0;
  } catch (const Error& error) {
    if (error.code() == ErrorCode::interrupted) return fail(error.code(), std::string(interruption()));
    return fail(error.code(), with_options(error));
  } catch (const std::bad_alloc&) {
    return fail(ErrorCode::limit, "not enough memory; use a smaller mesh or fewer samples, or provide more memory");
  } catch (const std::exception& error) {
    return fail(ErrorCode::internal,
                "internal: " + std::string(error.what()) + "; this is a bug in standoff, please report it");
  }
}

}  // namespace standoff::cli
