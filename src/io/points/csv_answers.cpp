// SPDX-License-Identifier: Apache-2.0
// Answers as CSV: a line of names, then a line per point, numbers with as many digits as read back the same bits.
#include <charconv>
#include <cstring>

#include "io/points/answer_format.h"
#include "standoff/mesh.h"

namespace standoff {
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

std::unique_ptr<AnswerWriter> csv_file(const std::filesystem::path& path, const AskedAnswers& asked,
                                       Existing existing) {
  return std::make_unique<CsvFile>(path, asked, existing);
}

}  // namespace standoff
