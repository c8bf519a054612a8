// Any bytes give a body or Error{input}; of a body, whatever bounds it holds, queries end and stay inside its arrays.
// The checksum is not looked at: past it no changed byte would come.
#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <string_view>

#include "collision/body/model_file.h"
#include "standoff/collision.h"

namespace standoff {

namespace {

// The body's middle, turned, moved by this.
Pose placed(const CollisionModel& body, double angle_rad, Vec3 by) {
  const Vec3 middle = body.bounds().center();
  Pose pose = make_pose({3, 1, 2}, angle_rad, {});
  pose.translation = middle - rotate(pose, middle) + by;
  return pose;
}

void ask(const CollisionModel& body, const Pose& pose) {
  // Sweeps take steps as short as the tolerance: it has to suit the way.
  const Vec3 extent = body.bounds().extent();
  const double size = std::max({extent.x, extent.y, extent.z, 1e-9});
  collide(body, {}, body, pose);
  collide(body, {}, body, pose, {.margin = size, .mode = CollideMode::certified});
  distance(body, {}, body, pose);
  contacts(body, {}, body, pose, {.most = 8, .margin = 0.01 * size});
  sweep(body, {}, body, {pose, placed(body, 2, extent * Vec3{-1, 0.3, 0.2}), body.bounds().center()}, {0.01 * size});
}

void fuzz_body(std::string_view bytes) {
  try {
    const CollisionModel body = collision::read_model(FileView("fuzzed", bytes), collision::BodyChecksum::ignored);
    try {
      ask(body, placed(body, 0.7, body.bounds().extent() * Vec3{1.1, 0.1, 0.2}));
      ask(body, {});
    } catch (const Error& error) {
      if (error.code() != ErrorCode::usage) std::abort();  // places past 1e15
    }
  } catch (const Error& error) {
    if (error.code() != ErrorCode::input || !std::string_view(error.what()).starts_with("fuzzed:")) std::abort();
  }
}

}  // namespace
}  // namespace standoff

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  standoff::fuzz_body({reinterpret_cast<const char*>(data), size});
  return 0;
}
