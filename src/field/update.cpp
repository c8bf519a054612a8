// SPDX-License-Identifier: Apache-2.0
// Fields of meshes of which a part moves: computes the windows that can change, and puts them into the field.
#include "standoff/update.h"

#include <tbb/parallel_for.h>
#include <tbb/parallel_invoke.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "core/guarded.h"
#include "core/tile_count.h"
#include "field/computation.h"
#include "field/dirty.h"
#include "field/lattice.h"
#include "field/mesh_parts.h"
#include "field/prepare.h"
#include "sign/diagnosis/closed.h"
#include "sign/sign_field.h"
#include "sign/sign_text.h"
#include "standoff/version.h"

namespace standoff {

// Which triangles changed.

namespace {

// Whether each vertex has other bits in the other mesh.
std::vector<std::uint8_t> moved_vertices(const MeshView& before, const MeshView& after) {
  const auto [fewer, more] = std::minmax({before.vertices.size(), after.vertices.size()});
  std::vector<std::uint8_t> moved(more, 1);
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, fewer, 16384), [&](const auto& range) {
    for (std::size_t v = range.begin(); v != range.end(); ++v) {
      const Vec3 a = before.vertices[v], b = after.vertices[v];
      moved[v] = std::memcmp(&a, &b, sizeof a) != 0;
    }
  });
  return moved;
}

}  // namespace

std::vector<std::uint32_t> changed_triangles(MeshView before, MeshView after) try {
  constexpr std::size_t kChunk = 16384;
  validate(before);
  validate(after);
  const auto [fewer, more] = std::minmax({before.triangles.size(), after.triangles.size()});
  const std::vector<std::uint8_t> moved = moved_vertices(before, after);
  std::vector<std::vector<std::uint32_t>> found((fewer + kChunk - 1) / kChunk);
  tbb::parallel_for(std::size_t{0}, found.size(), [&](std::size_t chunk) {
    for (std::size_t t = kChunk * chunk; t < std::min(fewer, kChunk * (chunk + 1)); ++t) {
      const Triangle a = before.triangles[t], b = after.triangles[t];
      if (a == b && !(moved[a[0]] | moved[a[1]] | moved[a[2]])) continue;
      const auto one = before.corners(t), other = after.corners(t);
      if (std::memcmp(&one, &other, sizeof one) != 0) found[chunk].push_back(static_cast<std::uint32_t>(t));
    }
  });
  std::vector<std::uint32_t> all;
  for (const std::vector<std::uint32_t>& some : found) all.insert(all.end(), some.begin(), some.end());
  for (std::size_t t = fewer; t < more; ++t) all.push_back(static_cast<std::uint32_t>(t));
  return all;
} catch (...) {
  throw_as_error("update");
}

// The update.

namespace {

// The tiles of a window, as they will be: as DistanceField::slots(), and the arrays that slots point into.
struct NewWindow {
  Grid grid;
  std::vector<std::int32_t> slots;
  std::vector<float> values;
  std::vector<std::uint32_t> nearest;

  void copy(const DistanceField& field) {
    slots.assign(field.slots().begin(), field.slots().end());
    values.assign(field.tile_values().begin(), field.tile_values().end());
    if (field.has_nearest()) nearest.assign(field.tile_nearest_values().begin(), field.tile_nearest_values().end());
  }
  // Of a slot.
  template <class T>
  static std::span<const T> tile(const std::vector<T>& all, std::int32_t slot) {
    return std::span(all).subspan(static_cast<std::size_t>(slot) * kTileSamples, kTileSamples);
  }
};

class FieldUpdate {
 public:
  FieldUpdate(MeshView before, MeshView after, DistanceField& field, const ComputeOptions& options)
      : before_(before), after_(after), field_(field), options_(options), progress_(options.progress) {
    options_.nearest = field.has_nearest();
  }

  UpdateReport run(std::span<const std::uint32_t> changed);

 private:
  void check_field() const;
  void hash_mesh();
  std::string global_reason() const;
  std::string find_windows(std::span<const std::uint32_t> changed);
  std::string decide_sign();
  bool was_closed(bool oriented) const;
  void compute(const WindowTriangles& triangles, const Grid& window, DistanceField& field);
  void sign(const WindowTriangles& triangles, DistanceField& field);
  void merge();
  void compute_anew(std::string why);
  Size3 largest_window() const;

  bool by_rows() const {
    return sign_.report.method == SignMethod::winding || sign_.report.method == SignMethod::parity;
  }

