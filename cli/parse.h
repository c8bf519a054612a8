// SPDX-License-Identifier: Apache-2.0
// Option values from text. Every function throws Error{usage} as `OPTION 'TEXT': what; what to give`.
#pragma once

#include <cstdint>
#include <limits>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "standoff/axis.h"
#include "standoff/colormap.h"
#include "standoff/compute.h"
#include "standoff/pose.h"
#include "standoff/vec.h"

namespace standoff::cli {

/// A band's half-width, as it was given: in world units, or in samples until the grid is known.
struct Thickness {
  double value;
  bool in_samples = false;

  bool infinite() const;
  /// In world units, one sample being `spacing` long.
  double world(double spacing) const { return in_samples ? value * spacing : value; }
};

/// A finite number.
double parse_number(const std::string& option, const std::string& text);

/// A finite number above zero.
double parse_positive(const std::string& option, const std::string& text,
                      double most = std::numeric_limits<double>::max());
/// A finite number, zero or above.
double parse_not_negative(const std::string& option, const std::string& text,
                          double most = std::numeric_limits<double>::max());
/// Degrees in [0, most].
double parse_degrees(const std::string& option, const std::string& text, double most);
/// A whole number in [least, most].
std::int64_t parse_count(const std::string& option, const std::string& text, std::int64_t least, std::int64_t most);
/// One positive number for all axes, or three.
Vec3 parse_spacing(const std::string& option, const std::string& text);
/// NX,NY,NZ.
Size3 parse_size(const std::string& option, const std::string& text);
/// The first sample of a window and its samples per axis.
struct WindowText {
  Size3 first, size;
};
WindowText parse_window(const std::string& option, const std::string& text);
/// x0,y0,z0,x1,y1,z1 with x0 <= x1 and so on.
Box parse_bounds(const std::string& option, const std::string& text);
/// "0.5" (world units), "3s" (samples), "inf".
Thickness parse_thickness(const std::string& option, const std::string& text);
/// Bytes, with K, M, G or T for powers of 1024; or "none": kNoMemoryLimit.
std::int64_t parse_bytes(const std::string& option, const std::string& text);
/// none, neighbour, neighbour:F, exact.
SkipRule parse_skip(const std::string& option, const std::string& text);
Method parse_method(const std::string& option, const std::string& text);
/// A method of signs, with the thickness of the solid for shell.
struct SignChoice {
  SignMethod method = SignMethod::none;
  Thickness shell{0};
};
/// A name of kSignMethods; shell:T, where T is world units or samples, as for parse_thickness.
SignChoice parse_sign(const std::string& option, const std::string& text);
WindingRule parse_winding_rule(const std::string& option, const std::string& text);
/// auto, cpu, cuda, cuda:N,N... or emulated; the numbers are the result, the name goes to `backend`.
std::vector<int> parse_devices(const std::string& option, const std::string& text, Backend& backend);
/// The same with one number at the most, which goes to `device`.
Backend parse_backend(const std::string& option, const std::string& text, int& device);
/// Metres per mm, cm, m, in, ft or km.
double parse_unit(const std::string& option, const std::string& text);

/// x,y,z (moved), x,y,z,ax,ay,az,degrees (turned about an axis, then moved), or twelve numbers: a 3x4 matrix row by
/// row.
Pose parse_pose(const std::string& option, const std::string& text);

/// The same for text that is no option's. Errors: usage, as `what; what to give`.
Pose pose_of(std::span<const double> numbers);
/// A number from 0 to 1.
double parse_share(const std::string& option, const std::string& text);
/// x, y or z.
Axis parse_axis(const std::string& option, const std::string& text);
/// The same for --up; nothing for auto.
std::optional<Axis> parse_up(const std::string& option, const std::string& text);
/// auto, diverging, viridis or thesis.
Colormap parse_colormap(const std::string& option, const std::string& text);

/// Finite numbers with commas between them, and blanks around them. Errors: usage, as above.
std::vector<double> numbers_in(std::string_view text);
/// The numbers of a screw: a point, an axis, degrees and the way along the axis, which is 0 if it is left out.
std::vector<double> parse_screw(const std::string& option, const std::string& text);
/// Three numbers: x,y,z, none past kMaxPosition.
Vec3 parse_point(const std::string& option, const std::string& text);

/// The index of `text` among `choices`.
std::size_t parse_choice(const std::string& option, const std::string& text, const std::vector<std::string>& choices);

}  // namespace standoff::cli
