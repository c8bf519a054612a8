// SPDX-License-Identifier: Apache-2.0
#include "cli/sign_options.h"

#include <algorithm>

#include "cli/options.h"

namespace standoff::cli {
namespace {

constexpr const char* kSignGroup = "Sign";
constexpr const char* kNames[] = {"--sign", "--rule", "--invert", "--as-oriented", "--outer", "--strict"};

// All but --sign and --outer.
void add_details(CLI::App& verb, SignOptions& options) {
  add_parsed(
      verb, {"--rule", "NAME", "inside is where the winding number is positive (default),\nnonzero or odd", kSignGroup},
      [&](S o, S t) { options.rule = parse_winding_rule(o, t); });
  verb.add_flag("--invert", options.invert, "exchange inside and outside, as for a room scanned from inside")
      ->group(kSignGroup);
  verb.add_flag("--as-oriented", options.as_oriented, "take triangles as they are oriented; repair nothing first")
      ->group(kSignGroup);
  verb.add_flag("--strict", options.strict, "fail with exit code 8 where the sign is not certain")->group(kSignGroup);
}

}  // namespace

void add_sign(CLI::App& verb, SignOptions& options, Thickness& shell, const SignHelp& help) {
  add_parsed(verb, {"--sign", "METHOD", help.sign, kSignGroup}, [&](S o, S t) {
    const SignChoice choice = parse_sign(o, t);
    options.method = choice.method;
    shell = choice.shell;
  });
  add_details(verb, options);
  verb.add_flag("--outer", options.outer, help.outer)->group(kSignGroup);
}

void add_sign(CLI::App& verb, SignOptions& options, Thickness& shell) {
  add_sign(
      verb, options, shell,
      {"make values inside negative. auto: what fits the mesh, or\nnothing if it has no inside; winding, parity: by "
       "crossings;\nnormal: behind the nearest triangle, for terrain;\nflood: what a flood from outside does not "
       "reach;\nshell:T: the surface as a solid of thickness T (0.5 or 3s);\nnone (default). `standoff info MESH` "
       "says what fits",
       "leave out triangles inside: distances are to the union of\nall parts (sign winding or auto, closed "
       "meshes)"});
}

void add_sign_to(CLI::App& verb, const std::vector<std::string>& methods, const char* help, SignOptions& options) {
  add_parsed(verb, {"--sign", "METHOD", help, kSignGroup}, [&options, methods](S o, S t) {
    parse_choice(o, t, methods);
    options.method = parse_sign(o, t).method;
  });
  add_details(verb, options);
}

bool is_sign_given(const CLI::App& verb) {
  return std::ranges::any_of(kNames, [&](const char* name) {
    const CLI::Option* option = verb.get_option_no_throw(name);
    return option && option->count() > 0;
  });
}

bool is_given(const SignOptions& sign) {
  const SignOptions none;
  return sign.method != none.method || sign.rule != none.rule || sign.invert || sign.as_oriented || sign.outer ||
         sign.strict;
}

void add_sign_report(Json& json, const SignReport& report) {
  json["sign"] = {{"method", name_of(report.method)}, {"why", report.why}, {"sure", report.sure}};
}

}  // namespace standoff::cli
