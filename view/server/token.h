// SPDX-License-Identifier: Apache-2.0
// The secret in the address of a served page.
#pragma once

#include <string>
#include <string_view>

namespace standoff::view {

/// 32 hexadecimal digits, 128 bits from the system's random numbers. Errors: device (the system has none).
std::string random_token();

/// Whether both texts are the same. How long it takes depends on the length of `given` alone, so that nobody learns a
/// token by timing guesses.
bool same_token(std::string_view token, std::string_view given);

}  // namespace standoff::view
