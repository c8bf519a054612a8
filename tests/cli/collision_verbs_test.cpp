// SPDX-License-Identifier: Apache-2.0
// build, collide, distance, sweep and fly.
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

#include "tests/cli/program.h"

namespace standoff::testing {
namespace {

class CollisionVerbs : public ProgramTest {};

// Two boxes of 2 x 1.5 x 1 around the origin.
TEST_F(CollisionVerbs, Collide) {
  EXPECT_EQ(done(words("collide scene:box scene:box --pose 2.5,0,0")).out, "free\n");
  EXPECT_TRUE(done(words("collide scene:box scene:box --pose 1.5,0.25,0.25")).out.starts_with("hit: triangle "));
  EXPECT_EQ(done(words("collide scene:box scene:box --pose 2.5,0,0 --margin 0.5 --json")).json()["hit"], true);
  EXPECT_EQ(done(words("collide scene:box scene:box --pose 2.5,0,0 --certified --json")).json()["hit"], false);
  const Json all = done(words("collide scene:box scene:box --pose 1.5,0.25,0.25 --contacts 3 --json")).json();
  EXPECT_EQ(all["contacts"].size(), 3u);
  EXPECT_EQ(all["overflow"], true);
  // Turned by 90 degrees about y its x is 1 long; as a matrix and as an axis with an angle.
  EXPECT_EQ(done(words("collide scene:box scene:box --pose 1.6,0,0,0,1,0,90")).out, "free\n");
  EXPECT_EQ(done(words("collide scene:box scene:box --pose 0,0,1,1.6,0,1,0,0,-1,0,0,0")).out, "free\n");
  EXPECT_NE(done(words("collide scene:box scene:box --pose 1.6,0,0")).out, "free\n");
}

TEST_F(CollisionVerbs, CollideKnowsInside) {
  done(words("generate terrain --triangles 200 -o sheet.ply"));
  write_bytes(folder / "small.obj", "v 0 0 0\nv 0.2 0 0\nv 0 0.2 0\nf 1 2 3\n");
  write_bytes(folder / "two.obj", "v 0 0 0\nv 0.2 0 0\nv 0 0.2 0\nv 9 0 0\nv 9 1 0\nv 9 0 1\nf 1 2 3\nf 4 5 6\n");
  EXPECT_EQ(done(words("collide scene:box small.obj")).out, "free\n");
  const Ran inside = done(words("collide scene:box small.obj --containment"));
  EXPECT_EQ(inside.out, "hit: B is inside A\n");
  EXPECT_EQ(inside.err, "B is not closed and consistently oriented, so nothing counts as inside it\n");
  EXPECT_EQ(done(words("collide small.obj scene:box --containment -q")).out, "hit: A is inside B\n");
  EXPECT_EQ(done(words("collide scene:box two.obj --containment")).out,
            "hit: parts of a body are inside the other one\n");
  EXPECT_EQ(done(words("collide scene:box small.obj --pose 5,0,0 --containment")).out, "free\n");
  EXPECT_TRUE(
      done(words("collide scene:box small.obj --pose 0.9,0,0 --containment")).out.starts_with("hit: triangle "));
  const Json json = done(words("collide scene:box small.obj --containment --json --contacts 2")).json();
  EXPECT_EQ(json["hit"], true);
  EXPECT_EQ(json["containment"], "b_in_a");
  EXPECT_TRUE(json["triangle_a"].is_null());
  EXPECT_TRUE(json["contacts"].empty());
  EXPECT_FALSE(done(words("collide scene:box small.obj --json")).json().contains("containment"));
  refused(words("collide sheet.ply small.obj --containment"), 3, "neither body is closed and consistently oriented");
  EXPECT_EQ(run(words("collide scene:box small.obj --containment --certified")).code, 2);
}

TEST_F(CollisionVerbs, DistanceAndSweep) {
  const Json near = done(words("distance scene:box scene:box --pose 5,0,0 --json")).json();
  EXPECT_DOUBLE_EQ(near["upper"].get<double>(), 3);
  EXPECT_DOUBLE_EQ(near["lower"].get<double>(), 3);
  EXPECT_EQ(done(words("distance scene:box scene:box --pose 5,0,0 --limit 2")).out, "more than 2, the limit\n");
  // What is as far as the limit is not beyond it.
  EXPECT_TRUE(done(words("distance scene:box scene:box --pose 5,0,0 --limit 3")).out.starts_with("3 from "));
  const Json beyond = done(words("distance scene:box scene:box --pose 5,0,0 --limit 2 --json")).json();
  EXPECT_EQ(beyond["lower"], 2);
  EXPECT_TRUE(beyond["upper"].is_null());
  const std::string gives_up = "distance scene:sphere:2000 scene:sphere:2000 --pose 5,4,3 --max-steps 1";
  EXPECT_TRUE(done(words(gives_up)).out.ends_with("; --max-steps ended the search there\n"));
  const Json bounds = done(words(gives_up + " --json")).json();
  EXPECT_EQ(bounds["finished"], false);
  EXPECT_LT(bounds["lower"].get<double>(), bounds["upper"].get<double>());
  EXPECT_EQ(near["finished"], true);
  const Json swept = done(words("sweep scene:box scene:box --from 5,0,0 --to -5,0,0 --json")).json();
  EXPECT_EQ(swept["hit"], true);
  EXPECT_NEAR(swept["time"].get<double>(), 0.3, 1e-5);
  EXPECT_EQ(done(words("sweep scene:box scene:box --from 5,9,0 --to -5,9,0")).out, "free during the whole motion\n");
  const std::string ends_early = "sweep scene:box scene:box --from 5,0,0 --to -5,0,0,1,0,0,30 --max-steps 1";
  EXPECT_TRUE(done(words(ends_early)).out.ends_with("of 1; --max-steps ended the sweep there\n"));
  const Json unfinished = done(words(ends_early + " --json")).json();
  EXPECT_TRUE(unfinished["hit"].is_null());
  EXPECT_LT(unfinished["time"].get<double>(), 0.3);
}

// A path has the answer of its motion that hits, given by itself.
TEST_F(CollisionVerbs, SweepsAlongScrewsAndPaths) {
  const std::string boxes = "sweep scene:box scene:box ";
  // Three turns about the point 9,0,0 pass nothing; rising by 30 on the way down from -20 they meet A.
  EXPECT_EQ(done(words(boxes + "--from 9,0,5 --screw 9,0,0,0,0,1,1080")).out, "free during the whole motion\n");
  const Json hit = done(words(boxes + "--from 0,0,-20 --screw 0,0,0,0,0,2,1080,30 --json")).json();
  EXPECT_EQ(hit["hit"], true);
  EXPECT_NEAR(hit["time"].get<double>(), 19.0 / 30, 1e-5);
  EXPECT_FALSE(hit.contains("motion"));
  write_bytes(folder / "way.csv", "9,0,5\n9,0,0\n-9,0,0\n");
  const Json on_path = done(words(boxes + "--path way.csv --json")).json(),
             second = done(words(boxes + "--from 9,0,0 --to -9,0,0 --json")).json();
  EXPECT_EQ(on_path["motion"], 1);
  EXPECT_EQ(on_path["time"], second["time"]);
  EXPECT_NE(done(words(boxes + "--path way.csv")).out.find(" of 1 in motion 1, at "), std::string::npos);
  const auto expect = [&](const std::string& rest, int code, const std::string& part) {
    refused(words(boxes + rest), code, part);
  };
  expect("--screw 1,2,3", 2, "--screw '1,2,3': give seven numbers or eight");
  expect("--screw 1,2,3,0,0,0,90", 2, "the axis has no direction");
  expect("--screw 0,0,0,0,0,1,1e12", 2, "radians");
  expect("--screw 0,0,0,0,0,1,90 --to 1,0,0", 2, "cannot go together");
  expect("--screw 0,0,0,0,0,1,90 --center 1,0,0", 2, "cannot go together");
  expect("--path way.csv --to 1,0,0", 2, "cannot go together");
  write_bytes(folder / "one.csv", "9,0,5\n");
  expect("--path one.csv", 3, "one.csv: 1 poses; give the two or more");
}

TEST_F(CollisionVerbs, ZeroIsAsGoodAsTheDefault) {
  EXPECT_EQ(done(words("collide scene:box scene:box --pose 2.5,0,0 --margin 0")).out, "free\n");
  EXPECT_TRUE(done(words("distance scene:box scene:box --pose 5,0,0 --tolerance 0")).out.starts_with("3 from"));
  EXPECT_EQ(done(words("fly --labyrinth scene:labyrinth:20000 --fly scene:box --steps 3 --no-check --json"))
                .json()["wall_crossings"],
            Json());
}

TEST_F(CollisionVerbs, BodiesAreBuiltOnceForEveryQuestion) {
  const Json built = done(words("build scene:box --json")).json();
  EXPECT_EQ(built["mesh"]["triangles"], 12);
  EXPECT_EQ(built["output"]["file"], "box.body");
  EXPECT_EQ(built["output"]["bytes"], read_bytes(folder / "box.body").size());
  const Json told = done(words("info box.body --json")).json();
  EXPECT_EQ(told["kind"], "body");
  EXPECT_EQ(built["has_inside"], true);
  for (const char* what : {"mesh", "has_inside", "grid", "thickness", "memory_bytes"})
    EXPECT_EQ(told[what], built[what]) << what;
  EXPECT_NE(done(words("info box.body")).out.find("triangles     12\n"), std::string::npos);
  // The same answers from the file as from the mesh, wherever a body may stand.
  for (const std::string line :
       {"collide A B --pose 1.5,0.25,0.25 --contacts 9", "distance A B --pose 5,1,0,1,2,3,40",
        "sweep A B --from 5,0,0 --to -5,0,0,0,1,0,90", "fly --labyrinth A --fly B --steps 20 --speed 1"}) {
    const auto with = [&](const std::string& a, const std::string& b) {
      std::string text = line;
      text.replace(text.find('A'), 1, a);
      text.replace(text.find('B'), 1, b);
      Json json = done(words(text + " --json")).json();
      for (const char* time : {"seconds", "steps_per_second"}) json.erase(time);
      return json;
    };
    if (line.starts_with("fly")) {
      done(words("build scene:labyrinth:20000"));
      EXPECT_EQ(with("labyrinth.body", "box.body"), with("scene:labyrinth:20000", "scene:box"));
    } else {
      EXPECT_EQ(with("box.body", "box.body"), with("scene:box", "scene:box")) << line;
    }
  }
  // Options of the mesh and of the field; the extension in any case.
  done(words("build scene:box --scale 10 --spacing 2 -o LARGE.BODY"));
  const Json large = done(words("info LARGE.BODY --json")).json();
  EXPECT_EQ(large["mesh"]["bounds"][1][0], 10);
  EXPECT_EQ(large["grid"]["spacing"][0], 2);
  EXPECT_EQ(done(words("distance LARGE.BODY box.body --pose 12,0,0")).out.substr(0, 1), "1");
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

// The names of devices are those of compute; the flight is the same on each.
TEST_F(CollisionVerbs, FlyTakesADeviceAndRecomputes) {
  const std::string line =
      "fly --fly scene:box --labyrinth scene:labyrinth:20000 --steps 60 --speed 1 --mode thesis --json ";
  EXPECT_EQ(done(words(line)).json()["device"], "cpu");
  for (const std::string how : {"", "--recompute "}) {
    const Json one = done(words(line + how + "--device cpu --path one.csv -f")).json(),
               two = done(words(line + how + "--device emulated --path two.csv -f")).json();
    EXPECT_EQ(one["device"], "cpu");
    EXPECT_EQ(one["device_name"], "");
    EXPECT_EQ(two["device"], "emulated");
    EXPECT_EQ(two["device_name"], "emulated on the CPU");
    EXPECT_EQ(one["recompute"], !how.empty());
    EXPECT_EQ(one["fly_grid"], two["fly_grid"]);
    EXPECT_GT(one["collisions"], 0);
    EXPECT_EQ(read_bytes(folder / "one.csv"), read_bytes(folder / "two.csv"));
  }
  const std::string said = done(words("fly --fly scene:box --labyrinth scene:labyrinth:20000 --steps 3 --mode thesis "
                                      "--recompute --device emulated"))
                               .out;
  EXPECT_NE(
      said.find(" a second on emulated (emulated on the CPU); grid 147 x 14 x 142, the fly's at each step anew, "),
      std::string::npos)
      << said;
  // Films as well.
  const Json film = done(words(line + "--recompute -o film.html")).json();
  EXPECT_EQ(film["recompute"], true);
  EXPECT_EQ(film["frames"], 61);
}

TEST_F(CollisionVerbs, ErrorsSayWhatToDo) {
  const auto expect = [this](const std::string& line, int code, const std::string& part) {
    refused(words(line), code, part);
  };
  expect("collide scene:box scene:box --pose 1,2", 2, "--pose '1,2': give x,y,z");
  expect("collide scene:box scene:box --pose 0,0,0,0,0,0,90", 2, "the axis has no direction");
  expect("collide scene:box scene:box --pose 2,0,0,0,0,2,0,0,0,0,2,0", 2, "the matrix is no rotation");
  expect("collide scene:box nowhere.stl", 3, "nowhere.stl");
  expect("collide scene:box nowhere.body", 3, "nowhere.body");
  done(words("build scene:box"));
  expect("build scene:box", 2, "box.body: it exists; give -f to overwrite it");
  done(words("build scene:box -f -q"));
  expect("build scene:box -o box.stl", 2, "box.stl: cannot write .stl here; use .body");
  expect("build scene:box -o there/box.body", 4, "the folder there does not exist");
  expect("build scene:box -o fine.body --spacing 1e-6", 5, "take a larger spacing");
  expect("build scene:box -o fine.body --spacing 0", 2, "--spacing '0': must be above zero");
  EXPECT_FALSE(std::filesystem::exists(folder / "fine.body"));
  // A body is no mesh any more.
  expect("build box.body -o two.body", 3, "box.body: this is a body");
  expect("compute box.body", 3, "box.body: this is a body");
  expect("convert box.body -o box.stl", 3, "box.body: this is a body");
  expect("convert scene:box -o two.body", 2, "use standoff build");
  std::ofstream(folder / "text.body") << "solid nothing";
  expect("collide text.body scene:box", 3, "text.body: this is no body that standoff saved");
  std::filesystem::resize_file(folder / "box.body", 1000);
  expect("info box.body", 3, "box.body:byte ");
  expect("sweep scene:box scene:box", 2, "--to");
  expect("sweep scene:box scene:box --to 1,0,0 --tolerance 0", 2, "--tolerance '0': must be above zero");
  expect("fly --steps 10 --path a.txt", 2, "cannot write .txt here; use .csv or .ply");
  // The labyrinth was once lost for its path.
  done(words("generate box -o room.ply"));
  expect("fly --steps 5 --labyrinth room.ply --path room.ply -f", 2, "room.ply: it is an input");
  expect("fly --steps 5 --scatter 181", 2, "--scatter '181': give degrees from 0 to 180");
  expect("sweep scene:box scene:box --to 1,0,0 --center 1e16,0,0", 2, "--center '1e16,0,0': a number past 1e+15");
  expect("fly --mode fast", 2, "--mode 'fast': give sweep or thesis");
  // These messages once said nothing of the option, or thousands of digits of the number.
  expect("collide scene:box scene:box --margin 1e31", 2, "--margin '1e31': must be at most 1e+30");
  expect("sweep scene:box scene:box --to 1,0,0 --tolerance 1e31", 2, "--tolerance '1e31': must be at most 1e+30");
  expect("collide scene:box scene:box --pose 2,0,0,0,0,1e200,0,0,0,0,2,0", 2, "--pose '2,0,0,0,0,1e200");
  expect("collide scene:box scene:box --pose 1e9,0,0,0,0,1e9,0,0,0,0,1e9,0", 2, "right angles by 1e+18;");
  expect("collide scene:fly:0 scene:box", 2, "scene:fly:TRIANGLES '0': give a whole number from 1 to ");
  write_bytes(folder / "huge.obj", "v 0 0 0\nv 1e21 0 0\nv 0 -1 0\nf 1 2 3\n");
  expect("collide huge.obj scene:box", 3, "huge.obj: body: the mesh is 1e+21 across; scale it");
  expect("build scene:box -o fine.body --spacing 1e-6", 5, "a spacing of 1e-06 makes");
  // A body by another name.
  done(words("build scene:box -o room.body"));
  std::filesystem::rename(folder / "room.body", folder / "room.stl");
  expect("info room.stl", 3, "room.stl:byte 0: the content is a body that standoff build made, and no mesh; rename it");
}

// What only the other mode knows was once left unsaid, and ignored.
TEST_F(CollisionVerbs, FlyTakesNoOptionOfTheOtherMode) {
  const auto expect = [this](const std::string& line, const std::string& part) { refused(words(line), 2, part); };
  for (const std::string option : {"--minimum", "--thickness", "--threshold"})
    expect("fly " + option + " 3", option + ": only --mode thesis knows it; leave it out");
  expect("fly --recompute", "--recompute: only --mode thesis knows it; leave it out");
  expect("fly --device cuda", "--device: only --mode thesis knows it; leave it out");
  expect("fly --mode thesis --device gpu", "--device 'gpu': give ");
  expect("fly --mode thesis --tolerance 0.1", "--tolerance: only --mode sweep knows it; leave it out");
  expect("fly --mode thesis --on-contact reflect", "--on-contact 'reflect': --mode thesis knows no normals");
  expect("fly -f", "--force needs --path");
}

// The text once counted the steps of all flies, the JSON those of one.
TEST_F(CollisionVerbs, FlySaysTheSameStepsInTextAndJson) {
  const std::string line = "fly --fly scene:box --labyrinth scene:labyrinth:20000 --steps 30 --speed 1 --flies ";
  EXPECT_EQ(done(words(line + "3 --json")).json()["steps"], 30);
  EXPECT_TRUE(done(words(line + "3")).out.starts_with("30 steps of each of 3 flies, "));
  EXPECT_TRUE(done(words(line + "1")).out.starts_with("30 steps, "));
}

}  // namespace
}  // namespace standoff::testing
