
#include "scenes/families.h"
#include "scenes/random.h"
#include "scenes/solids.h"

namespace difi::scenes {
namespace {

// A row of machines, pipes and beams in a box: the common ground of the first versions of the assemblies.
void crowd(Builder& b, Vec3 extent, int count, double size, std::uint64_t seed) {
  for (int i = 0; i < count; ++i) {
    const auto key = static_cast<std::uint64_t>(i);
    const Vec3 at{uniform(seed, key, 1) * extent.x, uniform(seed, key, 2) * extent.y, uniform(seed, key, 3) * extent.z};
    const double s = size * between(0.3, 1.2, uniform(seed, key, 4));
    const Frame f = Frame{}.at(at);
    switch (hash(seed + key) % 5) {
      case 0:
        box(b, f, {-s, 0, -s / 2}, {s, s, s / 2});
        break;
      case 1:
        cylinder(b, f.y_to_x(), s / 3, 2 * s);
        break;
      case 2:
        ellipsoid(b, f, {s / 2, s / 3, s / 2});
        break;
      case 3:
        torus(b, f, s / 2, s / 8);
        break;
      default:
        rod(b, f, {0, 0, 0}, {s, s * 0.7, s * 2}, s / 8);
        break;
    }
  }
  box(b, {}, {-size, -size / 8, -size}, extent * Vec3{1, 0, 1} + Vec3{size, 0, size});
}

}  // namespace

void draw_our_process(Builder& b) { crowd(b, {6, 2.5, 20}, 300, 0.5, 4); }
void draw_plane(Builder& b) { crowd(b, {11, 1.9, 6}, 200, 0.4, 5); }
void draw_bender(Builder& b) { crowd(b, {7, 5, 1.9}, 60, 0.7, 6); }
void draw_catapult(Builder& b) { crowd(b, {4, 3, 2}, 200, 0.8, 7); }
void draw_process(Builder& b) { crowd(b, {0.4, 0.4, 0.1}, 60, 0.05, 8); }
void draw_labyrinth(Builder& b) { crowd(b, {140, 9, 136}, 300, 8, 9); }
void draw_fly(Builder& b) { crowd(b, {3, 1.8, 3}, 20, 0.4, 10); }

}  // namespace difi::scenes
