#include "io/field/input.h"

namespace standoff {

void FieldInput::fail_short(std::uint64_t offset, std::uint64_t bytes, const char* what) const {
  fail("byte " + std::to_string(offset), std::string(what) + " of " + std::to_string(bytes) +
                                             " bytes reaches past the end of the file, " + std::to_string(size()) +
                                             " bytes; it is truncated or damaged, write it again");
}

}  // namespace standoff
