#include "cli/body_input.h"

#include <limits>

#include "cli/option.h"
#include "cli/parse.h"

namespace difi::cli {

CollisionModel read_body(const std::string& name) {
  if (name.ends_with(".body")) return CollisionModel::load(name);
  MeshInput mesh;
  mesh.set_name(name);
  return CollisionModel(mesh.read());
}

void PairInput::add_to(CLI::App& verb) {
  verb.add_option("A", a_, "a mesh file, scene:NAME[:TRIANGLES], or a body saved as .body")->required();
  verb.add_option("B", b_, "the other one")->required();
  add_pose(verb, "--pose-a", "where A is (default: where its file puts it)", pose_a_);
}

CLI::Option* add_pose(CLI::App& verb, const char* name, const char* help, Pose& pose) {
  return add_parsed(verb, {name, "POSE", help, "Place"},
                    [&pose](const std::string& o, const std::string& t) { pose = parse_pose(o, t); });
}

Json json_triangle(std::uint32_t triangle) {
  if (triangle == std::numeric_limits<std::uint32_t>::max()) return nullptr;
  return triangle;
}

}  // namespace difi::cli
