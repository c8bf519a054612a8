// SPDX-License-Identifier: Apache-2.0
// Algorithm 2 of the thesis (Fagerjord and Lochehina, 2008): on the CPU, and the public functions, which ask a table
// for the device that the fields are on.
#include "thesis/algorithm_2.h"

#include <algorithm>
#include <cmath>
#include <mutex>
#include <new>
#include <utility>
#include <vector>

#include "core/guarded.h"
#include "core/mesh_copy.h"
#include "core/tile_count.h"
#include "standoff/compute.h"
#include "standoff/error.h"
#include "standoff/thesis.h"

namespace standoff {

namespace cpu {
namespace {

using thesis::Algorithm2Job;
using thesis::HeldField;

// A field of its own, or the caller's.
struct HostField final : HeldField {
  explicit HostField(const DistanceField& callers) : field(&callers) { describe(); }
  explicit HostField(DistanceField&& moved) : own(std::move(moved)), field(&own) { describe(); }

  void describe() {
    grid = field->grid();
    thickness = field->thickness();
  }

  DistanceField own;
  const DistanceField* field;
};

const DistanceField& field_of(const HeldField& held) { return *static_cast<const HostField&>(held).field; }

// Reads single values: faster than DistanceField::value(), which checks its indices.
class Values {
 public:
  explicit Values(const DistanceField& field)
      : tiles_(field.tile_count()),
        slots_(field.slots().data()),
        values_(field.tile_values().data()),
        outside_(static_cast<float>(field.thickness())) {}

  float operator()(std::int64_t u, std::int64_t v, std::int64_t w) const {
    const std::int64_t tile = u / kTileSide + tiles_.x * (v / kTileSide + tiles_.y * (w / kTileSide));
    const std::int32_t slot = slots_[tile];
    // Where no tile is stored no sample has a value, neither outside nor inside.
    if (slot < 0) return outside_;
    return values_[std::int64_t{slot} * kTileSamples + u % kTileSide +
                   kTileSide * (v % kTileSide + kTileSide * (w % kTileSide))];
  }

 private:
  Size3 tiles_;
  const std::int32_t* slots_;
  const float* values_;
  float outside_;
};

// Calls use(i, j, k, value) for each sample of the stored tiles, x fastest, until it returns false.
template <class Use>
void for_each_stored(const DistanceField& field, Use use) {
  const Size3 size = field.grid().size, tiles = field.tile_count();
  const std::span<const std::int32_t> slots = field.slots();
  const std::span<const float> values = field.tile_values();
  for (std::int64_t k = 0; k < size.z; ++k)
    for (std::int64_t j = 0; j < size.y; ++j) {
      const std::int64_t row = tiles.x * (j / kTileSide + tiles.y * (k / kTileSide));
      const std::int64_t in_tile = kTileSide * (j % kTileSide + kTileSide * (k % kTileSide));
      for (std::int64_t tile = 0; tile < tiles.x; ++tile) {
        const std::int32_t slot = slots[static_cast<std::size_t>(row + tile)];
        if (slot < 0) continue;
        const float* const at = values.data() + std::int64_t{slot} * kTileSamples + in_tile;
        const std::int64_t first = tile * kTileSide, end = std::min<std::int64_t>(size.x, first + kTileSide);
        for (std::int64_t i = first; i < end; ++i)
          if (!use(i, j, k, at[i - first])) return;
      }
    }
}

// Calls use(index of the sample, sum) for each sample that has a sum, until it returns false.
template <class Use>
void for_each_sum(const Algorithm2Job& job, Use use) {
  // A field without tiles has no value; an empty one has not even slots.
  if (field_of(job.visited).stored_tiles() == 0 || field_of(job.other).stored_tiles() == 0) return;
  const thesis::PosedField visited = job.visited.at(job.of_visited), other = job.other.at(job.of_other);
  const Values values(field_of(job.other));
  for_each_stored(field_of(job.visited), [&](std::int64_t i, std::int64_t j, std::int64_t k, float value) {
    const double sum = thesis::sum_at(visited, i, j, k, value, other, values);
    return std::isinf(sum) || use(visited.grid.index(i, j, k), sum);
  });
}

class HostMoving final : public thesis::MovingField {
 public:
  HostMoving(const Mesh& mesh, const thesis::MinimumRule& rule, const Execution& execution)
      : mesh_(mesh), moved_(mesh), rule_(rule), held_(DistanceField()) {
    options_.method = Method::thesis;
    options_.skip = {SkipRule::Kind::none};
    options_.sign = {SignMethod::none};
    options_.hash_mesh = false;
    options_.execution = execution;
    options_.execution.backend = Backend::cpu;
  }

