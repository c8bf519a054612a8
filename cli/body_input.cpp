// SPDX-License-Identifier: Apache-2.0
#include "cli/body_input.h"

#include <limits>

#include "cli/options.h"
#include "cli/parse.h"
#include "cli/spinner.h"
#include "standoff/error.h"

namespace standoff::cli {

CollisionModel read_body(const std::string& name, const Console& console) {
  if (kind_of(name) == FileKind::body)
    return with_spinner(console, "reading " + name, [&] { return CollisionModel::load(name); });
  MeshInput input;
  input.set_name(name);
  const Mesh mesh = with_spinner(console, "reading " + name, [&] { return input.read(); });
  try {
    return with_spinner(console, "building the body of " + name, [&] { return CollisionModel(mesh); });
  } catch (const Error& error) {
    throw Error(error.code(), name + ": " + error.what());
  }
}

void PairInput::add_to(CLI::App& verb) {
  verb.add_option("A", a_, "a mesh file, scene:NAME[:TRIANGLES], or a body that standoff build made")->required();
  verb.add_option("B", b_, "the other one")->required();
  add_pose(verb, "--pose-a", "where A is (default: where its file puts it)", pose_a_);
}

void PairInput::check() const {
  for (const std::string& name : {a_, b_}) check_input(name);
}

CLI::Option* add_pose(CLI::App& verb, const char* name, const char* help, Pose& pose) {
  return add_parsed(verb, {name, "POSE", help, "Place"},
                    [&pose](const std::string& o, const std::string& t) { pose = parse_pose(o, t); });
}

void add_body(Json& json, const CollisionModel& body) {
  json["mesh"] = {{"triangles", body.mesh().triangles.size()},
                  {"vertices", body.mesh().vertices.size()},
                  {"bounds", json_box(body.bounds())}};
  json["closed"] = body.closed();
  json["grid"] = json_grid(body.grid());
  json["thickness"] = body.thickness();
  json["memory_bytes"] = body.memory_bytes();
}

}  // namespace standoff::cli
