// SPDX-License-Identifier: Apache-2.0
// docs/defaults.md: every cell about C++ and the program holds, and both choose the same grids. What it says of Python
// is tested by python/tests/defaults_test.py, and Python's grids by field_grids_test.py there.
#include <gtest/gtest.h>

#include <fstream>
#include <map>
#include <regex>
#include <set>
#include <sstream>

#include "standoff/standoff.h"
#include "tests/cli/program.h"
#include "tests/support/paths.h"

namespace standoff::testing {
namespace {

std::string text_of(const std::filesystem::path& path) {
  std::ostringstream text;
  text << std::ifstream(path).rdbuf();
  return text.str();
}

// The cells of a column of the page's table, all together.
std::string column(std::size_t wanted) {
  std::istringstream page(text_of(std::filesystem::path(kSourceFolder) / "docs/defaults.md"));
  std::string cells;
  for (std::string line; std::getline(page, line);) {
    if (!line.starts_with("| ")) continue;
    std::istringstream row(line.substr(1));
    std::string cell;
    for (std::size_t n = 0; n <= wanted; ++n) std::getline(row, cell, '|');
    cells += cell + "\n";
  }
  return cells;
}

TEST(Defaults, OfCxxAreThoseOfThePage) {
  const Box box{{0, 0, 0}, {3, 2, 1}};
  std::map<std::string, bool> holds;
#define HOLDS(expression) holds[#expression] = (expression)
  HOLDS(SignOptions{}.method == SignMethod::automatic);
  HOLDS(fit_resolution(box, 9) == fit_resolution(box, 9, kFullField));
  HOLDS(fit_resolution(box) == fit_resolution(box, 256));
  HOLDS(padding_for(3).length == 3);
  HOLDS(padding_for(3).most_share == 0.1);
  HOLDS(padding_for(3).least_samples == 2);
  HOLDS(padding_for(kFullField).length == 0);
  HOLDS(ComputeOptions{}.memory_limit == 0);
  HOLDS(SurfaceOptions{}.memory_limit == 0);
  HOLDS(FieldReadOptions{}.memory_limit == 0);
  HOLDS(EdgeCrossingOptions{}.memory_limit == 0);
  HOLDS(PictureOptions{}.memory_limit == 0);
  HOLDS(Execution{}.threads == 0);
  HOLDS(Execution{}.backend == Backend::automatic);
  HOLDS(FieldWriteOptions{}.existing == Existing::replace);
  HOLDS(MeshWriteOptions{}.existing == Existing::replace);
#undef HOLDS
  const std::string cells = column(2);
  const std::regex code("`([^`]+)`");
  std::set<std::string> told;
  for (std::sregex_iterator it(cells.begin(), cells.end(), code), end; it != end; ++it) {
    told.insert((*it)[1]);
    EXPECT_TRUE(holds.contains((*it)[1]) && holds[(*it)[1]]) << (*it)[1];
  }
  for (const auto& [expression, value] : holds) EXPECT_TRUE(told.contains(expression)) << expression;
}

// 0 is a share of the machine's memory, also of a control group's; no limit is something else.
TEST(Defaults, MemoryIsAShareOfTheMachines) {
  const double machine = static_cast<double>(::sysconf(_SC_PHYS_PAGES)) * static_cast<double>(::sysconf(_SC_PAGE_SIZE));
  EXPECT_GT(default_memory_limit(), 0);
  EXPECT_LE(static_cast<double>(default_memory_limit()), 0.8 * machine);
  EXPECT_EQ(default_memory_limit(), default_memory_limit());
  const Mesh mesh{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {{0, 1, 2}}};
  const Grid huge{{1 << 20, 1 << 20, 1 << 10}, {}, {1e-6, 1e-6, 1e-3}};
  try {
    compute(mesh, huge, kFullField);
    FAIL() << "no machine holds that";
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ErrorCode::limit);
    EXPECT_EQ(error.details().bytes_limit, default_memory_limit());
  }
  EXPECT_NO_THROW(compute(mesh, {{9, 9, 9}, {}, {0.1, 0.1, 0.1}}, 1, {.memory_limit = kNoMemoryLimit}));
}

class ProgramDefaults : public ProgramTest {};

// What the help of a verb says about an option, in one line.
std::string help_on(const std::string& help, const std::string& option) {
  std::istringstream lines(help);
  std::string found;
  bool within = false;
  for (std::string line; std::getline(lines, line);) {
    const std::size_t begin = line.find_first_not_of(' ');
    if (begin == 2) within = std::regex_search(line, std::regex("(^|[ ,])" + option + "\\b"));
    if (within) found += line + " ";
  }
  return std::regex_replace(found, std::regex(" +"), " ");
}

TEST_F(ProgramDefaults, AreThoseOfThePage) {
  const std::string cells = column(3);
  const std::regex told("`(\\w+) (--[-\\w]+)` \"([^\"]+)\"");
  int options = 0;
  for (std::sregex_iterator it(cells.begin(), cells.end(), told), end; it != end; ++it, ++options) {
    const std::string help = help_on(done({(*it)[1], "--help"}).out, (*it)[2]);
    EXPECT_NE(help.find((*it)[3]), std::string::npos) << (*it)[0] << ", but: " << help;
  }
  EXPECT_EQ(options, 17);
}

// One mesh and the same numbers give one grid.
TEST_F(ProgramDefaults, GridsAreThoseOfTheLibrary) {
  for (const Vec3 size : {Vec3{2, 1, 0.5}, Vec3{1, 1, 1}, Vec3{0.3, 40, 7}, Vec3{5, 5, 0}}) {
    const Vec3 low{-0.25, 10, 3};
    const Box box{low, low + size};
    const Mesh mesh{{box.min, {box.max.x, box.min.y, box.min.z}, box.max}, {{0, 1, 2}}};
    write_mesh(folder / "box.obj", mesh);
    const auto grid_of = [&](const std::vector<std::string>& options) {
      std::vector<std::string> words{"compute", "box.obj", "--dry-run", "--json", "-f"};
      words.insert(words.end(), options.begin(), options.end());
      return done(words).json()["grid"];
    };
    const auto expect = [&](const Json& found, const Grid& grid) {
      const auto& [s, o, h] = std::tie(grid.size, grid.origin, grid.spacing);
      EXPECT_EQ(found["size"], Json({s.x, s.y, s.z}));
      EXPECT_EQ(found["origin"], Json({o.x, o.y, o.z}));
      EXPECT_EQ(found["spacing"], Json({h.x, h.y, h.z}));
    };
    expect(grid_of({}), fit_resolution(box));
    for (const std::string thickness : {"0.01", "0.1", "0.5", "3", "100"}) {
      SCOPED_TRACE(::testing::Message() << size.y << ", " << thickness);
      const double world = std::stod(thickness);
      expect(grid_of({"-r", "40", "-t", thickness}), fit_resolution(box, 40, world));
      expect(grid_of({"--spacing", "0.2", "-t", thickness}), fit_spacing(box, {0.2, 0.2, 0.2}, world));
      expect(grid_of({"--size", "20,30,9", "-t", thickness}), fit_size(box, {20, 30, 9}, world));
      expect(grid_of({"-r", "40", "-t", thickness + "s"}), fit_resolution(box, 40, padding_for_samples(world)));
    }
  }
}

}  // namespace
}  // namespace standoff::testing
