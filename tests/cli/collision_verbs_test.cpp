// collide, distance, sweep and fly.
#include <gtest/gtest.h>

#include "tests/cli/program.h"

namespace difi {
namespace {

using testing::Json;
using testing::Ran;
using testing::words;

class CollisionVerbs : public testing::ProgramTest {};

// Two boxes of 2 x 1.5 x 1 around the origin.
TEST_F(CollisionVerbs, Collide) {
  EXPECT_EQ(done(words("collide scene:box scene:box --pose 2.5,0,0")).out, "free\n");
  EXPECT_TRUE(done(words("collide scene:box scene:box --pose 1.5,0.25,0.25")).out.starts_with("hit: triangle "));
  EXPECT_EQ(done(words("collide scene:box scene:box --pose 2.5,0,0 --margin 0.5 --json")).json()["result"], "hit");
  EXPECT_EQ(done(words("collide scene:box scene:box --pose 2.5,0,0 --certified --json")).json()["result"], "free");
  const Json all = done(words("collide scene:box scene:box --pose 1.5,0.25,0.25 --contacts 3 --json")).json();
  EXPECT_EQ(all["contacts"].size(), 3u);
  EXPECT_EQ(all["overflow"], true);
  // Turned by 90 degrees about y its x is 1 long; as a matrix and as an axis with an angle.
  EXPECT_EQ(done(words("collide scene:box scene:box --pose 1.6,0,0,0,1,0,90")).out, "free\n");
  EXPECT_EQ(done(words("collide scene:box scene:box --pose 0,0,1,1.6,0,1,0,0,-1,0,0,0")).out, "free\n");
  EXPECT_NE(done(words("collide scene:box scene:box --pose 1.6,0,0")).out, "free\n");
}

TEST_F(CollisionVerbs, DistanceAndSweep) {
  const Json near = done(words("distance scene:box scene:box --pose 5,0,0 --json")).json();
  EXPECT_DOUBLE_EQ(near["upper"].get<double>(), 3);
  EXPECT_DOUBLE_EQ(near["lower"].get<double>(), 3);
  EXPECT_EQ(done(words("distance scene:box scene:box --pose 5,0,0 --limit 2")).out, "farther than 2\n");
  const Json swept = done(words("sweep scene:box scene:box --from 5,0,0 --to -5,0,0 --json")).json();
  EXPECT_EQ(swept["hit"], true);
  EXPECT_NEAR(swept["time"].get<double>(), 0.3, 1e-5);
  EXPECT_EQ(done(words("sweep scene:box scene:box --from 5,9,0 --to -5,9,0")).out, "free all the way\n");
}

TEST_F(CollisionVerbs, Fly) {
  const Json sweep =
      done(words("fly --fly scene:box --labyrinth scene:labyrinth:20000 --steps 200 --speed 1 --json")).json();
  EXPECT_EQ(sweep["wall_crossings"], 0);
  EXPECT_EQ(sweep["mode"], "sweep");
  EXPECT_EQ(sweep["grid"]["size"].size(), 3u);
  EXPECT_GT(sweep["steps_per_second"].get<double>(), 0);
  const std::string thesis =
      "fly --fly scene:box --labyrinth scene:labyrinth:20000 --steps 200 --mode thesis --minimum 3 --json --path ";
  const Json one = done(words(thesis + "a.csv")).json(), two = done(words(thesis + "b.csv")).json();
  EXPECT_EQ(one["collisions"], two["collisions"]);
  EXPECT_EQ(read_bytes(folder / "a.csv"), read_bytes(folder / "b.csv"));
}

TEST_F(CollisionVerbs, ErrorsSayWhatToDo) {
  const auto expect = [this](const std::string& line, int code, const std::string& part) {
    const Ran ran = run(words(line));
    EXPECT_EQ(ran.code, code) << line;
    EXPECT_NE(ran.err.find(part), std::string::npos) << line << ": " << ran.err;
  };
  expect("collide scene:box scene:box --pose 1,2", 2, "--pose '1,2': give x,y,z");
  expect("collide scene:box scene:box --pose 0,0,0,0,0,0,90", 2, "the axis has no direction");
  expect("collide scene:box scene:box --pose 2,0,0,0,0,2,0,0,0,0,2,0", 2, "the matrix is no rotation");
  expect("collide scene:box nowhere.stl", 3, "nowhere.stl");
  expect("collide scene:box nowhere.body", 3, "nowhere.body");
  expect("sweep scene:box scene:box", 2, "--to");
  expect("sweep scene:box scene:box --to 1,0,0 --tolerance 0", 2, "--tolerance '0': must be above zero");
  expect("fly --steps 10 --path a.txt", 2, "cannot write .txt here; use .csv or .ply");
  expect("fly --mode fast", 2, "--mode 'fast': give sweep or thesis");
}

}  // namespace
}  // namespace difi
