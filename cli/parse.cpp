// SPDX-License-Identifier: Apache-2.0
#include "cli/parse.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <numbers>
#include <optional>

#include "cli/text.h"
#include "standoff/error.h"

namespace standoff::cli {
namespace {

[[noreturn]] void reject(const std::string& option, const std::string& text, const std::string& why) {
  throw Error(ErrorCode::usage, option + " '" + text + "': " + why);
}

// from_chars knows no plus sign.
std::string_view without_plus(std::string_view text) {
  return text.starts_with('+') && !text.starts_with("+-") ? text.substr(1) : text;
}

template <class T>
std::optional<T> whole_text(std::string_view text) {
  text = without_plus(text);
  T value{};
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc{} || end != text.data() + text.size()) return {};
  return value;
}

std::vector<std::string> parts(const std::string& text) {
  std::vector<std::string> found(1);
  for (const char c : text)
    if (c == ',')
      found.emplace_back();
    else
      found.back() += c;
  return found;
}

// What `read` makes of the text; what it has against it is told with the option's name.
template <class Read>
auto read_or_reject(const std::string& option, const std::string& text, Read read) {
  try {
    return read();
  } catch (const Error& error) {
    reject(option, text, error.what());
  }
}

std::vector<double> parse_numbers(const std::string& option, const std::string& text) {
  return read_or_reject(option, text, [&] { return numbers_in(text); });
}

// Why a text is no finite number, in the words of an error.
std::string no_number(std::string_view text) {
  text = without_plus(text);
  double value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  const bool whole = end == text.data() + text.size();
  return whole && error == std::errc::result_out_of_range ? "out of the range of numbers" : "not a number";
}

// World units, or samples with an s.
std::optional<Thickness> finite_thickness(std::string_view text) {
  const bool in_samples = text.ends_with('s');
  const auto value = whole_text<double>(in_samples ? text.substr(0, text.size() - 1) : text);
  if (!value || !std::isfinite(*value)) return {};
  return Thickness{*value, in_samples};
}

// The axis stands behind the first three numbers.
void expect_axis(std::span<const double> v) {
  if (v[3] == 0 && v[4] == 0 && v[5] == 0)
    throw Error(ErrorCode::usage, "the axis has no direction; one of its numbers must not be zero");
}

double at_most(const std::string& option, const std::string& text, double value, double most) {
  if (value > most) reject(option, text, "must be at most " + number(most));
  return value;
}

}  // namespace

bool Thickness::infinite() const { return std::isinf(value); }

double parse_number(const std::string& option, const std::string& text) {
  const auto value = whole_text<double>(text);
  if (!value || !std::isfinite(*value)) reject(option, text, no_number(text) + "; give one such as 0.5 or 1e-3");
  return *value;
}

double parse_positive(const std::string& option, const std::string& text, double most) {
  const double value = parse_number(option, text);
  if (!(value > 0)) reject(option, text, "must be above zero");
  return at_most(option, text, value, most);
}

double parse_not_negative(const std::string& option, const std::string& text, double most) {
  const double value = parse_number(option, text);
  if (!(value >= 0)) reject(option, text, "must be zero or more");
  return at_most(option, text, value, most);
}

double parse_degrees(const std::string& option, const std::string& text, double most) {
  const double value = parse_number(option, text);
  if (!(value >= 0 && value <= most)) reject(option, text, "give degrees from 0 to " + number(most));
  return value;
}

std::int64_t parse_count(const std::string& option, const std::string& text, std::int64_t least, std::int64_t most) {
  const auto value = whole_text<std::int64_t>(text);
  if (!value || *value < least || *value > most)
    reject(option, text, "give a whole number from " + grouped(least) + " to " + grouped(most));
  return *value;
}

Vec3 parse_spacing(const std::string& option, const std::string& text) {
  const auto v = parse_numbers(option, text);
  if (v.size() != 1 && v.size() != 3) reject(option, text, "give one number, or three: x,y,z");
  for (const double spacing : v)
    if (!(spacing > 0)) reject(option, text, "must be above zero");
  return v.size() == 1 ? Vec3{v[0], v[0], v[0]} : Vec3{v[0], v[1], v[2]};
}

Size3 parse_size(const std::string& option, const std::string& text) {
  const auto v = parts(text);
  if (v.size() != 3) reject(option, text, "give three whole numbers, the samples along x,y,z");
  const auto count = [&](const std::string& part) { return parse_count(option, part, 1, std::int64_t{1} << 40); };
  return {count(v[0]), count(v[1]), count(v[2])};
}

