// SPDX-License-Identifier: Apache-2.0
// --cache: fields that were computed before are the same bytes, and damaged ones are no fields.
#include <gtest/gtest.h>
#include <sys/stat.h>

#include <deque>
#include <filesystem>

#include "tests/cli/batch.h"

namespace standoff::testing {
namespace {

namespace fs = std::filesystem;

class Cache : public BatchTest {
 protected:
  Cache() { write("mesh.obj", octahedron()); }

  // Whether the field was computed before.
  bool cached(const std::string& options, const std::string& output = "a.npz") const {
    const Json json = done(words("compute mesh.obj -o " + output + " -f --cache kept --json " + options)).json();
    return json["cached"];
  }
  // The only file with that extension.
  fs::path entry(const std::string& extension) const {
    fs::path found;
    for (const auto& file : fs::recursive_directory_iterator(folder / "kept"))
      if (file.path().extension() == extension) found = file.path();
    return found;
  }
};

TEST_F(Cache, ComputesOnce) {
  const std::string options = "-r 24 -t 3s";
  EXPECT_FALSE(cached(options));
  const std::string made = read_bytes(folder / "a.npz");
  EXPECT_TRUE(cached(options));
  EXPECT_EQ(read_bytes(folder / "a.npz"), made);
  EXPECT_TRUE(cached(options, "b.npz"));
  EXPECT_EQ(read_bytes(folder / "b.npz"), made);
  // What is said is what was said then.
  const auto told = [&](const char* output) {
    Json json = done(words("compute mesh.obj -r 20 -o " + std::string(output) + " --cache kept --json")).json();
    for (const char* key : {"seconds", "output", "cached", "peak_memory_bytes"}) json.erase(key);
    return json;
  };
  EXPECT_EQ(told("c.vti"), told("d.vti"));
  done(words("compute mesh.obj -r 24 -t 3s -o plain.npz"));
  EXPECT_EQ(read_bytes(folder / "plain.npz"), made);
  EXPECT_TRUE(run(words("compute mesh.obj -r 24 -t 3s -o e.npz --cache kept")).says("e.npz: "));
}

TEST_F(Cache, AskedForSomethingElse) {
  EXPECT_FALSE(cached("-r 24 -t 3s"));
  for (const char* options : {"-r 25 -t 3s", "-r 24 -t 2s", "-r 24 -t 3s --sign none", "-r 24 -t 3s --invert",
                              "-r 24 -t 3s --scale 2", "-r 24 -t 3s --uncompressed", "-r 24 -t 3s --method propagate"})
    EXPECT_FALSE(cached(options)) << options;
  EXPECT_FALSE(cached("-r 24 -t 3s", "a.nrrd"));
  write("mesh.obj", octahedron(2));
  EXPECT_FALSE(cached("-r 24 -t 3s"));
  write("mesh.obj", "# another file of the same mesh\n" + octahedron());
  EXPECT_TRUE(cached("-r 24 -t 3s"));
  EXPECT_TRUE(cached("-r 24 -t 3s --device cpu -j 1 --memory-limit none"));
}

TEST_F(Cache, ADamagedEntryIsMadeAgain) {
  EXPECT_FALSE(cached("-r 24"));
  const std::string made = read_bytes(folder / "a.npz");
  fs::remove(folder / "a.npz");  // it is a second name of the entry
  std::string damaged = made;
  damaged[damaged.size() / 2] ^= 1;
  for (const auto& [extension, bytes] : {std::pair{".npz", damaged},
                                         {".npz", made.substr(0, 100)},
                                         {".npz", std::string()},
                                         {".json", std::string("{")},
                                         {".json", std::string("{\"key\":1}")},
                                         {".json", std::string()}}) {
    write_bytes(entry(extension), bytes);
    const Ran ran = done(words("compute mesh.obj -o a.npz -f --cache kept --json -q -r 24"));
    EXPECT_EQ(ran.json()["cached"], false) << extension << " of " << bytes.size() << " bytes";
    EXPECT_TRUE(ran.says(" is damaged; the field is computed and kept anew")) << ran.err;
    EXPECT_EQ(read_bytes(folder / "a.npz"), made);
    EXPECT_FALSE(done(words("compute mesh.obj -o a.npz -f --cache kept -r 24")).says("damaged"));
    EXPECT_TRUE(cached("-r 24"));
    fs::remove(folder / "a.npz");
  }
  for (const char* extension : {".npz", ".json"}) {
    fs::remove(entry(extension));
    const Ran ran = done(words("compute mesh.obj -o a.npz -f --cache kept --json -r 24"));
    EXPECT_EQ(ran.json()["cached"], false);
    EXPECT_FALSE(ran.says("damaged")) << ran.err;  // somebody has removed it
    fs::remove(folder / "a.npz");
  }
}

// They make the same field at the same time, and the same entry.
TEST_F(Cache, ManyWriters) {
  std::deque<Process> writers;
  for (int n = 0; n < 8; ++n)
    writers.emplace_back(words("compute mesh.obj -r 24 --cache kept -q -o " + std::to_string(n) + ".npz"), setup());
  for (Process& writer : writers) EXPECT_EQ(writer.wait().code, 0);
  EXPECT_TRUE(cached("-r 24"));
  const std::string made = read_bytes(folder / "a.npz");
  for (int n = 0; n < 8; ++n) EXPECT_EQ(read_bytes(folder / (std::to_string(n) + ".npz")), made);
  std::size_t entries = 0;
  for (const auto& file : fs::recursive_directory_iterator(folder / "kept")) entries += file.is_regular_file();
  EXPECT_EQ(entries, 2u);
}

TEST_F(Cache, BatchesShareIt) {
  write_meshes(4);
  done(words("batch list.txt -o first -r 20 -t 2s --cache kept"));
  for (const Json& row : rows("first/manifest.jsonl")) EXPECT_EQ(row["cached"], false);
  done(words("batch list.txt -o second -r 20 -t 2s --cache kept"));
  for (const Json& row : rows("second/manifest.jsonl")) {
    EXPECT_EQ(row["cached"], true);
    EXPECT_EQ(row["sign"]["method"], "winding");
  }
  EXPECT_EQ(files("first/fields"), files("second/fields"));
  write("mesh.obj", octahedron());
  EXPECT_TRUE(cached("-r 20 -t 2s"));  // mesh-0 is this one
}

TEST_F(Cache, WhatCannotBe) {
  write("file", "");
  const auto refused = [&](const std::string& line, int code, const std::string& part) {
    const Ran ran = run(words(line));
    EXPECT_EQ(ran.code, code) << line << ": " << ran.err;
    EXPECT_TRUE(ran.says(part)) << line << ": " << ran.err;
  };
  refused("compute mesh.obj -o a.vti --cache file", 4, "file: cannot make the folder of the cache");
  refused("compute mesh.obj -o a.vti --cache kept --with closest", 2, "--cache: it keeps distances alone");
  refused("batch mesh.txt -o out --points 9 --cache kept", 2, "--cache keeps fields");
  // A cache that cannot be written takes nothing away.
  fs::create_directories(folder / "kept");
  auto how = setup();
  how.file_size = 30'000;
  ASSERT_EQ(run(words("compute mesh.obj -o a.npz -r 20 --cache kept -q"), how).code, 0);
  EXPECT_TRUE(fs::exists(folder / "a.npz"));
}

}  // namespace
}  // namespace standoff::testing
