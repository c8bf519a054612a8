// SPDX-License-Identifier: Apache-2.0
#include "field/field_update.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <string>
#include <utility>

#include "core/memory.h"
#include "core/threads.h"
#include "core/tile_count.h"
#include "field/computation.h"
#include "field/mesh_parts.h"
#include "field/prepare.h"
#include "sign/plan.h"
#include "sign/sign_field.h"
#include "sign/sign_text.h"
#include "standoff/version.h"

namespace standoff {

// Puts the dirty tiles of windows into a field.
class TileMerge {
 public:
  TileMerge(const DirtyTiles& dirty, DistanceField& field) : dirty_(dirty), field_(field) {}

  void take(const FieldUpdate::NewWindow& window) {
    const Size3 tiles = DistanceField::tiles_of(window.grid.size);
    Size3 shift;
    for (std::size_t axis = 0; axis < 3; ++axis)
      shift[axis] = (window.grid.first[axis] - field_.grid().first[axis]) / kTileSide;
    auto slot = window.slots.begin();
    for (std::int64_t tz = 0; tz < tiles.z; ++tz)
      for (std::int64_t ty = 0; ty < tiles.y; ++ty)
        for (std::int64_t tx = 0; tx < tiles.x; ++tx) {
          const Size3 at{tx + shift.x, ty + shift.y, tz + shift.z};
          const std::int32_t here = *slot++;
          if (!dirty_.is_dirty(at)) continue;  // not all of its triangles were looked at
          if (here >= 0)
            store(window, here, at);
          else
            clear(here == DistanceField::kInside, at);
        }
  }
  // Takes out the tiles that are no longer stored. Returns how many tiles changed.
  std::int64_t finish() {
    field_.erase_tiles(erased_);
    for (const Size3& at : inside_) field_.mark_inside(at.x, at.y, at.z);
    return changed_;
  }

 private:
  // The samples of a slot.
  template <class T>
  static std::span<const T> tile_of(const std::vector<T>& all, std::int32_t slot) {
    return std::span(all).subspan(static_cast<std::size_t>(slot) * kTileSamples, kTileSamples);
  }
  bool is_stored(const Size3& at) const { return field_.tile(at.x, at.y, at.z).has_value(); }

  void store(const FieldUpdate::NewWindow& window, std::int32_t slot, const Size3& at) {
    const bool is_new = !is_stored(at);
    bool changed = put(tile_of(window.values, slot),
                       is_new ? field_.store_tile(at.x, at.y, at.z) : field_.edit_tile(at.x, at.y, at.z));
    if (field_.has_nearest()) changed |= put(tile_of(window.nearest, slot), field_.store_nearest(at.x, at.y, at.z));
    changed_ += changed || is_new;
  }
  // Returns whether other bits were there.
  template <class T>
  static bool put(std::span<const T> tile, std::span<T, kTileSamples> into) {
    if (std::memcmp(tile.data(), into.data(), into.size_bytes()) == 0) return false;
    std::ranges::copy(tile, into.begin());
    return true;
  }

  void clear(bool inside, const Size3& at) {
    if (is_stored(at)) {
      erased_.push_back(at);
      if (inside) inside_.push_back(at);
    } else {
      if (inside == (field_.background(at.x, at.y, at.z) < 0)) return;
      inside ? field_.mark_inside(at.x, at.y, at.z) : field_.mark_outside(at.x, at.y, at.z);
    }
    ++changed_;
  }

