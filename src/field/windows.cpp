// SPDX-License-Identifier: Apache-2.0
#include "field/windows.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "core/guarded.h"
#include "core/tile_count.h"
#include "field/lattice.h"
#include "field/prepare.h"
#include "sign/rows/row_crossings.h"
#include "sign/sign_field.h"
#include "standoff/windows.h"

namespace standoff {
namespace {

// Passes on a window's part of the work to the progress of all.
class WindowProgress {
 public:
  WindowProgress(ProgressMeter& all, std::int64_t units) : all_(all), units_(units) {
    if (all.is_watched()) callback_ = [this](const Progress& now) { return tell(now); };
  }
  ~WindowProgress() = default;
  WindowProgress(const WindowProgress&) = delete;
  WindowProgress& operator=(const WindowProgress&) = delete;

  ProgressMeter& meter() { return meter_; }
  void finish() { all_.advance(units_ - std::exchange(told_, units_)); }

 private:
  bool tell(const Progress& now) {
    const auto done = std::clamp<std::int64_t>(std::llround(now.fraction * static_cast<double>(units_)), told_, units_);
    if (done == told_ && ++unheard_ % kCheckEvery != 0) return true;
    all_.advance(done - std::exchange(told_, done));
    return true;
  }

  ProgressMeter& all_;
  static constexpr int kCheckEvery = 16;  // checks of a window's work, each of some ten microseconds at least

  std::int64_t units_, told_ = 0;
  int unheard_ = 0;
  ProgressCallback callback_;
  ProgressMeter meter_{callback_};
};

// Windows by jobs of their own, for the triangles that reach them.
class JobsOfWindows final : public WindowGather {
 public:
  JobsOfWindows(const Job& job, const BackendRow& row, const MeshParts& parts) : job_(job), row_(row), parts_(parts) {}

  Counts gather(const Grid& window, Sink& sink, ProgressMeter& progress) override {
    std::vector<std::uint32_t> near;
    if (!std::isinf(job_.thickness)) {
      near = parts_.touching(reached_from(window));
      if (near.empty()) {
        progress.advance(brick_count(window));
        return {};
      }
    }
    WindowProgress part(progress, brick_count(window));
    const Counts counts = row_.run({.mesh = job_.mesh,
                                    .kept = near.empty() ? job_.kept : near,
                                    .grid = window,
                                    .thickness = job_.thickness,
                                    .threads = job_.threads,
                                    .simd = job_.simd,
                                    .progress = part.meter(),
                                    .devices = job_.devices},
                                   sink);
    part.finish();
    return counts;
  }

  // With a spacing more, so that a window examines no less than the whole does.
  Box reached_from(const Grid& window) const {
    return window.bounds().grown(reach_beyond_rounding(window, job_.thickness) + window.max_spacing());
  }

 private:
  const Job& job_;
  const BackendRow& row_;
  const MeshParts& parts_;
};

// The least window of whole bricks of the grid around another one.
Grid in_bricks(const Grid& grid, const Size3& first, const Size3& size) {
  Size3 low, count;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const std::int64_t end = first[axis] + size[axis];
    low[axis] = first[axis] / kBrickSide * kBrickSide;
    count[axis] = std::min((end + kBrickSide - 1) / kBrickSide * kBrickSide, grid.size[axis]) - low[axis];
  }
  return grid.window(low, count);
}

// Copies samples of one tile, and tells whether it must be stored.
class TileCut {
 public:
  TileCut(const DistanceField& from, const Size3& shift) : from_(from), shift_(shift) {}

  void cut(std::int64_t tx, std::int64_t ty, std::int64_t tz, DistanceField& to) {
    const Size3& size = to.grid().size;
    const auto far = static_cast<float>(to.thickness());
    values_.fill(far);
    nearest_.fill(kNoTriangle);
    int outside = 0, inside = 0, samples = 0;
    for (std::int64_t z = kTileSide * tz; z < std::min(size.z, kTileSide * (tz + 1)); ++z)
      for (std::int64_t y = kTileSide * ty; y < std::min(size.y, kTileSide * (ty + 1)); ++y)
        for (std::int64_t x = kTileSide * tx; x < std::min(size.x, kTileSide * (tx + 1)); ++x) {
          const auto n =
              static_cast<std::size_t>(x % kTileSide + kTileSide * (y % kTileSide + kTileSide * (z % kTileSide)));
          values_[n] = from_.value(x + shift_.x, y + shift_.y, z + shift_.z);
          if (from_.has_nearest()) nearest_[n] = from_.nearest(x + shift_.x, y + shift_.y, z + shift_.z);
          const bool clamped = nearest_[n] == kNoTriangle;
          ++samples;
          outside += clamped && values_[n] == far;
          inside += clamped && values_[n] == -far;
        }
    if (outside == samples) return;
    if (inside == samples) return to.mark_inside(tx, ty, tz);
    std::ranges::copy(values_, to.store_tile(tx, ty, tz).begin());
    if (to.has_nearest()) std::ranges::copy(nearest_, to.store_nearest(tx, ty, tz).begin());
  }

