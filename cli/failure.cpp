#include "cli/failure.h"

#include <cstdio>
#include <exception>
#include <new>
#include <string>

#include "cli/text.h"
#include "standoff/error.h"

namespace standoff::cli {
namespace {

int fail(ErrorCode code, const std::string& message) {
  std::fprintf(stderr, "standoff: error: %s\n", message_line(message).c_str());
  return static_cast<int>(code);
}

// What the program has to offer where the library knows no more: its own options.
std::string own_advice(const Error& error) {
  return error.code() == ErrorCode::device ? " (--device cpu; `standoff devices` lists what there is)" : "";
}

}  // namespace

int exit_code_of(const std::function<void()>& run) {
  try {
    run();
    return 0;
  } catch (const Error& error) {
    if (error.code() == ErrorCode::interrupted)
      return fail(error.code(), "interrupted; no partial file was left, run it again");
    return fail(error.code(), error.what() + own_advice(error));
  } catch (const std::bad_alloc&) {
    return fail(ErrorCode::limit,
                "out of memory; take fewer samples, a smaller thickness, or a machine with more memory");
  } catch (const std::exception& error) {
    return fail(ErrorCode::internal,
                "internal: " + std::string(error.what()) + "; this is a bug in standoff, please report it");
  }
}

}  // namespace standoff::cli
