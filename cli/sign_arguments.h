// SPDX-License-Identifier: Apache-2.0
// How inside is decided, from the options of a verb.
#pragma once

#include <CLI/CLI.hpp>

#include "cli/parse.h"
#include "standoff/sign.h"

namespace standoff::cli {

class SignArguments {
 public:
  /// `method` is the default.
  explicit SignArguments(SignMethod method) { options_.method = method; }
  /// Adds --sign, --rule, --invert, --as-oriented, --outer and --strict.
  void add_to(CLI::App& verb);

  bool given() const { return given_; }
  /// `spacing`: what a sample is as a length, world units.
  SignOptions options(double spacing) const;
  /// Of --sign shell, else 0.
  Thickness shell() const { return options_.method == SignMethod::shell ? shell_ : Thickness{0}; }

 private:
  SignOptions options_;
  Thickness shell_{0};
  bool given_ = false;
};

}  // namespace standoff::cli
