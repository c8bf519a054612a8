// SPDX-License-Identifier: Apache-2.0
#include "render/mesh_picture.h"

#include "core/guarded.h"
#include "render/camera.h"
#include "render/raster.h"
#include "standoff/error.h"

namespace standoff {
namespace {

constexpr Color kBackground{246, 247, 249};
constexpr int kSupersampling = 2;  // what halved() undoes

void check(const PictureOptions& options) {
  for (const int side : {options.width, options.height})
    if (side < 16 || side > 8192)
      throw Error(ErrorCode::usage, "picture: width and height must be 16 to 8192 pixels; 1280 by 960 is usual");
  if (!std::isfinite(options.azimuth_deg))
    throw Error(ErrorCode::usage, "picture: the azimuth must be finite; give degrees");
  if (!(std::abs(options.elevation_deg) <= 90))
    throw Error(ErrorCode::usage, "picture: the elevation must be -90 to 90 degrees; 0 is level");
  if (options.up != Axis::x && options.up != Axis::y && options.up != Axis::z)
    throw Error(ErrorCode::usage, "picture: there is no such axis; take x, y or z");
}

// Light for a unit normal in the eye's axes that faces the eye: a soft sky over a darker ground, and a lamp above the
// eye's left shoulder. Chosen by eye.
Color shaded(Vec3 normal, double skyward) {
  constexpr Vec3 kLamp{-0.43, 0.62, 0.66};
  constexpr Vec3 kSky{0.34, 0.38, 0.45}, kGround{0.16, 0.14, 0.13}, kSun{0.62, 0.58, 0.52}, kClay{0.55, 0.63, 0.74};
  const double up = 0.5 + 0.5 * skyward;
  const Vec3 light = kClay * (kSky * up + kGround * (1 - up) + kSun * std::max(0.0, dot(normal, kLamp)));
  const auto encoded = [](double linear) {
    return static_cast<std::uint8_t>(std::lround(255 * std::pow(std::min(linear, 1.0), 1 / 2.2)));
  };
  return {encoded(light.x), encoded(light.y), encoded(light.z)};
}

Vec3 up_vector(Axis up) { return {up == Axis::x ? 1.0 : 0.0, up == Axis::y ? 1.0 : 0.0, up == Axis::z ? 1.0 : 0.0}; }

}  // namespace

Image draw_mesh(MeshView mesh, const PictureOptions& options) {
  check(options);
  validate(mesh);
  const Camera camera(bounds(mesh), options);
  Raster raster(options.width * kSupersampling, options.height * kSupersampling, kBackground);
  const auto points = camera.project(mesh, raster.image().width, raster.image().height);
  const Vec3 world_up = camera.turned(up_vector(options.up));
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    const auto [a, b, c] = mesh.corners(t);
    const Vec3 normal = camera.facing_normal(a, b, c);
    const Triangle& v = mesh.triangles[t];
    raster.draw(points[v[0]], points[v[1]], points[v[2]], shaded(normal, dot(normal, world_up)));
  }
  return halved(raster.image());
}

void write_mesh_png(const std::filesystem::path& path, MeshView mesh, const PictureOptions& options,
                    Existing existing) try {
  require_png();
  write_png(path, draw_mesh(mesh, options), existing);
} catch (...) {
  throw_as_error("picture", "draw fewer pixels, or provide more memory");
}

}  // namespace standoff
