// SPDX-License-Identifier: Apache-2.0
// Pages for browsers and notebooks.
#include "standoff/page.h"

#include "arrays.h"
#include "lock.h"
#include "options.h"

namespace standoff::python {
namespace {

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

void add_pages(nb::module_& m) {
  m.def("make_page", &page, "meshes"_a, "names"_a, "fields"_a, "title"_a, "unit"_a, "up"_a);
}

}  // namespace standoff::python
