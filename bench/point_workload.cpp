// SPDX-License-Identifier: Apache-2.0
#include "point_workload.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <random>

#include "raw.h"
#include "scenes/scenes.h"
#include "standoff/io.h"

namespace standoff::bench {
namespace {

/// Random numbers that do not depend on the standard library.
class Random {
 public:
  explicit Random(std::uint64_t seed) : engine_(seed) {}
  /// From 0 to 1, without 1.
  double operator()() { return static_cast<double>(engine_() >> 11) * 0x1p-53; }
  double within(double low, double high) { return low + (high - low) * (*this)(); }
  /// A point in the ball of radius 1, uniform in direction and in distance.
  Vec3 displacement() {
    for (;;) {
      const double x = within(-1, 1), y = within(-1, 1), z = within(-1, 1), r = std::sqrt(x * x + y * y + z * z);
      if (r > 1 || r == 0) continue;
      const double reach = (*this)() / r;
      return {reach * x, reach * y, reach * z};
    }
  }

 private:
  std::mt19937_64 engine_;
};

double area(const Mesh& mesh, const Triangle& t) {
  const Vec3 a = mesh.vertices[t[0]];
  return 0.5 * length(cross(mesh.vertices[t[1]] - a, mesh.vertices[t[2]] - a));
}

}  // namespace

std::vector<Vec3> make_points(const Mesh& mesh, PointSet set, std::int64_t count, std::uint64_t seed) {
  Random random(seed);
  std::vector<Vec3> points(static_cast<std::size_t>(count));
  const Box box = standoff::bounds(mesh);
  const Vec3 e = box.extent(), low = box.center() - 0.75 * e, high = box.center() + 0.75 * e;
  if (set == PointSet::box) {
    for (Vec3& p : points)
      p = {random.within(low.x, high.x), random.within(low.y, high.y), random.within(low.z, high.z)};
    return points;
  }
  if (set == PointSet::far) {
    for (Vec3& p : points) {
      const Vec3 way = random.displacement();
      p = box.center() + (3 * std::pow(10, random()) * box.longest_side() / length(way)) * way;
    }
    return points;
  }
  std::vector<double> until;
  until.reserve(mesh.triangles.size());
  double sum = 0;
  for (const Triangle& t : mesh.triangles) until.push_back(sum += area(mesh, t));
  const double reach = 0.01 * std::max({e.x, e.y, e.z});
  for (Vec3& p : points) {
    const auto at = std::upper_bound(until.begin(), until.end(), random() * sum) - until.begin();
    const Triangle& t = mesh.triangles[std::min<std::size_t>(static_cast<std::size_t>(at), until.size() - 1)];
    const double u = std::sqrt(random()), v = random();
    p = (1 - u) * mesh.vertices[t[0]] + (u * (1 - v)) * mesh.vertices[t[1]] + (u * v) * mesh.vertices[t[2]] +
        reach * random.displacement();
  }
  return points;
}

nlohmann::json PointWorkload::describe() const {
  return {{"source", source}, {"triangles", mesh.triangles.size()}, {"points", points.size()}, {"threads", threads}};
}

void PointWorkload::save_answers(std::span<const double> distances) const {
  if (!answers.empty()) write_raw(answers, distances.data(), distances.size());
}

PointOptions::PointOptions(CLI::App& app) {
  const std::map<std::string, PointSet> sets{{"box", PointSet::box}, {"near", PointSet::near}, {"far", PointSet::far}};
  auto* mesh = app.add_option("--mesh", mesh_, "mesh file");
  auto* scene = app.add_option("--scene", scene_, "mesh made by code")->excludes(mesh);
  app.add_option("--triangles", triangles_, "triangles of the scene (its own count when absent)")->needs(scene);
  app.add_option("--points", set_,
                 "box: random in the box grown 1.5 times; near: within 1 % of the surface; far: 3 to 30 lengths away")
      ->transform(CLI::CheckedTransformer(sets));
  app.add_option("--count", count_, "of points")->check(CLI::PositiveNumber);
  app.add_option("--seed", seed_, "of the random numbers");
  app.add_option("--threads", threads_);
  app.add_option("--repeats", repeats_, "calls in this process")->check(CLI::PositiveNumber);
  app.add_option("--answers", answers_, "write the distances to this file, as raw doubles");
  app.add_option("--save", save_, "write the mesh and the points into this folder");
}

PointWorkload PointOptions::make() const {
  PointWorkload work;
  work.source = scene_.empty() ? mesh_ : scene_;
  work.mesh = scene_.empty() ? read_mesh(mesh_).mesh : scenes::make(scene_, triangles_);
  work.points = make_points(work.mesh, set_, count_, seed_);
  work.threads = threads_;
  work.repeats = repeats_;
  work.answers = answers_;
  if (!save_.empty()) {
    save_mesh(save_, work.mesh);
    write_raw(std::filesystem::path(save_) / "points.f64", work.points.data(), work.points.size());
  }
  return work;
}

}  // namespace standoff::bench
