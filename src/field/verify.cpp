// SPDX-License-Identifier: Apache-2.0
// Verifies a field: its distances, nearest triangles and signs, each by other means than compute() uses.
#include "standoff/verify.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <optional>
#include <random>
#include <utility>
#include <vector>

#include "core/guarded.h"
#include "core/progress.h"
#include "core/threads.h"
#include "field/reference.h"
#include "field/skip.h"
#include "geometry/rounding.h"
#include "sign/diagnosis/closed.h"
#include "sign/diagnosis/mesh_edges.h"
#include "sign/diagnosis/orient.h"
#include "sign/outer/outer.h"
#include "sign/sign_text.h"

namespace standoff {

namespace {

// The sign of a point by the reference.
struct PointSign {
  std::optional<bool> inside;     ///< empty if it is undefined on the surface, hidden by rounding, or cannot be judged
  std::optional<double> winding;  ///< the reference's winding number, if it decided the sign
};

// Decides signs by the definition of the field's sign method, without the code that computed them.
class SignJudge {
 public:
  /// `use` as in OrientedMesh. The mesh and the groups must outlive this. Runs on the threads of the calling TBB arena.
  SignJudge(MeshView mesh, const TriangleGroups& groups, const SignText& sign, std::vector<std::int8_t> use);

  /// Whether any sign can be judged. With `flood` this is possible only for points beyond the mesh's box; with `normal`
  /// for points on the same side of all nearest triangles; with `shell`, or with `parity` or `facet` on a mesh that is
  /// not closed, for none.
  bool can_judge() const { return by_ != By::none; }
  /// `allowed`: the error that the point's distance may have, world units.
  PointSign judge(const Vec3& p, double allowed) const;

 private:
  enum class By { none, crossings, angles, box, nearest };

  PointSign by_winding(const Vec3& p) const;
  std::optional<bool> behind_nearest(const Vec3& p, double allowed) const;
  bool is_inside(double whole) const;

