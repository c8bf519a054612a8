// JSON as far as checks of a file need it: a tree that points into the text.
#pragma once

#include <cstdint>
#include <optional>
#include <string_view>
#include <utility>
#include <vector>

#include "io/file_view.h"

namespace difi {

/// A value; strings and names are as they stand between their quotes, escapes and all. What is asked of a value of
/// another kind is answered as if it were empty.
class JsonView {
 public:
  /// Reads the text, which ends at its first zero byte and nests no deeper than `deepest`; `offset` is where in the
  /// file it begins. Errors: input, as `FILE:byte N: what`.
  static JsonView read(const FileView& file, std::string_view text, std::size_t offset, int deepest);

  /// The first member of that name of an object, or nullptr.
  const JsonView* find(std::string_view name) const;
  /// The n-th element of a list, or nullptr.
  const JsonView* at(std::uint64_t n) const { return n < elements_.size() ? &elements_[n] : nullptr; }
  const std::vector<JsonView>& elements() const { return elements_; }
  /// Of an object, in the file's order.
  const std::vector<std::pair<std::string_view, JsonView>>& members() const { return members_; }
  /// Of a string.
  std::string_view text() const { return text_; }
  /// A whole number from 0 to 2^32 - 1 written without fraction and exponent.
  std::optional<std::uint32_t> whole() const;

 private:
  class Reader;

  std::string_view text_;
  std::string_view word_;                                       // numbers and literals
  std::vector<JsonView> elements_;                              // of a list
  std::vector<std::pair<std::string_view, JsonView>> members_;  // of an object
};

}  // namespace difi
