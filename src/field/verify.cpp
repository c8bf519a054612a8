// SPDX-License-Identifier: Apache-2.0
// Verifies a field: its distances, nearest triangles and signs, each by other means than compute() uses.
#include "standoff/verify.h"

#include <tbb/parallel_for.h>

#include <algorithm>
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

std::vector<Sample> all_samples(const Size3& size) {
  std::vector<Sample> samples;
  for (std::int64_t k = 0; k < size.z; ++k)
    for (std::int64_t j = 0; j < size.y; ++j)
      for (std::int64_t i = 0; i < size.x; ++i) samples.push_back({i, j, k});
  return samples;
}

std::vector<Sample> choose_samples(const DistanceField& field, std::int64_t count, std::uint64_t seed) {
  constexpr std::int64_t side = DistanceField::kTileSide;
  const Size3 size = field.grid().size;
  if (field.grid().sample_count() <= count) return all_samples(size);
  // The generator gives the same numbers everywhere; the standard promises nothing of the kind for distributions.
  std::mt19937_64 random(seed);
  const auto below = [&random](std::int64_t n) {
    return static_cast<std::int64_t>(random() % static_cast<std::uint64_t>(n));
  };
  std::vector<Size3> stored;
  for (const DistanceField::Tile& tile : field.tiles()) stored.push_back(tile.at);
  std::vector<Sample> samples;
  samples.reserve(static_cast<std::size_t>(count));
  for (std::int64_t n = 0; n < count; ++n) {
    if (n % 2 == 0 || stored.empty()) {
      samples.push_back({below(size.x), below(size.y), below(size.z)});
      continue;
    }
    const Size3& tile = stored[static_cast<std::size_t>(below(static_cast<std::int64_t>(stored.size())))];
    const auto within = [&](std::int64_t t, std::int64_t samples_along) {
      return t * side + below(std::min(side, samples_along - t * side));
    };
    samples.push_back({within(tile.x, size.x), within(tile.y, size.y), within(tile.z, size.z)});
  }
  return samples;
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
  Check(const DistanceField& field, MeshView mesh, ProgressMeter& progress)
      : field_(field),
        sign_(sign_text_in(field.provenance().sign).value_or(SignText{})),
        use_(oriented_for_sign(mesh, sign_)),
        groups_(mesh),
        near_(groups_with_distances(mesh, sign_, use_, progress)),
        judge_(mesh, groups_, sign_, use_) {}

  bool is_shell() const { return sign_.method == SignMethod::shell; }
  bool can_check_sign() const { return is_shell() || judge_.can_judge(); }
  Finding sample(const Sample& at) const;

 private:
  void compare_distance(double distance, Finding& finding) const;
  void compare_shell(double distance, Finding& finding) const;
  void compare_nearest(double distance, Finding& finding) const;

  const DistanceField& field_;
  // The triangles that count for distances; all triangles count for signs.
  const TriangleGroups& near() const { return near_ ? *near_ : groups_; }

  SignText sign_;
  std::vector<std::int8_t> use_;
  TriangleGroups groups_;
  std::optional<TriangleGroups> near_;
  SignJudge judge_;
};

Finding Check::sample(const Sample& at) const {
  const Vec3 position = field_.grid().position(at.i, at.j, at.k);
  const double distance = near().distance(position);
  Finding finding;
  SampleCheck& sample = finding.sample;
  sample = {at.i, at.j, at.k, position, field_.value(at.i, at.j, at.k)};
  if (is_shell())
    compare_shell(distance - sign_.shell / 2, finding);
  else
    compare_distance(distance, finding);
  if (std::isnan(sample.error)) sample.error = std::numeric_limits<double>::infinity();
  // A grid beyond the range of double has infinite distances, which no comparison can confirm.
  finding.wrong = !(std::isfinite(distance) && sample.error <= sample.allowed);
  if (field_.has_nearest()) compare_nearest(distance, finding);
  return finding;
}

void Check::compare_distance(double distance, Finding& finding) const {
  SampleCheck& sample = finding.sample;
  sample.expected = std::min(distance, field_.thickness());
  sample.allowed = allowed_error(field_.grid(), sample.expected);
  sample.error = std::abs(std::abs(sample.stored) - sample.expected);
  finding.in_band = distance <= field_.thickness();
  // The value 0 has no sign. Normals decide signs in the band only; samples beyond take the sign of their surroundings.
  const bool has_sign = sample.stored != 0 && !std::isnan(sample.stored);
  if (has_sign && (finding.in_band || sign_.method != SignMethod::normal))
    finding.sign = judge_.judge(sample.position, sample.allowed);
  if (finding.sign.inside.value_or(false)) sample.expected = -sample.expected;
}

// `value`: the distance from the surface of the thickened sheet.
void Check::compare_shell(double value, Finding& finding) const {
  SampleCheck& sample = finding.sample;
  const double thickness = field_.thickness();
  sample.expected = std::clamp(value, -thickness, thickness);
  sample.allowed = allowed_error(field_.grid(), value + sign_.shell / 2);
  finding.in_band = std::abs(value) <= thickness;
  if (std::abs(value) > sample.allowed) finding.sign.inside = (value < 0) != sign_.invert;
  if (sign_.invert) sample.expected = -sample.expected;
  sample.error = std::abs(sample.stored - sample.expected);
}

void Check::compare_nearest(double distance, Finding& finding) const {
  const SampleCheck& sample = finding.sample;
  const std::uint32_t nearest = field_.nearest(sample.i, sample.j, sample.k);
  // Near the thickness, rounding decides whether a sample has a nearest triangle.
  if (nearest == kNoTriangle)
    finding.nearest_wrong = std::abs(distance - sign_.shell / 2) < field_.thickness() - sample.allowed;
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

}  // namespace

double allowed_error(const Grid& grid, double distance) {
  const Box box = grid.bounds();
  const double resolution = 4 * std::numeric_limits<double>::epsilon() * std::max(max_norm(box.min), max_norm(box.max));
  return promised_error(distance, grid.max_spacing()) + resolution;
}

VerifyResult verify(const DistanceField& field, MeshView mesh, const VerifyOptions& options) try {
  if (options.samples < 1) throw Error(ErrorCode::usage, "verify: at least one sample must be tested; give 1 or more");
  validate("verify", options.execution, Runs::on_the_cpu);
  validate(mesh);

  ProgressMeter progress(options.progress);
  const auto samples = choose_samples(field, options.samples, options.seed);
  std::vector<Finding> findings(samples.size());
  VerifyResult result;
  result.sign.method = field.provenance().sign;
  Threads(options.execution.threads).run([&] {
    progress.stage("sort", 1, 0, 0.05);
    const Check check(field, mesh, progress);
    result.sign.can_check = check.can_check_sign();
    progress.stage("verify", static_cast<std::int64_t>(samples.size()), 0.05, 1);
    tbb::parallel_for(std::size_t{0}, samples.size(), [&](std::size_t n) {
      findings[n] = check.sample(samples[n]);
      progress.advance();
    });
  });

  result.samples = static_cast<std::int64_t>(samples.size());
  result.mesh_differs = field.provenance().mesh_hash != 0 && field.provenance().mesh_hash != content_hash(mesh);
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
} catch (...) {
  throw_as_error("verify", "test fewer samples, or provide more memory");
}

}  // namespace standoff
