// SPDX-License-Identifier: Apache-2.0
// Points from tables in text: .csv, .tsv, .txt, .xyz, with or without names of columns.
#include <algorithm>
#include <array>
#include <limits>
#include <vector>

#include "core/number_text.h"
#include "files/shown.h"
#include "files/text_cursor.h"
#include "io/points/format.h"
#include "standoff/error.h"

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

// What stands between two fields: the first of these that the first line contains, or blanks.
char separator_of(std::string_view line) {
  for (const char c : {';', ',', '\t'})
    if (line.find(c) != std::string_view::npos) return c;
  return ' ';
}

// The fields of a line, front to back. Many blanks part as one does.
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

class TextPoints : public PointReader {
 public:
  TextPoints(LineReader lines, InvalidPoints invalid) : lines_(std::move(lines)), invalid_(invalid) {}

  std::size_t read(std::span<Vec3> points) override {
    std::size_t n = 0;
    for (std::string_view line; n < points.size() && lines_.next(line);) {
      if (!begun_ && begin(line)) continue;
      points[n] = point(line);
      if (!check_point(points[n], invalid_) && invalid_ == InvalidPoints::reject)
        lines_.fail(invalid_point(read_, points[n]));
      ++n;
      ++read_;
    }
    if (n < points.size() && !begun_)
      throw Error(ErrorCode::input, lines_.name() + ": there is no point in it; give one on each line, as x,y,z",
                  {.file = lines_.name()});
    return n;
  }
  double fraction() const override { return lines_.fraction(); }

 private:
  // Of the first line: what parts its fields, and whether it names columns.
  bool begin(std::string_view line) {
    begun_ = true;
    separator_ = separator_of(line);
    std::array<int, 3> named{-1, -1, -1};
    bool names = false;
    Fields fields(line, separator_);
    int column = 0;
    for (std::string_view field; fields.next(field); ++column) {
      names |= column < 3 && !number_of(field);
      if (column < 3 && !number_of(field) && !field.empty() &&
          field.find_first_not_of("0123456789.,+-eE") == std::string_view::npos)
        lines_.fail("expected a number or a column's name, found " + in_quotes(field) +
                    "; write decimals with a point, and commas, semicolons, tabs or blanks between numbers");
      for (std::size_t axis = 0; axis < 3; ++axis)
        if (field.size() == 1 && (field[0] | 0x20) == "xyz"[axis]) {
          if (named[axis] >= 0) lines_.fail("two columns called " + in_quotes(field) + "; rename one");
          named[axis] = column;
        }
    }
    const auto found = std::ranges::count_if(named, [](int c) { return c >= 0; });
    if (found == 3) columns_ = named;
    if (found == 1 || found == 2)
      lines_.fail("it names some of the columns x, y and z; name all three, or none of them");
    return names || found == 3;
  }

  Vec3 point(std::string_view line) {
    std::array<double, 3> v{};
    Fields fields(line, separator_);
    const int last = std::max({columns_[0], columns_[1], columns_[2]});
    int column = 0;
    for (std::string_view field; column <= last && fields.next(field); ++column)
      for (std::size_t axis = 0; axis < 3; ++axis)
        if (columns_[axis] == column) {
          const auto value = number_of(field);
          if (!value)
            lines_.fail("expected a number, found " + in_quotes(field) +
                        "; write numbers like 12 or -1.5e3, decimals with a point, between them " + separator_name());
          v[axis] = *value;
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
  std::uint64_t read_ = 0;
};

}  // namespace

std::unique_ptr<PointReader> text_points(LineReader lines, InvalidPoints invalid) {
  return std::make_unique<TextPoints>(std::move(lines), invalid);
}

}  // namespace standoff
