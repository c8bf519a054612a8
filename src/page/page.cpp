// SPDX-License-Identifier: Apache-2.0
#include "standoff/page.h"

#include <utility>

#include "core/guarded.h"
#include "files/atomic_file.h"
#include "page/field_blob.h"
#include "page/html.h"
#include "page/mesh_blob.h"
#include "standoff/error.h"

namespace standoff {
namespace {

constexpr const char* kLessMemory =
    "show less in one page, allow it fewer samples or triangles, or provide more memory";

void expect_between(const char* name, std::int64_t value, std::int64_t least, std::int64_t most) {
  if (value < least || value > most)
    throw Error(ErrorCode::usage, std::string("PageOptions::") + name + " is " + std::to_string(value) +
                                      "; give a number from " + std::to_string(least) + " to " + std::to_string(most));
}

void check(const PageOptions& options) {
  expect_between("most_samples", options.most_samples, 512, std::int64_t{1} << 27);
  expect_between("most_triangles", options.most_triangles, 1000, 50'000'000);
  expect_between("proxy_triangles", options.proxy_triangles, 100, 50'000'000);
  expect_between("compression", options.compression, 0, 9);
  if (options.up != Axis::x && options.up != Axis::y && options.up != Axis::z)
    throw Error(ErrorCode::usage, "PageOptions::up is no axis; give Axis::x, y or z");
}

std::string title_of(std::span<const PageMesh> meshes, std::span<const PageField> fields, const PageOptions& options) {
  if (!options.title.empty()) return options.title;
  std::string title;
  const auto add = [&](const std::string& name) { title += (title.empty() ? "" : ", ") + name; };
  for (const PageMesh& mesh : meshes) add(mesh.name);
  for (const PageField& field : fields) add(field.name);
  return title.empty() ? "standoff" : title;
}

std::string made(std::span<const PageMesh> meshes, std::span<const PageField> fields, const PageOptions& options,
                 std::vector<PageItem>* held) {
  check(options);
  std::vector<std::string> blobs;
  std::vector<PageItem> items;
  for (const PageMesh& mesh : meshes) blobs.push_back(page::mesh_blob(mesh, options, &items.emplace_back()));
  for (const PageField& field : fields) blobs.push_back(page::field_blob(field, options, &items.emplace_back()));
  std::string html = page::html(title_of(meshes, fields, options), options, blobs);
  if (held) *held = std::move(items);
  return html;
}

}  // namespace

std::string make_page(std::span<const PageMesh> meshes, std::span<const PageField> fields, const PageOptions& options,
                      std::vector<PageItem>* held) {
  try {
    return made(meshes, fields, options, held);
  } catch (...) {
    throw_as_error("make_page", kLessMemory);
  }
}

void write_page(const std::filesystem::path& path, std::span<const PageMesh> meshes, std::span<const PageField> fields,
                const PageOptions& options, std::vector<PageItem>* held, Existing existing) {
  try {
    write_text(path, made(meshes, fields, options, held), existing);
  } catch (...) {
    throw_as_error("write_page", kLessMemory);
  }
}

std::string page_data(const PageMesh& mesh, const PageOptions& options, PageItem* held) {
  try {
    check(options);
    return page::mesh_blob(mesh, options, held);
  } catch (...) {
    throw_as_error("page_data", kLessMemory);
  }
}

std::string page_data(const PageField& field, const PageOptions& options, PageItem* held) {
  try {
    check(options);
    return page::field_blob(field, options, held);
  } catch (...) {
    throw_as_error("page_data", kLessMemory);
  }
}

}  // namespace standoff
