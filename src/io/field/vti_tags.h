// The tags of the XML header of a VTK file.
#pragma once

#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "io/field/input.h"

namespace standoff {

struct VtiTag {
  std::string name;  ///< "/Piece" where an element ends
  std::vector<std::pair<std::string, std::string>> attributes;
  std::string_view text;   ///< what follows, up to the next tag
  std::size_t offset = 0;  ///< where it stands in the header

  /// The value of an attribute, or nullptr.
  const std::string* find(std::string_view attribute) const;
};

/// All tags of `header`, which must outlive them. Errors: input, with the byte.
std::vector<VtiTag> read_vti_tags(const FieldInput& file, std::string_view header);

}  // namespace standoff
