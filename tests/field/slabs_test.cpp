// SPDX-License-Identifier: Apache-2.0
// A field in slabs is the whole field: sample by sample, and as a file byte by byte.
#include "standoff/slabs.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <utility>
#include <vector>

#include "standoff/io.h"
#include "standoff/windows.h"
#include "tests/collision/bodies.h"
#include "tests/support/changed_mesh.h"
#include "tests/support/expect_error.h"
#include "tests/support/fields.h"
#include "tests/support/random_mesh.h"
#include "tests/support/sanitized.h"
#include "tests/support/temp_folder.h"

namespace standoff::testing {
namespace {

// The sizes are no multiples of 16, nor of the size of a file's blocks.
const Grid kSlabsGrid{{37, 41, 77}, {-1.25, -1.3, -1.35}, {0.069, 0.065, 0.0351}};
constexpr std::int64_t kOneLayer = 1;  // slabs of 16 slices, the thinnest

Mesh open_ball() { return with_hole(ball_mesh(1, 6), 40, 55); }

ComputeOptions by(SignMethod method, int threads = 2) {
  return {.sign = {.method = method, .shell = method == SignMethod::shell ? 0.2 : 0},
          .execution = {.threads = threads, .backend = Backend::cpu}};
}

// But for the samples that were examined: a triangle that reaches few bricks of a slab is not tested against each.
void expect_same_report(const ComputeReport& a, const ComputeReport& b) {
  EXPECT_EQ(a.samples_band, b.samples_band);
  EXPECT_EQ(a.samples, b.samples);
  EXPECT_EQ(a.tiles, b.tiles);
  EXPECT_EQ(a.tiles_stored, b.tiles_stored);
  EXPECT_EQ(a.triangles, b.triangles);
  EXPECT_EQ(a.skipped, b.skipped);
  EXPECT_EQ(a.sign.method, b.sign.method);
  EXPECT_EQ(a.sign.why, b.sign.why);
  EXPECT_EQ(a.method, b.method);
  EXPECT_EQ(a.backend, b.backend);
  EXPECT_EQ(a.threads, b.threads);
  EXPECT_EQ(a.provenance.mesh_hash, b.provenance.mesh_hash);
  EXPECT_EQ(a.provenance.sign, b.provenance.sign);
}

// Compares the values, nearest triangles and reports of all slabs with the whole field. Returns the number of slabs.
int expect_whole_field(const Mesh& mesh, const Grid& grid, double thickness, const ComputeOptions& options,
                       std::int64_t slab_samples = kOneLayer) {
  const ComputeResult whole = compute(mesh, grid, thickness, options);
  SlabComputation slabs(mesh, grid, thickness, options, slab_samples);
  EXPECT_EQ(slabs.grid(), grid);
  EXPECT_EQ(slabs.thickness(), thickness);
  EXPECT_EQ(slabs.has_nearest(), options.nearest);
  std::int64_t slices = 0;
  int count = 0;
  while (const DistanceField* slab = slabs.next()) {
    const Grid& part = slab->grid();
    EXPECT_EQ(part, grid.window({0, 0, slices}, {grid.size.x, grid.size.y, part.size.z}));
    EXPECT_EQ(slab->provenance().sign, whole.field.provenance().sign);
    const auto samples = static_cast<std::size_t>(part.sample_count());
    std::vector<float> values(samples), found(samples);
    whole.field.copy_slices(slices, part.size.z, values);
    slab->copy_slices(0, part.size.z, found);
    EXPECT_TRUE(bits_of(values) == bits_of(found)) << "from slice " << slices;
    EXPECT_EQ(slab->has_nearest(), options.nearest);
    if (options.nearest) {
      std::vector<std::uint32_t> nearest(samples), found_nearest(samples);
      whole.field.copy_nearest_slices(slices, part.size.z, nearest);
      slab->copy_nearest_slices(0, part.size.z, found_nearest);
      EXPECT_TRUE(nearest == found_nearest) << "from slice " << slices;
    }
    slices += part.size.z;
    ++count;
  }
  EXPECT_EQ(slices, grid.size.z);
  EXPECT_EQ(slabs.next(), nullptr);
  expect_same_report(whole.report, slabs.report());
  return count;
}

TEST(Slabs, ThinThickAndFull) {
  for (const Mesh& mesh : {ball_mesh(1, 6), open_ball(), random_soup(3, 400, 1, 0.3), nasty_soup(3, 60, 1)})
    for (const double thickness : {0.05, 0.15, 0.7, kFullField})
      for (const bool nearest : {false, true}) {
        SCOPED_TRACE(thickness);
        ComputeOptions options = by(SignMethod::none);
        options.nearest = nearest;
        EXPECT_EQ(expect_whole_field(mesh, kSlabsGrid, thickness, options), 5);
      }
}

TEST(Slabs, EverySign) {
  struct {
    SignMethod method;
    bool closed, open;  // which meshes the method takes
    int slabs;
  } const cases[] = {{SignMethod::winding, true, true, 5}, {SignMethod::parity, true, false, 5},
                     {SignMethod::shell, true, true, 5},   {SignMethod::automatic, true, true, 5},
                     {SignMethod::normal, true, true, 1},  {SignMethod::flood, true, true, 5}};
  for (const auto& one : cases)
    for (const bool open : {false, true})
      for (const double thickness : {0.05, 0.7, kFullField})
        for (const bool invert : {false, true}) {
          if (open ? !one.open : !one.closed) continue;
          SCOPED_TRACE(std::string(name_of(one.method)) + (open ? " open " : " closed ") + std::to_string(thickness));
          ComputeOptions options = by(one.method);
          options.sign.invert = invert;
          options.nearest = thickness == 0.7;
          EXPECT_EQ(expect_whole_field(open ? open_ball() : ball_mesh(1, 6), kSlabsGrid, thickness, options),
                    one.slabs);
        }
}

// Deep inside there are tiles that are not stored, in every slab but the last.
TEST(Slabs, InsideOfTilesThatAreNotStored) {
  const Mesh ball = ball_mesh(1, 8);
  const Grid grid{{100, 100, 99}, {-1.1, -1.1, -1.1}, {0.0222, 0.0222, 0.0222}};
  SlabComputation slabs(ball, grid, 0.05, by(SignMethod::winding), kOneLayer);
  int with_inside = 0;
  while (const DistanceField* slab = slabs.next())
    with_inside += std::ranges::find(slab->slots(), DistanceField::kInside) != slab->slots().end();
  EXPECT_EQ(with_inside, 6);
  expect_whole_field(ball, grid, 0.05, by(SignMethod::winding));
}

TEST(Slabs, AreAsThickAsAsked) {
  const Mesh ball = ball_mesh(1, 6);
  const std::int64_t layer = 16 * kSlabsGrid.size.x * kSlabsGrid.size.y;
  const auto count = [&](std::int64_t samples) {
    return expect_whole_field(ball, kSlabsGrid, 0.15, by(SignMethod::winding), samples);
  };
  EXPECT_EQ(count(layer), 5);
  EXPECT_EQ(count(2 * layer - 1), 5);
  EXPECT_EQ(count(2 * layer), 3);
  EXPECT_EQ(count(4 * layer), 2);
  EXPECT_EQ(count(5 * layer), 1);
  EXPECT_EQ(count(kSlabSamples), 1);
}

TEST(Slabs, MethodsThatSpreadAreOneSlab) {
  ComputeOptions options = by(SignMethod::none);
  for (const MethodInfo& method : kComputeMethods) {
    SCOPED_TRACE(method.name);
    options.method = method.method;
    EXPECT_EQ(expect_whole_field(ball_mesh(1, 6), kSlabsGrid, 0.15, options), method.spreads ? 1 : 5);
  }
}

TEST(Slabs, SkipRulesAndTheUnionOfParts) {
  ComputeOptions options = by(SignMethod::winding);
  options.skip.kind = SkipRule::Kind::exact;
  EXPECT_EQ(expect_whole_field(ball_mesh(1, 6), kSlabsGrid, 0.15, options), 5);
  const Mesh two = joined(ball_mesh(0.6, 5), ball_mesh(0.6, 5, {0.3, 0.3, 0.3}));
  options = by(SignMethod::winding);
  options.sign.outer = true;
  EXPECT_EQ(expect_whole_field(two, kSlabsGrid, 0.15, options), 5);
}

// Files: blocks of 2^18 samples end within slabs, with them, and span several.
TEST(Slabs, FilesAreTheSameByteByByte) {
  const TempFolder folder;
  const auto bytes_of_whole = [&](const Mesh& mesh, const Grid& grid, double thickness, const ComputeOptions& options,
                                  const std::string& name, const FieldWriteOptions& written) {
    write_field(folder / name, compute(mesh, grid, thickness, options).field, written);
    return read_bytes(folder / name);
  };
  std::vector<Grid> grids{kSlabsGrid};
  if (!testing::kSanitized) {
    grids.push_back({{150, 141, 77}, kSlabsGrid.origin, {0.017, 0.019, 0.0351}});
    grids.push_back({{128, 128, 64}, kSlabsGrid.origin, {0.02, 0.02, 0.042}});
  }
  for (const Grid& grid : grids)
    for (const bool open : {false, true})
      for (const double thickness : {0.07, kFullField})
        for (const std::string name : {"a.vti", "a.npz", "a.nrrd", "a.zarr"})
          for (const bool compress : {true, false}) {
            const Mesh mesh = open ? open_ball() : ball_mesh(1, 6);
            const FieldWriteOptions written{.compress = compress, .threads = 2};
            const std::string whole = bytes_of_whole(mesh, grid, thickness, by(SignMethod::winding), name, written);
            for (const int threads : testing::kSanitized ? std::vector{2} : std::vector{1, 2, 5}) {
              SCOPED_TRACE(name + ", " + std::to_string(threads) + " threads");
              SlabComputation slabs(mesh, grid, thickness, by(SignMethod::winding, threads), kOneLayer);
              write_field(folder / name, slabs, {.compress = compress, .threads = threads});
              EXPECT_TRUE(read_bytes(folder / name) == whole);
            }
          }
  for (const SignMethod method : {SignMethod::none, SignMethod::parity, SignMethod::shell, SignMethod::flood,
                                  SignMethod::normal, SignMethod::automatic}) {
    SCOPED_TRACE(name_of(method));
    const Mesh ball = ball_mesh(1, 6);
    const std::string whole = bytes_of_whole(ball, kSlabsGrid, 0.07, by(method), "b.vti", {});
    SlabComputation slabs(ball, kSlabsGrid, 0.07, by(method), kOneLayer);
    write_field(folder / "b.vti", slabs);
    EXPECT_TRUE(read_bytes(folder / "b.vti") == whole);
  }
}

// Of a window, whose place .vti alone has room for.
TEST(Slabs, FilesOfAWindow) {
  const TempFolder folder;
  const Mesh ball = ball_mesh(1, 6);
  WindowComputation windows(ball, kSlabsGrid, 0.15, {16, 32, 32}, by(SignMethod::winding));
  DistanceField field;
  windows.compute({16, 0, 32}, {16, 32, 32}, field);
  for (const std::string name : {"a.vti", "a.npz", "a.nrrd"}) {
    write_field(folder / name, field);
    const DistanceField read = read_field(folder / name);
    EXPECT_EQ(read.grid().corner(), field.grid().corner()) << name;
    EXPECT_TRUE(bits_of(read.to_dense()) == bits_of(field.to_dense())) << name;
    EXPECT_EQ(read.grid() == field.grid(), name == "a.vti") << name;
  }
}

// A source by the caller: slabs of 5, 1, 6, .. slices of a field.
class Sliced final : public FieldSlabs {
 public:
  explicit Sliced(const DistanceField& field, std::vector<std::int64_t> slices)
      : field_(field), slices_(std::move(slices)) {}
  const Grid& grid() const override { return field_.grid(); }
  double thickness() const override { return field_.thickness(); }
  bool has_nearest() const override { return false; }
  const Provenance& provenance() const override { return field_.provenance(); }
  const DistanceField* next() override {
    if (at_ == slices_.size()) return nullptr;
    const Grid part = grid().window({0, 0, first_}, {grid().size.x, grid().size.y, slices_[at_++]});
    std::vector<float> values(static_cast<std::size_t>(part.sample_count()));
    field_.copy_slices(std::min(first_, grid().size.z - part.size.z), part.size.z, values);
    slab_ = DistanceField::from_dense(part, thickness(), values);
    first_ += part.size.z;
    return &slab_;
  }