 private:
  const DistanceField& from_;
  Size3 shift_;
  std::array<float, kTileSamples> values_;
  std::array<std::uint32_t, kTileSamples> nearest_;
};

// The samples of `window` out of a field that holds them all.
void cut_out(const DistanceField& from, const Grid& window, DistanceField& field) {
  field.reset(window, from.thickness(), from.has_nearest());
  const Size3 &first = window.first, &begin = from.grid().first;
  TileCut cut(from, {first.x - begin.x, first.y - begin.y, first.z - begin.z});
  const Size3 tiles = field.tile_count();
  for (std::int64_t tz = 0; tz < tiles.z; ++tz)
    for (std::int64_t ty = 0; ty < tiles.y; ++ty)
      for (std::int64_t tx = 0; tx < tiles.x; ++tx) cut.cut(tx, ty, tz, field);
}

// All samples are inside.
class Everywhere final : public SampleSigns {
 public:
  void fill(InsideRows& rows, std::int64_t, std::int64_t) const override { rows.invert(); }
};

}  // namespace

FieldInWindows::FieldInWindows(MeshView mesh, const Grid& grid, double thickness, const Size3& largest,
                               const ComputeOptions& options)
    : options_(options), computation_(mesh, grid, thickness, options_, false, largest) {
  computation_.check();
  if (plan().in_windows)
    computation_.threads().run([&] { prepare(); });
  else
    report_ = fill_field(computation_, whole_, options_);
}

FieldInWindows::~FieldInWindows() = default;

// Prepares the data that all windows share.
void FieldInWindows::prepare() {
  job_.emplace(computation_.job());
  Stopwatch watch;
  if (options_.hash_mesh) hash_ = computation_.mesh_hash();
  if (plan().row->in_windows) gather_ = plan().row->in_windows(*job_);
  if (!gather_) gather_ = std::make_unique<JobsOfWindows>(*job_, *plan().row, parts());
  computation_.report().seconds.compute = watch.lap();
  signs_of_grid_ =
      steps_of(computation_.sign_method()).scope == SignScope::grid ? computation_.signs({}) : signs_of_all_rows();
  computation_.report().seconds.sign = watch.lap();
  computation_.progress().stage("distances", brick_count(plan().grid), 0.2, 1);
  tell();
}

void FieldInWindows::tell() {
  computation_.finish(job_->triangle_count(), counts_, hash_);
  report_ = computation_.report();
  report_.samples = samples_;
  report_.tiles = tiles_;
}

void FieldInWindows::compute(const Size3& first, const Size3& size, DistanceField& field) try {
  const Grid window = checked(first, size);
  if (!plan().in_windows) {
    cut_out(whole_, window, field);
  } else if (const Grid bricks = in_bricks(plan().grid, first, size); bricks == window) {
    computation_.threads().run([&] { fill(window, field); });
  } else {
    DistanceField around;
    computation_.threads().run([&] { fill(bricks, around); });
    cut_out(around, window, field);
  }
  field.set_provenance(report_.provenance);
} catch (...) {
  field = {};
  throw;
}

Grid FieldInWindows::checked(const Size3& first, const Size3& size) const {
  const Grid& grid = plan().grid;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const std::string along = std::string(" along ") + "xyz"[axis];
    if (first[axis] < 0 || size[axis] < 1 || first[axis] > grid.size[axis] - size[axis])
      throw Error(ErrorCode::usage, "compute: " + std::to_string(size[axis]) + " samples from sample " +
                                        std::to_string(first[axis]) + " on" + along +
                                        " are no window of the grid, which has " + std::to_string(grid.size[axis]) +
                                        " there; give a window within it");
    if (size[axis] > plan().part[axis])
      throw Error(ErrorCode::usage, "compute: a window has " + std::to_string(size[axis]) + " samples" + along +
                                        ", the largest one that was announced " + std::to_string(plan().part[axis]) +
                                        "; announce a larger one");
  }
  return grid.window(first, size);
}