  OrientedMesh mesh_;
  const TriangleGroups& groups_;
  SignText sign_;
  std::vector<std::int8_t> use_;
  By by_ = By::none;
  Box box_;
};

// Checks edge by edge, without the hashes that compute() relies on.
Closed closed_in_use(const OrientedMesh& mesh) {
  Closed closed{true, true};
  MeshEdges(mesh.mesh).for_each([&](std::span<const HalfEdge> uses) {
    std::int64_t forward = 0, count = 0;
    for (const HalfEdge& one : uses) {
      const int use = mesh.use_of(one.triangle);
      forward += one.forward ? use : -use;
      count += use != 0;
    }
    closed.oriented = closed.oriented && forward == 0;
    closed.unoriented = closed.unoriented && count % 2 == 0;
  });
  return closed;
}

// Nearer to a threshold than this, rounding may decide the sign of an open mesh's sample (sign/open_winding).
constexpr double kEitherSign = 1e-9;

bool contains(const Box& box, const Vec3& p) { return min(box.min, p) == box.min && max(box.max, p) == box.max; }

// Whether the edges of the triangles in use cancel, edge by edge.
bool is_closed_in_use(const OrientedMesh& mesh) { return closed_in_use(mesh).oriented; }

SignJudge::SignJudge(MeshView mesh, const TriangleGroups& groups, const SignText& sign, std::vector<std::int8_t> use)
    : groups_(groups), sign_(sign), use_(std::move(use)), box_(bounds(mesh)) {
  mesh_ = {mesh, use_};
  if (sign.method == SignMethod::flood) by_ = By::box;
  if (sign.method == SignMethod::normal) by_ = By::nearest;
  if (sign.method == SignMethod::facet && closed_in_use(mesh_).oriented) by_ = By::crossings;
  if (sign.method == SignMethod::parity && closed_in_use(mesh_).unoriented) by_ = By::crossings;
  if (sign.method == SignMethod::winding) by_ = closed_in_use(mesh_).oriented ? By::crossings : By::angles;
}

bool SignJudge::is_inside(double whole) const {
  const bool odd = std::fmod(std::abs(whole), 2) == 1;
  if (sign_.method == SignMethod::parity || sign_.rule == WindingRule::odd) return odd;
  return sign_.rule == WindingRule::nonzero ? whole != 0 : whole > 0;
}

PointSign SignJudge::by_winding(const Vec3& p) const {
  const ReferenceWinding winding =
      by_ == By::crossings ? winding_by_crossings(mesh_, groups_, p) : winding_by_angles(mesh_, p);
  // All rules depend only on the nearest whole number, so the sign changes at the halves.
  const double whole = std::round(winding.value);
  const double from_whole = std::abs(winding.value - whole) + winding.error;
  if (winding.on_surface || !(from_whole < 0.5 - kEitherSign)) return {};
  return {is_inside(whole), winding.value};
}

// The normal of the nearest feature is a sum of its triangles' normals, with positive weights. If all triangles that
// may be the nearest one have p on the same side, so has every such sum.
std::optional<bool> SignJudge::behind_nearest(const Vec3& p, double allowed) const {
  bool front = false, back = false;
  groups_.for_each_within(p, groups_.distance(p) + allowed, [&](std::uint32_t triangle) {
    if (mesh_.use_of(triangle) == 0) return;
    const auto [a, b, c] = mesh_.corners(triangle);
    const Vec3 normal = cross(b - a, c - a);
    // This is NaN for a triangle without area, which has no normal: it decides nothing.
    const double height = dot(p - a, normal) / length(normal);
    front = front || height > allowed;
    back = back || height < -allowed;
  });
  return front == back ? std::nullopt : std::optional(back);
}

PointSign SignJudge::judge(const Vec3& p, double allowed) const {
  PointSign sign;
  if (by_ == By::nearest) sign.inside = behind_nearest(p, allowed);
  if (by_ == By::box && !contains(box_, p)) sign.inside = false;
  if (by_ == By::crossings || by_ == By::angles) sign = by_winding(p);
  if (sign.inside) sign.inside = *sign.inside != sign_.invert;
  return sign;
}

struct Sample {
  std::int64_t i, j, k;
};

// A sample that is drawn: of the grid, or of stored tile number `tile`; the other numbers say where in it.
struct Draw {
  std::int64_t tile = -1;
  std::array<std::uint64_t, 3> at{};
};

// Half of them of stored tiles, if there are any.
std::vector<Draw> draw(std::int64_t count, std::uint64_t seed, std::int64_t stored) {
  // The generator gives the same numbers everywhere; the standard promises nothing of the kind for distributions.
  std::mt19937_64 random(seed);
  std::vector<Draw> draws(static_cast<std::size_t>(count));
  for (std::size_t n = 0; n < draws.size(); ++n) {
    if (n % 2 == 1 && stored > 0)
      draws[n].tile = static_cast<std::int64_t>(random() % static_cast<std::uint64_t>(stored));
    for (std::uint64_t& number : draws[n].at) number = random();
  }
  return draws;
}

// One of the samples of an axis from `first` to before `end`.
std::int64_t one_of(std::uint64_t number, std::int64_t first, std::int64_t end) {
  return first + static_cast<std::int64_t>(number % static_cast<std::uint64_t>(end - first));
}

Sample in_grid(const Draw& draw, const Size3& size) {
  return {one_of(draw.at[0], 0, size.x), one_of(draw.at[1], 0, size.y), one_of(draw.at[2], 0, size.z)};
}

// In a tile of slices that begin at slice `first`.
Sample in_tile(const Draw& draw, const Size3& tile, const Size3& size, std::int64_t first) {
  constexpr std::int64_t side = DistanceField::kTileSide;
  const auto within = [&](std::size_t axis) {
    return one_of(draw.at[axis], tile[axis] * side, std::min((tile[axis] + 1) * side, size[axis]));
  };
  return {within(0), within(1), first + within(2)};
}

struct Finding {
  SampleCheck sample;
  bool in_band = false;
  bool wrong = false;
  bool nearest_wrong = false;
  PointSign sign;
};

// The orientation that the sign was decided with, in the form of OrientedMesh::use. No orientation is right or wrong,
// so verify takes compute()'s answer and checks what follows from it.
std::vector<std::int8_t> oriented_for_sign(MeshView mesh, const SignText& sign) {
  if (!sign.oriented) return {};
  return orient(mesh, MeshEdges(mesh)).use;
}

// The triangles that count for distances, in the form of SignPlan::exposed.
std::vector<std::uint32_t> exposed_in(MeshView mesh, const SignText& sign, const std::vector<std::int8_t>& use,
                                      ProgressMeter& progress) {
  if (!sign.outer) return {};
  const OrientedMesh oriented{mesh, use};
  // SignOptions::outer requires a closed mesh, so this is not the mesh of the field: check it with all triangles.
  if (!is_closed_in_use(oriented)) return {};
  std::vector<std::uint32_t> exposed;
  const std::vector<Exposure> of = find_exposed(oriented, sign.rule, progress).of;
  for (std::uint32_t t = 0; t < of.size(); ++t)
    if (of[t] != Exposure::internal) exposed.push_back(t);
  return exposed;
}

// Groups of these triangles, without copies if they are many; empty if all triangles count.
std::optional<TriangleGroups> groups_with_distances(MeshView mesh, const SignText& sign,
                                                    const std::vector<std::int8_t>& use, ProgressMeter& progress) {
  const std::vector<std::uint32_t> exposed = exposed_in(mesh, sign, use, progress),
                                   distinct = without_many_copies(mesh, exposed, progress);
  const auto& some = distinct.empty() ? exposed : distinct;
  if (some.empty()) return std::nullopt;
  return TriangleGroups(mesh, some);
}

// One field and its mesh. Requires a valid mesh. Runs on the threads of the calling TBB arena.
class Check {
 public:
  Check(const Grid& grid, double thickness, const std::string& sign, MeshView mesh, ProgressMeter& progress)
      : grid_(grid),
        thickness_(thickness),
        sign_(sign_text_in(sign).value_or(SignText{})),
        use_(oriented_for_sign(mesh, sign_)),
        groups_(mesh),
        near_(groups_with_distances(mesh, sign_, use_, progress)),
        judge_(mesh, groups_, sign_, use_) {}

