// glTF files that assimp reads in part: what it drops must be an error.
#ifdef DIFI_HAVE_ASSIMP
#include <gtest/gtest.h>

#include <cstring>
#include <initializer_list>
#include <thread>
#include <vector>

#include "difi/io.h"
#include "tests/io/expect_error.h"
#include "tests/io/temp_folder.h"

namespace difi {
namespace {

// A binary glTF of the four corners of a square and these indices.
std::string square(std::initializer_list<std::uint16_t> indices) {
  const float positions[] = {0, 0, 0, 1, 0, 0, 0, 1, 0, 1, 1, 0};
  std::string data(reinterpret_cast<const char*>(positions), sizeof positions);
  for (const std::uint16_t index : indices) data.append(reinterpret_cast<const char*>(&index), sizeof index);
  data.resize((data.size() + 3) / 4 * 4);
  std::string json =
      R"({"asset":{"version":"2.0"},"scene":0,"scenes":[{"nodes":[0]}],"nodes":[{"mesh":0}],)"
      R"("meshes":[{"primitives":[{"attributes":{"POSITION":0},"indices":1}]}],"buffers":[{"byteLength":)" +
      std::to_string(data.size()) +
      R"(}],"bufferViews":[{"buffer":0,"byteOffset":0,"byteLength":48},{"buffer":0,"byteOffset":48,"byteLength":)" +
      std::to_string(2 * indices.size()) +
      R"(}],"accessors":[{"bufferView":0,"componentType":5126,"count":4,"type":"VEC3","min":[0,0,0],"max":[1,1,0]},)"
      R"({"bufferView":1,"componentType":5123,"count":)" +
      std::to_string(indices.size()) + R"(,"type":"SCALAR"}]})";
  json.resize((json.size() + 3) / 4 * 4, ' ');
  const auto number = [](std::size_t n) {
    const auto word = static_cast<std::uint32_t>(n);
    return std::string(reinterpret_cast<const char*>(&word), sizeof word);
  };
  return "glTF" + number(2) + number(28 + json.size() + data.size()) + number(json.size()) + "JSON" + json +
         number(data.size()) + std::string("BIN\0", 4) + data;
}

TEST(Gltf, ASquareIsRead) {
  const TempFolder folder;
  const Mesh mesh = read_mesh(folder.file("a.glb", square({0, 1, 2, 1, 3, 2})));
  EXPECT_EQ(mesh.triangles.size(), 2u);
  EXPECT_EQ(mesh.vertices.size(), 4u);
}

// Assimp left such faces out, said so in its log alone, and the mesh had a hole that nobody was told of.
TEST(Gltf, FacesThatAssimpDropsAreErrors) {
  const TempFolder folder;
  const auto refused = [&](const std::string& bytes, const char* words) {
    const auto path = folder.file("a.glb", bytes);
    expect_error([&] { read_mesh(path); }, ErrorCode::input, words);
    expect_error([&] { read_mesh(path); }, ErrorCode::input, path.string() + ": ");
  };
  refused(square({0, 1, 2, 1, 9, 2}), "out-of-range indices");
  refused(square({0, 1, 9}), "no faces");
  refused(square({0, 1, 2, 1, 3}), "TRIANGLES mode");
  // And the next file is none the worse for it.
  EXPECT_EQ(read_mesh(folder.file("b.glb", square({0, 1, 2}))).triangles.size(), 1u);
}

// Assimp took gigabytes for a chunk that the file only claims.
TEST(Gltf, LengthsAreHeldAgainstTheFile) {
  const TempFolder folder;
  const auto refused = [&](std::size_t at, std::uint32_t number, const char* words) {
    std::string bytes = square({0, 1, 2});
    std::memcpy(bytes.data() + at, &number, sizeof number);
    const auto path = folder.file("a.glb", bytes);
    expect_error([&] { read_mesh(path); }, ErrorCode::input, words);
  };
  refused(4, 3, "byte 4: version 3 of glTF; convert");
  refused(8, 0xfffffff0, "byte 8: it promises 4294967280 bytes");
  refused(8, 12, "byte 8: it promises 12 bytes");
  refused(12, 0xfffffff0, "byte 12: a chunk of 4294967280 bytes");
  const std::string whole = square({0, 1, 2});
  std::uint32_t json;
  std::memcpy(&json, whole.data() + 12, sizeof json);
  refused(20 + json, 1000, "a chunk of 1000 bytes, where 56 are left");
  const auto cut = folder.file("a.glb", whole.substr(0, 16));
  expect_error([&] { read_mesh(cut); }, ErrorCode::input, "the file ends in its header");
}

// Found by fuzzing: a primitive without positions ended the program, and a strip without corners asked for 64 GB.
TEST(Gltf, PrimitivesHaveCorners) {
  const TempFolder folder;
  const auto text = [&](const std::string& primitive, const std::string& count = "3") {
    return folder.file(
        "a.gltf", R"({"asset":{"version":"2.0"},"scene":0,"scenes":[{"nodes":[0]}],"nodes":[{"mesh":0}],"meshes":)"
                  R"([{"primitives":[)" +
                      primitive +
                      R"(]}],"buffers":[{"byteLength":36,"uri":"data:application/octet-stream;base64,)"
                      R"(AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAAAAgD8AAAAA"}],"bufferViews":[{"buffer":0,)"
                      R"("byteLength":36}],"accessors":[{"bufferView":0,"componentType":5126,"type":"VEC3","count":)" +
                      count + "}]}");
  };
  const auto refused = [](const std::filesystem::path& path, const std::string& words) {
    expect_error([&] { read_mesh(path); }, ErrorCode::input, path.string() + words);
  };
  EXPECT_EQ(read_mesh(text(R"({"attributes":{"POSITION":0}})")).triangles.size(), 1u);
  EXPECT_EQ(read_mesh(text(R"({"attributes" :{ "NORMAL":0,"POSITION" : 0 } ,"mode":5})")).triangles.size(), 1u);
  for (const char* without : {R"({"mode":2})", R"({"attributes":{},"mode":2})", R"({"attributes":{"POSITIO":0}})",
                              R"({"attributes":{"POSITION":"0"}})", R"({"attributes":{"POSITION":-1}})", "{}", "7"})
    refused(text(without), ":mesh 0 primitive 0: no POSITION in its attributes; it has no shape");
  for (const std::string count : {"0", "1", "1.5", "\"3\""})
    for (const int mode : {2, 3, 5, 6})
      refused(text(R"({"attributes":{"POSITION":0},"mode":)" + std::to_string(mode) + "}", count),
              ":mesh 0 primitive 0: " + std::string(count == "1" ? "1" : "0") + " corners are too few for its mode, " +
                  std::to_string(mode) + "; repair the mesh");
  refused(text(R"({"attributes":{"POSITION":0},"indices":0,"mode":5})", "2"), ":mesh 0 primitive 0: 2 corners are");
  // Assimp closes a loop through its first line, which it may have dropped.
  refused(text(R"({"attributes":{"POSITION":0},"indices":0,"mode":2})"),
          ":mesh 0 primitive 0: a loop of lines with indices is not read; leave the lines out");
  EXPECT_EQ(read_mesh(text(R"({"attributes":{"POSITION":0},"mode":6})")).triangles.size(), 1u);
}

