// SPDX-License-Identifier: Apache-2.0
#include "sign/open_winding/tile_signs.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "core/tile_count.h"

namespace standoff {

RowWindings::RowWindings(std::span<const RowCrossing> a, std::span<const RowCrossing> b) {
  runs_.reserve(InsideRows::kRows + a.size() + b.size());
  const auto in_row = [](std::span<const RowCrossing> rest, int row) { return !rest.empty() && rest[0].row() == row; };
  for (int row = 0; row < InsideRows::kRows; ++row) {
    begin_[static_cast<std::size_t>(row)] = runs_.size();
    runs_.push_back({0, 0});
    while (in_row(a, row) || in_row(b, row)) {
      auto& next = !in_row(b, row) || (in_row(a, row) && a[0] < b[0]) ? a : b;
      if (next[0].past() != runs_.back().from) runs_.push_back({next[0].past(), runs_.back().winding});
      runs_.back().winding += next[0].step();
      next = next.subspan(1);
    }
  }
  begin_.back() = runs_.size();
}

namespace {

// A field with such an error decides little. It is less than a quarter, so that the difference of two estimates at a
// sample, the field and the sample's winding number by far fields, tells integers apart.
constexpr double kUseless = 0.24;
// More near rims than kManyRims are summed up in float. Where a cell has more than kVeryManyRims, most of them are a
// few samples away, so that roughly known fields of groups decide more than exact angles of rims.
constexpr std::size_t kManyRims = 64, kVeryManyRims = 256;
// The errors of fields there. Time hardly depends on them. kKnown: in a cell, for good. kRoughInCell: of groups, to
// decide a cell as a whole. kRough: at a sample, at first; then each time by kFiner less, down to kFinest, which is not
// much more than the error of angles in float.
constexpr double kKnown = 3e-4, kRoughInCell = 1e-3, kRough = 4e-3, kFiner = 4, kFinest = 1e-7;
// Few samples are decided one by one.
constexpr int kFewRows = 4;

Rim rim_of(const OpenMesh& mesh, std::int32_t node) { return mesh.rims[static_cast<std::size_t>(mesh.tree[node].rim)]; }

}  // namespace

std::int64_t TileSigns::decide(const SampleBox& tile, const RowWindings& windings, bool smooth, NodeStack::Part nodes,
                               const LinearField& far, std::span<std::uint8_t, InsideRows::kRows> inside) {
  tile_ = tile;
  smooth_ = smooth;
  inside_ = inside;
  doubtful_ = 0;
  undecided_.fill(0);
  for (std::int64_t k = tile.begin[2]; k < tile.end[2]; ++k)
    for (std::int64_t j = tile.begin[1]; j < tile.end[1]; ++j) {
      const std::size_t row = row_of(j, k);
      undecided_[row] = static_cast<std::uint8_t>(0xff >> (kTileSide - (tile.end[0] - tile.begin[0])));
      windings.for_each(static_cast<int>(row), tile.begin[0], tile.end[0],
                        [&](std::int64_t from, std::int64_t to, std::int32_t winding) {
                          for (std::int64_t i = from; i < to; ++i) windings_[kTileSide * row + bit_of(i)] = winding;
                        });
    }
  visit(tile, nodes, far, kFieldTolerance);
  return doubtful_;
}

void TileSigns::visit(const SampleBox& box, NodeStack::Part nodes, LinearField far, double tolerance) {
  if (!has_more_undecided_than(0, box)) return;
  const std::size_t size = stack_.size();
  const Cell cell = cell_of(mesh_.grid, box);
  far.move_to(cell.center);
  std::optional<NodeStack::Part> near = stack_.add_far_up_to(kVeryManyRims, nodes, cell, tolerance, far);
  if (!near) return decide_among_many(box, stack_.root(), {});
  if (!has_more_undecided_than(kFewRows, box)) {
    decide_one_by_one(box, *near, far);
    return stack_.resize(size);
  }

  // Decide most samples by a bound, which is cheaper than a field.
  decide_by_winding(box, far.value, far.reach(cell.half) + stack_.bound_of(*near, cell, 0.5) + kWindingRounding, true);
  if (!has_more_undecided_than(0, box)) return stack_.resize(size);

  if (!decide_by_fields(box, cell, *near, far, tolerance)) {
    stack_.resize(size);
    visit(box, stack_.root(), {}, tolerance / 32);
  } else if (is_smallest(box)) {
    decide_one_by_one(box, *near, far);
  } else {
    for_each_part(box, [&](const SampleBox& part) { visit(part, *near, far, tolerance); });
  }
  stack_.resize(size);
}

// Decides where very many rims are near. Fields that are known well in the cell are known well in its parts too. Those
// of other nodes, which stay closed, are known roughly: that decides most cells.
void TileSigns::decide_among_many(const SampleBox& box, NodeStack::Part nodes, LinearField far) {
  if (!has_more_undecided_than(0, box)) return;
  const std::size_t size = stack_.size();
  const Cell cell = cell_of(mesh_.grid, box);
  far.move_to(cell.center);
  const NodeStack::Part near = stack_.add_far(nodes, cell, kKnown, cell.radius / 2, far);
  if (has_more_undecided_than(kFewRows, box)) {
    LinearField rough = far;
    if (auto rims = stack_.add_far_up_to(kVeryManyRims, near, cell, FieldTolerance::of_groups(kRoughInCell), rough))
      decide_by_fields(box, cell, *rims, rough, kRoughInCell);
    stack_.resize(near.end);
  }
  if (!is_smallest(box))
    for_each_part(box, [&](const SampleBox& part) { decide_among_many(part, near, far); });
  else
    for_each_undecided(box, [&](std::int64_t i, std::int64_t j, std::int64_t k, std::size_t row) {
      const Vec3 p = mesh_.grid.position(i, j, k);
      // Caps larger than the cell are all among the nodes: one by one they take longer than groups from the root.
      if (near.end - near.begin > kVeryManyRims)
        decide_by_sums(row, bit_of(i), p, stack_.root(), {0, 0});
      else
        decide_by_sums(row, bit_of(i), p, near, {far.at(p), far.error});
    });
  stack_.resize(size);
}

// Decides by the fields of near caps too. Moves caps whose field is good enough in the cell from `near` to `far`.
// Returns false if most of the error is due to far caps: then the samples left need their fields more precisely.
bool TileSigns::decide_by_fields(const SampleBox& box, const Cell& cell, NodeStack::Part& near, LinearField& far,
                                 double tolerance) {
  stack_.count(near.end - near.begin);
  // Put the caps first that may touch the cell.
  const std::size_t caps_end = stack_.partition(near, [&](std::size_t n) {
    const Moments& caps = mesh_.tree[stack_[n]].caps;
    return cell.distance_sq(caps.center) <= caps.radius * caps.radius && may_touch(rim_of(mesh_, stack_[n]), cell);
  });
  const bool caps_inside = caps_end != near.begin;
  if (caps_inside && !smooth_) return true;
  // Give up next to a rim: no bound holds there, and smaller cells are needed, whatever the other caps are.
  for (std::size_t n = near.begin; n < near.end; ++n) {
    const Vec3 d = rim_of(mesh_, stack_[n]).corners[0] - cell.center;
    if (dot(d, d) < cell.radius * cell.radius) return true;
  }

  LinearField field = far;
  std::size_t end = near.begin;
  for (std::size_t n = near.begin; n < near.end; ++n) {
    if (field.error < kUseless) {
      const LinearField one = cap_field(rim_of(mesh_, stack_[n]), cell);
      field.add(one);
      if (n >= caps_end && one.error <= tolerance) {
        far.add(one);
        continue;
      }
    }
    stack_.set(end++, stack_[n]);
  }
  near.end = end;
  if (!(field.error < kUseless)) return true;
  if (caps_inside) continue_across_caps(box, near, far, field);
  decide_by_field(box, cell, field, !caps_inside);
  return far.error <= field.error / 2 || far.error <= kWindingRounding || !has_more_undecided_than(kFewRows, box);
}

// Corrects the field of a cell that caps touch and the mesh does not, so that it becomes the winding number of the open
// mesh. It is wrong by an integer only, which the winding number of one sample tells.
void TileSigns::continue_across_caps(const SampleBox& box, NodeStack::Part nodes, const LinearField& far,
                                     LinearField& field) const {
  const std::int64_t i = (box.begin[0] + box.end[0]) / 2, j = (box.begin[1] + box.end[1]) / 2,
                     k = (box.begin[2] + box.end[2]) / 2;
  const Vec3 p = mesh_.grid.position(i, j, k);
  const Interval angles = add_angles(mesh_.rims, mesh_.tree, p, stack_, nodes, {far.at(p), far.error});
  const double winding = windings_[kTileSide * row_of(j, k) + bit_of(i)] + angles.value;
  field.value += std::nearbyint(winding - field.at(p));
}

void TileSigns::decide_by_field(const SampleBox& box, const Cell& cell, const LinearField& field, bool with_windings) {
  decide_by_winding(box, field.value, field.reach(cell.half) + kWindingRounding, with_windings);
  for_each_undecided(box, [&](std::int64_t i, std::int64_t j, std::int64_t k, std::size_t row) {
    const unsigned x = bit_of(i);
    const double windings = with_windings ? windings_[kTileSide * row + x] : 0;
    decide_sample(row, x, windings + field.at(mesh_.grid.position(i, j, k)), field.error + kWindingRounding);
  });
}

// Decides samples of equal integer windings together, if the rest stays within `reach` of `value` in the whole box.
void TileSigns::decide_by_winding(const SampleBox& box, double value, double reach, bool with_windings) {
  if (!(reach < 0.5 - kDoubt)) return;
  std::int32_t last = 0;
  bool sure = false, inside = false;
  const auto classify = [&](std::int32_t winding) {
    last = winding;
    sure = margin(winding + value, mesh_.rule) > reach + kDoubt;
    inside = is_inside(winding + value, mesh_.rule);
  };
  classify(0);
  for (std::int64_t k = box.begin[2]; k < box.end[2]; ++k)
    for (std::int64_t j = box.begin[1]; j < box.end[1]; ++j) {
      const std::size_t row = row_of(j, k);
      unsigned decided = 0, marked = 0;
      for (unsigned x = bit_of(box.begin[0]), end = x + static_cast<unsigned>(box.end[0] - box.begin[0]); x < end;
           ++x) {
        const std::int32_t winding = with_windings ? windings_[kTileSide * row + x] : 0;
        if (winding != last) classify(winding);
        decided |= unsigned{sure} << x;
        marked |= unsigned{sure && inside} << x;
      }
      inside_[row] |= static_cast<std::uint8_t>(marked & undecided_[row]);
      undecided_[row] &= static_cast<std::uint8_t>(~decided);
    }
}

void TileSigns::decide_one_by_one(const SampleBox& box, NodeStack::Part nodes, const LinearField& far) {
  for_each_undecided(box, [&](std::int64_t i, std::int64_t j, std::int64_t k, std::size_t row) {
    const unsigned x = bit_of(i);
    const Vec3 p = mesh_.grid.position(i, j, k);
    if (nodes.end - nodes.begin <= kManyRims &&
        decide_sample(row, x, add_angles(mesh_.rims, mesh_.tree, p, stack_, nodes, {far.at(p), far.error})))
      return;
    decide_by_sums(row, x, p, stack_.root(), {0, 0});
  });
}

// Decides a sample by ever finer sums of all caps' angles: first of those in `nodes`, added to `far`.
void TileSigns::decide_by_sums(std::size_t row, unsigned x, const Vec3& p, NodeStack::Part nodes, Interval far) {
  bool in_range = sum_.begin(p, nodes, far);
  for (double tolerance = kRough; in_range && tolerance > kFinest; tolerance /= kFiner) {
    const Interval sum = sum_.refine(tolerance);
    if (decide_sample(row, x, sum)) return;
    if (far.error > sum.error / 2) in_range = sum_.begin(p, stack_.root(), far = {0, 0});
  }
  if (decide_sample(row, x, cap_sum_at(mesh_.rims, mesh_.tree, p, kFinest / 64, stack_))) return;
  // Only rounding is left: let the value decide.
  const double sum = cap_sum_at(mesh_.rims, mesh_.tree, p, 0, stack_).value;
  decide_sample(row, x, {sum, -kWindingRounding});
}

// Decides a sample by its integer winding number and the caps' angles, if these are on one side of the threshold and
// known well enough to tell whether the sample is doubtful.
bool TileSigns::decide_sample(std::size_t row, unsigned x, const Interval& angles) {
  return decide_sample(row, x, windings_[kTileSide * row + x] + angles.value, angles.error + kWindingRounding);
}

bool TileSigns::decide_sample(std::size_t row, unsigned x, double winding, double error) {
  const double distance = margin(winding, mesh_.rule);
  // NaN decides nothing.
  if (!(distance >= error) || (error > kDoubtError && distance < error + kDoubt)) return false;
  doubtful_ += distance < kDoubt;
  const auto bit = static_cast<std::uint8_t>(1u << x);
  undecided_[row] &= static_cast<std::uint8_t>(~bit);
  if (is_inside(winding, mesh_.rule)) inside_[row] |= bit;
  return true;
}

bool TileSigns::has_more_undecided_than(int few, const SampleBox& box) const {
  int count = 0;
  for (std::int64_t k = box.begin[2]; k < box.end[2]; ++k)
    for (std::int64_t j = box.begin[1]; j < box.end[1]; ++j)
      for (unsigned bits = undecided_[row_of(j, k)] & bits_of(box); bits != 0; bits &= bits - 1)
        if (++count > few) return true;
  return false;
}

}  // namespace standoff
