// SPDX-License-Identifier: Apache-2.0
// COLLADA: geometries, nodes that place them, and what is damaged.
#include <gtest/gtest.h>
#include <zlib.h>

#include <cmath>
#include <filesystem>
#include <initializer_list>

#include "standoff/io.h"
#include "tests/support/expect_error.h"
#include "tests/support/temp_folder.h"

namespace standoff {
namespace {

class Dae : public ::testing::Test {
 protected:
  const TempFolder folder;

  void refused(const std::string& bytes, const std::string& words) const {
    SCOPED_TRACE(bytes.substr(0, 300));
    const auto path = folder.file("a.dae", bytes);
    expect_error([&] { read_mesh(path); }, ErrorCode::input, words);
  }
  Mesh read(const std::string& bytes) const { return read_mesh(folder.file("a.dae", bytes)).mesh; }
  std::size_t triangles(const std::string& bytes) const { return read(bytes).triangles.size(); }
};

std::string packed_text(const std::string& bytes) {
  const TempFolder folder;
  const gzFile file = ::gzopen((folder / "packed").c_str(), "wb");
  ::gzwrite(file, bytes.data(), static_cast<unsigned>(bytes.size()));
  ::gzclose(file);
  return read_bytes(folder / "packed");
}

std::string repeated_text(int times, const std::string& part) {
  std::string all;
  all.reserve(static_cast<std::size_t>(times) * part.size());
  for (int n = 0; n < times; ++n) all += part;
  return all;
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

TEST_F(Dae, IsRead) {
  EXPECT_EQ(triangles(Collada().text()), 4u);
  EXPECT_EQ(triangles(Collada{.before = "<!-- <p>-1</p> -->"}.text()), 4u);
  EXPECT_EQ(triangles(Collada{.kind = "polylist", .more = "<vcount>3 3 3 3</vcount>"}.text()), 4u);
  EXPECT_EQ(triangles(Collada{.kind = "polygons", .count = "1"}.text()), 10u);
  const std::string twice = R"(<node id="m"><instance_node url="#n"/><instance_node url="#n"/></node>)";
  EXPECT_EQ(triangles(Collada{.nodes = Collada().nodes + twice}.text()), 12u);
  // A node may have the name of one in the library that it instances.
  EXPECT_EQ(triangles(Collada{.library = "<library_nodes>" + Collada().nodes + "</library_nodes>",
                              .nodes = R"(<node id="k" name="n"><instance_node url="#n"/></node>)"}
                          .text()),
            4u);
}

// Assimp took -1 for 0, and never came to the end of 1e308.
TEST_F(Dae, IndicesAreWholeNumbers) {
  for (const char* word : {"-1", "1e308", "1.5", "x", "3000000000", "99999999999999999999"})
    refused(Collada{.count = "1", .indices = std::string("0 1 ") + word}.text(),
            ":line 3: element p must hold whole numbers from 0 on, found '" + std::string(word) + "'");
  refused(Collada{.indices = "0 1 2 <!-- --> 0 1 3"}.text(), "element p must hold numbers only");
}

// Assimp made eight triangles of four when the count was zero, and read past the end of strips.
TEST_F(Dae, CountsFit) {
  refused(Collada{.indices = "0 1 2 0 1"}.text(), "5 indices, where the count of triangles asks for 12");
  refused(Collada{.count = "0"}.text(), "12 indices, where the count of triangles asks for 0");
  refused(Collada{.count = "-1"}.text(), "attribute count must be a whole number");
  refused(Collada{.offset = "-1"}.text(), "attribute offset must be a whole number");
  refused(Collada{.offset = "256"}.text(), "an offset of 256");
  refused(Collada{.kind = "polylist", .more = "<vcount>3 3 3 4</vcount>"}.text(), "asks for 13");
  refused(Collada{.kind = "polylist", .more = "<vcount>6 6</vcount>"}.text(), "2 numbers in vcount for 4");
  refused(Collada{.kind = "tristrips", .indices = "0 1"}.text(), "2 indices do not fit tristrips");
  refused(Collada{.kind = "polygons"}.text(), "1 elements p, where the count of polygons asks for 4");
  std::string without = Collada().text();
  refused(without.insert(without.find("\n<triangles"), "<triangles count='3'/>"), "0 elements p, where the count");
  refused(Collada{.more = "<p>0 1 2 0 1 3 0 2 3 1 2 3</p>"}.text(), "2 elements p, where the count");
  refused(Collada{.more = "<lines count='1'>"}.text(), "a list of faces inside of another");
  refused(Collada{.vertices = "5000000"}.text(), "the accessor of '#a' reaches past its 12 values");
  refused(Collada{.stride = "4"}.text(), "the accessor of '#a' reaches past its 12 values");
}

// Found by grammar: assimp added a second mesh of a geometry to the first, and corners named the wrong vertices.
TEST_F(Dae, GeometriesHaveOneMesh) {
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
  refused(with("</geometry>", mesh), ": a second mesh in a geometry; give each a geometry of its own");
  refused(with("</geometry>", "<mesh>" + part("<source", "</source>") + faces + "</mesh>"), "a second mesh");
  refused(with("\n<triangles", vertices), ": a second element vertices in a mesh; repair the mesh");
  std::string other = part("<geometry", "</geometry>");
  EXPECT_EQ(triangles(with("</library_geometries>", other.replace(other.find("\"g\""), 3, "\"h\""))), 4u);
}

std::vector<Vec3> dae_corners(const Mesh& mesh) {
  std::vector<Vec3> corners;
  for (const Triangle& t : mesh.triangles)
    for (const auto v : t) corners.push_back(mesh.vertices[v]);
  return corners;
}

// Found by grammar: assimp took a fan for a polygon, which is cut in another way where it is not flat.
TEST_F(Dae, FansAndStrips) {
  const Vec3 o{0, 0, 0}, x{1, 0, 0}, y{0, 1, 0}, z{0, 0, 1};
  const Mesh fan = read(Collada{.kind = "trifans", .count = "1", .indices = "0 1 2 3"}.text());
  EXPECT_EQ(dae_corners(fan), (std::vector{o, x, y, o, y, z}));
  const Mesh strip = read(Collada{.kind = "tristrips", .count = "1", .indices = "0 1 2 3"}.text());
  EXPECT_EQ(dae_corners(strip), (std::vector{o, x, y, y, x, z}));
  refused(Collada{.kind = "trifans", .count = "1", .indices = "0 1"}.text(), "2 indices do not fit trifans");
}

// Lines add no triangles; polygons with holes would be other ones.
TEST_F(Dae, LinesAndHoles) {
  std::string text = Collada().text();
  text.insert(text.find("\n<triangles"),
              R"(<lines count="1"><input semantic="VERTEX" source="#v"/><p>0 1</p></lines>)");
  EXPECT_EQ(triangles(text), 4u);
  const Collada holes{
      .kind = "polygons", .count = "1", .more = "<ph><p>0 1 2</p><h>0 1 3</h></ph>", .indices = "0 1 2"};
  refused(holes.text(), "polygons with holes (ph) are not read; triangulate the mesh");
}

TEST_F(Dae, PositionsAreThere) {
  const std::string good = Collada().text();
  const auto with = [&](const std::string& part, const std::string& other) {
    std::string text = good;
    return text.replace(text.find(part), part.size(), other);
  };
  refused(Collada{.count = "1", .indices = "0 1 4"}.text(),
          ":line 3: vertex index 4 is out of range, there are 4 vertices");
  refused(with("0 0 0 1 0 0", "0 0 0 1,5,2 0 0"),
          "element float_array must hold numbers, found '1,5,2'; repair the mesh");
  EXPECT_EQ(read(with("0 0 0 1 0 0", "0 0 0 1,5 0 0")).vertices[1].x, 1.5);
  refused(with(" 0 0 1</float", "        1</float"), "an array of 12 values holds 10; repair the mesh");
  refused(with("source=\"#v\"", "source=\"#w\""), "the input VERTEX names 'w', which is no element vertices before it");
  refused(with("source=\"#s\"", "source=\"#t\""), "the positions 't' are no source before them");
  refused(with("source=\"#a\"", "source=\"#b\""), "there is no float_array 'b' before");
  refused(with(R"(<param name="Z" type="float"/>)", ""), "the positions 's' have no X, Y and Z");
  refused(Collada{.stride = "0"}.text(), "the positions 's' have no X, Y and Z");
  refused(with("0 0 0 1 0 0", "0 0 0 inf 0 0"), "a coordinate is not a finite number");
  // Params may come in any order: here the file has y, x, z.
  const Mesh turned =
      read(with(R"(name="X" type="float"/><param name="Y")", R"(name="Y" type="float"/><param name="X")"));
  EXPECT_EQ(turned.vertices[1], (Vec3{0, 1, 0}));
}

// Names are compared as XML means them, however they are written.
TEST_F(Dae, NamesMayBeEscaped) {
  EXPECT_EQ(triangles(Collada{.nodes = R"(<node><instance_geometry url="#&#103;"/></node>)"}.text()), 4u);
  EXPECT_EQ(triangles(Collada{.nodes = R"(<node id="&lt;&amp;" ><instance_geometry url="#g"/></node>)"
                                       R"(<node><instance_node url="#&#x3c;&#38;"/></node>)"}
                          .text()),
            8u);
}

class DaeTransforms : public Dae {
 protected:
  // Where a node of these transforms puts (0, 0, 0), (1, 0, 0), (0, 1, 0) and (0, 0, 1).
  void expect(const std::string& transforms, std::initializer_list<Vec3> expected) const {
    SCOPED_TRACE(transforms);
    const Mesh mesh = read(Collada{.nodes = "<node>" + transforms + R"(<instance_geometry url="#g"/></node>)"}.text());
    ASSERT_EQ(mesh.vertices.size(), expected.size());
    for (std::size_t v = 0; v < expected.size(); ++v)
      EXPECT_LT(max_norm(mesh.vertices[v] - expected.begin()[v]), 1e-14) << v;
  }
};

TEST_F(DaeTransforms, EachKind) {
  expect("<matrix>1 2 3 4 0 1 0 5 0 0 1 6 0 0 0 1</matrix>", {{4, 5, 6}, {5, 5, 6}, {6, 6, 6}, {7, 5, 7}});
  expect("<translate>1 2\n3</translate>", {{1, 2, 3}, {2, 2, 3}, {1, 3, 3}, {1, 2, 4}});
  expect("<scale>2 3 -1</scale>", {{0, 0, 0}, {2, 0, 0}, {0, 3, 0}, {0, 0, -1}});
  expect("<rotate>0 0 7 90</rotate>", {{0, 0, 0}, {0, 1, 0}, {-1, 0, 0}, {0, 0, 1}});
  expect("<rotate>0 0 0 0</rotate>", {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}});
  // One after the other: moved first, as it stands last.
  expect("<rotate>0 0 1 90</rotate><translate>1 0 0</translate>", {{0, 1, 0}, {0, 2, 0}, {-1, 1, 0}, {0, 1, 1}});
  // From (5, 0, 0) along x, with z up: right is -y, and what is behind is on the side of z. Up need not be at right
  // angles.
  expect("<lookat>5 0 0 9 0 0 1 0 2</lookat>", {{5, 0, 0}, {5, -1, 0}, {5, 0, 1}, {4, 0, 0}});
  // y turns towards x by 45 degrees.
  expect("<skew>45 0 1 0 1 0 0</skew>", {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 0, 1}});
  // z turns by 45 degrees towards what is 45 degrees from it: there it would never come.
  refused(Collada{.nodes = "<node><skew>50 0 0 1 0 1 1</skew><instance_geometry url='#g'/></node>"}.text(),
          "the angle of a skew is too large");
}

TEST_F(Dae, DamagedTransforms) {
  const auto node = [](const std::string& transform) {
    return Collada{.nodes = "<node>" + transform + R"(<instance_geometry url="#g"/></node>)"}.text();
  };
  refused(node("<translate>1 2</translate>"), "element translate must hold 3 finite numbers, found ''");
  refused(node("<translate>1 2 3 4</translate>"), "must hold 3 finite numbers, and '4' follows");
  refused(node("<scale>1 nan 1</scale>"), "element scale must hold 3 finite numbers, found 'nan'");
  refused(node("<rotate>0 0 0 5</rotate>"), "element rotate gives no direction");
  refused(node("<lookat>0 0 0 1 0 0 1 0 0</lookat>"), "element lookat gives no direction");
  refused(node("<matrix>1 0 0 0 0 1 0 0 0 0 1 0 0 0 0 2</matrix>"), "the last row of a node's matrix is not 0 0 0 1");
}

TEST_F(Dae, UnitAndAxes) {
  const auto with = [](const std::string& asset) {
    std::string text = Collada().text();
    const std::string plain = "<up_axis>Y_UP</up_axis>";
    return text.replace(text.find(plain), plain.size(), asset);
  };
  const auto [mesh, report] = read_mesh(folder.file("a.dae", with("<unit meter='0.0254'/><up_axis> Z_UP </up_axis>")));
  EXPECT_EQ(mesh.vertices[3], (Vec3{0, 0.0254, 0}));
  EXPECT_EQ(report.axes, (std::array<int, 3>{1, 3, -2}));
  EXPECT_EQ(report.unit_scale, 0.0254);
  EXPECT_EQ(report.metres_per_unit, 1);
  EXPECT_EQ(read(with("<unit meter='0,010000'/>")).vertices[1].x, 0.01);  // as 3ds Max writes it in some countries
  EXPECT_EQ(read(with("<up_axis>X_UP</up_axis>")).vertices[1], (Vec3{0, 1, 0}));
  EXPECT_EQ(read(with("")).vertices[1], (Vec3{1, 0, 0}));
  refused(with("<unit meter='0'/>"), "the unit's meter must be a positive number, found '0'");
  refused(with("<unit meter='cm'/>"), "the unit's meter must be a positive number, found 'cm'");
}

// A skin or a morph is the geometry that it moves, through others too.
TEST_F(Dae, Controllers) {
  const std::string library =
      R"(<library_controllers><controller id="k"><skin source="#m"><source id="x"/></skin></controller>)"
      R"(<controller id="m"><morph source="#g"/></controller>)"
      R"(<controller id="r"><skin source="#r"/></controller></library_controllers>)";
  const auto placed = [&](const std::string& id) {
    return Collada{.library = library, .nodes = "<node><instance_controller url='#" + id + "'/></node>"}.text();
  };
  EXPECT_EQ(triangles(placed("k")), 4u);
  EXPECT_EQ(triangles(placed("m")), 4u);
  refused(placed("r"), "the file holds no triangles");
  refused(placed("none"), "the file holds no triangles");
  refused(Collada{.nodes = "<node><instance_geometry url='other.dae#g'/></node>"}.text(),
          "what an instance_geometry names, 'other.dae#g', is not in this file");
}

TEST_F(Dae, ScenesThatAreNotThere) {
  std::string none = Collada().text(), other = none;
  const std::string scene = R"(<scene><instance_visual_scene url="#vs"/></scene>)";
  refused(none.replace(none.find(scene), scene.size(), ""), "it has no element instance_visual_scene");
  refused(other.replace(other.find("url=\"#vs\""), 9, "url=\"#no\""), "the scene that it shows, 'no', is not there");
  refused("<?xml version='1.0'?><a><COLLADA/></a>", "the outermost element is not COLLADA");
}

TEST_F(Dae, NodesUnfold) {
  const std::string instance = R"(<instance_node url="#)";
  refused(Collada{.nodes = R"(<node id="n"><instance_node url="#n"/></node>)"}.text(), "a node instances itself");
  refused(Collada{.nodes = R"(<node name="n"><node><instance_node url="#n"/></node></node>)"}.text(),
          "a node instances itself");
  refused(Collada{.nodes = R"(<node id="n"><instance_node url="#&#110;"/></node>)"}.text(), "a node instances itself");
  std::string doubling, chain;
  for (int n = 0; n < 5000; ++n) {
    const std::string node = "<node id=\"n" + std::to_string(n) + "\">",
                      next = instance + "n" + std::to_string(n + 1) + "\"/>";
    if (n < 40) doubling += node + next + next + "</node>";
    chain += node + next + "</node>";
  }
  refused(Collada{.nodes = doubling}.text(), "unfold to more than 500000; instance fewer");
  refused(Collada{.nodes = chain}.text(), "nested too deep");
  refused(Collada{.nodes = nested(200'000, "<node>", "</node>")}.text(), "nested more than 500 deep");
  EXPECT_EQ(triangles(Collada{.nodes = Collada().nodes + nested(450, "<node>", "</node>")}.text()), 4u);
}

// What is not looked at may be as it likes; nodes are bounded.
TEST_F(Dae, PartsHaveANumber) {
  const auto entries = [](int number, const std::string& entry) {
    return Collada{.library = "<library_x>" + repeated_text(number, entry) + "</library_x>"}.text();
  };
  EXPECT_EQ(triangles(entries(100'000, "<material/>")), 4u);
  EXPECT_EQ(
      triangles(
          Collada{.nodes = repeated_text(10'000, "<node><instance_light url='#l'/></node>") + Collada().nodes}.text()),
      4u);
  refused(Collada{.nodes = repeated_text(500'001, "<node/>")}.text(), "unfold to more than 500000; instance fewer");
  // Each of these nodes places the tetrahedron's one list of faces, and is a node itself.
  const std::string node = "<node><instance_geometry url='#g'/></node>";
  EXPECT_EQ(triangles(Collada{.nodes = repeated_text(50'000, node)}.text()), 200'000u);
  refused(Collada{.nodes = repeated_text(250'001, node)}.text(), "unfold to more than 500000; instance fewer");
}

TEST_F(Dae, NodesWithoutMeshesAreNoMesh) {
  refused(Collada{.nodes = "<node><translate>1 0 0</translate><node/></node>"}.text(), "the file holds no triangles");
}

TEST_F(Dae, OneNodeMayPlaceAGeometryTwice) {
  const std::string instance = "<instance_geometry url='#g'/>";
  EXPECT_EQ(triangles(Collada{.nodes = "<node>" + instance + instance + "</node>"}.text()), 8u);
  EXPECT_EQ(triangles(Collada{.nodes = repeated_text(2, "<node>" + instance + "</node>")}.text()), 8u);
}

TEST_F(Dae, ShapesUnfold) {
  constexpr int kTimes = 6000;
  const std::string instance = R"(<instance_geometry url="#g"/>)",
                    nodes = repeated_text(kTimes, "<node>" + instance + "</node>");
  Collada shape{.count = "4000", .indices = repeated_text(4000, "0 1 2 ")};
  const auto too_far = [&](const std::string& text) {
    const auto path = folder.file("a.dae", text);
    expect_error([&] { read_mesh(path); }, ErrorCode::limit,
                 "its nodes place meshes until they have 18000 vertices and 24000000 triangles");
  };
  shape.nodes = nodes;
  too_far(shape.text());
  shape.nodes = "<node>" + repeated_text(kTimes, instance) + "</node>";
  too_far(shape.text());
  shape.library = "<library_nodes><node id='n'>" + nodes + "</node></library_nodes>";
  shape.nodes = R"(<node><instance_node url="#n"/></node>)";
  too_far(shape.text());
  shape.library = "<library_controllers><controller id='k'><skin source='#g'/></controller></library_controllers>";
  shape.nodes = "<node>" + repeated_text(kTimes, R"(<instance_controller url="#k"/>)") + "</node>";
  too_far(shape.text());
}

TEST_F(Dae, ArraysFit) {
  refused(Collada{.floats = "2000000001"}.text(), "an array of 2000000001 values in 23 characters");
}

// A name of the file came back in the message, all 8,600 bytes of it.
TEST_F(Dae, MessagesAreCutToALine) {
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

TEST_F(Dae, PackedFilesAreReadToo) {
  EXPECT_EQ(read_mesh(folder.file("a.dae.gz", packed_text(Collada().text()))).mesh.triangles.size(), 4u);
}

TEST_F(Dae, NoPlainXml) {
  refused(Collada{.before = "<!DOCTYPE COLLADA [<!ENTITY a \"1\">]>"}.text(), "a document type is not read");
  refused(Collada().text() + std::string(1, '\0'), "a zero byte");
  refused(Collada{.before = "<!-- "}.text(), "a comment or section without an end");
  refused(Collada{.before = "<a b>"}.text(), "a damaged tag");
  std::string crossed = Collada().text();
  refused(crossed.replace(crossed.find("</mesh>"), 7, "</maze>"), "the element mesh ends as maze; repair the file");
  const std::string whole = Collada().text();
  for (std::size_t size = 60; size < whole.size(); size += 7) refused(whole.substr(0, size), "a.dae");
}

}  // namespace
}  // namespace standoff
