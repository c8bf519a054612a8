// SPDX-License-Identifier: Apache-2.0
#include "page/blob.h"

#include <cstdint>

#include "files/deflate.h"

namespace standoff::page {

std::string packed_blob(JsonObject header, const std::vector<Section>& sections, int compression) {
  std::string list;
  for (const Section& section : sections)
    list += (list.empty() ? "[" : ",[") + json_string(section.name) + "," +
            json_number(static_cast<std::int64_t>(section.bytes.size())) + "]";
  const std::string text = header.add("sections", "[" + list + "]").text();
  std::string whole = "SOPG";
  for (int byte = 0; byte < 4; ++byte) whole += static_cast<char>(text.size() >> (8 * byte));
  whole += text;
  for (const Section& section : sections) whole += section.bytes;
  return compression == 0 ? whole : zlib_packed(whole, compression);
}

}  // namespace standoff::page
