// SPDX-License-Identifier: Apache-2.0
// standoff surface, as a user runs it.
#include <gtest/gtest.h>

#include "standoff/io.h"
#include "tests/cli/program.h"
#include "tests/sign/shapes.h"
#include "tests/surface/manifold.h"

namespace standoff::testing {
namespace {

class SurfaceVerb : public ProgramTest {
 protected:
  Mesh read(const std::string& name) const { return read_mesh(folder / name).mesh; }
};

TEST_F(SurfaceVerb, MakesAMeshASolid) {
  const Ran ran = done(words("surface scene:box -r 40 -o box.ply"));
  EXPECT_TRUE(ran.says("box.ply: ")) << ran.err;
  EXPECT_EQ(manifold_fault(read("box.ply")), "");
  EXPECT_NEAR(volume(read("box.ply")), 3, 0.05);
  const Json json = done(words("surface scene:box -r 40 --method dual --check --json -o sharp.ply")).json();
  EXPECT_EQ(json["method"], "dual");
  EXPECT_EQ(json["surface"]["components"], 1);
  EXPECT_EQ(json["surface"]["self_intersections"], 0);
  EXPECT_EQ(json["surface"]["triangles"], read("sharp.ply").triangles.size());
  EXPECT_NEAR(volume(read("sharp.ply")), 3, 1e-3);
}

// Vertices stay distinct in each format that can be written.
TEST_F(SurfaceVerb, EveryFormatKeepsASurfaceWhole) {
  for (const FileFormat& format : mesh_formats()) {
    if (!format.writable) continue;
    const std::string name = "fly." + format.extension;
    done({"surface", "scene:fly:2000", "-r", "50", "-o", name});
    EXPECT_EQ(manifold_fault(read(name)), "") << name;
  }
}

TEST_F(SurfaceVerb, OffsetsAndHollows) {
  const auto volume_of = [&](const std::string& options) {
    done(words("surface scene:box -r 50 -f -o a.stl " + options));
    EXPECT_EQ(manifold_fault(read("a.stl")), "") << options;
    return volume(read("a.stl"));
  };
  EXPECT_GT(volume_of("--at 0.1"), 3.6);
  EXPECT_LT(volume_of("--at -0.1"), 2.4);
  EXPECT_NEAR(volume_of("--wall 0.2"), 3 - 1.6 * 1.1 * 0.6, 0.05);
  EXPECT_NEAR(volume_of("--wall 3s --method dual"), volume_of("--wall 3s"), 0.05);
  EXPECT_GT(volume_of("--sign shell:4s"), 0.1);
}

TEST_F(SurfaceVerb, OfAField) {
  done(words("compute scene:box -r 40 -t 6s --sign winding -o box.vti"));
  done(words("surface box.vti -o box.ply"));
  EXPECT_EQ(manifold_fault(read("box.ply")), "");
  const Json json = done(words("surface box.vti --at 3s --json -f -o box.ply")).json();
  EXPECT_EQ(json["kind"], "field");
  EXPECT_GT(json["at"], 0.1);
  refused(words("surface box.vti --at 10s -f -o box.ply"), 2, "compute the field with a larger thickness");
  // The mesh's options are none of a field's, also where they say what goes without saying.
  for (const std::string option : {"--sign winding", "--sign auto", "--rule positive", "--outer", "--strict"})
    EXPECT_EQ(run(words("surface box.vti -f -o box.ply " + option)).code, 2) << option;
  EXPECT_EQ(run(words("surface box.vti -r 30 -f -o box.ply")).code, 2);
}

TEST_F(SurfaceVerb, MemoryLimit) {
  done(words("compute scene:box -r 40 -t 6s --sign winding -o box.vti"));
  for (const std::string input : {"box.vti", "scene:box -r 100", "scene:box -r 100 --method dual --at 1s"}) {
    const Ran ran = run(words("surface " + input + " --memory-limit 100k -o a.ply"));
    EXPECT_EQ(ran.code, 5) << input << ran.err;
    EXPECT_EQ(run(words("surface " + input + " --memory-limit 1G -f -o b.ply")).code, 0) << input;
  }
}

TEST_F(SurfaceVerb, SaysWhyThereIsNoSurface) {
  done(words("compute scene:box -r 30 --sign none -o unsigned.vti"));
  const Ran none = refused(words("surface unsigned.vti -o a.ply"), 3, "there is no surface at 0");
  refused(words("surface scene:box --sign none -o a.ply"), 3, "there is no inside");
  EXPECT_FALSE(folder.names().contains("a.ply"));
}

// The grid holds a part of the solid alone.
TEST_F(SurfaceVerb, SaysWhenTheGridCutsTheSolidOff) {
  const Ran ran = done(words("surface scene:box -r 30 --bounds 0,0,0,1,1,1 -o a.ply"));
  EXPECT_TRUE(ran.says("warning: the solid reaches the border of the grid")) << ran.err;
  EXPECT_EQ(manifold_fault(read("a.ply")), "");
}

TEST_F(SurfaceVerb, SaysWhatIsLost) {
  const Mesh body = box({0, 0, 0}, {1, 1, 1}), plate = box({2, 0, 0.001}, {4, 2, 0.006});
  write_mesh(folder / "both.obj", joined(body, plate));
  const Ran ran = done(words("surface both.obj -r 40 --json -o a.ply"));
  EXPECT_TRUE(ran.says("warning: 57 % of the mesh's area, 1 of its 2 parts as a whole, is farther than a spacing"))
      << ran.err;
  EXPECT_EQ(ran.json()["lost"]["lost_parts"], 1);
  EXPECT_EQ(ran.json()["lost"]["parts"], 2);
  EXPECT_NEAR(ran.json()["lost"]["share"], 0.57, 0.01);
  EXPECT_FALSE(done(words("surface both.obj -r 40 --sign shell:2s -f -o a.ply")).says("farther than a spacing"));
}

}  // namespace
}  // namespace standoff::testing
