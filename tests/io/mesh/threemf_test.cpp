// SPDX-License-Identifier: Apache-2.0
// 3MF: what a build places, its units, parts in other files of the archive; what is refused.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include "standoff/io.h"
#include "tests/support/expect_error.h"
#include "tests/support/paths.h"
#include "tests/support/stored_zip.h"
#include "tests/support/temp_folder.h"

namespace standoff {
namespace {

const std::filesystem::path kSamples = std::filesystem::path(kSourceFolder) / "tests/corpus/mesh";

// One triangle, object 1.
constexpr const char* kTriangle =
    R"(<object id="1"><mesh><vertices><vertex x="1" y="2" z="3"/><vertex x="4" y="2" z="3"/><vertex x="1" y="7" z="3"/>)"
    R"(</vertices><triangles><triangle v1="0" v2="1" v3="2"/></triangles></mesh></object>)";

std::string model(const std::string& objects, const std::string& build, const std::string& attributes = "") {
  return "<model " + attributes + "><resources>" + kTriangle + objects + "</resources><build>" + build +
         "</build></model>";
}

Mesh read(const std::string& text, MeshReadReport* report = nullptr) {
  const TempFolder folder;
  MeshReadResult read = read_mesh(folder.file("a.3mf", stored_zip({{"3D/3dmodel.model", text}})));
  if (report) *report = read.report;
  return std::move(read.mesh);
}

void refused(const std::string& text, const std::string& words, ErrorCode code = ErrorCode::input) {
  SCOPED_TRACE(text.substr(0, 1000));
  expect_error([&] { read(text); }, code, words);
}

Vec3 corner(const Mesh& mesh, std::size_t triangle, std::size_t c) {
  return mesh.vertices[mesh.triangles[triangle][c]];
}

// Row vectors: the first three numbers are where x goes, the last three the shift.
TEST(Threemf, PlacesAsTheSpecificationSays) {
  const Mesh moved = read(model("", R"(<item objectid="1" transform="0 1 0 0 0 1 1 0 0 10 20 30"/>)", "unit='meter'"));
  // (1, 2, 3) becomes (3, 1, 2) and moves to (13, 21, 32); z is up.
  EXPECT_EQ(corner(moved, 0, 0), (Vec3{13, 32, -21}));
  // The item is outermost: first twice as large, then moved.
  const Mesh nested = read(model(R"(<object id="2"><components><component objectid="1" )"
                                 R"(transform="2 0 0 0 2 0 0 0 2 0 0 0"/></components></object>)",
                                 R"(<item objectid="2" transform="1 0 0 0 1 0 0 0 1 10 0 0"/>)", "unit='meter'"));
  EXPECT_EQ(corner(nested, 0, 0), (Vec3{12, 6, -4}));
}

TEST(Threemf, KeepsTheOutsideOfWhatAMirrorPlaces) {
  const Mesh plain = read(model("", R"(<item objectid="1"/>)", "unit='meter'"));
  const Mesh mirrored = read(model("", R"(<item objectid="1" transform="-1 0 0 0 1 0 0 0 1 0 0 0"/>)", "unit='meter'"));
  for (std::size_t c = 0; c < 3; ++c) {
    const Vec3 p = corner(plain, 0, (3 - c) % 3);
    EXPECT_EQ(corner(mirrored, 0, c), (Vec3{-p.x, p.y, p.z}));
  }
}

TEST(Threemf, IsReadInMetresWithYUp) {
  MeshReadReport report;
  for (const auto& [unit, metres] : std::vector<std::pair<std::string, double>>{{"micron", 1e-6},
                                                                                {"millimeter", 0.001},
                                                                                {"centimeter", 0.01},
                                                                                {"inch", 0.0254},
                                                                                {"foot", 0.3048},
                                                                                {"meter", 1}}) {
    const Mesh mesh = read(model("", R"(<item objectid="1"/>)", "unit='" + unit + "'"), &report);
    EXPECT_EQ(corner(mesh, 0, 1), (Vec3{4 * metres, 3 * metres, -2 * metres})) << unit;
    EXPECT_EQ(report.unit_scale, metres) << unit;
    EXPECT_EQ(report.metres_per_unit, 1);
    EXPECT_EQ(report.axes, (std::array<int, 3>{1, 3, -2}));
    EXPECT_EQ(report.format, "3mf");
  }
  read(model("", R"(<item objectid="1"/>)"), &report);
  EXPECT_EQ(report.unit_scale, 0.001) << "millimetres, where the file does not say";
}

TEST(Threemf, ComponentsAreBounded) {
  const auto assembly = [](int id, const std::string& components) {
    return "<object id='" + std::to_string(id) + "'><components>" + components + "</components></object>";
  };
  const auto component = [](int id) { return "<component objectid='" + std::to_string(id) + "'/>"; };
  refused(model(assembly(2, component(3)) + assembly(3, component(2)), "<item objectid='2'/>"),
          "line 1: an object is a component of itself");
  std::string chain;
  for (int n = 2; n < 400; ++n) chain += assembly(n, component(n - 1));
  refused(model(chain, "<item objectid='399'/>"), "line 1: components are nested more than 200 deep");
  EXPECT_EQ(read(model(chain, "<item objectid='190'/>")).triangles.size(), 1u);
  // Known from an item before, and too deep all the same.
  refused(model(chain, "<item objectid='190'/><item objectid='399'/>"), "nested more than 200 deep");
  // 2^15 placements of 200 vertices are more than a file of its size may become; 2^40 of nothing take too long.
  std::string vertices, doubling, empty = "<object id='2'/>";
  for (int n = 0; n < 200; ++n) vertices += "<vertex x='0' y='0' z='0'/>";
  doubling = "<object id='2'><mesh><vertices>" + vertices +
             "</vertices><triangles><triangle v1='0' v2='1' v3='2'/></triangles></mesh></object>";
  for (int n = 3; n < 18; ++n) doubling += assembly(n, component(n - 1) + component(n - 1));
  refused(model(doubling, "<item objectid='17'/>"),
          "its nodes place meshes until they have 6553600 vertices and 32768 triangles", ErrorCode::limit);
  for (int n = 3; n < 43; ++n) empty += assembly(n, component(n - 1) + component(n - 1));
  refused(model(empty, "<item objectid='42'/>"), "place more than 1000000 objects");
}

// 70 MB in 70 KB; without a bound, one of any size.
TEST(Threemf, PartsThatUnpackTooFarAreRefused) {
  const TempFolder folder;
  const std::string command =
      std::string(kPython) +
      " -B -c 'import sys, zipfile; z = zipfile.ZipFile(sys.argv[1], \"w\", "
      "zipfile.ZIP_DEFLATED); z.writestr(\"3D/3dmodel.model\", \" \" * 80000000); z.close()' '" +
      (folder / "a.3mf").string() + "'";
  ASSERT_EQ(std::system(command.c_str()), 0);
  expect_error([&] { read_mesh(folder / "a.3mf"); }, ErrorCode::limit,
               "a.3mf:3D/3dmodel.model: with it the file unpacks to more than 6");
}

TEST(Threemf, ElementsNestedDeepAreRefused) {
  std::string deep;
  for (int n = 0; n < 100'000; ++n) deep += "<a>";
  refused(model(deep, ""), "elements nested more than 100 deep");
}

TEST(Threemf, TakesNumbersAsTheSpecificationWritesThem) {
  const auto first = [](const std::string& x) {
    std::string text = model("", R"(<item objectid="1"/>)", "unit='meter'");
    const std::string old = R"(x="1" y="2")";
    return text.replace(text.find(old), old.size(), "x=\"" + x + "\" y=\"2\"");
  };
  for (const auto& [x, value] :
       std::vector<std::pair<std::string, double>>{{"+.5", 0.5}, {" 1e1 ", 10}, {"-2.5E-1", -0.25}, {"1e-999", 0}})
    EXPECT_EQ(corner(read(first(x)), 0, 0).x, value) << x;
  for (const std::string x : {"", "1 2", "0x1", "1,5", "inf", "nan", "1e999", "--1", "1e"})
    refused(first(x), "line 1: attribute x must be a finite number");
}

TEST(Threemf, IsWhatAnotherReaderReads) {
  for (const std::string name :
       {"threemf_plain.3mf", "threemf_no_relations.3mf", "threemf_two_items.3mf", "threemf_components.3mf",
        "threemf_mirrored.3mf", "threemf_not_in_build.3mf", "threemf_production.3mf", "threemf_other_target.3mf"}) {
    SCOPED_TRACE(name);
    const TempFolder folder;
    const std::string command = std::string(kPython) + " -B " + kSourceFolder +
                                "/tests/io/mesh/threemf_reference.py '" + (kSamples / name).string() + "' > '" +
                                (folder / "triangles").string() + "'";
    ASSERT_EQ(std::system(command.c_str()), 0);
    std::istringstream numbers(read_bytes(folder / "triangles"));
    const Mesh mesh = read_mesh(kSamples / name).mesh;
    ASSERT_GE(mesh.triangles.size(), 4u);
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
      for (std::size_t c = 0; c < 3; ++c) {
        Vec3 p;
        ASSERT_TRUE(numbers >> p.x >> p.y >> p.z);
        const Vec3 read = corner(mesh, t, c);
        EXPECT_NEAR(read.x, 0.001 * p.x, 1e-15);
        EXPECT_NEAR(read.y, 0.001 * p.z, 1e-15);
        EXPECT_NEAR(read.z, -0.001 * p.y, 1e-15);
      }
    double more;
    EXPECT_FALSE(numbers >> more);
  }
}

}  // namespace
}  // namespace standoff
