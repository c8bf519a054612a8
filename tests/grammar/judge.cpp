// SPDX-License-Identifier: Apache-2.0
#include "tests/grammar/judge.h"

#include <sys/stat.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <fstream>
#include <limits>
#include <numeric>
#include <string_view>
#include <vector>

#include "io/points/points.h"
#include "standoff/collision.h"
#include "standoff/error.h"
#include "standoff/io.h"

namespace standoff::grammar {
namespace {

void write(const std::filesystem::path& path, const std::string& bytes) {
  std::ofstream(path, std::ios::binary).write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
}

}  // namespace

void set_traps(const std::filesystem::path& folder) {
  if (::mkfifo((folder / kPipe).c_str(), 0600) != 0)
    throw std::filesystem::filesystem_error("mkfifo", folder / kPipe, std::error_code());
  std::filesystem::create_directory(folder / kFolder);
  std::filesystem::create_symlink(kLoop, folder / kLoop);
  write(folder / kOutside, std::string(std::size_t{1} << 16, kOutsideByte));
}

std::filesystem::path put(const Grammar& grammar, const File& file, const std::filesystem::path& folder) {
  for (const auto& [name, bytes] : file.beside) write(folder / name, bytes);
  const std::filesystem::path path = folder / (std::string("made.") + grammar.extension);
  write(path, file.bytes);
  return path;
}

namespace {

std::string text_of(const Vec3& p) {
  char text[120];
  std::snprintf(text, sizeof text, "(%.9g, %.9g, %.9g)", p.x, p.y, p.z);
  return text;
}
std::string text_of(const Corners& t) { return text_of(t[0]) + " " + text_of(t[1]) + " " + text_of(t[2]); }

double apart(const Vec3& p, const Vec3& q) {
  return std::max({std::abs(p.x - q.x), std::abs(p.y - q.y), std::abs(p.z - q.z)});
}

// How far corners are from each other, in the same sense, whichever comes first.
double apart(const Corners& a, const Corners& b) {
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t first = 0; first < 3; ++first)
    least = std::min(
        least, std::max({apart(a[first], b[0]), apart(a[(first + 1) % 3], b[1]), apart(a[(first + 2) % 3], b[2])}));
  return least;
}

Corners corners_of(MeshView mesh, std::size_t t) { return {mesh.corner(t, 0), mesh.corner(t, 1), mesh.corner(t, 2)}; }

std::string differs(MeshView mesh, std::size_t t, const Corners& wanted) {
  return "triangle " + std::to_string(t) + ", " + text_of(wanted) + ", is not there; number " + std::to_string(t) +
         " is " + text_of(corners_of(mesh, t));
}

// Gives each triangle that was written the nearest of those that were read and are left; those with little slack choose
// first.
std::string compare_in_any_order(MeshView mesh, const Truth& truth) {
  std::vector<std::size_t> order(truth.triangles.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::vector<std::size_t> left = order;
  std::ranges::stable_sort(order, {}, [&](std::size_t t) { return truth.slack[t]; });
  for (const std::size_t t : order) {
    const Corners& wanted = truth.triangles[t];
    std::size_t nearest = 0;
    double least = std::numeric_limits<double>::infinity();
    for (std::size_t n = 0; n < left.size() && least > 0; ++n)
      if (const double gap = apart(corners_of(mesh, left[n]), wanted); gap < least) least = gap, nearest = n;
    if (!(least <= truth.slack[t])) return differs(mesh, t, wanted) + ", slack " + std::to_string(truth.slack[t]);
    left[nearest] = left.back();
    left.pop_back();
  }
  return "";
}

std::string compare(MeshView mesh, const Truth& truth) {
  const std::size_t count = mesh.triangles.size();
  if (count != truth.triangles.size())
    return std::to_string(count) + " triangles, " + std::to_string(truth.triangles.size()) + " were written";
  if (!truth.slack.empty()) return compare_in_any_order(mesh, truth);
  for (std::size_t t = 0; t < count; ++t)
    if (corners_of(mesh, t) != truth.triangles[t]) return differs(mesh, t, truth.triangles[t]);
  return "";
}

std::string compare(const DistanceField& field, const Truth& truth) {
  if (field.grid() != truth.grid) return "another grid";
  if (field.thickness() != truth.thickness) return "thickness " + std::to_string(field.thickness());
  if (field.to_dense() != truth.values) return "other values";
  if (field.has_nearest() == truth.nearest.empty()) return "nearest triangles";
  const Size3 size = truth.grid.size;
  if (!truth.nearest.empty())
    for (std::int64_t n = 0; n < size.count(); ++n)
      if (field.nearest(n % size.x, n / size.x % size.y, n / (size.x * size.y)) !=
          truth.nearest[static_cast<std::size_t>(n)])
        return "another nearest triangle";
  return "";
}

bool is_outside(double x) {
  float pattern;
  std::memset(&pattern, kOutsideByte, sizeof pattern);
  return std::abs(x) == double(pattern);
}

std::string check(const Mesh& mesh) {
  validate(mesh);
  for (const Vec3& v : mesh.vertices)
    if (is_outside(v.x) || is_outside(v.y) || is_outside(v.z)) return "it read a file outside of its folder";
  return "";
}

std::string check(const DistanceField& field) {
  for (const float value : field.tile_values())
    if (!(std::abs(value) <= static_cast<float>(field.thickness()))) return "a value past the thickness";
  return "";
}

// Whatever bounds a body holds, queries end. Where they refuse, it is for places past what they take.
std::string ask(const Body& body) {
  const Vec3 middle = body.bounds().center(), extent = body.bounds().extent();
  const double size = std::max({extent.x, extent.y, extent.z, 1e-9});
  Pose turned = make_pose({3, 1, 2}, 0.7, {});
  turned.translation = middle - rotate(turned, middle) + extent * Vec3{1.1, 0.1, 0.2};
  try {
    collide(body, {}, body, turned);
    collide(body, {}, body, turned, {.margin = size, .mode = CollideMode::certified});
    distance(body, {}, body, turned);
    contacts(body, {}, body, turned, {.most = 8, .margin = 0.01 * size});
    sweep(body, {}, body, {turned, {}, middle}, {0.01 * size});
  } catch (const Error& error) {
    if (error.code() != ErrorCode::usage) return std::string("a query: ") + error.what();
  }
  return "";
}

std::vector<Vec3> read_points(const std::filesystem::path& path) {
  const auto reader = open_points(path.string(), InvalidPoints::reject);
  std::vector<Vec3> all;
  std::array<Vec3, 100> some;
  for (std::size_t got = some.size(); got == some.size();) {
    got = reader->read(some);
    all.insert(all.end(), some.begin(), some.begin() + static_cast<std::ptrdiff_t>(got));
  }
  return all;
}

std::string check(const std::vector<Vec3>& points) {
  for (const Vec3& p : points)
    if (!(max_norm(p) <= kMaxCoordinate)) return "a point that is not finite, or too far out";
  return "";
}

std::string compare(const std::vector<Vec3>& points, const Truth& truth) {
  return points == truth.points ? "" : "other points";
}

template <class Read>
void judge_read(const Read& read, const Truth& truth, bool good, Verdict& verdict) {
  verdict.read = true;
  verdict.fault = check(read);
  if (!verdict.fault.empty() || !good) return;
  verdict.fault = compare(read, truth);
  verdict.compared = true;
}

void read_and_judge(const Grammar& grammar, const File& file, bool good, const std::filesystem::path& path,
                    Verdict& verdict) {
  switch (grammar.kind) {
    case Kind::mesh:
      judge_read(read_mesh(path).mesh, file.truth, good, verdict);
      break;
    case Kind::field:
      judge_read(read_field(path, {.memory_limit = std::int64_t{64} << 20}), file.truth, good, verdict);
      break;
    case Kind::points:
      judge_read(read_points(path), file.truth, good, verdict);
      break;
    case Kind::body: {
      const Body body = Body::load(path);
      verdict.read = true;
      verdict.fault = ask(body);
      if (good && verdict.fault.empty()) {
        verdict.fault = compare(body.mesh(), file.truth);
        verdict.compared = true;
      }
      break;
    }
  }
}

}  // namespace

Verdict judge(const Grammar& grammar, const File& file, bool good, const std::filesystem::path& path) {
  Verdict verdict;
  try {
    read_and_judge(grammar, file, good, path, verdict);
  } catch (const Error& error) {
    const std::string_view message = error.what();
    if (verdict.read)
      verdict.fault = "what was read is not valid: ";
    else if (good && !file.may_be_refused)
      verdict.fault = "refused, though it is good: ";
    else if (error.code() != ErrorCode::input && error.code() != ErrorCode::limit)
      verdict.fault = "an error of another kind: ";
    else if (!message.starts_with(path.string() + ":"))
      verdict.fault = "an error that does not name the file: ";
    else if (message.find("; ") == message.npos)
      verdict.fault = "an error that does not say what to do: ";
    else if (message.size() > 1000 + path.string().size())
      verdict.fault = "an error that goes on and on: ";
    else
      return verdict;
    verdict.fault += message;
  } catch (const std::exception& other) {
    verdict.fault = std::string("no Error of standoff: ") + other.what();
  }
  return verdict;
}

}  // namespace standoff::grammar
