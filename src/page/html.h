// SPDX-License-Identifier: Apache-2.0
// The page itself: view/page as one file, and what it shows.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "standoff/page.h"

namespace standoff::page {

/// The page with `blobs`, each as packed_blob() made it.
std::string html(std::string_view title, const PageOptions& options, const std::vector<std::string>& blobs);

}  // namespace standoff::page
