// SPDX-License-Identifier: Apache-2.0
// JSON that points into the text: nothing is copied, nothing is kept beside the file.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "files/file_view.h"

namespace standoff {

/// A value. Every question goes through its text again: ask for a list or an object once, and keep what is in it.
class JsonView {
 public:
  enum class Kind { object, list, string, number, literal };

  /// Checks the text, which may begin with a byte order mark, ends at its first zero byte and nests no deeper than
  /// `deepest`. It must lie in the file's bytes. Errors: input, as `FILE:byte N: what`.
  static JsonView read(const FileView& file, std::string_view text, int deepest);

  Kind kind() const;
  /// Calls visit(std::string name, JsonView value) for each member of an object, in the file's order.
  /// Errors: input, where this is no object.
  template <class Visit>
  void each_member(Visit visit) const {
    expect(Kind::object, "an object");
    for (Walk walk(*this); walk.next();) {
      std::string name = walk.value().text();
      walk.next();
      visit(std::move(name), walk.value());
    }
  }
  /// Calls visit(JsonView) for each element of a list. Errors: input, where this is no list.
  template <class Visit>
  void each_element(Visit visit) const {
    expect(Kind::list, "a list");
    for (Walk walk(*this); walk.next();) visit(walk.value());
  }
  /// How many members or elements. Errors: input, where this is neither an object nor a list.
  std::size_t size() const;

  /// The member of that name. Errors: input, where this is no object, or two members have that name.
  std::optional<JsonView> find(std::string_view name) const;
  /// Of a string, its escapes as the characters they stand for, in UTF-8. Errors: input.
  std::string text() const;
  /// A whole number from 0 to 2^53 written without fraction and exponent. Errors: input.
  std::uint64_t whole() const;
  /// Errors: input, for what is no number; too large a one is infinite.
  double number() const;
  /// Errors: input, for what is neither true nor false.
  bool boolean() const;

  /// Throws with the byte at which the value begins.
  [[noreturn]] void fail(const std::string& what) const;

 private:
  class Checker;
  // Goes through the values of a list or an object, and through its names as through values.
  class Walk {
   public:
    explicit Walk(const JsonView& parent) : file_(parent.file_), rest_(parent.text_.substr(1)) {}
    bool next();
    JsonView value() const { return {*file_, value_}; }

   private:
    const FileView* file_;
    std::string_view rest_, value_;
  };

  JsonView(const FileView& file, std::string_view text) : file_(&file), text_(text) {}
  void expect(Kind kind, const char* name) const;

  const FileView* file_;
  std::string_view text_;  // from its first character to its last
};

}  // namespace standoff
