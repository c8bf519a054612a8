// SPDX-License-Identifier: Apache-2.0
// What every public function does: it checks where it is to run, and turns every exception into standoff::Error.
#pragma once

#include <exception>
#include <utility>

#include "standoff/execution.h"

namespace standoff {

/// An exception of the caller's callback, which passes unchanged.
struct FromCallback {
  std::exception_ptr thrown;
};

/// Calls the caller's function.
template <class Callback, class... Arguments>
decltype(auto) call_back(const Callback& callback, Arguments&&... arguments) {
  try {
    return callback(std::forward<Arguments>(arguments)...);
  } catch (...) {
    throw FromCallback{std::current_exception()};
  }
}

/// For `catch (...)` around a public function: throws what is being handled again, as the Error it is or stands for.
/// Memory that is not there, and sizes that no memory holds, become Error{limit} with what to do; what the system
/// refuses Error{limit} too; what a callback threw comes out as it is; all else is a bug, Error{internal}.
[[noreturn]] void throw_as_error(const char* where,
                                 const char* what_to_do = "use smaller input, or provide more memory");

/// Which backends a call has.
enum class Runs { everywhere, on_the_cpu };

/// Throws Error{usage}, beginning with `where`, for invalid values, and for a backend the call does not
/// have.
void validate(const char* where, const Execution& execution, Runs runs);

}  // namespace standoff
