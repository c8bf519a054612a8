// SPDX-License-Identifier: Apache-2.0
#include "fly/flight_pictures.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <string>

#include "render/image.h"
#include "render/text.h"
#include "standoff/error.h"

namespace standoff::fly {
namespace {

constexpr std::size_t kMostTrail = 6000, kLeastTrail = 40;  // of all trails together; of one

}  // namespace

void Trails::take(const FlightFrame& frame) {
  const std::size_t bodies = frame.bodies.size();
  if (trails_.empty()) {
    trails_.assign(bodies, {{}, {}, std::numeric_limits<double>::infinity()});
    before_ = frame;
  }
  const std::size_t most = std::max(kLeastTrail, kMostTrail / std::max<std::size_t>(bodies, 1));
  for (std::size_t n = 0; n < bodies; ++n) {
    const Flying &now = frame.bodies[n], &last = before_.bodies[n];
    Trail& trail = trails_[n];
    const bool touched = now.collisions != last.collisions, crossed = now.crossings != last.crossings;
    trail.since_contact = touched ? 0 : trail.since_contact + frame_seconds_;
    if (crossed) crossings_.push_back((last.at + now.at) * 0.5);
    if (!touched && !crossed && !trail.points.empty() && length(now.at - trail.points.back()) < spacing_) continue;
    trail.points.push_back(now.at);
    trail.distances.push_back(now.distance);
    if (trail.points.size() <= most) continue;
    trail.points.pop_front();
    trail.distances.pop_front();
  }
  before_ = frame;
}

namespace {

constexpr double kWallOpacity = 0.13, kShellOpacity = 0.28;
constexpr Color kWalls{120, 132, 150}, kContact{224, 0, 176};
constexpr std::size_t kMostShells = 12;  // of more bodies nothing would be seen
constexpr double kRingSeconds = 0.3;     // that a contact is seen
constexpr int kRingSides = 32;
// In parts of a body's length.
constexpr double kTrailSpacing = 1.0 / 8, kRingFirst = 0.7, kRingLast = 1.3, kRingWidth = 0.06;
constexpr double kStarArm = 0.5, kStarWidth = 0.07;
constexpr double kPathWidth = 0.0012;  // in parts of the walls' longest side
constexpr double kWordsSize = 16;      // pixels, of a picture whose shorter side has kUsualSide
constexpr double kUsualSide = 720;

PictureOptions checked(PictureOptions options) {
  if (options.background == Background::transparent)
    throw Error(ErrorCode::usage, "films have no transparent background; take white or dark");
  options.shadows = options.axes = false;  // see-through walls cast none
  return options;
}

Color body_color(Background background) {
  return background == Background::dark ? Color{214, 219, 228} : Color{41, 46, 56};
}

Drawing walls_of(const FlightSubject& subject) {
  Drawing drawing;
  drawing.meshes.push_back(
      {.mesh = subject.walls.mesh(), .color = kWalls, .opacity = kWallOpacity, .shading = Shading::flat});
  drawing.quantity = "to the wall";
  drawing.colormap = Colormap::thesis;
  return drawing;
}

// The walls, and how far numbers reach.
Drawing whole_of(const FlightSubject& subject, const std::array<Vec3, 2>& corners,
                 const std::array<double, 2>& distances) {
  Drawing drawing = walls_of(subject);
  drawing.points.push_back({.points = corners, .values = distances});
  return drawing;
}

Stage stage_of(const FlightSubject& subject, const PictureOptions& options) {
  const Box box = subject.walls.bounds();
  const std::array<Vec3, 2> corners{box.min, box.max};
  const std::array<double, 2> distances{0, far_of(subject)};
  return {walls_of(subject), whole_of(subject, corners, distances), options};
}

// Adds a mesh turned about the y axis and moved, the body's middle to where it flies.
void add_turned(MeshView body, Vec3 middle, const Flying& flying, Mesh& all) {
  const auto [s, c] = turn_of(flying.heading_rad * 180 / std::numbers::pi);
  const auto first = static_cast<std::uint32_t>(all.vertices.size());
  for (const Vec3 vertex : body.vertices) {
    const Vec3 p = vertex - middle;
    all.vertices.push_back(flying.at + Vec3{c * p.x + s * p.z, p.y, c * p.z - s * p.x});
  }
  for (const Triangle t : body.triangles) all.triangles.push_back({first + t[0], first + t[1], first + t[2]});
}

}  // namespace

FlightPictures::FlightPictures(const FlightSubject& subject, std::span<const FlightFrame> frames,
                               double frames_per_second, const PictureOptions& options)
    : subject_(subject),
      frames_(frames),
      options_(checked(options)),
      threads_(options.threads),
      camera_(options_),
      stage_(threads_.run([&] { return stage_of(subject, options_); })),
      extent_(stage_.extent(camera_)),
      trails_(kTrailSpacing * subject.fly.bounds().longest_side(), frames_per_second) {
  if (frames.empty()) throw Error(ErrorCode::usage, "flight: there are no frames; record at least one");
  threads_.run([&] { stage_.keep(camera_, extent_); });
}

Image FlightPictures::next() {
  const FlightFrame& frame = frames_[next_++];
  trails_.take(frame);
  const Drawing drawing = moving(frame);
  Image image = threads_.run([&] {
    stage_.move(drawing);
    return stage_.draw(camera_, extent_);
  });
  write_words(frame, image);
  return image;
}

Drawing FlightPictures::moving(const FlightFrame& frame) {
  const Box box = subject_.fly.bounds();
  const double length = box.longest_side(), far = far_of(subject_);
  const auto shown = [&](double distance) { return std::clamp(distance, 0.0, far); };
  for (Bodies* bodies : {&calm_, &touching_}) *bodies = {};
  for (auto* list : {&path_, &rings_, &stars_}) list->clear();
  for (auto* list : {&path_starts_, &ring_starts_, &star_starts_}) list->clear();
  path_distances_.clear();

  for (std::size_t n = 0; n < frame.bodies.size(); ++n) {
    const Flying& flying = frame.bodies[n];
    const Trail& trail = trails_.trails()[n];
    path_starts_.push_back(path_.size());
    path_.insert(path_.end(), trail.points.begin(), trail.points.end());
    path_.push_back(flying.at);
    for (const double distance : trail.distances) path_distances_.push_back(shown(distance));
    path_distances_.push_back(shown(flying.distance));

    const bool touching = trail.since_contact < kRingSeconds;
    Bodies& bodies = touching ? touching_ : calm_;
    add_turned(subject_.fly.mesh(), box.center(), flying, bodies.flies);
    if (frame.bodies.size() <= kMostShells) add_turned(subject_.shell, box.center(), flying, bodies.shells);
    bodies.distances.resize(bodies.shells.vertices.size(), shown(flying.distance));
    if (!touching) continue;
    const double share = trail.since_contact / kRingSeconds;
    const double radius = length * (kRingFirst + (kRingLast - kRingFirst) * share);
    ring_starts_.push_back(rings_.size());
    for (int side = 0; side <= kRingSides; ++side) {
      const auto [sine, cosine] = turn_of(360.0 * side / kRingSides);
      const Float3 way = camera_.turned_back({static_cast<float>(cosine), static_cast<float>(sine), 0});
      rings_.push_back(flying.at + radius * Vec3{way.x, way.y, way.z});
    }
  }
  for (const Vec3& crossing : trails_.crossings())
    for (const Vec3& arm : {Vec3{1, 0, 0}, Vec3{0, 1, 0}, Vec3{0, 0, 1}}) {
      star_starts_.push_back(stars_.size());
      for (const double side : {-1.0, 1.0}) stars_.push_back(crossing + side * kStarArm * length * arm);
    }

  const Color body = body_color(options_.background);
  Drawing drawing;
  const auto add = [&](const Mesh& mesh, Color color, double opacity, std::span<const double> values = {}) {
    if (!mesh.triangles.empty())
      drawing.meshes.push_back({.mesh = mesh, .color = color, .opacity = opacity, .values = values});
  };
  add(calm_.flies, body, 1);
  add(touching_.flies, kContact, 1);
  add(calm_.shells, body, kShellOpacity, calm_.distances);
  add(touching_.shells, kContact, kShellOpacity);
  drawing.paths.push_back({.points = path_,
                           .starts = path_starts_,
                           .radius = kPathWidth * subject_.walls.bounds().longest_side() / options_.zoom,
                           .values = path_distances_});
  drawing.paths.push_back({.points = rings_, .starts = ring_starts_, .color = kContact, .radius = kRingWidth * length});
  drawing.paths.push_back({.points = stars_,
                           .starts = star_starts_,
                           .color = theme_of(options_.background).ink,
                           .radius = kStarWidth * length});
  return drawing;
}

void FlightPictures::write_words(const FlightFrame& frame, Image& image) const {
  std::int64_t contacts = 0, crossings = 0;
  for (const Flying& it : frame.bodies) contacts += it.collisions, crossings += it.crossings;
  const double size = kWordsSize * std::min(image.width, image.height) / kUsualSide;
  const Theme theme = theme_of(options_.background);
  double line = 1.6 * size;
  const auto write = [&](const std::string& words, Color color) {
    draw_text(image, size, line + cap_height(size) / 2, words, size, color);
    line += 1.5 * size;
  };
  write("step " + std::to_string(frame.step), theme.ink);
  write("contacts " + std::to_string(contacts), contacts > 0 ? kContact : theme.faint);
  write("wall crossings " + std::to_string(crossings), crossings > 0 ? theme.ink : theme.faint);
}

}  // namespace standoff::fly