  const HeldField& move_to(const Pose& pose) override {
    std::ranges::transform(mesh_.vertices, moved_.vertices.begin(), [&](Vec3 v) { return apply(pose, v); });
    const Grid grid = minimum_grid(bounds(moved_), rule_.thickness, rule_.e, rule_.speed);
    compute_into(moved_, grid, rule_.thickness, held_.own, options_);
    held_.describe();
    return held_;
  }

 private:
  const Mesh& mesh_;
  Mesh moved_;
  thesis::MinimumRule rule_;
  ComputeOptions options_;
  HostField held_;
};

std::shared_ptr<const HeldField> hold_field(DistanceField field, int) {
  return std::make_shared<HostField>(std::move(field));
}

std::unique_ptr<thesis::MovingField> moving_field(const Mesh& mesh, const thesis::MinimumRule& rule,
                                                  const Execution& execution) {
  return std::make_unique<HostMoving>(mesh, rule, execution);
}

std::int64_t first_below(const Algorithm2Job& job, double threshold) {
  std::int64_t first = thesis::kNoSample;
  for_each_sum(job, [&](std::int64_t index, double sum) {
    if (sum < threshold) first = index;
    return first == thesis::kNoSample;
  });
  return first;
}

double least_sum(const Algorithm2Job& job) {
  double least = std::numeric_limits<double>::infinity();
  for_each_sum(job, [&](std::int64_t, double sum) {
    least = std::min(least, sum);
    return true;
  });
  return least;
}

}  // namespace

const thesis::Algorithm2Functions kAlgorithm2{hold_field, moving_field, first_below, least_sum};

}  // namespace cpu

struct ThesisFieldAccess {
  static const thesis::HeldField& held(const ThesisField& field) { return *field.held_; }
  static const thesis::Algorithm2Row& row(const ThesisField& field) { return *field.row_; }
  static int device(const ThesisField& field) { return field.device_; }
};

namespace {

using thesis::Algorithm2Functions;
using thesis::Algorithm2Job;
using thesis::Algorithm2Row;
using thesis::HeldField;

// Whether the boxes of two grids overlap in the world, on all three axes of the first grid's frame.
bool boxes_overlap(const HeldField& a, const Pose& pose_a, const HeldField& b, const Pose& pose_b) {
  const Box box = b.grid.bounds(), mine = a.grid.bounds();
  Box theirs;
  for (int corner = 0; corner < 8; ++corner)
    theirs.include(
        apply_inverse(pose_a, apply(pose_b, {corner & 1 ? box.max.x : box.min.x, corner & 2 ? box.max.y : box.min.y,
                                             corner & 4 ? box.max.z : box.min.z})));
  return theirs.min.x <= mine.max.x && mine.min.x <= theirs.max.x && theirs.min.y <= mine.max.y &&
         mine.min.y <= theirs.max.y && theirs.min.z <= mine.max.z && mine.min.z <= theirs.max.z;
}

// Calls use(job) with the field of fewer samples to be visited, b of two equal ones; not if the boxes are apart, as the
// thesis too finds out on the CPU.
template <class Use>
void with_job(const HeldField& a, const Pose& pose_a, const HeldField& b, const Pose& pose_b, int device, Use use) {
  validate(pose_a);
  validate(pose_b);
  const bool swaps = a.grid.sample_count() < b.grid.sample_count();
  const Algorithm2Job job =
      swaps ? Algorithm2Job{a, pose_a, b, pose_b, device} : Algorithm2Job{b, pose_b, a, pose_a, device};
  if (boxes_overlap(job.other, job.of_other, job.visited, job.of_visited)) use(job);
}

ThesisCollisionResult collide(decltype(Algorithm2Functions::first_below) first_below, const HeldField& a,
                              const Pose& pose_a, const HeldField& b, const Pose& pose_b, double threshold,
                              int device) {
  if (!(threshold > 0))
    throw Error(ErrorCode::usage, "collide: the threshold must be positive; thesis_sum() helps to choose it");
  ThesisCollisionResult result;
  with_job(a, pose_a, b, pose_b, device, [&](const Algorithm2Job& job) {
    const std::int64_t first = first_below(job, threshold);
    result.hit = first != thesis::kNoSample;
    result.samples = result.hit ? first + 1 : job.visited.grid.sample_count();
  });
  return result;
}

double least_of(decltype(Algorithm2Functions::least_sum) least_sum, const HeldField& a, const Pose& pose_a,
                const HeldField& b, const Pose& pose_b, int device) {
  double least = std::numeric_limits<double>::infinity();
  with_job(a, pose_a, b, pose_b, device, [&](const Algorithm2Job& job) { least = least_sum(job); });
  return least;
}

using Access = ThesisFieldAccess;

// Throws Error{usage} unless one device can read both.
void expect_together(const ThesisField& a, const ThesisField& b) {
  if (&Access::row(a) == &Access::row(b) && Access::device(a) == Access::device(b)) return;
  const auto place = [](const ThesisField& field) {
    const BackendInfo& info = *find_info(field.backend());
    return info.name + (info.has_devices ? ":" + std::to_string(Access::device(field)) : std::string());
  };
  throw Error(ErrorCode::usage, "collide: the fields are on different devices, " + place(a) + " and " + place(b) +
                                    "; give both the same execution");
}

const Algorithm2Row& row_for(const Execution& execution) {
  validate("collide", execution, Runs::everywhere);
  return thesis::find_algorithm_2(execution.backend);
}

// Only the GPUs of CUDA are counted.
int device_of(const Algorithm2Row& row, const Execution& execution) {
  return find_info(row.backend)->has_devices ? execution.device : 0;
}

}  // namespace

ThesisCollisionResult collide_thesis(const DistanceField& a, const Pose& pose_a, const DistanceField& b,
                                     const Pose& pose_b, double threshold) try {
  return collide(cpu::kAlgorithm2.first_below, cpu::HostField(a), pose_a, cpu::HostField(b), pose_b, threshold, 0);
} catch (...) {
  throw_as_error("collide");
}

double thesis_sum(const DistanceField& a, const Pose& pose_a, const DistanceField& b, const Pose& pose_b) try {
  return least_of(cpu::kAlgorithm2.least_sum, cpu::HostField(a), pose_a, cpu::HostField(b), pose_b, 0);
} catch (...) {
  throw_as_error("collide");
}

ThesisField::ThesisField(DistanceField field, const Execution& execution) try
    : row_(&row_for(execution)), device_(device_of(*row_, execution)) {
  held_ = row_->run.hold(std::move(field), device_);
} catch (...) {
  throw_as_error("collide");
}

const Grid& ThesisField::grid() const { return held_->grid; }
double ThesisField::thickness() const { return held_->thickness; }
Backend ThesisField::backend() const { return row_->backend; }
std::string ThesisField::device_name() const { return row_->device_name(device_); }

ThesisCollisionResult collide_thesis(const ThesisField& a, const Pose& pose_a, const ThesisField& b, const Pose& pose_b,
                                     double threshold) try {
  expect_together(a, b);
  return collide(Access::row(a).run.first_below, Access::held(a), pose_a, Access::held(b), pose_b, threshold,
                 Access::device(a));
} catch (...) {
  throw_as_error("collide");
}

double thesis_sum(const ThesisField& a, const Pose& pose_a, const ThesisField& b, const Pose& pose_b) try {
  expect_together(a, b);
  return least_of(Access::row(a).run.least_sum, Access::held(a), pose_a, Access::held(b), pose_b, Access::device(a));
} catch (...) {
  throw_as_error("collide");
}

struct MinimumField::State {
  const Algorithm2Row& row;
  Execution execution;
  Mesh mesh;
  thesis::MinimumRule rule;
  std::mutex mutex;                                             // of the next
  std::vector<std::unique_ptr<thesis::MovingField>> idle = {};  // whose fields nobody reads

