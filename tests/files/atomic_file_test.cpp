// SPDX-License-Identifier: Apache-2.0
// labels: memory threads

#include "files/atomic_file.h"

#include <gtest/gtest.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <atomic>
#include <csignal>
#include <thread>
#include <vector>

#include "tests/support/expect_error.h"
#include "tests/support/temp_folder.h"

namespace standoff {
namespace {

using Names = std::set<std::string>;

void write_text(const std::filesystem::path& path, const std::string& text) {
  AtomicFile file(path);
  file.write(text.data(), text.size());
  file.commit();
}

// Runs `work` in a process of its own, as another user where we are root, and returns its exit status.
template <class Work>
int in_child(bool as_nobody, Work work) {
  const pid_t child = ::fork();
  if (child == 0) {
    if (as_nobody && ::getuid() == 0 && (::setgid(65534) != 0 || ::setuid(65534) != 0)) ::_exit(99);
    work();
    ::_exit(::testing::Test::HasFailure() ? 1 : 0);
  }
  int status = 0;
  ::waitpid(child, &status, 0);
  return WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
}

// Both ways to keep an unfinished file.
class BothKinds : public ::testing::TestWithParam<AtomicFile::Unfinished> {
 protected:
  const TempFolder folder;
};
INSTANTIATE_TEST_SUITE_P(AtomicFile, BothKinds,
                         ::testing::Values(AtomicFile::Unfinished::unnamed_if_possible, AtomicFile::Unfinished::named));

TEST_P(BothKinds, AppearOnCommitAndNotBefore) {
  AtomicFile file(folder / "a", Existing::replace, GetParam());
  file.write("one ", 4);
  file.write("two", 3);
  EXPECT_FALSE(std::filesystem::exists(folder / "a"));
  EXPECT_EQ(file.size(), 7u);
  file.commit();
  EXPECT_EQ(read_bytes(folder / "a"), "one two");
  EXPECT_EQ(folder.names(), Names{"a"});
}

TEST_P(BothKinds, KeepTheOldFileUntilCommit) {
  write_text(folder / "a", "old");
  ASSERT_EQ(::chmod((folder / "a").c_str(), 0640), 0);
  {
    AtomicFile file(folder / "a", Existing::replace, GetParam());
    file.write("new", 3);
    EXPECT_EQ(read_bytes(folder / "a"), "old");
  }
  EXPECT_EQ(read_bytes(folder / "a"), "old");
  EXPECT_EQ(folder.names(), Names{"a"});
  AtomicFile file(folder / "a", Existing::replace, GetParam());
  file.write("new", 3);
  file.commit();
  EXPECT_EQ(read_bytes(folder / "a"), "new");
  EXPECT_EQ(std::filesystem::status(folder / "a").permissions(), std::filesystem::perms{0640});
  EXPECT_EQ(folder.names(), Names{"a"});
}

// Without leave to overwrite, who comes first stays: at the start, and while ours was being written.
TEST_P(BothKinds, LeaveWhatIsToBeKept) {
  write_text(folder / "a", "theirs");
  const std::string told = "a: cannot write it: somebody has written it, and it stays as it is; give another name";
  expect_error([&] { AtomicFile(folder / "a", Existing::keep, GetParam()); }, ErrorCode::output, told);
  std::filesystem::create_symlink("later", folder / "link");
  for (const char* name : {"b", "link"}) {
    AtomicFile file(folder / name, Existing::keep, GetParam());
    file.write("ours", 4);
    write_bytes(folder / (name == std::string("b") ? "b" : "later"), "theirs");
    expect_error([&] { file.commit(); }, ErrorCode::output, "somebody has written it, and it stays");
    EXPECT_EQ(read_bytes(folder / name), "theirs");
  }
  EXPECT_EQ(read_bytes(folder / "a"), "theirs");
  EXPECT_EQ(folder.names(), (Names{"a", "b", "later", "link"}));
  AtomicFile file(folder / "c", Existing::keep, GetParam());
  file.write("ours", 4);
  file.commit();
  EXPECT_EQ(read_bytes(folder / "c"), "ours");
  EXPECT_EQ(folder.names(), (Names{"a", "b", "c", "later", "link"}));
}

// One of many wins, whole; the others are told.
TEST_P(BothKinds, OnlyOneOfManyTakesAFreeName) {
  std::vector<std::thread> threads;
  std::atomic<int> won{0}, lost{0};
  for (int t = 0; t < 8; ++t)
    threads.emplace_back([&, t] {
      const std::string text(1000, static_cast<char>('a' + t));
      try {
        AtomicFile file(folder / "same", Existing::keep, GetParam());
        file.write(text.data(), text.size());
        file.commit();
        ++won;
      } catch (const Error&) {
        ++lost;
      }
    });
  for (auto& thread : threads) thread.join();
  EXPECT_EQ(won, 1);
  EXPECT_EQ(lost, 7);
  const std::string text = read_bytes(folder / "same");
  EXPECT_EQ(text, std::string(1000, text.at(0)));
  EXPECT_EQ(folder.names(), Names{"same"});
}

TEST(AtomicFile, NewFilesObeyTheUmask) {
  const TempFolder folder;
  const mode_t before = ::umask(027);
  write_text(folder / "a", "text");
  ::umask(before);
  EXPECT_EQ(std::filesystem::status(folder / "a").permissions(), std::filesystem::perms{0640});
}

TEST(AtomicFile, WritesSmallAndLargePartsInOrder) {
  const TempFolder folder;
  std::string expected;
  AtomicFile file(folder / "a");
  // Sizes below, at and above the buffer's 256 KiB, one after the other.
  for (const std::size_t size : {1u, 262143u, 262144u, 3u, 262145u, 1000000u, 0u, 100000u, 200000u}) {
    const std::string part(size, static_cast<char>('a' + expected.size() % 26));
    file.write(part.data(), part.size());
    expected += part;
  }
  file.overwrite(2, "XYZ", 3);
  expected.replace(2, 3, "XYZ");
  file.write("end", 3);
  file.commit();
  EXPECT_EQ(read_bytes(folder / "a"), expected + "end");
}

TEST(AtomicFile, FollowsLinks) {
  const TempFolder folder;
  write_text(folder / "target", "old");
  std::filesystem::create_symlink("target", folder / "link");
  write_text(folder / "link", "new");
  EXPECT_TRUE(std::filesystem::is_symlink(folder / "link"));
  EXPECT_EQ(read_bytes(folder / "target"), "new");
}

// What a link promises may not be there yet: it is made where the link says, and the link stays.
TEST(AtomicFile, FollowsLinksToNothing) {
  const TempFolder folder;
  std::filesystem::create_directory(folder / "far");
  std::filesystem::create_symlink("far/second", folder / "first");
  std::filesystem::create_symlink("target", folder / "far/second");
  write_text(folder / "first", "new");
  EXPECT_TRUE(std::filesystem::is_symlink(folder / "first"));
  EXPECT_TRUE(std::filesystem::is_symlink(folder / "far/second"));
  EXPECT_EQ(read_bytes(folder / "far/target"), "new");
  std::filesystem::create_symlink(folder / "missing/a", folder / "lost");
  expect_error([&] { write_text(folder / "lost", "new"); }, ErrorCode::output,
               "the folder " + (folder / "missing").string() + " does not exist");
  std::filesystem::create_symlink("circle", folder / "circle");
  expect_error([&] { write_text(folder / "circle", "new"); }, ErrorCode::output, "circle: cannot write it: ");
}

TEST(AtomicFile, WritesDevicesStraight) {
  const TempFolder folder;
  std::filesystem::create_symlink("/dev/null", folder / "link");
  write_text(folder / "link", "gone");
  EXPECT_TRUE(std::filesystem::is_character_file("/dev/null"));
  EXPECT_TRUE(std::filesystem::is_symlink(folder / "link"));
}

TEST(AtomicFile, WritesRelativeNames) {
  const TempFolder folder;
  EXPECT_EQ(in_child(false,
                     [&] {
                       ASSERT_EQ(::chdir(folder.path().c_str()), 0);
                       AtomicFile file("a");
                       // Where the process goes meanwhile does not matter.
                       ASSERT_EQ(::chdir("/"), 0);
                       file.commit();
                     }),
            0);
  EXPECT_EQ(folder.names(), Names{"a"});
}

TEST(AtomicFile, SaysWhatIsWrongWithTheTarget) {
  const TempFolder folder;
  write_text(folder / "file", "text");
  const auto fails = [](const std::filesystem::path& path, const std::string& words) {
    expect_error([&] { AtomicFile file(path); }, ErrorCode::output, words);
  };
  fails("", "without a name");
  fails(folder.path(), ": it is a folder; give the name of a file");
  fails(folder / "", ": it is a folder; give the name of a file");
  fails(folder / "missing/a", "the folder " + (folder / "missing").string() + " does not exist; create it first");
  fails(folder / "file/a", "is not a folder; choose another place");
  fails(folder / std::string(300, 'n'), "the name is too long; choose a shorter one");
  EXPECT_EQ(folder.names(), Names{"file"});
}

TEST(AtomicFile, NeedsPermission) {
  const TempFolder folder;
  write_text(folder / "mine", "kept");
  ASSERT_EQ(::chmod((folder / "mine").c_str(), 0444), 0);
  std::filesystem::create_directory(folder / "shut");
  ASSERT_EQ(::chmod((folder / "shut").c_str(), 0555), 0);
  ASSERT_EQ(::chmod(folder.path().c_str(), 0777), 0);
  EXPECT_EQ(in_child(true,
                     [&] {
                       for (const char* name : {"mine", "shut/a"})
                         expect_error([&] { AtomicFile file(folder / name); }, ErrorCode::output,
                                      std::string(name) + ": cannot write it: permission denied; choose");
                     }),
            0);
  EXPECT_EQ(read_bytes(folder / "mine"), "kept");
}

TEST(AtomicFile, SaysThatTheDiskIsFull) {
  const TempFolder folder;
  std::filesystem::create_symlink("/dev/full", folder / "a");
  expect_error([&] { write_text(folder / "a", "text"); }, ErrorCode::output,
               "a: cannot write it: no space left on the disk; free some");
}

TEST(AtomicFile, LeavesNothingWhenAWriteFails) {
  const TempFolder folder;
  write_text(folder / "a", "old");
  EXPECT_EQ(in_child(false,
                     [&] {
                       ::signal(SIGXFSZ, SIG_IGN);
                       const rlimit small{100000, 100000};
                       ASSERT_EQ(::setrlimit(RLIMIT_FSIZE, &small), 0);
                       // The limit is hit while writing, and while the buffer is written at commit.
                       expect_error([&] { write_text(folder / "a", std::string(1000000, 'x')); }, ErrorCode::output,
                                    "ulimit -f");
                       expect_error([&] { write_text(folder / "a", std::string(150000, 'x')); }, ErrorCode::output,
                                    "ulimit -f");
                     }),
            0);
  EXPECT_EQ(read_bytes(folder / "a"), "old");
  EXPECT_EQ(folder.names(), Names{"a"});
}

TEST(AtomicFile, PipesAreWrittenButNotRewritten) {
  const TempFolder folder;
  ASSERT_EQ(::mkfifo((folder / "pipe").c_str(), 0600), 0);
  std::string got;
  std::thread reader([&] { got = read_bytes(folder / "pipe"); });
  expect_error(
      [&] {
        AtomicFile file(folder / "pipe");
        file.write("text", 4);
        file.overwrite(0, "T", 1);
      },
      ErrorCode::output, "not a pipe; write to a file");
  reader.join();
  EXPECT_EQ(got, "text");
  EXPECT_EQ(folder.names(), Names{"pipe"});
}

TEST_P(BothKinds, LeaveNoVisibleFileWhenKilled) {
  const int status = in_child(false, [&] {
    AtomicFile file(folder / "a", Existing::replace, GetParam());
    const std::string part(1000000, 'x');
    file.write(part.data(), part.size());
    ::kill(::getpid(), SIGKILL);
  });
  EXPECT_EQ(status, 128 + SIGKILL);
  for (const std::string& name : folder.names()) EXPECT_TRUE(name.starts_with(".standoff-")) << name;
}

TEST(AtomicFile, ManyAtATimeDoNotMeet) {
  const TempFolder folder;
  std::vector<std::thread> threads;
  for (int t = 0; t < 8; ++t)
    threads.emplace_back([&, t] {
      for (int n = 0; n < 20; ++n) write_text(folder / "same", std::string(1000, static_cast<char>('a' + t)));
    });
  for (auto& thread : threads) thread.join();
  const std::string text = read_bytes(folder / "same");
  EXPECT_EQ(text, std::string(1000, text.at(0)));
  EXPECT_EQ(folder.names(), Names{"same"});
}

TEST(UnfinishedFiles, AreRemovedByASignalHandlerAndNeverCommitted) {
  const TempFolder folder;
  write_text(folder / "a", "old");
  AtomicFile file(folder / "a", Existing::replace, AtomicFile::Unfinished::named);
  file.write("new", 3);
  EXPECT_EQ(folder.names().size(), 2u);
  remove_unfinished_files();
  EXPECT_EQ(folder.names(), Names{"a"});
  expect_error([&] { file.commit(); }, ErrorCode::output, "a: cannot write it: ");
  EXPECT_EQ(read_bytes(folder / "a"), "old");
}

TEST(FinishedFile, IsTheLastOneUnlessItIsForgotten) {
  const TempFolder folder;
  write_text(folder / "a", "text");
  ASSERT_NE(finished_file(), nullptr);
  EXPECT_EQ(std::string(finished_file()), (folder / "a").string());
  forget_finished();
  EXPECT_EQ(finished_file(), nullptr);
  write_text(folder / "b", "text");
  EXPECT_EQ(std::string(finished_file()), (folder / "b").string());
}

TEST(UnfinishedFiles, AreRemovedWhileNotedAndNotOtherwise) {
  const TempFolder folder;
  for (const char* name : {"noted", "forgotten", "other"}) write_bytes(folder / name, "text");
  const int noted = note_unfinished(folder / "noted");
  forget_unfinished(note_unfinished(folder / "forgotten"));
  remove_unfinished_files();
  EXPECT_EQ(folder.names(), (Names{"forgotten", "other"}));
  forget_unfinished(noted);
}

TEST(UnfinishedFiles, AFullTableOnlyForgoesNotes) {
  std::vector<int> slots;
  for (int n = 0; n < 40; ++n) slots.push_back(note_unfinished("/nowhere/file"));
  EXPECT_GE(slots.front(), 0);
  EXPECT_EQ(slots.back(), -1);
  for (const int slot : slots) forget_unfinished(slot);
  EXPECT_EQ(note_unfinished(std::string(5000, 'n')), -1);
  const int again = note_unfinished("/nowhere/file");
  EXPECT_GE(again, 0);
  forget_unfinished(again);
}

}  // namespace
}  // namespace standoff
