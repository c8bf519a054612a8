// SPDX-License-Identifier: Apache-2.0
#include "workload.h"

#include <cmath>
#include <exception>
#include <limits>

#include "scenes/scenes.h"
#include "standoff/error.h"
#include "standoff/io.h"

namespace standoff::bench {
namespace {

/// Adds a triangle a tenth as long as the mesh, `sides` of the mesh's longest side away along each axis.
void add_stray(Mesh& mesh, double sides) {
  const Box box = bounds(mesh);
  const double side = box.longest_side(), away = side * sides;
  const auto first = static_cast<std::uint32_t>(mesh.vertices.size());
  for (std::size_t axis = 0; axis < 3; ++axis) {
    Vec3 corner = box.center() + Vec3{away, away, away};
    corner[axis] += side / 10;
    mesh.vertices.push_back(corner);
  }
  mesh.triangles.push_back({first, first + 1, first + 2});
}

/// Scales the mesh and centres it in the box from the origin to `extent`.
void place(Mesh& mesh, Vec3 extent, Vec3 scale) {
  const Box box = bounds(mesh);
  for (Vec3& v : mesh.vertices) v = (v - box.center()) * scale + 0.5 * extent;
}

/// The scale per axis that makes the mesh's box, grown by `margin`, as large as `extent`.
Vec3 filling(const Mesh& mesh, Vec3 extent, double margin) {
  const Vec3 target = extent - Vec3{2, 2, 2} * margin, old = bounds(mesh).extent();
  if (target.x < 0 || target.y < 0 || target.z < 0)
    throw Error(ErrorCode::usage, "the margin leaves no room for the mesh");
  const auto factor = [](double to, double from) { return from > 0 ? to / from : 1; };
  return {factor(target.x, old.x), factor(target.y, old.y), factor(target.z, old.z)};
}

/// A grid of cubic cells with `samples` on the longest side; the outermost samples are at least `thickness` samples
/// away from the mesh.
Grid padded_grid(const Box& box, std::int64_t samples, double thickness) {
  const Vec3 e = box.extent();
  const double spacing = std::max({e.x, e.y, e.z}) / (static_cast<double>(samples - 1) - 2 * thickness);
  return fit_resolution(box, samples, {.length = thickness * spacing, .least_samples = 0});
}

/// A cube of samples with cubic cells, centred on the mesh, that holds the mesh's box grown by `thickness` samples.
Grid cube_grid(const Box& box, std::int64_t samples, double thickness) {
  const Vec3 e = box.extent();
  const double intervals = static_cast<double>(samples - 1);
  const double spacing = std::max({e.x, e.y, e.z}) / (intervals - 2 * thickness);
  const Vec3 h{spacing, spacing, spacing};
  return {{samples, samples, samples}, box.center() - h * (intervals / 2), h};
}

}  // namespace

bool Workload::full() const { return !std::isfinite(thickness); }

nlohmann::json Workload::describe() const {
  nlohmann::json line;
  line["source"] = source;
  line["triangles"] = mesh.triangles.size();
  line["grid"] = {grid.size.x, grid.size.y, grid.size.z};
  line["spacing"] = {grid.spacing.x, grid.spacing.y, grid.spacing.z};
  line["samples"] = grid.sample_count();
  if (!full()) line["thickness"] = thickness;
  line["threads"] = threads;
  return line;
}

WorkloadOptions::WorkloadOptions(CLI::App& app) {
  auto* mesh = app.add_option("--mesh", mesh_, "mesh file");
  auto* scene = app.add_option("--scene", scene_, "mesh made by code")->excludes(mesh);
  app.add_option("--triangles", triangles_, "triangles of the scene (its own count when absent)")->needs(scene);
  app.add_option("--stray", stray_,
                 "add a triangle, so many times the mesh's longest side away from its middle along each axis");
  auto* samples = app.add_option("--samples", samples_, "cubic cells, this many samples on the longest side");
  auto* cube = app.add_option("--cube", cube_, "cubic cells, this many samples on every side")->excludes(samples);
  auto* size = app.add_option("--size", size_,
                              "X,Y,Z samples; the mesh is stretched per axis until its box, grown by the thickness, "
                              "fills them")
                   ->delimiter(',')
                   ->expected(3)
                   ->excludes(samples, cube);
  app.add_option("--extent", extent_,
                 "X,Y,Z world units that the cells of --size fill, a sample in the middle of each (default: spacing 1, "
                 "the outermost samples on the box)")
      ->delimiter(',')
      ->expected(3)
      ->needs(size);
  app.add_option("--thickness", thickness_, "in samples; with --extent in world units");
  app.add_option("--scale", scale_, "with --size: scale the mesh by this instead of stretching it, and centre it")
      ->needs(size);
  app.add_option("--margin", margin_,
                 "left free around the mesh, in the unit of the thickness (default: the thickness)");
  app.add_flag("--full", full_, "a full field: no thickness");
  app.add_option("--threads", threads_);
  app.add_option("--repeats", repeats_, "calls in this process, the first one cold")->check(CLI::PositiveNumber);
  app.add_option("--enough", enough_, "no further call after so many seconds");
  app.add_option("--values", values_, "write the values to this file afterwards: raw floats, x fastest");
  app.add_flag("--check", check_, "compare the result with another method's afterwards");
}

Workload WorkloadOptions::make() const {
  Workload work;
  work.source = scene_.empty() ? mesh_ : scene_;
  work.mesh = scene_.empty() ? read_mesh(mesh_).mesh : scenes::make(scene_, triangles_);
  if (stray_) add_stray(work.mesh, *stray_);
  work.threads = threads_;
  work.repeats = repeats_;
  work.enough = enough_;
  work.check = check_;
  work.values = values_;
  const double margin = margin_ ? *margin_ : full_ ? 0 : thickness_;
  work.thickness = thickness_;
  if (size_.empty()) {
    const Box box = bounds(work.mesh);
    work.grid = cube_ ? cube_grid(box, cube_, margin) : padded_grid(box, samples_, margin);
    work.thickness *= work.grid.spacing.x;
  } else {
    const Vec3 counts{double(size_[0]), double(size_[1]), double(size_[2])}, one{1, 1, 1};
    const bool cells = !extent_.empty();
    const Vec3 extent = cells ? Vec3{extent_[0], extent_[1], extent_[2]} : counts - one;
    const Vec3 spacing = cells ? extent / counts : one;
    place(work.mesh, extent, scale_ ? one * *scale_ : filling(work.mesh, extent, margin));
    work.grid = {{size_[0], size_[1], size_[2]}, cells ? 0.5 * spacing : Vec3{}, spacing};
  }
  if (full_) work.thickness = std::numeric_limits<double>::infinity();
  return work;
}

}  // namespace standoff::bench
