// SPDX-License-Identifier: Apache-2.0
// Answers at points, into files, a block at a time: rows of numbers in named columns.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "standoff/existing.h"
#include "standoff/io.h"
#include "standoff/points.h"
#include "standoff/vec.h"

namespace standoff {

/// What is asked beside the distance.
struct AskedAnswers {
  bool point = false;  ///< the point itself
  bool closest = false, triangle = false, barycentric = false, feature = false, gradient = false, winding = false;

  /// Whether closest points are needed, or distances will do.
  bool needs_closest() const { return closest || triangle || barycentric || feature || gradient; }
};

/// The answers at some points; what is not asked is empty. NaN, and no triangle, where a point is invalid.
struct AnswerBlock {
  std::vector<Vec3> points;
  std::vector<double> distances;      ///< unless closest points are asked
  std::vector<ClosestPoint> closest;  ///< if they are needed
  std::vector<Vec3> gradients;
  std::vector<double> windings;

  std::size_t size() const { return points.size(); }
};

enum class CellType {
  number,    ///< float64
  triangle,  ///< uint32; kNoTriangle in binary, and nothing in text, where there is none
  feature,   ///< uint8 in binary, 255 where there is none; a name in text
};

struct AnswerColumn {
  const char* array;  ///< the name of its array in NumPy
  CellType type;
  std::vector<const char*> parts;  ///< the names of its numbers in CSV and PLY; one per number
};

/// The columns of what is asked, the distance first.
std::vector<AnswerColumn> columns_of(const AskedAnswers& asked);

/// One answer as the bytes of its columns, one after the other, little endian.
class PackedRow {
 public:
  static constexpr std::uint8_t kNoFeature = 255;
  /// Packs answer n of the block.
  PackedRow(const AskedAnswers& asked, const AnswerBlock& block, std::size_t n);
  std::span<const char> bytes() const { return {bytes_, size_}; }

 private:
  template <class T>
  void put(T value);
  void put(Vec3 v);

  char bytes_[8 + 24 + 24 + 4 + 24 + 1 + 24 + 8];
  std::size_t size_ = 0;
};

/// Bytes of a cell of one number.
std::size_t cell_bytes(CellType type);

class AnswerWriter {
 public:
  AnswerWriter() = default;
  AnswerWriter(const AnswerWriter&) = delete;
  AnswerWriter& operator=(const AnswerWriter&) = delete;
  virtual ~AnswerWriter() = default;

  virtual void write(const AnswerBlock& block) = 0;
  /// Completes the file, which then takes its place. Without this call nothing is left.
  virtual void finish() = 0;
};

/// The formats that create_answers() writes.
std::vector<FileFormat> answer_formats();

/// Where text goes that is no file's.
using TextSink = std::function<void(std::string_view)>;

/// Opens a file of answers by its extension, one of answer_formats(). It appears whole or not at all. Errors: output,
/// usage (the extension).
std::unique_ptr<AnswerWriter> create_answers(const std::filesystem::path& path, const AskedAnswers& asked,
                                             Existing existing);
/// CSV for a sink.
std::unique_ptr<AnswerWriter> csv_answers(TextSink sink, const AskedAnswers& asked);

}  // namespace standoff
