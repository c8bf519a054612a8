// SPDX-License-Identifier: Apache-2.0
#include "question.h"

#include <cmath>
#include <cstdlib>
#include <map>
#include <sstream>
#include <stdexcept>
#include <vector>

namespace standoff::bench {
namespace {

[[noreturn]] void fail(const std::string& what, const std::string& text) {
  throw std::invalid_argument(what + ": " + text);
}

double number(const std::string& digits, const std::string& text) {
  char* end = nullptr;
  const double value = std::strtod(digits.c_str(), &end);
  if (digits.empty() || *end != 0 || !std::isfinite(value)) fail("not a number", text);
  return value;
}

void read_word(Question& question, const std::string& word, const std::string& text) {
  const std::size_t equals = word.find('=');
  const std::string key = word.substr(0, equals);
  const double value = number(word.substr(equals + 1), text);
  const auto set = [&](auto& into, bool allowed) {
    if (!allowed) fail("out of range", text);
    if (into) fail("said twice", text);
    into = value;
  };
  if (key == "gap")
    set(question.gap, value > 0);
  else if (key == "depth")
    set(question.depth, value > 0);
  else if (key == "turn")
    set(question.turn_degrees, value >= 0 && value <= 180);
  else if (key == "hits")
    set(question.hits, value >= 0 && value <= 1);
  else if (key == "spin")
    set(question.spin_degrees, value >= 0 && value <= 180);
  else if (key == "dx" || key == "dy" || key == "dz")
    set(key == "dx" ? question.dx : key == "dy" ? question.dy : question.dz, value >= 0);
  else if (key == "way")
    set(question.way, value >= 0);
  else if (key == "rotate")
    set(question.rotate_degrees, value >= 0 && value <= 180);
  else if (key == "poses")
    set(question.poses, value >= 1 && value <= 1e9 && value == std::floor(value));
  else
    fail("no such key", text);
  if (key != "poses" && key != "way" && key != "rotate")
    question.placing += (question.placing.empty() ? "" : ",") + word;
}

}  // namespace

Question parse_question(const std::string& text) {
  static const std::map<std::string, Query> queries{{"collide", Query::collide},
                                                    {"contacts", Query::contacts},
                                                    {"all_contacts", Query::all_contacts},
                                                    {"distance", Query::distance},
                                                    {"sweep", Query::sweep}};
  const std::size_t at = text.find('@');
  const auto query = queries.find(text.substr(0, at));
  if (query == queries.end()) fail("no such query", text);
  Question question{query->second, query->first};
  if (at == std::string::npos) return question;
  std::istringstream words(text.substr(at + 1) + ',');
  std::vector<double> place;
  for (std::string word; std::getline(words, word, ',');)
    if (word.find('=') == std::string::npos)
      place.push_back(number(word, text));
    else
      read_word(question, word, text);
  if (place.size() == 3)
    question.place = Vec3{place[0], place[1], place[2]};
  else if (!place.empty())
    fail("not three numbers", text);
  if (question.place.has_value() + question.gap.has_value() + question.depth.has_value() +
          question.turn_degrees.has_value() + question.hits.has_value() + question.spin_degrees.has_value() >
      1)
    fail("more than one of X,Y,Z, gap, depth, turn, hits and spin", text);
  if ((question.dx || question.dy || question.dz) && !question.spin_degrees) fail("dx, dy and dz need spin", text);
  return question;
}

}  // namespace standoff::bench
