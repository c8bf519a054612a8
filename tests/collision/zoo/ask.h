// SPDX-License-Identifier: Apache-2.0
// How much a random test asks. Brief by default; more, from the seed that is wanted, by environment variables.
#pragma once

#include <cstdio>
#include <cstdlib>

namespace standoff::testing {

inline long from_environment(const char* name, long otherwise) {
  const char* const text = std::getenv(name);
  return text == nullptr ? otherwise : std::atol(text);
}

}  // namespace standoff::testing
