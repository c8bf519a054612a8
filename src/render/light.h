// SPDX-License-Identifier: Apache-2.0
// What a point of a triangle looks like, and what darkens it: a coarse distance field of everything opaque, and the
// shadow of the lamp.
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include "render/camera.h"
#include "render/float3.h"
#include "render/part.h"
#include "render/scales.h"
#include "standoff/grid.h"
#include "standoff/mesh_view.h"

namespace standoff {

/// A regular lattice of samples in the unit space.
struct UnitLattice {
  Float3 origin;
  float spacing = 1;
  std::size_t size[3] = {0, 0, 0};  ///< x, the fastest, y and z

  /// The cell of eight samples around a place.
  struct Cell {
    std::size_t first;  ///< the number of its sample of least x, y and z
    float x, y, z;      ///< where the place lies in it, 0 to 1
  };

  std::size_t samples() const { return size[0] * size[1] * size[2]; }

  Float3 place(std::size_t sample) const {
    return origin + Float3{static_cast<float>(sample % size[0]), static_cast<float>(sample / size[0] % size[1]),
                           static_cast<float>(sample / (size[0] * size[1]))} *
                        spacing;
  }

  /// The cell that a place lies in; nothing for places outside the lattice.
  std::optional<Cell> cell(Float3 place) const {
    const Float3 at = (place - origin) * (1 / spacing);
    // Also false for what is not a number.
    if (!(at.x >= 0 && at.x + 1 < static_cast<float>(size[0]) && at.y >= 0 && at.y + 1 < static_cast<float>(size[1]) &&
          at.z >= 0 && at.z + 1 < static_cast<float>(size[2])))
      return {};
    const int x = static_cast<int>(at.x), y = static_cast<int>(at.y), z = static_cast<int>(at.z);
    return Cell{
        static_cast<std::size_t>(x) + size[0] * (static_cast<std::size_t>(y) + size[1] * static_cast<std::size_t>(z)),
        at.x - static_cast<float>(x), at.y - static_cast<float>(y), at.z - static_cast<float>(z)};
  }

  /// Interpolates between the values of a cell's samples; `value(sample)` gives them.
  template <class Value>
  float interpolate(const Cell& cell, const Value& value) const {
    const auto along_x = [&](std::size_t sample) {
      const float low = value(sample);
      return low + (value(sample + 1) - low) * cell.x;
    };
    const auto along_y = [&](std::size_t sample) {
      const float low = along_x(sample);
      return low + (along_x(sample + size[0]) - low) * cell.y;
    };
    const float low = along_y(cell.first);
    return low + (along_y(cell.first + size[0] * size[1]) - low) * cell.z;
  }
};

/// The triangles without those that are smaller than `size` and have another such triangle near: of those whose first
/// corners lie in the same cube with sides of `size`, the first is kept. So every point of the mesh is within
/// (1 + sqrt(3)) * size of what is left. `size` must not be less than 2^-10; places are in the unit space.
std::vector<Triangle> thinned(std::span<const Float3> places, TriangleArray triangles, float size);

/// A coarse distance field of everything that darkens surfaces.
class Occlusion {
 public:
  /// Takes the opaque parts that cast shadows; everything is bright if there are none.
  explicit Occlusion(std::span<const DrawnPart> parts);

  /// The share of the light from all sides that reaches a point of a surface with a unit normal, 0 to 1.
  float ambient(Float3 point, Float3 normal) const;
  /// The share of a distant lamp's light that reaches a place, 0 to 1; softly, as if the lamp were large.
  float lamp(Float3 place, Float3 to_lamp) const;
  /// The place above a point of a surface from where the field tells how far away everything else is.
  Float3 above(Float3 point, Float3 normal) const;
  /// The lattice of the field; empty if nothing casts shadows.
  const UnitLattice& lattice() const { return lattice_; }

  /// How many bytes the field and its computation take, for so many triangles and vertices.
  static std::int64_t bytes(std::int64_t triangles, std::int64_t vertices);

 private:
  float distance(Float3 place) const;

  UnitLattice lattice_;
  float thickness_ = 0;
  std::vector<float> distances_;
};

/// How much of a distant lamp's light passes: found once for each sample of the occlusion's lattice that a picture asks
/// for.
class Shadow {
 public:
  /// `occlusion` must outlive it.
  Shadow(const Occlusion& occlusion, Float3 to_lamp);

  /// The share of the light that reaches a point of a surface with a unit normal, 0 to 1. For any number of threads.
  float passing(Float3 point, Float3 normal) const;

 private:
  float at_sample(std::size_t sample) const;

  const Occlusion& occlusion_;
  Float3 to_lamp_;
  // Of each sample; negative: not known yet. Two threads that compute the same sample get the same number.
  mutable std::vector<float> known_;
};

/// Everything that light depends on, for all pixels.
struct Scenery {
  const Camera& camera;
  const Occlusion& occlusion;
  const Shadow& shadow;  ///< of the lamp
  Float3 to_lamp;
  const Ramp& ramp;
  Float3 up;                ///< of the world
  float pixel = 0;          ///< about the width of a pixel, in the unit space
  double contour_step = 0;  ///< between the contour lines of slices, world units
  Float3 outside, inside;   ///< of slices beyond the band
  bool perspective = true;
};

/// Towards the lamp, which stays above the eye's left shoulder.
Float3 to_lamp(const Camera& camera);

/// Shades points of triangles. How much light reaches a point changes slowly, so neighbours that ask one after the
/// other share it. One for each tile: what is shared must not depend on the order in which tiles are drawn.
class Shader {
 public:
  explicit Shader(const Scenery& scenery) : scenery_(scenery) {}

  struct Seen {
    Float3 color;  ///< linear
    float opacity;
  };
  /// A triangle of a part at a place of the picture, subpixels, within the triangle.
  Seen seen(const SeenPart& part, std::uint32_t triangle, float x, float y);
  /// To be called where the next point is no neighbour of the last.
  void forget() { lighting_known_ = false; }

 private:
  struct Weights {
    float a, b, c;
  };
  Weights weights(const ScreenPoint& a, const ScreenPoint& b, const ScreenPoint& c, double x, double y) const;
  Seen of_slice(const SeenPart& part, const Triangle& v, float x, float y) const;
  Float3 color(const SeenPart& part, const Triangle& v, float x, float y);
  Float3 lit(Float3 color, Float3 point, Float3 normal);

  const Scenery& scenery_;
  bool lighting_known_ = false;
  Float3 known_point_, known_normal_;
  float known_ambient_ = 1, known_lamp_ = 1;
};

}  // namespace standoff
