// SPDX-License-Identifier: Apache-2.0
#include "view/server/token.h"

#include <unistd.h>

#include <array>

#include "standoff/error.h"

namespace standoff::view {

std::string random_token() {
  std::array<unsigned char, 16> bytes;
  // Not std::random_device: the standard allows it to be a fixed sequence.
  if (::getentropy(bytes.data(), bytes.size()) != 0)
    throw Error(ErrorCode::device, "the system gives no random numbers; write a page with -o instead");
  constexpr char kDigits[] = "0123456789abcdef";
  std::string token;
  for (const unsigned char byte : bytes) (token += kDigits[byte >> 4]) += kDigits[byte & 15];
  return token;
}

bool same_token(std::string_view token, std::string_view given) {
  // Volatile, or the compiler could leave the loop at the first difference.
  volatile unsigned char differs = token.size() != given.size() || token.empty();
  for (std::size_t n = 0; n < given.size(); ++n) {
    const char expected = token.empty() ? '\0' : token[n % token.size()];
    differs = static_cast<unsigned char>(differs | static_cast<unsigned char>(expected ^ given[n]));
  }
  return differs == 0;
}

}  // namespace standoff::view
