// SPDX-License-Identifier: Apache-2.0
// Rows of bytes after a header that says how many they are.
#include "io/points/answer_format.h"

namespace standoff {

void CountedRows::begin() {
  if (begun_) return;
  begun_ = true;
  const std::string room = header(0);
  file_.write(room.data(), room.size());
}

void CountedRows::write(const AnswerBlock& block) {
  begin();
  for (std::size_t n = 0; n < block.size(); ++n) {
    if (with_point()) file_.write(&block.points[n], sizeof(Vec3));
    const PackedRow row(asked_, block, n);
    file_.write(row.bytes().data(), row.bytes().size());
  }
  rows_ += block.size();
}

void CountedRows::finish() {
  begin();
  const std::string known = header(rows_);
  file_.overwrite(0, known.data(), known.size());
  file_.commit();
}

}  // namespace standoff
