// SPDX-License-Identifier: Apache-2.0
#include "cli/grid_options.h"

#include <algorithm>
#include <cmath>

#include "cli/options.h"
#include "cli/text.h"
#include "standoff/error.h"
#include "standoff/thesis.h"

namespace standoff::cli {
namespace {

// A wide band is not followed farther than this share of the mesh's longest side, or few samples are left for the mesh.
constexpr double kMostPadding = 0.1;

}  // namespace

void GridOptions::add_to(CLI::App& verb) {
  add_without_thickness_to(verb);
  add_parsed(verb,
             {"-t,--thickness", "T",
              "half-width of the band: world units (0.5), samples (3s),\nor inf for every sample (default)", "Grid"},
             [this](const std::string& o, const std::string& t) { thickness_ = parse_thickness(o, t); });
}

void GridOptions::add_without_thickness_to(CLI::App& verb) {
  const auto add = [&verb](const char* name, const char* value, const char* help, auto set) {
    return add_parsed(verb, {name, value, help, "Grid"}, set);
  };
  const std::string default_samples = "samples on the longest side (default " + std::to_string(samples_) + ")";
  auto* samples = add("-r,--resolution", "N", default_samples.c_str(), [this](S o, S t) {
    samples_ = parse_count(o, t, 2, std::int64_t{1} << 40);
    samples_given_ = true;
  });
  auto* spacing = add("--spacing", "S[,S,S]", "distance between samples, one or per axis",
                      [this](S o, S t) { spacing_ = parse_spacing(o, t); });
  auto* size = add("--size", "NX,NY,NZ", "samples per axis; the spacing may then differ per axis",
                   [this](S o, S t) { size_ = parse_size(o, t); });
  auto* bounds = add("--bounds", "x0,..,z1", "cover this box (x0,y0,z0,x1,y1,z1) and not the mesh's",
                     [this](S o, S t) { bounds_ = parse_bounds(o, t); });
  auto* padding = add("--padding", "N",
                      "samples around the mesh (default: 2 for a full field; for a\nband its thickness, from 2 to a "
                      "tenth of the longest side)",
                      [this](S o, S t) {
                        padding_ = parse_number(o, t);
                        if (!(*padding_ >= 0))
                          throw Error(ErrorCode::usage, "--padding '" + t + "': give zero or more");
                      });
  spacing->excludes(samples);
  size->excludes(samples)->excludes(spacing);
  bounds->excludes(padding);
}

void GridOptions::add_thesis_to(CLI::App& verb) {
  auto* minimum =
      add_parsed(verb,
                 {"--minimum", "E", "the smallest grid for collision: E samples per thickness\n(2 to 4 in the thesis)",
                  kThesisGroup},
                 [this](S o, S t) { minimum_ = parse_number(o, t); });
  add_parsed(verb, {"--speed", "V", "with --minimum: how far a body moves in one step", kThesisGroup},
             [this](S o, S t) { speed_ = parse_number(o, t); })
      ->needs(minimum);
  for (const char* name : {"--resolution", "--spacing", "--size", "--bounds", "--padding"})
    minimum->excludes(verb.get_option(name));
  minimum->needs(verb.get_option("--thickness"));
}

Padding GridOptions::padding() const {
  if (bounds_) return {.least_samples = 0};
  if (padding_) {
    const auto leaves_none = [this](std::int64_t samples) {
      return samples > 1 && static_cast<double>(samples - 1) <= 2 * *padding_;
    };
    const bool none = size_ ? leaves_none(size_->x) || leaves_none(size_->y) || leaves_none(size_->z)
                            : !spacing_ && leaves_none(samples_);
    if (none)
      throw Error(ErrorCode::usage, "--padding '" + number(*padding_) +
                                        "' leaves no samples for the mesh; take less, or " +
                                        (size_ ? "a larger --size" : "more with --resolution"));
    return {.samples = *padding_, .least_samples = 0};
  }
  if (thickness_.infinite()) return {};
  if (!thickness_.in_samples) return {.length = thickness_.value, .most_share = kMostPadding};
  if (spacing_) return {.length = thickness_.world(max_norm(*spacing_)), .most_share = kMostPadding};
  return {.samples = thickness_.value, .most_share = kMostPadding};
}

Grid GridOptions::around(const Box& box) const {
  if (spacing_) return fit_spacing(box, *spacing_, padding());
  if (size_) return fit_size(box, *size_, padding());
  return fit_samples(box, samples_, padding());
}

GridChoice GridOptions::choose(const Box& mesh) const {
  if (minimum_) {
    if (thickness_.in_samples || thickness_.infinite())
      throw Error(ErrorCode::usage,
                  "--minimum: needs a --thickness in world units, by which it sets the samples; give one without s");
    return {minimum_grid(mesh, thickness_.value, *minimum_, speed_), thickness_.value};
  }
  const Grid grid = around(bounds_.value_or(mesh));
  return {grid, thickness_.world(grid.max_spacing())};
}

}  // namespace standoff::cli
