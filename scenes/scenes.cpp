// SPDX-License-Identifier: Apache-2.0
// The table of scenes.
#include "scenes/scenes.h"

#include "scenes/families.h"
#include "standoff/error.h"

namespace standoff::scenes {
namespace {

using Make = Mesh (*)(std::int64_t triangles);

// How an assembly of parts becomes a mesh of the wanted size and extent.
struct Assembly {
  Draw draw = nullptr;
  Vec3 extent;              // of the finished mesh, in world units
  double edge = 0;          // the target edge for the scene's own count
  double slender = 1;       // see Builder
  double paired_share = 0;  // see Builder: sets how many triangles the thesis's skip rule drops
};

struct Entry {
  const char* name;
  const char* description;
  std::int64_t triangles;
  Make make = nullptr;  // either this
  Assembly assembly;    // or this
};

// Extents: the thesis prints the samples of its minimum grids, ceil(extent + 4) at thickness 2 and e = 2; where it also
// prints a grid of the mesh scaled by 20 (or 30, process), samples = ceil(20 * extent + 4) gives a second digit.
// paired_share and the numbers of parts are tuned so that the skip rule drops, and Algorithm 1 examines, about as
// many as the thesis reports (tests/scenes/thesis_counts_test.cpp).
const Entry kEntries[] = {
    {"factory",
     "a factory hall: frame, roof, machines, tanks, pipe racks, catwalks, conveyors",
     2889536,
     nullptr,
     {draw_factory, {10.6, 2.8, 12.7}, 0.024, 1, 0.025}},
    {"machine_1",
     "a paper machine: presses, drying cylinders, gears, drives, walkways",
     481888,
     nullptr,
     {draw_machine_1, {6.4, 5.4, 22.95}, 0.05, 0.9, 0.02}},
    {"machine_2",
     "the paper machine with its small parts",
     1444768,
     nullptr,
     {draw_machine_2, {6.35, 5.4, 22.95}, 0.03, 1, 0.06}},
    {"our_process",
     "a pulp line: vessels, drums, a screw conveyor, pumps, piping",
     65356,
     nullptr,
     {draw_our_process, {6.1, 2.55, 21.1}, 0.1, 2.5, 0.25}},
    {"our_process_small",
     "the pulp line with a stack, small triangles",
     74745,
     nullptr,
     {draw_our_process_small, {6.1, 16.4, 21.15}, 0.09, 2.5, 0.2}},
    {"our_process_large",
     "the pulp line with a low stack and a tank, large triangles",
     16599,
     nullptr,
     {draw_our_process_large, {7.75, 4.6, 21.1}, 0.3, 1, 0.5}},
    {"plane", "an aeroplane with two propellers", 58421, nullptr, {draw_plane, {11.8, 1.9, 6.9}, 0.05, 8, 0.16}},
    {"bender", "a standing robot with spread arms", 12034, nullptr, {draw_bender, {7.7, 5.8, 1.9}, 0.15, 4, 0.4}},
    {"catapult",
     "a catapult of beams, wheels and ropes: few and large triangles",
     9618,
     nullptr,
     {draw_catapult, {4.9, 3.9, 2.9}, 0.2, 100, 1}},
    {"process", "vessels joined by piping", 8100, nullptr, {draw_process, {0.4, 0.46666, 0.16666}, 0.2, 0.8, 0.22}},
    {"labyrinth", "the walls of a maze", 217000, nullptr, {draw_labyrinth, {140.8, 9.75, 136.2}, 1, 1, 0.1}},
    {"fly", "an insect: body, eyes, wings, legs", 6500, nullptr, {draw_fly, {3.2, 1.8, 3}, 0.15, 1, 0.1}},
    {"sphere", "the unit sphere", 20000, make_sphere, {}},
    {"box", "the box from (-1, -0.75, -0.5) to (1, 0.75, 0.5)", 12, make_box, {}},
    {"terrain", "a mountain range, open below", 200000, make_terrain, {}},
    {"slivers", "long triangles down to a width of 1e-8", 20000, make_slivers, {}},
    {"degenerate", "a sphere and triangles without area", 20000, make_degenerate, {}},
    {"duplicate", "a sphere four times in the same place, once inside out", 20000, make_duplicate, {}},
    {"soup", "loose triangles of many sizes", 20000, make_soup, {}},
    {"nested", "spheres inside spheres, some inside out", 19200, make_nested, {}},
    {"open",
     "surfaces with boundaries: hemisphere, tube, Moebius strip, three sheets on one edge",
     20000,
     make_open,
     {}},
    {"one_triangle", "a single triangle", 1, make_one_triangle, {}},
    {"far_away", "the fly, a million units from the origin on every axis", 6500, make_far_away, {}},
    {"tiny", "the fly, a few millionths of a unit long", 6500, make_tiny, {}},
};

// Scales and moves a mesh to the extent, standing on y = 0 and centred on the y axis.
void fit(Mesh& mesh, Vec3 extent) {
  const Box box = bounds(mesh);
  const Vec3 scale = extent / box.extent();
  const Vec3 base{box.center().x, box.min.y, box.center().z};
  for (Vec3& v : mesh.vertices) v = (v - base) * scale;
}

Mesh make_assembly(const Assembly& assembly, std::int64_t triangles) {
  const double edge = edge_for(assembly.draw, triangles, assembly.edge, assembly.slender);
  Builder b(edge, false, assembly.slender, assembly.paired_share);
  assembly.draw(b);
  Mesh mesh = b.take();
  split_to(mesh, triangles);
  fit(mesh, assembly.extent);
  return mesh;
}

[[noreturn]] void fail(const std::string& what) { throw Error(ErrorCode::usage, "scene: " + what); }

const Entry& entry(std::string_view name) {
  for (const Entry& e : kEntries)
    if (name == e.name) return e;
  std::string known;
  for (const Entry& e : kEntries) known += std::string(known.empty() ? "" : ", ") + e.name;
  fail("no scene is called '" + std::string(name) + "'; take one of " + known);
}

}  // namespace

std::vector<Scene> all() {
  std::vector<Scene> scenes;
  for (const Entry& e : kEntries) scenes.push_back({e.name, e.description, e.triangles});
  return scenes;
}

Mesh make(std::string_view name, std::int64_t triangles) {
  const Entry& e = entry(name);
  if (triangles < 0 || triangles > kMostTriangles)
    fail("cannot make " + std::to_string(triangles) + " triangles; ask for 1 to " + std::to_string(kMostTriangles) +
         ", or 0 for the scene's own count");
  const std::int64_t wanted = triangles == 0 ? e.triangles : triangles;
  return e.make != nullptr ? e.make(wanted) : make_assembly(e.assembly, wanted);
}

}  // namespace standoff::scenes