  bool is_shell() const { return sign_.method == SignMethod::shell; }
  bool can_check_sign() const { return is_shell() || judge_.can_judge(); }
  /// `slices` begin at slice `first` of the grid, and have the sample.
  Finding sample(const Sample& at, const DistanceField& slices, std::int64_t first) const;

 private:
  void compare_distance(double distance, Finding& finding) const;
  void compare_shell(double distance, Finding& finding) const;
  void compare_nearest(double distance, std::uint32_t nearest, Finding& finding) const;

  const Grid& grid_;
  const double thickness_;
  // The triangles that count for distances; all triangles count for signs.
  const TriangleGroups& near() const { return near_ ? *near_ : groups_; }

  SignText sign_;
  std::vector<std::int8_t> use_;
  TriangleGroups groups_;
  std::optional<TriangleGroups> near_;
  SignJudge judge_;
};

Finding Check::sample(const Sample& at, const DistanceField& slices, std::int64_t first) const {
  const Vec3 position = grid_.position(at.i, at.j, at.k);
  const double distance = near().distance(position);
  Finding finding;
  SampleCheck& sample = finding.sample;
  sample = {at.i, at.j, at.k, position, slices.value(at.i, at.j, at.k - first)};
  if (is_shell())
    compare_shell(distance - sign_.shell / 2, finding);
  else
    compare_distance(distance, finding);
  if (std::isnan(sample.error)) sample.error = std::numeric_limits<double>::infinity();
  // A grid beyond the range of double has infinite distances, which no comparison can confirm.
  finding.wrong = !(std::isfinite(distance) && sample.error <= sample.allowed);
  if (slices.has_nearest()) compare_nearest(distance, slices.nearest(at.i, at.j, at.k - first), finding);
  return finding;
}

void Check::compare_distance(double distance, Finding& finding) const {
  SampleCheck& sample = finding.sample;
  sample.expected = std::min(distance, thickness_);
  sample.allowed = allowed_error(grid_, sample.expected);
  sample.error = std::abs(std::abs(sample.stored) - sample.expected);
  finding.in_band = distance <= thickness_;
  // The value 0 has no sign. Normals decide signs in the band only; samples beyond take the sign of their surroundings.
  const bool has_sign = sample.stored != 0 && !std::isnan(sample.stored);
  if (has_sign && (finding.in_band || sign_.method != SignMethod::normal))
    finding.sign = judge_.judge(sample.position, sample.allowed);
  if (finding.sign.inside.value_or(false)) sample.expected = -sample.expected;
}

// `value`: the distance from the surface of the thickened sheet.
void Check::compare_shell(double value, Finding& finding) const {
  SampleCheck& sample = finding.sample;
  const double thickness = thickness_;
  sample.expected = std::clamp(value, -thickness, thickness);
  sample.allowed = allowed_error(grid_, value + sign_.shell / 2);
  finding.in_band = std::abs(value) <= thickness;
  if (std::abs(value) > sample.allowed) finding.sign.inside = (value < 0) != sign_.invert;
  if (sign_.invert) sample.expected = -sample.expected;
  sample.error = std::abs(sample.stored - sample.expected);
}

void Check::compare_nearest(double distance, std::uint32_t nearest, Finding& finding) const {
  const SampleCheck& sample = finding.sample;
  // Near the thickness, rounding decides whether a sample has a nearest triangle.
  if (nearest == kNoTriangle)
    finding.nearest_wrong = std::abs(distance - sign_.shell / 2) < thickness_ - sample.allowed;
  else
    finding.nearest_wrong =
        nearest >= groups_.triangle_count() || near().distance(sample.position, nearest) > distance + sample.allowed;
}

void count_sign(const Finding& finding, SignCheck& sign) {
  const SampleCheck& sample = finding.sample;
  sign.negative += sample.stored < 0;
  if (!finding.sign.inside) {
    ++sign.unknown;
    return;
  }
  ++sign.checked;
  if ((sample.stored < 0) == *finding.sign.inside) return;
  if (sign.wrong == 0 || std::abs(sample.expected) > std::abs(sign.worst.expected)) {
    sign.worst = sample;
    sign.worst_winding = finding.sign.winding.value_or(std::numeric_limits<double>::quiet_NaN());
  }
  ++sign.wrong;
}

// A field, or some slices of it at a time.
class Slices {
 public:
  explicit Slices(const DistanceField& field)
      : grid_(field.grid()), thickness_(field.thickness()), whole_(&field), step_(field.grid().size.z) {}
  Slices(const Grid& grid, double thickness, const SliceReader& read, std::int64_t slice_samples)
      : grid_(grid), thickness_(thickness), read_(&read) {
    constexpr std::int64_t kLayer = 32;  // slices of a chunk of a store, which is unpacked once so
    step_ = kLayer * std::max<std::int64_t>(1, slice_samples / (grid.size.x * grid.size.y) / kLayer);
  }

