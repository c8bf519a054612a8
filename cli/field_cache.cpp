// SPDX-License-Identifier: Apache-2.0
#include "cli/field_cache.h"

#include <unistd.h>

#include <cerrno>
#include <system_error>

#include "batch/content_hash.h"
#include "cli/options.h"
#include "cli/text.h"
#include "files/atomic_file.h"
#include "files/file_view.h"
#include "standoff/error.h"
#include "standoff/version.h"

namespace standoff::cli {
namespace {

namespace fs = std::filesystem;

Json report_json(const ComputeReport& report) {
  const SignReport& sign = report.sign;
  return {{"method", report.method},
          {"backend", report.backend},
          {"device", report.device},
          {"threads", report.threads},
          {"triangles", report.triangles},
          {"skipped", report.skipped},
          {"samples", report.samples},
          {"samples_examined", report.samples_examined},
          {"samples_band", report.samples_band},
          {"tiles", report.tiles},
          {"tiles_stored", report.tiles_stored},
          {"sign", static_cast<int>(sign.method)},
          {"why", sign.why},
          {"sure", sign.sure},
          {"flipped", sign.flipped},
          {"left_out", sign.left_out},
          {"boundary_edges", sign.boundary_edges},
          {"internal", sign.internal},
          {"cut", sign.cut},
          {"mesh_hash", report.provenance.mesh_hash}};
}

// Throws Json::exception where something is missing.
ComputeReport report_of(const Json& json) {
  ComputeReport report;
  json.at("method").get_to(report.method);
  json.at("backend").get_to(report.backend);
  json.at("device").get_to(report.device);
  json.at("threads").get_to(report.threads);
  json.at("triangles").get_to(report.triangles);
  json.at("skipped").get_to(report.skipped);
  json.at("samples").get_to(report.samples);
  json.at("samples_examined").get_to(report.samples_examined);
  json.at("samples_band").get_to(report.samples_band);
  json.at("tiles").get_to(report.tiles);
  json.at("tiles_stored").get_to(report.tiles_stored);
  report.sign.method = static_cast<SignMethod>(json.at("sign").get<int>());
  json.at("why").get_to(report.sign.why);
  json.at("sure").get_to(report.sign.sure);
  json.at("flipped").get_to(report.sign.flipped);
  json.at("left_out").get_to(report.sign.left_out);
  json.at("boundary_edges").get_to(report.sign.boundary_edges);
  json.at("internal").get_to(report.sign.internal);
  json.at("cut").get_to(report.sign.cut);
  json.at("mesh_hash").get_to(report.provenance.mesh_hash);
  return report;
}

// The entry's name without an extension.
fs::path entry_of(const fs::path& folder, const Json& key) {
  const std::string name = hash_text(content_hash(std::string_view(key.dump())));
  return folder / name.substr(0, 2) / name;
}

fs::path with_extension(fs::path entry, const std::string& extension) { return entry += "." + extension; }

// Gives a file a second name, or makes a copy of it; whoever looks sees the old file there or the new one. Errors:
// output, input.
void link_or_copy(const fs::path& from, const fs::path& to, Existing existing) {
  if (::link(from.c_str(), to.c_str()) == 0) return;
  if (errno == EEXIST && existing == Existing::replace) {
    const fs::path beside = to.parent_path() / (".standoff-" + std::to_string(::getpid()) + "-" +
                                                to.filename().string().substr(0, 100) + ".part");
    ::unlink(beside.c_str());
    if (::link(from.c_str(), beside.c_str()) == 0) {
      const int slot = note_unfinished(beside);
      const bool renamed = ::rename(beside.c_str(), to.c_str()) == 0;
      ::unlink(beside.c_str());  // it is still there where both names were of one file
      forget_unfinished(slot);
      if (renamed) return;
    }
  }
  const FileView bytes(from, FileView::Access::map);
  AtomicFile copy(to, existing);
  copy.write(bytes.bytes().data(), bytes.size());
  copy.commit();
}

}  // namespace

void FieldCache::add_to(CLI::App& verb, const char* group) {
  add_parsed(verb,
             {"--cache", "FOLDER",
              "take fields that were computed before from this folder, and\nkeep those that are computed", group},
             [this](S o, S t) {
               if (t.empty()) throw Error(ErrorCode::usage, o + " '': give the name of a folder");
               folder_ = t;
             });
}

void FieldCache::open() const {
  std::error_code error;
  fs::create_directories(folder_, error);
  if (error || !fs::is_directory(folder_, error))
    throw Error(ErrorCode::output, folder_.string() + ": cannot make the folder of --cache: " +
                                       (error ? error.message() : "a file is in the way") + "; give another one");
}

Json FieldCache::key(MeshView mesh, const FieldOptions& options, const GridChoice& choice, const Json& file) {
  Json key = options.parameters();
  key["version"] = version();
  key["mesh"] = {{"hash", hash_text(content_hash(mesh))},
                 {"triangles", mesh.triangles.size()},
                 {"vertices", mesh.vertices.size()}};
  key["grid"] = json_grid(choice.grid);  // in place of how it was chosen
  key["thickness"] = json_number(choice.thickness);
  key["file"] = file;
  return key;
}

std::optional<ComputeReport> FieldCache::fetch(const Json& key, const fs::path& target, Existing existing) const {
  const fs::path entry = entry_of(folder_, key);
  const fs::path kept = with_extension(entry, key.at("file").at("format").get<std::string>());
  std::optional<ComputeReport> report;
  try {
    const Json found = Json::parse(read_text(with_extension(entry, "json")));
    if (found.at("key") != key || hash_text(file_hash(kept)) != found.at("hash").get<std::string>())
      return std::nullopt;
    report = report_of(found.at("report"));
  } catch (const Error&) {
    return std::nullopt;
  } catch (const Json::exception&) {
    return std::nullopt;
  }
  link_or_copy(kept, target, existing);
  return report;
}

std::string FieldCache::store(const Json& key, const fs::path& made, const ComputeReport& report) const {
  const fs::path entry = entry_of(folder_, key);
  try {
    std::error_code error;
    fs::create_directories(entry.parent_path(), error);
    link_or_copy(made, with_extension(entry, key.at("file").at("format").get<std::string>()), Existing::replace);
    const Json about{{"key", key}, {"hash", hash_text(file_hash(made))}, {"report", report_json(report)}};
    AtomicFile file(with_extension(entry, "json"));
    file.leave_to_system();
    const std::string text = json_text(about);
    file.write(text.data(), text.size());
    file.commit();
    return {};
  } catch (const Error& error) {
    return std::string("--cache: ") + error.what();
  }
}

}  // namespace standoff::cli
