// SPDX-License-Identifier: Apache-2.0
// A body from bytes that nobody vouches for, and every query of it: for the fuzzer, and for what it found
// (corpus/body).
#pragma once

#include <algorithm>
#include <optional>
#include <string_view>

#include "collision/body/body.h"
#include "files/array_file.h"
#include "standoff/collision.h"
#include "standoff/error.h"

namespace standoff {

/// The body of a file called `fuzzed`. The checksum is not looked at: past it no changed byte would come.
inline Body read_body(std::string_view bytes) {
  return collision::read_body(FileView("fuzzed", bytes), ArrayChecksum::ignored);
}

/// The body's middle, turned, moved by this.
inline Pose placed(const Body& body, double angle_rad, Vec3 by) {
  const Vec3 middle = body.bounds().center();
  Pose pose = make_pose({3, 1, 2}, angle_rad, {});
  pose.translation = middle - rotate(pose, middle) + by;
  return pose;
}

inline void ask(const Body& body, const Pose& pose) {
  const Vec3 extent = body.bounds().extent();
  // Sweeps take steps as short as the tolerance: a share of the motion's length bounds their number.
  const double size = std::max(body.bounds().longest_side(), 1e-9);
  collide(body, {}, body, pose);
  if (body.has_inside()) collide(body, {}, body, pose, {.containment = true});
  collide(body, {}, body, pose, {.margin = size, .mode = CollideMode::certified});
  distance(body, {}, body, pose);
  contacts(body, {}, body, pose, {.most = 8, .margin = 0.01 * size});
  sweep(body, {}, body, {pose, placed(body, 2, extent * Vec3{-1, 0.3, 0.2}), body.bounds().center()}, {0.01 * size});
}

/// Every query of the body against itself, beside it and at the same pose. Each must end, whatever bounds the body
/// holds. Returns the code of the first error: usage is a legal answer, for poses beyond kMaxPosition.
inline std::optional<ErrorCode> ask(const Body& body) {
  try {
    ask(body, placed(body, 0.7, body.bounds().extent() * Vec3{1.1, 0.1, 0.2}));
    ask(body, {});
    return {};
  } catch (const Error& error) {
    return error.code();
  }
}

}  // namespace standoff
