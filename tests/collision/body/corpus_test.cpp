// SPDX-License-Identifier: Apache-2.0
// What the fuzzer of bodies found: tests/corpus/body/expected.txt says what each of its files gives.
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <set>
#include <sstream>

#include "tests/support/ask_body.h"
#include "tests/support/paths.h"

namespace standoff {
namespace {

const std::filesystem::path kCorpus = std::filesystem::path(kSourceFolder) / "tests/corpus/body";

std::string bytes(const std::filesystem::path& file) {
  std::ostringstream all;
  all << std::ifstream(file, std::ios::binary).rdbuf();
  return all.str();
}

void expect_refused(const std::string& file, const std::string& words) {
  try {
    read_body(file);
    ADD_FAILURE() << "was read, expected" << words;
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ErrorCode::input);
    EXPECT_TRUE(std::string(error.what()).starts_with("fuzzed" + words + "; "))
        << error.what() << "\nexpected" << words;
  }
}

TEST(BodyCorpus, GivesWhatTheTableSays) {
  std::set<std::string> named{"expected.txt"};
  std::ifstream table(kCorpus / "expected.txt");
  for (std::string line; std::getline(table, line);) {
    if (line.empty() || line[0] == '#') continue;
    std::istringstream words(line);
    std::string name, kind, answer;
    words >> name >> kind >> std::ws;
    std::getline(words, answer);
    SCOPED_TRACE(name);
    named.insert(name);
    if (kind == "error") {
      expect_refused(bytes(kCorpus / name), answer);
      continue;
    }
    const Body body = read_body(bytes(kCorpus / name));
    EXPECT_EQ(std::to_string(body.mesh().triangles.size()), answer);
    EXPECT_EQ(ask(body).value_or(ErrorCode::usage), ErrorCode::usage);
  }
  for (const auto& file : std::filesystem::directory_iterator(kCorpus))
    EXPECT_TRUE(named.contains(file.path().filename().string())) << file.path() << " is not in the table";
}

}  // namespace
}  // namespace standoff
