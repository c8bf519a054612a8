// SPDX-License-Identifier: Apache-2.0
#include "cli/batch/sink.h"

#include <unistd.h>

#include <algorithm>
#include <string_view>
#include <system_error>
#include <vector>

#include "batch/content_hash.h"
#include "cli/files.h"
#include "cli/json.h"
#include "cli/text.h"
#include "files/atomic_folder.h"
#include "standoff/error.h"
#include "standoff/io.h"

namespace standoff::cli {
namespace {

namespace fs = std::filesystem;

// File systems take 255 bytes in a part; the hash, the extension and what an unfinished file is called need some.
constexpr std::size_t kLongestPart = 160;

// At most so many bytes, and no character of UTF-8 cut in two.
std::string cut(std::string_view part) {
  std::size_t length = std::min(part.size(), kLongestPart);
  while (length > 0 && length < part.size() && (part[length] & '\xC0') == '\x80') --length;
  return std::string(part.substr(0, length));
}

std::string plain_part(std::string_view part) {
  if (part == "..") return "__";
  // The row names the file, and JSON holds UTF-8 alone: other bytes are replaced.
  std::string plain = Json::parse(Json(cut(part)).dump(-1, ' ', false, Json::error_handler_t::replace));
  for (char& c : plain)
    if (static_cast<unsigned char>(c) < ' ' || c == 0x7f) c = '_';
  return plain;
}

// "bolt" of bolt.stl and bolt.stl.gz.
std::string_view stem_of(std::string_view part) {
  for (const std::string_view end : {".gz", ""}) {
    if (!end.empty() && !part.ends_with(end)) continue;
    part.remove_suffix(end.size());
    if (const auto dot = part.rfind('.'); end.empty() && dot != std::string_view::npos && dot > 0)
      return part.substr(0, dot);
  }
  return part;
}

std::string output_name(const MeshId& mesh, const std::string& extension) {
  std::string folders;
  std::string_view left = mesh.name;
  for (std::size_t slash; (slash = left.find('/')) != std::string_view::npos; left.remove_prefix(slash + 1)) {
    const std::string_view part = left.substr(0, slash);
    if (!part.empty() && part != ".") folders += plain_part(part) + "/";
  }
  return folders + plain_part(stem_of(left)) + "-" + hash_text(mesh.hash) + "." + extension;
}

std::uint64_t folded(std::uint64_t hash, std::uint64_t more) { return content_hash(hash_text(hash) + hash_text(more)); }

// Adds the files of a folder and of those below. Errors: output.
void add_files(const fs::path& folder, std::vector<fs::path>& files) {
  const bool readable = all_entries(folder, [&](const char* name, bool is_folder) {
    std::error_code ignored;
    if (is_folder)
      add_files(folder / name, files);
    else if (fs::is_regular_file(folder / name, ignored))
      files.push_back(folder / name);
    return true;
  });
  if (!readable) throw Error(ErrorCode::output, folder.string() + ": cannot read the folder; see to its permissions");
}

// Of a file's bytes, or of all files of a folder and their names: Zarr stores are folders. Errors: output.
std::uint64_t hash_of_result(const fs::path& path) {
  std::error_code error;
  if (!fs::is_directory(path, error)) return file_hash(path);
  std::vector<fs::path> files;
  add_files(path, files);
  std::ranges::sort(files);
  std::uint64_t hash = 0;
  for (const fs::path& file : files)
    hash =
        folded(folded(hash, content_hash(std::string_view(file.lexically_relative(path).native()))), file_hash(file));
  return hash;
}

class FileSink : public ResultSink {
 public:
  FileSink(const fs::path& folder, const std::string& part, const std::string& extension, bool compress)
      : folder_(folder), part_(part), extension_(extension), compress_(compress) {}

  bool holds(const MeshId& mesh, std::int64_t bytes, std::uint64_t hash) const override {
    const fs::path path = folder_ / name_of(mesh);
    return bytes > 0 && written_bytes(path) == bytes && hash_of_result(path) == hash;
  }

