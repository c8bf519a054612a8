// SPDX-License-Identifier: Apache-2.0
// How the files of bodies begin (src/collision/body/model_file.cpp): readers of meshes tell them apart by it.
#pragma once

#include <string_view>

namespace standoff {

inline constexpr std::string_view kBodyMagic = "so.body\n";

}  // namespace standoff