 private:
  const DistanceField& field_;
  std::vector<std::int64_t> slices_;
  std::size_t at_ = 0;
  std::int64_t first_ = 0;
  DistanceField slab_;
};

TEST(Slabs, MayComeFromAnywhere) {
  const TempFolder folder;
  const DistanceField field = compute(ball_mesh(1, 6), kSlabsGrid, 0.2, by(SignMethod::winding)).field;
  for (const std::string name : {"a.vti", "a.npz", "a.nrrd", "a.zarr"}) {
    write_field(folder / name, field);
    const std::string whole = read_bytes(folder / name);
    Sliced slabs(field, {5, 1, 6, 40, 25});
    write_field(folder / name, slabs);
    EXPECT_TRUE(read_bytes(folder / name) == whole) << name;
    Sliced short_of_one(field, {5, 1, 6, 40, 24}), too_many(field, {40, 37, 1});
    for (FieldSlabs* wrong : {static_cast<FieldSlabs*>(&short_of_one), static_cast<FieldSlabs*>(&too_many)})
      expect_error([&] { write_field(folder / name, *wrong); }, ErrorCode::usage, "where the grid has 77");
    EXPECT_TRUE(read_bytes(folder / name) == whole) << "the file that was there before";
  }
}

TEST(Slabs, WhatTheirFilesCannotBe) {
  const TempFolder folder;
  const Mesh ball = ball_mesh(1, 3);
  SlabComputation slabs(ball, kSlabsGrid, 0.2, by(SignMethod::none));
  for (const std::string name : {"a.vdb", "a.nvdb"})
    expect_error([&] { write_field(folder / name, slabs); }, ErrorCode::usage,
                 "write .vti or .nrrd or .npz or .zarr, or compute the whole field");
  ComputeOptions options = by(SignMethod::none);
  options.nearest = true;
  SlabComputation with_nearest(ball, kSlabsGrid, 0.2, options);
  expect_error([&] { write_field(folder / "a.vti", with_nearest); }, ErrorCode::usage, "distances alone are written");
  EXPECT_TRUE(folder.names().empty());
}

TEST(Slabs, AfterAnErrorThereAreNoMore) {
  const Mesh ball = ball_mesh(1, 6);
  ComputeOptions options = by(SignMethod::winding);
  bool stop = false;
  options.progress = [&](const Progress&) { return !stop; };
  SlabComputation slabs(ball, kSlabsGrid, 0.2, options, kOneLayer);
  ASSERT_NE(slabs.next(), nullptr);
  stop = true;
  expect_error([&] { slabs.next(); }, ErrorCode::interrupted, "cancelled");
  stop = false;
  expect_error([&] { slabs.next(); }, ErrorCode::usage, "begin again");
}

struct OfTheCaller {};

// A source by the caller that fails.
class Broken final : public FieldSlabs {
 public:
  const Grid& grid() const override { return kSlabsGrid; }
  double thickness() const override { return 0.2; }
  bool has_nearest() const override { return false; }
  const Provenance& provenance() const override { return provenance_; }
  const DistanceField* next() override { throw OfTheCaller(); }

 private:
  Provenance provenance_;
};

// next() is the caller's code, and so is a progress callback that is called within it.
TEST(Slabs, WhatTheCallerThrowsPassesUnchanged) {
  const TempFolder folder;
  const Mesh ball = ball_mesh(1, 6);
  ComputeOptions options = by(SignMethod::winding);
  bool fail = false;
  options.progress = [&](const Progress&) -> bool { return fail ? throw OfTheCaller() : true; };
  SlabComputation slabs(ball, kSlabsGrid, 0.2, options, kOneLayer);
  fail = true;
  EXPECT_THROW(write_field(folder / "a.vti", slabs), OfTheCaller);
  Broken broken;
  EXPECT_THROW(write_field(folder / "a.npz", broken), OfTheCaller);
  EXPECT_TRUE(folder.names().empty());
}

}  // namespace
}  // namespace standoff::testing
