// SPDX-License-Identifier: Apache-2.0
#include "cli/sign_arguments.h"

#include "cli/options.h"

namespace standoff::cli {

void SignArguments::add_to(CLI::App& verb) {
  constexpr const char* kGroup = "Sign";
  using S = const std::string&;
  add_parsed(verb,
             {"--sign", "METHOD",
              "how inside is decided: auto (default), winding, parity,\nnormal, flood, shell:T or none, as in "
              "standoff compute",
              kGroup},
             [this](S o, S t) {
               const SignChoice choice = parse_sign(o, t);
               options_.method = choice.method;
               shell_ = choice.shell;
               given_ = true;
             });
  add_parsed(verb,
             {"--rule", "NAME", "inside is where the winding number is positive (default),\nnonzero or odd", kGroup},
             [this](S o, S t) {
               options_.rule = parse_winding_rule(o, t);
               given_ = true;
             });
  const auto flag = [&](const char* name, bool& set, const char* help) {
    verb.add_flag_callback(
            name,
            [this, &set] {
              set = true;
              given_ = true;
            },
            help)
        ->group(kGroup);
  };
  flag("--invert", options_.invert, "exchange inside and outside, as for a room scanned from inside");
  flag("--as-oriented", options_.as_oriented, "take triangles as they are oriented; repair nothing first");
  flag("--outer", options_.outer, "take the surface of the union of all parts (docs/outer.md)");
  flag("--strict", options_.strict, "fail with exit code 8 where the sign is not certain");
}

SignOptions SignArguments::options(double spacing) const {
  SignOptions options = options_;
  if (options.method == SignMethod::shell) options.shell = shell_.world(spacing);
  return options;
}

}  // namespace standoff::cli
