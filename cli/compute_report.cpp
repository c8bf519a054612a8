#include "cli/compute_report.h"

#include <cmath>

#include "cli/files.h"
#include "cli/memory.h"
#include "cli/text.h"
#include "standoff/field.h"
#include "standoff/version.h"

namespace standoff::cli {
namespace {

std::int64_t tile_count(Size3 size) {
  constexpr std::int64_t side = DistanceField::kTileSide;
  return ((size.x + side - 1) / side) * ((size.y + side - 1) / side) * ((size.z + side - 1) / side);
}

std::int64_t bytes_needed(const Plan& plan, const ComputeOptions& options) {
  return memory_needed(plan.mesh, plan.choice.grid, plan.choice.thickness, options);
}

Json description(const Plan& plan) {
  const Box box = bounds(plan.mesh);
  const Grid& grid = plan.choice.grid;
  return {
      {"version", version()},
      {"mesh",
       {{"file", plan.mesh_name},
        {"triangles", plan.mesh.triangles.size()},
        {"vertices", plan.mesh.vertices.size()},
        {"bounds", {json_point(box.min), json_point(box.max)}}}},
      {"grid",
       {{"size", json_size(grid.size)}, {"origin", json_point(grid.origin)}, {"spacing", json_point(grid.spacing)}}},
      {"thickness", json_number(plan.choice.thickness)}};
}

}  // namespace

std::string grid_line(const GridChoice& choice) {
  const std::string band =
      std::isinf(choice.thickness) ? "full field" : "band of thickness " + number(choice.thickness);
  return "grid " + size_text(choice.grid.size) + ", spacing " + spacing_text(choice.grid.spacing) + ", " + band;
}

std::string plan_text(const Plan& plan, const ComputeOptions& options) {
  const Grid& grid = plan.choice.grid;
  const std::int64_t needed = bytes_needed(plan, options);
  const std::string over =
      needed > options.memory_limit ? ", more than the limit of " + bytes_text(options.memory_limit) : "";
  return mesh_line(plan.mesh_name, plan.mesh) + "\n" + grid_line(plan.choice) + "\n" +  //
         "from " + point_text(grid.origin) + " to " + point_text(grid.bounds().max) + ", " +
         counted(grid.sample_count(), "sample") + " in " + counted(tile_count(grid.size), "tile") + "\n" +  //
         "needs at most " + bytes_text(needed) + " beside the mesh" + over + "\n" +                         //
         "would write " + plan.output + "\n";
}

Json plan_json(const Plan& plan, const ComputeOptions& options) {
  Json json = description(plan);
  json["samples"] = {{"total", plan.choice.grid.sample_count()}};
  json["tiles"] = {{"total", tile_count(plan.choice.grid.size)}};
  json["seconds"] = {{"load", plan.load_seconds}};
  json["memory_needed_bytes"] = bytes_needed(plan, options);
  json["memory_limit_bytes"] = options.memory_limit;
  json["output"] = {{"file", plan.output}};
  json["dry_run"] = true;
  return json;
}

void say(const Outcome& outcome, const Console& console) {
  const ComputeReport& report = outcome.report;
  const double load = outcome.plan.load_seconds, prepare = report.seconds.prepare, compute = report.seconds.compute,
               write = outcome.write_seconds;
  if (report.skipped > 0) console.say(counted(report.skipped, "triangle") + " skipped");
  console.detail(counted(report.samples_band, "sample") + " in the band, " + grouped(report.tiles_stored) + " of " +
                 counted(report.tiles, "tile") + " stored, " + counted(report.samples_examined, "distance") +
                 " computed");
  console.detail("load " + seconds_text(load) + ", prepare " + seconds_text(prepare) + ", compute " +
                 seconds_text(compute) + ", write " + seconds_text(write) + "; peak memory " +
                 bytes_text(peak_memory_bytes()));
  console.say(outcome.plan.output + ": " + bytes_text(outcome.written_bytes) + " in " +
              seconds_text(load + prepare + compute + write) + "; " + report.method + " on " + report.backend + " (" +
              report.device + "), " + counted(report.threads, "thread"));
}

Json outcome_json(const Outcome& outcome) {
  const ComputeReport& report = outcome.report;
  Json json = description(outcome.plan);
  json["mesh"]["skipped"] = report.skipped;
  json["mesh"]["hash"] = hash_text(outcome.mesh_hash);
  json["samples"] = {{"total", report.samples}, {"examined", report.samples_examined}, {"band", report.samples_band}};
  json["tiles"] = {{"total", report.tiles}, {"stored", report.tiles_stored}};
  json["seconds"] = {{"load", outcome.plan.load_seconds},
                     {"prepare", report.seconds.prepare},
                     {"compute", report.seconds.compute},
                     {"write", outcome.write_seconds}};
  json["peak_memory_bytes"] = peak_memory_bytes();
  json["method"] = report.method;
  json["device"] = report.backend;
  json["device_name"] = report.device;
  json["threads"] = report.threads;
  json["output"] = {{"file", outcome.plan.output}, {"bytes", outcome.written_bytes}};
  return json;
}

}  // namespace standoff::cli
