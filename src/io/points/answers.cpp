// SPDX-License-Identifier: Apache-2.0
// Answers at points as CSV, PLY and NumPy arrays.
#include "io/points/answers.h"

#include <bit>
#include <charconv>
#include <cmath>
#include <cstring>
#include <limits>
#include <memory>

#include "files/atomic_file.h"
#include "files/text.h"
#include "io/field/npy.h"
#include "standoff/error.h"
#include "standoff/mesh.h"

namespace standoff {

static_assert(std::endian::native == std::endian::little);

std::vector<AnswerColumn> columns_of(const AskedAnswers& asked) {
  std::vector<AnswerColumn> columns{{"distance", CellType::number, {"distance"}}};
  if (asked.point) columns.push_back({"point", CellType::number, {"x", "y", "z"}});
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
    if (asked.point) put(block.points[n]);
  } else {
    const ClosestPoint& it = block.closest[n];
    put(it.distance);
    if (asked.point) put(block.points[n]);
    if (asked.closest) put(it.point);
    if (asked.triangle) put(it.triangle);
    if (asked.barycentric) put(Vec3{it.barycentric[0], it.barycentric[1], it.barycentric[2]});
    if (asked.feature) put(it.triangle == kNoTriangle ? kNoFeature : static_cast<std::uint8_t>(it.feature));
    if (asked.gradient) put(block.gradients[n]);
  }
  if (asked.winding) put(block.windings[n]);
}

/// Rows of bytes after a header that says how many they are: it is written first, with room, and again at the end.
class CountedRows : public AnswerWriter {
 public:
  CountedRows(const std::filesystem::path& path, const AskedAnswers& asked, Existing existing)
      : file_(path, existing), asked_(asked) {}

  void write(const AnswerBlock& block) override;
  void finish() override;

 protected:
  /// The header for so many rows: of the same length for any number of them.
  virtual std::string header(std::uint64_t rows) const = 0;
  /// Whether a row begins with the point itself.
  virtual bool with_point() const { return false; }
  const AskedAnswers& asked() const { return asked_; }

 private:
  void begin();

  AtomicFile file_;
  AskedAnswers asked_;
  std::uint64_t rows_ = 0;
  bool begun_ = false;
};

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

namespace {

constexpr const char* kFeatures[] = {"face", "edge0", "edge1", "edge2", "vertex0", "vertex1", "vertex2"};
constexpr std::size_t kPart = std::size_t{1} << 18;  // characters that are handed on at once

template <class T>
T taken(const char*& at) {
  T value;
  std::memcpy(&value, at, sizeof value);
  at += sizeof value;
  return value;
}

class CsvAnswers : public AnswerWriter {
 public:
  CsvAnswers(TextSink sink, const AskedAnswers& asked)
      : sink_(std::move(sink)), asked_(asked), columns_(columns_of(asked)) {
    for (const AnswerColumn& column : columns_)
      for (const char* part : column.parts) text_.append(text_.empty() ? "" : ",").append(part);
    text_ += '\n';
  }

  void write(const AnswerBlock& block) override {
    for (std::size_t n = 0; n < block.size(); ++n) {
      write(PackedRow(asked_, block, n));
      if (text_.size() >= kPart) hand_on();
    }
  }
  void finish() override { hand_on(); }

 private:
  void write(const PackedRow& row) {
    const char* at = row.bytes().data();
    for (const AnswerColumn& column : columns_)
      for (std::size_t part = 0; part < column.parts.size(); ++part) {
        if (at != row.bytes().data()) text_ += ',';
        if (column.type == CellType::number) {
          number(taken<double>(at));
        } else if (column.type == CellType::triangle) {
          const auto triangle = taken<std::uint32_t>(at);
          if (triangle != kNoTriangle) number(triangle);
        } else {
          const auto feature = taken<std::uint8_t>(at);
          if (feature < std::size(kFeatures)) text_ += kFeatures[feature];
        }
      }
    text_ += '\n';
  }

  template <class Number>
  void number(Number value) {
    char digits[32];
    text_.append(digits, std::to_chars(digits, digits + sizeof digits, value).ptr);
  }

  void hand_on() {
    sink_(text_);
    text_.clear();
  }

  TextSink sink_;
  AskedAnswers asked_;
  std::vector<AnswerColumn> columns_;
  std::string text_;
};

class CsvFile : public AnswerWriter {
 public:
  CsvFile(const std::filesystem::path& path, const AskedAnswers& asked, Existing existing)
      : file_(path, existing), csv_([this](std::string_view text) { file_.write(text.data(), text.size()); }, asked) {}
  void write(const AnswerBlock& block) override { csv_.write(block); }
  void finish() override {
    csv_.finish();
    file_.commit();
  }

 private:
  AtomicFile file_;
  CsvAnswers csv_;
};

}  // namespace

std::unique_ptr<AnswerWriter> csv_answers(TextSink sink, const AskedAnswers& asked) {
  return std::make_unique<CsvAnswers>(std::move(sink), asked);
}

