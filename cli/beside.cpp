// SPDX-License-Identifier: Apache-2.0
#include "cli/beside.h"

#include <algorithm>
#include <array>
#include <utility>

#include "cli/parse.h"
#include "standoff/error.h"

namespace standoff::cli {
namespace {

constexpr std::array kKinds{SidecarKind::closest_point, SidecarKind::barycentric, SidecarKind::feature,
                            SidecarKind::gradient};

}  // namespace

void Beside::add(const std::string& option, const std::string& text) {
  for (std::size_t start = 0; start <= text.size();) {
    const std::size_t end = std::min(text.find(',', start), text.size());
    const std::size_t choice = parse_choice(option, text.substr(start, end - start),
                                            {"nearest", "triangle", "closest", "barycentric", "feature", "gradient"});
    start = end + 1;
    if (choice < 2) {
      nearest_ = true;
    } else if (const SidecarKind kind = kKinds[choice - 2]; std::ranges::find(kinds_, kind) == kinds_.end()) {
      kinds_.push_back(kind);
    }
  }
}

void Beside::check(const FileOutput& output) const {
  if (nearest_) output.check_carries_nearest(field_formats());
  if (!kinds_.empty()) output.check_carries_sidecars(field_formats());
}

void Beside::prepare(ComputeOptions& options) const {
  options.nearest_triangle = nearest_ || !kinds_.empty();
  for (const SidecarKind kind : kinds_) options.bytes_beside += bytes_per_sample(kind);
}

std::vector<Sidecar> Beside::make(MeshView mesh, DistanceField& field, const Execution& execution,
                                  const ProgressCallback& progress) const {
  if (kinds_.empty()) return {};
  std::vector<Sidecar> made = sidecars(mesh, field, kinds_, {.threads = execution.threads}, progress);
  if (!nearest_) field.erase_nearest();
  return made;
}

std::int64_t count_wrong(const FieldFile& file, MeshView mesh, const Execution& execution) {
  if (!file.field.has_nearest()) return 0;
  std::int64_t wrong = 0;
  for (const SidecarKind kind : kKinds)
    for (const Sidecar& stored : file.sidecars) {
      if (stored.name != name_of(kind)) continue;
      const Sidecar right = std::move(sidecars(mesh, file.field, {&kind, 1}, execution)[0]);
      const auto compare = [&]<class Number>(const std::vector<Number>& numbers) {
        const auto* const others = std::get_if<std::vector<Number>>(&right.values);
        const auto width = static_cast<std::size_t>(right.components);
        if (!others || others->size() != numbers.size() || stored.components != right.components) {
          ++wrong;  // another array of that name
          return;
        }
        for (std::size_t n = 0; n < numbers.size(); n += width)
          wrong += std::equal(numbers.data() + n, numbers.data() + n + width, others->data() + n) ? 0 : 1;
      };
      std::visit(compare, stored.values);
    }
  return wrong;
}

}  // namespace standoff::cli
