// SPDX-License-Identifier: Apache-2.0
#include "view/flight/frame_code.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <limits>

#include "page/page.h"
#include "standoff/error.h"

namespace standoff::view {
namespace {

static_assert(std::endian::native == std::endian::little);

template <class T>
void put(std::string& out, T value) {
  char bytes[sizeof value];
  std::memcpy(bytes, &value, sizeof value);
  out.append(bytes, sizeof value);
}

void put_signed(std::string& out, std::int64_t n) {
  page::put_varint(out, page::zigzag(static_cast<std::int32_t>(std::clamp<std::int64_t>(n, INT32_MIN, INT32_MAX))));
}

constexpr double kSteps = 65535;

// `of(frame)` is a whole number of a body; its change from frame to frame.
void put_changes(std::string& out, std::span<const FlightFrame> frames, auto of) {
  std::int64_t last = 0;
  for (const FlightFrame& frame : frames) {
    const std::int64_t now = of(frame);
    put_signed(out, now - last);
    last = now;
  }
}

void put_bends(std::string& out, std::span<const FlightFrame> frames, auto of) {
  std::int64_t last = 0, before = 0;
  for (const FlightFrame& frame : frames) {
    const std::int64_t now = of(frame);
    put_signed(out, now - (&frame == &frames[0] ? 0 : &frame == &frames[1] ? last : 2 * last - before));
    before = last;
    last = now;
  }
}

}  // namespace

std::string frame_bytes(const FlightFrame& frame, double steps_per_second, double microseconds) {
  std::string bytes;
  bytes.reserve(24 + 28 * frame.bodies.size());
  put(bytes, static_cast<std::uint32_t>(24 + 28 * frame.bodies.size()));
  put(bytes, static_cast<std::uint32_t>(frame.bodies.size()));
  put(bytes, static_cast<double>(frame.step));
  put(bytes, static_cast<float>(steps_per_second));
  put(bytes, static_cast<float>(microseconds));
  for (const Flying& body : frame.bodies) {
    for (const double number : {body.at.x, body.at.y, body.at.z, body.distance, body.heading_rad})
      put(bytes, static_cast<float>(number));
    put(bytes, static_cast<std::uint32_t>(body.collisions));
    put(bytes, static_cast<std::uint32_t>(body.crossings));
  }
  return bytes;
}

CodedFlight coded_flight(std::span<const FlightFrame> frames) {
  if (frames.empty()) throw Error(ErrorCode::usage, "a flight without frames cannot be shown; record some steps");
  CodedFlight coded;
  coded.frames = std::ssize(frames);
  coded.bodies = std::ssize(frames[0].bodies);
  Box box;
  for (const FlightFrame& frame : frames) {
    if (std::ssize(frame.bodies) != coded.bodies)
      throw Error(ErrorCode::usage, "a recorded flight keeps its bodies; record each number of them alone");
    for (const Flying& body : frame.bodies) box.include(body.at);
  }
  if (!box.empty()) {
    coded.origin = box.min;
    if (box.longest_side() > 0) coded.step = box.longest_side() / kSteps;
  }
  const auto whole = [&](double length) {
    return static_cast<std::int64_t>(std::llround(std::clamp(length / coded.step, -1e9, 1e9)));
  };
  for (std::size_t n = 0; n < frames[0].bodies.size(); ++n) {
    const auto body = [n](const FlightFrame& frame) -> const Flying& { return frame.bodies[n]; };
    for (double Vec3::*axis : {&Vec3::x, &Vec3::y, &Vec3::z})
      put_bends(coded.positions, frames,
                [&](const FlightFrame& frame) { return whole(body(frame).at.*axis - coded.origin.*axis); });
    put_changes(coded.distances, frames, [&](const FlightFrame& frame) { return whole(body(frame).distance); });
    put_changes(coded.collisions, frames, [&](const FlightFrame& frame) { return body(frame).collisions; });
    put_changes(coded.crossings, frames, [&](const FlightFrame& frame) { return body(frame).crossings; });
    put(coded.headings, static_cast<float>(body(frames[0]).heading_rad));
  }
  put_changes(coded.steps, frames, [](const FlightFrame& frame) { return frame.step; });
  return coded;
}

}  // namespace standoff::view