namespace {

const char* ply_type(CellType type) {
  return type == CellType::number ? "double" : type == CellType::triangle ? "uint" : "uchar";
}

class PlyFile : public CountedRows {
 public:
  PlyFile(const std::filesystem::path& path, AskedAnswers asked, Existing existing)
      : CountedRows(path, without_point(asked), existing) {}

 private:
  // Rows begin with it, whether it is asked or not.
  static AskedAnswers without_point(AskedAnswers asked) {
    asked.point = false;
    return asked;
  }
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

const char* npy_type(CellType type) {
  return type == CellType::number ? "<f8" : type == CellType::triangle ? "<u4" : "|u1";
}

class NpyFile : public CountedRows {
 public:
  using CountedRows::CountedRows;

 private:
  std::string header(std::uint64_t rows) const override {
    const auto columns = columns_of(asked());
    NpyHeader header{"<f8", {std::numeric_limits<std::int64_t>::max()}, false};
    if (columns.size() > 1) {
      header.type.clear();
      header.type += '[';
      for (const AnswerColumn& column : columns) {
        header.type.append("('").append(column.array).append("', '").append(npy_type(column.type));
        header.type += column.parts.size() == 1 ? "'), " : "', (3,)), ";
      }
      header.type += ']';
    }
    const std::size_t room = npy_header(header).size();
    header.shape = {static_cast<std::int64_t>(rows)};
    return npy_header(header, room);
  }
};

// An archive holds one array after the other, but answers come row by row: arrays wait in files beside it until all
// rows are known.
class NpzFile : public AnswerWriter {
 public:
  NpzFile(const std::filesystem::path& path, const AskedAnswers& asked, Existing existing)
      : file_(path, existing), asked_(asked), columns_(columns_of(asked)) {
    for (std::size_t n = 0; n < columns_.size(); ++n) arrays_.emplace_back(path.parent_path(), path);
  }

  void write(const AnswerBlock& block) override {
    for (std::size_t n = 0; n < block.size(); ++n) {
      const PackedRow row(asked_, block, n);
      const char* at = row.bytes().data();
      for (std::size_t c = 0; c < columns_.size(); ++c) {
        const std::size_t bytes = columns_[c].parts.size() * cell_bytes(columns_[c].type);
        arrays_[c].write(at, bytes);
        at += bytes;
      }
    }
    rows_ += static_cast<std::int64_t>(block.size());
  }

  void finish() override {
    NpzArrays arrays(file_);
    for (std::size_t c = 0; c < columns_.size(); ++c) {
      const AnswerColumn& column = columns_[c];
      NpyHeader header{npy_type(column.type), {rows_}, false};
      if (column.parts.size() > 1) header.shape.push_back(static_cast<std::int64_t>(column.parts.size()));
      arrays.begin(column.array, header, arrays_[c].size());
      arrays_[c].read_back([&](std::span<const std::byte> part) { arrays.write(part); });
      arrays.end();
    }
    arrays.finish();
    file_.commit();
  }

 private:
  AtomicFile file_;
  AskedAnswers asked_;
  std::vector<AnswerColumn> columns_;
  std::vector<SpoolFile> arrays_;
  std::int64_t rows_ = 0;
};

template <class Writer>
std::unique_ptr<AnswerWriter> create(const std::filesystem::path& path, const AskedAnswers& asked, Existing existing) {
  return std::make_unique<Writer>(path, asked, existing);
}

struct AnswerFormat {
  const char* extension;
  std::unique_ptr<AnswerWriter> (*create)(const std::filesystem::path&, const AskedAnswers&, Existing);
};
constexpr AnswerFormat kAnswerFormats[] = {
    {"csv", create<CsvFile>}, {"ply", create<PlyFile>}, {"npy", create<NpyFile>}, {"npz", create<NpzFile>}};

}  // namespace

std::vector<FileFormat> answer_formats() {
  std::vector<FileFormat> formats;
  for (const AnswerFormat& format : kAnswerFormats)
    formats.push_back({.extension = format.extension, .description = "", .writable = true});
  return formats;
}

std::unique_ptr<AnswerWriter> create_answers(const std::filesystem::path& path, const AskedAnswers& asked,
                                             Existing existing) {
  const std::string extension = path.extension().string();
  for (const AnswerFormat& format : kAnswerFormats)
    if (extension.starts_with('.') && equals_ignoring_case(std::string_view(extension).substr(1), format.extension))
      return format.create(path, asked, existing);
  std::string shown = extension, known;
  for (char& c : shown)
    if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
  for (std::size_t n = 0; n < std::size(kAnswerFormats); ++n)
    known += std::string(n == 0                               ? "."
                         : n + 1 == std::size(kAnswerFormats) ? " or ."
                                                              : ", .") +
             kAnswerFormats[n].extension;
  throw Error(ErrorCode::usage, path.string() + ": answers are not written as " + shown + " files; give " + known);
}

}  // namespace standoff
