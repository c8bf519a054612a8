// SPDX-License-Identifier: Apache-2.0
// A file that a grammar made, and what a reader must find in it.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "standoff/field.h"
#include "standoff/vec.h"
#include "tests/grammar/choices.h"

namespace standoff::grammar {

using Corners = std::array<Vec3, 3>;

/// What a good file holds.
struct Truth {
  std::vector<Corners> triangles;  ///< of a mesh
  /// Where nodes place triangles: how far corners may be off, of each triangle, for it is done in float; the order is
  /// not known. Empty: they are exact, and in the file's order.
  std::vector<double> slack;

  std::vector<Vec3> points;  ///< of a file of points

  Grid grid;  ///< of a field
  double thickness = 0;
  std::vector<float> values;
  std::vector<std::uint32_t> nearest;  ///< empty: none
};

struct File {
  std::string bytes;
  /// Files that lie beside it: name and content.
  std::vector<std::pair<std::string, std::string>> beside;
  Truth truth;  ///< where no trick was played
  /// It holds what the format allows and our readers need not take: refused or read as it is, but never otherwise.
  bool may_be_refused = false;
};

enum class Kind { mesh, field, body, points };

/// A row for each format.
struct Grammar {
  const char* extension;
  Kind kind;
  File (*make)(Choices&);
};

File make_stl(Choices&);
File make_ply(Choices&);
File make_obj(Choices&);
File make_obj_gz(Choices&);
File make_off(Choices&);
File make_medit(Choices&);
File make_3ds(Choices&);
File make_3mf(Choices&);
File make_gltf(Choices&);
File make_glb(Choices&);
File make_dae(Choices&);
File make_vti(Choices&);
File make_nrrd(Choices&);
File make_npz(Choices&);
File make_vdb(Choices&);
File make_nvdb(Choices&);
File make_body(Choices&);
File make_csv_points(Choices&);
File make_npy_points(Choices&);

inline constexpr Grammar kGrammars[] = {
    {"gltf", Kind::mesh, make_gltf},        {"glb", Kind::mesh, make_glb},   {"dae", Kind::mesh, make_dae},
    {"ply", Kind::mesh, make_ply},          {"obj", Kind::mesh, make_obj},   {"obj.gz", Kind::mesh, make_obj_gz},
    {"off", Kind::mesh, make_off},          {"stl", Kind::mesh, make_stl},   {"mesh", Kind::mesh, make_medit},
    {"3ds", Kind::mesh, make_3ds},          {"3mf", Kind::mesh, make_3mf},   {"vti", Kind::field, make_vti},
    {"nrrd", Kind::field, make_nrrd},       {"npz", Kind::field, make_npz},  {"vdb", Kind::field, make_vdb},
    {"nvdb", Kind::field, make_nvdb},       {"body", Kind::body, make_body}, {"csv", Kind::points, make_csv_points},
    {"npy", Kind::points, make_npy_points},
};

/// Names that files refer to which must not be opened. Who runs a grammar makes them beside its files: a pipe that
/// nobody writes to, a folder, a link to itself, and outside of the folder a file of these bytes.
inline constexpr const char *kPipe = "pipe.bin", *kFolder = "folder.bin", *kLoop = "loop.bin",
                            *kOutside = "../outside.bin";

}  // namespace standoff::grammar