  const MeshView before_, after_;
  DistanceField& field_;
  ComputeOptions options_;
  ProgressMeter progress_;
  MeshChange change_;
  std::optional<Plan> plan_;
  SignPlan sign_;
  std::uint64_t hash_ = 0;  // of the new mesh
  std::vector<NewWindow> windows_;
  UpdateReport report_;
};

// Puts the tiles of windows into a field.
class TileMerge {
 public:
  explicit TileMerge(DistanceField& field) : field_(field) {}

  void take(const NewWindow& window) {
    const Size3 tiles = DistanceField::tiles_of(window.grid.size);
    Size3 shift;
    for (std::size_t axis = 0; axis < 3; ++axis)
      shift[axis] = (window.grid.first[axis] - field_.grid().first[axis]) / kTileSide;
    auto slot = window.slots.begin();
    for (std::int64_t tz = 0; tz < tiles.z; ++tz)
      for (std::int64_t ty = 0; ty < tiles.y; ++ty)
        for (std::int64_t tx = 0; tx < tiles.x; ++tx) {
          const Size3 at{tx + shift.x, ty + shift.y, tz + shift.z};
          if (*slot >= 0)
            store(window, *slot, at);
          else
            clear(*slot == DistanceField::kInside, at);
          ++slot;
        }
  }
  // Takes out the tiles that are no longer stored. Returns how many tiles changed.
  std::int64_t finish() {
    field_.erase_tiles(erased_);
    for (const Size3& at : inside_) field_.mark_inside(at.x, at.y, at.z);
    return changed_;
  }

 private:
  bool is_stored(const Size3& at) const { return field_.tile(at.x, at.y, at.z).has_value(); }

