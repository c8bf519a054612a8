// SPDX-License-Identifier: Apache-2.0
#include "cli/batch/manifest.h"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <charconv>
#include <cstring>

#include "cli/text.h"
#include "standoff/error.h"

namespace standoff::cli {
namespace {

namespace fs = std::filesystem;

struct StatusName {
  int code;
  const char* name;
};
constexpr std::array kStatusNames{StatusName{0, "ok"},
                                  StatusName{static_cast<int>(ErrorCode::internal), "internal"},
                                  StatusName{static_cast<int>(ErrorCode::usage), "usage"},
                                  StatusName{static_cast<int>(ErrorCode::input), "input"},
                                  StatusName{static_cast<int>(ErrorCode::output), "output"},
                                  StatusName{static_cast<int>(ErrorCode::limit), "limit"},
                                  StatusName{static_cast<int>(ErrorCode::device), "device"},
                                  StatusName{static_cast<int>(ErrorCode::verify), "verify"},
                                  StatusName{static_cast<int>(ErrorCode::doubt), "doubt"},
                                  StatusName{static_cast<int>(ErrorCode::interrupted), "interrupted"}};

[[noreturn]] void fail_row(const fs::path& manifest, std::uint64_t line, const std::string& what) {
  throw Error(ErrorCode::input,
              manifest.string() + ":line " + std::to_string(line) + ": " + what +
                  "; somebody else has written to it: take that line out, or begin anew with -f",
              {.file = manifest.string(), .line = static_cast<std::int64_t>(line)});
}

}  // namespace

const char* status_name(int code) {
  for (const StatusName& status : kStatusNames)
    if (status.code == code) return status.name;
  return "internal";
}

fs::path manifest_path(const fs::path& folder, const Shard& shard) {
  return folder / ("manifest" + shard.suffix() + ".jsonl");
}
fs::path summary_path(const fs::path& folder, const Shard& shard) {
  return folder / ("summary" + shard.suffix() + ".json");
}

void wait_for_disk([[maybe_unused]] const fs::path& folder) {
#ifdef __linux__
  if (const Descriptor opened = open_to_read(folder); opened.number() >= 0) ::syncfs(opened.number());
#endif
}

std::string row_text(const Json& row) { return row.dump(-1, ' ', false, Json::error_handler_t::replace) + "\n"; }

bool is_unsure(const Json& row) {
  return row.at("code") == 0 && row.contains("sign") && row.at("sign").at("sure") == false;
}

std::optional<std::uint64_t> parse_hash(const std::string& text) {
  std::uint64_t hash = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), hash, 16);
  if (text.size() != 16 || error != std::errc() || end != text.data() + text.size()) return std::nullopt;
  return hash;
}

std::uint64_t each_row(const fs::path& manifest, const std::function<void(const Json&, const ManifestLine&)>& use) {
  InputStream input(manifest.string());
  std::string text;
  std::array<char, 1 << 16> buffer;
  ManifestLine line;
  for (;;) {
    const std::size_t count = input.read(buffer.data(), buffer.size());
    if (count == 0) return line.offset;
    text.append(buffer.data(), count);
    std::size_t at = 0;
    for (std::size_t end; (end = text.find('\n', at)) != std::string::npos; at = end + 1) {
      line.text = std::string_view(text).substr(at, end - at);
      ++line.number;
      const Json row = Json::parse(line.text, nullptr, false);
      if (!row.is_object()) fail_row(manifest, line.number, "this is no row of a manifest");
      try {
        use(row, line);
      } catch (const Json::exception&) {
        fail_row(manifest, line.number, "this row lacks a key, or has one of another type");
      }
      line.offset += end - at + 1;
    }
    text.erase(0, at);
  }
}

ManifestWriter::ManifestWriter(const fs::path& path, Start start) : path_(path) {
  file_ = Descriptor(::open(path.c_str(), O_RDWR | O_CREAT | O_APPEND | O_CLOEXEC, 0666));
  if (file_.number() < 0) fail(errno);
  if (::flock(file_.number(), LOCK_EX | LOCK_NB) != 0 && errno == EWOULDBLOCK)
    throw Error(ErrorCode::output,
                path.string() +
                    ": another standoff batch is writing it; wait for that one, or give "
                    "each of them a part with --shard",
                {.file = path.string()});
  if (start == Start::go_on) size_ = each_row(path, [](const Json&, const ManifestLine&) {});
  if (::ftruncate(file_.number(), static_cast<off_t>(size_)) != 0) fail(errno);
}

