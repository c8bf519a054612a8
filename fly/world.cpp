// SPDX-License-Identifier: Apache-2.0
// Worlds: bodies that fly among resting ones. What a world holds, how it changes between two runs, how bodies fly, and
// their paths as files.

#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <charconv>
#include <cmath>
#include <functional>
#include <limits>
#include <mutex>
#include <numbers>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "core/hashes.h"
#include "core/threads.h"
#include "files/atomic_file.h"
#include "fly/crossing_check.h"
#include "fly/world.h"
#include "standoff/compute.h"
#include "standoff/error.h"
#include "standoff/execution.h"
#include "standoff/field.h"
#include "standoff/points.h"
#include "standoff/thesis.h"

namespace standoff::fly {

// All that a world holds.
struct World::State {
  // The moving body's field, for Algorithm 2, where the body is at a pose; and the pose of the field.
  using FieldAt = std::function<std::pair<ThesisField, Pose>(const Pose& pose)>;

  struct Resting {
    Body model;
    Pose pose;
    double tolerance;                  // of sweeps; fliers start twice as far away
    std::optional<ThesisField> field;  // thesis mode
    std::optional<CrossingCheck> check;
    std::optional<MeshQuery> query;  // of the model's mesh, once distances were asked for
  };

  Body flier;
  FlightOptions options;
  std::vector<Resting> resting = {};
  std::vector<Flier> fliers = {};
  FieldAt field_at = {};  // in thesis mode
  Backend backend = Backend::cpu;
  std::string device_name = {};
  std::vector<Vec3> marks = {};  // the points whose paths are checked

  // Compute what the options need of the moving body and of a resting one. An existing check is kept.
  void prepare();
  void prepare(Resting& body) const;
  Execution execution() const;
  ThesisField thesis_field(const Body& model) const;

