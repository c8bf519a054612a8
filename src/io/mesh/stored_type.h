// SPDX-License-Identifier: Apache-2.0
// The types that binary mesh files store numbers in.
#pragma once

#include <cstdint>

namespace standoff {

/// In the order of glTF's componentType, which begins at 5120.
enum class StoredType { int8, uint8, int16, uint16, int32, uint32, float32, float64 };

/// Calls body with a value of the C++ type.
template <class Body>
decltype(auto) with_type(StoredType type, const Body& body) {
  switch (type) {
    case StoredType::int8:
      return body(std::int8_t{});
    case StoredType::uint8:
      return body(std::uint8_t{});
    case StoredType::int16:
      return body(std::int16_t{});
    case StoredType::uint16:
      return body(std::uint16_t{});
    case StoredType::int32:
      return body(std::int32_t{});
    case StoredType::uint32:
      return body(std::uint32_t{});
    case StoredType::float32:
      return body(float{});
    case StoredType::float64:
      break;
  }
  return body(double{});
}

}  // namespace standoff
