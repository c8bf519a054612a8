#include "cli/grid_options.h"

#include <algorithm>
#include <cmath>

#include "cli/options.h"
#include "cli/text.h"
#include "standoff/error.h"
#include "standoff/thesis.h"

namespace standoff::cli {
namespace {

// Around the mesh there are at least so many samples, for slices and surfaces that do not end at the face of the grid.
constexpr double kLeastPadding = 2;
// A wide band is not followed farther than this share of the mesh's longest side, or few samples are left for the mesh.
constexpr double kMostPadding = 0.1;

// How far an axis grows on each side when `samples` of its `cells` lie there and the rest covers the extent.
double growth(double extent, double cells, double samples) {
  if (samples == 0 || extent == 0 || cells == 0) return 0;
  return samples * extent / std::max(cells - 2 * samples, 0.0);
}

double longest(Vec3 extent) { return std::max({extent.x, extent.y, extent.z}); }

}  // namespace

void GridOptions::add_to(CLI::App& verb) {
  const auto add = [&verb](const char* name, const char* value, const char* help, auto set) {
    return add_parsed(verb, {name, value, help, "Grid"}, set);
  };
  using S = const std::string&;
  auto* samples = add("-r,--resolution", "N", "samples on the longest side (default 256)",
                      [this](S o, S t) { samples_ = parse_count(o, t, 2, std::int64_t{1} << 40); });
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
  add("-t,--thickness", "T",
      "half-width of the band: world units (0.5), samples (3s),\nor inf for every sample (default)",
      [this](S o, S t) { thickness_ = parse_thickness(o, t); });
  spacing->excludes(samples);
  size->excludes(samples)->excludes(spacing);
  bounds->excludes(padding);
}

void GridOptions::add_thesis_to(CLI::App& verb) {
  using S = const std::string&;
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

Box GridOptions::padded(const Box& mesh) const {
  const Vec3 extent = mesh.extent();
  const double side = longest(extent);
  // The growth of one axis with the given extent, where `cells` is what the axis has, or what its spacing makes of it.
  const auto along = [&](double axis_extent, double cells, double spacing) {
    const auto grown = [&](double samples) {
      return spacing > 0 ? samples * spacing : growth(axis_extent, cells, samples);
    };
    if (padding_) {
      if (spacing == 0 && cells > 0 && cells <= 2 * *padding_)
        throw Error(ErrorCode::usage, "--padding '" + number(*padding_) +
                                          "' leaves no samples for the mesh; take less, or " +
                                          (size_ ? "a larger --size" : "more with --resolution"));
      return grown(*padding_);
    }
    const double least = grown(spacing > 0 ? kLeastPadding : std::clamp((cells - 1) / 2, 0.0, kLeastPadding));
    if (thickness_.infinite()) return least;
    const double sample = spacing_ ? longest(*spacing_) : 0;
    const double wanted = !thickness_.in_samples ? thickness_.value
                          : sample > 0           ? thickness_.world(sample)
                                                 : grown(thickness_.value);
    return std::max(least, side > 0 ? std::min(wanted, kMostPadding * side) : wanted);
  };
  Vec3 by;
  if (spacing_) {
    by = {along(extent.x, 0, spacing_->x), along(extent.y, 0, spacing_->y), along(extent.z, 0, spacing_->z)};
  } else if (size_) {
    const auto cells = [](std::int64_t samples) { return static_cast<double>(samples - 1); };
    by = {along(extent.x, cells(size_->x), 0), along(extent.y, cells(size_->y), 0),
          along(extent.z, cells(size_->z), 0)};
  } else {
    const auto cells = static_cast<double>(samples_ - 1);
    // A mesh that is one point gets cells of size 1.
    const bool no_scale = side == 0 && (thickness_.infinite() || thickness_.in_samples);
    const double all = no_scale ? cells / 2 : along(side, cells, 0);
    by = {all, all, all};
  }
  return {mesh.min - by, mesh.max + by};
}

Grid GridOptions::around(const Box& box) const {
  if (spacing_) return fit_spacing(box, *spacing_);
  if (size_) return fit_size(box, *size_);
  return fit_samples(box, samples_);
}

GridChoice GridOptions::choose(const Box& mesh) const {
  if (minimum_) {
    if (thickness_.in_samples || thickness_.infinite())
      throw Error(ErrorCode::usage,
                  "--minimum: needs a --thickness in world units, by which it sets the samples; give one without s");
    return {minimum_grid(mesh, thickness_.value, *minimum_, speed_), thickness_.value};
  }
  const Grid grid = around(bounds_ ? *bounds_ : padded(mesh));
  return {grid, thickness_.world(grid.max_spacing())};
}

}  // namespace standoff::cli
