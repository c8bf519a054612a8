// SPDX-License-Identifier: Apache-2.0
#include "cli/sign_options.h"

#include "cli/options.h"
#include "cli/parse.h"

namespace standoff::cli {

void add_sign_to(CLI::App& verb, const std::vector<std::string>& methods, const char* help, SignOptions& sign) {
  using S = const std::string&;
  add_parsed(verb, {"--sign", "METHOD", help, "Sign"}, [&sign, methods](S o, S t) {
    parse_choice(o, t, methods);
    sign.method = parse_sign(o, t).method;
  });
  add_parsed(verb,
             {"--rule", "NAME", "inside is where the winding number is positive (default),\nnonzero or odd", "Sign"},
             [&sign](S o, S t) { sign.rule = parse_winding_rule(o, t); });
  verb.add_flag("--invert", sign.invert, "exchange inside and outside, as for a room scanned from inside")
      ->group("Sign");
  verb.add_flag("--as-oriented", sign.as_oriented, "take triangles as they are oriented; repair nothing first")
      ->group("Sign");
  verb.add_flag("--strict", sign.strict, "fail with exit code 8 where the sign is not certain")->group("Sign");
}

}  // namespace standoff::cli
