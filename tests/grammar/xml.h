// SPDX-License-Identifier: Apache-2.0
// XML to be written well or badly.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "tests/grammar/choices.h"

namespace standoff::grammar {

class Xml {
 public:
  explicit Xml(std::string name, std::vector<std::pair<std::string, std::string>> attributes = {})
      : name_(std::move(name)), attributes_(std::move(attributes)) {}

  Xml& set(const std::string& attribute, const std::string& value) {
    attributes_.emplace_back(attribute, value);
    return *this;
  }
  /// What stands in it before its children; spaces are added around and between the words.
  Xml& say(std::string text) {
    text_ = std::move(text);
    return *this;
  }
  Xml& add(Xml child) { return children_.emplace_back(std::move(child)); }
  const std::vector<Xml>& children() const { return children_; }

  /// The text; at tricks with tags left out, twice, unclosed or nested deep, attributes likewise, entities, sections.
  /// `comments` says whether there may be some between the tags.
  std::string text(Choices& c, bool comments) const;

 private:
  void write(Choices& c, bool comments, std::string& to) const;
  void write_attributes(Choices& c, std::string& to) const;

  std::string name_, text_;
  std::vector<std::pair<std::string, std::string>> attributes_;
  std::vector<Xml> children_;
};

}  // namespace standoff::grammar