  const Grid& grid() const { return grid_; }
  double thickness() const { return thickness_; }
  std::int64_t parts() const { return (grid_.size.z - 1) / step_ + 1; }
  /// Calls visit(slices, first) for all parts.
  template <class Visit>
  void for_each(const Visit& visit) {
    for (std::int64_t first = 0; first < grid_.size.z; first += step_) visit(part(first), first);
  }
  std::int64_t step() const { return step_; }
  /// The slices from `first` on; they live until the next call.
  const DistanceField& part(std::int64_t first) {
    if (whole_) return *whole_;
    if (first == held_first_) return held_;
    held_ = DistanceField();  // not two at a time
    const std::int64_t count = std::min(step_, grid_.size.z - first);
    held_ = call_back(*read_, first, count);
    if (held_.grid() != grid_.window({0, 0, first}, {grid_.size.x, grid_.size.y, count}) ||
        held_.thickness() != thickness_)
      throw Error(ErrorCode::usage, "verify: " + std::to_string(count) + " slices from slice " + std::to_string(first) +
                                        " on were asked for, and others came; give that window of the field");
    held_first_ = first;
    return held_;
  }

 private:
  const Grid grid_;
  const double thickness_;
  const DistanceField* whole_ = nullptr;
  const SliceReader* read_ = nullptr;
  std::int64_t step_ = 0, held_first_ = -1;
  DistanceField held_;
};

struct Chosen {
  std::vector<Draw> draws;             // none: all samples
  std::vector<std::int64_t> tiles{0};  // stored ones before each part, and at last all
};

Chosen choose(Slices& slices, const VerifyOptions& options, ProgressMeter& progress) {
  Chosen chosen;
  if (slices.grid().sample_count() <= options.samples) return chosen;
  slices.for_each([&](const DistanceField& part, std::int64_t) {
    chosen.tiles.push_back(chosen.tiles.back() + part.stored_tiles());
    progress.advance();
  });
  chosen.draws = draw(options.samples, options.seed, chosen.tiles.back());
  return chosen;
}

// What is to be tested in a part, in the order of the draws: which of them, and the sample.
std::vector<std::pair<std::size_t, Sample>> samples_in(const Chosen& chosen, const Slices& slices,
                                                       const DistanceField& part, std::int64_t first) {
  std::vector<std::pair<std::size_t, Sample>> samples;
  const Size3 size = slices.grid().size, of_part = part.grid().size;
  if (chosen.draws.empty()) {
    auto number = static_cast<std::size_t>(first * size.x * size.y);
    for (std::int64_t k = first; k < first + of_part.z; ++k)
      for (std::int64_t j = 0; j < size.y; ++j)
        for (std::int64_t i = 0; i < size.x; ++i) samples.push_back({number++, {i, j, k}});
    return samples;
  }
  std::vector<Size3> tiles;
  for (const DistanceField::Tile& tile : part.tiles()) tiles.push_back(tile.at);
  const std::int64_t before = chosen.tiles[static_cast<std::size_t>(first / slices.step())];
  for (std::size_t n = 0; n < chosen.draws.size(); ++n) {
    const Draw& draw = chosen.draws[n];
    const std::int64_t tile = draw.tile - before;
    if (draw.tile < 0) {
      const Sample at = in_grid(draw, size);
      if (at.k >= first && at.k < first + of_part.z) samples.push_back({n, at});
    } else if (tile >= 0 && tile < static_cast<std::int64_t>(tiles.size())) {
      samples.push_back({n, in_tile(draw, tiles[static_cast<std::size_t>(tile)], of_part, first)});
    }
  }
  return samples;
}

VerifyResult verify_slices(Slices& slices, MeshView mesh, const VerifyOptions& options) {
  if (options.samples < 1) throw Error(ErrorCode::usage, "verify: at least one sample must be tested; give 1 or more");
  validate("verify", options.execution, Runs::on_the_cpu);
  validate(mesh);

  ProgressMeter progress(options.progress);
  std::vector<Finding> findings(static_cast<std::size_t>(std::min(options.samples, slices.grid().sample_count())));
  VerifyResult result;
  Threads(options.execution.threads).run([&] {
    progress.stage("reading", slices.parts(), 0, 0.05);
    const Chosen chosen = choose(slices, options, progress);
    const Provenance from = slices.part(0).provenance();
    result.sign.method = from.sign;
    result.mesh_differs = from.mesh_hash != 0 && from.mesh_hash != content_hash(mesh);
    progress.stage("sorting the triangles", 1, 0.05, 0.1);
    const Check check(slices.grid(), slices.thickness(), from.sign, mesh, progress);
    result.sign.can_check = check.can_check_sign();
    progress.stage("comparing", static_cast<std::int64_t>(findings.size()), 0.1, 1);
    slices.for_each([&](const DistanceField& part, std::int64_t first) {
      const auto samples = samples_in(chosen, slices, part, first);
      tbb::parallel_for(std::size_t{0}, samples.size(), [&](std::size_t n) {
        findings[samples[n].first] = check.sample(samples[n].second, part, first);
        progress.advance();
      });
    });
  });

  result.samples = static_cast<std::int64_t>(findings.size());
  result.largest = result.worst = findings.front().sample;
  for (const Finding& finding : findings) {
    const SampleCheck& sample = finding.sample;
    result.samples_band += finding.in_band;
    result.samples_wrong += finding.wrong;
    result.nearest_wrong += finding.nearest_wrong;
    count_sign(finding, result.sign);
    if (sample.error > result.largest.error) result.largest = sample;
    if (sample.error / sample.allowed > result.worst.error / result.worst.allowed) result.worst = sample;
  }
  return result;
}

}  // namespace

double allowed_error(const Grid& grid, double distance) {
  const Box box = grid.bounds();
  const double resolution = 4 * std::numeric_limits<double>::epsilon() * std::max(max_norm(box.min), max_norm(box.max));
  return promised_error(distance, grid.max_spacing()) + resolution;
}

VerifyResult verify(const DistanceField& field, MeshView mesh, const VerifyOptions& options) try {
  Slices slices(field);
  return verify_slices(slices, mesh, options);
} catch (...) {
  throw_as_error("verify", "test fewer samples, or provide more memory");
}

VerifyResult verify(const Grid& grid, double thickness, const SliceReader& read, MeshView mesh,
                    const VerifyOptions& options, std::int64_t slice_samples) try {
  validate(grid);
  if (slice_samples < 1) throw Error(ErrorCode::usage, "verify: slices without samples; give 1 or more");
  Slices slices(grid, thickness, read, slice_samples);
  return verify_slices(slices, mesh, options);
} catch (...) {
  throw_as_error("verify", "test fewer samples, or provide more memory");
}

}  // namespace standoff
