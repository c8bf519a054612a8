// SPDX-License-Identifier: Apache-2.0
// Every exit code, and the form of every message: `standoff: error: WHERE: what; what to do`, on one line.
#include <gtest/gtest.h>

#include <algorithm>

#include "standoff/io.h"
#include "tests/cli/program.h"

namespace standoff::testing {
namespace {

struct Case {
  const char* command;
  int code;
  std::string message;  // part of it
};

class Errors : public ProgramTest {
 protected:
  Errors() {
    write_bytes(folder / "box.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
    write_bytes(folder / "empty.stl", "");
    write_bytes(folder / "nan.obj", "v 0 0 0\nv 1 0 0\nv nan 1 0\nf 1 2 3\n");
    write_bytes(folder / "index.obj", "v 0 0 0\nv 1 0 0\nf 1 2 3\n");
    write_bytes(folder / "points.obj", "v 0 0 0\nv 1 0 0\n");
    write_bytes(folder / "broken.vti", "<?xml");
    write_bytes(folder / "huge.obj", "v 0 0 0\nv 1e308 0 0\nv 0 -1e308 0\nf 1 2 3\n");
    std::filesystem::create_directory(folder / "folder.stl");
    std::filesystem::create_directory(folder / "folder.vti");
    before_ = folder.names();
  }

  void expect(const Case& test) const {
    const Ran ran = run(words(test.command));
    EXPECT_EQ(ran.code, test.code) << "standoff " << test.command << "\n" << ran.err;
    // One line, after whatever was said before it went wrong.
    const auto error = ran.err.find("standoff: error: ");
    ASSERT_NE(error, std::string::npos) << "standoff " << test.command << "\n" << ran.err;
    EXPECT_TRUE(error == 0 || ran.err[error - 1] == '\n') << "standoff " << test.command << "\n" << ran.err;
    EXPECT_EQ(std::count(ran.err.begin() + static_cast<std::ptrdiff_t>(error), ran.err.end(), '\n'), 1)
        << "standoff " << test.command << "\n"
        << ran.err;
    EXPECT_TRUE(ran.says(test.message)) << "standoff " << test.command << "\n" << ran.err << "lacks " << test.message;
    EXPECT_EQ(ran.out, "") << "standoff " << test.command;
    EXPECT_EQ(folder.names(), before_) << "standoff " << test.command;
  }
  // ".vti, .nrrd or ..": what the table of formats lists.
  static std::string listed(const std::vector<FileFormat>& formats) {
    std::string text;
    for (std::size_t n = 0; n < formats.size(); ++n)
      text += (n == 0 ? "." : n + 1 == formats.size() ? " or ." : ", .") + formats[n].extension;
    return text;
  }
  const std::string fields = listed(field_formats());

  template <std::size_t N>
  void expect_all(const Case (&tests)[N]) const {
    for (const Case& test : tests) expect(test);
  }

 private:
  std::set<std::string> before_;
};

TEST_F(Errors, UsageOfVerbs) {
  expect_all({
      {"", 2, "no verb given; see standoff help"},
      {"frobnicate", 2, "'frobnicate' is no verb; see standoff help"},
      {"compuet box.obj", 2, "did you mean 'compute'?"},
      {"box.obj", 2, "standoff compute box.obj"},
      {"help frobnicate", 2, "'frobnicate' is no verb; take compute, batch, "},
      {"help ifno", 2, "'ifno' is no verb; did you mean 'info'?"},
      {"-r 10 compute box.obj", 2, "'-r' stands before the verb; begin with the verb"},
      {"-v", 2, "'-v' stands before the verb"},
      {"compute", 2, "MESH is required; see standoff help compute"},
      {"compute box.obj too.vti", 2, "'too.vti' is one argument too many; name the output with -o, as in -o too.vti"},
      {"info box.obj too.obj", 2, "'too.obj' is one argument too many; see standoff help info"},
      {"compute box.obj --treads 2", 2, "unknown option '--treads'; did you mean '--threads'?"},
      {"compute box.obj --sing=auto", 2, "unknown option '--sing=auto'; did you mean '--sign'?"},
      {"compute box.obj --res 10", 2, "unknown option '--res'; did you mean '--resolution'?"},
      {"compute box.obj -x", 2, "unknown option '-x'; see standoff help compute"},
      {"compute box.obj -o", 2, "--output: its value is missing"},
      {"compute box.obj -r 10 -r 20", 2, "--resolution: given more than once"},
      {"info", 2, "FILE is required"},
      {"slice", 2, "FIELD is required"},
      {"verify broken.vti", 2, "MESH is required"},
      {"generate", 2, "no SCENE given; see standoff generate --list"},
      {"generate nowhere", 2, "scene:nowhere: there is no such scene; standoff generate --list shows all "},
      {"compute scene:lab", 2, "no such scene; did you mean 'scene:labyrinth'? standoff generate --list shows all "},
      {"compute bx.obj", 3, "bx.obj: no such file; check the name"},
      {"compute bax.obj", 3, "bax.obj: no such file; did you mean 'box.obj'?"},
      {"compute box.stl", 3, "box.stl: no such file; did you mean 'box.obj'?"},
      {"compute ./huge", 3, "./huge: no such file; did you mean './huge.obj'?"},
      {"slice brokn.vti", 3, "brokn.vti: no such file; did you mean 'broken.vti'?"},
      {"compute nowhere/box.obj", 3, "nowhere/box.obj: no such file; check the name"},
      {"compute scene:sphere:many", 2, "scene:sphere:TRIANGLES 'many': give a whole number"},
      {"convert box.obj", 2, "--output is required"},
      {"convert box.obj -o a.vti", 2, "use standoff compute"},
      {"convert broken.vti -o a.stl", 2, "a field can only become a field"},
      {"convert box.obj -o a.stl --uncompressed", 2, "--uncompressed: it is for fields, and box.obj is none"},
      {"convert broken.vti -o a.npz --scale 2", 2, "--scale and --unit are for meshes"},
  });
}

TEST_F(Errors, UsageOfValues) {
  expect_all({
      {"compute box.obj -r 1", 2, "--resolution '1': give a whole number from 2"},
      {"compute box.obj -r ten", 2, "--resolution 'ten': give a whole number"},
      {"compute box.obj -r 10.5", 2, "--resolution '10.5'"},
      {"compute box.obj -r 99999999999999999999", 2, "--resolution"},
      {"compute box.obj --spacing 0", 2, "--spacing '0': must be above zero"},
      {"compute box.obj --spacing 1,2", 2, "--spacing '1,2': give one number, or three"},
      {"compute box.obj --spacing 1,2,x", 2, "'x' is not a number"},
      {"compute box.obj --spacing nan", 2, "'nan' is not a number"},
      {"compute box.obj -j 1000000", 2, "--threads '1000000': give a whole number from 1 to "},
      {"compute box.obj --spacing +1e999", 2, "'+1e999' is out of the range of numbers"},
      {"compute box.obj --spacing 1e999x", 2, "'1e999x' is not a number"},
      {"compute box.obj --size 1,2", 2, "--size '1,2': give three whole numbers"},
      {"compute box.obj --size 1,0,2", 2, "--size '0'"},
      {"compute box.obj --bounds 1,2,3", 2, "--bounds '1,2,3': give six numbers"},
      {"compute box.obj --bounds 1,0,0,0,1,1", 2, "the first corner must not exceed"},
      {"compute box.obj --padding -1", 2, "--padding '-1': give zero or more"},
      {"compute box.obj -r 10 --padding 5", 2, "leaves no samples for the mesh"},
      {"compute box.obj -t 0", 2, "--thickness '0': the thickness must be above zero"},
      {"compute box.obj -t -2", 2, "the thickness must be above zero"},
      {"compute box.obj -t nan", 2, "--thickness 'nan'"},
      {"compute box.obj -t s", 2, "--thickness 's'"},
      {"compute box.obj --minimum 0.5 -t 1", 2, "factor e must be at least 1"},
      {"compute box.obj --minimum 2 -t 1 --speed -1", 2, "the speed must be zero or more"},
      {"compute box.obj --method magic", 2,
       "--method 'magic': give tiles, thesis, fuhrmann, propagate, jumpflood or jumpflood+1"},
      {"compute box.obj --sign some", 2,
       "--sign 'some': give auto, winding, parity, normal, facet, flood, shell or none"},
      {"compute box.obj --sign shell", 2, "--sign 'shell': give a thickness above zero, as in"},
      {"compute box.obj --sign shell:0", 2, "--sign 'shell:0': give a thickness above zero, as in"},
      {"compute box.obj --sign shell:inf", 2, "--sign 'shell:inf': give a thickness above zero, as in"},
      {"compute box.obj --sign flood:3", 2, "--sign 'flood:3': only shell takes a value"},
      {"compute box.obj --skip some", 2, "--skip 'some': give none, neighbour or exact"},
      {"compute box.obj --skip neighbour:2", 2, "the fraction must be above 0 and at most 1"},
      {"compute box.obj --skip exact:0.5", 2, "only neighbour takes a fraction"},
      {"compute box.obj --with color", 2, "--with 'color': give nearest, triangle, closest"},
      {"compute box.obj --device tpu", 2, "--device 'tpu': give auto, cpu, cuda or emulated"},
      {"compute box.obj -j 0", 2, "--threads '0'"},
      {"compute box.obj --memory-limit 8Q", 2, "--memory-limit '8Q'"},
      {"compute box.obj --memory-limit -1", 2, "--memory-limit '-1'"},
      {"compute box.obj --scale 0", 2, "--scale '0': must be above zero"},
      {"compute box.obj --unit parsec", 2, "--unit 'parsec': give mm, cm, m, in, ft or km"},
      {"compute box.obj --progress always", 2, "--progress 'always': give auto or never"},
      {"slice broken.vti --axis w", 2, "--axis 'w': give x, y or z"},
      {"slice broken.vti --at 1.5", 2, "--at '1.5': give a number from 0 to 1"},
      {"slice broken.vti --colormap jet", 2, "--colormap 'jet': give auto, diverging, viridis or thesis"},
      {"verify broken.vti box.obj --samples 0", 2, "--samples '0'"},
      {"generate box --triangles 0", 2, "--triangles '0'"},
  });
}

TEST_F(Errors, OptionsThatCannotGoTogetherAreBothNamed) {
  expect_all({
      {"compute box.obj -r 10 --spacing 1", 2, "--resolution and --spacing cannot go together"},
      {"compute box.obj -r 10 --size 1,1,1", 2, "--resolution and --size cannot go together"},
      {"compute box.obj --spacing 1 --size 1,1,1", 2, "--spacing and --size cannot go together"},
      {"compute box.obj -t 1 --minimum 2 -r 10", 2, "--resolution and --minimum cannot go together"},
      {"compute box.obj -t 1 --minimum 2 --padding 1", 2, "--padding and --minimum cannot go together"},
      {"compute box.obj -t 1 --minimum 2 --bounds 0,0,0,1,1,1", 2, "--bounds and --minimum cannot go together"},
      {"compute box.obj --bounds 0,0,0,1,1,1 --padding 1", 2, "--bounds and --padding cannot go together"},
      {"compute box.obj --minimum 2", 2, "--minimum needs --thickness"},
      {"compute box.obj --minimum 2 -t inf", 2, "--minimum: needs a --thickness in world units"},
      {"compute box.obj --minimum 2 -t 3s", 2, "--minimum: needs a --thickness in world units"},
      {"compute box.obj --speed 1", 2, "--speed needs --minimum"},
      {"compute box.obj -q -v", 2, "--quiet and --verbose cannot go together"},
      {"compute box.obj --scale 1 --unit mm", 2, "--scale and --unit cannot go together"},
      {"slice broken.vti --at 0.5 --index 1", 2, "--at and --index cannot go together"},
      {"generate --list box", 2, "SCENE and --list cannot go together"},
      {"generate --list --triangles 3", 2, "--list and --triangles cannot go together"},
  });
}

TEST_F(Errors, Input) {
  expect_all({
      {"compute missing.stl", 3, "missing.stl: "},
      {"compute folder.stl -o a.vti", 3, "folder.stl: "},
      {"compute empty.stl", 3, "empty.stl: "},
      {"compute nan.obj", 3, "nan.obj:"},
      {"compute index.obj", 3, "index.obj:"},
      {"compute points.obj", 3, "points.obj: "},
      {"compute huge.obj", 3, "huge.obj: a coordinate of -1e+308, too far out for a grid; repair the mesh, or scale"},
      {"info missing.vti", 3, "missing.vti: "},
      {"info broken.vti", 3, "broken.vti:"},
      {"info folder.vti", 3, "folder.vti: "},
      {"slice broken.vti", 3, "broken.vti:"},
      {"verify missing.vti box.obj", 3, "missing.vti: "},
      {"convert missing.obj -o a.stl", 3, "missing.obj: "},
      {"convert missing.npz -o a.vti", 3, "missing.npz: "},
      {"slice box.obj", 3, "box.obj: this is no field, as " + fields + " are; compute the field of a mesh with"},
      {"verify box.obj box.obj", 3, "box.obj: this is no field"},
      {"verify broken.vti broken.vti", 3, "broken.vti"},
      {"compute broken.vti -o a.vti", 3, "broken.vti: this is a field; give the mesh it was computed from"},
      {"collide scene:box broken.vti", 3, "broken.vti: this is a field"},
      {"compute -", 3, "-: meshes and fields are not read by this name; give a file, or /dev/stdin for a pipe"},
      // Both names are looked at before the first body is built.
      {"distance broken.vti missing.obj", 3, "missing.obj: no such file"},
      {"fly --fly missing.obj --labyrinth broken.vti", 3, "missing.obj: no such file"},
  });
}

TEST_F(Errors, Output) {
  expect_all({
      {"compute box.obj -o a.jpg", 2, "a.jpg: cannot write .jpg here; use " + fields},
      {"compute box.obj -o a", 2, "a: the name has no extension; use .vti"},
      {"compute box.obj -o box.obj -f", 2, "box.obj: cannot write .obj here"},
      {"compute box.obj -o broken.vti", 2, "broken.vti: it exists; give -f"},
      {"compute box.obj -o no/a.vti", 4, "no/a.vti: the folder no does not exist; create it first"},
      {"compute box.obj -o folder.vti -f", 4, "folder.vti: it is a folder"},
      {"compute box.obj -o .", 4, ".: it is a folder"},
      {"compute box.obj -o box.obj/a.vti", 4, "box.obj/a.vti: the folder box.obj does not exist"},
      {"compute box.obj -r 9 -o /proc/a.vti", 4, "/proc/a.vti: cannot write it: the folder /proc takes no new files"},
      {"slice broken.vti -o a.gif", 2, "a.gif: cannot write .gif here; use .png"},
      {"slice broken.vti -o no/a.png", 4, "no/a.png: the folder no does not exist"},
      {"generate box -o no/a.ply", 4, "no/a.ply: the folder no does not exist"},
      {"generate box -o a.vti", 2, "a.vti: cannot write .vti here"},
      {"generate box -o box.obj", 2, "box.obj: it exists; give -f"},
      {"convert box.obj -o no/a.stl", 4, "no/a.stl: the folder no does not exist"},
      {"convert box.obj -o empty.stl", 2, "empty.stl: it exists; give -f"},
  });
}

// A file that was written stays where only the word of it is lost: nobody has to compute it again.
TEST_F(Errors, StandardOutputThatFailsLosesNoFile) {
  const int full = ::open("/dev/full", O_WRONLY | O_CLOEXEC);
  ASSERT_GE(full, 0);
  auto how = setup();
  how.out = full;
  write_bytes(folder / "poses.csv", "1,2,3\n");
  for (const std::string line :
       {"compute box.obj -r 9 -o a.vti", "build box.obj -o a.body", "generate box -o a.ply",
        "fly --fly scene:box --labyrinth scene:labyrinth:20000 --steps 3 --no-check --path a.csv",
        "collide scene:box scene:box --poses poses.csv -o b.csv"}) {
    const Ran ran = run(words(line + " --json"), how);
    EXPECT_EQ(ran.code, 4) << line;
    const std::string file = line.substr(line.rfind(' ') + 1);
    EXPECT_TRUE(ran.says("standoff: error: standard output: cannot write to it: ")) << ran.err;
    EXPECT_TRUE(ran.says("; " + file + " was written before, and is whole\n")) << ran.err;
    EXPECT_GT(std::filesystem::file_size(folder / file), 10u) << line;
  }
  // The text of fly comes after its file too; what writes no file says nothing of one.
  const Ran fly =
      run(words("fly --fly scene:box --labyrinth scene:labyrinth:20000 --steps 3 --no-check --path c.csv"), how);
  EXPECT_EQ(fly.code, 4);
  EXPECT_TRUE(fly.says("; c.csv was written before, and is whole\n")) << fly.err;
  for (const std::string line : {"info box.obj", "collide box.obj box.obj", "devices --json"}) {
    const Ran ran = run(words(line), how);
    EXPECT_EQ(ran.code, 4) << line;
    EXPECT_FALSE(ran.says("was written")) << ran.err;
  }
  ::close(full);
}

// Fields are looked at before they take memory: a file of few tiles may be larger than the limit.
TEST_F(Errors, FieldsThatAreReadKeepTheLimit) {
  done(words("compute scene:box -r 150 -o full.vti"));
  done(words("compute scene:box -r 150 -t 1s -o band.npz --with triangle --uncompressed"));
  for (const std::string line : {"info full.vti", "slice full.vti"}) {
    const Ran ran = refused(words(line + " --memory-limit 5M"), 5, "standoff: error: full.vti: its tiles need ");
    EXPECT_TRUE(ran.says(" MiB, more than the limit of 5 MiB; give a higher limit\n")) << ran.err;
    done(words(line + " --memory-limit 40M"));
  }
  // Some slices at a time where all are too many.
  done(words("verify full.vti scene:box --memory-limit 5M"));
  for (const char* limit : {"5M", "40M"})
    done(words(std::string("convert full.vti -o ") + limit + ".vti --memory-limit " + limit));
  EXPECT_EQ(read_bytes(folder / "5M.vti"), read_bytes(folder / "40M.vti"));
  const std::int64_t size = static_cast<std::int64_t>(std::filesystem::file_size(folder / "band.npz"));
  ASSERT_GT(size, std::int64_t{10} << 20);
  done(words("info band.npz --memory-limit 9M"));
  EXPECT_EQ(run(words("info band.npz --memory-limit 1M")).code, 5);
  for (const std::string line : {"info box.obj", "convert box.obj -o c.stl"}) {
    refused(words(line + " --memory-limit 5M"), 2,
            "--memory-limit: it is for fields, and box.obj is none; leave it out");
  }
}

TEST_F(Errors, Limit) {
  expect_all({
      {"compute scene:box -r 800 -j 1 -o box.nvdb --memory-limit 500M", 5,
       "more than the limit of 500 MiB; take at most about"},
      {"compute scene:box -r 800 -j 1 -o box.nvdb --memory-limit 500M", 5, "a smaller thickness"},
      {"compute box.obj --spacing 1e-300", 5, "more than 2^40 samples on a side; take a larger spacing"},
      {"compute box.obj -r 1000000", 5, "more than the limit of"},
      {"compute box.obj --size 1000000000000,1000000000,1", 5, "too many samples to count"},
  });
}

// 100 KB of an argument came back whole, and a field's method, escapes and all.
TEST_F(Errors, MessagesAreShort) {
  const std::string longest(100'000, 'x');
  for (const std::vector<std::string>& line :
       {std::vector<std::string>{"info", longest}, {"compute", "box.obj", "-r", longest}, {longest}}) {
    const Ran ran = run(line);
    EXPECT_LT(ran.err.size(), 1300u);
    EXPECT_TRUE(ran.says("xxx...xxx")) << ran.err;
  }
  std::string umlauts = "x";
  for (int n = 0; n < 1000; ++n) umlauts += "\xc3\xa4";
  EXPECT_TRUE(run({umlauts}).says("\xc3\xa4...\xc3\xa4")) << "whole characters";
  write_bytes(folder / "poses.csv", "1,\x9b\xc3\xa4,3\n");
  EXPECT_EQ(run(words("collide box.obj box.obj --poses poses.csv")).err,
            "standoff: error: poses.csv:1: '\?\?\?' is not a number; separate numbers by commas\n");
}

TEST_F(Errors, WhatAFieldTellsOfItselfStaysOnItsLine) {
  const std::string method = "\\n\x1b[31m\x9b" + std::string(100'000, 'x');
  write_bytes(folder / "a.nrrd",
              "NRRD0005\ntype: float\ndimension: 3\nsizes: 1 1 1\nspacings: 1 1 1\nendian: little\nencoding: raw\n"
              "method:=" +
                  method + "\nversion:=" + method + "\n\n" + std::string(4, '\0'));
  const std::string shown = "\?\?[31m?" + std::string(193, 'x') + "...";
  const Ran ran = run(words("info a.nrrd"));
  EXPECT_NE(ran.out.find("\nmethod        " + shown + ", standoff " + shown + "\n"), ran.out.npos) << ran.out;
  EXPECT_LT(run(words("info a.nrrd --json")).out.size(), 10'000u);
}

#if !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)  // which need terabytes of addresses
// Memory that is not there although no limit of ours was met.
TEST_F(Errors, OutOfMemory) {
  auto how = setup();
  how.memory = rlim_t{600} << 20;
  const Ran ran =
      refused(words("compute scene:box -r 900 -j 1 --memory-limit 100G -o a.vdb"), how, 5, "standoff: error: ");
  EXPECT_TRUE(ran.says("memory")) << ran.err;
  EXPECT_FALSE(std::filesystem::exists(folder / "a.vdb"));
}
#endif

// No machine has a hundred GPUs; most test machines have none.
TEST_F(Errors, Device) {
  expect_all({{"compute box.obj --device cuda:99", 6, "cuda: "},
              {"compute box.obj --device cuda:x", 2, "give the number of a GPU"},
              {"compute box.obj --device cpu:1", 2, "only a GPU takes a number"}});
}

TEST_F(Errors, ANewlineInANameStaysOnTheLine) {
  const Ran ran = run({"compute", "no\nsuch.stl"});
  EXPECT_EQ(ran.code, 3);
  EXPECT_EQ(std::ranges::count(ran.err, '\n'), 1) << ran.err;
}

// A message is one whole line and steers no terminal, whatever a name or a file holds.
TEST_F(Errors, ControlBytesAreShownAsQuestionMarks) {
  const auto clean = [](const std::string& text) {
    return std::ranges::none_of(text, [](unsigned char c) { return (c < 0x20 && c != '\n') || c == 0x7f; });
  };
  const Ran name = run({"compute", "a\x1b[31m\x7f.stl"});
  EXPECT_EQ(name.err, "standoff: error: a?[31m?.stl: no such file; check the name\n");
  constexpr char kZero[] = "ply\nformat ascii 1.0\nelement a\0\x1b 1\nproperty list char char b\nend_header\n-1\n";
  write_bytes(folder / "zero.ply", std::string(kZero, sizeof kZero - 1));
  const Ran file = run(words("info zero.ply"));
  EXPECT_TRUE(file.says("zero.ply:a?? 0: a list of -1 values; the file is damaged, write it again\n")) << file.err;
  EXPECT_TRUE(clean(file.err)) << file.err;
  const Ran said = run({"convert", "box.obj", "-o", "a\x1b[31m\n.stl"});
  EXPECT_EQ(said.err, "a?[31m .stl: 1 triangle, 3 vertices\n");
}

TEST_F(Errors, AnEmptyOutputIsNoName) {
  const Ran ran = run({"compute", "box.obj", "-o", ""});
  EXPECT_EQ(ran.code, 2);
  EXPECT_EQ(ran.err, "standoff: error: --output '': give the name of a file\n");
}

TEST_F(Errors, JsonStaysSilentOnErrors) {
  const Ran ran = run(words("compute missing.stl --json"));
  EXPECT_EQ(ran.code, 3);
  EXPECT_EQ(ran.out, "");
}

}  // namespace
}  // namespace standoff::testing
