// SPDX-License-Identifier: Apache-2.0
#include "cli/files.h"

#include <unistd.h>

#include <algorithm>
#include <cctype>

#include "cli/console.h"
#include "cli/options.h"
#include "cli/parse.h"
#include "cli/suggest.h"
#include "cli/text.h"
#include "files/atomic_file.h"
#include "files/atomic_folder.h"
#include "scenes/scenes.h"
#include "standoff/error.h"

namespace standoff::cli {
namespace {

namespace fs = std::filesystem;
constexpr std::string_view kScene = "scene:";

std::string extension_of(const fs::path& path) {
  // A folder may be named with a slash at its end.
  std::string extension = (path.has_filename() ? path : path.parent_path()).extension().string();
  if (!extension.empty()) extension.erase(0, 1);
  std::ranges::transform(extension, extension.begin(), [](unsigned char c) { return std::tolower(c); });
  return extension;
}

bool knows(const std::vector<FileFormat>& formats, const std::string& extension, bool writable) {
  return std::ranges::any_of(formats, [&](const FileFormat& format) {
    return format.extension == extension && (writable ? format.writable : format.readable);
  });
}

bool is_folder_format(const fs::path& path) {
  return std::ranges::any_of(field_formats(), [extension = extension_of(path)](const FileFormat& format) {
    return format.folder && format.extension == extension;
  });
}

// A name without its folder and its extensions: "bunny" of "scans/bunny.obj.gz".
std::string stem_of(const fs::path& path) { return (path.extension() == ".gz" ? path.stem() : path).stem().string(); }

// Whether a verb reads files of this name.
bool is_input_name(const fs::path& path) {
  const std::string extension = extension_of(path);
  return extension == "body" || extension == "query" || knows(mesh_formats(), extension, false) ||
         knows(field_formats(), extension, false);
}

// The files that somebody may have meant who named one that is not there: of its folder, those that verbs read, and
// those with its extension. Of several the ones with its extension.
std::vector<std::string> meant_files(const fs::path& missing) {
  constexpr std::size_t kMostFiles = 10'000;  // of a folder; with more nobody wants to wait for a guess
  std::vector<std::string> names, stems;
  all_entries(missing.has_parent_path() ? missing.parent_path() : fs::path("."), [&](const char* name, bool is_folder) {
    const bool same_extension = extension_of(name) == extension_of(missing) && !extension_of(missing).empty();
    if (is_folder ? is_folder_format(name) : is_input_name(name) || same_extension) names.emplace_back(name);
    return names.size() < kMostFiles;
  });
  std::ranges::sort(names);
  for (const std::string& name : names) stems.push_back(stem_of(name));
  std::vector<std::string> near;
  for (const std::size_t index : meant(stem_of(missing), stems)) near.push_back(names[index]);
  const auto differs = [&](const std::string& name) { return extension_of(name) != extension_of(missing); };
  if (!std::ranges::all_of(near, differs)) std::erase_if(near, differs);
  for (std::string& name : near) name = (missing.parent_path() / name).string();
  return near;
}

// Of a scene that there is not.
[[noreturn]] void fail_unknown_scene(const std::string& written) {
  std::vector<std::string> names, near;
  for (const auto& scene : scenes::all()) names.push_back(scene.name);
  for (const std::size_t index : meant(written, names)) near.push_back(std::string(kScene) + names[index]);
  throw Error(ErrorCode::usage, std::string(kScene) + written + ": there is no such scene" + did_you_mean(near) +
                                    (near.empty() ? "; " : " ") + "standoff generate --list shows all " +
                                    std::to_string(names.size()));
}

}  // namespace

FileKind kind_of(const fs::path& path) {
  if (is_store(path)) return FileKind::field;
  if (extension_of(path) == "body") return FileKind::body;
  if (extension_of(path) == "query") return FileKind::query;
  return knows(field_formats(), extension_of(path), false) ? FileKind::field : FileKind::mesh;
}

bool is_store(const fs::path& path) {
  std::error_code ignored;
  return is_folder_format(path) || fs::exists(path / "zarr.json", ignored);
}

void check_input(const std::string& name) {
  if (name.empty()) throw Error(ErrorCode::usage, "'': the name of a file is empty; give a mesh or field");
  if (name == "-")
    throw Error(ErrorCode::input,
                "-: meshes and fields are not read by this name; give a file, or /dev/stdin for a pipe");
  if (name.starts_with(kScene)) {
    const SceneName scene = parse_scene(name);
    if (!std::ranges::any_of(scenes::all(), [&](const auto& known) { return known.name == scene.name; }))
      fail_unknown_scene(scene.name);
    return;
  }
  std::error_code ignored;
  const auto status = fs::status(name, ignored);
  if (fs::is_directory(status) && is_store(name)) return;
  if (fs::is_fifo(status) || (fs::is_regular_file(status) && ::access(name.c_str(), R_OK) == 0)) return;
  if (!fs::exists(status))
    if (const std::vector<std::string> near = meant_files(name); !near.empty())
      throw Error(ErrorCode::input, name + ": no such file" + did_you_mean(near));
  read_text(name);  // says why it cannot be read
}

SceneName parse_scene(const std::string& text) {
  const std::string name = text.starts_with(kScene) ? text.substr(kScene.size()) : text;
  const auto colon = name.find(':');
  if (colon == std::string::npos) return {name};
  return {name.substr(0, colon), parse_count(std::string(kScene) + name.substr(0, colon) + ":TRIANGLES",
                                             name.substr(colon + 1), 1, scenes::kMostTriangles)};
}

void MeshInput::add_to(CLI::App& verb) {
  verb.add_option("MESH", name_, "a mesh file (" + extensions(mesh_formats(), false) + "),\nor scene:NAME[:TRIANGLES]")
      ->required();
}

void MeshInput::add_query_to(CLI::App& verb) {
  verb.add_option("MESH", name_,
                  "a mesh file (" + extensions(mesh_formats(), false) +
                      "),\nscene:NAME[:TRIANGLES], or a query that standoff build made (.query)")
      ->required();
}

void MeshInput::add_any_to(CLI::App& verb, bool bodies) {
  verb.add_option("FILE", name_,
                  "a mesh (" + extensions(mesh_formats(), false) + "),\nscene:NAME[:TRIANGLES], " +
                      (bodies ? "" : "or ") + "a field (" + extensions(field_formats(), false) + ")" +
                      (bodies ? ",\nor a body (.body)" : ""))
      ->required();
}

void MeshInput::add_scale_to(CLI::App& verb) {
  auto* scale = add_parsed(verb, {"--scale", "S", "multiply the mesh's coordinates by S", "Mesh"},
                           [this](S o, S t) { scale_ = parse_positive(o, t); });
  add_parsed(verb, {"--unit", "UNIT", "the mesh is in mm, cm, m, in, ft or km: convert to metres", "Mesh"},
             [this](S o, S t) { unit_ = parse_unit(o, t); })
      ->excludes(scale);
}

std::string MeshInput::stem() const {
  if (name_.starts_with(kScene)) return parse_scene(name_).name;
  return stem_of(name_);
}

MeshReadResult MeshInput::read_with_report() const {
  if (kind_of(name_) == FileKind::body)
    throw Error(ErrorCode::input, name_ +
                                      ": this is a body, for collide, distance, sweep and fly; give the mesh it "
                                      "was built from");
  if (kind_of(name_) == FileKind::query)
    throw Error(ErrorCode::input, name_ + ": this is a query, for points; give the mesh it was built from");
  if (kind_of(name_) == FileKind::field)
    throw Error(ErrorCode::input, name_ + ": this is a field; give the mesh it was computed from");
  const double scale = this->scale();
  if (!name_.starts_with(kScene)) return read_mesh(name_, {scale});
  const SceneName scene = parse_scene(name_);
  MeshReadReport report;
  report.up = Axis::y;
  Mesh mesh = scenes::make(scene.name, scene.triangles);
  if (scale != 1)
    for (Vec3& vertex : mesh.vertices) vertex = vertex * scale;
  return {std::move(mesh), report};
}

MeshWriteOptions MeshInput::write_options(const MeshReadReport& read, Existing existing) const {
  return {.existing = existing, .metres_per_unit = unit_ ? 1 : read.metres_per_unit, .up = read.up};
}

void say_taken_unit(const Console& console, const fs::path& output, const MeshWriteOptions& options) {
  const std::string extension = extension_of(output);
  if (options.metres_per_unit > 0 || (extension != "glb" && extension != "3mf")) return;
  console.say("the unit of the coordinates is unknown: ." + extension + " takes it for " +
              (extension == "glb" ? "metres" : "millimetres") + "; for another: standoff convert --unit");
}

void FileOutput::add_to(CLI::App& verb, const char* placeholder, const std::string& what, const char* name) {
  // Not bound to a path: the stream operator of paths stops at spaces.
  add_parsed(verb, {name, placeholder, what.c_str(), "Output"},
             [this](const std::string& option, const std::string& text) {
               if (text.empty()) throw Error(ErrorCode::usage, option + " '': give the name of a file");
               path_ = text;
               // A new folder, named with a slash at its end.
               if (!path_.has_filename() && is_folder_format(path_)) path_ = path_.parent_path();
             });
  verb.add_flag("-f,--force", force_, "overwrite the output when it exists")->group("Output");
}

void FileOutput::check(const std::vector<FileFormat>& formats) const {
  check_name(formats);
  if (in_the_way()) throw Error(ErrorCode::usage, path_.string() + ": it exists; give -f to overwrite it");
}

bool FileOutput::in_the_way() const {
  std::error_code ignored;
  const auto status = fs::status(path_, ignored);
  return !force_ && (fs::is_regular_file(status) || (fs::is_directory(status) && is_folder_format(path_)));
}

void FileOutput::check_name(const std::vector<FileFormat>& formats) const {
  const auto fail = [this](ErrorCode code, const std::string& what) {
    throw Error(code, path_.string() + ": " + what);
  };
  std::error_code ignored;
  const auto status = fs::status(path_, ignored);
  if (fs::is_directory(status) && !is_folder_format(path_))
    fail(ErrorCode::output, "it is a folder; give the name of a file");
  if (!knows(formats, extension_of(path_), true)) {
    const auto extension = extension_of(path_);
    fail(ErrorCode::usage, (extension.empty() ? "the name has no extension" : "cannot write ." + extension + " here") +
                               "; use " + extensions(formats, true));
  }
  const auto folder = path_.has_parent_path() ? path_.parent_path() : fs::path(".");
  if (!fs::is_directory(folder, ignored))
    fail(ErrorCode::output, "the folder " + folder.string() + " does not exist; create it first");
  if (::access(fs::exists(status) ? path_.c_str() : folder.c_str(), W_OK) != 0)
    fail(ErrorCode::output, "permission denied; choose a file and folder that you may write");
}

std::int64_t written_bytes(const fs::path& path) {
  std::error_code error;
  if (!fs::is_directory(path, error)) {
    const auto bytes = fs::file_size(path, error);
    return error ? 0 : static_cast<std::int64_t>(bytes);
  }
  std::int64_t sum = 0;
  all_entries(path, [&](const char* name, bool is_folder) {
    const bool is_link_to_folder = !is_folder && fs::is_directory(path / name, error);
    if (!is_link_to_folder) sum += written_bytes(path / name);
    return true;
  });
  return sum;
}

FileOutput FileOutput::beside(const fs::path& path) const {
  std::error_code ignored;
  if (path.empty()) throw Error(ErrorCode::usage, "a second output has no name; give the name of a file");
  if (fs::weakly_canonical(fs::absolute(path), ignored) == fs::weakly_canonical(fs::absolute(path_), ignored))
    throw Error(ErrorCode::usage, path.string() + ": both outputs would be this file; give one of them another name");
  FileOutput other = *this;
  other.path_ = path;
  return other;
}

void FileOutput::check_differs(const std::string& input) const {
  std::error_code ignored;
  if (fs::equivalent(path_, input, ignored))
    throw Error(ErrorCode::usage, path_.string() + ": it is an input, and would be lost; give another name");
}

FileFormat FileOutput::format(const std::vector<FileFormat>& formats) const {
  const auto found = std::ranges::find(formats, extension_of(path_), &FileFormat::extension);
  return found == formats.end() ? FileFormat{} : *found;
}

void FileOutput::check_levels(int levels) const {
  if (levels > 1 && !is_folder_format(path_))
    throw Error(ErrorCode::usage, "--levels: " + path_.string() + " is no store; write .zarr, or leave it out");
}

void FileOutput::check_carries(const std::vector<FileFormat>& formats, bool FileFormat::*can, const char* what,
                               const char* leave_out) const {
  if (format(formats).*can) return;
  std::vector<FileFormat> good = formats;
  std::erase_if(good, [can](const FileFormat& one) { return !(one.*can); });
  throw Error(ErrorCode::usage, path_.string() + ": ." + extension_of(path_) + " " + what + "; write " +
                                    extensions(good, true) + ", or leave out " + leave_out);
}

std::string mesh_line(const std::string& name, const Mesh& mesh) {
  return name + ": " + counted(static_cast<std::int64_t>(mesh.triangles.size()), "triangle") + ", " +
         counted(static_cast<std::int64_t>(mesh.vertices.size()), "vertex");
}

std::string extensions(const std::vector<FileFormat>& formats, bool writable) {
  std::vector<std::string> names;
  for (const FileFormat& format : formats)
    if (writable ? format.writable : format.readable) names.push_back("." + format.extension);
  std::string text;
  for (std::size_t n = 0; n < names.size(); ++n)
    text += (n == 0 ? "" : n + 1 == names.size() ? " or " : ", ") + names[n];
  return text;
}

void FieldArgument::add_to(CLI::App& verb, const std::string& what) {
  const std::string help = "most memory for " + what + ", as in 500M or 8G,\nor none (default: 80 % of the machine's)";
  add_parsed(verb, {"--memory-limit", "SIZE", help.c_str(), "Input"},
             [this](const std::string& o, const std::string& t) { memory_limit_ = parse_bytes(o, t); });
  add_parsed(verb,
             {"--level", "N", "of a .zarr store: level N, which has every 2^N-th sample\n(default 0: all)", "Input"},
             [this](S o, S t) { level_ = static_cast<int>(parse_count(o, t, 0, 31)); });
}

FieldReadOptions FieldArgument::options_for(const std::string& name) const {
  if (kind_of(name) != FileKind::field)
    throw Error(ErrorCode::input, name + ": this is no field, as " + extensions(field_formats(), false) +
                                      " are; compute the field of a mesh with standoff compute");
  if (level_ > 0 && !is_store(name))
    throw Error(ErrorCode::usage, "--level: " + name + " is no .zarr store, and has no levels; leave it out");
  return {.memory_limit = memory_limit_};
}

DistanceField FieldArgument::read(const std::string& name, const Console& console) const {
  const FieldReadOptions options = options_for(name);
  return with_spinner(console, "reading " + name,
                      [&] { return level_ > 0 ? open_store(name).read(options) : read_field(name, options); });
}

ZarrStore FieldArgument::open_store(const std::string& name) const {
  const ZarrStore store = ZarrStore::open(name);
  return level_ > 0 ? store.level(level_) : store;
}

FieldSlices FieldArgument::open_slices(const std::string& name) const {
  options_for(name);  // refuses options that it has no use for
  return is_store(name) ? FieldSlices(open_store(name)) : FieldSlices::open(name);
}

FieldArgument::Parts FieldArgument::read_parts(const std::string& name, const Console& console) const {
  if (is_store(name)) return {open_slices(name), {}};
  try {
    return {std::nullopt, read_file(name, console)};
  } catch (const Error& error) {
    if (error.code() != ErrorCode::limit || !FieldSlices::can_open(name)) throw;
    console.detail(std::string(error.what()) + ": slices of it are read at a time");
    return {open_slices(name), {}};
  }
}

DistanceField FieldArgument::read_fitting(const std::string& name, const Console& console) const {
  if (!is_store(name)) return read(name, console);
  const FieldReadOptions options = options_for(name);
  const ZarrStore store = ZarrStore::open(name);
  return with_spinner(console, "reading " + name, [&] {
    for (int level = level_;; ++level) try {
        DistanceField field = store.level(level).read(options);
        if (level > level_)
          console.say(name + ": level " + std::to_string(level) + ", " + size_text(field.grid().size) +
                      " samples; finer ones need more than the memory limit");
        return field;
      } catch (const Error& error) {
        if (error.code() != ErrorCode::limit || level + 1 >= store.levels()) throw;
      }
  });
}

FieldFile FieldArgument::read_file(const std::string& name, const Console& console) const {
  const FieldReadOptions options = options_for(name);
  return with_spinner(console, "reading " + name, [&] {
    return level_ > 0 ? FieldFile{open_store(name).read(options), {}} : read_field_file(name, options);
  });
}

void FieldArgument::check_unused(const std::string& name) const {
  const char* const given = memory_limit_ != 0 ? "--memory-limit" : level_ > 0 ? "--level" : nullptr;
  if (given)
    throw Error(ErrorCode::usage, std::string(given) + ": it is for fields, and " + name + " is none; leave it out");
}

Body read_body(const std::string& name, const Console& console, Axis* up) {
  if (kind_of(name) == FileKind::body) {
    Body body = with_spinner(console, "reading " + name, [&] { return Body::load(name); });
    if (up) *up = up_axis(body.mesh());
    return body;
  }
  MeshInput input;
  input.set_name(name);
  const auto [mesh, read] = with_spinner(console, "reading " + name, [&] { return input.read_with_report(); });
  if (up) *up = read.up;
  try {
    return with_spinner(console, "building the body of " + name, [&mesh = mesh] { return Body(mesh); });
  } catch (const Error& error) {
    throw Error(error.code(), name + ": " + error.what());
  }
}

void PairInput::add_to(CLI::App& verb) {
  verb.add_option("A", a_, "a mesh file, scene:NAME[:TRIANGLES], or a body that standoff build made")->required();
  verb.add_option("B", b_, "the other one")->required();
  add_pose(verb, "--pose-a", "where A is (default: where its file puts it)", pose_a_);
}

void PairInput::check() const {
  for (const std::string& name : {a_, b_}) check_input(name);
}

CLI::Option* add_pose(CLI::App& verb, const char* name, const char* help, Pose& pose) {
  return add_parsed(verb, {name, "POSE", help, "Place"},
                    [&pose](const std::string& o, const std::string& t) { pose = parse_pose(o, t); });
}

void add_body(Json& json, const Body& body) {
  json["mesh"] = {{"triangles", body.mesh().triangles.size()},
                  {"vertices", body.mesh().vertices.size()},
                  {"bounds", json_box(body.bounds())}};
  json["has_inside"] = body.has_inside();
  json["grid"] = json_grid(body.grid());
  json["thickness"] = body.thickness();
  json["memory_bytes"] = body.memory_bytes();
}

}  // namespace standoff::cli
