// SPDX-License-Identifier: Apache-2.0
#include "cli/iso_report.h"

#include "cli/files.h"
#include "cli/text.h"

namespace standoff::cli {

void say(const IsoResult& found, const std::string& output, const Console& console) {
  const IsoReport& report = found.report;
  if (!report.sign.why.empty()) console.say("sign: " + report.sign.why + (report.sign.sure ? "" : " (not certain)"));
  console.say(mesh_line(output, found.mesh) + (report.floats ? "" : ", 64-bit coordinates"));
  if (report.examined) {
    console.say(counted(report.components, "component") + ", " + (report.intersections_known ? "" : "at least ") +
                counted(report.self_intersections, "self-intersection"));
  }
  if (report.capped > 0)
    console.warn("the solid reaches the border of the grid and was cut off there; take a larger grid");
  if (report.clamped > 0)
    console.warn(counted(report.clamped, "edge") +
                 " of the grid that the surface crosses: values there are clamped to the field's thickness, so that "
                 "vertices are not accurate; compute the field with a larger thickness");
  if (!report.lost.empty()) console.warn(report.lost);
  console.detail(counted(report.ambiguous_faces, "ambiguous face") + "; vertices keep " + number(report.clearance) +
                 " spacings from samples");
}

Json iso_json(const std::string& input, const IsoSubject& subject, const IsoOptions& options, const IsoResult& found,
              const std::filesystem::path& output) {
  const IsoReport& report = found.report;
  Json json = json_answer("iso");
  json["kind"] = subject.kind;
  json["input"] = {{"file", input}};
  json["grid"] = json_grid(subject.grid);
  json["at"] = options.at;
  json["wall"] = options.wall;
  json["method"] = options.method == IsoMethod::dual ? "dual" : "marching-cubes";
  json["surface"] = {
      {"triangles", report.triangles}, {"vertices", report.vertices}, {"ambiguous_faces", report.ambiguous_faces},
      {"clamped", report.clamped},     {"capped", report.capped},     {"floats", report.floats},
      {"clearance", report.clearance}};
  if (report.examined) {
    json["surface"]["components"] = report.components;
    json["surface"]["self_intersections"] = report.self_intersections;
    json["surface"]["intersections_known"] = report.intersections_known;
  }
  if (std::string(subject.kind) == "mesh")
    json["lost"] = {{"share", report.lost_share},
                    {"parts", report.parts},
                    {"lost_parts", report.lost_parts},
                    {"thickness", report.lost_thickness},
                    {"what", report.lost}};
  if (std::string(subject.kind) == "mesh")
    json["sign"] = {{"method", name_of(report.sign.method)}, {"why", report.sign.why}, {"sure", report.sign.sure}};
  json["output"] = json_output(output);
  return json;
}

}  // namespace standoff::cli
