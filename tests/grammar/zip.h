// SPDX-License-Identifier: Apache-2.0
// Zip archives written well or badly.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "tests/grammar/choices.h"

namespace standoff::grammar {

/// The archive of these members, by name, deflated or as they are. Good ones differ in what lies between members, in
/// extra fields and comments, in 64-bit sizes and data descriptors; bad ones in anything else: members that overlap or
/// lie outside, sizes that contradict each other, damaged packed bytes, encryption.
std::string make_zip(Choices& c, const std::vector<std::pair<std::string, std::string>>& members);

}  // namespace standoff::grammar
