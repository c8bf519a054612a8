// SPDX-License-Identifier: Apache-2.0
// gpu-check, first part: every kernel on this machine's GPU against the same kernels emulated on the CPU, bit for bit,
// and against distances by definition in double precision. Small grids; scripts run it under compute-sanitizer too.
//
// check [--quick] [--unpoisoned]: prints a line per case and how many were wrong; exit code 0 where none was.
// Unpoisoned: workspaces are not filled before use, so that initcheck sees what is read before it is written. Built as
// plain C++ it checks itself: the emulation takes the GPU's part.
#include <algorithm>
#include <cstdio>
#include <cstring>
#include <optional>
#include <string>
#include <utility>

#include "backends/cuda/fields.h"
#include "scenes/scenes.h"
#include "standoff/error.h"
#include "tests/gpu_check/batch_on_device.cuh"
#include "tests/gpu_check/field_on_device.cuh"
#include "tests/gpu_check/timing.cuh"
#include "tests/sign/solid_soup.h"
#include "tests/support/random_mesh.h"
#include "tests/support/reference.h"

namespace standoff {
namespace {

struct Case {
  std::string name;
  Mesh mesh;
  Grid grid;
  double thickness;
  SignOptions sign = {.method = SignMethod::none};
};

/// The field from the emulated kernels: host memory is their device memory.
struct Reference {
  std::vector<float> values;
  std::vector<std::uint32_t> nearest;
  cuda::Outcome outcome;
};

struct alignas(256) Aligned {
  char bytes[256];
};

/// With sidecars in host memory, if any.
Reference emulate(const Case& c, Method method, const cuda::DeviceSidecars& sidecars = {}) {
  const auto samples = static_cast<std::size_t>(c.grid.sample_count());
  Reference r{std::vector<float>(samples), std::vector<std::uint32_t>(samples), {}};
  cuda::Task task;
  task.mesh = {&c.mesh.vertices.data()->x, static_cast<std::int64_t>(c.mesh.vertices.size()),
               c.mesh.triangles.data()->data(), static_cast<std::int64_t>(c.mesh.triangles.size())};
  task.grid = c.grid;
  task.thickness = c.thickness;
  task.method = method;
  task.sign = c.sign;
  task.output = {r.values.data(), r.nearest.data(), nullptr, 0};
  task.sidecars = sidecars;
  task.outcome = &r.outcome;
  std::int64_t entries = cuda::likely_entries(task.mesh.triangle_count, c.grid, c.thickness, method);
  do {
    const std::int64_t bytes = emulated::workspace_bytes(task, entries);
    std::vector<Aligned> workspace(static_cast<std::size_t>(bytes) / sizeof(Aligned) + 1);
    emulated::enqueue(task, workspace.data(), bytes);
    entries *= 4;
  } while (r.outcome.stopped != 0 && r.outcome.bad_triangle == cuda::Outcome::kNone);
  cuda::check(r.outcome, task);
  return r;
}

template <class T>
std::int64_t different(const std::vector<T>& a, const std::vector<T>& b) {
  std::int64_t count = a.size() != b.size();
  for (std::size_t n = 0; n < std::min(a.size(), b.size()); ++n) count += std::memcmp(&a[n], &b[n], sizeof(T)) != 0;
  return count;
}

/// Samples beyond the promised error, of about `most` tried. Requires a method without a skip rule.
std::int64_t inexact(const Case& c, const std::vector<float>& values, std::int64_t most) {
  const std::int64_t samples = c.grid.sample_count(), step = std::max<std::int64_t>(1, samples / most) | 1;
  std::int64_t wrong = 0;
  for (std::int64_t n = 0; n < samples; n += step) {
    const Size3& s = c.grid.size;
    const Vec3 p = c.grid.position(n % s.x, n / s.x % s.y, n / (s.x * s.y));
    const double expected = std::min(testing::reference_distance(c.mesh, p), c.thickness);
    wrong += !(std::abs(values[static_cast<std::size_t>(n)] - expected) <= testing::promised_error(c.grid, expected));
  }
  return wrong;
}

int run(const Case& c, Method method) {
  using namespace STANDOFF_PLATFORM;
  const char* const method_name = method == Method::thesis ? "thesis" : "tiles";
  const Reference reference = emulate(c, method);
  int faults = 0;
  for (const Layout layout : {Layout::dense, Layout::sparse}) {
    FieldOnDevice field(c.mesh, c.grid, c.thickness, method, layout, true);
    const cuda::Outcome outcome = field.run();
    const std::vector<float> values = field.values();
    const std::int64_t in_values = different(values, reference.values),
                       in_nearest = different(field.nearest(), reference.nearest),
                       off = method == Method::tiles && layout == Layout::dense ? inexact(c, values, 200) : 0;
    const std::int64_t unbalanced = field.unbalanced_lists();
    const bool good = in_values == 0 && in_nearest == 0 && off == 0 && unbalanced == 0 &&
                      outcome.samples_band == reference.outcome.samples_band;
    std::printf(
        "%-6s %-7s %-6s %-28s thickness %-9.4g %lld values and %lld nearest triangles differ, %lld inexact, %lld lists "
        "not as counted\n",
        good ? "ok" : "WRONG", method_name, layout == Layout::dense ? "dense" : "sparse", c.name.c_str(), c.thickness,
        static_cast<long long>(in_values), static_cast<long long>(in_nearest), static_cast<long long>(off),
        static_cast<long long>(unbalanced));
    std::fflush(stdout);
    faults += !good;
  }
  return faults;
}

std::vector<Case> cases(bool quick) {
  std::vector<Case> all;
  const auto add = [&all](std::string name, Mesh mesh, const Grid& grid) {
    for (const double spacings : {1.5, 6.0, std::numeric_limits<double>::infinity()})
      all.push_back({name, mesh, grid, spacings * grid.max_spacing()});
  };
  const Grid grid{{27, 22, 19}, {-6, -5, -4.5}, {0.5, 0.45, 0.5}};
  add("nasty soup", testing::nasty_soup(71, 60, 6), grid);
  if (quick) return all;
  add("short triangles", testing::random_soup(72, 400, 6, 0.6), grid);
  add("long triangles", testing::random_soup(73, 12, 8, 20), grid);
  add("a crowded tile", testing::random_soup(74, 900, 0.7, 0.5), grid);
  const Vec3 far{1e6, -3e5, 77};
  Grid there = grid;
  there.origin = there.origin + far;
  add("far from the origin", testing::random_soup(75, 100, 6, 2, far), there);
  for (const scenes::Scene& scene : scenes::all()) {
    const Mesh mesh = scenes::make(scene.name, std::min<std::int64_t>(scene.triangles, 400));
    add(scene.name, mesh, fit_resolution(bounds(mesh), 20, {.least_samples = 0}));
  }
  return all;
}

/// Prints how a check went; 1 where it went wrong.
int judge(bool good, const std::string& what) {
  std::printf("%-6s %s\n", good ? "ok" : "WRONG", what.c_str());
  std::fflush(stdout);
  return good ? 0 : 1;
}

/// The code of the error that work ends with, or no error.
template <class Work>
std::optional<ErrorCode> error_of(Work work) {
  try {
    work();
  } catch (const Error& error) {
    return error.code();
  }
  return {};
}

const Grid kSmallGrid{{9, 9, 9}, {-2, -2, -2}, {0.5, 0.5, 0.5}};

/// Wrong input and too little memory must be said, and leave everything usable.
int run_faults() {
  using namespace STANDOFF_PLATFORM;
  Mesh mesh = testing::random_soup(76, 20, 2, 1);
  const auto field = [&] { FieldOnDevice(mesh, kSmallGrid, 1, Method::tiles, Layout::dense, false).run(); };
  const std::uint32_t index = std::exchange(mesh.triangles[7][1], 4000000000u);
  int faults = judge(error_of(field) == ErrorCode::input, "a triangle with an index out of range is named");
  mesh.triangles[7][1] = index;
  faults += judge(!error_of(field), "the next field is computed");
  const auto more_than_there_is = [] { const Memory memory(std::int64_t{1} << 50); };
  faults += judge(error_of(more_than_there_is) == ErrorCode::limit, "more memory than there is is a limit");
  return faults + judge(!error_of(field), "the next field is computed");
}

/// A recorded graph gives the field of the mesh that is in its memory when it is played.
int run_graph() {
  using namespace STANDOFF_PLATFORM;
  const Mesh first = testing::random_soup(77, 60, 2, 1), second = testing::random_soup(78, 60, 2, 1);
  int faults = 0;
  for (const double thickness : {0.9, 3.0}) {
    FieldOnDevice expected(second, kSmallGrid, thickness, Method::tiles, Layout::dense, false);
    expected.run();
    FieldOnDevice field(first, kSmallGrid, thickness, Method::tiles, Layout::dense, false);
    field.run();
    field.upload(first);
    Recorded recorded([&](Stream stream) { field.enqueue(stream); });
    field.upload(second);
    recorded.play();
    recorded.wait();
    faults += judge(field.outcome().stopped == 0 && different(field.values(), expected.values()) == 0,
                    "a graph that is played again sees the mesh move");
  }
  return faults;
}

/// The blocking way, from host memory to host memory, against what lies in device memory.
int run_blocking() {
  using namespace STANDOFF_PLATFORM;
  const Mesh mesh = testing::random_soup(80, 200, 5, 1);
  const Grid grid{{37, 30, 21}, {-6, -5, -4}, {0.35, 0.35, 0.4}};
  int faults = 0;
  for (const Method method : {Method::tiles, Method::thesis, Method::propagate, Method::jumpflood, Method::jumpflood_1})
    for (const double thickness : {0.7, 2.9}) {
      FieldOnDevice expected(mesh, grid, thickness, method, Layout::dense, true);
      const cuda::Outcome outcome = expected.run();
      std::vector<float> values(static_cast<std::size_t>(grid.sample_count()), static_cast<float>(thickness));
      std::vector<std::uint32_t> nearest(values.size(), kNoTriangle);
      const ComputeOptions options{.sign = {SignMethod::none}};
      ProgressMeter progress(options.progress);
      const Job job{mesh, {}, grid, thickness, 1, Simd::automatic, progress};
      Sink sink(grid, values, nearest);
      const Counts counts = STANDOFF_PLATFORM::run(method, job, sink);
      faults += judge(different(values, expected.values()) == 0 && different(nearest, expected.nearest()) == 0 &&
                          counts.samples_band == static_cast<std::int64_t>(outcome.samples_band),
                      "from host memory to host memory");
    }
  return faults;
}

/// More samples than 32 bits count: distances in the last corner of 2048^3 samples, by definition.
int run_large() {
  using namespace STANDOFF_PLATFORM;
  const Grid grid{{2048, 2048, 2048}, {0, 0, 0}, {1, 1, 1}};
  const Mesh mesh = testing::random_soup(79, 200, 6, 3, {2040, 2040, 2040});
  FieldOnDevice field(mesh, grid, 1.5, Method::tiles, Layout::sparse, false);
  field.run();
  const std::vector<std::int32_t> slots = field.slots();
  const std::vector<float> pool = field.pool<float>(field.task().output.values);
  std::int64_t looked_at = 0, wrong = 0;
  for (std::size_t tile = 0; tile < slots.size(); ++tile)
    for (int n = 0; slots[tile] >= 0 && n < 512; n += 73, ++looked_at) {
      const auto t = static_cast<std::int64_t>(tile);
      const Vec3 p = grid.position(t % 256 * 8 + n % 8, t / 256 % 256 * 8 + n / 8 % 8, t / 65536 * 8 + n / 64);
      const double expected = std::min(testing::reference_distance(mesh, p), 1.5);
      const float value = pool[static_cast<std::size_t>(slots[tile]) * 512 + static_cast<std::size_t>(n)];
      wrong += !(std::abs(value - expected) <= testing::promised_error(grid, expected));
    }
  return judge(looked_at > 100 && wrong == 0, "2048^3 samples, sparse: " + std::to_string(wrong) + " of " +
                                                  std::to_string(looked_at) + " are inexact");
}

/// The fields of many meshes at once against single ones of the emulation; of those that are wrong, each is told.
int run_batch(bool quick) {
  using namespace STANDOFF_PLATFORM;
  const Size3 size{27, 22, 19};
  std::vector<Case> singles;
  testing::MeshBatch all;
  for (int n = 0; n < (quick ? 12 : 200); ++n) {
    const double scale = 0.3 + 0.01 * n;
    const Vec3 at{1000.0 * n, -77.0 * n, 0.5};
    Mesh mesh = n % 5 == 0   ? testing::nasty_soup(300u + static_cast<unsigned>(n), 30, 6)
                : n % 5 == 1 ? testing::random_soup(300u + static_cast<unsigned>(n), 6, 8, 20)
                             : testing::random_soup(300u + static_cast<unsigned>(n), 1 + n % 97, 5, 0.8);
    for (Vec3& v : mesh.vertices) v = scale * v + at;
    const Vec3 spacing = scale * Vec3{0.5, 0.45, 0.5 + 0.001 * n};
    singles.push_back({"", mesh, {size, at - scale * Vec3{6, 5, 4.5}, spacing}, (0.5 + 0.01 * n) * scale});
    all.add(mesh, {singles.back().grid.origin, spacing, singles.back().thickness});
  }
  const std::size_t bad = 7;
  all.triangles[static_cast<std::size_t>(all.first_triangle[bad])][1] = 4000000000u;
  BatchOnDevice batch(all, size, true);
  batch.run();
  const std::vector<cuda::Outcome> outcomes = batch.outcomes();
  int wrong = outcomes[bad].bad_triangle != 0;
  for (std::size_t n = 0; n < singles.size(); ++n) {
    if (n == bad) continue;
    const Reference reference = emulate(singles[n], Method::tiles);
    const auto index = static_cast<std::int64_t>(n);
    wrong += different(batch.values(index), reference.values) != 0 ||
             different(batch.nearest(index), reference.nearest) != 0 || outcomes[n].stopped != 0 ||
             outcomes[n].samples_band != reference.outcome.samples_band;
  }
  return judge(wrong == 0, "many meshes at once: " + std::to_string(wrong) + " of " + std::to_string(singles.size()) +
                               " fields are wrong");
}

/// Tetrahedra with whole corners, all facing outwards, on samples of whole places: their planes, edges and corners are
/// decided exactly.
Mesh whole_tetrahedra() {
  testing::Random random(81);
  std::vector<testing::Tetrahedron> outwards;
  for (testing::Tetrahedron t : testing::integer_tetrahedra(random, 200, 9)) {
    const int side = testing::orientation(t[0], t[1], t[2], t[3]);
    if (side < 0) std::swap(t[0], t[1]);
    if (side != 0) outwards.push_back(t);
  }
  return testing::mesh_of(outwards);
}

/// Signs that the device decides, in device memory and from host memory.
int run_signs(bool quick) {
  using namespace STANDOFF_PLATFORM;
  std::vector<Case> all{{"whole tetrahedra", whole_tetrahedra(), {{25, 24, 23}, {-11, -11, -11}, {1, 1, 1}}, 2, {}}};
  for (const char* const name : {"sphere", "catapult", "labyrinth", "machine_2"}) {
    const Mesh mesh = scenes::make(name, quick ? 400 : 3000);
    const Grid grid = fit_resolution(bounds(mesh), quick ? 20 : 48, {.least_samples = 0});
    all.push_back({name, mesh, grid, 2 * grid.max_spacing(), {}});
  }
  int wrong = 0;
  for (const Case& c : all) {
    const Reference expected = emulate(c, Method::tiles);
    for (const Layout layout : {Layout::dense, Layout::sparse}) {
      FieldOnDevice field(c.mesh, c.grid, c.thickness, Method::tiles, layout, false, c.sign);
      field.run();
      wrong += different(field.values(), expected.values) != 0;
    }
    std::vector<float> values(expected.values.size(), static_cast<float>(c.thickness));
    ProgressMeter progress;
    Sink sink(c.grid, values, {});
    Job job{c.mesh, {}, c.grid, c.thickness, 1, Simd::automatic, progress};
    job.sign = &c.sign;
    wrong += STANDOFF_PLATFORM::run(Method::tiles, job, sink).samples_signed != c.grid.sample_count() ||
             different(values, expected.values) != 0;
  }
  return judge(wrong == 0,
               "signs: " + std::to_string(wrong) + " of " + std::to_string(3 * all.size()) + " fields are wrong");
}

/// Sidecars of dense fields, some with a sign.
int run_sidecars(bool quick) {
  using namespace STANDOFF_PLATFORM;
  std::vector<Case> all = cases(quick);
  const Mesh ball = scenes::make("sphere", quick ? 400 : 3000);
  all.push_back({"sphere", ball, fit_resolution(bounds(ball), quick ? 20 : 48, {.least_samples = 0}), 0.3, {}});
  int wrong = 0;
  for (const Case& c : all) {
    const std::int64_t samples = c.grid.sample_count(), floats = 3 * samples;
    const auto count = static_cast<std::size_t>(floats);
    std::vector<float> closest(count), weights(count), gradient(count), found(count);
    std::vector<std::uint8_t> feature(count / 3), found_feature(count / 3);
    emulate(c, Method::tiles, {closest.data(), weights.data(), feature.data(), gradient.data()});
    FieldOnDevice field(c.mesh, c.grid, c.thickness, Method::tiles, Layout::dense, true, c.sign);
    field.run();
    const Memory room(4 * 3 * floats), features(samples);
    float* const arrays = room.as<float>();
    cuda::Task task = field.task();
    task.sidecars = {arrays, arrays + floats, features.as<std::uint8_t>(), arrays + 2 * floats};
    STANDOFF_PLATFORM::enqueue(task, field.workspace(), field.workspace_bytes(), nullptr);
    const std::vector<float>* const expected[] = {&closest, &weights, &gradient};
    for (std::int64_t n = 0; n < 3; ++n) {
      copy_out(found.data(), arrays + n * floats, 4 * floats);
      wrong += different(found, *expected[n]) != 0;
    }
    copy_out(found_feature.data(), features.as<std::uint8_t>(), samples);
    wrong += found_feature != feature;
  }
  return judge(wrong == 0,
               "sidecars: " + std::to_string(wrong) + " of " + std::to_string(4 * all.size()) + " arrays are wrong");
}

int run_all(bool quick) {
  int faults = run_faults() + run_graph() + run_blocking() + run_batch(quick) + run_signs(quick) + run_sidecars(quick),
      count = 13;
  if (!quick) {
    faults += run_large();
    ++count;
  }
  for (const Case& c : cases(quick))
    for (const Method method : {Method::tiles, Method::thesis}) {
      faults += run(c, method);
      count += 2;
    }
  std::printf("%d of %d checks went wrong\n", faults, count);
  return faults == 0 ? 0 : 7;
}

}  // namespace
}  // namespace standoff

int main(int argc, char** argv) {
  bool quick = false;
  for (int n = 1; n < argc; ++n) {
    quick |= std::string(argv[n]) == "--quick";
    if (std::string(argv[n]) == "--unpoisoned") standoff::STANDOFF_PLATFORM::poisons_workspace = false;
  }
  try {
    return standoff::run_all(quick);
  } catch (const standoff::Error& error) {
    std::fprintf(stderr, "check: error: %s\n", error.what());
    return static_cast<int>(error.code());
  }
}
