// SPDX-License-Identifier: Apache-2.0
#include "cli/compute_report.h"

#include <algorithm>
#include <cmath>

#include "cli/files.h"
#include "cli/memory.h"
#include "cli/text.h"
#include "standoff/error.h"
#include "standoff/field.h"
#include "standoff/slabs.h"

namespace standoff::cli {
namespace {

std::int64_t tile_count(Size3 samples) { return DistanceField::tiles_of(samples).count(); }

// What a file of the output's format takes at most, but for a header of less than 4 KiB: it has the samples as they
// are, or packs them. Trees have whole tiles and tables of them.
double most_file_bytes(const Plan& plan, const ComputeOptions& options) {
  if (plan.output.ends_with(".vdb") || plan.output.ends_with(".nvdb")) {
    const auto tiles = static_cast<double>(tile_count(plan.choice.grid.size));
    return 2300 * tiles + 40'000 * (tiles / 512 + 1) + 300'000 * (tiles / 262'144 + 1);
  }
  const double bytes = (options.nearest_triangle ? 8.0 : 4.0) + static_cast<double>(options.bytes_beside);
  return bytes * static_cast<double>(plan.choice.grid.sample_count());
}

Json description(const Plan& plan) {
  const Box box = bounds(plan.mesh);
  Json json = json_answer("compute");
  json["mesh"] = {{"file", plan.mesh_name},
                  {"triangles", plan.mesh.triangles.size()},
                  {"vertices", plan.mesh.vertices.size()},
                  {"bounds", json_box(box)}};
  json["grid"] = json_grid(plan.choice.grid);
  json["thickness"] = json_number(plan.choice.thickness);
  return json;
}

std::string confidence_line(const SignConfidence& found) {
  const auto percent = [](double share) { return number(100 * share) + " %"; };
  return "confidence: of " + counted(found.samples, "sample") + " in the band " + percent(found.doubtful) +
         " are doubtful, lines along the three axes disagree about " + percent(found.axes_disagree) +
         ", and a flood from outside about " + percent(found.flood_disagrees);
}

std::string sign_line(const SignReport& sign) {
  const std::string method =
      sign.method == SignMethod::none ? "no sign" : std::string("sign by ") + name_of(sign.method);
  return method + ": " + sign.why + (sign.sure ? "" : "; not certain");
}

}  // namespace

std::string grid_line(const GridChoice& choice) {
  const std::string band =
      std::isinf(choice.thickness) ? "full field" : "band of thickness " + number(choice.thickness);
  return "grid " + size_text(choice.grid.size) + ", spacing " + spacing_text(choice.grid.spacing) + ", " + band;
}

void tell(const Plan& plan, const ComputeOptions& options, const Console& console) {
  const Grid& grid = plan.choice.grid;
  const std::int64_t needed = plan.in_slabs ? slab_memory_needed(plan.mesh, grid, plan.choice.thickness, options)
                                            : memory_needed(plan.mesh, grid, plan.choice.thickness, options),
                     limit = options.memory_limit;
  const std::string memory = "needs at most " + bytes_text(needed) + " beside the mesh";
  const std::string over = ", more than the limit of " + bytes_text(limit);
  const auto file_bytes = static_cast<std::int64_t>(std::min(most_file_bytes(plan, options), 0x1p62));
  if (console.json()) {
    Json json = description(plan);
    json["samples"] = {{"total", grid.sample_count()}};
    json["tiles"] = {{"total", tile_count(grid.size)}};
    json["seconds"] = {{"load", plan.load_seconds}};
    json["memory_needed_bytes"] = needed;
    json["memory_limit_bytes"] = limit;
    json["dry_run"] = true;
    json["output"] = {{"file", plan.output}, {"bytes", file_bytes}, {"in_the_way", plan.in_the_way}};
    print(json);
  } else {
    print(mesh_line(plan.mesh_name, plan.mesh) + "\n" + grid_line(plan.choice) + "\n" +  //
          "from " + point_text(grid.origin) + " to " + point_text(grid.bounds().max) + ", " +
          counted(grid.sample_count(), "sample") + " in " + counted(tile_count(grid.size), "tile") + "\n" +  //
          memory + (needed > limit ? over : "") + "\n" +                                                     //
          "would write " + plan.output + ", at most " + bytes_text(file_bytes) +
          (plan.in_the_way ? "; it exists: give -f to overwrite it" : "") + "\n");
  }
  if (needed > limit)
    throw Error(ErrorCode::limit, "compute: the field " + memory + over +
                                      "; take fewer samples, a smaller thickness, or a larger --memory-limit");
}

void say(const Outcome& outcome, const Console& console) {
  const ComputeReport& report = outcome.report;
  const double load = outcome.plan.load_seconds, prepare = report.seconds.prepare, compute = report.seconds.compute,
               sign = report.seconds.sign, write = outcome.write_seconds;
  // Doubt is said aloud where the caller chose the method; who leaves it to the diagnosis asked for a line.
  if (!report.sign.why.empty())
    report.sign.sure ? console.say(sign_line(report.sign)) : console.warn(sign_line(report.sign));
  if (outcome.confidence) console.say(confidence_line(*outcome.confidence));
  if (report.sign.internal > 0) console.say(counted(report.sign.internal, "triangle") + " inside the union left out");
  if (report.sign.cut > 0)
    console.warn(counted(report.sign.cut, "triangle") +
                 " that others cut are kept: distances inside, near them, are too small");
  if (report.skipped > 0) console.say(counted(report.skipped, "triangle") + " skipped");
  console.detail(counted(report.samples_band, "sample") + " in the band, " + grouped(report.tiles_stored) + " of " +
                 counted(report.tiles, "tile") + " stored, " + counted(report.samples_examined, "distance") +
                 " computed");
  console.detail("load " + seconds_text(load) + ", prepare " + seconds_text(prepare) + ", compute " +
                 seconds_text(compute) + (sign > 0 ? ", sign " + seconds_text(sign) : "") + ", write " +
                 seconds_text(write) + "; peak memory " + bytes_text(peak_memory_bytes()));
  console.say(outcome.plan.output + ": " + bytes_text(outcome.written_bytes) + " in " +
              seconds_text(load + prepare + compute + sign + write) + "; " + report.method + " on " + report.backend +
              " (" + report.device + "), " + counted(report.threads, "thread"));
}

Json outcome_json(const Outcome& outcome) {
  const ComputeReport& report = outcome.report;
  Json json = description(outcome.plan);
  json["mesh"]["skipped"] = report.skipped;
  json["mesh"]["hash"] = hash_text(outcome.mesh_hash);
  json["sign"] = {{"method", name_of(report.sign.method)},
                  {"why", report.sign.why},
                  {"sure", report.sign.sure},
                  {"flipped", report.sign.flipped},
                  {"left_out", report.sign.left_out},
                  {"boundary_edges", report.sign.boundary_edges},
                  {"internal", report.sign.internal},
                  {"cut", report.sign.cut}};
  if (const auto& found = outcome.confidence)
    json["sign"]["confidence"] = {{"samples", found->samples},
                                  {"doubtful", found->doubtful},
                                  {"axes_disagree", found->axes_disagree},
                                  {"flood_disagrees", found->flood_disagrees}};
  json["samples"] = {{"total", report.samples}, {"examined", report.samples_examined}, {"band", report.samples_band}};
  json["tiles"] = {{"total", report.tiles}, {"stored", report.tiles_stored}};
  json["seconds"] = {{"load", outcome.plan.load_seconds},
                     {"prepare", report.seconds.prepare},
                     {"compute", report.seconds.compute},
                     {"sign", report.seconds.sign},
                     {"write", outcome.write_seconds}};
  json["peak_memory_bytes"] = peak_memory_bytes();
  json["method"] = report.method;
  json["device"] = report.backend;
  json["device_name"] = report.device;
  json["threads"] = report.threads;
  json["dry_run"] = false;
  json["output"] = {{"file", outcome.plan.output}, {"bytes", outcome.written_bytes}};
  return json;
}

}  // namespace standoff::cli
