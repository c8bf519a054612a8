// SPDX-License-Identifier: Apache-2.0
// page.h with arguments that make no sense.
#include "standoff/page.h"
#include "tests/api/misuse.h"
#include "tests/support/temp_folder.h"

namespace standoff {
namespace {

using namespace testing;

TEST(Misuse, Pages) {
  const std::vector<PageField> none{{"none", nullptr}};
  expect_usage("field", [&] { make_page({}, none); });
  expect_usage("field", [&] { page_data(none.front()); });
  const DistanceField empty;
  const std::vector<PageField> empty_one{{"empty", &empty}};
  expect_answer_or_error("an empty field", [&] { make_page({}, empty_one); });
  expect_answer_or_error("no field", [&] { up_axis({}, none); });
  for (const std::vector<Mesh>& meshes : {odd_meshes(), unusable_meshes()})
    for (const Mesh& mesh : meshes) {
      const std::vector<PageMesh> one{{"mesh", mesh}};
      expect_answer_or_error("mesh", [&] { make_page(one, {}); });
      expect_answer_or_error("mesh", [&] { page_data(one.front()); });
      expect_answer_or_error("mesh", [&] { up_axis(one, {}); });
      expect_answer_or_error("mesh", [&] { up_axis(MeshView(mesh)); });
    }
}

TEST(Misuse, OptionsOfPages) {
  for (const std::int64_t n : kCounts) {
    expect_answer_or_error(named("samples", n), [&] { make_page({}, {}, {.most_samples = n}); });
    expect_answer_or_error(named("triangles", n), [&] { make_page({}, {}, {.most_triangles = n}); });
    expect_answer_or_error(named("proxy", n), [&] { make_page({}, {}, {.proxy_triangles = n}); });
  }
  expect_usage("samples", [&] { make_page({}, {}, {.most_samples = 0}); });
  expect_usage("triangles", [&] { make_page({}, {}, {.most_triangles = 0}); });
  expect_usage("proxy", [&] { make_page({}, {}, {.proxy_triangles = 0}); });
  expect_usage("compression", [&] { make_page({}, {}, {.compression = 10}); });
  expect_usage("up", [&] { make_page({}, {}, {.up = none_of<Axis>()}); });
  const TempFolder folder;
  expect_answer_or_error("a folder", [&] { write_page(folder.path(), {}, {}); });
}

}  // namespace
}  // namespace standoff
