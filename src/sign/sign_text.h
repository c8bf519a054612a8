// SPDX-License-Identifier: Apache-2.0
// The text that tells how a field's sign was decided. Its provenance and every field format store it.
#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "standoff/sign.h"

namespace standoff {

/// The decision about a sign.
struct SignText {
  SignMethod method = SignMethod::none;  ///< never `automatic`
  WindingRule rule = WindingRule::positive;
  bool invert = false;
  bool oriented = false;  ///< triangles were flipped or left out before (sign/diagnosis/orient.h)
  bool outer = false;     ///< internal triangles were left out (sign/outer/outer.h)
  double shell = 0;       ///< of SignMethod::shell alone; world units

  friend bool operator==(const SignText&, const SignText&) = default;
};

/// The decision with these options that the report tells of.
SignText sign_text_of(const SignOptions& options, const SignReport& report);

/// The method, then what differs from its default: "winding", "winding odd oriented inverted", "shell 0.01". Empty
/// without a sign. Numbers are read back as they were.
std::string written(const SignText& text);

/// Reads what `written` wrote; nothing for any other text, for example of another program or of a later version.
std::optional<SignText> sign_text_in(std::string_view text);

}  // namespace standoff
