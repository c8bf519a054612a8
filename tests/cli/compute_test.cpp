// SPDX-License-Identifier: Apache-2.0
// standoff compute: grids, thickness, outputs, and what it says.
#include <gtest/gtest.h>

#include <cmath>

#include "standoff/io.h"
#include "tests/cli/program.h"

namespace standoff::testing {
namespace {

class Compute : public ProgramTest {
 protected:
  // The box scene spans (-1, -0.75, -0.5) to (1, 0.75, 0.5).
  Json planned(const std::string& options) const {
    return done(words("compute scene:box --dry-run --json " + options)).json();
  }
  static Size3 size(const Json& json) {
    const auto& n = json["grid"]["size"];
    return {n[0], n[1], n[2]};
  }
  static Vec3 vec(const Json& json) { return {json[0], json[1], json[2]}; }
};

TEST_F(Compute, WritesBesideNothing) {
  const Ran ran = done(words("compute scene:box -r 20"));
  EXPECT_EQ(folder.names(), std::set<std::string>{"box.vti"});
  EXPECT_EQ(ran.out, "");
  EXPECT_TRUE(ran.says("12 triangles, 8 vertices")) << ran.err;
  EXPECT_TRUE(ran.says("box.vti: ")) << ran.err;
  EXPECT_FALSE(ran.says("\r")) << "a progress bar without a terminal";
  const DistanceField field = read_field(folder / "box.vti");
  EXPECT_EQ(field.grid().size.x, 20);
  EXPECT_NEAR(field.interpolate({0, 0, 0}), -0.5, 0.1);
  EXPECT_EQ(field.provenance().method, "tiles");
  EXPECT_NE(field.provenance().mesh_hash, 0u);
}

// Compute and write stand apart.
TEST_F(Compute, SaysWhatTookHowLong) {
  const Ran ran = done(words("compute scene:box -r 20"));
  EXPECT_TRUE(ran.says(" s of it compute and ")) << ran.err;
  EXPECT_TRUE(ran.says(" s write; tiles on cpu")) << ran.err;
}

// No disk has room for 2^50 samples. What takes their place before an hour of work is refused at once; of compressed
// files nobody knows what they take, so a full field gets a warning, which --dry-run gives too.
TEST_F(Compute, AFileThatTheDiskHasNoRoomForIsRefusedAtOnce) {
  const std::string huge = "compute scene:box --size 1024,1024,1073741824 ";
  auto how = setup();
  how.file_size = 1 << 20;  // so that a program that does not look fills no disk
  for (const std::string name : {"a.vti", "a.nrrd", "a.npz"}) {
    const Ran ran = run(words(huge + "-t 0.01 --uncompressed -o " + name), how);
    EXPECT_EQ(ran.code, 4) << ran.err;
    EXPECT_TRUE(ran.says("error: " + name + ": cannot write it: it takes 4294967296 MiB, and its disk has "))
        << ran.err;
  }
  EXPECT_TRUE(folder.names().empty());
  const Ran planned = done(words(huge + "-t 0.01 --dry-run"));
  EXPECT_NE(planned.out.find("would write box.vti, at most 4.0 PiB; its disk has "), planned.out.npos) << planned.out;
  EXPECT_GT(done(words(huge + "-t 0.01 --dry-run --json")).json()["output"]["free_bytes"], 0);
  EXPECT_EQ(done(words("compute scene:box -r 9 --dry-run")).out.find("its disk has"), planned.out.npos);

  Process full(words(huge + "--progress never"), how);
  EXPECT_TRUE(full.wait_for("standoff: warning: box.vti may take 4.0 PiB; its disk has "));
  full.send(SIGTERM);
  full.wait();
}

// A thickness of whole world units that is much of the mesh, which is 2.7 across, was meant to be samples.
TEST_F(Compute, WarnsOfAThicknessThatWasMeantInSamples) {
  const auto warns = [&](const std::string& thickness) {
    return done(words("compute scene:box -r 20 -q -f -o box.vti -t " + thickness)).says("standoff: warning");
  };
  EXPECT_TRUE(done(words("compute scene:box -r 20 -q -t 3"))
                  .says("--thickness 3 is 3 world units, and the mesh is 2.69258 across; for 3 samples give -t 3s, and "
                        "-t 3.0 if world units are meant"));
  EXPECT_TRUE(warns("1"));
  for (const char* thickness : {"3s", "inf", "3.0", "0.5", "100", "1e0"}) EXPECT_FALSE(warns(thickness)) << thickness;
  EXPECT_FALSE(warns("3 --scale 20")) << "3 of 54";
  EXPECT_TRUE(done(words("compute scene:box -r 20 -t 2 --dry-run")).says("for 2 samples give -t 2s"));
  EXPECT_TRUE(done(words("view scene:box -r 20 -q -t 3 -o box.html")).says("for 3 samples give -t 3s"));
  for (const char* mesh : {"meshes/a.stl", "meshes/b.stl"}) {
    std::filesystem::create_directory(folder / "meshes");
    done(words(std::string("generate box -q -o ") + mesh));
  }
  const std::string warned = done(words("batch meshes -o out -r 20 -q -t 3")).err;
  EXPECT_EQ(warned.find("for 3 samples give -t 3s"), warned.rfind("for 3 samples give -t 3s")) << "once: " << warned;
  EXPECT_NE(warned.find("stl: --thickness 3 is 3 world units"), warned.npos) << warned;
}

TEST_F(Compute, EveryFormatHoldsTheSameField) {
  for (const std::string name : {"a.vti --with triangle", "a.npz --with triangle", "a.nrrd"})
    done(words("compute scene:box -r 20 -t 0.3 -o " + name));
  const auto values = read_field(folder / "a.vti").to_dense();
  for (const std::string name : {"a.nrrd", "a.npz"}) {
    const DistanceField field = read_field(folder / name);
    EXPECT_EQ(field.to_dense(), values) << name;
    EXPECT_NEAR(field.thickness(), 0.3, 1e-9) << name;
  }
  EXPECT_TRUE(read_field(folder / "a.vti").has_nearest());
}

TEST_F(Compute, Json) {
  const Json json = done(words("compute scene:box -r 20 -t 3s --json")).json();
  EXPECT_EQ(json["mesh"]["triangles"], 12);
  EXPECT_EQ(json["mesh"]["skipped"], 0);
  EXPECT_EQ(json["grid"]["size"][0], 20);
  EXPECT_EQ(json["grid"]["origin"].size(), 3u);
  EXPECT_NEAR(json["thickness"].get<double>(), 3 * json["grid"]["spacing"][0].get<double>(), 1e-12);
  EXPECT_GT(json["samples"]["examined"], 0);
  EXPECT_GT(json["samples"]["band"], 0);
  EXPECT_LT(json["samples"]["band"], json["samples"]["total"]);
  for (const char* stage : {"load", "prepare", "compute", "write"}) EXPECT_GE(json["seconds"][stage], 0) << stage;
  EXPECT_GT(json["peak_memory_bytes"], 1 << 20);
  EXPECT_EQ(json["method"], "tiles");
  EXPECT_EQ(json["device"], "cpu");
  EXPECT_EQ(json["output"]["file"], "box.vti");
  EXPECT_EQ(json["output"]["bytes"], std::filesystem::file_size(folder / "box.vti"));
}

TEST_F(Compute, FullFieldHasNoThicknessInJson) { EXPECT_TRUE(planned("-r 9")["thickness"].is_null()); }

// TBB refused threads beyond the cores, with a warning of its own on stderr.
TEST_F(Compute, MoreThreadsThanCores) {
  const Ran ran = done(words("compute scene:box -r 20 -o a.vti -q -j 200"));
  EXPECT_EQ(ran.err, "");
}

TEST_F(Compute, DryRunWritesNothing) {
  const Ran text = done(words("compute scene:box --dry-run"));
  EXPECT_NE(text.out.find("grid 256 x "), std::string::npos) << text.out;
  EXPECT_NE(text.out.find("would write box.vti"), std::string::npos) << text.out;
  EXPECT_EQ(text.err, "");
  EXPECT_EQ(planned("")["dry_run"], true);
  EXPECT_TRUE(folder.names().empty());
  EXPECT_EQ(planned("")["output"]["bytes"], planned("")["samples"]["total"].get<std::int64_t>() * 4);
}

// A slab of the field fits where the field does not. What is said of it is said of all of it.
TEST_F(Compute, SlabsFitWhereTheWholeFieldDoesNot) {
  const std::string field = "compute scene:sphere --size 600,600,400 -t 60s --sign winding --json ";
  const std::string limited = field + "--memory-limit 300M ";
  refused(words(limited + "-o a.nvdb"), 5, "more than the limit of 300");
  EXPECT_EQ(run(words(limited + "-o a.vti --with nearest")).code, 5);
  EXPECT_EQ(run(words(limited + "-o a.nvdb --dry-run")).code, 5);
  EXPECT_EQ(run(words(limited + "-o a.vti --dry-run")).code, 0);
  EXPECT_TRUE(folder.names().empty());

  const Json slabs = done(words(limited + "-o a.npz")).json();
  EXPECT_LT(slabs["peak_memory_bytes"], 400 << 20);
  const Json all = done(words(field + "-o a.nvdb")).json();
  for (const char* key : {"samples", "tiles", "sign", "method", "device", "threads"}) EXPECT_EQ(slabs[key], all[key]);
  EXPECT_EQ(slabs["mesh"]["hash"], all["mesh"]["hash"]);
  std::set<std::string> keys, keys_of_all;
  for (const auto& [key, value] : slabs.items()) keys.insert(key);
  for (const auto& [key, value] : all.items()) keys_of_all.insert(key);
  EXPECT_EQ(keys, keys_of_all);
}

// Over the limit all is told as ever, and the exit code is that of the real run.
TEST_F(Compute, DryRunOverTheMemoryLimit) {
  const Ran text = run(words("compute scene:box --dry-run --memory-limit 1M"));
  EXPECT_EQ(text.code, 5);
  EXPECT_NE(text.out.find("needs at most 30.6 MiB beside the mesh, more than the limit of 1.0 MiB\n"),
            std::string::npos)
      << text.out;
  EXPECT_TRUE(text.says("standoff: error: compute: the field needs at most 30.6 MiB")) << text.err;
  const Ran as_json = run(words("compute scene:box --dry-run --memory-limit 1M --json"));
  EXPECT_EQ(as_json.code, 5);
  EXPECT_GT(as_json.json()["memory_needed_bytes"], as_json.json()["memory_limit_bytes"]);
}

TEST_F(Compute, DryRunLeavesWhatIsThere) {
  write_bytes(folder / "box.vti", "mine");
  const Ran text = done(words("compute scene:box --dry-run"));
  EXPECT_NE(text.out.find("would write box.vti, at most 24.8 MiB; it exists: give -f to overwrite it\n"),
            std::string::npos)
      << text.out;
  EXPECT_EQ(planned("")["output"]["in_the_way"], true);
  EXPECT_EQ(planned("-f")["output"]["in_the_way"], false);
  EXPECT_EQ(read_bytes(folder / "box.vti"), "mine");
}

// What is told as the file's size is the most that it then has, but for its header; uncompressed, just that.
TEST_F(Compute, DryRunTellsTheFileSize) {
  for (const std::string options :
       {"-o a.vti", "-o a.npz", "-o a.nrrd", "-o b.vti --with triangle", "-o a.vdb", "-o a.nvdb",
        "-o c.vti --uncompressed", "-o c.npz --uncompressed", "-o c.nrrd --uncompressed"}) {
    const auto told = planned("-r 40 " + options)["output"]["bytes"].get<std::int64_t>();
    const auto written = done(words("compute scene:box --json -r 40 " + options)).json()["output"]["bytes"];
    if (options.ends_with("--uncompressed")) {
      EXPECT_LE(told, written) << options;
    }
    EXPECT_GE(told + 4096, written) << options;
  }
}

// The name of the input is looked at before the output, and the output before any work.
TEST_F(Compute, TheInputIsCheckedFirst) {
  write_bytes(folder / "box.vti", "mine");
  EXPECT_TRUE(run(words("compute missing.stl -o box.vti")).says("missing.stl: no such file"));
  EXPECT_TRUE(run(words("compute scene:nowhere -o box.vti")).says("scene:nowhere: there is no such scene"));
  write_bytes(folder / "broken.stl", "solid");
  EXPECT_TRUE(run(words("compute broken.stl -o box.vti")).says("box.vti: it exists"));
  EXPECT_TRUE(run(words("build missing.stl -o no/such.body")).says("missing.stl: no such file"));
  EXPECT_TRUE(run(words("convert missing.stl -o box.vti")).says("use standoff compute")) << "the line makes no sense";
  EXPECT_TRUE(run(words("slice missing.vti -o no/such.png")).says("missing.vti: no such file"));
}

TEST_F(Compute, Resolution) {
  EXPECT_EQ(size(planned("")).x, 256);
  EXPECT_EQ(size(planned("-r 50")), (Size3{50, 39, 28}));
  EXPECT_EQ(size(planned("--resolution=50")), (Size3{50, 39, 28}));
  EXPECT_EQ(size(planned("-r 2")).x, 2);
}

TEST_F(Compute, Padding) {
  const Json bare = planned("-r 21 --padding 0");
  EXPECT_EQ(vec(bare["grid"]["origin"]), (Vec3{-1, -0.75, -0.5}));
  EXPECT_EQ(size(bare), (Size3{21, 16, 11}));
  const Json two = planned("-r 25 --padding 2");
  EXPECT_NEAR(two["grid"]["spacing"][0].get<double>(), 0.1, 1e-12);
  EXPECT_NEAR(two["grid"]["origin"][0].get<double>(), -1.2, 1e-12);
  EXPECT_EQ(planned("-r 25")["grid"], two["grid"]) << "two samples is the default of a full field";
  EXPECT_NEAR(planned("--spacing 0.1 --padding 3")["grid"]["origin"][0].get<double>(), -1.3, 1e-12);
}

TEST_F(Compute, BandLiesOnTheGrid) {
  // The thickness, up to a tenth of the longest side.
  EXPECT_NEAR(planned("-r 100 -t 0.15")["grid"]["origin"][0].get<double>(), -1.15, 1e-9);
  EXPECT_NEAR(planned("-r 100 -t 5")["grid"]["origin"][0].get<double>(), -1.2, 1e-9);
  EXPECT_NEAR(planned("--spacing 0.05 -t 3s")["grid"]["origin"][0].get<double>(), -1.15, 1e-9);
  const Json samples = planned("-r 100 -t 5s");
  EXPECT_NEAR(samples["grid"]["origin"][0].get<double>(), -1 - samples["thickness"].get<double>(), 1e-9);
  const Json sized = planned("--size 100,60,20 -t 0.15");
  EXPECT_LE(sized["grid"]["origin"][2].get<double>(), -0.65 + 1e-9);
  EXPECT_NEAR(sized["grid"]["origin"][0].get<double>(), -1.15, 1e-9);
}

TEST_F(Compute, SpacingSizeBounds) {
  const Json cubic = planned("--spacing 0.1 --padding 0");
  EXPECT_EQ(size(cubic), (Size3{21, 16, 11}));
  const Json flat = planned("--spacing 0.1,0.25,0.5 --padding 0 -t 2s");
  EXPECT_EQ(size(flat), (Size3{21, 7, 3}));
  EXPECT_EQ(flat["thickness"], 1.0) << "a sample is the largest spacing";
  const Json sized = planned("--size 11,7,1 --padding 0");
  EXPECT_EQ(size(sized), (Size3{11, 7, 1}));
  EXPECT_NEAR(sized["grid"]["spacing"][1].get<double>(), 0.25, 1e-12);
  const Json bounded = planned("--bounds -2,-3,-4,2,3,4 -r 9");
  EXPECT_EQ(size(bounded), (Size3{5, 7, 9}));
  EXPECT_EQ(vec(bounded["grid"]["origin"]), (Vec3{-2, -3, -4}));
}

// samples = (extent + 2 * thickness) / thickness * e, the factor growing with the speed.
TEST_F(Compute, MinimumGridOfTheThesis) {
  EXPECT_EQ(size(planned("--minimum 2 -t 0.5")), (Size3{12, 10, 8}));
  EXPECT_EQ(size(planned("--minimum 3 -t 0.5")), (Size3{18, 15, 12}));
  EXPECT_EQ(size(planned("--minimum 2 -t 0.5 --speed 0.25")), (Size3{18, 15, 12}));
}

TEST_F(Compute, ScaleAndUnit) {
  EXPECT_EQ(planned("--scale 3 -r 9")["mesh"]["bounds"][1][0], 3.0);
  EXPECT_EQ(planned("--unit mm -r 9")["mesh"]["bounds"][1][0], 0.001);
  EXPECT_EQ(planned("--unit in -r 9")["mesh"]["bounds"][1][0], 0.0254);
  done(words("generate box -o box.stl"));
  const Json json = done(words("compute box.stl --unit km -r 9 --dry-run --json")).json();
  EXPECT_EQ(json["mesh"]["bounds"][1][0], 1000.0);
}

TEST_F(Compute, MeshOfOnePoint) {
  write_bytes(folder / "point.obj", "v 1 2 3\nf 1 1 1\n");
  for (const std::string grid :
       {"-r 9", "-r 9 -t 0.5", "-r 9 -t 2s", "--size 5,6,7", "--spacing 0.25", "--minimum 2 -t 1"}) {
    done(words("compute point.obj -f -o p.vti " + grid));
    const DistanceField field = read_field(folder / "p.vti");
    EXPECT_NEAR(field.interpolate({1, 2, 3}), 0, field.grid().max_spacing()) << grid;
    EXPECT_GT(field.grid().size.x, 1) << grid;
  }
}

TEST_F(Compute, MethodsAgree) {
  done(words("compute scene:box -r 30 -t 0.2 -o tiles.vti"));
  const Ran ran = done(words("compute scene:box -r 30 -t 0.2 --method thesis --skip none -o thesis.vti"));
  EXPECT_TRUE(ran.says("thesis on cpu")) << ran.err;
  const auto a = read_field(folder / "tiles.vti").to_dense(), b = read_field(folder / "thesis.vti").to_dense();
  ASSERT_EQ(a.size(), b.size());
  for (std::size_t n = 0; n < a.size(); ++n) ASSERT_NEAR(a[n], b[n], 1e-5);
}

TEST_F(Compute, SkipRulesAreCounted) {
  const auto skipped = [&](const std::string& rule) {
    return done(words("compute scene:duplicate -r 30 -t 0.1 -f --json --skip " + rule)).json()["mesh"]["skipped"];
  };
  EXPECT_EQ(skipped("none"), 0);
  EXPECT_GT(skipped("exact"), 1000);
  EXPECT_GE(skipped("neighbour:0.5"), skipped("neighbour"));
}

TEST_F(Compute, SameBytesForAnyThreads) {
  done(words("compute scene:fly -r 60 -o one.nrrd -j 1"));
  done(words("compute scene:fly -r 60 -o four.nrrd -j 4"));
  EXPECT_EQ(read_bytes(folder / "one.nrrd"), read_bytes(folder / "four.nrrd"));
}

TEST_F(Compute, QuietAndVerbose) {
  EXPECT_EQ(done(words("compute scene:box -r 20 -q")).err, "");
  const Ran ran = done(words("compute scene:box -r 20 -v -f"));
  EXPECT_TRUE(ran.says("peak memory")) << ran.err;
  EXPECT_TRUE(ran.says("distances computed")) << ran.err;
}

// What a reader did to the axes and the unit is not silent: -v and info say it, --json in numbers.
TEST_F(Compute, TellsWhatTheReaderDidToCoordinates) {
  std::vector<std::string> files{"mesh/threemf_plain.3mf"};
  for (const FileFormat& format : mesh_formats())
    if (format.readable && (format.extension == "3ds" || format.extension == "dae"))
      files.push_back("scene/tetrahedron." + format.extension);
  const std::string turned = "axes turned so that y is up: x, y, z are x, z, -y of the file";
  for (const std::string& file : files) {
    SCOPED_TRACE(file);
    const std::string path = std::string(kSourceFolder) + "/tests/corpus/" + file;
    const Ran loud = done({"compute", path, "-r", "9", "-o", "a.vti", "-f", "-v"});
    EXPECT_TRUE(loud.says(path + ": " + turned)) << loud.err;
    EXPECT_FALSE(done({"compute", path, "-r", "9", "-o", "a.vti", "-f"}).says(turned));
    const Ran info = done({"info", path});
    EXPECT_NE(info.out.find("read          " + turned), std::string::npos) << info.out;
    const Json json = done({"info", path, "--json"}).json()["mesh"];
    EXPECT_EQ(json["axes"], Json({1, 3, -2}));
    if (file.ends_with("3ds")) continue;  // it has no unit
    const std::string scaled = "coordinates multiplied by 0.0";
    EXPECT_TRUE(loud.says(path + ": " + scaled)) << loud.err;
    EXPECT_NE(info.out.find("read          " + scaled), std::string::npos) << info.out;
    EXPECT_EQ(json["unit_scale"], file.ends_with("3mf") ? 0.001 : 0.01);
    EXPECT_EQ(json["metres_per_unit"], 1);
  }
}

TEST_F(Compute, ForceOverwrites) {
  write_bytes(folder / "a.vti", "mine");
  refused(words("compute scene:box -r 20 -o a.vti"), 2, "a.vti: it exists; give -f");
  EXPECT_EQ(read_bytes(folder / "a.vti"), "mine");
  done(words("compute scene:box -r 20 -o a.vti -f"));
  EXPECT_GT(read_bytes(folder / "a.vti").size(), 1000u);
}

// A file that is not there at the start, but before the field is written, is another program's.
TEST_F(Compute, AFileThatAppearsMeanwhileStays) {
  for (const bool force : {false, true}) {
    auto command = words("compute scene:sphere:20000 -r 150 -j 1 -o a.vti");
    if (force) command.emplace_back("-f");
    std::filesystem::remove(folder / "a.vti");
    Process process(command, setup());
    ASSERT_TRUE(process.wait_for("full field\n"));
    write_bytes(folder / "a.vti", "theirs");
    const Ran ran = process.wait();
    EXPECT_EQ(ran.code, force ? 0 : 4) << ran.err;
    EXPECT_EQ(ran.says("standoff: error: a.vti: cannot write it: somebody has written it, and it stays as it is"),
              !force);
    EXPECT_EQ(read_bytes(folder / "a.vti") == "theirs", !force);
    EXPECT_EQ(folder.names(), std::set<std::string>{"a.vti"});
  }
}

TEST_F(Compute, OddFileNames) {
  for (const std::string name :
       {"with blank", "h\xC3\xA9risson \xF0\x9F\xA6\x94", "-dash", "a\nb", "quote'\"", "\xFF\xFE"}) {
    const std::string mesh = "./" + name + ".stl";
    done({"generate", "box", "-o", mesh});
    const Json json = done({"compute", mesh, "-r", "9", "--json"}).json();
    EXPECT_EQ(json["mesh"]["triangles"], 12);
    EXPECT_TRUE(folder.names().contains(name + ".vti")) << name;
    EXPECT_EQ(done({"info", "./" + name + ".vti", "--json"}).json()["kind"], "field");
  }
  done({"compute", "-r", "9", "-f", "--", "-dash.stl"});
}

}  // namespace
}  // namespace standoff::testing
