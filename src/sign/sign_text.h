// SPDX-License-Identifier: Apache-2.0
// How a field's sign was decided, as the text that its provenance and every field format store.
#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "standoff/sign.h"

namespace standoff {

/// What a field tells about its sign.
struct SignText {
  SignMethod method = SignMethod::none;  ///< never `automatic`
  WindingRule rule = WindingRule::positive;
  bool invert = false;
  bool oriented = false;  ///< triangles were turned around or left out before (sign/diagnosis/orient.h)
  bool outer = false;     ///< internal triangles were left out (sign/outer/exposed.h)
  double shell = 0;       ///< SignMethod::shell alone: world units

  friend bool operator==(const SignText&, const SignText&) = default;
};

/// The text of a sign that was decided with these options, as the report says.
SignText sign_text_of(const SignOptions& options, const SignReport& report);

/// The method, then what differs from its default: "winding", "winding odd oriented inverted", "shell 0.01". Empty
/// without a sign. Numbers are read back as they were.
std::string written(const SignText& text);

/// What `written` wrote; nothing for any other text, for example that of another program or of a later version.
std::optional<SignText> sign_text_in(std::string_view text);

}  // namespace standoff