WindowText parse_window(const std::string& option, const std::string& text) {
  const auto v = parts(text);
  if (v.size() != 6)
    reject(option, text, "give six whole numbers, the first sample along x,y,z and the samples: I,J,K,NX,NY,NZ");
  const auto number = [&](std::size_t n) {
    constexpr std::array kNames{"I", "J", "K", "NX", "NY", "NZ"};
    constexpr std::int64_t kMost = std::int64_t{1} << 40;
    const std::int64_t least = n < 3 ? 0 : 1;
    const auto value = whole_text<std::int64_t>(v[n]);
    if (!value || *value < least || *value > kMost)
      reject(option, text,
             std::string(kNames[n]) + ", " + (n < 3 ? "the first sample" : "the samples") + " along " + "xyz"[n % 3] +
                 ", is '" + v[n] + "'; give a whole number from " + grouped(least) + " to " + grouped(kMost));
    return *value;
  };
  return {{number(0), number(1), number(2)}, {number(3), number(4), number(5)}};
}

Box parse_bounds(const std::string& option, const std::string& text) {
  const auto v = parse_numbers(option, text);
  if (v.size() != 6) reject(option, text, "give six numbers: x0,y0,z0,x1,y1,z1");
  const Box box{{v[0], v[1], v[2]}, {v[3], v[4], v[5]}};
  if (box.empty()) reject(option, text, "the first corner must not exceed the second on any axis");
  return box;
}

Thickness parse_thickness(const std::string& option, const std::string& text) {
  if (text == "inf" || text == "infinite") return {std::numeric_limits<double>::infinity()};
  const auto thickness = finite_thickness(text);
  if (!thickness) reject(option, text, "give world units (0.5), samples (3s), or inf for a full field");
  if (!(thickness->value > 0)) reject(option, text, "the thickness must be above zero; inf gives a full field");
  return *thickness;
}

std::int64_t parse_bytes(const std::string& option, const std::string& text) {
  if (text == "none") return kNoMemoryLimit;
  std::string digits = text;
  for (const std::string_view ending : {"iB", "B"})
    if (digits.ends_with(ending)) {
      digits.erase(digits.size() - ending.size());
      break;
    }
  double unit = 1;
  const std::string_view units = "KMGT";
  if (!digits.empty())
    if (const auto at = units.find(static_cast<char>(std::toupper(static_cast<unsigned char>(digits.back()))));
        at != std::string_view::npos) {
      unit = std::exp2(10.0 * static_cast<double>(at + 1));
      digits.pop_back();
    }
  const auto value = whole_text<double>(digits);
  if (!value || !(*value * unit >= 1 && *value * unit < 0x1p62))
    reject(option, text, "give a size such as 500M or 8G, or none");
  return static_cast<std::int64_t>(*value * unit);
}

std::size_t parse_choice(const std::string& option, const std::string& text, const std::vector<std::string>& choices) {
  std::string known;
  for (std::size_t n = 0; n < choices.size(); ++n) {
    if (choices[n] == text) return n;
    known += (n == 0 ? "" : n + 1 == choices.size() ? " or " : ", ") + choices[n];
  }
  reject(option, text, "give " + known);
}

SkipRule parse_skip(const std::string& option, const std::string& text) {
  const auto colon = text.find(':');
  const auto kind = parse_choice(option, text.substr(0, colon), {"none", "neighbour", "exact"});
  constexpr SkipRule::Kind kinds[] = {SkipRule::Kind::none, SkipRule::Kind::neighbour, SkipRule::Kind::exact};
  if (colon == std::string::npos) return {kinds[kind]};
  if (kinds[kind] != SkipRule::Kind::neighbour) reject(option, text, "only neighbour takes a fraction");
  const auto fraction = whole_text<double>(std::string_view(text).substr(colon + 1));
  if (!fraction || !(*fraction > 0 && *fraction <= 1))
    reject(option, text, "the fraction must be above 0 and at most 1");
  return {kinds[kind], *fraction};
}

namespace {

// The row that `text` names, of a table of what the library has.
template <class Info, std::size_t kCount>
const Info& parse_row(const std::string& option, const std::string& text, const Info (&rows)[kCount]) {
  std::vector<std::string> names;
  for (const Info& info : rows) names.emplace_back(info.name);
  return rows[parse_choice(option, text, names)];
}

}  // namespace

Method parse_method(const std::string& option, const std::string& text) {
  return parse_row(option, text, kComputeMethods).method;
}

SignChoice parse_sign(const std::string& option, const std::string& text) {
  const auto colon = text.find(':');
  const SignMethod method = parse_row(option, text.substr(0, colon), kSignMethods).method;
  const bool has_value = colon != std::string::npos;
  if (method != SignMethod::shell) {
    if (has_value) reject(option, text, "only shell takes a value, its thickness");
    return {method};
  }
  const auto shell = has_value ? finite_thickness(std::string_view(text).substr(colon + 1)) : std::nullopt;
  if (!shell || !(shell->value > 0))
    reject(option, text, "give a thickness above zero, as in shell:0.5 (world units) or shell:3s (samples)");
  return {method, *shell};
}

WindingRule parse_winding_rule(const std::string& option, const std::string& text) {
  constexpr WindingRule rules[] = {WindingRule::positive, WindingRule::nonzero, WindingRule::odd};
  return rules[parse_choice(option, text, {"positive", "nonzero", "odd"})];
}

