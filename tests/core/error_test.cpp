// SPDX-License-Identifier: Apache-2.0
// What an Error's details say: the same as its message, for programs.
#include "standoff/error.h"

#include <gtest/gtest.h>

#include <fstream>
#include <functional>
#include <string>
#include <type_traits>

#include "standoff/compute.h"
#include "standoff/io.h"
#include "standoff/version.h"
#include "tests/support/temp_folder.h"

namespace standoff {
namespace {

const Grid kErrorGrid{{40, 40, 40}, {-1, -1, -1}, {0.1, 0.1, 0.1}};
const Mesh kErrorMesh{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1e100, 0, 0}}, {{0, 1, 2}}};

template <class Call>
Error error_of(Call call) {
  try {
    call();
  } catch (const Error& error) {
    return error;
  }
  return {ErrorCode::internal, "no error"};
}

bool says(const Error& error, std::int64_t number) {
  return std::string(error.what()).find(std::to_string(number)) != std::string::npos;
}

TEST(ErrorDetails, NameTheTriangle) {
  Mesh mesh = kErrorMesh;
  mesh.triangles.push_back({0, 1, 9});
  for (const auto& call : {std::function<void()>([&] { validate(mesh); }),
                           {[&] { compute(mesh, kErrorGrid, 1, {.sign = {SignMethod::none}}); }}}) {
    const Error error = error_of(call);
    EXPECT_EQ(error.code(), ErrorCode::input);
    EXPECT_EQ(error.details().triangle, 1);
    EXPECT_TRUE(says(error, 1));
  }
  mesh.triangles.back() = {0, 1, 3};
  const Error far = error_of([&] { compute(mesh, kErrorGrid, 1, {.sign = {SignMethod::none}}); });
  EXPECT_EQ(far.code(), ErrorCode::limit);
  EXPECT_EQ(far.details().triangle, 1) << far.what();
  EXPECT_FALSE(far.details().bytes_needed);
}

TEST(ErrorDetails, TellTheBytesOfAComputation) {
  ComputeOptions options{.sign = {SignMethod::none}, .memory_limit = 1000};
  const Error error = error_of([&] { compute(kErrorMesh, kErrorGrid, 1, options); });
  EXPECT_EQ(error.code(), ErrorCode::limit);
  EXPECT_EQ(error.details().bytes_limit, 1000);
  EXPECT_EQ(error.details().bytes_needed, estimate(kErrorMesh, kErrorGrid, 1, options).whole);
}

TEST(ErrorDetails, TellTheBytesAndTheFileOfAField) {
  const TempFolder folder;
  const auto path = folder / "a.npz";
  write_field(path, compute(kErrorMesh, kErrorGrid, 1, {.sign = {SignMethod::none}}).field);
  const Error error = error_of([&] { read_field(path, {.memory_limit = 1000}); });
  EXPECT_EQ(error.code(), ErrorCode::limit);
  EXPECT_EQ(error.details().bytes_limit, 1000);
  EXPECT_GT(error.details().bytes_needed.value_or(0), 1000);
  EXPECT_EQ(error.details().file, path.string());
}

TEST(ErrorDetails, TellTheFileThatIsOfNoFieldFormat) {
  const TempFolder folder;
  const auto path = folder / "a.obj";
  std::ofstream(path) << "v 0 0 0\n";
  const Error error = error_of([&] { read_field(path); });
  EXPECT_EQ(error.code(), ErrorCode::input);
  EXPECT_EQ(error.details().file, path.string());
}

TEST(ErrorDetails, TellFileAndLine) {
  const TempFolder folder;
  const auto path = folder / "a.obj";
  std::ofstream(path) << "v 0 0 0\nv 1 0 0\nv 0 here 0\n";
  const Error error = error_of([&] { read_mesh(path); });
  EXPECT_EQ(error.code(), ErrorCode::input);
  EXPECT_EQ(error.details().file, path.string());
  EXPECT_EQ(error.details().line, 3);
  EXPECT_FALSE(error.details().byte);
  const Error missing = error_of([&] { read_mesh(folder / "none.obj"); });
  EXPECT_EQ(missing.details().file, (folder / "none.obj").string());
  EXPECT_FALSE(missing.details().line);
}

TEST(ErrorDetails, TellFileAndByte) {
  const TempFolder folder;
  const auto path = folder / "a.gltf";
  std::ofstream(path) << R"({"asset" 1})";
  const Error error = error_of([&] { read_mesh(path); });
  EXPECT_EQ(error.code(), ErrorCode::input);
  EXPECT_TRUE(error.details().byte && says(error, *error.details().byte)) << error.what();
}

TEST(ErrorDetails, TellTheFileThatCannotBeWritten) {
  const TempFolder folder;
  const auto path = folder / "none" / "a.obj";
  const Error error = error_of([&] { write_mesh(path, kErrorMesh); });
  EXPECT_EQ(error.code(), ErrorCode::output);
  EXPECT_EQ(error.details().file, path.string());
}

// What is thrown is copied, also where there is no memory left.
static_assert(std::is_nothrow_copy_constructible_v<Error>);

TEST(ErrorDetails, AreEmptyWhereNothingIsKnown) {
  const Error error(ErrorCode::usage, "what");
  EXPECT_FALSE(error.details().triangle || error.details().bytes_needed || error.details().line);
  EXPECT_EQ(error.details().file, "");
}

TEST(Version, IsTheSameInNumbersAndText) {
  const std::string numbers = std::to_string(STANDOFF_VERSION_MAJOR) + "." + std::to_string(STANDOFF_VERSION_MINOR) +
                              "." + std::to_string(STANDOFF_VERSION_PATCH);
  EXPECT_EQ(numbers, STANDOFF_VERSION);
  EXPECT_EQ(numbers, version());
}

}  // namespace
}  // namespace standoff
