// SPDX-License-Identifier: Apache-2.0
// JSON as text: the few words that the program says to its page.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include "standoff/vec.h"

namespace standoff::page {

/// The text between quotes. No '<', '>', '&', U+2028 or U+2029 stands in it, so that it can end no script it stands in;
/// bytes that are no UTF-8 become U+FFFD.
std::string json_string(std::string_view text);
/// The number that reads back as the same; null for infinite ones and those that are none.
std::string json_number(double value);
std::string json_number(std::int64_t value);
inline std::string json_bool(bool value) { return value ? "true" : "false"; }
std::string json_triple(Vec3 value);
std::string json_triple(Size3 value);

/// An object, member by member.
class JsonObject {
 public:
  /// `value` is JSON already.
  JsonObject& add(std::string_view name, const std::string& value) {
    if (!text_.empty()) text_ += ',';
    text_.append(json_string(name)).append(":").append(value);
    return *this;
  }
  std::string text() const { return "{" + text_ + "}"; }

 private:
  std::string text_;
};

}  // namespace standoff::page
