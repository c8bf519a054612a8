// SPDX-License-Identifier: Apache-2.0
// The writers of answers, which create_answers lists, and what the binary ones share.
#pragma once

#include <memory>

#include "files/atomic_file.h"
#include "io/points/answer_writer.h"

namespace standoff {

std::unique_ptr<AnswerWriter> csv_file(const std::filesystem::path& path, const AskedAnswers& asked, Existing existing);
std::unique_ptr<AnswerWriter> ply_file(const std::filesystem::path& path, const AskedAnswers& asked, Existing existing);
std::unique_ptr<AnswerWriter> npy_file(const std::filesystem::path& path, const AskedAnswers& asked, Existing existing);
std::unique_ptr<AnswerWriter> npz_file(const std::filesystem::path& path, const AskedAnswers& asked, Existing existing);

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

}  // namespace standoff
