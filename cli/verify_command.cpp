// SPDX-License-Identifier: Apache-2.0
// standoff verify: a field against its mesh, by brute force in double precision.
#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <utility>

#include "cli/console.h"
#include "cli/files.h"
#include "cli/options.h"
#include "cli/parse.h"
#include "cli/sidecar_options.h"
#include "cli/text.h"
#include "cli/verb.h"
#include "standoff/compute.h"
#include "standoff/error.h"
#include "standoff/sidecars.h"
#include "standoff/verify.h"

namespace standoff::cli {
namespace {

constexpr const char* kVerifyExamples = R"(  standoff verify bunny.vti bunny.obj                  1000 random samples
  standoff verify bunny.vti bunny.obj --samples 100000
  standoff verify part.vti part.stl --unit mm          as it was computed
)";

// In how many samples the sidecars that compute --with makes are not what the mesh and the stored nearest triangles
// give. 0 where there are none, or no nearest triangles.
std::int64_t count_wrong(const FieldFile& file, MeshView mesh, const Execution& execution) {
  if (!file.field.has_nearest()) return 0;
  std::int64_t wrong = 0;
  for (const SidecarKind kind : kSidecarKinds)
    for (const Sidecar& stored : file.sidecars) {
      if (stored.name != name_of(kind)) continue;
      const Sidecar right = std::move(sidecars(mesh, file.field, {&kind, 1}, {.execution = execution})[0]);
      const auto compare = [&]<class Number>(const std::vector<Number>& numbers) {
        const auto* const others = std::get_if<std::vector<Number>>(&right.values);
        const auto width = static_cast<std::size_t>(right.components);
        if (!others || others->size() != numbers.size() || stored.components != right.components) {
          ++wrong;  // another array of that name
          return;
        }
        for (std::size_t n = 0; n < numbers.size(); n += width)
          wrong += std::equal(numbers.data() + n, numbers.data() + n + width, others->data() + n) ? 0 : 1;
      };
      std::visit(compare, stored.values);
    }
  return wrong;
}

struct VerifyCommand {
  std::string field;
  FieldArgument input;
  MeshInput mesh;
  VerifyOptions options;
  Console console;
  std::int64_t sidecars_wrong = 0;
  std::string method;  // that computed the field, if the file says it