  void store(const NewWindow& window, std::int32_t slot, const Size3& at) {
    const bool is_new = !is_stored(at);
    bool changed = put(NewWindow::tile(window.values, slot),
                       is_new ? field_.store_tile(at.x, at.y, at.z) : field_.edit_tile(at.x, at.y, at.z));
    if (field_.has_nearest())
      changed |= put(NewWindow::tile(window.nearest, slot), field_.store_nearest(at.x, at.y, at.z));
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

  DistanceField& field_;
  std::vector<Size3> erased_, inside_;
  std::int64_t changed_ = 0;
};

UpdateReport FieldUpdate::run(std::span<const std::uint32_t> changed) {
  Threads threads(options_.execution.threads);
  std::string anew;
  Stopwatch watch;
  threads.run([&] {
    progress_.stage("prepare", 1, 0, 0.1);
    check_field();
    anew = global_reason();
    if (anew.empty()) anew = find_windows(changed);
    if (anew.empty()) anew = decide_sign();
    if (anew.empty()) hash_mesh();
  });
  report_.seconds.prepare = watch.lap();
  if (!anew.empty()) {
    compute_anew(std::move(anew));
    report_.seconds.compute = watch.lap();
    return report_;
  }
  threads.run([&] {
    std::vector<Grid> grids;
    for (const NewWindow& window : windows_) grids.push_back(window.grid);
    const double reach = reach_beyond_rounding(plan_->grid, plan_->thickness);
    const std::vector<WindowTriangles> triangles =
        triangles_of(after_, plan_->grid, grids, reach, by_rows(), progress_);
    report_.seconds.prepare += watch.lap();
    progress_.stage("gather", static_cast<std::int64_t>(windows_.size()), 0.1, 0.9);
    DistanceField scratch;  // keeps its memory from window to window
    for (std::size_t n = 0; n < windows_.size(); ++n) {
      compute(triangles[n], windows_[n].grid, scratch);
      report_.seconds.compute += watch.lap();
      sign(triangles[n], scratch);
      windows_[n].copy(scratch);
      report_.seconds.sign += watch.lap();
      progress_.advance();
    }
    progress_.stage("merge", 1, 0.9, 1);
    merge();
  });
  report_.seconds.merge = watch.lap();
  return report_;
}

void expect_arrays(const MeshView& mesh, const char* which) {
  if ((mesh.triangles.data() || mesh.triangles.empty()) && (mesh.vertices.data() || mesh.vertices.empty())) return;
  throw Error(ErrorCode::usage, std::string("update: an array of the mesh ") + which +
                                    " is null but said not to be empty; give its address");
}

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

std::string FieldUpdate::find_windows(std::span<const std::uint32_t> changed) {
  const Grid grid = field_.grid();
  const Plan whole =
      make_plan(static_cast<std::int64_t>(after_.triangles.size()), grid, field_.thickness(), options_, false);
  change_ = change_of(before_, after_, changed);
  report_.triangles_changed = std::ssize(change_.triangles);
  if (change_.triangles.size() > after_.triangles.size() / 2) return "more than half of the triangles changed";
  DirtyBricks dirty(grid);
  dirty.mark_reached(change_, reach_beyond_rounding(grid, whole.thickness));
  if (options_.sign.method != SignMethod::none && options_.sign.method != SignMethod::shell)
    for (const Box& box : enclosing_boxes(change_)) dirty.mark(box.grown(rounding_of_places(grid)));
  if (2 * dirty.count() > dirty.all()) return "more than half of the grid may change";
  for (const Grid& window : dirty.windows()) windows_.push_back({window, {}, {}, {}});
  report_.windows = std::ssize(windows_);
  plan_ = make_plan(whole.triangles, grid, field_.thickness(), options_, false, largest_window());
  check_mesh(after_, *plan_, options_);
  return {};
}

Size3 FieldUpdate::largest_window() const {
  Size3 largest{1, 1, 1};
  for (const NewWindow& window : windows_)
    for (std::size_t axis = 0; axis < 3; ++axis) largest[axis] = std::max(largest[axis], window.grid.size[axis]);
  return largest;
}

// The same as plan_sign() where a closed mesh takes as it is what it crosses: then samples keep their side outside the
// boxes around changed triangles. All else may change the sign anywhere.
std::string FieldUpdate::decide_sign() {
  const SignMethod asked = options_.sign.method;
  if (asked == SignMethod::automatic || asked == SignMethod::winding) {
    if (!is_closed(after_).oriented || !was_closed(true))
      return "the mesh is not closed, or was not, so that its sign is decided for the whole field";
    if (!options_.sign.as_oriented && !faces_outwards(after_))
      return "parts of the mesh may be inside out or nested, which is decided for the whole mesh";
    sign_.report.method = SignMethod::winding;
    sign_.report.why = "the mesh is closed and consistently oriented";
  } else {
    sign_ = plan_sign(after_, options_.sign, progress_);
    if (asked == SignMethod::parity && !was_closed(false)) return "the mesh was not closed";
  }
  if (written(sign_text_of(options_.sign, sign_.report)) != field_.provenance().sign)
    return "the field's sign was decided in another way";
  return {};
}

// Requires that the new mesh is closed.
bool FieldUpdate::was_closed(bool oriented) const {
  const auto in = [&](const MeshView& mesh) {
    const auto end = std::ranges::lower_bound(change_.triangles, mesh.triangles.size());
    return std::span(change_.triangles.begin(), end);
  };
  const Closed same = same_edges(before_, in(before_), after_, in(after_));
  return oriented ? same.oriented : same.unoriented;
}

void FieldUpdate::compute(const WindowTriangles& triangles, const Grid& window, DistanceField& field) {
  field.reset(window, field_.thickness(), field_.has_nearest());
  report_.tiles_computed += tile_count(window.size);
  if (triangles.near.empty()) return;
  const BackendRow& row = find_backend(options_.execution.backend, options_.method, std::ssize(triangles.near), window);
  const ProgressCallback check = [this](const Progress&) {
    progress_.check();
    return true;
  };
  ProgressMeter meter(check);
  Sink sink(field);
  row.run({.mesh = after_,
           .kept = triangles.near,
           .grid = window,
           .thickness = plan_->thickness,
           .threads = plan_->threads,
           .simd = options_.execution.simd,
           .progress = meter,
           .devices = plan_->devices},
          sink);
}

void FieldUpdate::sign(const WindowTriangles& triangles, DistanceField& field) {
  if (sign_.report.method == SignMethod::none) return;
  if (sign_.report.method == SignMethod::shell)
    return apply(Shell(options_.sign, field_.thickness()), field, progress_);
  const MeshPart part(OrientedMesh{after_}, triangles.crossed);
  const UnsignedField window{field.grid(), field_.thickness(), {}, crossing_bytes(*plan_)};
  const auto signs = make_signs_of_window(part.oriented(), sign_, options_.sign, window, progress_);
  sign_field(*signs, options_.sign.invert, field.grid(), field, progress_);
}

void FieldUpdate::merge() {
  Provenance provenance = field_.provenance();
  provenance.mesh_hash = hash_;
  try {
    TileMerge merge(field_);
    for (const NewWindow& window : windows_) merge.take(window);
    report_.tiles_changed = merge.finish();
  } catch (...) {
    field_ = {};
    throw;
  }
  field_.set_provenance(std::move(provenance));
  report_.tiles_stored = field_.stored_tiles();
  report_.sign = sign_.report;
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

}  // namespace

UpdateReport update_field(MeshView before, MeshView after, std::span<const std::uint32_t> changed, DistanceField& field,
                          const ComputeOptions& options) try {
  validate(field.thickness(), options);
  return FieldUpdate(before, after, field, options).run(changed);
} catch (...) {
  throw_as_error("update", kWithLessMemory);
}

}  // namespace standoff
