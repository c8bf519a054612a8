// SPDX-License-Identifier: Apache-2.0
// Answers as a PLY point cloud: the points that were asked about, with the answers as properties.
#include <limits>

#include "io/points/answer_format.h"

namespace standoff {
namespace {

const char* ply_type(CellType type) {
  return type == CellType::number ? "double" : type == CellType::triangle ? "uint" : "uchar";
}

class PlyFile : public CountedRows {
 public:
  using CountedRows::CountedRows;

 private:
  bool with_point() const override { return true; }

  std::string header(std::uint64_t rows) const override {
    const std::string count = std::to_string(rows);
    const std::size_t most = std::numeric_limits<std::uint64_t>::digits10 + 1;
    std::string text = "ply\nformat binary_little_endian 1.0\ncomment answers of standoff " +
                       std::string(most - count.size() + 1, '-') + "\nelement vertex " + count + "\n";
    for (const char* axis : {"x", "y", "z"}) text += std::string("property double ") + axis + "\n";
    for (const AnswerColumn& column : columns_of(asked()))
      for (const char* part : column.parts)
        text.append("property ").append(ply_type(column.type)).append(" ").append(part) += '\n';
    return text + "end_header\n";
  }
};

}  // namespace

std::unique_ptr<AnswerWriter> ply_file(const std::filesystem::path& path, const AskedAnswers& asked,
                                       Existing existing) {
  return std::make_unique<PlyFile>(path, asked, existing);
}

}  // namespace standoff