  const DirtyTiles& dirty_;
  DistanceField& field_;
  std::vector<Size3> erased_, inside_;
  std::int64_t changed_ = 0;
};

void FieldUpdate::NewWindow::copy(const DistanceField& field) {
  slots.assign(field.slots().begin(), field.slots().end());
  values.assign(field.tile_values().begin(), field.tile_values().end());
  if (field.has_nearest()) nearest.assign(field.tile_nearest_values().begin(), field.tile_nearest_values().end());
}

FieldUpdate::FieldUpdate(MeshView before, MeshView after, MeshFacts& facts, DistanceField& field,
                         const ComputeOptions& options)
    : before_(before), after_(after), facts_(facts), field_(field), options_(options), progress_(options.progress) {
  options_.nearest = field.has_nearest();
}

// What all depends on, then which windows change. Returns why windows cannot do; nothing where they do.
std::string FieldUpdate::find_out(std::span<const std::uint32_t> changed) {
  progress_.stage("preparing the mesh", 1, 0, 0.1);
  check_field();
  std::string anew = global_reason();
  if (anew.empty()) anew = find_change(changed);
  if (anew.empty()) anew = find_windows();
  if (anew.empty()) anew = decide_sign();
  if (anew.empty()) hash_mesh();
  if (anew.empty()) find_triangles();
  return anew;
}

void FieldUpdate::prepare(std::span<const std::uint32_t> changed) {
  Threads(options_.execution.threads).run([&] { find_out(changed); });
}

UpdateReport FieldUpdate::run(std::span<const std::uint32_t> changed) {
  Threads threads(options_.execution.threads);
  Stopwatch watch;
  std::string anew = threads.run([&] { return find_out(changed); });
  report_.seconds.prepare = watch.lap();
  if (!anew.empty()) {
    compute_anew(std::move(anew));
    report_.seconds.compute = watch.lap();
    return std::move(report_);
  }
  threads.run([&] {
    progress_.stage("distances", static_cast<std::int64_t>(windows_.size()), 0.1, 0.9);
    DistanceField scratch;  // keeps its memory from window to window
    for (std::size_t n = 0; n < windows_.size(); ++n) {
      compute(triangles_[n], windows_[n].grid, scratch);
      report_.seconds.compute += watch.lap();
      sign(triangles_[n], scratch);
      windows_[n].copy(scratch);
      report_.seconds.sign += watch.lap();
      progress_.advance();
    }
    progress_.stage("putting together", 1, 0.9, 1);
    merge();
  });
  report_.seconds.merge = watch.lap();
  return std::move(report_);
}

namespace {

void expect_arrays(const MeshView& mesh, const char* which) {
  if ((mesh.triangles.data() || mesh.triangles.empty()) && (mesh.vertices.data() || mesh.vertices.empty())) return;
  throw Error(ErrorCode::usage, std::string("update: an array of the mesh ") + which +
                                    " is null but said not to be empty; give its address");
}

}  // namespace

void FieldUpdate::check_field() const {
  expect_arrays(before_, "before");
  expect_arrays(after_, "after");
  if (field_.slots().empty())
    throw Error(ErrorCode::usage, "update: the field is empty; give one that compute() has filled");
}

// Hashes the new mesh. Hashing the one before takes as long again, so only who gives one mesh twice, having changed it
// in its place, or the meshes in the wrong order, is found out.
void FieldUpdate::hash_mesh() {
  if (!options_.hash_mesh) return;
  hash_ = content_hash(after_);
  const std::uint64_t known = field_.provenance().mesh_hash;
  if (known == 0 || (known == hash_) == change_.triangles.empty()) return;
  if (known != hash_ && content_hash(before_) == known) return;  // other indices, or vertices that no triangle uses
  throw Error(ErrorCode::usage,
              "update: the field is not that of the mesh before, as its hash shows; give the mesh that the field was "
              "computed of, or updated to, as it was then");
}

// Why windows cannot do, as far as field and options show it. Nothing where they may do.
std::string FieldUpdate::global_reason() const {
  const Provenance& from = field_.provenance();
  if (std::isinf(field_.thickness())) return "in a full field every sample has a distance, which may change";
  if (options_.method != Method::tiles)
    return std::string("the method ") + find_info(options_.method)->name + " is not exact, which windows need";
  if (options_.skip.kind == SkipRule::Kind::neighbour)
    return "the skip rule looks at triangles that are neighbours in the mesh's order";
  if (from.method != find_info(options_.method)->name || from.version != version())
    return "the field was computed by another method or version";
  if (options_.sign.outer) return "which triangles are inside of others is decided for the whole mesh";
  switch (options_.sign.method) {
    case SignMethod::none:
    case SignMethod::shell:
    case SignMethod::winding:
    case SignMethod::parity:
    case SignMethod::automatic:
      return {};
    default:
      return std::string("the sign by ") + name_of(options_.sign.method) + " is decided for the whole field";
  }
}

std::string FieldUpdate::find_change(std::span<const std::uint32_t> changed) {
  const Grid& grid = field_.grid();
  const Plan whole =
      make_plan(static_cast<std::int64_t>(after_.triangles.size()), grid, field_.thickness(), options_, false);
  change_ = change_of(before_, after_, changed);
  report_.triangles_changed = std::ssize(change_.triangles);
  if (change_.triangles.size() > after_.triangles.size() / 2) return "more than half of the triangles changed";
  facts_.check(change_, whole);
  if (by_rows(options_.sign.method)) {
    const MeshPart were({before_}, change_.in(before_)), are({after_}, change_.in(after_));
    const double bytes =
        RowCrossings::expected_bytes(were.oriented(), grid) + RowCrossings::expected_bytes(are.oriented(), grid);
    constexpr double kShare = 0.125;
    if (const auto limit = static_cast<double>(memory_limit_of(options_)); limit != 0 && bytes > kShare * limit)
      return "the crossings of rows with triangles that changed would take too much memory";
    crossings_ = ChangedCrossings(were.oriented(), are.oriented(), grid, progress_);
  }
  facts_.follow(change_, crossings_);
  return {};
}

std::string FieldUpdate::find_windows() {
  const Grid& grid = field_.grid();
  plan_ = make_plan(std::ssize(after_.triangles), grid, field_.thickness(), options_, false);
  DirtyTiles& dirty = dirty_.emplace(grid);
  dirty.mark_reached(change_, reach_beyond_rounding(grid, plan_->thickness));
  crossings_.each_changed(
      [&](std::int64_t j, std::int64_t k, std::int64_t begin, std::int64_t end) { dirty.mark_row(j, k, begin, end); });
  if (2 * dirty.bricks() > dirty.all_bricks()) return "more than half of the grid may change";
  for (const Grid& window : dirty.windows()) windows_.push_back({window, {}, {}, {}});
  report_.windows = std::ssize(windows_);
  report_.tiles_computed = dirty.count();
  plan_ = make_plan(plan_->triangles, grid, field_.thickness(), options_, false, largest_window());
  check_windows();
  return {};
}

// Throws where the work on one window, and the tiles of all of them, may take more than the limit.
void FieldUpdate::check_windows() const {
  const auto limit = static_cast<double>(memory_limit_of(options_));
  if (limit == 0) return;
  double tiles = 0;
  for (const NewWindow& window : windows_) tiles += static_cast<double>(tile_count(window.grid.size));
  // Other backends also compute tiles beside dirty ones.
  const double computed = plan_->row->backend == Backend::cpu ? static_cast<double>(dirty_->count()) : tiles;
  const auto needed = [&](const ReachCounts& counts) {
    return static_cast<double>(bytes_needed(*plan_, counts, {.boundary = std::ssize(sign_.boundary.edges)})) +
           field_bytes(std::min(counts.tiles, computed), tiles, field_.has_nearest());
  };
  if (needed({}) <= limit) return;
  const double bytes = needed(scan_mesh(after_, *plan_, true).counts);
  if (bytes <= limit) return;
  throw Error(ErrorCode::limit,
              "update: the windows may need " + over_the_limit(bytes, limit) +
                  "; give a higher limit, or move fewer triangles at a time",
              limit_details(bytes, limit));
}

Size3 FieldUpdate::largest_window() const {
  Size3 largest{1, 1, 1};
  for (const NewWindow& window : windows_)
    for (std::size_t axis = 0; axis < 3; ++axis) largest[axis] = std::max(largest[axis], window.grid.size[axis]);
  return largest;
}

// The same as plan_sign() where a closed mesh takes as it is what it crosses: then samples keep their side where their
// rows cross as before. All else may change the sign anywhere.
std::string FieldUpdate::decide_sign() {
  const SignMethod asked = options_.sign.method;
  if (!by_rows(asked)) {
    sign_ = plan_sign(after_, options_.sign, progress_);
  } else if (const Closed closed = facts_.closed(change_); asked == SignMethod::parity) {
    if (!closed.unoriented) return "the mesh is not closed, or was not";
    sign_ = plan_of_closed(asked);
  } else {
    if (!closed.oriented) return "the mesh is not closed, or was not, so that its sign is decided for the whole field";
    if (!options_.sign.as_oriented && !facts_.faces_outwards(change_))
      return "parts of the mesh may be inside out or nested, which is decided for the whole mesh";
    sign_ = plan_of_closed(SignMethod::winding);
  }
  if (written(sign_text_of(options_.sign, sign_.report)) != field_.provenance().sign)
    return "the field's sign was decided in another way";
  return {};
}

void FieldUpdate::find_triangles() {
  const bool with_signs = by_rows(sign_.report.method);
  if (with_signs) kept_signs_ = facts_.signs(plan_->grid, rule(), progress_);
  std::vector<Grid> grids;
  for (const NewWindow& window : windows_) grids.push_back(window.grid);
  triangles_ = facts_.triangles_of(*dirty_, grids, reach_beyond_rounding(plan_->grid, plan_->thickness),
                                   with_signs && !kept_signs_, progress_);
}

void FieldUpdate::compute(const WindowTriangles& triangles, const Grid& window, DistanceField& field) {
  field.reset(window, field_.thickness(), field_.has_nearest());
  if (triangles.near.empty()) return;
  const BackendRow& row = find_backend(options_.execution.backend, options_.method, std::ssize(triangles.near), window);
  const ProgressCallback check = [this](const Progress&) {
    progress_.check();
    return true;
  };
  ProgressMeter meter(check);
  Sink sink(field);
  const std::vector<std::uint8_t> wanted = dirty_->marks_of(window);
  row.run({.mesh = after_,
           .kept = triangles.near,
           .grid = window,
           .thickness = plan_->thickness,
           .threads = plan_->threads,
           .simd = options_.execution.simd,
           .progress = meter,
           .devices = plan_->devices,
           .wanted = wanted},
          sink);
}

void FieldUpdate::sign(const WindowTriangles& triangles, DistanceField& field) {
  if (sign_.report.method == SignMethod::none) return;
  if (sign_.report.method == SignMethod::shell)
    return apply(Shell(options_.sign, field_.thickness()), field, progress_);
  if (kept_signs_) return sign_field(*kept_signs_, options_.sign.invert, plan_->grid, field, progress_);
  const MeshPart part(OrientedMesh{after_}, triangles.crossed);
  const UnsignedField window{field.grid(), field_.thickness(), {}, crossing_bytes(*plan_)};
  const auto signs = make_signs_of_window(part.oriented(), sign_, options_.sign, window, progress_);
  sign_field(*signs, options_.sign.invert, field.grid(), field, progress_);
}

void FieldUpdate::merge() {
  report_.sign = std::move(sign_.report);  // nothing may fail once the field has changed
  Provenance provenance = field_.provenance();
  provenance.mesh_hash = hash_;
  try {
    TileMerge merge(*dirty_, field_);
    for (const NewWindow& window : windows_) merge.take(window);
    report_.tiles_changed = merge.finish();
  } catch (...) {
    field_ = {};
    throw;
  }
  field_.set_provenance(std::move(provenance));
  report_.tiles_stored = field_.stored_tiles();
}

void FieldUpdate::compute_anew(std::string why) {
  const ComputeReport done = compute_into(after_, field_.grid(), field_.thickness(), field_, options_);
  report_.anew = true;
  report_.why = std::move(why);
  report_.windows = 1;
  report_.tiles_computed = report_.tiles_changed = done.tiles;
  report_.tiles_stored = done.tiles_stored;
  report_.sign = done.sign;
}

}  // namespace standoff
