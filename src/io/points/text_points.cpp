// SPDX-License-Identifier: Apache-2.0
// Points from tables in text: .csv, .tsv, .txt, .xyz, with or without names of columns.
#include <algorithm>
#include <array>
#include <limits>
#include <utility>
#include <vector>

#include "files/file_view.h"
#include "files/text.h"
#include "io/points/points.h"

namespace standoff {
namespace {

constexpr std::string_view kBlanks = " \t\v\f\r";

std::string_view stripped(std::string_view field) {
  field.remove_prefix(std::min(field.find_first_not_of(kBlanks), field.size()));
  field.remove_suffix(field.size() - (field.find_last_not_of(kBlanks) + 1));
  if (field.size() >= 2 && field.front() == '"' && field.back() == '"')
    return stripped(field.substr(1, field.size() - 2));
  return field;
}

// Returns the separator of fields: the first of these that the first line contains, or a blank.
char separator_of(std::string_view line) {
  for (const char c : {';', ',', '\t'})
    if (line.find(c) != std::string_view::npos) return c;
  return ' ';
}

// Reads the fields of a line, front to back. Several blanks separate as one does.
class Fields {
 public:
  Fields(std::string_view line, char separator) : line_(line), separator_(separator) { skip_blanks(); }

  bool next(std::string_view& field) {
    if (over_) return false;
    const std::size_t end = separator_ == ' ' ? line_.find_first_of(kBlanks) : line_.find(separator_);
    field = stripped(line_.substr(0, end));
    over_ = end == std::string_view::npos;
    if (!over_) line_.remove_prefix(end + 1);
    skip_blanks();
    return true;
  }

 private:
  void skip_blanks() {
    if (separator_ != ' ') return;
    line_.remove_prefix(std::min(line_.find_first_not_of(kBlanks), line_.size()));
    over_ |= line_.empty();
  }

  std::string_view line_;
  char separator_;
  bool over_ = false;
};

// The number in a field; NaN in an empty one, as programs write missing values.
std::optional<double> number_of(std::string_view field) {
  if (field.empty()) return std::numeric_limits<double>::quiet_NaN();
  if (field.starts_with('+') && !field.starts_with("+-")) field.remove_prefix(1);
  double value = 0;
  const auto [end, error] = std::from_chars(field.data(), field.data() + field.size(), value);
  if (error == std::errc::invalid_argument || end != field.data() + field.size()) return std::nullopt;
  return error == std::errc{} ? value : beyond_range(field);
}

// Whether a field is a number, or a damaged one: "1e5x", "0x10", a quote without its end before a digit. No name of a
// column begins so.
bool begins_like_number(std::string_view field) {
  if (!field.empty() && number_of(field)) return true;
  constexpr std::string_view kMinus = "\xe2\x88\x92";  // as text processors write it
  while (!field.empty()) {
    const char c = field.front();
    if (c >= '0' && c <= '9') return true;
    const bool letter = (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '_' || (c & 0x80) != 0;
    if (letter && !field.starts_with(kMinus)) return false;
    field.remove_prefix(letter ? kMinus.size() : 1);
  }
  return false;
}

class TextPoints : public PointReader {
 public:
  TextPoints(LineReader lines, InvalidPoints invalid) : lines_(std::move(lines)), invalid_(invalid) {}

  std::size_t read(std::span<Vec3> points) override {
    std::size_t n = 0;
    distances_.clear();
    for (std::string_view line; n < points.size() && lines_.next(line);) {
      if (!std::exchange(begun_, true) && begin(line)) continue;
      points[n] = point(line);
      if (!check_point(points[n], invalid_) && invalid_ == InvalidPoints::reject)
        lines_.fail(invalid_point(read_, points[n]));
      ++n;
      ++read_;
    }
    // Columns of other names are points if numbers stand below them; any text has a first line.
    if (n < points.size() && read_ == 0 && unknown_names_ > 0)
      lines_.fail_at(unknown_names_, "expected three numbers, or columns called x, y and z, found " +
                                         in_quotes(unknown_line_) + "; give a point on each line, as x,y,z");
    return n;
  }
  double fraction() const override { return lines_.fraction(); }

 private:
  // Of the first line: what parts its fields, and whether it names columns. A line with a number among its fields, or
  // with what may have been one, is a point, damaged or not: taken for names it would vanish, and all answers with it
  // would stand one line too high.
  bool begin(std::string_view line) {
    separator_ = separator_of(line);
    std::array<int, 3> named{-1, -1, -1};
    std::array<std::string_view, 3> first;
    Fields fields(line, separator_);
    int column = 0;
    for (std::string_view field; fields.next(field); ++column) {
      if (begins_like_number(field)) return false;
      if (column < 3) first[static_cast<std::size_t>(column)] = field;
      if (field == "distance") distance_ = column;
      for (std::size_t axis = 0; axis < 3; ++axis)
        if (field.size() == 1 && (field[0] | 0x20) == "xyz"[axis]) {
          if (named[axis] >= 0) lines_.fail("two columns called " + in_quotes(field) + "; rename one");
          named[axis] = column;
        }
    }
    const auto found = std::ranges::count_if(named, [](int c) { return c >= 0; });
    if (found == 1 || found == 2)
      lines_.fail("it names some of the columns x, y and z; name all three, or none of them");
    if (found == 3) {
      columns_ = named;
      return true;
    }
    // Three equal words are no heading: they may stand for missing values.
    const bool three_names = std::ranges::none_of(first, &std::string_view::empty) && first[0] != first[1] &&
                             first[0] != first[2] && first[1] != first[2];
    if (three_names) {
      unknown_names_ = lines_.number();
      unknown_line_ = line;
    }
    return three_names;
  }

  Vec3 point(std::string_view line) {
    std::array<double, 3> v{};
    Fields fields(line, separator_);
    const int last = std::max({columns_[0], columns_[1], columns_[2], distance_});
    const auto number = [&](std::string_view field) {
      const auto value = number_of(field);
      if (!value)
        lines_.fail("expected a number, found " + in_quotes(field) +
                    "; write numbers like 12 or -1.5e3, decimals with a point, between them " + separator_name() +
                    (read_ == 0 ? " (a line that names columns has no field that begins like a number)" : ""));
      return *value;
    };
    int column = 0;
    for (std::string_view field; column <= last && fields.next(field); ++column) {
      if (column == distance_) distances_.push_back(number(field));
      for (std::size_t axis = 0; axis < 3; ++axis)
        if (columns_[axis] == column) v[axis] = number(field);
    }
    if (column <= last)
      lines_.fail("it has " + std::to_string(column) + " of the " + std::to_string(last + 1) +
                  " numbers that a point needs; write x,y,z");
    return {v[0], v[1], v[2]};
  }

  const char* separator_name() const {
    return separator_ == ';' ? "semicolons" : separator_ == ',' ? "commas" : separator_ == '\t' ? "tabs" : "blanks";
  }

  LineReader lines_;
  InvalidPoints invalid_;
  bool begun_ = false;
  char separator_ = ',';
  std::array<int, 3> columns_{0, 1, 2};
  int distance_ = -1;  // the column of that name
  std::uint64_t read_ = 0;
  std::uint64_t unknown_names_ = 0;  // the line of names that are not x, y and z, if there is one
  std::string unknown_line_;
};

}  // namespace

std::unique_ptr<PointReader> text_points(LineReader lines, InvalidPoints invalid) {
  return std::make_unique<TextPoints>(std::move(lines), invalid);
}

}  // namespace standoff
