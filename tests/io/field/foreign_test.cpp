// SPDX-License-Identifier: Apache-2.0
// Our files read by VTK, numpy, teem and OpenVDB, and theirs read by us. NanoVDB is asked in nanovdb_test.cpp.
#include <gtest/gtest.h>

#include <cstdlib>

#include "odd_field.h"
#include "standoff/io.h"
#include "tests/support/expect_error.h"
#include "tests/support/paths.h"
#include "tests/support/temp_folder.h"

namespace standoff {
namespace {

// Runs tests/io/field/foreign.py; what it complains of is the test's output. A missing module is a failure too:
// script/bootstrap installs them.
void run_foreign(const std::string& arguments) {
  const std::string command = std::string(kPython) + " -B " + kSourceFolder + "/tests/io/field/foreign.py " + arguments;
  EXPECT_EQ(std::system(command.c_str()), 0) << command;
}

std::string quoted(const std::string& text) { return "'" + text + "'"; }

// Debian has no reader of Zarr 3: python/tests/zarr_test.py asks zarr-python and TensorStore.
std::vector<FileFormat> formats_for_python() {
  auto formats = field_formats();
  std::erase_if(formats, [](const FileFormat& format) { return format.extension == "nvdb" || format.folder; });
  return formats;
}

class ReadByOthers : public ::testing::TestWithParam<FileFormat> {};
INSTANTIATE_TEST_SUITE_P(AllFormats, ReadByOthers, ::testing::ValuesIn(formats_for_python()),
                         [](const auto& format) { return format.param.extension; });

TEST_P(ReadByOthers, FullField) {
  for (const bool compress : {false, true}) {
    const TempFolder folder;
    const auto path = folder / ("field." + GetParam().extension);
    write_field(path, odd_field(), {.compress = compress});
    run_foreign("read " + quoted(path.string()) + " inf");
  }
}

// Tiles deep inside that are not stored have the right sign, and so has what is beyond the grid's last whole tile.
TEST_P(ReadByOthers, SignedField) {
  for (const bool compress : {false, true}) {
    const TempFolder folder;
    const auto path = folder / ("field." + GetParam().extension);
    write_field(path, ball_field(), {.compress = compress});
    run_foreign("ball " + quoted(path.string()));
  }
}

TEST_P(ReadByOthers, BandWithNearestTriangles) {
  const TempFolder folder;
  const auto path = folder / ("field." + GetParam().extension);
  write_field(path, odd_field(odd_grid(), 4200.5, GetParam().nearest));
  run_foreign("read " + quoted(path.string()) + " 4200.5" + (GetParam().nearest ? " nearest" : ""));
}

struct Foreign {
  const char* kind;
  const char* extension;
};
void PrintTo(const Foreign& foreign, std::ostream* out) { *out << foreign.kind; }

class WrittenByOthers : public ::testing::TestWithParam<Foreign> {};
INSTANTIATE_TEST_SUITE_P(
    Readers, WrittenByOthers,
    ::testing::Values(Foreign{"vtk header 32", "vti"}, Foreign{"vtk header 64", "vti"},
                      Foreign{"vtk big endian", "vti"}, Foreign{"vtk extent from 5", "vti"}, Foreign{"vtk zlib", "vti"},
                      Foreign{"vtk zlib header 32", "vti"}, Foreign{"vtk zlib big endian", "vti"},
                      Foreign{"numpy C order", "npz"}, Foreign{"numpy Fortran order", "npz"},
                      Foreign{"numpy big endian", "npz"}, Foreign{"numpy extra arrays", "npz"},
                      Foreign{"numpy compressed C order", "npz"}, Foreign{"numpy compressed Fortran order", "npz"},
                      Foreign{"teem gzip", "nrrd"}, Foreign{"teem little", "nrrd"}, Foreign{"teem big", "nrrd"}));

TEST_P(WrittenByOthers, IsTheSameField) {
  const TempFolder folder;
  const auto path = folder / (std::string("field.") + GetParam().extension);
  run_foreign("write " + quoted(path.string()) + " " + quoted(GetParam().kind));
  const DistanceField field = read_field(path);
  const DistanceField expected = odd_field();
  EXPECT_EQ(field.grid().size, expected.grid().size);
  EXPECT_EQ(field.grid().spacing, expected.grid().spacing);
  // A file whose extent does not begin at 0 has its origin elsewhere, and rounds on the way back.
  const Vec3 off = field.grid().origin - expected.grid().origin;
  EXPECT_LE(length(off), 1e-9);
  EXPECT_EQ(field.thickness(), kInfinite);
  EXPECT_EQ(field.provenance().mesh_hash, 0u);
  EXPECT_TRUE(field.to_dense() == expected.to_dense());
}

// Half as many kilobytes as it has megabytes of samples: the limit is held though the file is small.
TEST(CompressedField, KeepsToTheMemoryLimit) {
  const TempFolder folder;
  const auto path = folder / "zeros.npz";
  run_foreign("write " + quoted(path.string()) + " 'numpy compressed zeros'");
  ASSERT_LT(std::filesystem::file_size(path), 100'000u);
  expect_error([&] { read_field(path, {.memory_limit = 1 << 20}); }, ErrorCode::limit, "its tiles need");
  // Room for the tiles, but none for the layer that is unpacked.
  const DistanceField field = read_field(path);
  EXPECT_EQ(field.grid().size, (Size3{200, 200, 200}));
  const std::int64_t layer = 4 * 8 * 200 * 200;
  expect_error([&] { read_field(path, {.memory_limit = field.memory_bytes() + layer / 2}); }, ErrorCode::limit,
               "its tiles need");
  EXPECT_NO_THROW(read_field(path, {.memory_limit = field.memory_bytes() + 4 * layer}));
}

TEST(CompressedField, OfAnotherCodecIsRefused) {
  const TempFolder folder;
  const auto path = folder / "lz4.vti";
  run_foreign("write " + quoted(path.string()) + " 'vtk lz4'");
  expect_error([&] { read_field(path); }, ErrorCode::input,
               "it is compressed by vtkLZ4DataCompressor, which is not read; save it with zlib, or plain");
}

TEST(RewrittenByVtk, KeepsFactsAndNearestTriangles) {
  const TempFolder folder;
  const auto path = folder / "field.vti";
  write_field(path, odd_field(odd_grid(), 4200.5, true));
  run_foreign("write " + quoted(path.string()) + " 'vtk rewritten'");
  const DistanceField field = read_field(path);
  EXPECT_EQ(field.thickness(), 4200.5);
  EXPECT_EQ(field.provenance().method, "tiles");
  EXPECT_EQ(field.provenance().version, "1.2.3");
  EXPECT_EQ(field.provenance().mesh_hash, 0x0123456789abcdefu);
  ASSERT_TRUE(field.has_nearest());
  EXPECT_EQ(field.nearest(7, 3, 2), odd_nearest(7, 3, 2, 4200.5));
  EXPECT_EQ(field.nearest(7, 3, 20), kNoTriangle);
}

}  // namespace
}  // namespace standoff
