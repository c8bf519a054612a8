// SPDX-License-Identifier: Apache-2.0
#include "cli/suggest.h"

#include <algorithm>
#include <numeric>
#include <utility>

#include "cli/text.h"

namespace standoff::cli {
namespace {

constexpr std::size_t kMostNames = 3;        // more would be a list, and lists stand in the help
constexpr std::size_t kFewestLetters = 2;    // one letter begins too many words
constexpr std::size_t kLongestWord = 1'000;  // longer ones are no typos, and the table below grows with the square

char small(char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c; }

std::string letters(std::string_view word) {
  word.remove_prefix(std::min(word.find_first_not_of('-'), word.size()));
  std::string found(word);
  std::ranges::transform(found, found.begin(), small);
  return found;
}

}  // namespace

std::size_t edits(std::string_view a, std::string_view b) {
  // Rows of the table of distances between the beginnings of a and b: of i - 2, i - 1 and i letters of a.
  std::vector<std::size_t> before_last(b.size() + 1), last(b.size() + 1), row(b.size() + 1);
  std::iota(row.begin(), row.end(), std::size_t{0});
  for (std::size_t i = 1; i <= a.size(); ++i) {
    before_last = std::exchange(last, row);
    row[0] = i;
    for (std::size_t j = 1; j <= b.size(); ++j) {
      const char x = small(a[i - 1]), y = small(b[j - 1]);
      row[j] = std::min({last[j] + 1, row[j - 1] + 1, last[j - 1] + (x != y)});
      if (i > 1 && j > 1 && x == small(b[j - 2]) && small(a[i - 2]) == y)
        row[j] = std::min(row[j], before_last[j - 2] + 1);
    }
  }
  return row.back();
}

std::vector<std::size_t> meant(std::string_view written, const std::vector<std::string>& words) {
  const std::string word = letters(written);
  if (word.size() < kFewestLetters || word.size() > kLongestWord) return {};
  struct Near {
    std::size_t steps, index;
  };
  std::vector<Near> found;
  for (std::size_t n = 0; n < words.size(); ++n) {
    const std::string known = letters(words[n]);
    const std::size_t most = word.size() / 3;
    const bool too_long = known.size() > word.size() + most || word.size() > known.size() + most;
    const std::size_t steps = too_long ? most + 1 : edits(word, known);
    if (steps <= most || known.starts_with(word)) found.push_back({steps, n});
  }
  std::ranges::stable_sort(found, {}, &Near::steps);
  // A typo with one explanation needs no second one that is farther.
  if (!found.empty() && found.front().steps <= word.size() / 3)
    std::erase_if(found, [least = found.front().steps](const Near& near) { return near.steps > least; });
  if (found.size() > kMostNames) return {};
  std::vector<std::size_t> indices;
  for (const Near& near : found) indices.push_back(near.index);
  return indices;
}

std::string did_you_mean(const std::vector<std::string>& names) {
  if (names.empty()) return "";
  std::vector<std::string> quoted;
  for (const std::string& name : names) quoted.push_back("'" + name + "'");
  return "; did you mean " + joined(quoted) + "?";
}

std::string did_you_mean(std::string_view written, const std::vector<std::string>& words) {
  std::vector<std::string> names;
  for (const std::size_t index : meant(written, words)) names.push_back(words[index]);
  return did_you_mean(names);
}

}  // namespace standoff::cli
