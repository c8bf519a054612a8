// SPDX-License-Identifier: Apache-2.0
// Pictures, as files, and pages for browsers and notebooks.
#include "standoff/picture.h"

#include "arrays.h"
#include "lock.h"
#include "options.h"
#include "standoff/page.h"
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
  const SliceOptions options{
      .axis = axis ? std::optional(static_cast<Axis>(choice_of("axis", *axis, kPictureAxes))) : std::nullopt,
      .at = at,
      .colormap = static_cast<Colormap>(choice_of("colormap", colormap, kColormaps)),
      .interpolation = static_cast<Interpolation>(choice_of("interpolation", interpolation, kInterpolations)),
      .background = static_cast<Background>(choice_of("background", background, kBackgrounds)),
      .pixels = pixels,
      .contours = contours,
      .bare = bare,
      .title = title,
      .unit = unit,
      .legend = legend};
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

using NamedMesh = std::tuple<std::string, VertexInput, FaceInput>;

nb::bytes page(const std::vector<NamedMesh>& meshes, const std::vector<std::string>& names, const nb::list& fields,
               const std::string& title, const std::string& unit, const std::string& up) {
  std::vector<PageMesh> shown_meshes;
  for (const auto& [name, vertices, faces] : meshes) shown_meshes.push_back({name, view_of(vertices, faces)});
  std::vector<PageField> shown_fields;
  for (std::size_t n = 0; n < names.size(); ++n)
    shown_fields.push_back({names[n], &nb::cast<const DistanceField&>(fields[n])});
  const PageOptions options{.title = title, .unit = unit, .up = up_of(up)};
  std::string html;
  {
    const Unlocked released;
    html = make_page(shown_meshes, shown_fields, options);
  }
  return nb::bytes(html.data(), html.size());
}

}  // namespace

void add_pictures(nb::module_& m) {
  m.def("write_slice", &slice, "field"_a, "path"_a, "axis"_a.none(), "at"_a.none(), "colormap"_a, "background"_a,
        "interpolation"_a, "contours"_a, "bare"_a, "title"_a, "unit"_a, "legend"_a, "pixels"_a);
  m.def("write_picture", &mesh_picture, "vertices"_a.noconvert(), "faces"_a.noconvert(), "path"_a, "width"_a,
        "height"_a, "azimuth"_a, "elevation"_a, "up"_a);
}

void add_pages(nb::module_& m) {
  m.def("make_page", &page, "meshes"_a, "names"_a, "fields"_a, "title"_a, "unit"_a, "up"_a);
}

}  // namespace standoff::python
