// SPDX-License-Identifier: Apache-2.0
// JSON to be written well or badly.
#pragma once

#include <cstdint>
#include <initializer_list>
#include <string>
#include <utility>
#include <vector>

#include "tests/grammar/choices.h"

namespace standoff::grammar {

class Json {
 public:
  enum class Kind { word, text, list, object };

  Json() : kind_(Kind::object) {}
  Json(const char* text) : kind_(Kind::text), word_(text) {}
  Json(const std::string& text) : kind_(Kind::text), word_(text) {}
  Json(std::uint64_t number) : kind_(Kind::word), word_(std::to_string(number)) {}
  Json(std::uint32_t number) : Json(std::uint64_t{number}) {}
  Json(int number) : kind_(Kind::word), word_(std::to_string(number)) {}
  /// A literal: null, true, 1e5.
  static Json literal(const std::string& word) { return {Kind::word, word}; }
  static Json list() { return {Kind::list, ""}; }

  /// The member of that name, made where it is not there.
  Json& operator[](const std::string& name);
  Json& push(Json value);
  std::size_t size() const { return items_.size(); }
  std::vector<Json>& items() { return items_; }

  /// The text; at tricks with values of another kind, members left out or twice, lists and objects nested deep.
  std::string text(Choices& c) const;

 private:
  Json(Kind kind, std::string word) : kind_(kind), word_(std::move(word)) {}
  void write(Choices& c, std::string& to) const;

  Kind kind_;
  std::string word_;
  std::vector<Json> items_;
  std::vector<std::string> names_;  // of an object's items
};

}  // namespace standoff::grammar
