// SPDX-License-Identifier: Apache-2.0
#include "cli/field_options.h"

#include <cmath>
#include <limits>

#include "cli/parse.h"
#include "cli/text.h"
#include "standoff/error.h"
#include "standoff/memory.h"

namespace standoff::cli {
namespace {

// "tiles (default): exact; thesis: ..".
std::string methods_text() {
  std::string text;
  for (const MethodInfo& info : kComputeMethods)
    text += (text.empty() ? "" : "; ") + std::string(info.name) +
            (info.method == ComputeOptions{}.method ? " (default)" : "") + ": " + info.what;
  return wrapped(text, kHelpColumns);
}

// Beyond this the padding of the box or the squares of distances would be infinite.
void check_extent(const std::string& name, const Box& box) {
  for (const Vec3 corner : {box.min, box.max})
    for (const double c : {corner.x, corner.y, corner.z})
      if (std::abs(c) > kMaxCoordinate)
        throw Error(ErrorCode::input, name + ": a coordinate of " + number(c) +
                                          ", too far out for a grid; repair the mesh, or scale it down with --scale");
}

const char* rule_name(WindingRule rule) {
  return rule == WindingRule::positive ? "positive" : rule == WindingRule::nonzero ? "nonzero" : "odd";
}

}  // namespace

void CacheOption::add_to(CLI::App& verb, const char* group) {
  add_parsed(verb,
             {"--cache", "FOLDER",
              "take fields that were computed before from this folder, and\nkeep those that are computed", group},
             [this](S o, S t) {
               if (t.empty()) throw Error(ErrorCode::usage, o + " '': give the name of a folder");
               folder_ = t;
             });
}

void FieldOptions::add_work_to(CLI::App& verb) {
  add_devices(verb, "Work", compute.execution.backend, compute.devices);
  add_threads(verb, "Work", compute.execution.threads);
  add_parsed(
      verb,
      {"--memory-limit", "SIZE",
       "most memory for the field and its making, as in 500M or 8G,\nor none (default: 80 % of the machine's)", "Work"},
      [this](S o, S t) { compute.memory_limit = parse_bytes(o, t); });
}

void FieldOptions::add_thesis_to(CLI::App& verb) {
  add_parsed(verb, {"--method", "NAME", methods_text().c_str(), kThesisGroup},
             [this](S o, S t) { compute.method = parse_method(o, t); });
  add_parsed(verb,
             {"--skip", "RULE",
              "leave triangles out first: none, neighbour[:FRACTION] or\nexact (default: none; thesis: neighbour:1)",
              kThesisGroup},
             [this](S o, S t) { compute.skip = parse_skip(o, t); });
  grid_.add_thesis_to(verb);
}

// The grid is one around the solid: a shell reaches beyond the mesh.
GridChoice FieldOptions::choose_grid(const std::string& name, const Box& box) {
  check_extent(name, box);
  if (compute.sign.method != SignMethod::shell) return grid_.choose(box);
  const double spacing = shell_.in_samples ? grid_.choose(box).grid.max_spacing() : 1;
  GridChoice choice = grid_.choose(box.grown(shell_.world(spacing) / 2));
  compute.sign.shell = shell_.world(choice.grid.max_spacing());
  return choice;
}

std::int64_t FieldOptions::memory_limit() const {
  const std::int64_t limit = compute.memory_limit == 0 ? default_memory_limit() : compute.memory_limit;
  return limit < 0 ? std::numeric_limits<std::int64_t>::max() : limit;
}

Json FieldOptions::parameters() const {
  const SignOptions& sign = compute.sign;
  Json json;
  json["grid"] = grid_.parameters();
  json["sign"] = {{"method", find_info(sign.method)->name},
                  {"rule", rule_name(sign.rule)},
                  {"invert", sign.invert},
                  {"strict", sign.strict},
                  {"as_oriented", sign.as_oriented},
                  {"outer", sign.outer}};
  if (sign.method == SignMethod::shell) json["sign"]["shell"] = thickness_json(shell_);
  json["method"] = find_info(compute.method)->name;
  json["skip"] = {{"rule", static_cast<int>(compute.skip.kind)}, {"fraction", compute.skip.fraction}};
  return json;
}

}  // namespace standoff::cli