// Found by fuzzing: assimp read past the end of a view where an accessor begins late in it.
TEST(Gltf, AccessorsStayInTheirViews) {
  const TempFolder folder;
  const auto with = [&](const std::string& accessor, const std::string& view = R"("byteLength":36)") {
    return folder.file("a.gltf",
                       R"({"asset":{"version":"2.0"},"scene":0,"scenes":[{"nodes":[0]}],"nodes":[{"mesh":0}],"meshes":)"
                       R"([{"primitives":[{"attributes":{"POSITION":0}}]}],"buffers":[{"byteLength":36,"uri":)"
                       R"("data:application/octet-stream;base64,AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAAAAgD8AAAAA"}],)"
                       R"("bufferViews":[{"buffer":0,)" +
                           view + R"(}],"accessors":[{)" + accessor + R"(,"count":3,"bufferView":0}]})");
  };
  const auto refused = [](const std::filesystem::path& path, const std::string& words) {
    expect_error([&] { read_mesh(path); }, ErrorCode::input, path.string() + ":accessor 0: " + words);
  };
  const std::string floats = R"("type":"VEC3","componentType":5126)";
  EXPECT_EQ(read_mesh(with(floats)).triangles.size(), 1u);
  EXPECT_EQ(read_mesh(with(floats + R"(,"byteOffset":0)")).triangles.size(), 1u);
  refused(with(floats + R"(,"byteOffset":4)"), "its numbers reach past the 36 bytes of their view");
  refused(with(floats + R"(,"byteOffset":4294967295)"), "its numbers reach past the 36 bytes of their view");
  refused(with(floats, R"("byteLength":35)"), "its numbers reach past the 35 bytes of their view");
  refused(with(floats, R"("byteLength":36,"byteStride":13)"), "its numbers reach past the 36 bytes of their view");
  for (const char* type : {"VEC4", "MAT2", "MAT3", "MAT4"})
    refused(with("\"componentType\":5125,\"type\":\"" + std::string(type) + '"'), "its numbers reach past");
  refused(with(R"("componentType":5126,"type":"VEC\u0033")"), "its type or componentType is none of glTF's");
  refused(with(R"("componentType":5127,"type":"VEC3")"), "its type or componentType is none of glTF's");
  refused(with(floats + R"(,"sparse":{"count":1,"indices":{},"values":{}})"), "sparse accessors are not read");
}

