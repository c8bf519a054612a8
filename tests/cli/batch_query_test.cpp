// SPDX-License-Identifier: Apache-2.0
// Many poses at once: collide, distance and sweep of a file.
#include <fcntl.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <random>
#include <sstream>

#include "tests/cli/program.h"

namespace standoff::testing {
namespace {

class BatchQuery : public ProgramTest {
 protected:
  void write(const std::string& name, const std::string& text) const { write_bytes(folder / name, text); }
  static std::vector<std::string> lines(const std::string& text) {
    std::vector<std::string> found;
    std::istringstream stream(text);
    for (std::string line; std::getline(stream, line);) found.push_back(line);
    return found;
  }
  void expect(const std::string& line, int code, const std::string& part) const {
    const Ran ran = refused(words(line), code, "standoff: error: " + part);
    EXPECT_EQ(std::ranges::count(ran.err, '\n'), 1) << ran.err;
    EXPECT_EQ(ran.out, "") << line;
  }
};

// Boxes of 2 x 1.5 x 1 around the origin, and every way to write a pose.
constexpr const char* kPoses =
    "\xEF\xBB\xBF# x, y, z\n"
    "2.5,0,0\n"
    "1.5, 0.25 ,\t0.25   # in the middle of it\n"
    "\n"
    "   \t\r\n"
    "1.6,0,0,0,1,0,90\r\n"
    "0,0,1,1.6,0,1,0,0,-1,0,0,0\n"
    "+1.6,-0,0e0";

TEST_F(BatchQuery, CollideAnswersLineByLine) {
  write("poses.csv", kPoses);
  const Ran ran = done(words("collide scene:box scene:box --poses poses.csv"));
  EXPECT_EQ(ran.out, "pose,result\n0,free\n1,hit\n2,free\n3,free\n4,hit\n");
  EXPECT_TRUE(ran.err.starts_with("5 poses: 3 free, 2 hit; in ")) << ran.err;
  EXPECT_TRUE(ran.says(" on cpu\n")) << ran.err;
  EXPECT_EQ(done(words("collide scene:box scene:box --poses poses.csv -q")).err, "");
  EXPECT_EQ(done(words("collide scene:box scene:box --poses poses.csv --margin 0.5")).out,
            "pose,result\n0,hit\n1,hit\n2,hit\n3,hit\n4,hit\n");
  // Seen from a turned A nothing changes where B turns with it: -0.25 along x is 0.25 along z.
  write("turned.csv", "0,0,-2.5,0,1,0,90\n");
  EXPECT_EQ(done(words("collide scene:box scene:box --pose-a 0,0,0,0,1,0,90 --poses turned.csv")).out,
            "pose,result\n0,free\n");
  const Json certified = done(words("collide scene:box scene:box --poses poses.csv --certified --json")).json();
  EXPECT_EQ(certified["counts"]["hit"], 0);
  EXPECT_EQ(certified["counts"]["free"].get<int>() + certified["counts"]["ambiguous"].get<int>(), 5);
}

TEST_F(BatchQuery, CollideKnowsInside) {
  write("small.obj", "v 0 0 0\nv 0.2 0 0\nv 0 0.2 0\nf 1 2 3\n");
  write("poses.csv", "0,0,0\n0.9,0,0\n5,0,0\n0.1,0.1,0.1\n");
  const Ran ran = done(words("collide scene:box small.obj --poses poses.csv --containment"));
  EXPECT_EQ(ran.out, "pose,result,containment\n0,hit,b_in_a\n1,hit,none\n2,free,none\n3,hit,b_in_a\n");
  EXPECT_TRUE(ran.says("4 poses: 1 free, 3 hit, 2 b in a, 0 a in b, 0 partly; in ")) << ran.err;
  EXPECT_EQ(done(words("collide scene:box small.obj --poses poses.csv --containment --device emulated")).out, ran.out);
  const Json json = done(words("collide small.obj scene:box --poses poses.csv --containment --json")).json();
  EXPECT_EQ(json["counts"]["hit"], 3);
  EXPECT_EQ(json["counts"]["a_in_b"], 3);
  EXPECT_EQ(json["counts"]["b_in_a"], 0);
  expect("collide small.obj small.obj --poses poses.csv --containment", 3, "collide: neither body is closed");
}

TEST_F(BatchQuery, TheSummaryCounts) {
  write("poses.csv", kPoses);
  const Json cpu = done(words("collide scene:box scene:box --poses poses.csv --json -j 1")).json();
  EXPECT_EQ(cpu["queries"], 5);
  EXPECT_EQ(cpu["counts"]["free"], 3);
  EXPECT_EQ(cpu["counts"]["hit"], 2);
  EXPECT_GE(cpu["seconds"]["query"].get<double>(), 0);
  EXPECT_EQ(cpu["device"], "cpu");
  EXPECT_EQ(cpu["on_device"], 0);
  EXPECT_FALSE(cpu.contains("output"));
  const Json device =
      done(words("collide scene:box scene:box --poses poses.csv --json --device emulated -o a.csv")).json();
  EXPECT_EQ(device["device"], "emulated");
  EXPECT_GT(device["on_device"].get<int>(), 0);
  EXPECT_TRUE(device["recomputed"].contains("undecided"));
  EXPECT_TRUE(device["recomputed"].contains("overflowed"));
  EXPECT_EQ(device["output"]["file"], "a.csv");
  EXPECT_EQ(device["output"]["bytes"], std::filesystem::file_size(folder / "a.csv"));
  const Json near = done(words("distance scene:box scene:box --poses poses.csv --limit 0.2 --json")).json();
  EXPECT_EQ(near["counts"]["touching"], 2);
  EXPECT_EQ(near["counts"]["beyond_limit"], 1);
  EXPECT_FALSE(near["counts"].contains("unfinished"));
  const Ran early = done(words("distance scene:sphere:2000 scene:sphere:2000 --poses poses.csv --max-steps 1"));
  EXPECT_TRUE(early.out.starts_with("pose,lower,upper,ax,ay,az,bx,by,bz,triangle_a,triangle_b,finished\n0,"));
}

TEST_F(BatchQuery, StandardInput) {
  write("poses.csv", kPoses);
  auto how = setup();
  how.in = ::open((folder / "poses.csv").c_str(), O_RDONLY | O_CLOEXEC);
  EXPECT_EQ(run(words("collide scene:box scene:box --poses - -q"), how).out,
            "pose,result\n0,free\n1,hit\n2,free\n3,free\n4,hit\n");
  ::close(how.in);
  write("bad.csv", "1,2,3\n1,2\n");
  how.in = ::open((folder / "bad.csv").c_str(), O_RDONLY | O_CLOEXEC);
  const Ran bad = run(words("collide scene:box scene:box --poses -"), how);
  ::close(how.in);
  EXPECT_EQ(bad.code, 3);
  EXPECT_TRUE(bad.says("standoff: error: standard input:2: give x,y,z; or")) << bad.err;
  how.in = ::open((folder / "poses.csv").c_str(), O_RDONLY | O_CLOEXEC);
  const Ran lost = run(words("collide scene:box scene:box --poses - -f -o poses.csv"), how);
  ::close(how.in);
  EXPECT_EQ(lost.code, 2);
  EXPECT_TRUE(lost.says("poses.csv: it is an input, and would be lost")) << lost.err;
}

TEST_F(BatchQuery, DistancesAndSweeps) {
  write("poses.csv", "5,0,0\n5,9,0\n0,0,0\n");
  const auto near = lines(done(words("distance scene:box scene:box --poses poses.csv --limit 4")).out);
  ASSERT_EQ(near.size(), 4u);
  EXPECT_EQ(near[0], "pose,lower,upper,ax,ay,az,bx,by,bz,triangle_a,triangle_b");
  EXPECT_TRUE(near[1].starts_with("0,3,3,1,")) << near[1];
  EXPECT_EQ(near[2], "1,4,inf,,,,,,,,");
  EXPECT_TRUE(near[3].starts_with("2,0,0,")) << near[3];
  write("ways.csv", "# from, to\n5,0,0, -5,0,0\n5,9,0,-5,9,0\n5,0,0,0,1,0,0, -5,0,0,0,1,0,90\n");
  const auto swept = lines(done(words("sweep scene:box scene:box --motions ways.csv")).out);
  ASSERT_EQ(swept.size(), 4u);
  EXPECT_EQ(swept[0], "motion,result,time,x,y,z,nx,ny,nz,triangle_a,triangle_b");
  EXPECT_TRUE(swept[1].starts_with("0,hit,0.29999")) << swept[1];
  EXPECT_EQ(swept[2], "1,free,1,,,,,,,,");
  EXPECT_TRUE(swept[3].starts_with("2,hit,0.")) << swept[3];
  // As one question of its own, with a centre off the origin.
  const Json one =
      done(words("sweep scene:box scene:box --from 5,0,0,0,1,0,0 --to -5,0,0,0,1,0,90 --center 1,0,0 --json")).json();
  const auto same = lines(done(words("sweep scene:box scene:box --motions ways.csv --center 1,0,0")).out);
  std::istringstream cells(same[3]);
  std::string cell;
  for (int n = 0; n < 3; ++n) std::getline(cells, cell, ',');
  EXPECT_EQ(std::stod(cell), one["time"].get<double>());
}

// Thousands of poses: the table is the same for any number of threads, and where the GPU's kernels decide.
TEST_F(BatchQuery, TheTableDoesNotDependOnTheDevice) {
  std::mt19937 random(1);
  std::uniform_real_distribution<double> place(-2.5, 2.5);
  std::string poses, ways;
  const auto point = [&] {
    return std::to_string(place(random)) + ',' + std::to_string(place(random)) + ',' + std::to_string(place(random));
  };
  for (int n = 0; n < 3000; ++n) {
    poses += point() + ',' + point() + ',' + std::to_string(100 * place(random)) + '\n';
    if (n < 300) ways += point() + ',' + point() + '\n';
  }
  write("poses.csv", poses);
  write("ways.csv", ways);
  done(words("build scene:sphere:500 -o a.body"));
  for (const std::string line :
       {"collide a.body scene:box --poses poses.csv", "sweep a.body scene:box --motions ways.csv",
        "distance a.body scene:box --poses poses.csv --limit 0.5"}) {
    const std::string expected = done(words(line + " -j 1 --device cpu")).out;
    const bool measures = line.starts_with("distance");
    EXPECT_NE(expected.find(measures ? ",0,0," : ",hit"), std::string::npos);
    EXPECT_NE(expected.find(measures ? ",inf," : ",free"), std::string::npos);
    EXPECT_EQ(done(words(line)).out, expected);
    done(words(line + " -o out.csv --device emulated"));
    EXPECT_EQ(read_bytes(folder / "out.csv"), expected) << line;
    done(words(line + " -o out.csv -f -j 3"));
    EXPECT_EQ(read_bytes(folder / "out.csv"), expected) << line;
    std::filesystem::remove(folder / "out.csv");
  }
}

TEST_F(BatchQuery, ErrorsNameFileAndLine) {
  const auto bad = [this](const std::string& line, const std::string& part) {
    write("bad.csv", "1,2,3\n\n" + line + "\n");
    expect("collide scene:box scene:box --poses bad.csv -o out.csv", 3, "bad.csv:3: " + part);
    expect("distance scene:box scene:box --poses bad.csv", 3, "bad.csv:3: " + part);
    EXPECT_FALSE(std::filesystem::exists(folder / "out.csv"));
  };
  bad("x,y,z", "'x' is not a number; separate numbers by commas");
  bad("1 2 3", "'1 2 3' is not a number; separate numbers by commas");
  bad("1,,3", "'' is not a number");
  bad("1,2,", "'' is not a number");
  bad("1,2,nan", "'nan' is not a number");
  bad("1,2,1e999", "'1e999' is out of the range of numbers; separate");
  bad("1,2", "give x,y,z; or x,y,z,ax,ay,az,degrees; or the twelve numbers of a 3x4 matrix, row by row");
  bad("1,2,3,4,5,6", "give x,y,z; or");
  bad("1,2,3,0,0,0,90", "the axis has no direction");
  bad("2,0,0,0,0,2,0,0,0,0,2,0", "pose: the matrix is no rotation");
  bad("1e16,0,0", "pose: the translation is not finite or past 1e+15");
  write("ways.csv", "1,2,3,4,5,6\n1,2,3\n");
  expect("sweep scene:box scene:box --motions ways.csv", 3, "ways.csv:2: 3 numbers; give those of two poses");
  write("ways.csv", "1,2,3,4,5,6,7,8,9,10\n");
  expect("sweep scene:box scene:box --motions ways.csv", 3, "ways.csv:1: 10 numbers; give those of two poses");
  write("ways.csv", "0,0,0,0,0,0,1,0,0,0,0,0,0,1\n");
  expect("sweep scene:box scene:box --motions ways.csv", 3, "ways.csv:1: the axis has no direction");
  write("empty.csv", "# nothing\n");
  expect("collide scene:box scene:box --poses nowhere.csv", 3, "nowhere.csv: no such file");
  expect("collide scene:box scene:box --poses .", 3, ".: it is a folder");
}

// No question, no answer, as in C++ and Python; but not without a word.
TEST_F(BatchQuery, AFileWithoutPosesHasNoAnswers) {
  write("empty.csv", "# nothing\n");
  Ran ran = done(words("collide scene:box scene:box --poses empty.csv"));
  EXPECT_EQ(ran.out, "pose,result\n");
  EXPECT_TRUE(ran.says("standoff: warning: empty.csv: there is no pose in it")) << ran.err;
  ran = done(words("distance scene:box scene:box --poses empty.csv -o out.csv"));
  EXPECT_EQ(lines(read_bytes(folder / "out.csv")).size(), 1u);
  ran = done(words("sweep scene:box scene:box --motions empty.csv --json"));
  EXPECT_EQ(ran.json()["queries"], 0);
  EXPECT_TRUE(ran.says("standoff: warning: empty.csv: there is no motion in it")) << ran.err;
  EXPECT_TRUE(done(words("collide scene:box scene:box --poses -")).says("standard input: there is no pose in it"));
}

// A message shows what it needs of a line, and all of itself.
TEST_F(BatchQuery, OddLinesAreQuotedInPart) {
  write("zero.csv", std::string("0\0x,0,0\n", 9));
  expect("collide scene:box scene:box --poses zero.csv", 3,
         "zero.csv:1: '0?x' is not a number; separate numbers by commas");
  write("long.csv", std::string(1'000'000, 'x'));
  expect("collide scene:box scene:box --poses long.csv", 3,
         "long.csv:1: '" + std::string(40, 'x') + "...' is not a number");
  write("signs.csv", "+-1,0,0\n");
  expect("collide scene:box scene:box --poses signs.csv", 3, "signs.csv:1: '+-1' is not a number");
  write("turns.csv", "5,0,0,0,1,0,1e308\n");
  EXPECT_EQ(done(words("collide scene:box scene:box --poses turns.csv -q")).out, "pose,result\n0,free\n");
}

TEST_F(BatchQuery, ErrorsOfTheCommandLine) {
  write("poses.csv", "1,2,3\n");
  write("ways.csv", "1,2,3,4,5,6\n");
  const std::string collide = "collide scene:box scene:box ", sweep = "sweep scene:box scene:box ";
  for (const std::string option : {"-o out.csv", "-j 2", "--device cpu"}) {
    const std::string name = option[1] == 'o' ? "--output" : option[1] == 'j' ? "--threads" : "--device";
    expect(collide + option, 2, name + " needs --poses");
    expect(sweep + "--to 1,0,0 " + option, 2, name + " needs --motions");
  }
  expect(collide + "--poses poses.csv -f", 2, "--force needs --output");
  expect(collide + "--poses poses.csv --pose 1,2,3", 2, "--pose and --poses cannot go together");
  expect(collide + "--poses poses.csv --contacts 3", 2, "--contacts and --poses cannot go together");
  expect("distance scene:box scene:box --poses poses.csv --pose 1,2,3", 2, "--pose and --poses cannot go together");
  expect("distance scene:box scene:box --poses poses.csv --tolerance 1 --device emulated", 2,
         "distance: with a tolerance or most steps: this runs on the CPU only");
  expect(sweep + "--motions ways.csv --to 1,2,3", 2, "--to and --motions cannot go together");
  expect(sweep + "--motions ways.csv --from 1,2,3", 2, "--from and --motions cannot go together");
  expect(sweep, 2, "sweep: no --to given, where B ends; or give --screw, --path or --motions");
  expect(collide + "--poses poses.csv --device tpu", 2, "--device 'tpu': give auto, cpu, cuda or emulated");
  expect(collide + "--poses poses.csv --device cuda:99", 6, "cuda: ");
  expect(sweep + "--motions ways.csv --device cuda:99", 6, "cuda: ");
  expect(collide + "--poses poses.csv --certified --device emulated", 2,
         "--certified: comes from the CPU alone; leave --device out");
  expect(collide + "--poses poses.csv -o out.txt", 2, "out.txt: cannot write .txt here; use .csv");
  expect(collide + "--poses poses.csv -o no/out.csv", 4, "no/out.csv: the folder no does not exist");
  expect(collide + "--poses poses.csv -o poses.csv -f", 2, "poses.csv: it is an input, and would be lost");
  expect(collide + "--poses poses.csv -o ways.csv", 2, "ways.csv: it exists; give -f to overwrite it");
  EXPECT_EQ(run({"collide", "scene:box", "scene:box", "--poses", ""}).err,
            "standoff: error: --poses '': give the name of a file, or - for standard input\n");
  EXPECT_EQ(folder.names(), (std::set<std::string>{"poses.csv", "ways.csv"}));
  // What cannot be written to the end leaves nothing.
  std::string many;
  for (int n = 0; n < 20000; ++n) many += "9,9,9\n";
  write("poses.csv", many);
  auto how = setup();
  how.file_size = 50'000;
  EXPECT_EQ(run(words(collide + "--poses poses.csv -o out.csv"), how).code, 4);
  EXPECT_EQ(folder.names(), (std::set<std::string>{"poses.csv", "ways.csv"}));
}

TEST_F(BatchQuery, AnInterruptLeavesNoTable) {
  std::string poses;
  for (int n = 0; n < 300'000; ++n) poses += "0.9,0,0\n";
  write("poses.csv", poses);
  Process process(words("collide scene:labyrinth scene:fly --poses poses.csv -o out.csv --device emulated"), setup());
  ::usleep(500'000);
  process.send(SIGINT);
  const Ran ran = process.wait();
  EXPECT_EQ(ran.code, 130) << ran.err;
  EXPECT_EQ(folder.names(), std::set<std::string>{"poses.csv"});
}

}  // namespace
}  // namespace standoff::testing
