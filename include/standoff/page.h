// SPDX-License-Identifier: Apache-2.0
// One HTML page that shows meshes and fields in any browser, without a network.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "standoff/axis.h"
#include "standoff/existing.h"
#include "standoff/export.h"
#include "standoff/field.h"
#include "standoff/mesh_view.h"

namespace standoff {

/// A mesh that a page shows.
struct PageMesh {
  std::string name;  ///< as the page shows it; any text, bytes that are no UTF-8 are replaced
  MeshView mesh;
  std::optional<Axis> up = {};  ///< its axis that points up, if that is known (MeshReadReport::up)
};

/// A field that a page shows.
struct PageField {
  std::string name;
  const DistanceField* field = nullptr;
};

struct PageOptions {
  std::string title = {};  ///< the page's title; empty: the names of what it shows
  std::string unit = {};   ///< of lengths, as the legend names it: "mm"; empty: "world units"
  /// The axis that points up on the screen. None: the first that a mesh or a field's provenance names; else up_axis()
  /// of the first mesh; else z.
  std::optional<Axis> up = {};
  /// A field with more samples than this in stored tiles, more than 2^24 tiles, or 2^14 samples along an axis, is
  /// thinned: the page holds every second, third .. sample per axis. 512 to 2^27.
  std::int64_t most_samples = std::int64_t{1} << 24;
  /// A mesh with more triangles than this is simplified. 1,000 to 50,000,000.
  std::int64_t most_triangles = 5'000'000;
  /// A mesh with more triangles than this gets a simplified one beside it, of at most two thirds as many as this, which
  /// is drawn while the camera moves; unless that would not look the same: then the page makes one, which keeps beams
  /// and wires. 100 to 50,000,000.
  std::int64_t proxy_triangles = 70'000;
  int compression = 6;  ///< 0 (none) to 9 (smallest), as zlib has them
  /// The page asks the server that it came from for what it shows (view/README.md).
  bool served = false;
};

/// What a page holds of a mesh or a field.
struct PageItem {
  std::string name;
  std::int64_t bytes = 0;  ///< packed, before they become text
  /// Of a mesh: how many triangles the page holds, and those that it holds to be drawn while the camera moves.
  std::int64_t triangles = 0, proxy_triangles = 0;
  /// Of a field: every how many-th sample per axis the page holds.
  std::int64_t every = 0;
  /// No coordinate of a mesh's vertex, or value of a field's finite sample, is farther than this from the one given.
  /// World units.
  double error = 0;
};

/// A page that shows meshes and fields: self-contained HTML that asks the network for nothing and runs no script but
/// its own, whatever the names are. Positions and values are rounded (PageItem::error); two fields can be compared.
/// `held`, unless null, receives an item for each mesh and then each field. Takes about 60 bytes per triangle and 8 per
/// sample that the page holds.
/// Errors: usage (options; a field that is null), input (mesh), limit (memory; a mesh that has more than
/// options.most_triangles, where the library is built without meshoptimizer).
STANDOFF_API std::string make_page(std::span<const PageMesh> meshes, std::span<const PageField> fields,
                                   const PageOptions& options = {}, std::vector<PageItem>* held = nullptr);

/// The axis that points up in a page of these, where PageOptions::up is none. Errors: input (mesh).
STANDOFF_API Axis up_axis(std::span<const PageMesh> meshes, std::span<const PageField> fields);

/// Writes such a page; the file appears whole or not at all. Errors: as make_page(); output.
STANDOFF_API void write_page(const std::filesystem::path& path, std::span<const PageMesh> meshes,
                             std::span<const PageField> fields, const PageOptions& options = {},
                             std::vector<PageItem>* held = nullptr, Existing existing = Existing::replace);

/// A mesh as pages hold it: the bytes that a server hands to a page (view/README.md). Errors: as make_page().
STANDOFF_API std::string page_data(const PageMesh& mesh, const PageOptions& options = {}, PageItem* held = nullptr);
/// The same for a field.
STANDOFF_API std::string page_data(const PageField& field, const PageOptions& options = {}, PageItem* held = nullptr);

}  // namespace standoff