bool FieldInWindows::is_reached(const Size3& first, const Size3& size) {
  const Grid window = checked(first, size);
  if (!plan().in_windows || std::isinf(plan().thickness)) return true;
  if (const auto known = gather_->is_reached(in_bricks(plan().grid, first, size))) return *known;
  return computation_.threads().run(
      [&] { return parts().touch(window.bounds().grown(reach_beyond_rounding(window, plan().thickness))); });
}

bool FieldInWindows::is_empty(const Size3& first, const Size3& size) {
  if (is_reached(first, size)) return false;
  const SignMethod method = computation_.sign_method();
  if (plan().in_windows && method == SignMethod::none) return true;
  if (plan().in_windows && method != SignMethod::shell && !signs_of_grid_) {
    const Grid window = checked(first, size);
    bool one_sign = false, inside = false;
    computation_.threads().run([&] {
      one_sign = is_of_one_sign(window);
      inside = one_sign && is_inside(window);
    });
    if (one_sign) return inside == options_.sign.invert;
  }
  DistanceField field;
  compute(first, size, field);
  return field.stored_tiles() == 0 && std::ranges::find(field.slots(), DistanceField::kInside) == field.slots().end();
}

// A window of whole bricks.
void FieldInWindows::fill(const Grid& window, DistanceField& field) {
  Stopwatch watch;
  field.reset(window, plan().field_thickness, plan().with_nearest);
  Sink sink(field);
  counts_ += gather_->gather(window, sink, computation_.progress());
  samples_ += window.sample_count();
  tiles_ += tile_count(window.size);
  computation_.report().seconds.compute += watch.lap();
  sign(window, field);
  computation_.report().seconds.sign += watch.lap();
  computation_.report().tiles_stored += field.stored_tiles();
  tell();
}

void FieldInWindows::sign(const Grid& window, DistanceField& field) {
  const SignMethod method = computation_.sign_method();
  const bool invert = options_.sign.invert;
  ProgressMeter& progress = computation_.progress();
  if (method == SignMethod::none) return;
  if (method == SignMethod::shell) return apply(Shell(options_.sign, plan().field_thickness), field, progress);
  if (signs_of_grid_) return sign_field(*signs_of_grid_, invert, plan().grid, field, progress);
  if (is_of_one_sign(window)) {
    Everywhere inside;
    if (is_inside(window) != invert) sign_field(inside, false, window, field, progress);
    return;
  }
  if (SampleSigns* const signs = signs_of_rows(window)) sign_field(*signs, invert, rows_->grid, field, progress);
}

SampleSigns* FieldInWindows::signs_of_rows(const Grid& window) {
  const Grid& grid = plan().grid;
  const Grid rows = grid.window({0, window.first.y - grid.first.y, window.first.z - grid.first.z},
                                {grid.size.x, window.size.y, window.size.z});
  if (!rows_ || rows_->grid != rows) {
    rows_.reset();
    RowSigns made{rows, crossed_by(rows), nullptr};
    made.signs = computation_.signs_of_window(rows, made.part.oriented());
    rows_.emplace(std::move(made));
  }
  return rows_->signs.get();
}

// The triangles that rows of the window, or rays from there to smaller x, may cross.
MeshPart FieldInWindows::crossed_by(const Grid& window) {
  Box box = window.bounds();
  box.min.x = -std::numeric_limits<double>::infinity();
  return {OrientedMesh{computation_.mesh(), computation_.sign_plan().use}, all_parts().touching(box)};
}

// By the crossings of all rows, if these are so few that they can be held: of a closed mesh windows need no others.
std::unique_ptr<SampleSigns> FieldInWindows::signs_of_all_rows() {
  const SignPlan& sign = computation_.sign_plan();
  if (!sign.has_sign() || !sign.boundary.edges.empty() || sign.report.method == SignMethod::shell) return nullptr;
  if (!may_share_rows(plan().grid)) return nullptr;
  // Found crossings lie in blocks, of which each thread leaves one half empty.
  constexpr double kRoom = 1.25;
  const double expected = RowCrossings::expected_bytes({computation_.mesh(), sign.use}, plan().grid);
  if (kRoom * expected > static_cast<double>(crossing_bytes(plan()))) return nullptr;
  std::unique_ptr<SampleSigns> signs = computation_.signs({});
  const bool all = signs->load(0) >= tiles_along(plan().grid.size.y) * tiles_along(plan().grid.size.z);
  return all ? std::move(signs) : nullptr;
}

