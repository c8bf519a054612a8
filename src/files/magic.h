// SPDX-License-Identifier: Apache-2.0
// How the files of bodies and of queries begin (src/collision/body/model.cpp, src/points/query_file.cpp): readers of
// meshes tell them apart by it.
#pragma once

#include <string_view>

namespace standoff {

inline constexpr std::string_view kBodyMagic = "so.body\n";
inline constexpr std::string_view kQueryMagic = "so.quer\n";

}  // namespace standoff
