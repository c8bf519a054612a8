// SPDX-License-Identifier: Apache-2.0
#include "core/guarded.h"

#include <new>
#include <optional>
#include <stdexcept>
#include <string>
#include <system_error>

#include "standoff/error.h"

namespace standoff {
namespace {

// It is made while there is memory; copying an Error takes none.
const Error kNoMemory(ErrorCode::limit, "not enough memory; use smaller input, or provide more memory");

Error refused(const std::string& place, const std::exception& error) {
  return Error(ErrorCode::limit,
               place + "the system refused: " + error.what() + "; free some of its resources, or use fewer threads");
}

// Turns the exception being handled into an Error.
Error as_error(const char* where, const char* what_to_do) {
  const std::string place = std::string(where) + ": ";
  try {
    throw;
  } catch (const std::bad_alloc&) {
    return Error(ErrorCode::limit, place + "not enough memory; " + what_to_do);
  } catch (const std::length_error&) {
    return Error(ErrorCode::limit, place + "no memory is large enough; " + what_to_do);
  } catch (const std::system_error& error) {
    return refused(place, error);
  } catch (const std::exception& error) {
    // TBB reports in this way that it got no thread.
    if (std::string(error.what()).find("pthread_create") != std::string::npos) return refused(place, error);
    return Error(ErrorCode::internal, place + error.what() + "; this is a bug in standoff, please report it");
  } catch (...) {
    return Error(ErrorCode::internal,
                 place + "what was thrown is no exception; this is a bug in standoff, please report it");
  }
}

}  // namespace

void throw_as_error(const char* where, const char* what_to_do) {
  try {
    throw;
  } catch (const FromCallback& callback) {
    std::rethrow_exception(callback.thrown);
  } catch (const Error&) {
    throw;
  } catch (...) {
    std::optional<Error> error;
    try {
      error = as_error(where, what_to_do);
    } catch (const std::bad_alloc&) {  // there is no memory for the message either
      error = kNoMemory;
    }
    throw Error(*error);
  }
}

}  // namespace standoff
