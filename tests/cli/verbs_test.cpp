// SPDX-License-Identifier: Apache-2.0
// info, slice, verify, generate, convert, version and help.
#include <gtest/gtest.h>

#include <map>
#include <sstream>
#include <string>
#include <vector>

#include "scenes/scenes.h"
#include "standoff/io.h"
#include "tests/cli/program.h"

namespace standoff::testing {
namespace {

class Verbs : public ProgramTest {
 protected:
  static bool holds(const std::string& text, const std::string& words) { return text.find(words) != std::string::npos; }
  static bool is_png(const std::string& bytes) { return bytes.starts_with("\x89PNG\r\n\x1a\n"); }
  // The verbs that the program's help lists.
  static std::vector<std::string> verbs_in(const std::string& help) {
    std::vector<std::string> verbs;
    std::istringstream lines(help.substr(help.find("\nVerbs:\n") + 8));
    for (std::string line; std::getline(lines, line) && line.starts_with("  ");)
      verbs.push_back(line.substr(2, line.find(' ', 2) - 2));
    return verbs;
  }
};

TEST_F(Verbs, VersionAndHelp) {
  EXPECT_EQ(done({"version"}).out, done({"--version"}).out);
  EXPECT_TRUE(done({"version"}).out.starts_with("standoff "));
  const std::string all = done({"help"}).out;
  EXPECT_EQ(all, done({"--help"}).out);
  EXPECT_EQ(all, done({"-h"}).out);
  const std::vector<std::string> verbs = verbs_in(all);
  EXPECT_GE(verbs.size(), 18u);
  for (const std::string& verb : verbs) {
    if (verb == "version" || verb == "help") continue;  // they have no options
    const std::string help = done({"help", verb}).out;
    EXPECT_EQ(help, done({verb, "--help"}).out);
    // Examples first, then the usage, then options; exit codes last.
    EXPECT_LT(help.find("Examples:\n  standoff " + verb), help.find("Usage: standoff " + verb + " ")) << help;
    EXPECT_LT(help.find("Usage: "), help.find("\nOptions:")) << help;
    EXPECT_LT(help.find("\nOptions:"), help.find("Exit codes: ")) << help;
    for (std::size_t start = 0, end; (end = help.find('\n', start)) != std::string::npos; start = end + 1)
      EXPECT_LE(end - start, 120u) << help.substr(start, end - start);
  }
}

// The thesis's options are few people's: they stand last.
TEST_F(Verbs, HelpEndsWithTheThesis) {
  for (const auto& [verb, options] : std::map<std::string, std::vector<std::string>>{
           {"compute", {"--method", "--skip", "--minimum", "--speed"}},
           {"fly", {"--mode", "--minimum", "--thickness", "--threshold"}}}) {
    const std::string help = done({"help", verb}).out;
    const auto group = help.find("\nThe thesis of 2008");
    ASSERT_NE(group, std::string::npos) << help;
    EXPECT_LT(help.find("--quiet"), group);
    for (const auto& option : options) EXPECT_GT(help.find("  " + option + " "), group) << option;
  }
}

TEST_F(Verbs, HelpNamesWhatAVerbTakes) {
  for (const std::string what : {".stl", "scene:NAME", ".vti", ".body"})
    EXPECT_TRUE(holds(done({"help", "info"}).out, what)) << what;
  for (const std::string what : {".stl", "scene:NAME", ".vti"})
    EXPECT_TRUE(holds(done({"help", "convert"}).out, what)) << what;
}

TEST_F(Verbs, VerboseSaysHowLongFilesTook) {
  EXPECT_TRUE(done(words("generate box -v")).says("writing box.ply: 0.0"));
  EXPECT_TRUE(done(words("info box.ply -v")).says("reading box.ply: 0.0"));
  EXPECT_EQ(done(words("info box.ply")).err, "");
}

// Flags that most verbs have may stand before the verb.
TEST_F(Verbs, FlagsBeforeTheVerb) {
  EXPECT_TRUE(done(words("--verbose info scene:box")).says("reading scene:box: 0.0"));
  EXPECT_EQ(done(words("--json -v info scene:box")).json()["mesh"]["triangles"], 12);
  EXPECT_EQ(done(words("-q generate box")).err, "");
}

TEST_F(Verbs, InfoOfAMesh) {
  const Json box = done(words("info scene:box --json")).json();
  EXPECT_EQ(box["kind"], "mesh");
  EXPECT_EQ(box["mesh"]["triangles"], 12);
  EXPECT_EQ(box["mesh"]["vertices"], 8);
  EXPECT_EQ(box["mesh"]["closed"], true);
  EXPECT_EQ(box["mesh"]["extent"], Json({2.0, 1.5, 1.0}));
  EXPECT_DOUBLE_EQ(box["mesh"]["area"], 2 * (2 * 1.5 + 2 * 1.0 + 1.5 * 1.0));
  EXPECT_TRUE(holds(done(words("info scene:box")).out, "closed        yes"));

  // Two triangles and one of them again, a sliver of no area, and a fin on the shared edge: by hand.
  write_bytes(folder / "odd.obj",
              "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 1 1 0\nv 0 0 1\nv 2 0 0\n"
              "f 1 2 3\nf 2 4 3\nf 3 1 2\nf 1 2 6\nf 2 3 5\n");
  const Json odd = done(words("info odd.obj --json")).json()["mesh"];
  EXPECT_EQ(odd["triangles"], 5);
  EXPECT_EQ(odd["degenerate"], 1);
  EXPECT_EQ(odd["duplicate"], 1);
  EXPECT_EQ(odd["nonmanifold_edges"], 2) << "2-3 has four triangles, 1-2 three";
  EXPECT_EQ(odd["open_edges"], 6) << "2-4, 3-4, 2-6, 1-6, 2-5, 3-5";
  EXPECT_EQ(odd["closed"], false);
}

TEST_F(Verbs, InfoDiagnosesAMesh) {
  // A tetrahedron whose last face is flipped, and one without its last face.
  const std::string corners = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 1 4 3\n";
  write_bytes(folder / "flipped.obj", corners + "f 2 4 3\n");
  write_bytes(folder / "open.obj", corners);
  const Json flipped = done(words("info flipped.obj --json")).json();
  EXPECT_EQ(flipped["mesh"]["inconsistent_edges"], 3);
  EXPECT_EQ(flipped["orientation"]["flipped"], 1);
  EXPECT_EQ(flipped["sign"]["method"], "winding");
  EXPECT_EQ(flipped["sign"]["sure"], true);
  EXPECT_DOUBLE_EQ(flipped["components"][0]["volume"], 1. / 6);
  EXPECT_TRUE(
      holds(done(words("info flipped.obj")).out, "orientation   3 inconsistent edges; for the sign: 1 flipped\n"));
  const std::string open = done(words("info open.obj --spacing 0.5")).out;
  EXPECT_TRUE(holds(open, "closed        no: 3 boundary edges in 1 loop, the largest 1.41421 across (2.82843 samples)"))
      << open;
  EXPECT_TRUE(holds(open, "\nsign          none, not certain: the mesh is open")) << open;
  done(words("compute scene:box -r 20 -o box.vti"));
  EXPECT_EQ(run(words("info box.vti --spacing 0.5")).code, 2);
}

TEST_F(Verbs, InfoOfAField) {
  done(words("compute scene:box -r 40 -t 0.125 -o a.npz"));
  const Json json = done(words("info a.npz --json")).json();
  EXPECT_EQ(json["kind"], "field");
  EXPECT_EQ(json["grid"]["size"][0], 40);
  EXPECT_EQ(json["thickness"], 0.125);
  EXPECT_EQ(json["values"]["max"], 0.125);
  EXPECT_LT(json["values"]["min"], 0.05);
  EXPECT_EQ(json["values"]["nan"], 0);
  EXPECT_LT(json["tiles"]["stored"], json["tiles"]["total"]);
  EXPECT_EQ(json["field"]["method"], "tiles");
  EXPECT_EQ(json["mesh"]["hash"], done(words("info scene:box --json")).json()["mesh"]["hash"]);
  const std::string text = done(words("info a.npz")).out;
  EXPECT_TRUE(holds(text, "thickness     0.125")) << text;
  done(words("compute scene:box -r 20 -o full.vti"));
  EXPECT_TRUE(done(words("info full.vti --json")).json()["thickness"].is_null());
  EXPECT_TRUE(holds(done(words("info full.vti")).out, "infinite"));
}

// Samples as far as the thickness lie in the band; only a nearest triangle tells them from those beyond.
TEST_F(Verbs, InfoCountsTheBandAsComputeDoes) {
  write_mesh(folder / "plane.obj", Mesh{{{-1, -1, 7}, {17, -1, 7}, {-1, 17, 7}, {17, 17, 7}}, {{0, 1, 2}, {1, 3, 2}}});
  const auto band = [&](const std::string& command) {
    return done(words(command + " --json")).json()["samples"]["band"];
  };
  const std::string plane = "compute plane.obj --bounds 0,0,0,15,15,15 --spacing 1 -t 1 -o ";
  EXPECT_EQ(band(plane + "a.vti --with triangle"), 3 * 256);
  EXPECT_EQ(band("info a.vti"), 3 * 256);
  EXPECT_EQ(band(plane + "b.vti"), 3 * 256);
  EXPECT_EQ(band("info b.vti"), 256);
  const std::string exact = done(words("info a.vti")).out, lower = done(words("info b.vti")).out;
  EXPECT_TRUE(holds(exact, "band          768 samples\n")) << exact;
  EXPECT_TRUE(holds(lower, "band          256 samples nearer than the thickness\n")) << lower;
}

TEST_F(Verbs, Slice) {
  done(words("compute scene:fly -r 40 --sign none -o a.vti"));
  const Ran ran = done(words("slice a.vti"));
  EXPECT_TRUE(is_png(read_bytes(folder / "a.png")));
  EXPECT_TRUE(ran.says("a.png: ")) << ran.err;
  EXPECT_EQ(ran.out, "");
  std::set<std::string> pictures;
  const std::vector<std::string> all{"",
                                     "--axis x",
                                     "--axis y --at 0.4",
                                     "--axis z --at 0.2",
                                     "--axis z --index 0",
                                     "--colormap thesis",
                                     "--pixels 1024",
                                     "--background dark",
                                     "--interpolation linear",
                                     "--interpolation linear --no-contours",
                                     "--bare",
                                     "--title Fly",
                                     "--length-unit mm",
                                     "--legend margin"};
  for (const std::string& options : all) {
    done(words("slice a.vti -q -f -o b.png " + options));
    pictures.insert(read_bytes(folder / "b.png"));
    EXPECT_TRUE(is_png(*pictures.rbegin())) << options;
  }
  EXPECT_EQ(pictures.size(), all.size()) << "two options gave the same picture";
  done(words("compute scene:fly -r 40 -t inf --sign winding -f -o a.vti"));
  for (const std::string map : {"auto", "diverging", "viridis", "thesis"}) {
    done(words("slice a.vti -q -f -o b.png --colormap " + map));
    pictures.insert(read_bytes(folder / "b.png"));
  }
  EXPECT_EQ(pictures.size(), all.size() + 3) << "auto is diverging where there is a sign";
  // The plane that shows the most is told.
  const Ran told = done(words("slice a.vti --json -f -o b.png"));
  EXPECT_TRUE(holds(told.out, "\"axis\"") && holds(told.out, "\"index\"") && holds(told.out, "\"position\""))
      << told.out;
  EXPECT_EQ(run(words("slice a.vti -o b.png")).code, 2);
  EXPECT_EQ(run(words("slice a.vti -o c.png --index 1000")).code, 2);
}

TEST_F(Verbs, VerifyPasses) {
  done(words("generate fly -o fly.ply"));
  for (const std::string options : {"-r 40", "-r 60 -t 3s --with triangle"}) {
    done(words("compute fly.ply -f " + options));
    const Ran ran = done(words("verify fly.vti fly.ply"));
    EXPECT_TRUE(holds(ran.out, "1,000 samples tested")) << ran.out;
    EXPECT_TRUE(holds(ran.out, "largest error ")) << ran.out;
    EXPECT_TRUE(ran.says("the field matches the mesh")) << ran.err;
  }
  const Json json = done(words("verify fly.vti fly.ply --samples 77 --json")).json();
  EXPECT_EQ(json["ok"], true);
  EXPECT_EQ(json["samples"]["tested"], 77);
  EXPECT_EQ(json["same_mesh"], true);
  EXPECT_LE(json["largest"]["error"], json["largest"]["allowed"]);
}

TEST_F(Verbs, VerifyFails) {
  done(words("compute scene:box -r 20 -o a.vti"));
  DistanceField field = read_field(folder / "a.vti");
  auto values = field.to_dense();
  values[static_cast<std::size_t>(field.grid().index(3, 4, 5))] += 0.01f;
  DistanceField wrong = DistanceField::from_dense(field.grid(), field.thickness(), values);
  wrong.set_provenance(field.provenance());
  write_field(folder / "wrong.vti", wrong);
  const Ran ran = refused(words("verify wrong.vti scene:box --samples 1000000"), 7,
                          "standoff: error: wrong.vti: sample (3, 4, 5) at ");
  EXPECT_TRUE(ran.says("as 1 sample of ")) << ran.err;
  const Ran as_json = run(words("verify wrong.vti scene:box --samples 1000000 --json"));
  EXPECT_EQ(as_json.code, 7);
  EXPECT_EQ(as_json.json()["ok"], false);
  EXPECT_EQ(as_json.json()["samples"]["wrong"], 1);
  EXPECT_EQ(as_json.json()["worst"]["sample"], Json({3, 4, 5}));
}

// The sample's sign is turned around, and nothing else.
DistanceField with_wrong_sign(const DistanceField& field, std::int64_t index) {
  auto values = field.to_dense();
  values[static_cast<std::size_t>(index)] *= -1;
  DistanceField wrong = DistanceField::from_dense(field.grid(), field.thickness(), values);
  wrong.set_provenance(field.provenance());
  return wrong;
}

TEST_F(Verbs, VerifyChecksTheSign) {
  done(words("compute scene:box -r 20 --sign winding --rule odd --invert -o a.vti"));
  EXPECT_TRUE(holds(done(words("info a.vti")).out, "sign          winding odd inverted\n"));
  const std::string every = " scene:box --samples 1000000";
  const Ran right = done(words("verify a.vti" + every));
  EXPECT_TRUE(holds(right.out, "sign (winding odd inverted): ")) << right.out;
  EXPECT_TRUE(holds(right.out, " checked, 0 wrong, ")) << right.out;

  const DistanceField field = read_field(folder / "a.vti");
  write_field(folder / "wrong.npz", with_wrong_sign(field, field.grid().index(3, 4, 5)));
  const Ran wrong = refused(words("verify wrong.npz" + every), 7, "standoff: error: wrong.npz: sample (3, 4, 5) at ");
  EXPECT_TRUE(wrong.says("the sign is wrong, the sample is ")) << wrong.err;
  EXPECT_TRUE(wrong.says("1 sample of ")) << wrong.err;
  const Json json = run(words("verify wrong.npz --json" + every)).json();
  EXPECT_EQ(json["ok"], false);
  EXPECT_EQ(json["samples"]["wrong"], 0);
  EXPECT_EQ(json["sign"]["method"], "winding odd inverted");
  EXPECT_EQ(json["sign"]["wrong"], 1);
  EXPECT_EQ(json["sign"]["worst"]["sample"], Json({3, 4, 5}));
}

// A sign that nothing is known of is not passed over in silence.
TEST_F(Verbs, VerifySaysWhatItDoesNotCheck) {
  done(words("compute scene:box -r 20 --sign winding -o a.vti"));
  DistanceField field = read_field(folder / "a.vti");
  const auto verified_as = [&](const std::string& sign) {
    field.set_provenance({"", 0, "", sign});
    write_field(folder / "b.vti", field);
    return done(words("verify b.vti scene:box"));
  };
  EXPECT_FALSE(verified_as("winding").says("warning"));
  EXPECT_TRUE(verified_as("").says("has negative values but does not say how their sign was decided")) << "no words";
  EXPECT_TRUE(verified_as("by hand").says("the sign (by hand) cannot be checked")) << "other words";
  done(words("compute scene:box -r 20 -f -o a.vti"));
  EXPECT_FALSE(done(words("verify a.vti scene:box")).says("warning"));
}

TEST_F(Verbs, VerifySaysWhenTheMeshIsAnother) {
  done(words("compute scene:box -r 20 -o a.vti --scale 2"));
  refused(words("verify a.vti scene:box"), 7, "standoff: warning: a.vti: computed from another mesh");
  EXPECT_FALSE(done(words("verify a.vti scene:box --scale 2")).says("warning"));
}

TEST_F(Verbs, Generate) {
  const std::string list = done(words("generate --list")).out;
  const Json json = done(words("generate --list --json")).json();
  EXPECT_TRUE(json.is_object());
  EXPECT_EQ(json["scenes"].size(), scenes::all().size());
  for (const auto& scene : scenes::all()) EXPECT_TRUE(holds(list, scene.name + " ")) << scene.name;
  EXPECT_TRUE(folder.names().empty());

  done(words("generate box"));
  EXPECT_EQ(read_mesh(folder / "box.ply").mesh.triangles, scenes::make("box").triangles);
  const Json made = done(words("generate sphere --triangles 5000 -o s.stl --json")).json();
  EXPECT_NEAR(made["mesh"]["triangles"].get<double>(), 5000, 1000);
  EXPECT_EQ(made["mesh"]["triangles"], read_mesh(folder / "s.stl").mesh.triangles.size());
  const Json same = done(words("info scene:sphere:5000 --json")).json();
  EXPECT_EQ(same["mesh"]["triangles"], made["mesh"]["triangles"]);
  // As other verbs name it.
  EXPECT_EQ(done(words("generate scene:sphere:5000 --json")).json()["mesh"], made["mesh"]);
  EXPECT_TRUE(folder.names().contains("sphere.ply"));
  EXPECT_TRUE(run(words("generate scene:sphere:5000 --triangles 100")).says("names a number already"));
}

TEST_F(Verbs, ConvertMeshes) {
  done(words("generate fly -o fly.ply"));
  const auto triangles = read_mesh(folder / "fly.ply").mesh.triangles.size();
  for (const std::string name : {"fly.stl", "fly.obj"}) {
    done({"convert", "fly.ply", "-o", name});
    EXPECT_EQ(read_mesh(folder / name).mesh.triangles.size(), triangles) << name;
  }
  done(words("convert fly.ply -o cm.ply --unit cm"));
  EXPECT_NEAR(bounds(read_mesh(folder / "cm.ply").mesh).max.x, bounds(read_mesh(folder / "fly.ply").mesh).max.x / 100,
              1e-12);
  done(words("convert cm.ply -o cm.ply -f --scale 100"));
  EXPECT_EQ(read_mesh(folder / "cm.ply").mesh.triangles.size(), triangles);
  // glTF's y is up, as STL's z is; its unit is the metre, as far as that is known.
  done(words("generate catapult -q -o catapult.stl"));
  EXPECT_TRUE(done(words("convert catapult.stl -o catapult.glb")).says("is unknown: .glb takes it for metres"));
  EXPECT_FALSE(done(words("convert catapult.stl -f -o catapult.glb --unit m")).says("unknown"));
  const Box lies = bounds(read_mesh(folder / "catapult.stl").mesh),
            stands = bounds(read_mesh(folder / "catapult.glb").mesh);
  EXPECT_EQ(stands.extent(), (Vec3{lies.extent().x, lies.extent().z, lies.extent().y}));
}

TEST_F(Verbs, ConvertFields) {
  done(words("compute scene:fly -r 40 -t 3s -o a.vti"));
  done(words("convert a.vti -o a.nrrd"));
  done(words("convert a.nrrd -o a.npz"));
  const DistanceField from = read_field(folder / "a.vti"), to = read_field(folder / "a.npz");
  EXPECT_EQ(to.to_dense(), from.to_dense());
  EXPECT_EQ(to.grid(), from.grid());
  EXPECT_EQ(to.provenance().mesh_hash, from.provenance().mesh_hash);
  EXPECT_EQ(done(words("verify a.npz scene:fly")).code, 0);
}

}  // namespace
}  // namespace standoff::testing
