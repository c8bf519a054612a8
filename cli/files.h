// SPDX-License-Identifier: Apache-2.0
// Files that verbs read and write: meshes, fields, bodies, outputs.
#pragma once

#include <algorithm>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>

#include <CLI/CLI.hpp>

#include "cli/console.h"
#include "standoff/collision.h"
#include "standoff/field.h"
#include "standoff/field_slices.h"
#include "standoff/io.h"
#include "standoff/mesh.h"
#include "standoff/zarr.h"

namespace standoff::cli {

enum class FileKind { mesh, field, body, query };

/// Decides by the extension. A name without a known one is a mesh's, because meshes are recognised by content.
FileKind kind_of(const std::filesystem::path& path);

/// Whether the name is that of a Zarr store, or of an array in one, which is read part by part (standoff/zarr.h).
bool is_store(const std::filesystem::path& path);

/// Checks an input's name before anything is read or written: a scene must exist; a file must exist, be no folder (but
/// where its format is one), and be readable. Errors: usage (scene), input.
void check_input(const std::string& name);

/// A mesh made by code, as `scene:NAME[:TRIANGLES]` names it.
struct SceneName {
  std::string name;
  std::int64_t triangles = 0;  ///< 0: the scene's own count
};
/// Parses a name with or without `scene:`. Errors: usage (the number of triangles).
SceneName parse_scene(const std::string& text);

/// A mesh that a verb reads: a file, or `scene:NAME[:TRIANGLES]`.
class MeshInput {
 public:
  /// Adds the positional argument MESH.
  void add_to(CLI::App& verb);
  /// Adds the positional argument FILE for verbs that take meshes, fields and, with `bodies`, bodies.
  void add_any_to(CLI::App& verb, bool bodies);
  /// Adds the positional argument MESH, which may also be a query that standoff build made.
  void add_query_to(CLI::App& verb);
  /// Adds --scale and --unit.
  void add_scale_to(CLI::App& verb);

  bool scaled() const { return scale_ || unit_; }
  /// What coordinates are multiplied by.
  double scale() const { return scale_ ? *scale_ : unit_.value_or(1); }
  const std::string& name() const { return name_; }
  /// Returns the mesh's name without folder and extension.
  std::string stem() const;
  /// Reads the mesh. Errors: input, also for fields and bodies.
  Mesh read() const { return read_with_report().mesh; }
  /// The same with what was done to the file's coordinates.
  MeshReadResult read_with_report() const;

  /// How a mesh that was made of this one is written: in its unit, and with its direction that is up.
  MeshWriteOptions write_options(const MeshReadReport& read, Existing existing) const;

  /// Sets a name that is no argument of its own.
  void set_name(const std::string& name) { name_ = name; }

 private:
  std::string name_;
  std::optional<double> scale_;
  std::optional<double> unit_;
};

/// A file that a verb writes.
class FileOutput {
 public:
  /// Adds -o and -f. `what` goes into the help: "the field: .vti (default), .nrrd or .npz".
  void add_to(CLI::App& verb, const char* placeholder, const std::string& what, const char* name = "-o,--output");

  bool given() const { return !path_.empty(); }
  const std::filesystem::path& path() const { return path_; }
  void set_path(const std::filesystem::path& path) { path_ = path; }
  /// Checks before any work that the file can be written. Errors: usage, for an unknown extension and for a file in the
  /// way without -f; output, for a folder in the way or a missing one. Where the format is a folder, one in the way is
  /// as a file.
  void check(const std::vector<FileFormat>& formats) const;
  /// Does the same, but accepts a file in the way.
  void check_name(const std::vector<FileFormat>& formats) const;
  /// Says whether a file is in the way, without -f.
  bool in_the_way() const;
  /// A second output beside this one, with the same -f. Throws Error{usage} where both are one file.
  FileOutput beside(const std::filesystem::path& path) const;
  /// Throws Error{usage} where the output is the file that an input comes from, also with -f.
  void check_differs(const std::string& input) const;
  /// A file that has appeared since the check stays, unless -f was given.
  Existing existing() const { return force_ ? Existing::replace : Existing::keep; }
  /// The row of the file's format; an empty one if it has none.
  FileFormat format(const std::vector<FileFormat>& formats) const;
  /// Throws Error{usage} where more than one level is given, and the file is no store.
  void check_levels(int levels) const;
  /// Throws Error{usage} "FILE: .EXTENSION WHAT; write .., or leave out LEAVE_OUT" unless the file's format can.
  void check_carries(const std::vector<FileFormat>& formats, bool FileFormat::*can, const char* what,
                     const char* leave_out) const;