std::vector<int> parse_devices(const std::string& option, const std::string& text, Backend& backend) {
  const auto colon = text.find(':');
  const BackendInfo& info = parse_row(option, text.substr(0, colon), kBackends);
  backend = info.backend;
  std::vector<int> devices;
  if (colon == std::string::npos) return devices;
  if (!info.has_devices) reject(option, text, "only a GPU takes a number, as in cuda:1");
  for (const std::string& part : parts(text.substr(colon + 1))) {
    const auto number = whole_text<int>(part);
    if (!number || *number < 0) reject(option, text, "give the number of a GPU, from 0 on; see `standoff devices`");
    devices.push_back(*number);
  }
  return devices;
}

Backend parse_backend(const std::string& option, const std::string& text, int& device) {
  Backend backend{};
  const std::vector<int> devices = parse_devices(option, text, backend);
  if (devices.size() > 1) reject(option, text, "give one GPU here; `standoff compute` takes several");
  if (!devices.empty()) device = devices[0];
  return backend;
}

double parse_unit(const std::string& option, const std::string& text) {
  constexpr double metres[] = {0.001, 0.01, 1, 0.0254, 0.3048, 1000};
  return metres[parse_choice(option, text, {"mm", "cm", "m", "in", "ft", "km"})];
}

Vec3 parse_point(const std::string& option, const std::string& text) {
  const auto v = parse_numbers(option, text);
  if (v.size() != 3) reject(option, text, "give three numbers: x,y,z");
  for (const double c : v)
    if (std::abs(c) > kMaxPosition)
      reject(option, text, "a number past " + number(kMaxPosition) + "; give a point of the body");
  return {v[0], v[1], v[2]};
}

double parse_share(const std::string& option, const std::string& text) {
  const double share = parse_number(option, text);
  if (!(share >= 0 && share <= 1)) throw Error(ErrorCode::usage, option + " '" + text + "': give a number from 0 to 1");
  return share;
}

Axis parse_axis(const std::string& option, const std::string& text) {
  return static_cast<Axis>(parse_choice(option, text, {"x", "y", "z"}));
}

std::optional<Axis> parse_up(const std::string& option, const std::string& text) {
  const std::size_t choice = parse_choice(option, text, {"x", "y", "z", "auto"});
  return choice < 3 ? std::optional(static_cast<Axis>(choice)) : std::nullopt;
}

Colormap parse_colormap(const std::string& option, const std::string& text) {
  constexpr Colormap maps[] = {Colormap::automatic, Colormap::diverging, Colormap::viridis, Colormap::thesis};
  return maps[parse_choice(option, text, {"auto", "diverging", "viridis", "thesis"})];
}

std::vector<double> parse_screw(const std::string& option, const std::string& text) {
  return read_or_reject(option, text, [&] {
    std::vector<double> numbers = numbers_in(text);
    if (numbers.size() == 7) numbers.push_back(0);
    if (numbers.size() != 8) throw Error(ErrorCode::usage, "give seven numbers or eight: x,y,z,ax,ay,az,degrees,along");
    expect_axis(numbers);
    return numbers;
  });
}

Pose parse_pose(const std::string& option, const std::string& text) {
  return read_or_reject(option, text, [&] { return pose_of(numbers_in(text)); });
}

Pose pose_of(std::span<const double> v) {
  Pose pose;
  if (v.size() == 3) {
    pose.translation = {v[0], v[1], v[2]};
  } else if (v.size() == 7) {
    expect_axis(v);
    pose = make_pose({v[3], v[4], v[5]}, std::fmod(v[6], 360) * std::numbers::pi / 180, {v[0], v[1], v[2]});
  } else if (v.size() == 12) {
    for (std::size_t n = 0; n < 9; ++n) pose.rotation[n] = v[n / 3 * 4 + n % 3];
    pose.translation = {v[3], v[7], v[11]};
  } else {
    throw Error(ErrorCode::usage,
                "give x,y,z; or x,y,z,ax,ay,az,degrees; or the twelve numbers of a 3x4 matrix, row by row");
  }
  validate(pose);
  return pose;
}

std::vector<double> numbers_in(std::string_view text) {
  std::vector<double> numbers;
  for (std::size_t from = 0; from <= text.size();) {
    const std::size_t comma = std::min(text.find(',', from), text.size());
    std::string_view part = text.substr(from, comma - from);
    part.remove_prefix(std::min(part.find_first_not_of(" \t"), part.size()));
    part.remove_suffix(part.size() - (part.find_last_not_of(" \t") + 1));
    const auto value = whole_text<double>(part);
    if (!value || !std::isfinite(*value))
      throw Error(ErrorCode::usage,
                  "'" + beginning(part, 40) + "' is " + no_number(part) + "; separate numbers by commas");
    numbers.push_back(*value);
    from = comma + 1;
  }
  return numbers;
}

}  // namespace standoff::cli
