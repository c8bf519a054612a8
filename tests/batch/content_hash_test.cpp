// SPDX-License-Identifier: Apache-2.0
#include "batch/content_hash.h"

#include <gtest/gtest.h>
#include <sys/stat.h>

#include <set>
#include <string>

#include "tests/support/temp_folder.h"

namespace standoff {
namespace {

// Every length, every changed byte, and zeros of different numbers have hashes of their own.
TEST(ContentHash, DependsOnEveryByteAndTheLength) {
  std::set<std::uint64_t> hashes;
  std::size_t texts = 0;
  for (std::size_t length = 0; length < 300; ++length) {
    std::string text(length, '\0');
    hashes.insert(content_hash(text)), ++texts;
    for (std::size_t n = 0; n < length; n += 7) {
      text[n] = 1;
      hashes.insert(content_hash(text)), ++texts;
      text[n] = 0;
    }
  }
  EXPECT_EQ(hashes.size(), texts);
}

TEST(ContentHash, EqualWordsInOtherPlacesDiffer) {
  const std::string a(8, 'a'), b(8, 'b');
  std::string text;
  for (int n = 0; n < 32; ++n) text += n % 2 == 0 ? a : b;
  std::string turned;
  for (int n = 0; n < 32; ++n) turned += n % 2 == 0 ? b : a;
  EXPECT_NE(content_hash(text), content_hash(turned));
  EXPECT_NE(content_hash(text + a + b), content_hash(text + b + a));
}

// Manifests and caches of one machine are read on others, and by later versions.
TEST(ContentHash, StaysWhatItIs) {
  EXPECT_EQ(content_hash(std::string_view("")), 0x1f719e0633b26aa4u);
  EXPECT_EQ(content_hash(std::string_view("standoff")), 0xe7492d8485b4ed29u);
  EXPECT_EQ(content_hash(std::string(100, 'x')), 0x5f10db89358e8805u);
}

TEST(ContentHash, OfFiles) {
  const TempFolder folder;
  const std::string text = "v 0 0 0\n";
  EXPECT_EQ(file_hash(folder.file("a.obj", text)), content_hash(text));
  EXPECT_NE(file_hash(folder.file("empty.obj", "")), 0u);
  ASSERT_EQ(::mkfifo((folder / "pipe.obj").c_str(), 0600), 0);
  EXPECT_EQ(file_hash(folder / "pipe.obj"), 0u);
  EXPECT_EQ(file_hash(folder / "missing.obj"), 0u);
}

}  // namespace
}  // namespace standoff
