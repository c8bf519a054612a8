// SPDX-License-Identifier: Apache-2.0
#include "cli/sidecar_options.h"

#include <algorithm>
#include <cstddef>

#include "cli/parse.h"

namespace standoff::cli {

void SidecarOptions::add(const std::string& option, const std::string& text) {
  for (std::size_t start = 0; start <= text.size();) {
    const std::size_t end = std::min(text.find(',', start), text.size());
    const std::size_t choice = parse_choice(option, text.substr(start, end - start),
                                            {"nearest", "triangle", "closest", "barycentric", "feature", "gradient"});
    start = end + 1;
    if (choice < 2) {
      nearest_ = true;
    } else if (const SidecarKind kind = kSidecarKinds[choice - 2]; std::ranges::find(kinds_, kind) == kinds_.end()) {
      kinds_.push_back(kind);
    }
  }
}

void SidecarOptions::check(const FileOutput& output) const {
  if (nearest_)
    output.check_carries(field_formats(), &FileFormat::nearest, "cannot carry nearest triangles", "--with nearest");
  if (!kinds_.empty())
    output.check_carries(field_formats(), &FileFormat::sidecars, "can only carry distances", "--with");
}

std::int64_t SidecarOptions::bytes_per_sample() const {
  std::int64_t bytes = 0;
  for (const SidecarKind kind : kinds_) bytes += standoff::bytes_per_sample(kind);
  return bytes;
}

std::vector<Sidecar> SidecarOptions::make(MeshView mesh, DistanceField& field, const Execution& execution,
                                          const ProgressCallback& progress) const {
  if (kinds_.empty()) return {};
  std::vector<Sidecar> made =
      sidecars(mesh, field, kinds_, {.execution = {.threads = execution.threads}, .progress = progress});
  if (!nearest_) field.erase_nearest();
  return made;
}

}  // namespace standoff::cli