  std::unique_ptr<thesis::MovingField> take() {
    {
      const std::lock_guard lock(mutex);
      if (!idle.empty()) {
        std::unique_ptr<thesis::MovingField> one = std::move(idle.back());
        idle.pop_back();
        return one;
      }
    }
    return row.run.moving(mesh, rule, execution);
  }
  void give_back(std::unique_ptr<thesis::MovingField> one) noexcept {
    const std::lock_guard lock(mutex);
    try {
      idle.push_back(std::move(one));
    } catch (const std::bad_alloc&) {
      // Without memory to keep it, it goes.
    }
  }
};

MinimumField::MinimumField(MeshView mesh, double thickness, double e, double speed, const Execution& execution) try {
  const Algorithm2Row& row = row_for(execution);
  validate(mesh);
  minimum_grid(bounds(mesh), thickness, e, speed);  // throws if an argument is not valid
  Execution there = execution;
  there.device = device_of(row, execution);
  state_.reset(new State{row, there, copy_of(mesh), {thickness, e, speed}, {}});
  state_->give_back(state_->take());
} catch (...) {
  throw_as_error("collide");
}

Backend MinimumField::backend() const { return state_->row.backend; }
std::string MinimumField::device_name() const { return state_->row.device_name(state_->execution.device); }

ThesisField MinimumField::at(const Pose& pose) const try {
  validate(pose);
  std::unique_ptr<thesis::MovingField> moving = state_->take();
  const HeldField& field = moving->move_to(pose);
  std::shared_ptr<thesis::MovingField> in_use(moving.release(), [state = state_](thesis::MovingField* one) {
    state->give_back(std::unique_ptr<thesis::MovingField>(one));
  });
  return {std::shared_ptr<const HeldField>(std::move(in_use), &field), &state_->row, state_->execution.device};
} catch (...) {
  throw_as_error("collide");
}

}  // namespace standoff
