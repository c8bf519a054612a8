// SPDX-License-Identifier: Apache-2.0
// Pictures, as files.
#include "standoff/picture.h"

#include "arrays.h"
#include "lock.h"
#include "options.h"
#include "standoff/slice.h"

namespace standoff::python {
namespace {

constexpr const char* kPictureAxes[] = {"x", "y", "z"};

void slice(const DistanceField& field, const std::filesystem::path& path, const std::optional<std::string>& axis,
           std::optional<double> at, const std::string& colormap, const std::string& background,
           const std::string& interpolation, bool contours, bool bare, const std::string& title,
           const std::string& unit, const std::string& legend, int pixels) {
  constexpr const char* kColormaps[] = {"viridis", "thesis", "diverging", "auto"};
  constexpr const char* kBackgrounds[] = {"white", "dark"};
  constexpr const char* kInterpolations[] = {"auto", "nearest", "linear"};
  SliceOptions options;
  if (axis) options.axis = static_cast<Axis>(choice_of("axis", *axis, kPictureAxes));
  options.at = at;
  options.colormap = static_cast<Colormap>(choice_of("colormap", colormap, kColormaps));
  options.background = static_cast<Background>(choice_of("background", background, kBackgrounds));
  options.interpolation = static_cast<Interpolation>(choice_of("interpolation", interpolation, kInterpolations));
  options.contours = contours;
  options.bare = bare;
  options.title = title;
  options.unit = unit;
  options.legend = legend;
  options.pixels = pixels;
  const Unlocked released;
  write_slice_png(path, field, options);
}

void mesh_picture(const VertexInput& vertices, const FaceInput& faces, const std::filesystem::path& path, int width,
                  int height, double azimuth, double elevation, const std::string& up) {
  const MeshView mesh = view_of(vertices, faces);
  const PictureOptions options{
      .width = width, .height = height, .azimuth_deg = azimuth, .elevation_deg = elevation, .up = up_of(up)};
  const Unlocked released;
  write_mesh_png(path, mesh, options);
}

}  // namespace

void add_pictures(nb::module_& m) {
  m.def("write_slice", &slice, "field"_a, "path"_a, "axis"_a.none(), "at"_a.none(), "colormap"_a, "background"_a,
        "interpolation"_a, "contours"_a, "bare"_a, "title"_a, "unit"_a, "legend"_a, "pixels"_a);
  m.def("write_picture", &mesh_picture, "vertices"_a.noconvert(), "faces"_a.noconvert(), "path"_a, "width"_a,
        "height"_a, "azimuth"_a, "elevation"_a, "up"_a);
}

}  // namespace standoff::python
