// SPDX-License-Identifier: Apache-2.0
// Where a batch's results go: a file for each mesh, or a row of one array.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>

#include "batch/field_array.h"
#include "batch/training_points.h"
#include "standoff/field.h"
#include "standoff/points.h"

namespace standoff::cli {

/// A mesh as results know it.
struct MeshId {
  std::int64_t index = 0;  ///< its place in the list, from 0
  std::string name;        ///< as it stands in the list
  std::uint64_t hash = 0;  ///< of the name

  static MeshId of(std::int64_t index, const std::string& name);
};

/// What was put somewhere.
struct Placed {
  std::string file;        ///< relative to the batch's folder, with slashes
  std::int64_t row = -1;   ///< of it, where it is an array
  std::int64_t bytes = 0;  ///< 0: it is not there
  std::uint64_t hash = 0;  ///< of the bytes
};

/// Results of worker processes: two put() never run at once in one of them, but do in several.
class ResultSink {
 public:
  virtual ~ResultSink() = default;
  /// Whether a result of so many bytes with that hash, which put() once returned, is there.
  virtual bool holds(const MeshId& mesh, std::int64_t bytes, std::uint64_t hash) const = 0;
  /// The file that is to be a mesh's result, in a folder that is there now; empty where results are no files of their
  /// own. Errors: output.
  virtual std::filesystem::path file_of(const MeshId& mesh) const = 0;
  /// Says where it is, once somebody else has put it there.
  virtual Placed placed(const MeshId& mesh) const = 0;
  /// Puts a result in its place, whole or not at all; another one there is replaced. Errors: output.
  virtual Placed put(const MeshId& mesh, const DistanceField& field, int threads) = 0;
  virtual Placed put(const MeshId& mesh, const TrainingPoints& points, const MeshQuery& query) = 0;
  /// Removes an earlier result, so that one that somebody else puts there takes its name in one step: a process that is
  /// killed while it replaces a file may leave an unfinished one. put() does so, too. Errors: output.
  virtual void clear(const MeshId& mesh) = 0;
  /// The mesh has failed: where its place would go on showing an earlier result, that is removed. Errors: output.
  virtual void forget(const MeshId& mesh) = 0;
};

/// A file for each mesh in `folder`/`part`, in folders as in the list: `fields/parts/bolt-0123456789abcdef.npz` of
/// parts/bolt.stl. The digits are the hash of the name, so that no two names meet, whatever becomes of the rest of
/// them: parts ".." are replaced, control characters too, and long parts cut. `extension` is without its dot.
std::unique_ptr<ResultSink> file_sink(const std::filesystem::path& folder, const std::string& part,
                                      const std::string& extension, bool compress);

/// The name of the array of all fields in a batch's folder.
inline constexpr const char* kArrayName = "fields.zarr";

/// Row `index` of the array `folder`/fields.zarr for each mesh.
std::unique_ptr<ResultSink> array_sink(const std::filesystem::path& folder, const FieldArrayLayout& layout);

}  // namespace standoff::cli
