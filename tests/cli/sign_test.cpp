// SPDX-License-Identifier: Apache-2.0
// The options of the sign: what the program computes, says and refuses.
#include <gtest/gtest.h>

#include <filesystem>

#include "standoff/inspect.h"
#include "standoff/io.h"
#include "tests/cli/program.h"
#include "tests/sign/shapes.h"

namespace standoff::testing {
namespace {

// Meshes in files: a ball of radius 1, one of them damaged or turned inside out; a sheet; a strip with one side.
class Sign : public ProgramTest {
 protected:
  Sign() {
    const Mesh ball = sphere(8);
    write_mesh(folder / "ball.obj", ball);
    write_mesh(folder / "inside_out.obj", reversed(ball));
    write_mesh(folder / "flipped.obj", with_flipped(ball, 60));
    write_mesh(folder / "hole.obj", without(ball, 60));
    write_mesh(folder / "both.obj", joined(ball, reversed(ball)));
    write_mesh(folder / "nested.obj", joined(ball, moved(ball, {}, 0.5)));
    write_mesh(folder / "sheet.obj", terrain(8, 0.1));
    write_mesh(folder / "strip.obj", moebius());
  }
  Ran compute(const std::string& options) const { return run(words("compute -r 24 -f -o out.vti " + options)); }
  DistanceField field() const { return read_field(folder / "out.vti"); }
  // The signs at the centre, between the two balls of nested.obj, and far outside: as in "-+-".
  std::string sides(const std::string& options) const {
    const Ran ran = compute(options);
    EXPECT_EQ(ran.code, 0) << ran.err;
    if (ran.code != 0) return "";
    const DistanceField computed = field();
    std::string found;
    for (const double x : {0.02, 0.75, 1.1}) found += computed.interpolate({x, 0.01, 0.02}) < 0 ? '-' : '+';
    return found;
  }
};

TEST_F(Sign, EveryMethodAndRule) {
  EXPECT_EQ(sides("ball.obj"), "--+") << "auto is the default";
  for (const std::string method : {"none", "auto", "winding", "parity", "normal", "facet", "flood"})
    EXPECT_EQ(sides("ball.obj --sign " + method), method == "none" ? "+++" : "--+") << method;
  EXPECT_EQ(sides("ball.obj --sign winding --invert"), "++-");
  EXPECT_EQ(sides("ball.obj --sign auto --invert"), "++-");
  EXPECT_EQ(sides("nested.obj --sign winding"), "--+");
  EXPECT_EQ(sides("nested.obj --sign winding --rule nonzero"), "--+");
  EXPECT_EQ(sides("nested.obj --sign winding --rule odd"), "+-+");
  EXPECT_EQ(sides("nested.obj --sign parity"), "+-+");
  EXPECT_EQ(sides("nested.obj --sign flood"), "--+");
}

TEST_F(Sign, ConfidenceIsAFileOfItsOwn) {
  for (const std::string wrong : {"out.vti", "./out.vti", "ball.obj", "margins.txt", "nowhere/margins.vti"})
    EXPECT_NE(compute("ball.obj --sign auto --confidence " + wrong).code, 0) << wrong;
  EXPECT_FALSE(std::filesystem::exists(folder / "out.vti"));
  EXPECT_EQ(compute("ball.obj --sign none --confidence margins.vti").code, 2);
  const Ran ran = compute("hole.obj --sign auto --confidence margins.vti");
  ASSERT_EQ(ran.code, 0) << ran.err;
  EXPECT_TRUE(ran.says("confidence: of ")) << ran.err;
  const DistanceField margins = read_field(folder / "margins.vti");
  EXPECT_EQ(margins.grid(), field().grid());
  EXPECT_EQ(margins.thickness(), 0.5);
  EXPECT_GE(inspect(margins).min, 0);
  EXPECT_LT(inspect(margins).min, 0.5);
  // It is in the way now; nothing is computed.
  EXPECT_EQ(run(words("compute -r 24 -o other.vti hole.obj --sign auto --confidence margins.vti")).code, 2);
  EXPECT_FALSE(std::filesystem::exists(folder / "other.vti"));
}

TEST_F(Sign, Outer) {
  const Ran ran = compute("nested.obj --sign auto --outer --json");
  ASSERT_EQ(ran.code, 0) << ran.err;
  const Json json = Json::parse(ran.out);
  EXPECT_EQ(json["sign"]["internal"], 224);
  EXPECT_EQ(json["sign"]["cut"], 0);
  EXPECT_NE(ran.err.find("224 triangles inside the union left out"), std::string::npos) << ran.err;
  EXPECT_LT(field().interpolate({0.02, 0.01, 0.02}), -0.8);  // without it -0.48
  EXPECT_EQ(field().provenance().sign, "winding outer");
  EXPECT_EQ(run(words("verify out.vti nested.obj")).code, 0);
  EXPECT_EQ(compute("sheet.obj --sign auto --outer").code, 3);
  EXPECT_EQ(compute("ball.obj --sign flood --outer").code, 2);
  EXPECT_EQ(compute("ball.obj --sign none --outer").code, 2);
}

// The sheet's height is within 0.1 of z = 0. The grid reaches around the solid.
TEST_F(Sign, Shell) {
  EXPECT_EQ(compute("sheet.obj --sign shell:0.5").code, 0);
  const DistanceField shell = field();
  EXPECT_LT(shell.interpolate({0, 0, 0.1}), 0);
  EXPECT_GT(shell.interpolate({0, 0, 0.38}), 0);
  EXPECT_GT(shell.interpolate({0, 0, -0.38}), 0);
  EXPECT_GT(shell.interpolate({1.3, 0, 0}), 0);
  for (const std::string wrong : {"shell", "shell:", "shell:0", "shell:-1", "shell:thick", "winding:2", "flood:0.1"}) {
    const Ran ran = compute("sheet.obj --sign " + wrong);
    EXPECT_EQ(ran.code, 2) << wrong << "\n" << ran.err;
    EXPECT_TRUE(ran.says("standoff: error: --sign '" + wrong + "': ")) << ran.err;
  }
}

TEST_F(Sign, DamageIsRepairedUnlessTold) {
  for (const std::string mesh : {"inside_out.obj", "flipped.obj", "hole.obj"})
    for (const std::string method : {"auto", "winding"}) EXPECT_EQ(sides(mesh + " --sign " + method), "--+") << mesh;
  for (const std::string mesh : {"inside_out.obj", "flipped.obj"})
    EXPECT_EQ(sides(mesh + " --sign normal"), "--+") << mesh;
  EXPECT_EQ(sides("inside_out.obj --sign normal --as-oriented"), "++-");
  EXPECT_EQ(sides("inside_out.obj --sign winding --as-oriented"), "+++");
  EXPECT_EQ(sides("inside_out.obj --sign winding --as-oriented --rule nonzero"), "--+");
  EXPECT_EQ(sides("both.obj --sign auto"), "--+");
  EXPECT_EQ(sides("both.obj --sign flood"), "--+");
}

// One line on stderr says which method and why, also where there is no sign at last.
TEST_F(Sign, SaysWhichMethodAndWhy) {
  EXPECT_TRUE(compute("ball.obj --sign auto").says("sign by winding: ")) << compute("ball.obj --sign auto").err;
  const Ran flipped = compute("flipped.obj --sign auto");
  EXPECT_TRUE(flipped.says("sign by winding: ")) << flipped.err;
  EXPECT_TRUE(flipped.says("1 triangle flipped")) << flipped.err;
  const Ran sheet = compute("sheet.obj --sign auto");
  EXPECT_EQ(sheet.code, 0);
  EXPECT_TRUE(sheet.says("no sign: ")) << sheet.err;
  EXPECT_TRUE(sheet.says("normal") && sheet.says("shell")) << sheet.err;
  EXPECT_GE(field().interpolate({0, 0, -0.2}), 0);
  // A sheet by its winding number is computed, with a warning of what to take instead, even in silence.
  const Ran winding = compute("sheet.obj --sign winding -q");
  EXPECT_EQ(winding.code, 0);
  EXPECT_TRUE(winding.says("normal")) << winding.err;
}

// Whoever decides a sign says its doubt, in the same words, also in silence.
TEST_F(Sign, EachVerbThatDecidesItWarns) {
  write_bytes(folder / "points.csv", "1,2,3\n");
  const std::string warning = compute("hole.obj --sign winding -q").err;
  ASSERT_TRUE(warning.starts_with("standoff: warning: sign by winding: ") && warning.ends_with("; not certain\n"));
  for (const std::string command :
       {"points MESH.obj points.csv", "surface MESH.obj -r 16 -o MESH.ply", "view MESH.obj -r 16 -o MESH.html",
        "voxels MESH.obj -r 16 -o MESH.npz", "build MESH.obj -o MESH.query"}) {
    const auto ran_with = [&](const std::string& mesh) {
      std::string line = command + " -q --sign winding";
      for (std::size_t at; (at = line.find("MESH")) != line.npos;) line.replace(at, 4, mesh);
      return done(words(line));
    };
    EXPECT_TRUE(ran_with("hole").says(warning)) << command;
    EXPECT_FALSE(ran_with("ball").says("warning: sign")) << command;
  }
  EXPECT_EQ(run(words("points hole.query points.csv -q")).err, warning);
  EXPECT_TRUE(run(words("points ball.obj points.csv")).says("\nsign by winding: the mesh is closed"));
}

TEST_F(Sign, StrictNamesVerbAndFile) {
  write_bytes(folder / "points.csv", "1,2,3\n");
  for (const std::string command :
       {"compute sheet.obj -r 16 -o a.vti", "compute sheet.obj -r 16 -o a.vdb", "points sheet.obj points.csv",
        "surface sheet.obj -r 16 -o a.ply", "view sheet.obj -r 16 -o a.html", "voxels sheet.obj -r 16 -o a.npz",
        "crossings sheet.obj -r 16 -o a.npz", "build sheet.obj -o a.query"}) {
    const Ran ran = run(words(command + " --strict"));
    EXPECT_EQ(ran.code, 8) << command;
    const std::string verb = command.substr(0, command.find(' '));
    EXPECT_TRUE(ran.says("standoff: error: sheet.obj: " + verb + ": the sign is not certain (")) << ran.err;
  }
}

TEST_F(Sign, Json) {
  const Json flipped = compute("flipped.obj --sign auto --json").json()["sign"];
  EXPECT_EQ(flipped["method"], "winding");
  EXPECT_EQ(flipped["sure"], true);
  EXPECT_EQ(flipped["flipped"], 1);
  EXPECT_EQ(flipped["boundary_edges"], 0);
  EXPECT_FALSE(flipped["why"].get<std::string>().empty());
  const Json hole = compute("hole.obj --sign winding --json").json()["sign"];
  EXPECT_EQ(hole["boundary_edges"], 3);
  const Json both = compute("both.obj --sign auto --json").json()["sign"];
  EXPECT_GT(both["left_out"], 0);
  EXPECT_EQ(compute("sheet.obj --sign auto --json").json()["sign"]["method"], "");
}

TEST_F(Sign, StrictRefusesWhereItDoubts) {
  for (const std::string doubtful : {"sheet.obj --sign auto", "sheet.obj --sign winding", "strip.obj --sign auto",
                                     "strip.obj --sign winding", "sheet.obj --sign flood"}) {
    refused(words("compute -r 16 -o doubt.vti --strict " + doubtful), 8, "standoff: error: ");
    EXPECT_FALSE(folder.names().contains("doubt.vti")) << doubtful;
  }
  for (const std::string sure : {"ball.obj --sign auto", "ball.obj --sign winding", "ball.obj --sign parity",
                                 "inside_out.obj --sign auto", "flipped.obj --sign winding"})
    EXPECT_EQ(compute("--strict " + sure).code, 0) << sure;
}

TEST_F(Sign, PairsThatContradictEachOther) {
  struct Pair {
    const char* options;
    const char* message;
  };
  for (const auto& [options, message] : {
           Pair{"--sign none --invert", "cannot be inverted"},
           Pair{"--sign none --strict", "strict"},
           Pair{"--sign parity --rule odd", "winding rule"},
           Pair{"--sign flood --rule nonzero", "winding rule"},
           Pair{"--sign none --rule odd", "winding rule"},
           Pair{"--sign wind", "--sign 'wind': give "},
           Pair{"--sign winding --rule even", "--rule 'even': give positive, nonzero or odd"},
       }) {
    refused(words("compute -r 16 -o wrong.vti ball.obj " + std::string(options)), 2, message);
    EXPECT_FALSE(folder.names().contains("wrong.vti")) << options;
  }
  const Ran unknown = run(words("compute ball.obj --sign wind"));
  for (const char* method : {"auto", "winding", "parity", "normal", "facet", "flood", "shell", "none"})
    EXPECT_TRUE(unknown.says(method)) << method << " is not named: " << unknown.err;
}

TEST_F(Sign, ParityOfAnOpenMeshIsRefused) {
  const Ran ran = refused(words("compute -r 16 -o open.vti hole.obj --sign parity"), 3, "not closed");
  EXPECT_TRUE(ran.says("take")) << ran.err;
}

TEST_F(Sign, VerifyFindsAForeignMesh) {
  EXPECT_EQ(compute("ball.obj --sign winding").code, 0);
  EXPECT_EQ(run(words("verify out.vti ball.obj")).code, 0);
  EXPECT_NE(run(words("verify out.vti inside_out.obj")).code, 0);
}

}  // namespace
}  // namespace standoff::testing
