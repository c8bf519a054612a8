// SPDX-License-Identifier: Apache-2.0
// The corpus of broken and odd mesh files: tests/corpus/mesh/expected.txt says what each of them gives.
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <map>
#include <sstream>

#include "standoff/io.h"
#include "tests/support/expect_error.h"
#include "tests/support/paths.h"

namespace standoff {
namespace {

const std::filesystem::path kCorpus = std::filesystem::path(kSourceFolder) / "tests/corpus/mesh";

std::map<std::string, std::string> expectations() {
  std::map<std::string, std::string> expected;
  std::ifstream table(kCorpus / "expected.txt");
  for (std::string line; std::getline(table, line);) {
    if (line.empty() || line[0] == '#') continue;
    const auto gap = line.find(' ');
    expected[line.substr(0, gap)] = line.substr(line.find_first_not_of(' ', gap));
  }
  return expected;
}

void expect_refused(const std::filesystem::path& file, const std::string& words) {
  try {
    read_mesh(file);
    ADD_FAILURE() << file << " was read, expected" << words;
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ErrorCode::input);
    const std::string message = error.what();
    EXPECT_TRUE(message.starts_with(file.string() + words + "; ")) << message << "\nexpected " << words;
    EXPECT_TRUE(says_what_to_do(message)) << message;
  }
}

TEST(MeshCorpus, GivesWhatTheTableSays) {
  for (const auto& [name, expected] : expectations()) {
    SCOPED_TRACE(name);
    std::istringstream words(expected);
    std::string kind;
    words >> kind >> std::ws;
    if (kind == "error") {
      std::string message;
      std::getline(words, message);
      expect_refused(kCorpus / name, message);
      continue;
    }
    const Mesh mesh = read_mesh(kCorpus / name).mesh;
    if (kind == "mesh") {
      std::size_t vertices = 0, triangles = 0;
      words >> vertices >> triangles;
      EXPECT_EQ(mesh.vertices.size(), vertices);
      EXPECT_EQ(mesh.triangles.size(), triangles);
    } else {
      std::string as, other_name;
      words >> as >> other_name;
      const Mesh other = read_mesh(kCorpus / other_name).mesh;
      EXPECT_EQ(mesh.vertices, other.vertices);
      EXPECT_EQ(mesh.triangles, other.triangles);
    }
    // Whichever of equal vertices came first, -0 has become +0.
    for (const Vec3& v : mesh.vertices)
      for (const double c : {v.x, v.y, v.z}) EXPECT_FALSE(c == 0 && std::signbit(c));
  }
}

TEST(MeshCorpus, HasARowForEveryFile) {
  auto expected = expectations();
  for (const auto& entry : std::filesystem::directory_iterator(kCorpus)) {
    const std::string name = entry.path().filename().string();
    if (name == "expected.txt" || name.ends_with(".py")) continue;
    EXPECT_EQ(expected.erase(name), 1u) << name << " is not in expected.txt";
  }
  EXPECT_TRUE(expected.empty()) << expected.begin()->first << " is in expected.txt only";
}

}  // namespace
}  // namespace standoff
