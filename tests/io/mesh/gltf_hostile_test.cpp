// SPDX-License-Identifier: Apache-2.0
// glTF files that are damaged, or made to do harm: each is an error before anything dangerous is done.
#include <gtest/gtest.h>

#include <cstring>
#include <initializer_list>
#include <string>

#include "standoff/io.h"
#include "tests/io/mesh/gltf_document.h"
#include "tests/support/expect_error.h"
#include "tests/support/temp_folder.h"

namespace standoff {
namespace {

void text_refused(const std::string& text, const std::string& words, ErrorCode code = ErrorCode::input) {
  const TempFolder folder;
  SCOPED_TRACE(text.substr(0, 1000));
  const auto path = folder.file(text.starts_with("glTF") ? "a.glb" : "a.gltf", text);
  expect_error([&] { read_mesh(path); }, code, words);
  expect_error([&] { read_mesh(path); }, code, path.string() + ":");
}

void refused(const GltfDocument& document, const std::string& words) { text_refused(document.text(), words); }

// 40 nodes that list the next one twice are 2^40 placements; assimp took all memory.
TEST(GltfHostile, NodesFormTrees) {
  std::string doubling = "[";
  for (int n = 1; n < 40; ++n) {
    const std::string next = std::to_string(n);
    doubling += "{\"children\":[" + next + "," + next + "]},";
  }
  refused({.nodes = doubling + R"({"mesh":0}])"}, ":node 1: it is a child twice, of node 0 and of node 0");
  refused({.nodes = R"([{"children":[1,2]},{"children":[2]},{"mesh":0}])"},
          ":node 2: it is a child twice, of node 0 and of node 1");
  refused({.nodes = R"([{"mesh":0,"children":[0]}])"}, ":node 0: it is a child twice, of node 0 and of node 0");
  refused({.nodes = R"([{"mesh":0,"children":[1]},{"children":[0]}])"}, ":node 0: the scene begins at it");
  refused({.scene = "[0,0]"}, ":node 0: the scene begins at it");
  refused({.nodes = R"([{"children":[1]},{"mesh":0}])", .scene = "[0,1]"}, ":node 1: the scene begins at it");
  refused({.scene = "[1]"}, "node 1 of 1, counted from 0");
  refused({.nodes = R"([{"children":[9]}])"}, "node 9 of 1, counted from 0");
  refused({.nodes = R"([{"mesh":1}])"}, "a node names mesh 1 of 1");
  // A cycle that no scene reaches does no harm.
  const TempFolder folder;
  const GltfDocument apart{.nodes = R"([{"mesh":0},{"children":[2]},{"children":[1]}])"};
  EXPECT_EQ(read_mesh(folder.file("a.gltf", apart.text())).mesh.triangles.size(), 1u);
}

// Found by grammar: the elements of a number were counted past its end, for ever or until std::out_of_range.
TEST(GltfHostile, ListsAreLists) {
  for (const std::string number : {"39", "-0", "1e5", "true", "\"[0]\""}) {
    refused({.nodes = number}, "expected a list, found '" + number + "'; repair the file");
    for (const std::string member : {"accessors", "bufferViews", "buffers", "meshes"}) {
      std::string text = GltfDocument{}.text();
      text.replace(text.find(member), member.size(), "extras");
      text_refused(text.insert(1, '"' + member + "\":" + number + ","), "expected a list, found '" + number + "'");
    }
  }
}

TEST(GltfHostile, PlacementsAreWhole) {
  refused({.nodes = R"([{"mesh":0,"matrix":[1,0,0,0,0,1,0,0,0,0,1,0,0,0,0]}])"}, "expected 16 numbers, found 15");
  refused({.nodes = R"([{"mesh":0,"matrix":[1,0,0,0.5,0,1,0,0,0,0,1,0,0,0,0,1]}])"}, "the last row of a node's matrix");
  refused({.nodes = R"([{"mesh":0,"rotation":[0,0,0,0]}])"}, "a rotation is no unit quaternion");
  refused({.nodes = R"([{"mesh":0,"scale":[1,"2",1]}])"}, "expected a number, found '\"2\"'");
  refused({.nodes = R"([{"mesh":0,"scale":[1,1e999,1]}])"},
          ":accessor 0 vertex 0: a coordinate is not a finite number");
  refused({.nodes = R"([{"mesh":0,"extensions":{"EXT_mesh_gpu_instancing":{}}}])"}, ":node 0: instances by EXT_mesh");
}

// A few bytes that unfold to all memory: many nodes with one large mesh, and a sparse accessor of zeros.
TEST(GltfHostile, WhatUnfoldsTooFar) {
  std::string nodes = R"([{"mesh":0})", scene = "[0";
  for (int n = 1; n < 4000; ++n) {
    nodes += R"(,{"mesh":0})";
    scene += "," + std::to_string(n);
  }
  constexpr int kCorners = 9999;
  GltfDocument document{.nodes = nodes + "]",
                        .scene = scene + "]",
                        .accessors = R"({"bufferView":0,"componentType":5121,"count":9999,"type":"VEC3"})",
                        .views = R"({"buffer":0,"byteLength":29997})",
                        .data = std::string(3 * kCorners, '\1')};
  text_refused(document.text(), "its nodes place meshes until they have 39996000 vertices and 13332000 triangles",
               ErrorCode::limit);
  const std::string sparse =
      R"({"componentType":5126,"count":4000000000000,"type":"VEC3","sparse":{"count":1,"indices":)"
      R"({"bufferView":0,"componentType":5121},"values":{"bufferView":0}}})";
  text_refused(GltfDocument{.primitive = R"({"attributes":{"POSITION":0},"mode":5})", .accessors = sparse}.text(),
               "its nodes place meshes until they have 4000000000000 vertices", ErrorCode::limit);
  // Corners are held beside their triangles: 48 million zeros are 183 MiB of them and as much of triangles.
  const std::string corners =
      R"(,{"componentType":5125,"count":48000000,"type":"SCALAR","sparse":{"count":1,"indices":)"
      R"({"bufferView":0,"componentType":5121},"values":{"bufferView":0}}})";
  text_refused(GltfDocument{.primitive = R"({"attributes":{"POSITION":0},"indices":1})",
                            .accessors = GltfDocument().accessors + corners}
                   .text(),
               "3 vertices and 16000000 triangles, 366 MiB, where a file", ErrorCode::limit);
  // What adds nothing is not walked, however often it is placed.
  std::string lines = R"({"attributes":{"POSITION":0}})";
  for (int n = 0; n < 20'000; ++n) lines += R"(,{"attributes":{"POSITION":0},"mode":1})";
  const TempFolder folder;
  const GltfDocument many{.nodes = document.nodes, .scene = document.scene, .primitive = lines};
  EXPECT_EQ(read_mesh(folder.file("a.gltf", many.text())).mesh.triangles.size(), 4000u);
}

// Found by fuzzing assimp: a primitive without positions ended the program, and a strip without corners asked for 64
// GB.
TEST(GltfHostile, PrimitivesHaveCorners) {
  const auto accessors = [](const std::string& count) {
    return R"({"bufferView":0,"componentType":5126,"type":"VEC3","count":)" + count + "}";
  };
  for (const char* without : {"{}", R"({"attributes":{}})", R"({"attributes":{"POSITIO":0}})"})
    refused({.primitive = without}, ":mesh 0 primitive 0: no POSITION in its attributes; it has no shape");
  refused({.primitive = R"({"attributes":{"POSITION":"0"}})"}, "expected a whole number from 0 on, found '\"0\"'");
  refused({.primitive = R"({"attributes":{"POSITION":-1}})"}, "expected a whole number from 0 on, found '-1'");
  refused({.primitive = R"({"attributes":{"POSITION":1}})"}, "it names accessor 1 of 1");
  refused({.primitive = "7"}, "expected an object, found '7'");
  refused({.primitive = R"({"attributes":{"POSITION":0},"mode":7})"}, "mode 7 is none of glTF's");
  for (const std::string count : {"0", "1", "2"})
    for (const char* mode : {"5", "6"})
      refused({.primitive = R"({"attributes":{"POSITION":0},"mode":)" + std::string(mode) + "}",
               .accessors = accessors(count)},
              ":mesh 0 primitive 0: " + count + " corners are too few for its mode, " + mode);
  refused({.accessors = accessors("2")}, ":mesh 0 primitive 0: 2 corners are not those of whole triangles");
  refused({.accessors = accessors("0")}, "the file holds no triangles");
  refused({.accessors = accessors("1.5")}, "expected a whole number from 0 on, found '1.5'");
}

TEST(GltfHostile, IndicesNameVertices) {
  const auto with = [](const std::string& type, const std::string& more = "") {
    return GltfDocument{
        .primitive = R"({"attributes":{"POSITION":0},"indices":1})",
        .accessors = GltfDocument().accessors + R"(,{"bufferView":1,"count":3,"type":)" + type + more + "}",
        .views = GltfDocument().views + R"(,{"buffer":0,"byteOffset":36,"byteLength":12})",
        .data = GltfDocument().data + std::string("\0\3\1", 3) + std::string(9, '\0')};
  };
  refused(with(R"("SCALAR","componentType":5121)"),
          ":mesh 0 primitive 0: corner 1: vertex index 3 is out of range, "
          "there are 3 vertices; repair the mesh");
  for (const char* type : {R"("SCALAR","componentType":5126)", R"("SCALAR","componentType":5122)",
                           R"("VEC2","componentType":5121)", R"("SCALAR","componentType":5121,"normalized":true)"})
    refused(with(type), ":accessor 1: indices are SCALAR of unsigned byte, short or int");
  refused(with(R"("SCALAR","componentType":5121)", R"(,"normalized":1)"), "expected true or false, found '1'");
}

// Assimp read past the end of a view where an accessor begins late in it, and wrote sparse numbers wherever they said.
TEST(GltfHostile, AccessorsStayInTheirViews) {
  const auto with = [](const std::string& more, const std::string& view = R"("byteLength":36)") {
    return GltfDocument{.accessors = R"({"type":"VEC3","componentType":5126,"count":3,"bufferView":0)" + more + "}",
                        .views = R"({"buffer":0,)" + view + "}"};
  };
  const std::string past = ":accessor 0: its numbers reach past the 36 bytes of bufferView 0";
  refused(with(R"(,"byteOffset":4)"), past);
  refused(with(R"(,"byteOffset":9007199254740992)"), past);
  refused(with(R"(,"byteOffset":18446744073709551615)"), "expected a whole number from 0 on");
  refused(with("", R"("byteLength":35)"), "its numbers reach past the 35 bytes");
  refused(with("", R"("byteLength":36,"byteStride":13)"), past);
  refused(with("", R"("byteLength":36,"byteStride":8)"), ":bufferView 0: a byteStride of 8 for elements of 12 bytes");
  refused(with("", R"("byteLength":36,"byteStride":256)"), ":bufferView 0: a byteStride of 256 for elements of 12");
  refused(with("", R"("byteLength":36,"byteOffset":1)"), ":bufferView 0: it reaches past the 36 bytes of buffer 0");
  refused(with(R"(,"bufferView":1)"), "a second member is called 'bufferView'");
  refused({.views = ""}, ":accessor 0: it names bufferView 0 of 0");
  refused({.views = R"({"buffer":1,"byteLength":36})"}, ":bufferView 0: it names buffer 1 of 1");
  refused({.views = R"({"buffer":0})"}, "a member called byteLength is missing");
  refused({.accessors = R"({"type":"VEC3","componentType":5126,"count":3})"}, ":accessor 0: it has no data");
  refused({.accessors = R"({"type":"VEC3","count":3})"}, ":accessor 0: it lacks a type, a componentType or a count");
  for (const char* type :
       {R"("VEC5","componentType":5126)", R"("VEC3","componentType":5127)", R"("VEC3","componentType":5124)"})
    refused({.accessors = "{\"count\":3,\"bufferView\":0,\"type\":" + std::string(type) + "}"},
            ":accessor 0: its type or componentType is none of glTF's");
  refused({.accessors = R"({"type":"VEC3","componentType":5125,"count":3,"bufferView":0})"},
          ":accessor 0: positions are VEC3 of float, byte or short");
}

TEST(GltfHostile, SparseIndicesRise) {
  const auto with = [](const std::string& indices, const std::string& sparse) {
    return GltfDocument{.accessors = GltfDocument().accessors.substr(0, GltfDocument().accessors.size() - 1) +
                                     R"(,"sparse":{)" + sparse + "}}",
                        .views = GltfDocument().views + R"(,{"buffer":0,"byteOffset":36,"byteLength":2})",
                        .data = GltfDocument().data + indices};
  };
  const std::string two = R"("count":2,"indices":{"bufferView":1,"componentType":5121},"values":{"bufferView":0})";
  for (const char* wrong : {"\2\1", "\1\1", "\1\3"})
    refused(with(wrong, two), ":accessor 0: its sparse indices do not rise, or reach");
  refused(with("\1\2", R"("count":4)" + two.substr(9)), ":accessor 0: 4 sparse values for 3 elements");
  refused(with("\1\2", R"("count":3)" + two.substr(9)), ":accessor 0: its numbers reach past the 2 bytes");
  refused(with("\1\2", R"("count":2,"indices":{"bufferView":1,"componentType":5122},"values":{"bufferView":0})"),
          ":accessor 0: its sparse indices are no unsigned integers");
  refused(with("\1\2", R"("count":2)"), ":accessor 0: its sparse part lacks");
}

TEST(GltfHostile, DataIsWhole) {
  refused({.uri = "data:"}, ":buffer 0: its data is no base64");
  refused({.uri = "data:a/b;base64,AAA?"}, ":buffer 0: its data is no base64");
  refused({.uri = "data:a/b;base64,AAAAA"}, ":buffer 0: its data is no base64");
  refused({.uri = "data:a/b;base64,AAAA"},
          ":buffer 0: it has 3 bytes, where its byteLength promises 36; it is cut off");
  refused({.uri = "data:\\ud83d\\x"}, "it holds an escape that JSON does not know");
  GltfDocument document;
  document.data.resize(32);
  std::string glb = document.binary();
  glb.replace(glb.find(R"("byteLength":32)"), 15, R"("byteLength":36)");
  text_refused(glb, ":buffer 0: it has 32 bytes, where its byteLength promises 36");
}

// What is not read is told by name, not read in part.
TEST(GltfHostile, OtherVersionsAndExtensions) {
  refused({.version = "\"1.0\""}, "version '1.0' of glTF is not read; convert it to version 2.0");
  refused({.version = "1"}, "version '1' of glTF is not read; convert it to version 2.0");
  refused({.version = R"("2.1","minVersion":"2.1")"}, "version '2.1' of glTF is not read");
  text_refused(R"({"asset":{}})", "its asset has no version");
  for (const std::string name : {"KHR_draco_mesh_compression", "EXT_meshopt_compression", "EXT_mesh_gpu_instancing"})
    refused({.root = R"(,"extensionsRequired":[")" + name + "\"]"}, "without the extension '" + name + "'");
  text_refused(R"({"asset":{"version":"2.0"}})", "it has no scene");
  refused({.root = R"(,"scene":0)"}, "a second member is called 'scene'");
}

TEST(GltfHostile, LengthsOfAGlbAreHeldAgainstTheFile) {
  const std::string whole = GltfDocument().binary();
  const auto with = [&](std::size_t at, std::uint32_t number) {
    std::string bytes = whole;
    std::memcpy(bytes.data() + at, &number, sizeof number);
    return bytes;
  };
  text_refused(with(4, 3), "byte 4: version 3 of glTF is not read; convert");
  text_refused(with(4, 1), "byte 4: version 1 of glTF is not read; convert");
  text_refused(with(8, 0xfffffff0), "byte 8: it promises 4294967280 bytes");
  text_refused(with(8, 12), "byte 8: it promises 12 bytes");
  text_refused(with(12, 0xfffffff0), "byte 12: a chunk of 4294967280 bytes");
  text_refused(with(16, 7), "byte 16: the first chunk is not its JSON");
  std::uint32_t json;
  std::memcpy(&json, whole.data() + 12, sizeof json);
  text_refused(with(20 + json, 1000), "a chunk of 1000 bytes, where 36 are left");
  text_refused(with(24 + json, 7), ":buffer 0: it has no uri, so it has no data");
  text_refused(whole.substr(0, 16), "the file ends in its header");
}

TEST(GltfHostile, DamagedJsonIsToldByItsByte) {
  text_refused(R"({"asset":{"version":"2.0"})", ":byte 26: its JSON is damaged: no '}' where one should stand; write");
  text_refused(R"({"asset"{}})", ":byte 8: its JSON is damaged: no ':' where");
  text_refused(R"({"asset":[1,]})", ":byte 12: its JSON is damaged: a value is missing");
  text_refused(R"({"asset":"\"})", ":byte 9: its JSON is damaged: a string without an end");
  text_refused(R"({"asset":1} 2)", ":byte 12: its JSON is damaged: text after its end");
  text_refused(R"({asset:1,"asset":1})", ":byte 1: its JSON is damaged: no '\"' where");
  for (const char* word : {"nan", "+1", "01", "1.", ".5", "1e", "-", "True", "0x10", "inf"})
    text_refused(std::string(R"({"asset":)") + word + "}",
                 ":byte 9: its JSON is damaged: '" + std::string(word) + "' is no value");
}

// Every reader that calls itself for each level comes to the end of the stack.
TEST(GltfHostile, NestingHasAnEnd) {
  constexpr std::size_t kLevels = 200'000;
  text_refused(R"({"asset":{"version":"2.0"},"extras":)" + std::string(kLevels, '[') + std::string(kLevels, ']') + "}",
               "its JSON is nested more than 200 deep");
  // Brackets in strings are no nesting; what is wrong with this one is that it holds nothing.
  text_refused(R"({"asset":{"version":"2.0","generator":"\")" + std::string(300, '[') + "\"}}", "it has no scene");
  std::string binary = GltfDocument().binary();
  std::uint32_t json;
  std::memcpy(&json, binary.data() + 12, sizeof json);
  std::memset(binary.data() + 20, '[', json);
  text_refused(binary, "its JSON is nested more than 200 deep");
}

}  // namespace
}  // namespace standoff
