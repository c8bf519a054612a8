// SPDX-License-Identifier: Apache-2.0
// The frame of every public function: it checks the execution options, and turns every exception into standoff::Error.
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
  } catch (const FromCallback&) {
    throw;  // of a callback within the callback
  } catch (...) {
    throw FromCallback{std::current_exception()};
  }
}

/// For `catch (...)` around a public function: throws the exception being handled again, as an Error. A failed
/// allocation, and a size beyond all memory, become Error{limit} with advice; so does a refusal of the system. An
/// exception of a callback passes unchanged. Any other exception is a bug, Error{internal}.
[[noreturn]] void throw_as_error(const char* where,
                                 const char* what_to_do = "use smaller input, or provide more memory");

/// The backends of a call.
enum class Runs { everywhere, on_the_cpu };

/// Throws Error{usage}, beginning with `where`, for invalid values, and for a backend that the call lacks.
void validate(const char* where, const Execution& execution, Runs runs);

}  // namespace standoff
