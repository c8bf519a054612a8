// SPDX-License-Identifier: Apache-2.0
// Signals, full disks, closed pipes and terminals: nothing half-written stays, whatever happens.
#include <gtest/gtest.h>
#include <stdlib.h>
#include <sys/stat.h>

#include <algorithm>
#include <chrono>
#include <deque>
#include <filesystem>
#include <iterator>
#include <thread>

#include "tests/cli/program.h"

namespace standoff::testing {
namespace {

// Would take hours: Algorithm 1 tests every triangle at every sample of a full field. Little memory.
const Arguments kEndless = words("compute scene:sphere:200000 -r 300 --method thesis --skip none -o a.vti -f");

class Interrupt : public ProgramTest {
 protected:
  // Started, and so far that the computation has begun or is about to.
  Process& started(const Process::Setup& how) {
    process_.emplace(kEndless, how);
    EXPECT_TRUE(process_->wait_for("full field\n"));
    std::this_thread::sleep_for(std::chrono::milliseconds(50));
    return *process_;
  }

 private:
  std::optional<Process> process_;
};

TEST_F(Interrupt, SignalsEndItWithoutATrace) {
  write_bytes(folder / "a.vti", "mine");
  for (const int signal : {SIGINT, SIGTERM, SIGHUP}) {
    Process& process = started(setup());
    process.send(signal);
    const Ran ran = process.wait();
    EXPECT_EQ(ran.code, 130) << ran.err;
    EXPECT_TRUE(ran.says("standoff: error: interrupted")) << ran.err;
    EXPECT_EQ(ran.out, "");
    EXPECT_EQ(folder.names(), std::set<std::string>{"a.vti"});
    EXPECT_EQ(read_bytes(folder / "a.vti"), "mine");
  }
}

TEST_F(Interrupt, SecondSignalEndsItAtOnce) {
  Process& process = started(setup());
  process.send(SIGINT);
  process.send(SIGTERM);
  EXPECT_EQ(process.wait().code, 130);
  EXPECT_TRUE(folder.names().empty());
}

// Two signals that arrive together, for the program was stopped: the first asks it to end, the second ends it, and only
// one of them says so.
TEST_F(Interrupt, TwoSignalsAreOneMessage) {
  Process& process = started(setup());
  process.send(SIGSTOP);
  process.send(SIGINT);
  process.send(SIGTERM);
  process.send(SIGCONT);
  const Ran ran = process.wait();
  EXPECT_EQ(ran.code, 130);
  const auto first = ran.err.find("interrupted");
  ASSERT_NE(first, std::string::npos) << ran.err;
  EXPECT_EQ(ran.err.find("interrupted", first + 1), std::string::npos) << ran.err;
}

// What a mapped field brings that another program shortens. It was the end without a word.
TEST_F(Interrupt, ALostFileIsAnInputError) {
  Process& process = started(setup());
  process.send(SIGBUS);
  const Ran ran = process.wait();
  EXPECT_EQ(ran.code, 3);
  EXPECT_TRUE(ran.says("standoff: error: a file that was being read became shorter")) << ran.err;
  EXPECT_TRUE(folder.names().empty());
}

TEST_F(Interrupt, KilledLeavesNothing) {
  Process& process = started(setup());
  process.send(SIGKILL);
  EXPECT_EQ(process.wait().code, 128 + SIGKILL);
  EXPECT_TRUE(folder.names().empty());
}

TEST_F(Interrupt, NohupIsHonoured) {
  auto how = setup();
  how.ignore_hangup = true;
  Process& process = started(how);
  process.send(SIGHUP);
  process.send(SIGTERM);
  const Ran ran = process.wait();
  EXPECT_EQ(ran.code, 130);  // of SIGTERM: one line, for a second signal would have given another
  EXPECT_TRUE(folder.names().empty());
}

// The field is written while it is computed: some of its file is there when the signal comes.
TEST_F(Interrupt, InTheMiddleOfSlabs) {
  write_bytes(folder / "a.vti", "mine");
  for (const int signal : {SIGINT, SIGTERM, SIGKILL}) {
    Process process(words("compute scene:sphere --size 1024,1024,900 --sign winding -o a.vti -f"), setup());
    EXPECT_TRUE(process.wait_for("full field\n"));
    std::this_thread::sleep_for(std::chrono::milliseconds(200));
    process.send(signal);
    EXPECT_EQ(process.wait().code, signal == SIGKILL ? 128 + SIGKILL : 130);
    EXPECT_EQ(folder.names(), std::set<std::string>{"a.vti"});
    EXPECT_EQ(read_bytes(folder / "a.vti"), "mine");
  }
}

// While it writes into a pipe that nobody reads, a signal must not have to wait.
TEST_F(Interrupt, WhileWriting) {
  ASSERT_EQ(::mkfifo((folder / "pipe.nrrd").c_str(), 0600), 0);
  const int reader = ::open((folder / "pipe.nrrd").c_str(), O_RDONLY | O_NONBLOCK | O_CLOEXEC);
  ASSERT_GE(reader, 0);
  Process process(words("compute scene:box -r 100 -o pipe.nrrd"), setup());
  pollfd ready{reader, POLLIN, 0};
  ASSERT_EQ(::poll(&ready, 1, 60'000), 1);
  process.send(SIGINT);
  const Ran ran = process.wait();
  ::close(reader);
  EXPECT_EQ(ran.code, 130) << ran.err;
  EXPECT_TRUE(ran.says("standoff: error: interrupted")) << ran.err;
}

// What is said of an interrupt that comes after the file took its name: five kills of 260 were told that nothing was
// left, and to run it again. A full pipe in place of stdout holds the program at that place.
TEST_F(Interrupt, AfterTheFileWasCompletedSaysSo) {
  int ends[2];
  ASSERT_EQ(::pipe2(ends, O_CLOEXEC | O_NONBLOCK), 0);
  const std::string filling(1 << 16, '.');
  while (::write(ends[1], filling.data(), filling.size()) > 0 || ::write(ends[1], ".", 1) > 0) {
  }
  ::fcntl(ends[1], F_SETFL, 0);
  for (const std::string command : {"compute scene:box -r 20 -o a.vti --json", "generate sphere -o a.ply --json",
                                    "surface scene:box -r 20 -o a.stl --json", "convert scene:box -o a.obj --json",
                                    "voxels scene:box -r 20 -o a.npz --json", "build scene:box -o a.body --json",
                                    "points scene:box points.csv -o a.npy --json",
                                    "collide scene:box scene:box --poses points.csv -o a.csv --json"}) {
    write_bytes(folder / "points.csv", "1,2,3\n");
    auto how = setup();
    how.out = ends[1];
    const auto parts = words(command);
    const std::string name = *(std::ranges::find(parts, "-o") + 1);
    Process process(parts, how);
    while (!std::filesystem::exists(folder / name)) std::this_thread::sleep_for(std::chrono::milliseconds(1));
    process.send(SIGINT);
    const Ran ran = process.wait();
    EXPECT_EQ(ran.code, 130) << command << "\n" << ran.err;
    EXPECT_TRUE(ran.says("standoff: error: interrupted after " + name + " was written, which is complete")) << ran.err;
    EXPECT_FALSE(ran.says("run it again")) << ran.err;
    std::filesystem::remove(folder / name);
    EXPECT_EQ(folder.names(), std::set<std::string>{"points.csv"}) << command;
  }
  ::close(ends[0]);
  ::close(ends[1]);
}

// The first of two files was written, and the second one's samples are being computed: both are named.
TEST_F(Interrupt, BetweenTwoFilesSaysThatOneIsMissing) {
  Process process(words("compute scene:terrain:20000 --sign winding --confidence b.vti -r 160 -t 2s -o a.vti"),
                  setup());
  while (!std::filesystem::exists(folder / "a.vti")) std::this_thread::sleep_for(std::chrono::milliseconds(1));
  process.send(SIGINT);
  const Ran ran = process.wait();
  EXPECT_EQ(ran.code, 130) << ran.err;
  EXPECT_TRUE(
      ran.says("interrupted after a.vti was written, which is complete; no partial file was left, but b.vti was "
               "not written, run it again"))
      << ran.err;
  EXPECT_EQ(folder.names(), std::set<std::string>{"a.vti"});
}

// Two signals end the drawing of pictures in the middle: the folder that they wait in goes too.
TEST_F(Interrupt, TwiceWhilePicturesAreDrawn) {
  Process process(words("fly --steps 5000 -o frames/"), setup());
  const auto drawing = [&] {
    for (const auto& entry : std::filesystem::directory_iterator(folder.path()))
      if (entry.path().filename().string().starts_with(".standoff-"))
        return std::distance(std::filesystem::directory_iterator(entry), {}) > 2;
    return false;
  };
  while (!drawing()) std::this_thread::sleep_for(std::chrono::milliseconds(1));
  process.send(SIGSTOP);
  process.send(SIGINT);
  process.send(SIGTERM);
  process.send(SIGCONT);
  const Ran ran = process.wait();
  EXPECT_EQ(ran.code, 130) << ran.err;
  EXPECT_TRUE(ran.says("interrupted; no partial file was left, run it again")) << ran.err;
  EXPECT_TRUE(folder.names().empty()) << *folder.names().begin();
}

// A pipe without a writer, or without a reader, was waited for forever and without a word.
TEST_F(Interrupt, APipeWithoutAnOtherEndIsWaitedForAloud) {
  for (const char* name : {"pipe.stl", "pipe.vti", "pipe.body", "pipe.query", "pipe.csv", "pipe.npy", "out.csv"})
    ASSERT_EQ(::mkfifo((folder / name).c_str(), 0600), 0);
  const std::vector<std::string> commands{"info pipe.stl",
                                          "info pipe.vti -q",
                                          "compute pipe.stl -o a.vti",
                                          "slice pipe.vti -o a.png",
                                          "collide pipe.body scene:box",
                                          "points pipe.query pipe.csv",
                                          "points scene:box pipe.npy",
                                          "distance scene:box scene:box --poses pipe.csv",
                                          "render pipe.csv -o a.png",
                                          "view pipe.stl -o a.html",
                                          "points scene:box - -o out.csv"};
  std::deque<Process> processes;  // they wait side by side
  for (const std::string& command : commands) processes.emplace_back(words(command), setup());
  for (std::size_t n = 0; n < commands.size(); ++n) {
    const std::string& command = commands[n];
    Process& process = processes[n];
    EXPECT_TRUE(process.wait_for("waiting for a program to ")) << command;
    process.send(SIGINT);
    const Ran ran = process.wait();
    EXPECT_EQ(ran.code, 130) << command << "\n" << ran.err;
    const std::string pipe = command.ends_with("out.csv") ? "out.csv" : "pipe.";
    EXPECT_TRUE(ran.says("standoff: warning: " + pipe)) << ran.err;
    EXPECT_TRUE(ran.says("interrupted")) << ran.err;
  }
}

// Whoever writes to one is read, however late.
TEST_F(Interrupt, APipeIsReadWheneverItsWriterComes) {
  ASSERT_EQ(::mkfifo((folder / "pipe.csv").c_str(), 0600), 0);
  Process process(words("points scene:box pipe.csv -q"), setup());
  EXPECT_TRUE(process.wait_for("waiting for a program to write to it"));
  write_bytes(folder / "pipe.csv", "5,0,0\n");
  EXPECT_EQ(process.wait().out, "distance\n4\n");
}

TEST_F(Interrupt, Verify) {
  ASSERT_EQ(run(words("compute scene:fly -r 100 -o a.vti")).code, 0);
  Process process(words("verify a.vti scene:soup:2000000 --samples 1000000000 -j 2"), setup());
  std::this_thread::sleep_for(std::chrono::milliseconds(200));
  process.send(SIGINT);
  EXPECT_EQ(process.wait().code, 130);
}

// A full disk, met while writing.
TEST_F(Interrupt, FullDisk) {
  ASSERT_EQ(::symlink("/dev/full", (folder / "full.nrrd").c_str()), 0);
  const Ran ran = refused(words("compute scene:box -r 40 -o full.nrrd"), 4, "standoff: error: full.nrrd: ");
  EXPECT_TRUE(ran.says("no space left")) << ran.err;
}

TEST_F(Interrupt, FileSizeLimit) {
  auto how = setup();
  how.file_size = 40'000;  // the fields are compressed
  for (const std::string command :
       {"compute scene:box -r 60 -o a.vti", "compute scene:box -r 60 -o a.nrrd", "compute scene:box -r 60 -o a.npz",
        "generate sphere -o a.ply", "generate sphere -o a.stl", "generate sphere -o a.obj"}) {
    refused(words(command), how, 4, "standoff: error: a.");
    EXPECT_TRUE(folder.names().empty()) << command;
  }
}

TEST_F(Interrupt, StandardOutputClosedOrFull) {
  {
    Process process(words("generate --list"), setup());
    process.close_out();
    const Ran ran = process.wait();
    EXPECT_TRUE(ran.code == 0 || ran.code == 4) << ran.code;  // 0 when it was faster than we
  }
  auto how = setup();
  how.out = ::open("/dev/full", O_WRONLY | O_CLOEXEC);
  const Ran ran = run(words("info scene:box --json"), how);
  ::close(how.out);
  EXPECT_EQ(ran.code, 4);
  EXPECT_TRUE(ran.says("standoff: error: standard output: ")) << ran.err;
}

// As `standoff ... | head` has it: who reads no more has what it wanted, and needs no message.
TEST_F(Interrupt, BrokenPipeEndsWithoutAMessage) {
  int ends[2];
  ASSERT_EQ(::pipe2(ends, O_CLOEXEC), 0);
  ::close(ends[0]);
  auto how = setup();
  how.out = ends[1];
  ASSERT_EQ(::symlink("/dev/full", (folder / "full.nrrd").c_str()), 0);
  write_bytes(folder / "points.csv", "1,2,3\n");
  for (const std::string line :
       {"info scene:box --json", "points scene:box points.csv -q", "compute scene:box -r 9 -o a.vti -q --json"}) {
    const Ran ran = run(words(line), how);
    EXPECT_EQ(ran.code, 4) << line << "\n" << ran.err;
    EXPECT_EQ(ran.err, "") << line;
  }
  EXPECT_TRUE(folder.names().contains("a.vti"));
  EXPECT_TRUE(run(words("compute scene:box -r 9 -o full.nrrd"), how).says("standoff: error: full.nrrd: "))
      << "another output that fails";
  ::close(ends[1]);
}

// A pseudo-terminal for stderr: the bar is drawn there, and wiped away.
class Terminal : public Interrupt {
 protected:
  std::string said_on_a_terminal(const Arguments& arguments, int signal_after_bar, const char* bar = " % ") const {
    const int terminal = ::posix_openpt(O_RDWR | O_NOCTTY | O_CLOEXEC);
    auto how = setup();
    if (terminal >= 0 && ::grantpt(terminal) == 0 && ::unlockpt(terminal) == 0)
      how.err = ::open(::ptsname(terminal), O_RDWR | O_NOCTTY | O_CLOEXEC);
    // Without one a program that waits for its signal would wait for hours.
    if (how.err < 0) {
      ADD_FAILURE() << "no pseudo-terminal (in a new root: mount -t devpts devpts /dev/pts)";
      return {};
    }
    Process process(arguments, how);
    ::close(how.err);
    std::string said;
    char buffer[1024];
    // The read fails once the program has gone.
    for (ssize_t count; (count = ::read(terminal, buffer, sizeof buffer)) > 0;) {
      said.append(buffer, static_cast<std::size_t>(count));
      if (signal_after_bar != 0 && said.find(bar) != std::string::npos)
        process.send(std::exchange(signal_after_bar, 0));
    }
    process.wait();
    ::close(terminal);
    return said;
  }
};

TEST_F(Terminal, HasABar) {
  const std::string said = said_on_a_terminal(kEndless, SIGINT);
  EXPECT_NE(said.find("....]"), std::string::npos) << said;
  // Wiped before the last word.
  EXPECT_NE(said.find("\r\033[Kstandoff: error: interrupted"), std::string::npos) << said;
}

// Files are read and written for long without a word from the library: a pipe that nobody serves, forever.
TEST_F(Terminal, SaysWhatItWaitsFor) {
  ASSERT_EQ(::mkfifo((folder / "pipe.stl").c_str(), 0600), 0);
  ASSERT_EQ(::mkfifo((folder / "pipe.nrrd").c_str(), 0600), 0);
  const int reader = ::open((folder / "pipe.nrrd").c_str(), O_RDONLY | O_NONBLOCK | O_CLOEXEC);
  for (const char* command : {"info pipe.stl", "compute pipe.stl -o a.vti", "convert pipe.stl -o a.ply"}) {
    const std::string said = said_on_a_terminal(words(command), SIGINT, "reading pipe.stl, ");
    EXPECT_NE(said.find("\r\033[Kreading pipe.stl, "), std::string::npos) << said;
    EXPECT_NE(said.find("\r\033[Kstandoff: error: interrupted"), std::string::npos) << said;
  }
  const std::string said =
      said_on_a_terminal(words("compute scene:box -r 100 -o pipe.nrrd"), SIGINT, "writing pipe.nrrd, ");
  EXPECT_NE(said.find("\r\033[Kwriting pipe.nrrd, "), std::string::npos) << said;
  EXPECT_NE(said.find("\r\033[Kstandoff: error: interrupted"), std::string::npos) << said;
  ::close(reader);
}

TEST_F(Terminal, HasNoneWhenAskedSo) {
  for (const std::string option : {"-q", "--progress=never"}) {
    auto arguments = words("compute scene:sphere -r 200 --method thesis -t 10s");
    arguments.push_back(option);
    arguments.push_back("-f");
    EXPECT_EQ(said_on_a_terminal(arguments, 0).find(" % "), std::string::npos);
  }
}

}  // namespace
}  // namespace standoff::testing