 private:
  std::filesystem::path path_;
  bool force_ = false;
};

/// The bytes of a file, or of all files of a folder. A pipe has 0.
std::int64_t written_bytes(const std::filesystem::path& path);

/// Says which unit a format takes for coordinates whose unit is unknown, if it has one.
void say_taken_unit(const Console& console, const std::filesystem::path& output, const MeshWriteOptions& options);

/// "MESH: 12 triangles, 8 vertices".
std::string mesh_line(const std::string& name, const Mesh& mesh);

/// The names of the formats that can be read or written: ".vti, .nrrd or .npz".
std::string extensions(const std::vector<FileFormat>& formats, bool writable);

class FieldArgument {
 public:
  /// Adds --memory-limit, for `what`, and --level.
  void add_to(CLI::App& verb, const std::string& what = "the field that is read");
  /// Returns the given limit; 0 if there is none, which stands for the default.
  std::int64_t memory_limit() const { return memory_limit_; }
  /// Reads the field, and shows on a terminal what is waited for. Errors: input; limit, before any memory is taken.
  DistanceField read(const std::string& name, const Console& console) const;
  /// A store, or a file that memory cannot hold as a whole, as slices that are read at a time; any other as a whole.
  struct Parts {
    std::optional<FieldSlices> slices;
    FieldFile whole;  ///< without slices
  };
  Parts read_parts(const std::string& name, const Console& console) const;
  /// The slices of a store, or of a file of which they can be read.
  FieldSlices open_slices(const std::string& name) const;
  /// How slices are read, and how many samples at a time, so that those of a dense field are within the limit.
  FieldReadOptions reading() const { return {.memory_limit = memory_limit_}; }
  std::int64_t slice_samples() const {
    constexpr std::int64_t kBytes = 8;  // of a sample, with what is made of it
    return memory_limit_ > 0 ? std::clamp<std::int64_t>(memory_limit_ / kBytes, 1, kSlabSamples) : kSlabSamples;
  }
  /// Reads the field with its sidecars.
  FieldFile read_file(const std::string& name, const Console& console) const;
  /// The store of the name, or the level of it that was asked for.
  ZarrStore open_store(const std::string& name) const;
  /// Reads what is to be looked at: of a store, the first level from the given one on that the memory limit allows.
  /// Says so where it is another one.
  DistanceField read_fitting(const std::string& name, const Console& console) const;
  /// Throws Error{usage} where an option was given: `name` is no field.
  void check_unused(const std::string& name) const;

 private:
  FieldReadOptions options_for(const std::string& name) const;

  std::int64_t memory_limit_ = 0;
  int level_ = 0;  // of a store
};

/// Makes a body of a mesh, or reads one that standoff build made (NAME.body), and shows on a terminal what is waited
/// for. `up`, unless null, receives the axis of its mesh that points up.
Body read_body(const std::string& name, const Console& console, Axis* up = nullptr);

/// Two bodies A and B, and where A is.
class PairInput {
 public:
  /// Adds the arguments A and B and the option --pose-a.
  void add_to(CLI::App& verb);
  /// Checks both names before anything is built. Errors: usage, input.
  void check() const;
  Body read_a(const Console& console) const { return read_body(a_, console); }
  Body read_b(const Console& console) const { return read_body(b_, console); }
  const std::string& name_a() const { return a_; }
  const std::string& name_b() const { return b_; }
  const Pose& pose_a() const { return pose_a_; }

 private:
  std::string a_, b_;
  Pose pose_a_;
};

/// Adds an option that takes a pose.
CLI::Option* add_pose(CLI::App& verb, const char* name, const char* help, Pose& pose);

/// Adds a body's mesh, whether it is closed, its grid, thickness and memory to an answer.
void add_body(Json& json, const Body& body);

}  // namespace standoff::cli
