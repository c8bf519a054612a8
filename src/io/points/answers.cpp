// SPDX-License-Identifier: Apache-2.0
// The columns of answers, and their bytes.
#include <bit>
#include <cmath>
#include <cstring>

#include "io/points/answer_writer.h"

namespace standoff {

static_assert(std::endian::native == std::endian::little);

std::vector<AnswerColumn> columns_of(const AskedAnswers& asked) {
  std::vector<AnswerColumn> columns{{"distance", CellType::number, {"distance"}}};
  if (asked.closest) columns.push_back({"closest", CellType::number, {"closest_x", "closest_y", "closest_z"}});
  if (asked.triangle) columns.push_back({"triangle", CellType::triangle, {"triangle"}});
  if (asked.barycentric) columns.push_back({"barycentric", CellType::number, {"w0", "w1", "w2"}});
  if (asked.feature) columns.push_back({"feature", CellType::feature, {"feature"}});
  if (asked.gradient) columns.push_back({"gradient", CellType::number, {"gradient_x", "gradient_y", "gradient_z"}});
  if (asked.winding) columns.push_back({"winding", CellType::number, {"winding"}});
  return columns;
}

std::size_t cell_bytes(CellType type) { return type == CellType::number ? 8 : type == CellType::triangle ? 4 : 1; }

template <class T>
void PackedRow::put(T value) {
  std::memcpy(bytes_ + size_, &value, sizeof value);
  size_ += sizeof value;
}

void PackedRow::put(Vec3 v) { put(v.x), put(v.y), put(v.z); }

PackedRow::PackedRow(const AskedAnswers& asked, const AnswerBlock& block, std::size_t n) {
  if (!asked.needs_closest()) {
    put(block.distances[n]);
  } else {
    const ClosestPoint& it = block.closest[n];
    put(it.distance);
    if (asked.closest) put(it.point);
    if (asked.triangle) put(it.triangle);
    if (asked.barycentric) put(Vec3{it.weights[0], it.weights[1], it.weights[2]});
    if (asked.feature) put(it.triangle == kNoTriangle ? kNoFeature : static_cast<std::uint8_t>(it.feature));
    if (asked.gradient) put(block.gradients[n]);
  }
  if (asked.winding) put(block.windings[n]);
}

}  // namespace standoff
