// SPDX-License-Identifier: Apache-2.0
// Folders that appear whole or not at all.
#include "files/atomic_folder.h"

#include <gtest/gtest.h>

#include "files/atomic_file.h"
#include "tests/support/expect_error.h"
#include "tests/support/temp_folder.h"

namespace standoff {
namespace {

bool yes(const std::filesystem::path&) noexcept { return true; }
bool no(const std::filesystem::path&) noexcept { return false; }

void fill(const std::filesystem::path& folder, const std::string& text) {
  std::filesystem::create_directories(folder / "a" / "b" / "c");
  write_bytes(folder / "a" / "b" / "c" / "file", text);
  write_bytes(folder / "top", text);
}
std::string text_in(const std::filesystem::path& folder) { return read_bytes(folder / "a" / "b" / "c" / "file"); }

TEST(AtomicFolder, AppearsOnCommit) {
  const TempFolder temp;
  AtomicFolder folder(temp / "new", Existing::keep, no, "ours");
  fill(folder.path(), "one");
  EXPECT_FALSE(std::filesystem::exists(temp / "new"));
  EXPECT_EQ(folder.path().parent_path(), temp.path());
  folder.commit();
  EXPECT_EQ(text_in(temp / "new"), "one");
  EXPECT_EQ(temp.names(), std::set<std::string>{"new"});
  EXPECT_EQ(std::string(finished_file()), (temp / "new").string());
}

TEST(AtomicFolder, LeavesNothingWithoutACommit) {
  const TempFolder temp;
  fill(temp / "old", "old");
  for (const char* name : {"new", "old"}) {
    AtomicFolder folder(temp / name, Existing::replace, yes, "ours");
    fill(folder.path(), "one");
  }
  EXPECT_EQ(temp.names(), std::set<std::string>{"old"});
  EXPECT_EQ(text_in(temp / "old"), "old");
}

TEST(AtomicFolder, ReplacesWhatItMay) {
  const TempFolder temp;
  fill(temp / "old", "old");
  write_bytes(temp / "old" / "more", "gone");
  AtomicFolder folder(temp / "old" / "", Existing::replace, yes, "ours");  // with a slash at its end
  fill(folder.path(), "new");
  EXPECT_EQ(text_in(temp / "old"), "old");
  folder.commit();
  EXPECT_EQ(text_in(temp / "old"), "new");
  EXPECT_FALSE(std::filesystem::exists(temp / "old" / "more"));
  EXPECT_EQ(temp.names(), std::set<std::string>{"old"});
}

TEST(AtomicFolder, FollowsALink) {
  const TempFolder temp;
  std::filesystem::create_directory(temp / "there");
  std::filesystem::create_directory_symlink(temp / "there" / "target", temp / "link");
  AtomicFolder folder(temp / "link", Existing::replace, no, "ours");
  fill(folder.path(), "new");
  folder.commit();
  EXPECT_TRUE(std::filesystem::is_symlink(temp / "link"));
  EXPECT_EQ(text_in(temp / "there" / "target"), "new");
}

TEST(AtomicFolder, RefusesWhatIsNotItsOwn) {
  const TempFolder temp;
  fill(temp / "other", "other");
  write_bytes(temp / "file", "file");
  std::filesystem::create_directory(temp / "empty");
  const auto refused = [&](const std::string& name, Existing existing, const std::string& words) {
    expect_error([&] { AtomicFolder(temp / name, existing, no, "ours"); }, ErrorCode::output, words);
  };
  refused("other", Existing::replace, "other: cannot write it: a folder is there that is not ours; give another name");
  refused("other", Existing::keep, "somebody has written it");
  refused("empty", Existing::keep, "somebody has written it");
  refused("file", Existing::replace, "file: cannot write it: it is a file; give another name");
  refused("none/new", Existing::replace, "does not exist; create it first");
  expect_error([&] { AtomicFolder("", Existing::replace, yes, "ours"); }, ErrorCode::output, "without a name");
  EXPECT_EQ(text_in(temp / "other"), "other");
  AtomicFolder(temp / "empty", Existing::replace, no, "ours").commit();
  EXPECT_EQ(temp.names(), (std::set<std::string>{"empty", "file", "other"}));
}

// Somebody comes between the look and the commit.
TEST(AtomicFolder, LooksAgainOnCommit) {
  const TempFolder temp;
  AtomicFolder kept(temp / "kept", Existing::keep, yes, "ours");
  AtomicFolder replaced(temp / "replaced", Existing::replace, no, "ours");
  fill(temp / "kept", "theirs");
  fill(temp / "replaced", "theirs");
  expect_error([&] { kept.commit(); }, ErrorCode::output, "somebody has written it");
  expect_error([&] { replaced.commit(); }, ErrorCode::output, "a folder is there that is not ours");
  EXPECT_EQ(text_in(temp / "kept"), "theirs");
  EXPECT_EQ(text_in(temp / "replaced"), "theirs");
}

// As a handler of signals does it: folders in folders, and links, which are not followed.
TEST(AtomicFolder, UnfinishedOnesAreRemovedWithAllInThem) {
  const TempFolder temp;
  fill(temp / "mine", "mine");
  AtomicFolder folder(temp / "new", Existing::keep, no, "ours");
  fill(folder.path(), "one");
  for (int n = 0; n < 300; ++n) write_bytes(folder.path() / "a" / std::string(100, 'n').append(std::to_string(n)), "");
  std::filesystem::create_directory_symlink(temp / "mine", folder.path() / "link");
  remove_unfinished_files();
  EXPECT_EQ(temp.names(), std::set<std::string>{"mine"});
  EXPECT_EQ(text_in(temp / "mine"), "mine");
}

}  // namespace
}  // namespace standoff
