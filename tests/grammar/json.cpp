// SPDX-License-Identifier: Apache-2.0
#include "tests/grammar/json.h"

#include <algorithm>
#include <cstdio>

#include "tests/grammar/hostile.h"

namespace standoff::grammar {
namespace {

std::string quoted(Choices& c, const std::string& text) {
  std::string to = "\"";
  for (const char letter : word(c, text)) {
    // A quote that is not escaped ends the text early: at a trick alone does one stand in it.
    if ((letter == '"' || letter == '\\') && !c.trick()) to += '\\';
    if (c.trick()) {
      char escape[8];
      std::snprintf(escape, sizeof escape, "\\u%04x",
                    static_cast<unsigned>(c.one_in(2) ? letter & 0xff : c.below(65536)));
      to += escape;
    } else {
      to += letter;
    }
  }
  return to + '"';
}

std::string space(Choices& c) {
  constexpr const char* kSpaces[] = {"", "", "", "", " ", "\n", "\r\n\t", "  "};
  return c.pick(kSpaces);
}

// Something else in the place of a value.
std::string wrong_value(Choices& c) {
  constexpr const char* kOthers[] = {"null",      "true",   "{}", "[]",  "[0]", "\"0\"",
                                     "{\"a\":1}", "[[[]]]", "-0", "1.0", "1e2", "/*c*/1"};
  switch (c.below(4)) {
    case 0: {
      const std::uint32_t deep = c.many();
      const bool list = c.one_in(2);
      std::string text;
      for (std::uint32_t n = 0; n < deep; ++n) text += list ? "[" : "{\"a\":";
      text += "0";
      return c.one_in(2) ? text : text + std::string(deep, list ? ']' : '}');
    }
    case 1: {
      std::string text = "[0";
      for (std::uint32_t n = c.many(); n > 0; --n) text += c.one_in(2) ? ",0" : ",[]";
      return text + "]";
    }
    case 2:
      return bad_number(c);
    default:
      return c.pick(kOthers);
  }
}

}  // namespace

Json& Json::operator[](const std::string& name) {
  const auto found = std::ranges::find(names_, name);
  if (found != names_.end()) return items_[static_cast<std::size_t>(found - names_.begin())];
  names_.push_back(name);
  return items_.emplace_back();
}

Json& Json::push(Json value) { return items_.emplace_back(std::move(value)); }

std::string Json::text(Choices& c) const {
  std::string to = space(c);
  write(c, to);
  return to + space(c);
}

void Json::write(Choices& c, std::string& to) const {
  if (c.trick()) {
    to += wrong_value(c);
    return;
  }
  switch (kind_) {
    case Kind::word:
      to += word_;
      return;
    case Kind::text:
      to += quoted(c, word_);
      return;
    case Kind::list:
    case Kind::object:
      break;
  }
  const bool object = kind_ == Kind::object, backwards = object && c.one_in(4);
  to += object ? '{' : '[';
  bool first = true;
  for (std::size_t n = 0; n < items_.size(); ++n) {
    if (c.trick()) continue;
    const std::size_t at = backwards ? items_.size() - 1 - n : n;
    for (int times = c.trick() ? 2 : 1; times > 0; --times) {
      if (!first) to += "," + space(c);
      first = false;
      if (object) to += quoted(c, names_[at]) + ":" + space(c);
      items_[at].write(c, to);
    }
  }
  to += space(c) + (object ? '}' : ']');
}

}  // namespace standoff::grammar
