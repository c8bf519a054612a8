// SPDX-License-Identifier: Apache-2.0
#include "batch/training_points.h"

#include <algorithm>
#include <cmath>
#include <span>
#include <string>

#include "core/hashes.h"
#include "files/atomic_file.h"
#include "io/field/npy.h"
#include "standoff/error.h"

namespace standoff {
namespace {

// Numbers of one point: splitmix64 from a state that its number, the mesh and the seed decide, so that points can be
// made in any order.
class Numbers {
 public:
  explicit Numbers(std::uint64_t state) : state_(state) {}
  // In [0, 1), a multiple of 2^-53.
  double uniform() { return static_cast<double>(next() >> 11) * 0x1p-53; }
  // Of mean 0 and deviation 1, within [-6, 6].
  double normal() {
    double sum = -6;
    for (int n = 0; n < 12; ++n) sum += uniform();
    return sum;
  }

 private:
  std::uint64_t next() { return splitmix64(state_ += kSplitmixStep); }
  std::uint64_t state_;
};

double area(MeshView mesh, std::size_t t) {
  const Vec3 a = mesh.corner(t, 0), u = mesh.corner(t, 1) - a, v = mesh.corner(t, 2) - a;
  const Vec3 n{u.y * v.z - u.z * v.y, u.z * v.x - u.x * v.z, u.x * v.y - u.y * v.x};
  return 0.5 * std::sqrt(n.x * n.x + n.y * n.y + n.z * n.z);
}

// Points of a surface, each part as likely as its area.
class SurfaceSampler {
 public:
  explicit SurfaceSampler(MeshView mesh) : mesh_(mesh), sums_(mesh.triangles.size()) {
    double sum = 0;
    for (std::size_t t = 0; t < sums_.size(); ++t) sums_[t] = sum += area(mesh, t);
    if (!(sum > 0) || !std::isfinite(sum))
      throw Error(ErrorCode::input,
                  "mesh: its triangles have no area, or more than there are numbers for, so that no points can be "
                  "drawn on them; repair the mesh, or take uniform points alone");
  }
  Vec3 point(Numbers& numbers) const {
    const double at = numbers.uniform() * sums_.back();
    const auto t = static_cast<std::size_t>(std::ranges::upper_bound(sums_, at) - sums_.begin());  // at < the last sum
    const double root = std::sqrt(numbers.uniform()), along = numbers.uniform();
    const Vec3 a = mesh_.corner(t, 0), b = mesh_.corner(t, 1), c = mesh_.corner(t, 2);
    return a * (1 - root) + b * (root * (1 - along)) + c * (root * along);
  }

 private:
  MeshView mesh_;
  std::vector<double> sums_;
};

void check(const TrainingPointOptions& options) {
  const auto fail = [](const char* what) { throw Error(ErrorCode::usage, std::string("training points: ") + what); };
  if (options.count < 1 || options.count > (std::int64_t{1} << 31)) fail("take 1 to 2^31 points");
  if (!(options.near_share >= 0 && options.near_share <= 1)) fail("the share near the surface must be 0 to 1");
  for (const double sigma : options.sigma)
    if (!(sigma >= 0 && std::isfinite(sigma))) fail("deviations must be finite and not negative");
}

std::array<float, 3> rounded(Vec3 p) {
  return {static_cast<float>(p.x), static_cast<float>(p.y), static_cast<float>(p.z)};
}

std::vector<std::array<float, 3>> draw(MeshView mesh, const Box& box, const TrainingPointOptions& options) {
  const auto count = static_cast<std::size_t>(options.count);
  const auto near = static_cast<std::size_t>(std::llround(options.near_share * static_cast<double>(count)));
  const Vec3 sides = box.max - box.min;
  const double side = std::max({sides.x, sides.y, sides.z});
  const std::uint64_t base = splitmix64(options.seed ^ splitmix64(content_hash(mesh)));
  std::vector<std::array<float, 3>> points(count);
  if (near > 0) {
    const SurfaceSampler surface(mesh);
    for (std::size_t n = 0; n < near; ++n) {
      Numbers numbers(splitmix64(base ^ n));
      const Vec3 on = surface.point(numbers);
      const double sigma = options.sigma[n % 2] * side;
      const double x = numbers.normal(), y = numbers.normal(), z = numbers.normal();
      points[n] = rounded(on + Vec3{x, y, z} * sigma);
    }
  }
  for (std::size_t n = near; n < count; ++n) {
    Numbers numbers(splitmix64(base ^ n));
    const double x = numbers.uniform(), y = numbers.uniform(), z = numbers.uniform();
    points[n] = rounded(box.min + Vec3{x * sides.x, y * sides.y, z * sides.z});
  }
  return points;
}

}  // namespace

TrainingPoints training_points(const MeshQuery& query, const Box& box, const TrainingPointOptions& options,
                               int threads) {
  check(options);
  TrainingPoints made{draw(query.mesh(), box, options), {}};
  made.distances.reserve(made.points.size());
  constexpr std::size_t kBlock = std::size_t{1} << 18;  // asked at once, as doubles: 8 MiB
  std::vector<Vec3> points;
  std::vector<double> distances;
  for (std::size_t begin = 0; begin < made.points.size(); begin += kBlock) {
    const std::size_t end = std::min(begin + kBlock, made.points.size());
    points.clear();
    for (std::size_t n = begin; n < end; ++n)
      points.push_back({made.points[n][0], made.points[n][1], made.points[n][2]});
    distances.resize(points.size());
    query.distances(points, distances, {.execution = {.threads = threads}});
    for (const double distance : distances) made.distances.push_back(static_cast<float>(distance));
  }
  return made;
}

void write_training_points(const std::filesystem::path& path, const TrainingPoints& made, const MeshQuery& query,
                           Existing existing, bool sync) {
  AtomicFile file(path, existing);
  if (!sync) file.leave_to_system();
  NpzArrays arrays(file);
  const auto count = static_cast<std::int64_t>(made.points.size());
  arrays.small("points", {"<f4", {count, 3}, false}, std::as_bytes(std::span(made.points)));
  arrays.small("distances", {"<f4", {count}, false}, std::as_bytes(std::span(made.distances)));
  std::vector<std::uint32_t> sign;  // numpy keeps 4 bytes per character, and has no empty strings
  for (const char c : std::string(name_of(query.sign().method))) sign.push_back(static_cast<unsigned char>(c));
  if (sign.empty()) sign.push_back(0);
  arrays.small("sign", {"<U" + std::to_string(sign.size()), {}, false}, std::as_bytes(std::span(sign)));
  arrays.finish();
  file.commit();
}

}  // namespace standoff
