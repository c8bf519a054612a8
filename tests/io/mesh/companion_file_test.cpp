// SPDX-License-Identifier: Apache-2.0
// Files that a mesh refers to: regular ones in its folder, and nothing else, are opened.
#include <gtest/gtest.h>
#include <sys/stat.h>

#include <filesystem>
#include <string>

#include "standoff/io.h"
#include "tests/io/mesh/gltf_document.h"
#include "tests/support/expect_error.h"
#include "tests/support/temp_folder.h"

namespace standoff {
namespace {

// A glTF in the folder "mesh" of a folder, whose buffer is another file.
class Companion : public ::testing::Test {
 protected:
  const TempFolder folder;
  const std::filesystem::path inside = folder / "mesh";

  void SetUp() override { std::filesystem::create_directory(inside); }
  std::filesystem::path mesh(const std::string& uri) const {
    return folder.file("mesh/a.gltf", GltfDocument{.uri = uri}.text());
  }
  void buffer(const std::string& name, const std::string& bytes = GltfDocument().data) const {
    std::filesystem::create_directories((folder / name).parent_path());
    folder.file(name, bytes);
  }
  void reads(const std::string& uri) const {
    SCOPED_TRACE(uri);
    EXPECT_EQ(read_mesh(mesh(uri)).mesh.triangles.size(), 1u);
  }
  void refused(const std::string& uri, const std::string& words) const {
    SCOPED_TRACE(uri);
    const auto path = mesh(uri);
    expect_error([&] { read_mesh(path); }, ErrorCode::input, path.string() + ":buffer 0: '");
    expect_error([&] { read_mesh(path); }, ErrorCode::input, words);
  }
};

TEST_F(Companion, InTheFolderIsRead) {
  buffer("mesh/a.bin");
  buffer("mesh/below/it/b.bin");
  buffer("mesh/with space, 100%, \xc3\xa4 and ..dots.bin");
  reads("a.bin");
  reads("./a.bin");
  reads("below//it/./b.bin");
  reads("below%2Fit/b.bin");
  reads("with%20space,%20100%25,%20%C3%A4%20and%20..dots.bin");
  reads("with space, 100%, \\u00e4 and ..dots.bin");  // as careless programs write it
  std::filesystem::current_path(inside);
  EXPECT_EQ(read_mesh("a.gltf").mesh.triangles.size(), 1u);
  std::filesystem::current_path("/");
}

// '../../../etc/passwd' was read, and its bytes became vertices.
TEST_F(Companion, OutsideOfTheFolderIsRefused) {
  buffer("a.bin");
  buffer("mesh/below/a.bin");
  const std::string leaves = "leaves the mesh's folder, and only files in it are read; put the file beside the mesh";
  for (const char* uri :
       {"../a.bin", "below/../../a.bin", "below/../below/a.bin", "%2e%2e/a.bin", ".%2E%2fa.bin", ".."})
    refused(uri, leaves);
  const std::string absolute = "is an absolute path, and only files in the mesh's folder are read";
  refused((folder / "a.bin").string(), absolute);
  refused("%2fetc/passwd", absolute);
  refused("//host/a.bin", absolute);
  for (const char* uri : {"file:///etc/passwd", "file:a.bin", "https://example.com/a.bin", "C:/a.bin"})
    refused(uri, "is an address, and only files in the mesh's folder are read");
  refused("..\\\\a.bin", "holds a backslash");
  refused("below%5ca.bin", "holds a backslash");
  refused("a.bin%00.png", "holds a control character");
  refused("a\\nb", "holds a control character");
  for (const char* uri : {"", ".", "./", "/"})
    if (*uri) refused(uri, *uri == '/' ? absolute : "names no file");
}

// A pipe hung, and to open a device can do things already.
TEST_F(Companion, WhatIsNoFileIsNotOpened) {
  ASSERT_EQ(::mkfifo((inside / "pipe").c_str(), 0600), 0);
  std::filesystem::create_directory(inside / "below");
  refused("pipe", "it is a pipe or a device; name a regular file");
  refused("below", "it is a folder; name a regular file");
  refused("pipe/a.bin", "no such file");
  refused("none.bin", "no such file; put it beside the mesh");
  refused("none/a.bin", "no such file; put it beside the mesh");
  // A mesh beside devices: they are told by what they are.
  if (std::filesystem::is_character_file("/dev/zero")) {
    std::filesystem::create_symlink("/dev/zero", inside / "zero");
    refused("zero", "a symbolic link is not followed");
  }
}

TEST_F(Companion, LinksAreNotFollowed) {
  buffer("secret/a.bin");
  buffer("mesh/a.bin");
  std::filesystem::create_symlink("../secret/a.bin", inside / "out.bin");
  std::filesystem::create_symlink("a.bin", inside / "in.bin");
  std::filesystem::create_directory_symlink("../secret", inside / "below");
  for (const char* uri : {"out.bin", "in.bin", "below/a.bin"})
    refused(uri, "a symbolic link is not followed; put the file itself there");
  // The folder itself may be reached through one.
  mesh("a.bin");
  std::filesystem::create_directory_symlink(inside, folder / "link");
  EXPECT_EQ(read_mesh(folder / "link/a.gltf").mesh.triangles.size(), 1u);
}

TEST_F(Companion, ShortOnesAreCutOff) {
  buffer("mesh/a.bin", "short");
  const auto path = mesh("a.bin");
  expect_error([&] { read_mesh(path); }, ErrorCode::input,
               path.string() + ":buffer 0: it has 5 bytes, where its byteLength promises 36; it is cut off");
  buffer("mesh/empty.bin", "");
  const auto other = mesh("empty.bin");
  expect_error([&] { read_mesh(other); }, ErrorCode::input, ":buffer 0: it has 0 bytes");
}

// A file of a gigabyte was read whole for a buffer of 36 bytes, and let the scene unfold to twelve times as much.
TEST_F(Companion, AreReadAsFarAsBuffersReach) {
  buffer("mesh/a.bin");
  std::filesystem::resize_file(inside / "a.bin", 16 << 20);
  reads("a.bin");
  const GltfDocument zeros{.primitive = R"({"attributes":{"POSITION":0},"mode":5})",
                           .accessors =
                               R"({"componentType":5126,"count":4000000,"type":"VEC3","sparse":{"count":1,"indices":)"
                               R"({"bufferView":0,"componentType":5121},"values":{"bufferView":0}}})",
                           .uri = "a.bin"};
  const auto path = folder.file("mesh/a.gltf", zeros.text());
  expect_error([&] { read_mesh(path); }, ErrorCode::limit, "where a file of its size may have 192 MiB");
}

TEST_F(Companion, OneMayHoldSeveralBuffers) {
  buffer("mesh/a.bin", GltfDocument().data + std::string("\0\1\2", 3));
  const GltfDocument document{
      .primitive = R"({"attributes":{"POSITION":0},"indices":1})",
      .accessors = GltfDocument().accessors + R"(,{"bufferView":1,"componentType":5121,"count":3,"type":"SCALAR"})",
      .views = GltfDocument().views + R"(,{"buffer":1,"byteOffset":36,"byteLength":3})",
      .uri = "a.bin"};
  std::string text = document.text();
  text.insert(text.rfind("}]") + 1, R"(,{"byteLength":39,"uri":"a.bin"})");
  EXPECT_EQ(read_mesh(folder.file("mesh/a.gltf", text)).mesh.triangles.size(), 1u);
}

// Images are no shape: never opened, wherever they are.
TEST_F(Companion, ImagesAreNeverOpened) {
  ASSERT_EQ(::mkfifo((inside / "pipe").c_str(), 0600), 0);
  const GltfDocument document{.root =
                                  R"(,"images":[{"uri":"pipe"},{"uri":"../../etc/passwd"}],"textures":[{"source":0}])"};
  EXPECT_EQ(read_mesh(folder.file("mesh/a.gltf", document.text())).mesh.triangles.size(), 1u);
}

}  // namespace
}  // namespace standoff
