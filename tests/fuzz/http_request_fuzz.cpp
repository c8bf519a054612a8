// SPDX-License-Identifier: Apache-2.0
// Any bytes as the head of a request: refused, or read into a request of which every part obeys its grammar; and as the
// gate sees it, nothing comes in without the token.
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <string_view>

#include "view/server/request.h"

namespace {

using namespace standoff::view;

void check_head(std::string_view bytes) {
  const auto length = head_length(bytes);
  const auto [request, refusal] = parse_head(bytes.substr(0, length.value_or(bytes.size())));
  if (refusal) {
    if (refusal->status < 400 || refusal->status > 505 || refusal->why.empty()) std::abort();
    return;
  }
  if (!length || request.method.empty() || !request.path.starts_with('/')) std::abort();
  if (request.headers.size() > kMostHeaders || request.parameters.size() > kMostParameters) std::abort();
  for (const auto& [name, value] : request.headers)
    if (name.empty() || value.find_first_of("\r\n") != std::string::npos || request.header(name) == nullptr)
      std::abort();
  const std::string token = "0123456789abcdef0123456789abcdef";
  const Gate gate(token);
  const bool in = !gate.check(request);
  if (in && !request.path.starts_with("/" + token + "/")) std::abort();
  if (in) (void)gate.route(request);
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string_view bytes(reinterpret_cast<const char*>(data), size);
  check_head(bytes);
  if (const auto parameters = parse_query(bytes))
    for (const auto& [name, value] : *parameters)
      if (name.empty() || name.size() + value.size() > bytes.size()) std::abort();
  return 0;
}
