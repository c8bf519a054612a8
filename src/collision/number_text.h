// Numbers in messages: of any size, in a few digits.
#pragma once

#include <cstdio>
#include <string>

namespace difi::collision {

/// "0.02", "1e+21".
inline std::string number_text(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%.6g", value);
  return text;
}

}  // namespace difi::collision
