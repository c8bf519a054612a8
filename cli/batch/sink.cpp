// SPDX-License-Identifier: Apache-2.0
#include "cli/batch/sink.h"

#include <sys/stat.h>

#include <string_view>
#include <system_error>

#include "batch/content_hash.h"
#include "cli/json.h"
#include "cli/text.h"
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

class FileSink : public ResultSink {
 public:
  FileSink(const fs::path& folder, const std::string& part, const std::string& extension, bool compress)
      : folder_(folder), part_(part), extension_(extension), compress_(compress) {}

  bool holds(const MeshId& mesh, std::int64_t bytes) const override {
    struct stat about {};
    return ::stat((folder_ / name_of(mesh)).c_str(), &about) == 0 && S_ISREG(about.st_mode) && about.st_size == bytes;
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
    Placed found{name_of(mesh), 0};
    struct stat about {};
    if (::stat((folder_ / found.file).c_str(), &about) == 0) found.bytes = about.st_size;
    return found;
  }

  Placed put(const MeshId& mesh, const DistanceField& field, int threads) override {
    write_field(file_of(mesh), field, {.compress = compress_, .threads = threads, .sync = false});
    return placed(mesh);
  }

  Placed put(const MeshId& mesh, const TrainingPoints& points, const MeshQuery& query) override {
    write_training_points(file_of(mesh), points, query, Existing::replace, false);
    return placed(mesh);
  }

 private:
  std::string name_of(const MeshId& mesh) const { return part_ + "/" + output_name(mesh, extension_); }

  fs::path folder_;
  std::string part_, extension_;
  bool compress_;
};

}  // namespace

MeshId MeshId::of(std::int64_t index, const std::string& name) {
  return {index, name, content_hash(std::string_view(name))};
}

std::unique_ptr<ResultSink> file_sink(const fs::path& folder, const std::string& part, const std::string& extension,
                                      bool compress) {
  return std::make_unique<FileSink>(folder, part, extension, compress);
}

}  // namespace standoff::cli
