// SPDX-License-Identifier: Apache-2.0
// Files written by grammars of their formats, good ones and hostile ones: each is read or refused with an Error, in
// bounded time and memory, and a good one is read as what was written. A few hundred of each format by default; for as
// many as docs/testing.md tells of, run this program with
//   STANDOFF_LONG_FILES   how many of each format
//   STANDOFF_LONG_SEED    the first seed; what a run did not come to, another one does from there on
//   STANDOFF_LONG_FOLDER  where bad files are kept (a new folder under it for each format)
// For one format alone give --gtest_filter=*/gltf.
#include <gtest/gtest.h>

#include <cstdio>
#include <cstdlib>
#include <optional>
#include <regex>
#include <string>

#include "standoff/io.h"
#include "tests/grammar/judge.h"
#include "tests/grammar/run.h"
#include "tests/support/temp_folder.h"

namespace standoff::grammar {
namespace {

std::uint64_t from_environment(const char* name, std::uint64_t otherwise) {
  const char* const text = std::getenv(name);
  return text == nullptr ? otherwise : std::strtoull(text, nullptr, 10);
}

bool reads(const Grammar& grammar) {
  if (grammar.kind != Kind::mesh) return true;
  for (const FileFormat& format : mesh_formats())
    if ((std::string(grammar.extension) + ".").starts_with(format.extension + ".")) return format.readable;  // or .gz
  return false;
}

class Grammars : public ::testing::TestWithParam<Grammar> {};

TEST_P(Grammars, FilesAreReadAsWrittenOrRefused) {
  const Grammar& grammar = GetParam();
  if (!reads(grammar)) GTEST_SKIP() << "this build does not read ." << grammar.extension;
  const char* const kept = std::getenv("STANDOFF_LONG_FOLDER");
  std::optional<TempFolder> own;
  const std::filesystem::path base = kept ? std::filesystem::path(kept) / grammar.extension : own.emplace().path();
  const std::filesystem::path folder = base / "files";
  if (kept) std::filesystem::remove_all(base);
  std::filesystem::create_directories(folder);
  set_traps(folder);
  const std::uint64_t first = from_environment("STANDOFF_LONG_SEED", 1),
                      count = from_environment("STANDOFF_LONG_FILES", 400);
  const Tally tally = run(grammar, first, count, folder);
  const auto number = [](std::uint64_t n) { return static_cast<unsigned long long>(n); };
  std::printf(
      "%s: %llu files of seeds from %llu on: %llu read, %llu refused; %llu good, %llu of them read as written; %llu "
      "crashed, %llu hung, %llu over memory, %llu wrong; longest %.2f s, most memory %.1f MB\n",
      grammar.extension, number(tally.files), number(first), number(tally.read), number(tally.refused),
      number(tally.good), number(tally.compared), number(tally.crashed), number(tally.hung), number(tally.over_memory),
      number(tally.wrong), tally.longest_s, static_cast<double>(tally.most_bytes) / 1e6);
  std::fflush(stdout);  // a long run is watched
  for (const std::string& fault : tally.faults) ADD_FAILURE() << grammar.extension << " " << fault;
  EXPECT_EQ(tally.bad(), 0u);
  // Every good one; and neither those nor the others may crowd out the rest, or tricks test nothing.
  EXPECT_EQ(tally.compared, tally.good);
  EXPECT_GT(tally.good, count / 3);
  EXPECT_GT(tally.refused, count / 10);
}

INSTANTIATE_TEST_SUITE_P(Formats, Grammars, ::testing::ValuesIn(kGrammars), [](const auto& row) {
  return std::regex_replace(row.param.extension, std::regex("[.]"), "_");
});

}  // namespace
}  // namespace standoff::grammar
