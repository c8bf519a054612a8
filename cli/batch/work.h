// SPDX-License-Identifier: Apache-2.0
// What a worker of a batch does with one mesh, and the row that comes of it.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <variant>

#include "batch/normalize.h"
#include "batch/training_points.h"
#include "cli/batch/pool.h"
#include "cli/batch/sink.h"
#include "cli/field_options.h"
#include "cli/files.h"
#include "cli/json.h"
#include "standoff/field.h"
#include "standoff/field_cache.h"

namespace standoff::cli {

/// What is made of every mesh.
struct BatchMaking {
  MeshInput mesh;  ///< for its scale
  FieldOptions field;
  Normalization normalization = Normalization::none;
  std::optional<TrainingPointOptions> points;  ///< in place of a field
  std::string extension = "npz";
  std::optional<FieldArrayLayout> array;  ///< in place of files
  bool compress = true;
  std::optional<FieldCache> cache;
  int workers = 1;  ///< meshes side by side, and threads of one that has the machine alone

  /// All that decides a result, by which runs are compared; with the program's version.
  Json parameters() const;
};

/// A mesh that is asked for. A worker gets it as text.
struct BatchOrder {
  MeshId mesh;
  std::string path;  ///< where it lies
  // Nothing is done where the file and the result are still those of an earlier row:
  std::uint64_t earlier_hash = 0;    ///< of the file; 0: there is no such row
  std::int64_t earlier_bytes = 0;    ///< of the result
  std::uint64_t earlier_result = 0;  ///< its hash

  std::string text() const;
  static BatchOrder of(const std::string& text);
};

/// The answer to an order: a row, or that the earlier one still holds.
struct BatchAnswer {
  bool holds = false;
  int code = 0;            ///< of the row
  bool unsure = false;     ///< is_unsure() of the row
  std::string row = {};    ///< with the line's end
  std::string doubt = {};  ///< of the thickness, for a warning; empty: none

  std::string text() const;
  static BatchAnswer of(const std::string& text);
};

/// The row of a mesh as far as nothing is known but the order. `parameters`: their hash.
Json row_of(const BatchOrder& order, const std::string& parameters);
/// Sets status, code and message.
void set_status(Json& row, int code, const std::string& message);
/// The row of a mesh whose process ended before it answered.
BatchAnswer answer_of_lost(const BatchOrder& order, const std::string& parameters, const TaskEnd& end,
                           double timeout_s);

/// Whether a mesh takes so much to read that it should be read alone: more than 256 MiB, or its part of the memory.
bool is_large_file(const std::string& path, const BatchMaking& making);

class MeshWork {
 public:
  MeshWork(const BatchMaking& making, std::shared_ptr<ResultSink> sink, const std::string& parameters)
      : making_(making), sink_(std::move(sink)), parameters_(parameters) {}

  /// Makes what was ordered. Whatever is wrong becomes a row. Meshes of more than a million triangles, and fields or
  /// points of more than 16 million samples, take about a second and more of one thread: these, and those that need
  /// more than their part of the memory, wait to be alone and then take all threads.
  BatchAnswer make(const BatchOrder& order, const std::function<void()>& wait_to_be_alone);

 private:
  /// False where the result of the earlier row still holds.
  bool make_row(const BatchOrder& order, const std::function<void()>& wait_to_be_alone, Json& row);
  bool still_holds(const BatchOrder& order, std::uint64_t file_hash, Json& row) const;
  MeshReadResult read(const BatchOrder& order, Json& row, bool& holds) const;
  void make_field(const BatchOrder& order, const Mesh& mesh, const GridChoice& choice, Json& row);
  bool fetch_field(const BatchOrder& order, const Mesh& mesh, const GridChoice& choice, Json& row);
  void make_points(const BatchOrder& order, const Mesh& mesh, const GridChoice& choice, Json& row);
  struct Need;
  Need need(const Mesh& mesh, const GridChoice& choice) const;
  Need need_of(const MemoryEstimate& field) const;
  bool is_large(const Need& need, std::int64_t triangles) const;
  void begin(const Mesh& mesh, const GridChoice& choice, const std::function<void()>& wait_to_be_alone);

  BatchMaking making_;
  std::shared_ptr<ResultSink> sink_;
  std::string parameters_;
  DistanceField field_;  // kept from one mesh to the next: allocating it anew takes a third of a small field's time
  Json seconds_;         // of the mesh being worked on
  std::string doubt_;
  FieldCache::Key cache_key_;
  double waited_s_ = 0;  // to be alone
  int threads_ = 1;
  bool alone_ = false;
};

}  // namespace standoff::cli
