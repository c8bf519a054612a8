// SPDX-License-Identifier: Apache-2.0
// Answers as NumPy arrays. NPY: distances; records, if more is asked. NPZ: an array for each.
#include <limits>

#include "files/atomic_file.h"
#include "files/zip.h"
#include "io/field/npy.h"
#include "io/points/answer_format.h"

namespace standoff {
namespace {

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

// An archive has one array after the other, and answers come one by one: arrays wait beside it until all is known.
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
    ZipWriter zip(file_);
    for (std::size_t c = 0; c < columns_.size(); ++c) {
      const AnswerColumn& column = columns_[c];
      NpyHeader header{npy_type(column.type), {rows_}, false};
      if (column.parts.size() > 1) header.shape.push_back(static_cast<std::int64_t>(column.parts.size()));
      const std::string text = npy_header(header);
      zip.begin(std::string(column.array) + ".npy", text.size() + arrays_[c].size());
      zip.write(std::as_bytes(std::span(text)));
      arrays_[c].read_back([&](std::span<const std::byte> part) { zip.write(part); });
      zip.end();
    }
    zip.finish();
    file_.commit();
  }

 private:
  AtomicFile file_;
  AskedAnswers asked_;
  std::vector<AnswerColumn> columns_;
  std::vector<SpoolFile> arrays_;
  std::int64_t rows_ = 0;
};

}  // namespace

std::unique_ptr<AnswerWriter> npy_file(const std::filesystem::path& path, const AskedAnswers& asked,
                                       Existing existing) {
  return std::make_unique<NpyFile>(path, asked, existing);
}

std::unique_ptr<AnswerWriter> npz_file(const std::filesystem::path& path, const AskedAnswers& asked,
                                       Existing existing) {
  return std::make_unique<NpzFile>(path, asked, existing);
}

}  // namespace standoff
