// SPDX-License-Identifier: Apache-2.0
// The bodies that collide, distance, sweep and fly are about.
#pragma once

#include <string>

#include <CLI/CLI.hpp>

#include "cli/console.h"
#include "cli/files.h"
#include "standoff/collision.h"

namespace standoff::cli {

/// A mesh made into a body, or a body that standoff build made: NAME.body. Terminals are shown what is waited for.
CollisionModel read_body(const std::string& name, const Console& console);

/// Two bodies A and B, and where A is.
class PairInput {
 public:
  /// Adds the arguments A and B and the option --pose-a.
  void add_to(CLI::App& verb);
  /// Tells before anything is built what is wrong with the names of both. Errors: usage, input.
  void check() const;
  CollisionModel read_a(const Console& console) const { return read_body(a_, console); }
  CollisionModel read_b(const Console& console) const { return read_body(b_, console); }
  const std::string& name_a() const { return a_; }
  const std::string& name_b() const { return b_; }
  const Pose& pose_a() const { return pose_a_; }

 private:
  std::string a_, b_;
  Pose pose_a_;
};

/// Adds an option that takes a pose.
CLI::Option* add_pose(CLI::App& verb, const char* name, const char* help, Pose& pose);

/// Adds a body's mesh, whether it is closed, its grid, thickness and memory to an answer.
void add_body(Json& json, const CollisionModel& body);

}  // namespace standoff::cli
