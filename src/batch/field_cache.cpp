// SPDX-License-Identifier: Apache-2.0
#include "standoff/field_cache.h"

#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <string_view>
#include <system_error>
#include <utility>

#include "batch/content_hash.h"
#include "core/guarded.h"
#include "core/number_text.h"
#include "files/atomic_file.h"
#include "files/file_view.h"
#include "files/json_view.h"
#include "standoff/error.h"
#include "standoff/io.h"
#include "standoff/version.h"

namespace standoff {
namespace {

namespace fs = std::filesystem;

// Writes an object of JSON, member by member.
class ObjectText {
 public:
  void add(const char* name, const std::string& text) { member(name) += quoted(text); }
  void add(const char* name, std::int64_t number) { member(name) += std::to_string(number); }
  void add(const char* name, bool value) { member(name) += value ? "true" : "false"; }
  void add_object(const char* name, const ObjectText& object) { member(name) += object.text(); }
  std::string text() const { return "{" + text_ + "}"; }

 private:
  std::string& member(const char* name) {
    return text_ += (text_.empty() ? "\"" : ", \"") + std::string(name) + "\": ";
  }
  static std::string quoted(const std::string& text) {
    std::string json = "\"";
    for (const char c : text) {
      if (static_cast<unsigned char>(c) < ' ') {
        char code[8];
        std::snprintf(code, sizeof code, "\\u%04x", static_cast<unsigned>(c));
        json += code;
      } else {
        if (c == '"' || c == '\\') json += '\\';
        json += c;
      }
    }
    return json + '"';
  }

