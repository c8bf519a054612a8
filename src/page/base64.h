// SPDX-License-Identifier: Apache-2.0
// Bytes as text (RFC 4648).
#pragma once

#include <string>
#include <string_view>

namespace standoff::page {

/// Appends the bytes, four characters for three of them, with '=' at the end where the count asks for it.
void append_base64(std::string& out, std::string_view bytes);

}  // namespace standoff::page
