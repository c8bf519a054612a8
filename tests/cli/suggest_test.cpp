// SPDX-License-Identifier: Apache-2.0
// What the program takes for a typo of what, and what it takes for none.
#include "cli/suggest.h"

#include <gtest/gtest.h>

#include <string>
#include <vector>

namespace standoff::cli {
namespace {

const std::vector<std::string> kOptions{"--output",   "--resolution", "--spacing", "--size",        "--sign",
                                        "--strict",   "--threads",    "--invert",  "--as-oriented", "--memory-limit",
                                        "--progress", "--quiet",      "--outer",   "--padding"};
const std::vector<std::string> kVerbs{"compute",  "batch",    "info",    "slice",  "render",    "view",    "verify",
                                      "generate", "convert",  "surface", "points", "crossings", "voxels",  "build",
                                      "collide",  "distance", "sweep",   "fly",    "devices",   "version", "help"};

struct Typo {
  const char* written;
  std::vector<std::string> meant;
};

void expect_all(const std::vector<std::string>& words, const std::vector<Typo>& typos) {
  for (const auto& [written, expected] : typos) {
    std::vector<std::string> found;
    for (const std::size_t index : meant(written, words)) found.push_back(words[index]);
    EXPECT_EQ(found, expected) << written;
  }
}

TEST(Suggest, Options) {
  expect_all(kOptions, {{"--sing", {"--sign"}},       // two letters swapped, and not --size
                        {"--res", {"--resolution"}},  // a beginning
                        {"--reslution", {"--resolution"}},
                        {"--resolutoin", {"--resolution"}},
                        {"--treads", {"--threads"}},
                        {"--thread", {"--threads"}},
                        {"--Sign", {"--sign"}},
                        {"-sign", {"--sign"}},
                        {"--memory", {"--memory-limit"}},
                        {"--oriented", {}},
                        {"--si", {"--size", "--sign"}},
                        {"--s", {}},
                        {"-x", {}},
                        {"--", {}},
                        {"--o", {}},
                        {"--ou", {"--output", "--outer"}},
                        {"--colour", {}},
                        {"--verbatim", {}}});
}

TEST(Suggest, Verbs) {
  expect_all(kVerbs, {{"compuet", {"compute"}},
                      {"ifno", {"info"}},
                      {"foo", {}},
                      {"ply", {"fly"}},
                      {"rendre", {"render"}},
                      {"ver", {"verify", "version"}},
                      {"frobnicate", {}},
                      {"iso", {}},
                      {"", {}}});
}

TEST(Suggest, SilentWhereTooManyAreNear) {
  EXPECT_TRUE(meant("bat", {"cat", "hat", "rat", "mat"}).empty());
  EXPECT_EQ(meant("bat", {"cat", "dog", "hat"}), (std::vector<std::size_t>{0, 2}));
}

TEST(Suggest, Edits) {
  EXPECT_EQ(edits("", "abc"), 3u);
  EXPECT_EQ(edits("abc", ""), 3u);
  EXPECT_EQ(edits("sign", "sign"), 0u);
  EXPECT_EQ(edits("sing", "sign"), 1u);
  EXPECT_EQ(edits("sing", "size"), 2u);
  EXPECT_EQ(edits("kitten", "sitting"), 3u);
  EXPECT_EQ(edits("ca", "abc"), 3u) << "no letter changes twice";
}

TEST(Suggest, Sentence) {
  EXPECT_EQ(did_you_mean("--sing", kOptions), "; did you mean '--sign'?");
  EXPECT_EQ(did_you_mean("--si", kOptions), "; did you mean '--size' or '--sign'?");
  EXPECT_EQ(did_you_mean("foo", kVerbs), "");
}

// A word of any length costs no more than a moment.
TEST(Suggest, LongWords) { EXPECT_TRUE(meant(std::string(10'000'000, 'a'), kVerbs).empty()); }

}  // namespace
}  // namespace standoff::cli