  fs::path file_of(const MeshId& mesh) const override {
    fs::path path = folder_ / name_of(mesh);
    std::error_code error;
    fs::create_directories(path.parent_path(), error);
    if (error)
      throw Error(ErrorCode::output,
                  path.parent_path().string() + ": cannot make the folder: " + error.message() +
                      "; make room or see to its permissions",
                  {.file = path.string()});
    return path;
  }

  Placed placed(const MeshId& mesh) const override {
    const fs::path path = folder_ / name_of(mesh);
    return {.file = name_of(mesh), .bytes = written_bytes(path), .hash = hash_of_result(path)};
  }

  Placed put(const MeshId& mesh, const DistanceField& field, int threads) override {
    clear(mesh);
    write_field(file_of(mesh), field, {.compress = compress_, .threads = threads, .sync = false});
    return placed(mesh);
  }

  Placed put(const MeshId& mesh, const TrainingPoints& points, const MeshQuery& query) override {
    clear(mesh);
    write_training_points(file_of(mesh), points, query, Existing::replace, false);
    return placed(mesh);
  }

  // Not a folder, such as a store, and no file that its owner has made read-only: writing says what is wrong with it.
  void clear(const MeshId& mesh) override {
    const fs::path path = folder_ / name_of(mesh);
    if (::access(path.c_str(), W_OK) == 0) ::unlink(path.c_str());
  }
  void forget(const MeshId&) override {}  // the row says that it has none

 private:
  std::string name_of(const MeshId& mesh) const { return part_ + "/" + output_name(mesh, extension_); }

  fs::path folder_;
  std::string part_, extension_;
  bool compress_;
};

class ArraySink : public ResultSink {
 public:
  ArraySink(const fs::path& folder, const FieldArrayLayout& layout) : array_(folder / kArrayName, layout) {}

  bool holds(const MeshId& mesh, std::int64_t bytes, std::uint64_t hash) const override {
    const Placed found = placed(mesh);
    return bytes > 0 && found.bytes == bytes && found.hash == hash;
  }
  fs::path file_of(const MeshId& mesh) const override {
    const std::vector<fs::path> files = array_.files_of(mesh.index);
    return files.size() == 1 ? files[0] : fs::path();
  }
  Placed placed(const MeshId& mesh) const override {
    Placed found{.file = kArrayName, .row = mesh.index};
    const std::vector<fs::path> files = array_.files_of(mesh.index);
    for (const fs::path& file : files) {
      const std::int64_t bytes = written_bytes(file);
      if (bytes == 0) return {.file = kArrayName, .row = mesh.index};  // all of them, or none
      found.bytes += bytes;
      found.hash = files.size() == 1 ? file_hash(file) : folded(found.hash, file_hash(file));
    }
    return found;
  }
  Placed put(const MeshId& mesh, const DistanceField& field, int) override {
    array_.put(mesh.index, field);
    return placed(mesh);
  }
  Placed put(const MeshId&, const TrainingPoints&, const MeshQuery&) override {
    throw Error(ErrorCode::internal, "points are no rows of an array");
  }
  void clear(const MeshId& mesh) override { array_.remove(mesh.index); }
  void forget(const MeshId& mesh) override { clear(mesh); }

 private:
  FieldArray array_;
};

}  // namespace

MeshId MeshId::of(std::int64_t index, const std::string& name) {
  return {index, name, content_hash(std::string_view(name))};
}

std::unique_ptr<ResultSink> file_sink(const fs::path& folder, const std::string& part, const std::string& extension,
                                      bool compress) {
  return std::make_unique<FileSink>(folder, part, extension, compress);
}

std::unique_ptr<ResultSink> array_sink(const fs::path& folder, const FieldArrayLayout& layout) {
  return std::make_unique<ArraySink>(folder, layout);
}

}  // namespace standoff::cli
