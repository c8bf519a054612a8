// SPDX-License-Identifier: Apache-2.0
// standoff batch: results, rows, parts of a list, and every status that a mesh can have.
#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/stat.h>

#include <algorithm>
#include <filesystem>

#include "tests/cli/batch.h"

namespace standoff::testing {
namespace {

namespace fs = std::filesystem;

class Batch : public BatchTest {
 protected:
  void fails(const std::string& line, int code, const std::string& part) const {
    refused(words(line), code, "standoff: error: " + part);
  }
};

TEST_F(Batch, MakesTheFieldsThatComputeMakes) {
  write_meshes(3);
  const Ran ran = done(words("batch list.txt -o out -r 24 -t 3s --format vti -j 2"));
  EXPECT_TRUE(ran.says("out/manifest.jsonl: 3 meshes: 3 ok; in ")) << ran.err;
  for (const Json& row : rows()) {
    const std::string path = row["path"];
    done({"compute", path, "-o", "one.vti", "-r", "24", "-t", "3s", "-f", "-q"});
    EXPECT_EQ(read_bytes(folder / ("out/" + row["output"]["file"].get<std::string>())), read_bytes(folder / "one.vti"));
    EXPECT_EQ(row["output"]["bytes"], fs::file_size(folder / "one.vti"));
  }
}

TEST_F(Batch, ARowSaysAll) {
  write("list.txt", "mesh.obj\n");
  write("mesh.obj", octahedron());
  done(words("batch list.txt -o out -r 24 -t 3s"));
  const Json row = rows().at(0);
  std::vector<std::string> keys;
  for (const auto& [key, value] : row.items()) keys.push_back(key);
  std::ranges::sort(keys);
  EXPECT_EQ(keys, (std::vector<std::string>{"code", "file_hash", "grid", "id", "index", "mesh", "message",
                                            "normalization", "output", "parameters", "path", "samples", "seconds",
                                            "sign", "status", "thickness"}));
  EXPECT_EQ(row["index"], 0);
  EXPECT_EQ(row["status"], "ok");
  EXPECT_EQ(row["code"], 0);
  EXPECT_EQ(row["message"], "");
  EXPECT_EQ(row["mesh"]["triangles"], 8);
  EXPECT_EQ(row["mesh"]["vertices"], 6);
  EXPECT_EQ(row["mesh"]["hash"], done(words("compute mesh.obj -r 8 -o hash.vti --json")).json()["mesh"]["hash"]);
  EXPECT_EQ(row["grid"]["size"], Json({24, 24, 24}));
  EXPECT_EQ(row["samples"]["total"], 24 * 24 * 24);
  EXPECT_EQ(row["sign"]["method"], "winding");
  EXPECT_EQ(row["sign"]["sure"], true);
  EXPECT_GT(row["seconds"]["total"], 0.0);
  EXPECT_TRUE(fs::exists(folder / ("out/parameters-" + row["parameters"].get<std::string>() + ".json")));
  // What decides the values decides the hash, and nothing else does.
  const auto parameters_of = [&](const std::string& options) {
    done(words("batch list.txt -o other -f " + options));
    return rows("other/manifest.jsonl").at(0)["parameters"];
  };
  EXPECT_EQ(parameters_of("-r 24 -t 3s -j 1 --timeout 99 --device cpu --memory-limit 1G"), row["parameters"]);
  for (const char* options :
       {"-r 25 -t 3s", "-r 24 -t 4s", "-r 24 -t 3s --sign none", "-r 24 -t 3s --scale 2", "-r 24 -t 3s --invert",
        "-r 24 -t 3s --normalize unit-cube", "-r 24 -t 3s --format nrrd", "-r 24 -t 3s --uncompressed",
        "-r 24 -t 3s --padding 4", "-r 24 -t 3s --method propagate", "-r 24 -t 3s --points 9"})
    EXPECT_NE(parameters_of(options), row["parameters"]) << options;
}

// Once, however many meshes leave a doubt; the rows say which.
TEST_F(Batch, SaysHowManySignsAreNotCertain) {
  const std::string open = octahedron().substr(0, octahedron().rfind("f "));
  write("list.txt", "whole.obj\nopen.obj\nopener.obj\n");
  write("whole.obj", octahedron());
  write("open.obj", open);
  write("opener.obj", open);
  const std::string warning = "standoff: warning: the sign of 2 meshes is not certain: sign.sure is false in out/";
  const auto unsure = [&](const std::string& options) {
    const Ran ran = done(words("batch -o out --json -q " + options));
    const bool said = ran.says(warning);
    if (!options.starts_with("--report")) EXPECT_EQ(said, ran.json()["unsure"] == 2) << ran.err;
    EXPECT_EQ(ran.err.find("not certain"), ran.err.rfind("not certain")) << ran.err;
    return ran.json()["unsure"].get<int>();
  };
  EXPECT_EQ(unsure("list.txt -r 16"), 2);
  EXPECT_EQ(unsure("list.txt -r 16 --resume"), 0) << "nothing was made";
  EXPECT_EQ(unsure("list.txt -r 16 --points 9 -f"), 2);
  EXPECT_EQ(unsure("list.txt -r 16 --sign parity -f --shard 1/3"), 0);
  EXPECT_EQ(unsure("--report"), 2);
  EXPECT_NE(read_bytes(folder / "out/report.html").find("; the sign of 2 is not certain."), std::string::npos);
  write("parts.txt", "open.obj\nopener.obj\n");
  for (const char* part : {"1/2", "2/2"})
    done(words("batch parts.txt -o merged -q -r 16 --shard " + std::string(part)));
  EXPECT_EQ(done(words("batch --merge -o merged --json -q")).json()["unsure"], 2);
}

TEST_F(Batch, NormalizesFirst) {
  write("list.txt", "mesh.obj\n");
  write("mesh.obj", octahedron(4));
  done(words("batch list.txt -o out -r 24 --normalize unit-cube"));
  const Json cube = rows().at(0);
  EXPECT_EQ(cube["normalization"], Json({{"kind", "unit-cube"}, {"center", {3.0, 0.0, 0.0}}, {"scale", 0.125}}));
  EXPECT_LT(cube["grid"]["origin"][0], -0.5);
  EXPECT_GT(cube["grid"]["origin"][0], -0.8);
  done(words("batch list.txt -o out -r 24 --normalize unit-sphere -f"));
  EXPECT_EQ(rows().at(0)["normalization"]["scale"], 0.25);
}

TEST_F(Batch, EveryStatus) {
  write("good.obj", octahedron());
  write("garbage.obj", "this is no mesh\n");
  write("flat.obj", "v 0 0 0\nv 0 0 0\nv 0 0 0\nf 1 2 3\n");
  write("huge.obj", octahedron(1e5));  // at this spacing more samples than may be
  write("open.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
  write("blocked/mesh.obj", octahedron());
  write("out/fields/blocked", "a file where a folder must be");
  write("list.txt", "good.obj\ngarbage.obj\nmissing.obj\nhuge.obj\nopen.obj\nblocked/mesh.obj\nscene:nothing\n");
  const Ran ran =
      run(words("batch list.txt -o out --spacing 0.1 -t 3s --sign winding --strict --memory-limit 64M --json"));
  EXPECT_EQ(ran.code, 3) << ran.err;
  EXPECT_TRUE(ran.says("standoff: error: 6 meshes failed; out/manifest.jsonl says why")) << ran.err;
  auto found = last_rows();
  const auto expect = [&](const std::string& path, int code, const std::string& status, const std::string& message) {
    EXPECT_EQ(found[path]["code"], code) << found[path];
    EXPECT_EQ(found[path]["status"], status) << found[path];
    EXPECT_NE(found[path]["message"].get<std::string>().find(message), std::string::npos) << found[path];
  };
  expect("good.obj", 0, "ok", "");
  expect("garbage.obj", 3, "input", "garbage.obj");
  expect("missing.obj", 3, "input", "missing.obj: no such file");
  expect("huge.obj", 5, "limit", "huge.obj: ");
  expect("open.obj", 8, "doubt", "open.obj: ");
  expect("blocked/mesh.obj", 4, "output", "cannot make the folder");
  expect("scene:nothing", 2, "usage", "nothing");
  EXPECT_EQ(ran.json()["counts"],
            Json({{"ok", 1}, {"usage", 1}, {"input", 2}, {"output", 1}, {"limit", 1}, {"doubt", 1}}));
  EXPECT_EQ(ran.json()["rows"], 7);
  EXPECT_EQ(files("out/fields").size(), 2u);  // the good one's, and what was in the way
}

TEST_F(Batch, ShardsMakeWhatOneRunMakes) {
  write_meshes(7);
  write("mesh-3.obj", "no mesh\n");
  EXPECT_EQ(run(words("batch list.txt -o whole -r 20 -t 2s")).code, 3);
  for (const char* shard : {"2/3", "1/3", "3/3"})
    EXPECT_EQ(run({"batch", "list.txt", "-o", "parts", "-r", "20", "-t", "2s", "--shard", shard, "-q"}).code,
              shard[0] == '1' ? 3 : 0);
  EXPECT_EQ(run(words("batch --merge -o parts")).code, 3);
  EXPECT_EQ(files("whole/fields"), files("parts/fields"));
  auto whole = last_rows("whole/manifest.jsonl");
  const std::vector<Json> merged = rows("parts/manifest.jsonl");
  ASSERT_EQ(merged.size(), 7u);
  for (std::size_t n = 0; n < merged.size(); ++n) {
    EXPECT_EQ(merged[n]["index"], n);
    Json row = merged[n], one = whole.at(row["path"]);
    row.erase("seconds"), one.erase("seconds");
    EXPECT_EQ(row, one);
  }
}

TEST_F(Batch, MergeMissesNothing) {
  write_meshes(5);
  fails("batch --merge -o .", 2, ".: there is no manifest of a shard");
  done(words("batch list.txt -o out -r 20 --shard 1/2"));
  fails("batch --merge -o out", 3, "out/manifest-2-of-2.jsonl: it is missing; run --shard 2/2");
  done(words("batch list.txt -o out -r 21 --shard 2/2"));
  fails("batch --merge -o out", 3, "out/manifest-2-of-2.jsonl: it is of other options");
  write("other.txt", "mesh-0.obj\nmesh-4.obj\n");
  done(words("batch other.txt -o out -r 20 --shard 2/2 -f"));
  fails("batch --merge -o out", 3, "out/manifest-2-of-2.jsonl: it is of another list");
  done(words("batch list.txt -o out -r 20 --shard 2/2 -f"));
  const std::string complete = read_bytes(folder / "out/manifest-2-of-2.jsonl");
  write("out/manifest-2-of-2.jsonl", complete.substr(0, complete.find('\n') + 1));
  fails("batch --merge -o out", 3, "out/manifest-2-of-2.jsonl: mesh ");
  // Somebody tried again: the last row counts.
  write("out/manifest-2-of-2.jsonl", complete + complete);
  done(words("batch --merge -o out"));
  EXPECT_EQ(rows().size(), 5u);
  fs::remove(folder / "out/summary-1-of-2.json");
  fails("batch --merge -o out", 3, "out/summary-1-of-2.json: it is missing, so the shard has not come to its end");
}

TEST_F(Batch, TheOrderDoesNotMatter) {
  const std::vector<std::string> names = write_meshes(6);
  std::string reversed;
  for (const std::string& name : names) reversed = name + "\n" + reversed;
  write("reversed.txt", reversed);
  for (const std::string options : {"-r 20 -t 2s", "--points 100"}) {
    done(words("batch list.txt -o a -f -j 2 " + options));
    done(words("batch reversed.txt -o b -f -j 1 " + options));
  }
  EXPECT_EQ(files("a/fields"), files("b/fields"));
  EXPECT_EQ(files("a/points"), files("b/points"));
  EXPECT_EQ(files("a/points").size(), 6u);
}

TEST_F(Batch, AMeshThatIsListedTwiceIsMadeOnceAtATime) {
  write("mesh.obj", octahedron());
  std::string list;
  for (int n = 0; n < 200; ++n) list += "mesh.obj\n";
  write("list.txt", list);
  done(words("batch list.txt -o out -r 8 -j 4"));
  const std::vector<Json> found = rows();
  EXPECT_EQ(found.size(), 200u);
  for (const Json& row : found) EXPECT_EQ(row["output"], found.at(0)["output"]);
  EXPECT_EQ(files("out/fields").size(), 1u);
}

TEST_F(Batch, FoldersAreWalkedInOrder) {
  write("meshes/b.obj", octahedron());
  write("meshes/a/2.obj", octahedron());
  write("meshes/a/10.OBJ", octahedron());
  write("meshes/readme.txt", "no mesh");
  write("meshes/c/deep/er.obj", octahedron());
  fs::create_directory_symlink("..", folder / "meshes/a/circle");
  for (int n = 0; n < 2; ++n) done(words("batch meshes -o meshes/out -r 20 -j 1 -f"));  // its own results lie below
  std::vector<std::string> paths;
  for (const Json& row : rows("meshes/out/manifest.jsonl")) paths.push_back(row["path"]);
  EXPECT_EQ(paths,
            (std::vector<std::string>{"meshes/a/10.OBJ", "meshes/a/2.obj", "meshes/b.obj", "meshes/c/deep/er.obj"}));
  EXPECT_TRUE(fs::is_directory(folder / "meshes/out/fields/c/deep"));
}

TEST_F(Batch, NamesOfAllKinds) {
  const std::vector<std::string> names{"with space.obj",
                                       "line\nend.obj",
                                       "tab\t.obj",
                                       "\xC3\xA4\xE6\xBC\xA2.obj",
                                       "no-utf8-\xFF.obj",
                                       "#hash.obj",
                                       "-dash.obj",
                                       "../" + folder.path().filename().string() + "/up.obj",
                                       (folder / "absolute.obj").string(),
                                       std::string(200, 'n') + ".obj"};
  std::string list;
  for (const std::string& name : names) {
    write_bytes(name.starts_with("/") ? fs::path(name) : folder / name, octahedron());
    list += name + '\0';
  }
  write("list", list);
  done(words("batch list -o out -r 20 -0"));
  std::set<std::string> ids, outputs;
  for (const Json& row : rows()) {
    ids.insert(row["id"]);
    outputs.insert(row["output"]["file"]);
    EXPECT_TRUE(fs::exists(folder / ("out/" + row["output"]["file"].get<std::string>()))) << row;
  }
  EXPECT_EQ(ids.size(), names.size());
  EXPECT_EQ(outputs.size(), names.size());
  for (const auto& [path, bytes] : files("out"))
    EXPECT_TRUE(path.starts_with("fields/") || path.find('/') == std::string::npos) << path;
  EXPECT_EQ(last_rows().at("line\nend.obj")["status"], "ok");
  // Lists of Windows, and the last line without an end.
  write("list.txt", "with space.obj\r\n\r\n#hash.obj");
  done(words("batch list.txt -o lines -r 20"));
  EXPECT_EQ(last_rows("lines/manifest.jsonl").size(), 2u);
}

TEST_F(Batch, ReadsAListFromAPipe) {
  write_meshes(3);
  auto how = setup();
  how.in = ::open((folder / "list.txt").c_str(), O_RDONLY | O_CLOEXEC);
  EXPECT_EQ(run(words("batch - -o out -r 20"), how).code, 0);
  ::close(how.in);
  EXPECT_EQ(rows().size(), 3u);
  // Rows of meshes that are there do not wait for those to come.
  int ends[2];
  ASSERT_EQ(::pipe2(ends, O_CLOEXEC), 0);
  how.in = ends[0];
  Process process(words("batch - -o slow -r 20"), how);
  ::close(ends[0]);
  ASSERT_EQ(::write(ends[1], "mesh-0.obj\nmesh-1", 17), 17);
  while (!fs::exists(folder / "slow/manifest.jsonl") || rows("slow/manifest.jsonl").empty()) std::this_thread::yield();
  ASSERT_EQ(::write(ends[1], ".obj\n", 5), 5);
  ::close(ends[1]);
  EXPECT_EQ(process.wait().code, 0);
  EXPECT_EQ(rows("slow/manifest.jsonl").size(), 2u);
}

// A field of 64^3 of these meshes takes 3.6 MiB and more: it fits, but not beside another one.
TEST_F(Batch, LargeMeshesTakeTurns) {
  write("list.txt", "scene:sphere:2000\nscene:box\nscene:fly:3000\nscene:sphere:3000\nscene:box:12\n");
  done(words("batch list.txt -o narrow -r 64 --memory-limit 6M -j 2"));
  done(words("batch list.txt -o wide -r 64 -j 1"));
  EXPECT_EQ(files("narrow/fields"), files("wide/fields"));
}

TEST_F(Batch, SaysWhatMakesNoSense) {
  write_meshes(1);
  write("empty.txt", "\n\n");
  fs::create_directory(folder / "empty");
  fails("batch -o out", 2, "batch: no LIST given");
  fails("batch list.txt", 2, "--output");
  fails("batch mesh-0.obj -o out", 2, "mesh-0.obj: this is a mesh, and batch takes a list");
  fails("batch missing.txt -o out", 3, "missing.txt: no such file");
  fails("batch empty.txt -o out", 3, "empty.txt: there is no mesh in it");
  fails("batch empty -o empty-out", 3, "empty: there is no mesh in it");
  fails("batch empty -o out -0", 2, "--null: it is for lists");
  for (const char* shard : {"0/4", "5/4", "4", "a/b", "1/0"})
    EXPECT_EQ(run({"batch", "list.txt", "-o", "out", "--shard", shard}).code, 2) << shard;
  fails("batch list.txt -o out --near 0.5", 2, "--near, --sigma and --seed are for points");
  fails("batch list.txt -o out --points 9 --format vti", 2, "--points are written as .npz");
  fails("batch list.txt -o out --points 9 --sign flood", 2, "--sign flood needs a grid");
  fails("batch list.txt -o out --resume -f", 2, "-f begins anew");
  fails("batch list.txt -o new --retry failed", 2, "new/manifest.jsonl: there is none");
  fails("batch list.txt --merge -o out", 2, "--merge and LIST");
  fails("batch --report -o empty", 2, "empty: there is no manifest in it");
  done(words("batch list.txt -o done -r 20"));
  fails("batch list.txt -o done -r 20", 2, "done/manifest.jsonl: it exists; give --resume to go on");
}

TEST_F(Batch, SaysWhatCannotBeWritten) {
  write_meshes(2);
  write("file", "");
  fails("batch list.txt -o file -r 20", 4, "file: cannot make the folder");
  fails("batch list.txt -o file/below -r 20", 4, "file/below: cannot make the folder");
  fs::create_directories(folder / "full");
  ASSERT_EQ(::symlink("/dev/full", (folder / "full/manifest.jsonl").c_str()), 0);
  fails("batch list.txt -o full -r 20 -f", 4, "full/manifest.jsonl: cannot write it");
  // No file may grow past this: results fail one by one, and the manifest in the end. What it holds are whole rows.
  std::string list;
  for (int n = 0; n < 40; ++n) list += "mesh-0.obj\nscene:fly:5000\n";
  write("long.txt", list);
  auto how = setup();
  how.file_size = 20'000;
  refused(words("batch long.txt -o out -r 40"), how, 4, "rows up to here are kept");
  const std::string manifest = read_bytes(folder / "out/manifest.jsonl");
  EXPECT_TRUE(manifest.ends_with("}\n"));
  EXPECT_EQ(last_rows().at("scene:fly:5000")["code"], 4);
}

TEST_F(Batch, Report) {
  write("list.txt", "good.obj\ngarbage.obj\nopen.obj\n<b>&.obj\n");
  write("good.obj", octahedron());
  write("garbage.obj", "no mesh\n");
  write("open.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
  EXPECT_EQ(run(words("batch list.txt -o out -r 20 --sign winding --strict --report")).code, 3);
  const std::string page = read_bytes(folder / "out/report.html");
  for (const char* part :
       {"4 meshes, 3 failed", "<td>ok<td class=n>0<td class=n>1", "garbage.obj", "&lt;b&gt;&amp;.obj"})
    EXPECT_NE(page.find(part), std::string::npos) << part;
  EXPECT_EQ(page.find("<b>"), std::string::npos);
  // The open mesh can be read, and so drawn.
  std::size_t pictures = 0;
  for (std::size_t at = 0; (at = page.find("data:image/png;base64,iVBOR", at)) != std::string::npos; ++at) ++pictures;
  EXPECT_EQ(pictures, 1u);
  done(words("batch --report -o out"));
  EXPECT_EQ(read_bytes(folder / "out/report.html"), page);
}

}  // namespace
}  // namespace standoff::testing