// Found by fuzzing: a skin without matrices, which glTF allows, ended the program. Skins change nothing that is read.
TEST(Gltf, SkinsAreLeftOut) {
  const TempFolder folder;
  for (const std::string name : {"skin", "sk\\u0069n"}) {
    const auto path = folder.file(
        "a.gltf",
        R"({"asset":{"version":"2.0"},"scene":0,"scenes":[{"nodes":[0,1]}],"nodes":[{"mesh":0,")" + name +
            R"(":0},{}],"skins":[{"joints":[1]}],"animations":[{}],"meshes":[{"primitives":[{"attributes":)"
            R"({"POSITION":0,"JOINTS_0":1,"WEIGHTS_0":2}}]}],"buffers":[{"byteLength":36,"uri":)"
            R"("data:application/octet-stream;base64,AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAAAAgD8AAAAA"}],)"
            R"("bufferViews":[{"buffer":0,"byteLength":36}],"accessors":[{"bufferView":0,"type":"VEC3",)"
            R"("componentType":5126,"count":3},{"bufferView":0,"type":"VEC4","componentType":5121,"count":3},)"
            R"({"bufferView":0,"type":"VEC4","componentType":5121,"count":3}]})");
    EXPECT_EQ(read_mesh(path).triangles.size(), 1u);
  }
}

// Found by fuzzing: the type of an image without a slash ended the program. The others are read past their ends.
TEST(Gltf, DataSaysWhatItIs) {
  const TempFolder folder;
  const auto with = [&](const std::string& image, const std::string& uri = "data:application\\/octet-stream;base64,") {
    return folder.file("a.gltf",
                       R"({"asset":{"version":"2.0"},"scene":0,"scenes":[{"nodes":[0]}],"nodes":[{"mesh":0}],"meshes":)"
                       R"([{"primitives":[{"attributes":{"POSITION":0}}]}],"images":[)" +
                           image + R"(],"buffers":[{"byteLength":36,"uri":")" + uri +
                           R"(AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAAAAgD8AAAAA"}],"bufferViews":[{"buffer":0,)"
                           R"("byteLength":36}],"accessors":[{"bufferView":0,"componentType":5126,"type":"VEC3",)"
                           R"("count":3}]})");
  };
  const auto refused = [](const std::filesystem::path& path, const std::string& words) {
    expect_error([&] { read_mesh(path); }, ErrorCode::input, path.string() + words);
  };
  EXPECT_EQ(read_mesh(with("")).triangles.size(), 1u);
  EXPECT_EQ(
      read_mesh(with(R"({"uri":"data:image/png;base64,AAAA"},{"uri":"data:image\/png;base64,AAAA"})")).triangles.size(),
      1u);
  EXPECT_EQ(read_mesh(with(R"({"uri":"wood.png"},{"bufferView":0,"mimeType":"image/png"})")).triangles.size(), 1u);
  const std::string type = ":image 0: the type of its data is not of the form image/png";
  refused(with(R"({"uri":"data:imagepng;base64,AAAA"})"), type);
  refused(with(R"({"uri":"data:image\u002cx/png;base64,AAAA"})"), type);
  refused(with(R"({"bufferView":0,"mimeType":"png"})"), ":image 0: its mimeType is not of the form image/png");
  refused(with(R"({"bufferView":0,"mimeType":"a\u0000/b"})"), ":image 0: its mimeType is not of the form image/png");
  const std::string begins = ":buffer 0: its data has no beginning of the form data:image/png;base64,";
  refused(with("", "data:a/" + std::string(200, 'b') + ";base64,"), begins);
  refused(with("", "data:"), begins);
  refused(with("", R"(\u0010data:a/b;base64,)"), ":buffer 0: its uri begins with an escape");
}

