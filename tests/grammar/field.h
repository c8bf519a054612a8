// SPDX-License-Identifier: Apache-2.0
// Small fields for grammars to write.
#pragma once

#include <string>

#include "tests/grammar/file.h"

namespace standoff::grammar {

/// A grid of up to some thousand samples, a thickness, values up to it, sometimes nearest triangles.
Truth make_field(Choices& c, bool may_have_nearest);

/// Shortest decimals of a double; at a trick something else.
std::string real64(Choices& c, double value);

}  // namespace standoff::grammar
