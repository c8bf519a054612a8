// SPDX-License-Identifier: Apache-2.0
// The manifest of a batch: a line of JSON for each mesh, written once its output is complete (docs/batch_files.md).
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <unordered_map>
#include <vector>

#include "batch/field_array.h"
#include "cli/batch/list.h"
#include "cli/batch/sink.h"
#include "cli/json.h"
#include "files/file_view.h"

namespace standoff::cli {

/// What a row says of the exit code that the program would have had: "ok", "input", "limit".
const char* status_name(int code);

std::filesystem::path manifest_path(const std::filesystem::path& folder, const Shard& shard);
std::filesystem::path summary_path(const std::filesystem::path& folder, const Shard& shard);

/// Results are left to the system, file by file; a batch that has come to its end is on the disk (on Linux).
void wait_for_disk(const std::filesystem::path& folder);

/// A line of JSON, ended. Bytes of names that are no UTF-8 are replaced.
std::string row_text(const Json& row);
/// Whether a row tells of a result whose sign is not certain.
bool is_unsure(const Json& row);
/// Sixteen hexadecimal digits; nothing for other text.
std::optional<std::uint64_t> parse_hash(const std::string& text);

/// A line of a manifest, and where it is.
struct ManifestLine {
  std::string_view text;  ///< without its end
  std::uint64_t offset = 0;
  std::uint64_t number = 0;  ///< from 1
};

/// Calls use(row, line) for all rows. Returns the bytes of whole lines: a last line without an end was being written
/// when its program was killed, and counts as missing. Memory: one line. Errors: input, where a whole line is no row.
std::uint64_t each_row(const std::filesystem::path& manifest,
                       const std::function<void(const Json& row, const ManifestLine& line)>& use);

/// A manifest that rows are appended to. One process at a time may do so.
class ManifestWriter {
 public:
  enum class Start {
    anew,   ///< what it held is dropped
    go_on,  ///< behind its last whole row
  };
  /// Errors: output, also where another process has it open.
  ManifestWriter(const std::filesystem::path& path, Start start);

  /// Appends a row that row_text() made. When it returns, no end of this process takes the row away. Errors: output;
  /// then the file ends with a whole row, unless that cannot be seen to either.
  void append(const std::string& row);
  /// The open file, whose lock lasts until all that have it open close it.
  int descriptor() const { return file_.number(); }

 private:
  [[noreturn]] void fail(int error) const;

  std::filesystem::path path_;
  Descriptor file_;
  std::uint64_t size_ = 0;
};

/// What earlier runs have found out about the meshes of a manifest: their last rows. Meshes are known by the hash of
/// their names, or, where results lie by their places in the list, by that and their place.
class EarlierRows {
 public:
  struct Row {
    std::uint64_t id = 0;
    std::uint64_t file_hash = 0;  ///< 0: unknown
    std::uint64_t result = 0;     ///< the hash of the output
    std::int64_t bytes = 0;       ///< of it
    std::int64_t index = 0;       ///< in the list of that run
    std::uint64_t offset = 0;     ///< in the manifest
    std::uint32_t length = 0;
    std::int16_t code = 0;
    bool same_parameters = false;
  };
  EarlierRows() = default;
  /// Reads a manifest; there are no rows where there is none. Takes about 140 bytes for each mesh. Errors: input.
  EarlierRows(const std::filesystem::path& manifest, const std::string& parameters, bool by_place);

  const Row* find(const MeshId& mesh) const;
  /// The row of a mesh that is kept, as it must be written again since its place in the list has changed; nothing where
  /// the row that is there will do. Errors: input.
  std::optional<std::string> moved_row(const MeshId& mesh) const;
  /// Whether a mesh is done that other parameters were given for.
  bool has_others() const;

 private:
  struct Last {
    std::uint64_t id = 0;
    std::int16_t code = 0;
  };

  std::filesystem::path manifest_;
  bool by_place_ = false;
  std::unordered_map<std::uint64_t, Row> rows_;     // by the place, or else by the name's hash
  std::unordered_map<std::int64_t, Last> last_at_;  // the last row with that index
};

/// Counts rows by their codes.
using StatusCounts = std::map<int, std::int64_t>;
Json counts_json(const StatusCounts& counts);
/// "10,000 ok, 3 input, 1 limit".
std::string counts_text(const StatusCounts& counts);

/// What a finished run leaves beside its manifest.
struct BatchSummary {
  Shard shard;
  std::int64_t listed = 0;      ///< meshes in the whole list
  std::uint64_t list_hash = 0;  ///< of their names, in order
  std::string parameters;       ///< the hash of the parameters
  StatusCounts counts;          ///< of rows that were written
  std::int64_t unsure = 0;      ///< of these, results whose sign is not certain
  std::int64_t skipped = 0;     ///< meshes whose rows an earlier run wrote
  double seconds = 0;
};
Json summary_json(const BatchSummary& summary);

/// Makes manifest.jsonl and summary.json of the manifests of all shards in a folder: a mesh's last row, in the order of
/// the list. Takes 32 bytes for each mesh. Errors: input, where a shard or a mesh is missing, or the shards are not of
/// one batch; usage, where there are no shards; output.
BatchSummary merge_shards(const std::filesystem::path& folder);

/// The parts whose manifests lie in a folder, sorted. Errors: input.
std::vector<Shard> parts_in(const std::filesystem::path& folder);

/// Makes an array of the rows `folder`/fields.zarr of a run with these parameters that has come to its end. Nothing is
/// known of rows that were made with others: those are taken away. Takes 57 bytes for each mesh. Errors: input (the
/// manifest), output.
void end_array(const std::filesystem::path& folder, const FieldArrayLayout& layout, std::int64_t listed,
               const std::string& parameters);
/// The array's layout, where a batch with these parameters makes one; nothing where the folder does not hold them.
/// Errors: input.
std::optional<FieldArrayLayout> array_layout_of(const std::filesystem::path& folder, const std::string& parameters);

}  // namespace standoff::cli