TEST(Gltf, DamagedJsonIsToldByItsByte) {
  const TempFolder folder;
  const auto refused = [&](const std::string& text, const std::string& words) {
    const auto path = folder.file("a.gltf", text);
    expect_error([&] { read_mesh(path); }, ErrorCode::input, path.string() + words);
  };
  refused(R"({"asset":{"version":"2.0"})", ":byte 26: its JSON is damaged: no '}' where one should stand; write");
  refused(R"({"asset"{}})", ":byte 8: its JSON is damaged: no ':' where");
  refused(R"({"asset":[1,]})", ":byte 12: its JSON is damaged: a value is missing");
  refused(R"({"asset":"\"})", ":byte 13: its JSON is damaged: a string without an end");
  refused(R"({"asset":1} 2)", ":byte 12: its JSON is damaged: text after its end");
  refused(R"({asset:1,"asset":1})", ":byte 1: its JSON is damaged: no '\"' where");
}

// Assimp's JSON parser calls itself for every level, until the stack ends.
TEST(Gltf, NestingHasAnEnd) {
  const TempFolder folder;
  const auto text = [&](int depth) {
    const auto levels = static_cast<std::size_t>(depth);
    return folder.file("a.gltf", R"({"asset":{"version":"2.0"},"extras":)" + std::string(levels, '[') +
                                     std::string(levels, ']') + "}");
  };
  const auto deep = text(200'000);
  expect_error([&] { read_mesh(deep); }, ErrorCode::input, "its JSON is nested more than 200 deep");
  // Brackets in strings are no nesting; what is wrong with this one is that it holds nothing.
  const auto words =
      folder.file("b.gltf", R"({"asset":{"version":"2.0","generator":"\")" + std::string(300, '[') + "\"}}");
  expect_error([&] { read_mesh(words); }, ErrorCode::input, "No scene");
  std::string binary = square({0, 1, 2});
  std::uint32_t json;
  std::memcpy(&json, binary.data() + 12, sizeof json);
  std::memset(binary.data() + 20, '[', json);
  const auto path = folder.file("a.glb", binary);
  expect_error([&] { read_mesh(path); }, ErrorCode::input, "its JSON is nested more than 200 deep");
}

TEST(Gltf, ThreadsHearOfTheirOwnFilesOnly) {
  const TempFolder folder;
  const auto good = folder.file("good.glb", square({0, 1, 2, 1, 3, 2}));
  const auto bad = folder.file("bad.glb", square({0, 1, 2, 1, 9, 2}));
  std::vector<std::thread> threads;
  for (int n = 0; n < 4; ++n)
    threads.emplace_back([&, n] {
      for (int times = 0; times < 20; ++times) {
        if (n % 2 == 0) {
          EXPECT_EQ(read_mesh(good).triangles.size(), 2u);
        } else {
          EXPECT_THROW(read_mesh(bad), Error);
        }
      }
    });
  for (std::thread& thread : threads) thread.join();
}

}  // namespace
}  // namespace difi
#endif  // DIFI_HAVE_ASSIMP
