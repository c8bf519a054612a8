// SPDX-License-Identifier: Apache-2.0
// Files that assimp reads wrongly, or that end the program in it: they must be errors before or after it.
#include <gtest/gtest.h>
#include <sys/stat.h>
#include <zlib.h>

#include <algorithm>
#include <cstring>
#include <filesystem>
#include <initializer_list>
#include <thread>

#include "standoff/io.h"
#include "tests/support/expect_error.h"
#include "tests/support/paths.h"
#include "tests/support/temp_folder.h"

namespace standoff {
namespace {

bool reads(const std::string& extension) {
  return std::ranges::any_of(mesh_formats(),
                             [&](const FileFormat& f) { return f.extension == extension && f.readable; });
}

class Assimp : public ::testing::Test {
 protected:
  const TempFolder folder;

  void SetUp() override {
    if (!reads("dae")) GTEST_SKIP() << "this build has no assimp";
  }
  void refused(const std::string& name, const std::string& bytes, const std::string& words) const {
    SCOPED_TRACE(bytes.substr(0, 300));
    const auto path = folder.file(name, bytes);
    expect_error([&] { read_mesh(path); }, ErrorCode::input, words);
  }
  std::size_t triangles(const std::string& name, const std::string& bytes) const {
    return read_mesh(folder.file(name, bytes)).triangles.size();
  }
};

template <class Value>
std::string bytes_of(std::initializer_list<Value> values) {
  return {reinterpret_cast<const char*>(values.begin()), values.size() * sizeof(Value)};
}

std::string packed(const std::string& bytes) {
  const TempFolder folder;
  const gzFile file = ::gzopen((folder / "packed").c_str(), "wb");
  ::gzwrite(file, bytes.data(), static_cast<unsigned>(bytes.size()));
  ::gzclose(file);
  return read_bytes(folder / "packed");
}

std::string chunk(std::uint16_t id, const std::string& content) {
  return bytes_of<std::uint16_t>({id}) + bytes_of({static_cast<std::uint32_t>(6 + content.size())}) + content;
}

// A 3DS of the four corners of a tetrahedron and one face.
std::string tetrahedron(std::uint16_t a, std::uint16_t b, std::uint16_t c) {
  const std::string corners = bytes_of<std::uint16_t>({4}) + bytes_of<float>({0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1});
  const std::string faces = bytes_of<std::uint16_t>({1, a, b, c, 0});
  const std::string mesh = chunk(0x4100, chunk(0x4110, corners) + chunk(0x4120, faces));
  return chunk(0x4d4d, chunk(0x3d3d, chunk(0x4000, std::string("a\0", 2) + mesh)));
}

// The tetrahedron with nodes of these kinds, names and parents.
std::string with_nodes(const std::string& nodes) {
  std::string file = tetrahedron(0, 1, 2) + chunk(0xb000, nodes);
  const auto size = static_cast<std::uint32_t>(file.size());
  std::memcpy(file.data() + 2, &size, sizeof size);
  return file;
}

std::string node(const std::string& name, int parent, std::uint16_t kind = 0xb002) {
  return chunk(kind, chunk(0xb010, name + std::string(5, '\0') + bytes_of({static_cast<std::int16_t>(parent)})));
}

// Chains of 60,000 nodes ended the stack where they share a name, and took minutes where each had its own.
TEST_F(Assimp, NodesOf3dsHaveADepth) {
  std::string chain, cameras, siblings;
  for (int n = 0; n < 1200; ++n) {
    chain += node("a", n - 1);
    cameras += node("c" + std::to_string(n), n - 1, 0xb003);
    siblings += node("a", -1);
  }
  refused("a.3ds", with_nodes(chain), "its nodes are nested too deep; flatten the scene");
  refused("a.3ds", with_nodes(cameras), "its nodes are nested too deep; flatten the scene");
  EXPECT_EQ(triangles("a.3ds", with_nodes(siblings)), 1200u);
  EXPECT_EQ(triangles("a.3ds", with_nodes(node("a", -1) + node("b", 0) + node("a", 1))), 2u);
  std::string many;
  for (int n = 0; n < 10'001; ++n) many += node("", -1);
  refused("a.3ds", with_nodes(many), "more than 10000 nodes in its keyframes; write the file again without");
}

// Assimp put the last vertex in the place of one that is not there, and said so in its log alone.
TEST_F(Assimp, CornersOf3dsThatAreNoVertices) {
  EXPECT_EQ(triangles("a.3ds", tetrahedron(0, 1, 2)), 1u);
  refused("a.3ds", tetrahedron(0, 1, 60000), "Vertex index overflow");
}

std::string object(const std::string& name, const std::string& parts) { return chunk(0x4000, name + '\0' + parts); }

std::string repeated(int times, const std::string& part) {
  std::string all;
  all.reserve(static_cast<std::size_t>(times) * part.size());
  for (int n = 0; n < times; ++n) all += part;
  return all;
}

// Four megabytes of empty materials took five gigabytes, and groups of faces the time to look for the name of each.
TEST_F(Assimp, PartsOf3dsHaveANumber) {
  const auto with = [](const std::string& more) {
    const std::string file = tetrahedron(0, 1, 2);
    return chunk(0x4d4d, chunk(0x3d3d, file.substr(12) + more));
  };
  const std::string material = chunk(0xafff, "x"), light = chunk(0x4600, std::string(12, '\0'));
  EXPECT_EQ(triangles("a.3ds", with(repeated(5000, material))), 1u);
  refused("a.3ds", with(repeated(5001, material)), "more than 5000 materials; write the file again without them");
  refused("a.3ds", with(repeated(1001, object("b", light))), "more than 1000 lights and cameras; write the file");
  refused("a.3ds", with(object("b", repeated(1001, chunk(0x4700, std::string(32, '\0'))))), "more than 1000 lights");
  refused("a.3ds", with(repeated(20'001, object("b", chunk(0x4100, "x")))), "more than 20000 meshes; join some");
  const std::string group = chunk(0x4130, std::string("m\0\0\0", 4)), face = bytes_of<std::uint16_t>({1, 0, 1, 2, 0});
  refused("a.3ds", with(object("b", chunk(0x4100, chunk(0x4120, face + repeated(100'001, group))))),
          "more than 100000 groups of faces; write the file again without materials");
}

// Each object's first chunk is longer than the object, so that all that follow lie in it, too.
TEST_F(Assimp, ChunksOf3dsDoNotReachIntoEachOther) {
  std::string object = chunk(0x4000, std::string("a\0", 2) + chunk(0x4100, "123") + chunk(0x4111, ""));
  const std::uint32_t longer = 60;
  std::memcpy(object.data() + 10, &longer, sizeof longer);
  refused("a.3ds", chunk(0x4d4d, chunk(0x3d3d, repeated(2000, object))), "chunks, which reach into each other");
}

// Found by fuzzing: assimp asked for the memory of as many keys as a track claims, up to 100 GB.
TEST_F(Assimp, TracksOf3dsHaveTheKeysTheyClaim) {
  const auto animated = [](std::uint16_t track, std::uint32_t keys, std::size_t bytes) {
    const std::string name = chunk(0xb010, std::string("a\0", 2) + bytes_of<std::uint16_t>({0, 0, 0xffff}));
    const std::string content = std::string(10, '\0') + bytes_of({keys}) + std::string(bytes, '\0');
    const std::string node = chunk(0xb002, chunk(0xb030, bytes_of<std::uint16_t>({0})) + name + chunk(track, content));
    std::string file = tetrahedron(0, 1, 2) + chunk(0xb000, node);
    const auto size = static_cast<std::uint32_t>(file.size());
    std::memcpy(file.data() + 2, &size, sizeof size);
    return file;
  };
  EXPECT_EQ(triangles("a.3ds", animated(0xb020, 2, 36)), 1u);
  EXPECT_EQ(triangles("a.3ds", animated(0xb020, 0, 0)), 1u);
  for (const std::uint16_t track :
       {std::uint16_t{0xb020}, std::uint16_t{0xb021}, std::uint16_t{0xb022}, std::uint16_t{0xb029}}) {
    refused("a.3ds", animated(track, 0xfffffff0, 36), "a track of 4294967280 keys, where 36 bytes are left");
    refused("a.3ds", animated(track, 7, 36), "a track of 7 keys, where 36 bytes are left; the file is cut off");
  }
}

// Assimp once opened the file a second time, after the checks: what it read could be another one, and a pipe was empty.
TEST_F(Assimp, SeesTheBytesThatWereChecked) {
  ASSERT_EQ(::mkfifo((folder / "pipe.3ds").c_str(), 0600), 0);
  std::thread writer([&] { write_bytes(folder / "pipe.3ds", tetrahedron(0, 1, 2)); });
  EXPECT_EQ(read_mesh(folder / "pipe.3ds").triangles.size(), 1u);
  writer.join();
}

TEST_F(Assimp, ReadsTheSeedsOfTheFuzzers) {
  const std::filesystem::path seeds = std::filesystem::path(kSourceFolder) / "tests/corpus/assimp";
  for (const char* name : {"tetrahedron.3ds", "tetrahedron.dae"}) {
    const Mesh mesh = read_mesh(seeds / name);
    EXPECT_EQ(mesh.triangles.size(), 4u) << name;
    EXPECT_EQ(mesh.vertices.size(), 4u) << name;
  }
}

// A COLLADA tetrahedron, of which a test changes parts.
struct Collada {
  std::string before = "", kind = "triangles", count = "4", offset = "0", more = "";
  std::string indices = "0 1 2 0 1 3 0 2 3 1 2 3";
  std::string vertices = "4", stride = "3", floats = "12";
  std::string library = "", nodes = R"(<node id="n"><instance_geometry url="#g"/></node>)";

  std::string text() const {
    return R"(<?xml version="1.0"?>)" + before + R"(<COLLADA xmlns="http://www.collada.org/2005/11/COLLADASchema" )" +
           R"(version="1.4.1"><asset><up_axis>Y_UP</up_axis></asset><library_geometries><geometry id="g"><mesh>)" +
           R"(<source id="s"><float_array id="a" count=")" + floats + R"(">0 0 0 1 0 0 0 1 0 0 0 1</float_array>)" +
           R"(<technique_common><accessor source="#a" count=")" + vertices + R"(" stride=")" + stride +
           R"("><param name="X" type="float"/><param name="Y" type="float"/><param name="Z" type="float"/>)" +
           R"(</accessor></technique_common></source><vertices id="v"><input semantic="POSITION" source="#s"/>)" +
           "</vertices>\n<" + kind + R"( count=")" + count + R"("><input semantic="VERTEX" source="#v" offset=")" +
           offset + "\"/>" + more + "\n<p>" + indices + "</p></" + kind + "></mesh></geometry></library_geometries>" +
           library + R"(<library_visual_scenes><visual_scene id="vs">)" + nodes +
           "</visual_scene></library_visual_scenes>" + R"(<scene><instance_visual_scene url="#vs"/></scene></COLLADA>)";
  }
};

std::string nested(int levels, const std::string& begin, const std::string& end) {
  std::string text;
  for (int n = 0; n < levels; ++n) text += begin;
  for (int n = 0; n < levels; ++n) text += end;
  return text;
}

TEST_F(Assimp, ColladaIsRead) {
  EXPECT_EQ(triangles("a.dae", Collada().text()), 4u);
  EXPECT_EQ(triangles("a.dae", Collada{.before = "<!-- <p>-1</p> -->"}.text()), 4u);
  EXPECT_EQ(triangles("a.dae", Collada{.kind = "polylist", .more = "<vcount>3 3 3 3</vcount>"}.text()), 4u);
  EXPECT_EQ(triangles("a.dae", Collada{.kind = "polygons", .count = "1"}.text()), 10u);
  const std::string twice = R"(<node id="m"><instance_node url="#n"/><instance_node url="#n"/></node>)";
  EXPECT_EQ(triangles("a.dae", Collada{.nodes = Collada().nodes + twice}.text()), 12u);
  // A node may have the name of one in the library that it instances.
  EXPECT_EQ(triangles("a.dae", Collada{.library = "<library_nodes>" + Collada().nodes + "</library_nodes>",
                                       .nodes = R"(<node id="k" name="n"><instance_node url="#n"/></node>)"}
                                   .text()),
            4u);
}

// Assimp took -1 for 0, and never came to the end of 1e308.
TEST_F(Assimp, IndicesOfColladaAreWholeNumbers) {
  for (const char* word : {"-1", "1e308", "1.5", "x", "3000000000", "99999999999999999999"})
    refused("a.dae", Collada{.count = "1", .indices = std::string("0 1 ") + word}.text(),
            ":line 3: element p must hold whole numbers from 0 on, found '" + std::string(word) + "'");
  refused("a.dae", Collada{.indices = "0 1 2 <!-- --> 0 1 3"}.text(), "element p must hold numbers only");
}

// Assimp made eight triangles of four when the count was zero, and read past the end of strips.
TEST_F(Assimp, CountsOfColladaFit) {
  refused("a.dae", Collada{.indices = "0 1 2 0 1"}.text(), "5 indices, where the count of triangles asks for 12");
  refused("a.dae", Collada{.count = "0"}.text(), "12 indices, where the count of triangles asks for 0");
  refused("a.dae", Collada{.count = "-1"}.text(), "attribute count must be a whole number");
  refused("a.dae", Collada{.offset = "-1"}.text(), "attribute offset must be a whole number");
  refused("a.dae", Collada{.offset = "256"}.text(), "an offset of 256");
  refused("a.dae", Collada{.kind = "polylist", .more = "<vcount>3 3 3 4</vcount>"}.text(), "asks for 13");
  refused("a.dae", Collada{.kind = "polylist", .more = "<vcount>6 6</vcount>"}.text(), "2 numbers in vcount for 4");
  refused("a.dae", Collada{.kind = "tristrips", .indices = "0 1"}.text(), "2 indices do not fit tristrips");
  refused("a.dae", Collada{.kind = "polygons"}.text(), "1 elements p, where the count of polygons asks for 4");
  refused("a.dae", Collada{.before = "<triangles count='3'/>"}.text(), "0 elements p, where the count");
  refused("a.dae", Collada{.more = "<p>0 1 2 0 1 3 0 2 3 1 2 3</p>"}.text(), "2 elements p, where the count");
  refused("a.dae", Collada{.more = "<lines count='1'>"}.text(), "a list of faces inside of another");
  refused("a.dae", Collada{.vertices = "5000000"}.text(), "the accessor of '#a' reaches past its 12 values");
  refused("a.dae", Collada{.stride = "4"}.text(), "the accessor of '#a' reaches past its 12 values");
}

// Found by grammar: assimp adds a second mesh of a geometry, or a second list of vertices, to the first. Corners named
// the wrong vertices, and where there were none the program ended.
TEST_F(Assimp, GeometriesOfColladaHaveOneMesh) {
  const std::string good = Collada().text();
  const auto part = [&](const std::string& begin, const std::string& end) {
    const auto at = good.find(begin);
    return good.substr(at, good.find(end, at) + end.size() - at);
  };
  const auto with = [&](const std::string& before, const std::string& more) {
    std::string text = good;
    return text.insert(text.find(before), more);
  };
  const std::string mesh = part("<mesh>", "</mesh>"), vertices = part("<vertices", "</vertices>"),
                    faces = part("\n<triangles", "</triangles>");
  refused("a.dae", with("</geometry>", mesh), ": a second mesh in a geometry; give each a geometry of its own");
  refused("a.dae", with("</geometry>", "<mesh>" + part("<source", "</source>") + faces + "</mesh>"), "a second mesh");
  refused("a.dae", with("\n<triangles", vertices), ": a second element vertices in a mesh; repair the mesh");
  std::string other = part("<geometry", "</geometry>");
  EXPECT_EQ(triangles("a.dae", with("</library_geometries>", other.replace(other.find("\"g\""), 3, "\"h\""))), 4u);
}

// Found by grammar: assimp takes a fan for a polygon, which is cut in another way where it is not flat.
TEST_F(Assimp, FansOfColladaAreTriangles) {
  EXPECT_EQ(triangles("a.dae", Collada{.kind = "trifans", .count = "1", .indices = "0 1 2"}.text()), 1u);
  refused("a.dae", Collada{.kind = "trifans", .count = "1", .indices = "0 1 2 3"}.text(),
          "fans of more than three corners are not read; write triangles or tristrips");
}

TEST_F(Assimp, NodesOfColladaUnfold) {
  const std::string instance = R"(<instance_node url="#)";
  refused("a.dae", Collada{.nodes = R"(<node id="n"><instance_node url="#n"/></node>)"}.text(),
          "a node instances itself");
  refused("a.dae", Collada{.nodes = R"(<node name="n"><node><instance_node url="#n"/></node></node>)"}.text(),
          "a node instances itself");
  refused("a.dae", Collada{.nodes = R"(<node id="n"><instance_node url="#&#110;"/></node>)"}.text(), "hold '&'");
  std::string doubling, chain;
  for (int n = 0; n < 5000; ++n) {
    const std::string node = "<node id=\"n" + std::to_string(n) + "\">",
                      next = instance + "n" + std::to_string(n + 1) + "\"/>";
    if (n < 40) doubling += node + next + next + "</node>";
    chain += node + next + "</node>";
  }
  refused("a.dae", Collada{.nodes = doubling}.text(),
          "unfold to more than 100000, a light or camera counted as 100; instance fewer");
  refused("a.dae", Collada{.nodes = chain}.text(), "nested too deep");
  refused("a.dae", Collada{.nodes = nested(200'000, "<node>", "</node>")}.text(), "nested more than 500 deep");
  EXPECT_EQ(triangles("a.dae", Collada{.nodes = Collada().nodes + nested(450, "<node>", "</node>")}.text()), 4u);
}

// Assimp makes kilobytes of what has ten bytes in the file: six megabytes of nodes became more than one gigabyte.
TEST_F(Assimp, PartsOfColladaHaveANumber) {
  const auto entries = [](int number, const std::string& entry) {
    return Collada{.library = "<library_x>" + repeated(number, entry) + "</library_x>"}.text();
  };
  EXPECT_EQ(triangles("a.dae", entries(5000, "<material/>")), 4u);
  refused("a.dae", entries(5001, "<material/>"), "more than 5000 materials; write the file again without them");
  refused("a.dae", entries(50'001, "<effect id='e'/>"), "more than 50000 things in its libraries; split the file");
  const std::string too_many = "unfold to more than 100000, a light or camera counted as 100; instance fewer";
  refused("a.dae", Collada{.nodes = repeated(100'001, "<node/>")}.text(), too_many);
  refused("a.dae", Collada{.nodes = repeated(1000, "<node><instance_light url='#l'/></node>")}.text(), too_many);
  // Each of these nodes places the tetrahedron's one list of faces, and is a node itself.
  refused("a.dae", Collada{.nodes = repeated(50'001, "<node><instance_geometry url='#g'/></node>")}.text(), too_many);
}

// Assimp makes a mesh of the skeleton of the nodes where there is none.
TEST_F(Assimp, NodesWithoutMeshesAreNoMesh) {
  refused("a.dae", Collada{.nodes = "<node><translate>1 0 0</translate><node/></node>"}.text(),
          "the file holds no triangles");
}

// Assimp's validation refuses it, and gave no hint of what to change.
TEST_F(Assimp, AGeometryTwiceInANodeIsTold) {
  const std::string instance = "<instance_geometry url='#g'/>";
  refused("a.dae", Collada{.nodes = "<node>" + instance + instance + "</node>"}.text(),
          ": one node places a geometry twice, which assimp does not read; give each place a node of its own");
  EXPECT_EQ(triangles("a.dae", Collada{.nodes = repeated(2, "<node>" + instance + "</node>")}.text()), 8u);
}

// A megabyte became six gigabytes: assimp copies a mesh for each material that an instance binds, and we for each node.
TEST_F(Assimp, ShapesOfColladaUnfold) {
  const std::string instance = R"(<instance_geometry url="#g"/>)";
  std::string bound, nodes;
  for (int n = 0; n < 1200; ++n) {
    bound +=
        R"(<instance_geometry url="#g"><bind_material><technique_common><instance_material symbol="s" target="#m)" +
        std::to_string(n) + R"("/></technique_common></bind_material></instance_geometry>)";
    nodes += "<node>" + instance + "</node>";
  }
  Collada shape{.count = "4000", .indices = ""};
  for (int n = 0; n < 4000; ++n) shape.indices += "0 1 2 ";
  const auto too_far = [&](const std::string& text) {
    const auto path = folder.file("a.dae", text);
    expect_error([&] { read_mesh(path); }, ErrorCode::limit,
                 "its nodes place meshes until they have 14400000 vertices");
  };
  shape.nodes = "<node>" + bound + "</node>";
  too_far(shape.text());
  shape.nodes = nodes;
  too_far(shape.text());
  shape.library = "<library_nodes><node id='n'>" + nodes.substr(0, nodes.size() / 2) + "</node></library_nodes>";
  shape.nodes = R"(<node><instance_node url="#n"/></node>)";
  too_far(shape.text());
  shape.library = "<library_controllers><controller id='k'><skin source='#g'/></controller></library_controllers>";
  shape.nodes = "<node>";
  for (int n = 0; n < 1200; ++n) shape.nodes += R"(<instance_controller url="#k"/>)";
  shape.nodes += "</node>";
  too_far(shape.text());
}

// Assimp asked for the memory of all values that an array claims.
TEST_F(Assimp, ArraysOfColladaFit) {
  refused("a.dae", Collada{.floats = "2000000001"}.text(), "an array of 2000000001 values in 23 characters");
}

// A name of the file came back in the message, all 8,600 bytes of it.
TEST_F(Assimp, ItsMessagesAreCutToALine) {
  std::string text = Collada().text();
  const std::string reference = R"(<instance_visual_scene url="#vs")";
  text.replace(text.find(reference), reference.size(),
               R"(<instance_visual_scene url="#)" + std::string(8600, 'x') + '"');
  const auto path = folder.file("a.dae", text);
  try {
    read_mesh(path);
    ADD_FAILURE() << "no error";
  } catch (const Error& error) {
    const std::string message = error.what();
    EXPECT_LT(message.size(), path.string().size() + 250) << message;
    EXPECT_EQ(message.find('\n'), message.npos);
    EXPECT_TRUE(says_what_to_do(message)) << message;
  }
}

TEST_F(Assimp, PackedFilesAreReadToo) {
  // Assimp is told of the name that says the format.
  EXPECT_EQ(triangles("a.3ds.gz", packed(tetrahedron(0, 1, 2))), 1u);
  EXPECT_EQ(triangles("a.dae.gz", packed(Collada().text())), triangles("a.dae", Collada().text()));
}

TEST_F(Assimp, ColladaThatIsNoPlainXml) {
  refused("a.dae", Collada{.before = "<!DOCTYPE COLLADA [<!ENTITY a \"1\">]>"}.text(), "a document type is not read");
  refused("a.dae", Collada().text() + std::string(1, '\0'), "a zero byte");
  refused("a.dae", Collada{.before = "<!-- "}.text(), "a comment or section without an end");
  refused("a.dae", Collada{.before = "<a b>"}.text(), "a damaged tag");
  const std::string whole = Collada().text();
  for (std::size_t size = 60; size < whole.size(); size += 7) refused("a.dae", whole.substr(0, size), "a.dae");
}

}  // namespace
}  // namespace standoff
