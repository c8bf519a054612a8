// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

#include "io/field/write_samples.h"
#include "odd_field.h"
#include "standoff/compute.h"
#include "standoff/io.h"
#include "tests/support/expect_error.h"
#include "tests/support/formats.h"
#include "tests/support/temp_folder.h"

namespace standoff {
namespace {

class EveryFieldFormat : public ::testing::TestWithParam<FileFormat> {
 protected:
  std::filesystem::path path() const { return folder / ("field." + GetParam().extension); }
  DistanceField through_file(const DistanceField& field) const {
    write_field(path(), field);
    return read_field(path());
  }
  const TempFolder folder;
};

INSTANTIATE_TEST_SUITE_P(AllFormats, EveryFieldFormat, ::testing::ValuesIn(field_formats()),
                         [](const auto& format) { return format.param.extension; });

void expect_same(const DistanceField& a, const DistanceField& b) {
  EXPECT_EQ(a.grid(), b.grid());
  EXPECT_EQ(a.thickness(), b.thickness());
  EXPECT_EQ(a.stored_tiles(), b.stored_tiles());
  EXPECT_EQ(a.provenance().method, b.provenance().method);
  EXPECT_EQ(a.provenance().mesh_hash, b.provenance().mesh_hash);
  EXPECT_EQ(a.provenance().version, b.provenance().version);
  EXPECT_EQ(a.provenance().sign, b.provenance().sign);
  EXPECT_EQ(a.provenance().up, b.provenance().up);
  EXPECT_TRUE(a.to_dense() == b.to_dense());
  ASSERT_EQ(a.has_nearest(), b.has_nearest());
  if (!a.has_nearest()) return;
  const auto samples = static_cast<std::size_t>(a.grid().sample_count());
  std::vector<std::uint32_t> of_a(samples), of_b(samples);
  a.copy_nearest_slices(0, a.grid().size.z, of_a);
  b.copy_nearest_slices(0, b.grid().size.z, of_b);
  EXPECT_TRUE(of_a == of_b);
}

TEST_P(EveryFieldFormat, KeepsAFullField) {
  const DistanceField field = odd_field();
  expect_same(through_file(field), field);
  EXPECT_EQ(folder.names().size(), 1u);
}

TEST_P(EveryFieldFormat, KeepsABandAndItsSparsity) {
  const DistanceField field = odd_field(odd_grid(), 4200.5);
  EXPECT_LT(field.stored_tiles(), field.tile_count().count());
  expect_same(through_file(field), field);
}

TEST_P(EveryFieldFormat, KeepsAFieldWithoutTiles) {
  expect_same(through_file(DistanceField(odd_grid(), 0.1)), DistanceField(odd_grid(), 0.1));
  expect_same(through_file(DistanceField(odd_grid(), kInfinite)), DistanceField(odd_grid(), kInfinite));
}

TEST_P(EveryFieldFormat, KeepsGridsOfAnyShape) {
  for (const Size3 size : {Size3{1, 1, 1}, {1, 1, 40}, {40, 1, 1}, {1, 40, 1}, {8, 8, 8}, {9, 7, 1}, {3, 50, 17}}) {
    const DistanceField field = odd_field({size, {1, 2, 3}, {1, 2, 3}});
    expect_same(through_file(field), field);
  }
}

TEST_P(EveryFieldFormat, KeepsExtremeNumbers) {
  const Grid grid{{2, 3, 4}, {-1e-300, 1e300, 0.1 + 0.2}, {1e-310, 1e299, 1.0 / 3}};
  for (const double thickness : {1e-300, 5e-324, 1.0 / 3, 1e300}) {
    const DistanceField field(grid, thickness);
    expect_same(through_file(field), field);
  }
}

TEST_P(EveryFieldFormat, KeepsProvenanceOfAnyText) {
  DistanceField field = odd_field();
  for (const char* text : {"", "two words", "<&\"'>", "back\\slash\nand line", ":=", "  spaces  "}) {
    field.set_provenance({text, 0, text, text});
    expect_same(through_file(field), field);
  }
  field.set_provenance({"", ~std::uint64_t{0}, "", ""});
  expect_same(through_file(field), field);
  for (const Axis up : {Axis::x, Axis::y, Axis::z}) {
    field.set_provenance({"tiles", 0, "", "", up});
    expect_same(through_file(field), field);
  }
}

TEST_P(EveryFieldFormat, KeepsNearestTrianglesOrSaysThatItCannot) {
  const DistanceField field = odd_field(odd_grid(), 4200.5, true);
  if (GetParam().nearest) return expect_same(through_file(field), field);
  expect_error([&] { write_field(path(), field); }, ErrorCode::usage,
               "cannot carry nearest triangles; write .vti or .npz or .zarr, or compute without them");
  EXPECT_TRUE(folder.names().empty());
}

// Samples as far from the plane as the thickness lie in the band: here they are all that the upper tiles hold.
TEST_P(EveryFieldFormat, KeepsTilesWhoseLeastValueIsTheThickness) {
  const Mesh plane{{{-1, -1, 7}, {17, -1, 7}, {-1, 17, 7}, {17, 17, 7}}, {{0, 1, 2}, {1, 3, 2}}};
  ComputeOptions options{.sign = {SignMethod::none}, .nearest = GetParam().nearest};
  const DistanceField field = compute(plane, {{16, 16, 16}, {}, {1, 1, 1}}, 1, options).field;
  ASSERT_EQ(field.stored_tiles(), 8);
  ASSERT_EQ(field.value(3, 4, 8), 1);
  const DistanceField read = through_file(field);
  if (GetParam().nearest) expect_same(read, field);
  EXPECT_TRUE(read.to_dense() == field.to_dense());
  const std::string bytes = read_bytes(path());
  write_field(path(), read);
  EXPECT_TRUE(read_bytes(path()) == bytes);
}

std::vector<std::int32_t> backgrounds(const DistanceField& field) {
  std::vector<std::int32_t> all;
  for (const std::int32_t slot : field.slots()) all.push_back(std::min(slot, 0));
  return all;
}

// Tiles that are -thickness throughout were stored when they were read.
TEST_P(EveryFieldFormat, KeepsTheSignAndWhatIsDeepInside) {
  for (const bool nearest : {false, true}) {
    if (nearest && !GetParam().nearest) continue;
    const DistanceField field = ball_field(nearest);
    const DistanceField read = through_file(field);
    expect_same(read, field);
    EXPECT_EQ(backgrounds(read), backgrounds(field));
    EXPECT_GT(std::ranges::count(read.slots(), DistanceField::kInside), 3);
    EXPECT_GT(std::ranges::count(read.slots(), DistanceField::kOutside), 3);
    EXPECT_LT(read.stored_tiles(), read.tile_count().count() / 2);
  }
}

TEST_P(EveryFieldFormat, WritesTheSameBytesTwice) {
  write_field(path(), odd_field());
  const std::string once = read_bytes(path());
  write_field(path(), odd_field());
  EXPECT_TRUE(read_bytes(path()) == once);
}

TEST_P(EveryFieldFormat, KnowsItsExtensionInCapitals) {
  std::string extension = GetParam().extension;
  for (char& c : extension) c = static_cast<char>(std::toupper(c));
  write_field(folder / ("FIELD." + extension), odd_field());
  expect_same(read_field(folder / ("FIELD." + extension)), odd_field());
}

// Slices so large that fewer than a layer of tiles is sent at a time.
TEST(SendSamples, SendsAllSlicesWhateverTheirSize) {
  const DistanceField field = odd_field({{700, 800, 11}, {}, {1, 1, 1}}, 2000);
  std::vector<float> sent;
  std::size_t largest = 0;
  send_samples(FieldSource(field), distance_array(field), {}, [&](std::span<const std::byte> part) {
    const auto* values = reinterpret_cast<const float*>(part.data());
    sent.insert(sent.end(), values, values + part.size() / sizeof(float));
    largest = std::max(largest, part.size());
  });
  EXPECT_TRUE(sent == field.to_dense());
  EXPECT_LE(largest, std::size_t{4} << 20);
}

TEST(FieldFormats, AreThoseThatTheDocumentationNames) {
  const std::string names = documented("## Fields");
  std::string::size_type at = 0;
  for (const FileFormat& format : field_formats()) {
    const auto found = names.find("`." + format.extension + "`");
    EXPECT_TRUE(found != names.npos && found >= at) << "docs/formats.md: no row of ." << format.extension;
    at = found;
    EXPECT_TRUE(format.readable && format.writable);
    EXPECT_FALSE(format.description.empty());
  }
  EXPECT_EQ(static_cast<std::size_t>(std::ranges::count(names, '\n')), field_formats().size() + 2);  // its head too
}

TEST(FieldFormats, UnknownNamesAreRefused) {
  const TempFolder folder;
  expect_error([&] { write_field(folder / "a.vtk", odd_field()); }, ErrorCode::usage,
               "a.vtk: no field format is called .vtk; use one of .vti, .nrrd, ");
  expect_error([&] { write_field(folder / "a", odd_field()); }, ErrorCode::usage,
               "a: the name has no extension; use one of");
  expect_error([&] { read_field(folder / "a.txt"); }, ErrorCode::input, "a.txt: no field format is called .txt");
  expect_error([&] { write_field(folder / "no/a.vti", odd_field()); }, ErrorCode::output,
               "does not exist; create it first");
  EXPECT_TRUE(folder.names().empty());
}

}  // namespace
}  // namespace standoff
