// SPDX-License-Identifier: Apache-2.0
#include "io/points/path_starts.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <utility>

#include "standoff/error.h"

namespace standoff {
namespace {

// Calls use(line) for each line of a text.
template <class Use>
void for_lines(std::string_view text, const Use& use) {
  while (!text.empty()) {
    const std::size_t end = std::min(text.find('\n'), text.size());
    use(text.substr(0, end));
    text.remove_prefix(std::min(end + 1, text.size()));
  }
}

std::vector<std::size_t> starts_of_ply(std::string_view text, std::size_t points) {
  std::vector<std::size_t> starts;
  std::vector<char> joined(points, 0);  // to the point before
  std::size_t row = 0, header_end = text.find("end_header");
  header_end = header_end == std::string::npos ? text.size() : std::min(text.find('\n', header_end), text.size());
  for_lines(text.substr(header_end), [&](std::string_view line) {
    if (line.empty()) return;
    if (row++ < points) return;
    std::array<std::size_t, 2> ends{};
    const char *at = line.data(), *const end = line.data() + line.size();
    at = std::from_chars(at, end, ends[0]).ptr;
    while (at != end && *at == ' ') ++at;
    std::from_chars(at, end, ends[1]);
    if (ends[1] == ends[0] + 1 && ends[1] < points) joined[ends[1]] = 1;
  });
  for (std::size_t n = 0; n < points; ++n)
    if (!joined[n]) starts.push_back(n);
  return starts;
}

std::vector<std::size_t> starts_of_table(std::string_view text) {
  std::vector<std::size_t> starts;
  std::size_t row = 0;
  std::string_view before;
  bool header = true;
  for_lines(text, [&](std::string_view line) {
    if (std::exchange(header, false) || line.empty()) return;
    const std::string_view flier = line.substr(0, line.find(','));
    if (row == 0 || flier != before) starts.push_back(row);
    before = flier;
    ++row;
  });
  return starts;
}

}  // namespace

bool is_path(std::string_view head) {
  const auto has = [&](std::string_view words) { return head.find(words) != std::string_view::npos; };
  if (head.starts_with("ply")) return has("element edge") && !has("element face");
  return head.starts_with("flier,step,");
}

std::vector<std::size_t> path_starts(const std::string& name, std::string_view text, std::size_t points) {
  if (!text.starts_with("ply")) return starts_of_table(text);
  if (text.substr(0, text.find("end_header")).find("format ascii") == std::string_view::npos)
    throw Error(ErrorCode::input,
                name + ": paths are read from PLY files of text only; write it as ASCII, or as CSV by standoff fly");
  return starts_of_ply(text, points);
}

}  // namespace standoff
