// SPDX-License-Identifier: Apache-2.0
// Whether a sanitizer watches, which makes a test ten times as long: a few tests then take smaller inputs of the same kinds.
#pragma once

namespace standoff::testing {

#ifdef STANDOFF_SANITIZED
inline constexpr bool kSanitized = true;
#else
inline constexpr bool kSanitized = false;
#endif

}  // namespace standoff::testing
