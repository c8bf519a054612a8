// SPDX-License-Identifier: Apache-2.0
// standoff batch when things go wrong: meshes that end their process, kills, signals, torn files. Nothing is lost but
// what was being worked on, and nothing is done twice.
#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/stat.h>

#include <chrono>
#include <filesystem>
#include <fstream>
#include <functional>
#include <thread>

#include "tests/cli/batch.h"

namespace standoff::testing {
namespace {

namespace fs = std::filesystem;

class BatchFaults : public BatchTest {
 protected:
  // Octahedra, and in their midst a pipe that nobody writes to: a mesh that takes forever.
  void write_meshes_and_a_pipe(int before, int after) const {
    write_meshes(before + after);
    std::string list;
    for (int n = 0; n < before + after; ++n) {
      if (n == before) list += "pipe.obj\n";
      list += "mesh-" + std::to_string(n) + ".obj\n";
    }
    write("list.txt", list);
    ASSERT_EQ(::mkfifo((folder / "pipe.obj").c_str(), 0600), 0);
  }

  static void wait_until(const std::function<bool()>& holds) {
    for (int n = 0; n < 20'000 && !holds(); ++n) std::this_thread::sleep_for(std::chrono::milliseconds(1));
    EXPECT_TRUE(holds());
  }
  // Until so many rows are there.
  void wait_for_rows(std::size_t count) const {
    wait_until([&] { return fs::exists(folder / "out/manifest.jsonl") && rows().size() >= count; });
  }

  // The processes that a process has started.
  static std::vector<pid_t> children_of(pid_t process) {
    std::ifstream file("/proc/" + std::to_string(process) + "/task/" + std::to_string(process) + "/children");
    std::vector<pid_t> found;
    for (pid_t child; file >> child;) found.push_back(child);
    return found;
  }
  static bool is_running(pid_t process) {
    std::ifstream file("/proc/" + std::to_string(process) + "/stat");
    std::string word;
    return (file >> word >> word >> word) && word != "Z";
  }

  static constexpr const char* kRun = "batch list.txt -o out -r 20 -t 2s -j 1";
};

TEST_F(BatchFaults, AMeshThatTakesTooLong) {
  write_meshes_and_a_pipe(2, 2);
  for (const char* workers : {"1", "2"}) {
    const Ran ran = run(words(std::string("batch list.txt -o out -r 20 -f --timeout 0.5 -j ") + workers));
    EXPECT_EQ(ran.code, 3) << ran.err;
    auto found = last_rows();
    EXPECT_EQ(found.size(), 5u);
    EXPECT_EQ(found["pipe.obj"]["status"], "limit");
    EXPECT_EQ(found["pipe.obj"]["message"],
              "pipe.obj: it took longer than --timeout 0.5; allow more, or take fewer samples");
    EXPECT_EQ(found["mesh-3.obj"]["status"], "ok");
    EXPECT_EQ(rows().size(), 5u);
  }
}

TEST_F(BatchFaults, AMeshThatEndsItsProcess) {
  write_meshes_and_a_pipe(2, 2);
  struct Death {
    int signal;
    const char* status;
    const char* message;
  };
  for (const Death& test :
       {Death{SIGKILL, "limit", "ended by signal 9"}, Death{SIGTERM, "limit", "ended by signal 15"},
        Death{SIGSEGV, "internal", "ended by signal 11"}, Death{SIGABRT, "internal", "ended by signal 6"}}) {
    fs::remove_all(folder / "out");
    Process process(words(kRun), setup());
    wait_for_rows(2);
    std::vector<pid_t> workers;
    wait_until([&] { return (workers = children_of(process.pid())).size() == 1; });
    ::kill(workers.at(0), test.signal);
    EXPECT_EQ(process.wait().code, 3);
    auto found = last_rows();
    EXPECT_EQ(rows().size(), 5u);
    EXPECT_EQ(found["pipe.obj"]["status"], test.status) << found["pipe.obj"];
    EXPECT_NE(found["pipe.obj"]["message"].get<std::string>().find(test.message), std::string::npos);
    EXPECT_EQ(found["mesh-2.obj"]["status"], "ok");
    EXPECT_EQ(found["mesh-3.obj"]["status"], "ok");
  }
}

// Memory that the system does not give ends the mesh, whatever the limit says. It waits to be alone with the next one
// behind it.
#ifndef STANDOFF_SANITIZED
TEST_F(BatchFaults, AMeshWithoutMemory) {
  write("list.txt", "scene:box\nscene:sphere:4000000\nscene:fly\n");
  auto how = setup();
  how.memory = rlim_t{256} << 20;
  EXPECT_EQ(run(words("batch list.txt -o out -r 20 -j 1 --memory-limit none"), how).code, 3);
  auto found = last_rows();
  EXPECT_EQ(found["scene:box"]["status"], "ok");
  EXPECT_EQ(found["scene:sphere:4000000"]["status"], "limit") << found["scene:sphere:4000000"];
  EXPECT_EQ(found["scene:fly"]["status"], "ok");
}
#endif

TEST_F(BatchFaults, ResumesAfterAKill) {
  write_meshes_and_a_pipe(4, 3);
  write("empty.txt", "\n");
  pid_t worker = 0;
  {
    Process process(words(kRun), setup());
    wait_for_rows(4);
    wait_until([&] { return children_of(process.pid()).size() == 1; });
    worker = children_of(process.pid()).at(0);
    process.send(SIGKILL);
    EXPECT_EQ(process.wait().code, 128 + SIGKILL);
  }
  // It left no lock, whatever its worker still does; and no worker outlives its pool for long.
  EXPECT_EQ(run(words("batch empty.txt -o out -r 20 --resume")).code, 3);
  wait_until([&] { return !is_running(worker); });
  ASSERT_EQ(rows().size(), 4u);
  EXPECT_FALSE(fs::exists(folder / "out/summary.json"));
  std::map<std::string, fs::file_time_type> times;
  for (const Json& row : rows()) {
    const std::string file = row["output"]["file"];
    times[file] = fs::last_write_time(folder / ("out/" + file));
  }
  fs::remove(folder / "pipe.obj");
  write("pipe.obj", octahedron());

  EXPECT_TRUE(done(words(std::string(kRun) + " --resume")).says("4 meshes: 4 ok; 4 were done before"))
      << run(words(kRun)).err;
  EXPECT_EQ(rows().size(), 8u);  // no mesh has two
  EXPECT_EQ(last_rows().size(), 8u);
  for (const auto& [file, time] : times) EXPECT_EQ(fs::last_write_time(folder / ("out/" + file)), time) << file;
  const auto resumed = files("out/fields");
  done(words("batch list.txt -o whole -r 20 -t 2s -j 2"));
  EXPECT_EQ(resumed, files("whole/fields"));
}

TEST_F(BatchFaults, ResumeDoesWhatHasChanged) {
  write_meshes(4);
  write("mesh-3.obj", "no mesh\n");
  EXPECT_EQ(run(words(kRun)).code, 3);
  const std::string resume = std::string(kRun) + " --resume";
  const auto outputs = last_rows();
  write("mesh-0.obj", octahedron(9));
  fs::remove(folder / ("out/" + outputs.at("mesh-1.obj")["output"]["file"].get<std::string>()));
  Ran ran = run(words(resume));
  EXPECT_EQ(ran.code, 3);
  EXPECT_TRUE(ran.says("3 meshes: 2 ok, 1 input; 1 were done before")) << ran.err;  // not mesh-2
  EXPECT_EQ(rows().size(), 7u);
  // Cut short, as a loss of power may leave it.
  fs::resize_file(folder / ("out/" + outputs.at("mesh-2.obj")["output"]["file"].get<std::string>()), 10);
  write("mesh-3.obj", octahedron());
  EXPECT_TRUE(done(words(resume)).says("2 meshes: 2 ok; 2 were done before"));
  EXPECT_TRUE(done(words(resume)).says("0 meshes: none; 4 were done before"));
  // Other options, other results.
  EXPECT_TRUE(done(words("batch list.txt -o out -r 21 -t 2s --resume")).says("4 meshes: 4 ok; in"));
}

// Rows say where in the list a mesh is, and parts are merged by that: it must be its place in the list of today.
TEST_F(BatchFaults, ResumesWithAnotherList) {
  write_meshes(6);
  const auto run_parts = [&](const char* list) {
    std::string said;
    for (const char* part : {"1/2", "2/2"})
      said += done({"batch", list, "-o", "out", "-r", "20", "--resume", "--shard", part}).err;
    done(words("batch --merge -o out"));
    std::string paths;
    const std::vector<Json> merged = rows();
    for (std::size_t n = 0; n < merged.size(); ++n) {
      EXPECT_EQ(merged[n]["index"], n);
      paths += merged[n]["path"].get<std::string>() + "\n";
    }
    EXPECT_EQ(paths, read_bytes(folder / list));
    return said;
  };
  run_parts("list.txt");
  write("shorter.txt", "mesh-4.obj\nmesh-1.obj\nmesh-0.obj\n");  // 4 and 0 stay in part 1, at other places
  EXPECT_NE(run_parts("shorter.txt").find("2 were done before"), std::string::npos);
  write("other.txt", "mesh-2.obj\nmesh-5.obj\nmesh-4.obj\nmesh-3.obj\n");
  run_parts("other.txt");
  EXPECT_NE(run_parts("list.txt").find("3 were done before"), std::string::npos);
}

TEST_F(BatchFaults, AResultOfNoBytesIsNone) {
  write_meshes(1);
  done(words(kRun));
  Json row = rows().at(0);
  fs::remove(folder / ("out/" + row["output"]["file"].get<std::string>()));
  row["output"]["bytes"] = 0;
  row["output"]["hash"] = "0000000000000000";
  write("out/manifest.jsonl", row.dump() + "\n");
  EXPECT_TRUE(done(words(std::string(kRun) + " --resume")).says("1 mesh: 1 ok; in "));
  EXPECT_EQ(files("out/fields").size(), 1u);
}

TEST_F(BatchFaults, RetryTakesFailedMeshesAlone) {
  write_meshes(3);
  write("mesh-1.obj", "no mesh\n");
  EXPECT_EQ(run(words(kRun)).code, 3);
  write("mesh-0.obj", octahedron(9));
  write("mesh-1.obj", octahedron());
  EXPECT_TRUE(done(words(std::string(kRun) + " --retry failed")).says("1 mesh: 1 ok; 2 were done before"));
  EXPECT_EQ(rows().back()["path"], "mesh-1.obj");
}

TEST_F(BatchFaults, ATornRowIsNoRow) {
  write_meshes(3);
  done(words(kRun));
  const std::string whole = read_bytes(folder / "out/manifest.jsonl");
  write("out/manifest.jsonl", whole.substr(0, whole.size() - 40));
  EXPECT_TRUE(done(words(std::string(kRun) + " --resume")).says("1 mesh: 1 ok; 2 were done before"));
  EXPECT_EQ(rows().size(), 3u);
  EXPECT_EQ(last_rows().size(), 3u);
  // In the middle it is somebody else's doing.
  write("out/manifest.jsonl", whole + "{\"index\":\n" + whole);
  refused(words(std::string(kRun) + " --resume"), 3, "out/manifest.jsonl:line 4: this is no row of a manifest");
}

TEST_F(BatchFaults, OneProcessWritesAManifest) {
  write_meshes_and_a_pipe(1, 1);
  Process first(words(kRun), setup());
  wait_for_rows(1);
  refused(words(std::string(kRun) + " --resume"), 4, "another standoff batch is writing it");
  EXPECT_EQ(rows().size(), 1u);
}

TEST_F(BatchFaults, SignalsStopIt) {
  write_meshes_and_a_pipe(2, 2);
  for (const int signal : {SIGINT, SIGTERM}) {
    fs::remove_all(folder / "out");
    Process process(words(kRun), setup());
    wait_for_rows(2);
    std::vector<pid_t> workers;
    wait_until([&] { return (workers = children_of(process.pid())).size() == 1; });
    process.send(signal);
    const Ran ran = process.wait();
    EXPECT_EQ(ran.code, 130) << ran.err;
    EXPECT_TRUE(
        ran.says("standoff: error: interrupted; no partial file was left, 2 rows are written: the same command "
                 "with --resume goes on from here\n"))
        << ran.err;
    EXPECT_FALSE(is_running(workers.at(0)));
    EXPECT_EQ(rows().size(), 2u);
    EXPECT_EQ(files("out/fields").size(), 2u);
  }
}

}  // namespace
}  // namespace standoff::testing