  Json report(const VerifyResult& found) const;
  void warn_of(const VerifyResult& found) const;
  void fail(const VerifyResult& found) const;
  void run();
};

std::string sample_text(const SampleCheck& at) {
  return "sample (" + std::to_string(at.i) + ", " + std::to_string(at.j) + ", " + std::to_string(at.k) + ") at " +
         point_text(at.position);
}

Json sample_json(const SampleCheck& at) {
  return {{"sample", {at.i, at.j, at.k}},     {"position", json_point(at.position)},
          {"stored", json_number(at.stored)}, {"expected", json_number(at.expected)},
          {"error", json_number(at.error)},   {"allowed", json_number(at.allowed)}};
}

Json sign_json(const SignCheck& sign) {
  return {{"method", sign.method},
          {"checked", sign.checked},
          {"wrong", sign.wrong},
          {"unknown", sign.unknown},
          {"negative", sign.negative},
          {"worst", sign.wrong > 0 ? sample_json(sign.worst) : Json()},
          {"worst_winding", sign.wrong > 0 ? json_number(sign.worst_winding) : Json()}};
}

std::string sign_line(const SignCheck& sign) {
  if (sign.method.empty() || !sign.can_check) return "";
  return "sign (" + sign.method + "): " + counted(sign.checked, "sample") + " checked, " + grouped(sign.wrong) +
         " wrong, " + grouped(sign.unknown) + " not decided\n";
}

Json VerifyCommand::report(const VerifyResult& found) const {
  Json json = json_answer("verify");
  json["field"] = {{"file", field}};
  json["mesh"] = {{"file", mesh.name()}};
  json["ok"] = found.ok() && sidecars_wrong == 0;
  json["samples"] = {{"tested", found.samples}, {"band", found.samples_band}, {"wrong", found.samples_wrong}};
  json["nearest_wrong"] = found.nearest_wrong;
  json["sidecars_wrong"] = sidecars_wrong;
  json["sign"] = sign_json(found.sign);
  json["same_mesh"] = !found.mesh_differs;
  json["largest"] = sample_json(found.largest);
  json["worst"] = sample_json(found.worst);
  return json;
}

void VerifyCommand::run() {
  check_input(field);
  check_input(mesh.name());
  const auto [slices, file] = input.read_parts(field, console);
  method = (slices ? slices->provenance() : file.field.provenance()).method;
  const Mesh triangles = with_spinner(console, "reading " + mesh.name(), [&] { return mesh.read(); });
  const VerifyResult found = with_progress(console, options.progress, [&] {
    return slices ? verify(slices->grid(), slices->thickness(), slices->reader(input.reading()), triangles, options,
                           input.slice_samples())
                  : verify(file.field, triangles, options);
  });
  if (slices && !slices->sidecars().empty())
    console.warn(field + ": too large for the memory limit; what is stored beside the distances is not checked");
  if (found.nearest_wrong == 0) sidecars_wrong = count_wrong(file, triangles, {.threads = options.execution.threads});

  warn_of(found);
  if (console.json())
    print(report(found));
  else
    print(counted(found.samples, "sample") + " tested, " + grouped(found.samples_band) + " of them in the band\n" +
          "largest error " + number(found.largest.error) + " (allowed there: " + number(found.largest.allowed) + "), " +
          sample_text(found.largest) + ": stored " + exact_number(found.largest.stored) + ", expected " +
          exact_number(found.largest.expected) + "\n" + sign_line(found.sign));
  if (!found.ok()) fail(found);
  if (sidecars_wrong > 0)
    throw Error(ErrorCode::verify, field + ": what is stored beside the distances is wrong in " +
                                       counted(sidecars_wrong, "place") + ", by the mesh and the nearest triangles; " +
                                       "compute it again from " + mesh.name());
  console.say("the field matches the mesh");
}

void VerifyCommand::warn_of(const VerifyResult& found) const {
  if (found.mesh_differs)
    console.warn(field + ": computed from another mesh than " + mesh.name() +
                 " as read here, by their hashes; give the --scale or --unit it was computed with");
  const SignCheck& sign = found.sign;
  if (sign.can_check || (sign.method.empty() && sign.negative == 0)) return;
  if (sign.method.empty())
    console.warn(field +
                 ": has negative values but does not say how their sign was decided; only distances are checked");
  else
    console.warn(field + ": the sign (" + sign.method + ") cannot be checked with this mesh; only distances are");
}

void VerifyCommand::fail(const VerifyResult& found) const {
  const auto fail_with = [&](const std::string& what) {
    const bool is_exact = method.empty() || method == find_info(Method::tiles)->name;
    const bool by_facet = found.sign.method.starts_with(name_of(SignMethod::facet));
    throw Error(ErrorCode::verify, field + ": " + what + "; " +
                                       (is_exact ? "" : "the method " + method + " is not exact: ") +
                                       "compute it again from " + mesh.name() + (is_exact ? "" : " by tiles") +
                                       (by_facet ? ", with another sign than facet, which is wrong beside edges" : ""));
  };
  if (found.samples_wrong > 0)
    fail_with(sample_text(found.worst) + ": the value is wrong by " + number(found.worst.error) + ", more than the " +
              number(found.worst.allowed) + " allowed, as " + counted(found.samples_wrong, "sample") + " of " +
              grouped(found.samples) + " are");
  const SignCheck& sign = found.sign;
  if (sign.wrong > 0) {
    const bool inside = sign.worst.expected < 0;
    fail_with(sample_text(sign.worst) + ": the sign is wrong, the sample is " + (inside ? "inside" : "outside") +
              (std::isnan(sign.worst_winding) ? "" : " (winding number " + number(sign.worst_winding) + ")") + "; " +
              counted(sign.wrong, "sample") + " of " + grouped(sign.checked) + " have the wrong sign");
  }
  fail_with("the nearest triangle of " + counted(found.nearest_wrong, "sample") + " of " + grouped(found.samples) +
            " is not the nearest");
}

}  // namespace

void add_verify(CLI::App& program) {
  auto* verb = add_verb(program, "verify", "test a field against its mesh, by brute force", kVerifyExamples);
  const auto command = std::make_shared<VerifyCommand>();
  verb->add_option("FIELD", command->field, "a field file (" + extensions(field_formats(), false) + ")")->required();
  command->mesh.add_to(*verb);
  command->mesh.add_scale_to(*verb);
  VerifyOptions& options = command->options;
  constexpr const char* kGroup = "Test";
  add_parsed(*verb, {"--samples", "N", "how many random samples to test (default 1000)", kGroup},
             [&options](S o, S t) { options.samples = parse_count(o, t, 1, 1'000'000'000); });
  add_parsed(*verb, {"--seed", "N", "chooses the samples (default 1)", kGroup}, [&options](S o, S t) {
    options.seed = static_cast<std::uint64_t>(parse_count(o, t, 0, std::numeric_limits<std::int64_t>::max()));
  });
  add_threads(*verb, kGroup, options.execution.threads);
  command->input.add_to(*verb);
  command->console.add_to(*verb, Console::kMessages | Console::kJson | Console::kProgress);
  verb->callback([command] { command->run(); });
}

}  // namespace standoff::cli
