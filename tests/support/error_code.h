// SPDX-License-Identifier: Apache-2.0
// Which error a call ends in.
#pragma once

#include <optional>

#include "standoff/error.h"

namespace standoff::testing {

/// The code of the standoff::Error that the call throws; nothing where it throws none.
template <class Call>
std::optional<ErrorCode> code_of(Call call) {
  try {
    call();
  } catch (const Error& error) {
    return error.code();
  }
  return std::nullopt;
}

}  // namespace standoff::testing