  std::string text_;
};

// Calls visit(name, member) for what is kept of a report but the sign's method and the mesh's hash.
template <class Report, class Visit>
void each_member(Report& report, const Visit& visit) {
  visit("method", report.method);
  visit("backend", report.backend);
  visit("device", report.device);
  visit("threads", report.threads);
  visit("triangles", report.triangles);
  visit("skipped", report.skipped);
  visit("samples", report.samples);
  visit("samples_examined", report.samples_examined);
  visit("samples_band", report.samples_band);
  visit("tiles", report.tiles);
  visit("tiles_stored", report.tiles_stored);
  visit("why", report.sign.why);
  visit("sure", report.sign.sure);
  visit("flipped", report.sign.flipped);
  visit("left_out", report.sign.left_out);
  visit("boundary_edges", report.sign.boundary_edges);
  visit("internal", report.sign.internal);
  visit("cut", report.sign.cut);
}

ObjectText text_of(const ComputeReport& report) {
  ObjectText text;
  each_member(report, [&]<class Member>(const char* name, const Member& member) {
    if constexpr (std::is_same_v<Member, int>)
      text.add(name, std::int64_t{member});
    else
      text.add(name, member);
  });
  text.add("sign", std::string(find_info(report.sign.method)->name));
  text.add("mesh_hash", hash_text(report.provenance.mesh_hash));
  return text;
}

JsonView need(const JsonView& object, const char* name) {
  const auto found = object.find(name);
  if (!found) object.fail(std::string("it lacks \"") + name + "\"");
  return *found;
}

// Errors: input, where something is missing.
ComputeReport report_of(const JsonView& json) {
  ComputeReport report;
  each_member(report, [&]<class Member>(const char* name, Member& member) {
    const JsonView value = need(json, name);
    if constexpr (std::is_same_v<Member, std::string>)
      member = value.text();
    else if constexpr (std::is_same_v<Member, bool>)
      member = value.boolean();
    else
      member = static_cast<Member>(value.whole());
  });
  const std::string sign = need(json, "sign").text();
  for (const SignMethodInfo& info : kSignMethods)
    if (sign == info.name) report.sign.method = info.method;
  report.provenance.mesh_hash = hash_in(need(json, "mesh_hash").text()).value_or(0);
  return report;
}

fs::path with_extension(fs::path entry, const std::string& extension) { return entry += "." + extension; }

// Gives a file a second name, or makes a copy of it; whoever looks sees the old file there or the new one. Errors:
// output, input.
void link_or_copy(const fs::path& from, const fs::path& to, Existing existing) {
  if (::link(from.c_str(), to.c_str()) == 0) return;
  if (errno == EEXIST && existing == Existing::replace) {
    const fs::path beside = to.parent_path() / unfinished_name();
    const int slot = note_unfinished(beside);
    const bool renamed = ::link(from.c_str(), beside.c_str()) == 0 && ::rename(beside.c_str(), to.c_str()) == 0;
    ::unlink(beside.c_str());  // it is still there where both names were of one file
    forget_unfinished(slot);
    if (renamed) return;
  }
  const FileView bytes(from, FileView::Access::map);
  AtomicFile copy(to, existing);
  copy.write(bytes.bytes().data(), bytes.size());
  copy.commit();
}

std::string three(const Vec3& v) { return exact_text(v.x) + " " + exact_text(v.y) + " " + exact_text(v.z); }
std::string three(const Size3& v) {
  return std::to_string(v.x) + " " + std::to_string(v.y) + " " + std::to_string(v.z);
}

const char* rule_name(WindingRule rule) {
  return rule == WindingRule::positive ? "positive" : rule == WindingRule::nonzero ? "nonzero" : "odd";
}

// Why, of the exception that is being handled; all but an interrupt, which is thrown on.
std::string not_kept() {
  try {
    throw_as_error("cache");
  } catch (const Error& error) {
    if (error.code() == ErrorCode::interrupted) throw;
    return std::string("the field is not kept in the cache: ") + error.what();
  }
}

}  // namespace

FieldCache::FieldCache(const fs::path& folder) try : folder_(folder) {
  std::error_code error;
  fs::create_directories(folder_, error);
  if (error || !fs::is_directory(folder_, error))
    throw Error(ErrorCode::output, folder_.string() + ": cannot make the folder of the cache: " +
                                       (error ? error.message() : "a file is in the way") + "; give another one");
} catch (...) {
  throw_as_error("cache");
}

FieldCache::Key FieldCache::key(MeshView mesh, const Grid& grid, double thickness, const ComputeOptions& options,
                                const File& file) try {
  const auto refuse = [](const char* what) { throw Error(ErrorCode::usage, std::string("cache: ") + what); };
  if (options.nearest) refuse("it keeps distances alone; leave it out, or the nearest triangles");
  if (!options.decision.empty()) refuse("it keeps what is decided here; leave it out, or the sign decision");
  const SignOptions& sign = options.sign;
  std::string text = std::string("standoff ") + version();
  text += "; mesh " + hash_text(content_hash(mesh)) + " of " + std::to_string(mesh.triangles.size()) + " triangles, " +
          std::to_string(mesh.vertices.size()) + " vertices";
  text += "; size " + three(grid.size) + ", origin " + three(grid.origin) + ", first " + three(grid.first) +
          ", spacing " + three(grid.spacing);
  text += "; thickness " + exact_text(thickness);
  text += std::string("; sign ") + find_info(sign.method)->name + " " + rule_name(sign.rule);
  for (const auto& [given, name] : {std::pair{sign.invert, " invert"},
                                    {sign.strict, " strict"},
                                    {sign.as_oriented, " as-oriented"},
                                    {sign.outer, " outer"}})
    if (given) text += name;
  if (sign.method == SignMethod::shell) text += " shell " + exact_text(sign.shell);
  text += std::string("; method ") + find_info(options.method)->name + ", skip " +
          std::to_string(static_cast<int>(options.skip.kind)) + " " + exact_text(options.skip.fraction);
  if (file.window) text += "; window from " + three(file.window->first) + ", size " + three(file.window->size);
  if (options.up) text += "; up " + axis_text(options.up);
  text += "; " + file.extension + (file.compress ? "" : " uncompressed");
  return {text, file.extension};
} catch (...) {
  throw_as_error("cache");
}

// The entry's name without an extension.
fs::path FieldCache::entry_of(const Key& key) const {
  const std::string name = hash_text(content_hash(std::string_view(key.text))).substr(2);  // without its 0x
  return folder_ / name.substr(0, 2) / name;
}

// The report of an entry whose file is as it was.
FieldCache::Fetched FieldCache::look_up(const Key& key) const {
  const fs::path entry = entry_of(key), about = with_extension(entry, "json"),
                 kept = with_extension(entry, key.extension);
  std::error_code ignored;
  if (!fs::exists(about, ignored) || !fs::exists(kept, ignored)) return {};
  const Fetched damaged{{}, "the cache's entry " + entry.string() + " is damaged; the field is computed and kept anew"};
  if (!fs::is_regular_file(about, ignored) || !fs::is_regular_file(kept, ignored)) return damaged;
  try {
    const FileView file(about, FileView::Access::map);
    const JsonView json = JsonView::read(file, file.text(0, file.size()), 8);
    if (need(json, "key").text() != key.text) return {};
    if (need(json, "hash").text() != hash_text(file_hash(kept))) return damaged;
    return {report_of(need(json, "report")), {}};
  } catch (const Error& error) {
    if (error.code() != ErrorCode::input) throw;
    return damaged;
  }
}

FieldCache::Fetched FieldCache::fetch(const Key& key, const fs::path& target, Existing existing) const try {
  Fetched found = look_up(key);
  if (found.report) link_or_copy(with_extension(entry_of(key), key.extension), target, existing);
  return found;
} catch (...) {
  throw_as_error("cache");
}

std::string FieldCache::store(const Key& key, const fs::path& made, const ComputeReport& report) const {
  const fs::path entry = entry_of(key), kept = with_extension(entry, key.extension);
  try {
    std::error_code error;
    fs::create_directories(entry.parent_path(), error);
    if (made != kept) link_or_copy(made, kept, Existing::replace);
    ObjectText about;
    about.add("key", key.text);
    about.add("hash", hash_text(file_hash(kept)));
    about.add_object("report", text_of(report));
    AtomicFile file(with_extension(entry, "json"));
    file.leave_to_system();
    const std::string text = about.text() + "\n";
    file.write(text.data(), text.size());
    file.commit();
    return {};
  } catch (...) {
    return not_kept();
  }
}

FieldCache::Computed FieldCache::compute(MeshView mesh, const Grid& grid, double thickness,
                                         const ComputeOptions& options) const try {
  const Key asked = key(mesh, grid, thickness, options, {});
  const fs::path kept = with_extension(entry_of(asked), asked.extension);
  Fetched found = look_up(asked);
  if (found.report) {
    try {
      Computed made{read_field(kept, {.memory_limit = options.memory_limit}), *std::move(found.report), true, {}};
      made.report.provenance = made.field.provenance();
      if (options.progress) options.progress({"done", 1});
      return made;
    } catch (const Error& error) {  // somebody has removed it since
      if (error.code() != ErrorCode::input) throw;
    }
  }
  ComputeOptions hashed = options;
  hashed.hash_mesh = true;
  ComputeResult result = standoff::compute(mesh, grid, thickness, hashed);
  Computed made{std::move(result.field), std::move(result.report), false, std::move(found.problem)};
  std::string problem;
  try {
    std::error_code ignored;
    fs::create_directories(kept.parent_path(), ignored);
    write_field(kept, made.field, {.threads = options.execution.threads, .sync = false});
    problem = store(asked, kept, made.report);
  } catch (...) {
    problem = not_kept();
  }
  if (!problem.empty()) made.problem = std::move(problem);
  return made;
} catch (...) {
  throw_as_error("cache");
}

}  // namespace standoff
