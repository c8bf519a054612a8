// SPDX-License-Identifier: Apache-2.0
// Uniform resource identifiers (RFC 3986), as far as files hold them.
#pragma once

#include <optional>
#include <string>
#include <string_view>

namespace standoff {

/// Whether it begins with a scheme, such as https: or file: or C:.
bool has_scheme(std::string_view uri);

/// %20 and its like as the bytes they stand for; a percent sign without two digits stays.
std::string percent_decoded(std::string_view uri);

/// Whether it holds its data itself: "data:...".
bool is_data_uri(std::string_view uri);

/// What a data URI holds (RFC 2397), in base64 or percent escapes; nothing where it is damaged.
std::optional<std::string> data_of_uri(std::string_view uri);

}  // namespace standoff
