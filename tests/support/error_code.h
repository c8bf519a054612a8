// Which error a call ends in.
#pragma once

#include "standoff/error.h"

namespace standoff::testing {

/// The code of the standoff::Error that the call throws; internal where it throws none.
template <class Call>
ErrorCode code_of(Call call) {
  try {
    call();
  } catch (const Error& error) {
    return error.code();
  }
  return ErrorCode::internal;
}

}  // namespace standoff::testing
