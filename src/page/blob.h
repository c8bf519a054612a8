// SPDX-License-Identifier: Apache-2.0
// What a page gets of one mesh or field: a header that says what it is, and sections of bytes (view/README.md).
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "page/json_text.h"

namespace standoff::page {

struct Section {
  std::string_view name;
  std::string bytes;
};

/// "SOPG", the header's length in 4 bytes (little endian), the header (JSON: `header` with a list of the sections'
/// names and lengths), and the sections one after the other; all of it as one zlib stream, or as it is with a
/// compression of 0.
std::string packed_blob(JsonObject header, const std::vector<Section>& sections, int compression);

}  // namespace standoff::page