void ManifestWriter::append(const std::string& row) {
  std::size_t done = 0;
  while (done < row.size()) {
    const auto count = ::write(file_.number(), row.data() + done, row.size() - done);
    if (count < 0 && errno == EINTR) continue;
    if (count <= 0) {
      const int error = count < 0 ? errno : EIO;
      (void)!::ftruncate(file_.number(), static_cast<off_t>(size_));
      fail(error);
    }
    done += static_cast<std::size_t>(count);
  }
  size_ += row.size();
}

void ManifestWriter::fail(int error) const {
  throw Error(ErrorCode::output,
              path_.string() + ": cannot write it: " + std::strerror(error) +
                  "; rows up to here are kept: make room or see to its permissions, and go on with --resume",
              {.file = path_.string()});
}

EarlierRows::EarlierRows(const fs::path& manifest, const std::string& parameters, bool by_place) : by_place_(by_place) {
  std::error_code ignored;
  if (!fs::exists(manifest, ignored)) return;
  manifest_ = manifest;
  each_row(manifest, [&](const Json& row, const ManifestLine& line) {
    const std::uint64_t id = parse_hash(row.at("id").get<std::string>()).value_or(0);
    const auto index = row.at("index").get<std::int64_t>();
    Row& earlier = rows_[by_place ? static_cast<std::uint64_t>(index) : id];
    earlier.id = id;
    earlier.index = index;
    earlier.offset = line.offset;
    earlier.length = static_cast<std::uint32_t>(line.text.size());
    const Json& hash = row.at("file_hash");
    earlier.file_hash = hash.is_string() ? parse_hash(hash.get<std::string>()).value_or(0) : 0;
    earlier.code = row.at("code").get<std::int16_t>();
    const Json& output = row.at("output");
    earlier.bytes = output.is_object() ? output.at("bytes").get<std::int64_t>() : 0;
    earlier.result = output.is_object() ? parse_hash(output.value("hash", "")).value_or(0) : 0;
    if (!by_place) last_at_[index] = {id, earlier.code};
    earlier.same_parameters = row.at("parameters").get<std::string>() == parameters;
  });
}

const EarlierRows::Row* EarlierRows::find(const MeshId& mesh) const {
  const auto found = rows_.find(by_place_ ? static_cast<std::uint64_t>(mesh.index) : mesh.hash);
  return found == rows_.end() || found->second.id != mesh.hash ? nullptr : &found->second;
}

std::optional<std::string> EarlierRows::moved_row(const MeshId& mesh) const {
  const Row* const row = find(mesh);
  if (!row || by_place_) return std::nullopt;
  const auto last = last_at_.find(mesh.index);  // of this mesh, also if a list names it several times
  if (last != last_at_.end() && last->second.id == row->id && last->second.code == row->code) return std::nullopt;
  const FileView manifest(manifest_, FileView::Access::map);
  Json json = Json::parse(manifest.text(row->offset, row->length));
  json["index"] = mesh.index;
  return row_text(json);
}

bool EarlierRows::has_others() const {
  return std::ranges::any_of(rows_,
                             [](const auto& row) { return row.second.code == 0 && !row.second.same_parameters; });
}

Json counts_json(const StatusCounts& counts) {
  Json json = Json::object();
  for (const auto& [code, count] : counts) json[status_name(code)] = count;
  return json;
}

std::string counts_text(const StatusCounts& counts) {
  std::string text;
  for (const auto& [code, count] : counts)
    text += (text.empty() ? "" : ", ") + grouped(count) + " " + status_name(code);
  return text.empty() ? "none" : text;
}

Json summary_json(const BatchSummary& summary) {
  Json json = json_answer("batch");
  std::int64_t rows = 0;
  for (const auto& [code, count] : summary.counts) rows += count;
  json["shard"] = {{"part", summary.shard.part}, {"of", summary.shard.of}};
  json["listed"] = summary.listed;
  json["list_hash"] = hash_text(summary.list_hash);
  json["parameters"] = summary.parameters;
  json["rows"] = rows;
  json["counts"] = counts_json(summary.counts);
  json["unsure"] = summary.unsure;
  json["skipped"] = summary.skipped;
  json["seconds"] = summary.seconds;
  return json;
}

}  // namespace standoff::cli
