// SPDX-License-Identifier: Apache-2.0
// A page about a batch: how many meshes ended how, and the failed ones with their messages and pictures.
#pragma once

#include <filesystem>

#include "cli/batch/manifest.h"
#include "cli/console.h"

namespace standoff::cli {

/// How a report draws.
struct ReportOptions {
  int workers = 1;        ///< processes that draw
  double timeout_s = 30;  ///< of a picture
};

/// Of the last row of each mesh.
struct ReportedCounts {
  StatusCounts by_status;
  std::int64_t unsure = 0;  ///< as in BatchSummary
};

/// Writes FOLDER/report.html, one file that needs nothing else: counts by status, and the first failures, those of
/// whose meshes can be read at all with a picture. They are drawn by processes of their own: whatever spoils a mesh
/// spoils a picture alone. Of a folder without manifest.jsonl it takes the manifests of its shards. Returns the counts.
/// Errors: usage (no manifest), input, output.
ReportedCounts write_batch_report(const std::filesystem::path& folder, const ReportOptions& options,
                                  const Console& console);

}  // namespace standoff::cli
