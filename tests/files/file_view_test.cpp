// SPDX-License-Identifier: Apache-2.0
// Input files, whatever becomes of them while they are read.
#include "files/file_view.h"

#include <gtest/gtest.h>
#include <sys/stat.h>

#include <thread>
#include <vector>

#include "standoff/io.h"
#include "tests/support/expect_error.h"
#include "tests/support/formats.h"
#include "tests/support/temp_folder.h"

namespace standoff {
namespace {

using Access = FileView::Access;

std::string many_bytes(std::size_t count) {
  std::string bytes(count, 0);
  for (std::size_t n = 0; n < count; ++n) bytes[n] = static_cast<char>(n * n / 7);
  return bytes;
}

TEST(FileView, HoldsAllBytes) {
  const TempFolder folder;
  for (const std::size_t size : {0u, 1u, 65535u, 65536u, 65537u, 3'000'000u}) {
    const std::string bytes = many_bytes(size);
    const auto path = folder.file("a", bytes);
    for (const Access access : {Access::copy, Access::map}) EXPECT_EQ(FileView(path, access).bytes(), bytes) << size;
  }
}

TEST(FileView, ReadsPipes) {
  const TempFolder folder;
  const auto path = folder / "pipe";
  const std::string bytes = many_bytes(1'000'000);
  for (const Access access : {Access::copy, Access::map}) {
    ASSERT_EQ(::mkfifo(path.c_str(), 0600), 0);
    std::thread writer([&] { write_bytes(path, bytes); });
    EXPECT_EQ(FileView(path, access).bytes(), bytes);
    writer.join();
    std::filesystem::remove(path);
  }
}

TEST(FileView, SaysWhyItCannotRead) {
  const TempFolder folder;
  for (const Access access : {Access::copy, Access::map}) {
    expect_error([&] { FileView(folder / "none", access); }, ErrorCode::input, "none: no such file");
    expect_error([&] { FileView(folder.path(), access); }, ErrorCode::input, ": it is a folder");
    expect_error([&] { FileView("/dev/null", access); }, ErrorCode::input, "/dev/null: it is a device");
  }
}

// Meshes were read from a mapping of the file: when another program shortened it meanwhile, the first look past its new
// end was a SIGBUS, which no caller can catch.
TEST(FileView, AFileShortenedWhileItIsReadIsNoCrash) {
  const TempFolder folder;
  Mesh mesh;
  for (std::uint32_t t = 0; t < 5000; ++t) {
    for (const double y : {0.0, 1.0, 2.0}) mesh.vertices.push_back({double(t), y, y * y});
    mesh.triangles.push_back({3 * t, 3 * t + 1, 3 * t + 2});
  }
  const auto path = folder / "a.stl";
  write_mesh(path, mesh);
  const FileView file(path);
  std::filesystem::resize_file(path, 100);
  EXPECT_EQ(read_as("stl", file).triangles.size(), 5000u);
}

// A fuzzer's find, which only the address sanitizer sees: past the word "ply" the byte after the file was looked at.
TEST(FileView, APlyOfOneWordIsReadNoFurther) {
  const std::vector<char> bytes{'p', 'l', 'y'};
  const FileView file("a.ply", {bytes.data(), bytes.size()});
  expect_error([&] { read_as("ply", file); }, ErrorCode::input, "a.ply:");
}

}  // namespace
}  // namespace standoff