  void step(Flier& it) const;
  bool leaves_bounds(const Pose& pose) const;
  bool thesis_hit(const Pose& at) const;
  bool thesis_step(Flier& it, const Pose& next) const;
  bool sweep_step(Flier& it, Pose& next) const;
};

namespace {

// Errors: usage.
void check_options(const FlightOptions& o) {
  const auto fail = [](const char* what) { throw Error(ErrorCode::usage, std::string("flight: ") + what); };
  if (!(o.speed >= 0) || !std::isfinite(o.speed))
    fail("the speed must be zero or more, and finite; give world units a step");
  if (!(o.scatter_rad >= 0 && o.scatter_rad <= std::numbers::pi))
    fail("the scatter must be from 0 to pi; 0 turns that off");
  if (!(o.tolerance >= 0) || !std::isfinite(o.tolerance))
    fail("the tolerance must be zero or more, and finite; give a small part of the bodies' size, or 0");
  if (!(o.thickness > 0) || !std::isfinite(o.thickness))
    fail("the thickness must be positive and finite; give a few steps' length");
  if (!(o.threshold >= 0) || !std::isfinite(o.threshold))
    fail("the threshold must be zero or more, and finite; 0 takes the larger spacing");
  if (o.threads < 0 || o.threads > kMaxThreads) fail("the number of threads must be from 0 to 1024; 0 takes all cores");
}

}  // namespace

// A flight runs in an arena of its own, whose threads Algorithm 1 takes.
Execution World::State::execution() const { return {.backend = options.backend, .device = options.device}; }

ThesisField World::State::thesis_field(const Body& model) const {
  const Grid grid = minimum_grid(model.bounds(), options.thickness, options.minimum, options.speed);
  ComputeOptions compute_options{.sign = {SignMethod::none}, .execution = {.threads = options.threads}};
  return ThesisField(compute(model.mesh(), grid, options.thickness, compute_options).field, execution());
}

void World::State::prepare() {
  if (options.check && marks.empty()) marks = outermost_points(flier.mesh());
  const auto take = [this](const auto& fields, FieldAt made) {
    backend = fields.backend();
    device_name = fields.device_name();
    field_at = std::move(made);
  };
  if (options.mode != FlightMode::thesis) {
    field_at = nullptr;
    backend = Backend::cpu;
    device_name.clear();
  } else if (options.recompute) {
    const MinimumField anew(flier.mesh(), options.thickness, options.minimum, options.speed, execution());
    take(anew, [anew](const Pose& pose) { return std::pair(anew.at(pose), Pose()); });
  } else {
    const ThesisField once = thesis_field(flier);
    take(once, [once](const Pose& pose) { return std::pair(once, pose); });
  }
}

void World::State::prepare(Resting& body) const {
  body.tolerance = options.tolerance > 0 ? options.tolerance : automatic_tolerance(body.model, flier);
  body.field.reset();
  if (options.mode == FlightMode::thesis) body.field.emplace(thesis_field(body.model));
  if (options.check && !body.check) body.check.emplace(body.model.mesh(), body.pose);
}

const FlightOptions& World::options() const { return state_->options; }

void World::set_options(const FlightOptions& options) {
  check_options(options);
  // Into a copy: what fails changes nothing.
  State changed = *state_;
  changed.options = options;
  changed.prepare();
  for (State::Resting& body : changed.resting) changed.prepare(body);
  *state_ = std::move(changed);
}

void World::restore_flier(const Flier& flier) {
  validate(flier.pose);
  if (!(std::abs(length(flier.direction) - 1) < 1e-6))
    throw Error(ErrorCode::usage, "flight: a direction is not one long; give a unit vector");
  state_->fliers.push_back(flier);
}

void World::keep_fliers(std::size_t count) {
  if (count < state_->fliers.size()) state_->fliers.resize(count);
}

void World::wall_distances(std::span<double> out) {
  if (out.size() != state_->fliers.size())
    throw Error(ErrorCode::usage, "flight: there are " + std::to_string(state_->fliers.size()) +
                                      " moving bodies; give room for as many distances");
  std::vector<Vec3> points(out.size());
  std::vector<double> distances(out.size());
  std::ranges::fill(out, std::numeric_limits<double>::infinity());
  const Vec3 middle = state_->flier.bounds().center();
  for (State::Resting& body : state_->resting) {
    if (!body.query)
      body.query.emplace(body.model.mesh(), MeshQueryOptions{.sign = {SignMethod::none},
                                                             .execution = {.threads = state_->options.threads}});
    for (std::size_t n = 0; n < points.size(); ++n)
      points[n] = apply_inverse(body.pose, apply(state_->fliers[n].pose, middle));
    // One by one: points far from each other have no triangles in common, and are slow to ask for together.
    for (std::size_t n = 0; n < points.size(); ++n) {
      body.query->distances({&points[n], 1}, {&distances[n], 1}, {.execution = {.threads = 1}});
      out[n] = std::min(out[n], distances[n]);
    }
  }
}

namespace {

constexpr int kTries = 10'000;
// Steps of one flier between two reports of progress, if a step is short: the CPU takes microseconds for it. Else it
// reports after each.
constexpr std::int64_t kStepsAtOnce = 1000;

// Numbers in [0, 1) from a state of 64 bits.
double draw(std::uint64_t& state) {
  const std::uint64_t bits = splitmix64(state);
  state += kSplitmixStep;
  return static_cast<double>(bits >> 11) * 0x1p-53;
}

Vec3 random_direction(std::uint64_t& state) {
  const double z = 2 * draw(state) - 1, angle = 2 * std::numbers::pi * draw(state), r = std::sqrt(1 - z * z);
  return {r * std::cos(angle), r * std::sin(angle), z};
}

Vec3 unit(Vec3 v) { return v * (1 / length(v)); }

// At random within an angle of `direction`.
Vec3 scattered(Vec3 direction, double angle_rad, std::uint64_t& state) {
  if (!(angle_rad > 0)) return direction;
  const Vec3 across = cross(direction, random_direction(state));
  if (!(length(across) > 1e-6)) return direction;
  const double angle = angle_rad * draw(state);
  return unit(direction * std::cos(angle) + unit(across) * std::sin(angle));
}

}  // namespace

bool World::State::thesis_hit(const Pose& at) const {
  const auto [mine, pose] = field_at(at);
  const double spacing = mine.grid().max_spacing();
  return std::ranges::any_of(resting, [&, &mine = mine, &pose = pose](const Resting& body) {
    const double threshold =
        options.threshold > 0 ? options.threshold : std::max(body.field->grid().max_spacing(), spacing);
    return collide_thesis(*body.field, body.pose, mine, pose, threshold).hit;
  });
}

// True where the flier collides at `next`; it then stays where it is.
bool World::State::thesis_step(Flier& it, const Pose& next) const {
  if (!thesis_hit(next)) return false;
  it.direction = scattered(it.direction * -1.0, options.scatter_rad, it.seed);
  return true;
}

// True where the flier touches something before `next`, which then becomes the pose where it stops: the tolerance short
// of the contact, so that it can separate again.
bool World::State::sweep_step(Flier& it, Pose& next) const {
  SweepResult first;
  double tolerance = 0;
  for (const Resting& body : resting) {
    const SweepResult swept = sweep(body.model, body.pose, flier, {it.pose, next, {}}, {body.tolerance});
    if (swept.hit && (!first.hit || swept.time < first.time)) first = swept, tolerance = body.tolerance;
  }
  if (!first.hit) return false;
  const double time = std::max(0.0, first.time - (options.speed > 0 ? tolerance / options.speed : 0));
  next.translation = it.pose.translation + (next.translation - it.pose.translation) * time;
  const bool mirror = options.on_contact == OnContact::reflect && length(first.normal) > 0;
  const Vec3 away = mirror ? it.direction - first.normal * (2 * dot(first.normal, it.direction)) : it.direction * -1.0;
  it.direction = unit(scattered(unit(away), options.scatter_rad, it.seed));
  return true;
}

bool World::State::leaves_bounds(const Pose& pose) const {
  if (options.bounds.empty()) return false;
  const Vec3 at = apply(pose, flier.bounds().center());
  return min(max(at, options.bounds.min), options.bounds.max) != at;
}

void World::State::step(Flier& it) const {
  Pose next = it.pose;
  next.translation = next.translation + it.direction * options.speed;
  if (leaves_bounds(next)) {
    it.direction = scattered(it.direction * -1.0, options.scatter_rad, it.seed);
    ++it.turns;
    return;
  }
  if (field_at) {
    if (thesis_step(it, next)) {
      ++it.collisions;
      return;
    }
  } else if (sweep_step(it, next)) {
    ++it.collisions;
  }
  if (options.check) {
    bool crossed = false;
    for (const Resting& body : resting)
      for (const Vec3& mark : marks) crossed = crossed || body.check->crosses(apply(it.pose, mark), apply(next, mark));
    it.crossings += crossed;
  }
  it.pose = next;
}

World::World(const Body& flier, const FlightOptions& options) : state_(new State{flier, options}) {
  check_options(options);
  state_->prepare();
}

World::~World() = default;

void World::add(const Body& body, const Pose& pose) {
  validate(pose);
  State::Resting resting{body, pose, 0, {}, {}, {}};
  state_->prepare(resting);
  state_->resting.push_back(std::move(resting));
}

void World::add_flier(const Box& box) {
  if (box.empty() || !is_finite(box.min) || !is_finite(box.max))
    throw Error(ErrorCode::usage,
                "flight: the box to start in is empty or not finite; give one with room for the body");
  Flier it;
  it.seed = state_->options.seed * 0xd1342543de82ef95u + state_->fliers.size() * 0x2545f4914f6cdd1du;
  const Vec3 middle = state_->flier.bounds().center();
  for (int n = 0; n < kTries; ++n) {
    const Vec3 at = box.min + box.extent() * Vec3{draw(it.seed), draw(it.seed), draw(it.seed)};
    it.pose = make_pose({0, 1, 0}, 2 * std::numbers::pi * draw(it.seed), {});
    it.pose.translation = at - rotate(it.pose, middle);
    bool free = true;
    for (const auto& body : state_->resting)
      free = free && !collide(body.model, body.pose, state_->flier, it.pose, {.margin = 2 * body.tolerance}).hit();
    // Nor where the thesis's test would report a collision at every step.
    if (!free) continue;
    if (state_->field_at && Threads(state_->options.threads).run([&] { return state_->thesis_hit(it.pose); })) continue;
    it.direction = random_direction(it.seed);
    state_->fliers.push_back(it);
    return;
  }
  throw Error(ErrorCode::input,
              "flight: no free pose for a moving body in 10,000 tries; give it more room or make it smaller");
}

std::span<const Flier> World::fliers() const { return state_->fliers; }

void World::run(std::int64_t steps, const Visit& visit) {
  if (steps < 0) throw Error(ErrorCode::usage, "flight: the number of steps is negative; give zero or more");
  State& state = *state_;
  std::atomic<std::int64_t> done{0};
  std::atomic<bool> cancelled{false};
  std::mutex telling;
  const double all = static_cast<double>(steps) * static_cast<double>(state.fliers.size());
  const bool short_steps = !state.field_at || (!state.options.recompute && state.backend == Backend::cpu);
  const std::int64_t at_once = short_steps ? kStepsAtOnce : 1;
  const auto fly = [&](std::size_t n) {
    Flier& it = state.fliers[n];
    if (visit) visit(n, 0, it.pose);
    for (std::int64_t k = 0; k < steps && !cancelled; ++k) {
      const std::int64_t before = it.collisions + it.turns;
      state.step(it);
      if (visit && (it.collisions + it.turns != before || k + 1 == steps)) visit(n, k + 1, it.pose);
      if ((k + 1) % at_once != 0 && k + 1 != steps) continue;
      done += k % at_once + 1;
      if (!state.options.progress) continue;
      if (const std::unique_lock lock(telling, std::try_to_lock); lock && !cancelled)
        cancelled = !state.options.progress({"fly", static_cast<double>(done) / all});
    }
  };
  Threads(state.options.threads).run([&] { tbb::parallel_for(std::size_t{0}, state.fliers.size(), fly); });
  if (cancelled)
    throw Error(ErrorCode::interrupted, "flight: cancelled; run it again to go on from where the bodies are");
}

Grid World::grid(std::size_t n) const {
  if (n >= state_->resting.size())
    throw Error(ErrorCode::usage, "flight: there is no resting body " + std::to_string(n) + "; add it first");
  const State::Resting& body = state_->resting[n];
  return body.field ? body.field->grid() : body.model.grid();
}

Grid World::flier_grid() const {
  if (!state_->field_at) return state_->flier.grid();
  const Pose& pose = state_->fliers.empty() ? Pose{} : state_->fliers[0].pose;
  return state_->field_at(pose).first.grid();
}

Backend World::backend() const { return state_->backend; }
std::string World::device_name() const { return state_->device_name; }

namespace {

void write(AtomicFile& file, const std::string& text) { file.write(text.data(), text.size()); }

std::string exact(Vec3 p, char between) {
  std::string text;
  for (const double c : {p.x, p.y, p.z}) {
    // Not printf, which follows the locale.
    std::array<char, 32> number;
    const auto end = std::to_chars(number.begin(), number.end(), c, std::chars_format::general, 17).ptr;
    text.append(number.begin(), end) += between;
  }
  text.back() = '\n';
  return text;
}

void write_csv(AtomicFile& file, std::span<const PathPoint> points) {
  write(file, "flier,step,x,y,z\n");
  for (const PathPoint& p : points)
    write(file, std::to_string(p.flier) + ',' + std::to_string(p.step) + ',' + exact(p.point, ','));
}

void write_ply(AtomicFile& file, std::span<const PathPoint> points) {
  std::size_t edges = 0;
  for (std::size_t n = 1; n < points.size(); ++n) edges += points[n].flier == points[n - 1].flier;
  write(file, "ply\nformat ascii 1.0\nelement vertex " + std::to_string(points.size()) +
                  "\nproperty double x\nproperty double y\nproperty double z\nelement edge " + std::to_string(edges) +
                  "\nproperty int vertex1\nproperty int vertex2\nend_header\n");
  for (const PathPoint& p : points) write(file, exact(p.point, ' '));
  for (std::size_t n = 1; n < points.size(); ++n)
    if (points[n].flier == points[n - 1].flier) write(file, std::to_string(n - 1) + ' ' + std::to_string(n) + '\n');
}

}  // namespace

void write_path(const std::filesystem::path& path, std::span<const PathPoint> points, Existing existing) {
  const std::string extension = path.extension().string();
  if (extension != ".csv" && extension != ".ply")
    throw Error(ErrorCode::usage,
                path.string() + ": a path is written as .csv or .ply; give the file one of these names");
  AtomicFile file(path, existing);
  if (extension == ".csv")
    write_csv(file, points);
  else
    write_ply(file, points);
  file.commit();
}

}  // namespace standoff::fly