// Nothing of the mesh, which has no holes, is between samples of the window.
bool FieldInWindows::is_of_one_sign(const Grid& window) {
  return computation_.sign_plan().boundary.edges.empty() && !all_parts().touch(window.bounds());
}

// The side of the first sample.
bool FieldInWindows::is_inside(const Grid& window) {
  const Grid sample = window.window({}, {1, 1, 1});
  const MeshPart part = crossed_by(sample);
  const auto signs = computation_.signs_of_window(sample, part.oriented());
  return signs && bits_of(*signs, false, sample, computation_.progress())(0, 0, 0);
}

const MeshParts& FieldInWindows::parts() {
  if (!parts_) parts_.emplace(job_->mesh, job_->kept, job_->progress);
  return *parts_;
}

const MeshParts& FieldInWindows::all_parts() {
  if (job_->kept.empty()) return parts();
  if (!all_parts_) all_parts_.emplace(computation_.mesh(), std::span<const std::uint32_t>{}, computation_.progress());
  return *all_parts_;
}

// The public class.

class WindowComputation::Work : public FieldInWindows {
 public:
  using FieldInWindows::FieldInWindows;
};

namespace {

// The largest window within the grid. Errors: usage.
Size3 largest_of(const Grid& grid, double thickness, const Size3& largest, const ComputeOptions& options) {
  validate(thickness, options);
  validate(grid);
  if (largest.count() == 0)
    throw Error(ErrorCode::usage, "compute: the largest window has no samples; give 1 or more along each axis");
  return {std::min(largest.x, grid.size.x), std::min(largest.y, grid.size.y), std::min(largest.z, grid.size.z)};
}

}  // namespace

std::int64_t estimate_window(MeshView mesh, const Grid& grid, double thickness, const Size3& largest,
                             const ComputeOptions& options) try {
  const Size3 window = largest_of(grid, thickness, largest, options);
  const auto triangles = static_cast<std::int64_t>(mesh.triangles.size());
  const Plan plan = make_plan(triangles, grid, thickness, options, false, window);
  return Threads(options.execution.threads).run([&] { return bytes_needed(mesh, plan, options); });
} catch (...) {
  throw_as_error("compute");
}

WindowComputation::WindowComputation(MeshView mesh, const Grid& grid, double thickness, const Size3& largest,
                                     const ComputeOptions& options) try {
  const Size3 window = largest_of(grid, thickness, largest, options);
  work_ = std::make_unique<Work>(mesh, grid, thickness, window, options);
} catch (...) {
  throw_as_error("compute", kWithLessMemory);
}

WindowComputation::WindowComputation(WindowComputation&&) noexcept = default;
WindowComputation& WindowComputation::operator=(WindowComputation&&) noexcept = default;
WindowComputation::~WindowComputation() = default;

const Grid& WindowComputation::grid() const { return work_->plan().grid; }
double WindowComputation::thickness() const { return work_->plan().field_thickness; }
bool WindowComputation::has_nearest() const { return work_->has_nearest(); }
bool WindowComputation::is_whole() const { return !work_->plan().in_windows; }
SignDecision WindowComputation::decision() const try { return work_->decision(); } catch (...) {
  throw_as_error("compute");
}

const ComputeReport& WindowComputation::report() const { return work_->report(); }

void WindowComputation::compute(const Size3& first, const Size3& size, DistanceField& field) try {
  work_->compute(first, size, field);
} catch (...) {
  throw_as_error("compute", kWithLessMemory);
}

bool WindowComputation::is_empty(const Size3& first, const Size3& size) try {
  return work_->is_empty(first, size);
} catch (...) {
  throw_as_error("compute", kWithLessMemory);
}

bool WindowComputation::is_reached(const Size3& first, const Size3& size) const try {
  return work_->is_reached(first, size);
} catch (...) {
  throw_as_error("compute");
}

}  // namespace standoff
