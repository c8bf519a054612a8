// SPDX-License-Identifier: Apache-2.0
// Valid files with bytes changed, cut out or repeated: reading them gives a valid mesh or an Error, and nothing else.
#include <gtest/gtest.h>

#include <fstream>
#include <random>
#include <sstream>
#include <vector>

#include "standoff/error.h"
#include "standoff/mesh.h"
#include "tests/support/formats.h"
#include "tests/support/paths.h"

namespace standoff {
namespace {

std::string corpus_file(const std::string& name) {
  std::ostringstream bytes;
  bytes << std::ifstream(std::string(kSourceFolder) + "/tests/corpus/mesh/" + name, std::ios::binary).rdbuf();
  return bytes.str();
}

// One to four edits of kinds that damaged files show, and of digits, which are what counts and indices are made of.
std::string mutated(std::string bytes, std::mt19937& random) {
  constexpr std::string_view kLikely = "0123456789-+.eE/\\# \n\r\t\xff\x7f\x80";
  for (auto edits = 1 + random() % 4; edits > 0 && !bytes.empty(); --edits) {
    const std::size_t at = random() % bytes.size(), length = 1 + random() % 16;
    switch (random() % 6) {
      case 0:
        bytes[at] = static_cast<char>(random());
        break;
      case 1:
        bytes[at] = kLikely[random() % kLikely.size()];
        break;
      case 2:
        bytes[at] = static_cast<char>(bytes[at] ^ (1 << random() % 8));
        break;
      case 3:
        bytes.erase(at, length);
        break;
      case 4:
        bytes.insert(at, bytes.substr(random() % bytes.size(), length));
        break;
      default:
        bytes.resize(at);
        break;
    }
  }
  return bytes;
}

struct Reader {
  const char* extension;
  std::vector<const char*> files;
};

TEST(MeshMutation, GivesAMeshOrAnError) {
  const std::vector<Reader> readers{
      {"stl", {"stl_text.stl", "stl_text_two_solids.stl", "stl_header_says_solid.stl", "stl_called_mesh.dat"}},
      {"ply",
       {"ply_text.ply", "ply_faces_first.ply", "ply_extra_elements.ply", "ply_little_endian.ply",
        "ply_big_endian.ply"}},
      {"obj", {"obj_plain.obj", "obj_corner_forms.obj", "obj_continued_lines.obj", "obj_concave.obj"}},
      {"off", {"off_plain.off", "off_colours.off"}},
      {"3mf", {"threemf_plain.3mf", "threemf_components.3mf", "threemf_production.3mf"}}};
  std::mt19937 random(2008);
  int read = 0, refused = 0;
  for (const Reader& reader : readers)
    for (const char* name : reader.files) {
      const std::string original = corpus_file(name);
      ASSERT_FALSE(original.empty()) << name;
      for (int trial = 0; trial < 2000; ++trial) {
        const std::string bytes = mutated(original, random);
        try {
          const Mesh mesh = read_as(reader.extension, FileView(name, bytes));
          ASSERT_NO_THROW(validate(mesh)) << name << " trial " << trial;
          ++read;
        } catch (const Error& error) {
          ASSERT_EQ(error.code(), ErrorCode::input) << error.what();
          ASSERT_TRUE(std::string(error.what()).starts_with(std::string(name) + ":")) << error.what();
          ++refused;
        }
      }
    }
  // Neither kind may crowd out the other, or the edits test nothing.
  EXPECT_GT(read, 3000);
  EXPECT_GT(refused, 3000);
}

}  // namespace
}  // namespace standoff
