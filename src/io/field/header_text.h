// SPDX-License-Identifier: Apache-2.0
// Words of the text headers of field files.
#pragma once

#include <cstdint>
#include <string_view>
#include <vector>

namespace standoff {

/// Characters of a method or version that are read: far more than any has.
constexpr std::uint64_t kMaxText = 4096;

std::string_view trimmed(std::string_view text);
/// The parts between spaces and the like.
std::vector<std::string_view> words_of(std::string_view text);

}  // namespace standoff
