// SPDX-License-Identifier: Apache-2.0
#include "cli/batch/work.h"

#include <sys/wait.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <csignal>
#include <cstring>
#include <new>
#include <system_error>

#include "batch/content_hash.h"
#include "batch/on_threads.h"
#include "cli/batch/manifest.h"
#include "cli/text.h"
#include "standoff/compute.h"
#include "standoff/error.h"
#include "standoff/memory.h"
#include "standoff/version.h"

namespace standoff::cli {
namespace {

constexpr std::int64_t kAloneTriangles = 1'000'000, kAloneSamples = std::int64_t{1} << 24;
constexpr std::int64_t kLargeFile = std::int64_t{256} << 20;

const char* name_of(Normalization kind) {
  return kind == Normalization::none ? "none" : kind == Normalization::unit_cube ? "unit-cube" : "unit-sphere";
}

// glTF has its numbers in files beside it, so that its own bytes say little: the mesh stands for it.
bool has_companions(const std::string& path) { return path.ends_with(".gltf") || path.ends_with(".gltf.gz"); }

// The hash by which a later run tells whether the file is the same; 0: it cannot be told.
std::uint64_t hash_of_source(const std::string& path) {
  if (path.starts_with("scene:")) return content_hash(std::string_view(path));
  return file_hash(path);
}

// Numbers and texts one after the other; both ends are one program.
class Packed {
 public:
  Packed() = default;
  explicit Packed(const std::string& text) : text_(text) {}
  void put(std::int64_t value) { text_.append(reinterpret_cast<const char*>(&value), sizeof value); }
  void put(const std::string& value) {
    put(static_cast<std::int64_t>(value.size()));
    text_ += value;
  }
  std::int64_t number() {
    std::int64_t value = 0;
    std::memcpy(&value, text_.data() + at_, sizeof value);
    at_ += sizeof value;
    return value;
  }
  std::string text() {
    const auto size = static_cast<std::size_t>(number());
    return text_.substr(std::exchange(at_, at_ + size), size);
  }
  std::string take() { return std::move(text_); }

 private:
  std::string text_;
  std::size_t at_ = 0;
};

std::string how_it_died(int status) {
  if (WIFEXITED(status)) return "its process ended with exit code " + std::to_string(WEXITSTATUS(status));
  const int signal = WTERMSIG(status);
  const char* const name = ::strsignal(signal);
  return "its process was ended by signal " + std::to_string(signal) + (name ? " (" + std::string(name) + ")" : "");
}

void note_result(const Placed& placed, Json& row) {
  if (placed.bytes == 0)
    throw Error(ErrorCode::output, placed.file +
                                       ": it was written, and is not there now; see to it that nobody else "
                                       "works in the folder, and go on with --resume");
  row["output"] = {{"file", placed.file}, {"bytes", placed.bytes}, {"hash", hash_text(placed.hash)}};
  if (placed.row >= 0) row["output"]["row"] = placed.row;
}

void note_field(const ComputeReport& report, const Placed& placed, Json& row) {
  row["mesh"]["hash"] = hash_text(report.provenance.mesh_hash);
  row["samples"] = {{"total", report.samples}, {"band", report.samples_band}};
  add_sign_report(row, report.sign);
  note_result(placed, row);
}

// Errors of a mesh name no file; all that goes into rows and messages shall.
template <class Work>
void naming(const std::string& path, const Work& work) {
  try {
    work();
  } catch (const Error& error) {
    const std::string message = error.what();
    const bool named = error.code() == ErrorCode::output || message.starts_with(path);
    throw Error(error.code(), named ? message : path + ": " + message, error.details());
  }
}

}  // namespace

Json BatchMaking::parameters() const {
  Json json;
  json["version"] = version();
  json["making"] = points ? "points" : "field";
  json["scale"] = mesh.scale();
  json["normalize"] = name_of(normalization);
  json.update(field.parameters());
  json["format"] = extension;
  if (!points) json["compress"] = compress;
  if (array) json["shape"] = json_size(array->shape);
  if (points)
    json["points"] = {
        {"count", points->count}, {"near", points->near_share}, {"sigma", points->sigma}, {"seed", points->seed}};
  return json;
}

std::string BatchOrder::text() const {
  Packed packed;
  packed.put(mesh.index);
  packed.put(mesh.name);
  packed.put(static_cast<std::int64_t>(mesh.hash));
  packed.put(path);
  packed.put(static_cast<std::int64_t>(earlier_hash));
  packed.put(earlier_bytes);
  packed.put(static_cast<std::int64_t>(earlier_result));
  return packed.take();
}

BatchOrder BatchOrder::of(const std::string& text) {
  Packed packed(text);
  BatchOrder order;
  order.mesh.index = packed.number();
  order.mesh.name = packed.text();
  order.mesh.hash = static_cast<std::uint64_t>(packed.number());
  order.path = packed.text();
  order.earlier_hash = static_cast<std::uint64_t>(packed.number());
  order.earlier_bytes = packed.number();
  order.earlier_result = static_cast<std::uint64_t>(packed.number());
  return order;
}

std::string BatchAnswer::text() const {
  Packed packed;
  packed.put(std::int64_t{holds});
  packed.put(std::int64_t{code});
  packed.put(std::int64_t{unsure});
  packed.put(row);
  packed.put(doubt);
  return packed.take();
}

BatchAnswer BatchAnswer::of(const std::string& text) {
  Packed packed(text);
  BatchAnswer answer;
  answer.holds = packed.number() != 0;
  answer.code = static_cast<int>(packed.number());
  answer.unsure = packed.number() != 0;
  answer.row = packed.text();
  answer.doubt = packed.text();
  return answer;
}

Json row_of(const BatchOrder& order, const std::string& parameters) {
  Json row;
  row["index"] = order.mesh.index;
  row["path"] = order.path;
  row["id"] = hash_text(order.mesh.hash);
  row["status"] = "";
  row["code"] = 0;
  row["message"] = "";
  row["file_hash"] = nullptr;
  row["parameters"] = parameters;
  row["output"] = nullptr;
  return row;
}

void set_status(Json& row, int code, const std::string& message) {
  row["code"] = code;
  row["status"] = status_name(code);
  row["message"] = message;
}

BatchAnswer answer_of_lost(const BatchOrder& order, const std::string& parameters, const TaskEnd& end,
                           double timeout_s) {
  Json row = row_of(order, parameters);
  int code = static_cast<int>(ErrorCode::internal);
  std::string message;
  if (end.kind == TaskEnd::Kind::timed_out) {
    code = static_cast<int>(ErrorCode::limit);
    message = "it took longer than --timeout " + number(timeout_s) + "; allow more, or take fewer samples";
  } else if (WIFSIGNALED(end.status) && (WTERMSIG(end.status) == SIGKILL || WTERMSIG(end.status) == SIGTERM)) {
    code = static_cast<int>(ErrorCode::limit);
    message =
        how_it_died(end.status) + ", as the system does when memory runs out; give a --memory-limit, or more memory";
  } else if (WIFEXITED(end.status) && WEXITSTATUS(end.status) != 0) {
    code = WEXITSTATUS(end.status);
    message = how_it_died(end.status) + "; what it said stands among the messages";
  } else {
    message = how_it_died(end.status) + "; this is a bug in standoff, please report it with the mesh";
  }
  set_status(row, code, order.path + ": " + message);
  row["seconds"] = {{"total", end.seconds}};
  return {.holds = false, .code = code, .row = row_text(row)};
}

bool is_large_file(const std::string& path, const BatchMaking& making) {
  std::error_code error;
  const auto bytes = std::filesystem::file_size(path, error);
  // In memory a mesh takes a few times its file, a packed one more.
  const std::int64_t share = making.field.memory_limit() / making.workers / 16;
  return !error && static_cast<std::int64_t>(bytes) > std::min(kLargeFile, share);
}

BatchAnswer MeshWork::make(const BatchOrder& order, const std::function<void()>& wait_to_be_alone) {
  const auto start = std::chrono::steady_clock::now();
  Json row = row_of(order, parameters_);
  seconds_ = Json::object();
  waited_s_ = 0;
  doubt_.clear();
  const auto fail = [&](ErrorCode code, const std::string& message) {
    set_status(row, static_cast<int>(code), message);
    field_ = {};
  };
  set_status(row, 0, "");
  try {
    if (!make_row(order, wait_to_be_alone, row)) return {.holds = true};
  } catch (const Error& error) {
    fail(error.code(), error.what());
  } catch (const std::bad_alloc&) {
    fail(ErrorCode::limit, order.path + ": not enough memory; take fewer samples, or provide more memory");
  } catch (const std::exception& error) {
    fail(ErrorCode::internal,
         order.path + ": internal: " + error.what() + "; this is a bug in standoff, please report it");
  }
  seconds_["total"] = seconds_since(start) - waited_s_;
  row["seconds"] = seconds_;
  if (alone_) field_ = {};  // what a large one took is not held through thousands of small ones
  return {
      .holds = false, .code = row["code"].get<int>(), .unsure = is_unsure(row), .row = row_text(row), .doubt = doubt_};
}

bool MeshWork::still_holds(const BatchOrder& order, std::uint64_t file_hash, Json& row) const {
  if (file_hash != 0) row["file_hash"] = hash_text(file_hash);
  return file_hash != 0 && file_hash == order.earlier_hash &&
         sink_->holds(order.mesh, order.earlier_bytes, order.earlier_result);
}

MeshReadResult MeshWork::read(const BatchOrder& order, Json& row, bool& holds) const {
  MeshInput input = making_.mesh;
  input.set_name(order.path);
  MeshReadResult found = input.read_with_report();
  Mesh& mesh = found.mesh;
  validate(mesh);
  if (has_companions(order.path) && still_holds(order, content_hash(MeshView(mesh)), row)) {
    holds = true;
    return found;
  }
  const Similarity moved = normalization(mesh, making_.normalization);
  if (making_.normalization != Normalization::none) apply(moved, mesh);
  row["mesh"] = {{"vertices", mesh.vertices.size()}, {"triangles", mesh.triangles.size()}};
  row["normalization"] = {
      {"kind", name_of(making_.normalization)}, {"center", json_point(moved.center)}, {"scale", moved.scale}};
  return found;
}

bool MeshWork::make_row(const BatchOrder& order, const std::function<void()>& wait_to_be_alone, Json& row) {
  alone_ = is_large_file(order.path, making_);
  threads_ = alone_ ? making_.workers : 1;
  check_input(order.path);
  if (!has_companions(order.path) && still_holds(order, hash_of_source(order.path), row)) return false;
  const auto start = std::chrono::steady_clock::now();
  MeshReadResult found;
  bool holds = false;
  naming(order.path, [&] { on_threads(threads_, [&] { found = read(order, row, holds); }); });
  if (holds) return false;
  const Mesh& mesh = found.mesh;
  making_.field.compute.up = found.report.up;
  naming(order.path, [&] {
    const GridChoice choice = making_.field.choose_grid(order.path, bounds(mesh));
    doubt_ = making_.field.doubt_of_thickness(bounds(mesh));
    row["grid"] = json_grid(choice.grid);
    row["thickness"] = json_number(choice.thickness);
    seconds_["read"] = seconds_since(start);
    if (fetch_field(order, mesh, choice, row)) return;
    begin(mesh, choice, wait_to_be_alone);
    on_threads(threads_,
               [&] { making_.points ? make_points(order, mesh, choice, row) : make_field(order, mesh, choice, row); });
  });
  return true;
}

// What making takes.
struct MeshWork::Need {
  std::int64_t bytes = 0, samples = 0;
};

MeshWork::Need MeshWork::need_of(const MemoryEstimate& field) const {
  const std::int64_t row = making_.array ? making_.array->chunk().count() : 0;
  return {field.whole + 2 * std::int64_t{sizeof(float)} * row, field.stored_samples};  // a row, and packed
}

// Most meshes are small by their number of triangles alone; only others are gone through.
MeshWork::Need MeshWork::need(const Mesh& mesh, const GridChoice& choice) const {
  const auto triangles = static_cast<std::int64_t>(mesh.triangles.size());
  // The query's hierarchy and prepared triangles, the mesh's copy; a point as it is drawn, asked and stored.
  if (making_.points)
    return {400 * triangles + 16 * making_.points->count + (std::int64_t{16} << 20), making_.points->count};
  const ComputeOptions& options = making_.field.compute;
  const Need most = need_of(estimate(triangles, choice.grid, choice.thickness, options));
  if (!is_large(most, triangles)) return most;
  Need need;
  on_threads(threads_, [&] { need = need_of(estimate(mesh, choice.grid, choice.thickness, options)); });
  return need;
}

bool MeshWork::is_large(const Need& need, std::int64_t triangles) const {
  return triangles > kAloneTriangles || need.samples > kAloneSamples ||
         need.bytes > making_.field.memory_limit() / making_.workers;
}

// Decides how the mesh is worked on, and waits until that may begin. Errors: limit.
void MeshWork::begin(const Mesh& mesh, const GridChoice& choice, const std::function<void()>& wait_to_be_alone) {
  const Need need = this->need(mesh, choice);
  const std::int64_t limit = making_.field.memory_limit();
  if (need.bytes > limit)
    throw Error(ErrorCode::limit,
                std::string("the ") + (making_.points ? "points" : "field") + " and the making may need " +
                    bytes_text(need.bytes) + ", more than the limit of " + bytes_text(limit) +
                    "; take fewer samples, a smaller thickness, or a larger --memory-limit",
                {.bytes_needed = need.bytes, .bytes_limit = limit});
  if (!is_large(need, static_cast<std::int64_t>(mesh.triangles.size())) && !alone_) return;
  if (!alone_) {
    const auto start = std::chrono::steady_clock::now();
    wait_to_be_alone();
    waited_s_ = seconds_since(start);
  }
  alone_ = true;
  threads_ = making_.workers;
}

void MeshWork::make_field(const BatchOrder& order, const Mesh& mesh, const GridChoice& choice, Json& row) {
  ComputeOptions options = making_.field.compute;
  options.execution.threads = threads_;
  options.memory_limit = kNoMemoryLimit;  // it was looked at, and without one the field's memory is used again
  auto start = std::chrono::steady_clock::now();
  const ComputeReport report = compute_into(mesh, choice.grid, choice.thickness, field_, options);
  seconds_["compute"] = seconds_since(start);
  start = std::chrono::steady_clock::now();
  note_field(report, sink_->put(order.mesh, field_, threads_), row);
  if (making_.cache) {
    const std::string problem = making_.cache->store(cache_key_, sink_->file_of(order.mesh), report);
    if (!problem.empty()) Console().warn(problem);
  }
  seconds_["write"] = seconds_since(start);
}

// Whether it was computed before.
bool MeshWork::fetch_field(const BatchOrder& order, const Mesh& mesh, const GridChoice& choice, Json& row) {
  if (!making_.cache) return false;
  const auto start = std::chrono::steady_clock::now();
  cache_key_ = FieldCache::key(mesh, choice.grid, choice.thickness, making_.field.compute,
                               {.extension = making_.extension, .compress = making_.compress});
  sink_->clear(order.mesh);
  const FieldCache::Fetched found = making_.cache->fetch(cache_key_, sink_->file_of(order.mesh), Existing::replace);
  if (!found.problem.empty()) Console().warn(found.problem);
  row["cached"] = found.report.has_value();
  if (!found.report) return false;
  note_field(*found.report, sink_->placed(order.mesh), row);
  seconds_["write"] = seconds_since(start);
  return true;
}

void MeshWork::make_points(const BatchOrder& order, const Mesh& mesh, const GridChoice& choice, Json& row) {
  auto start = std::chrono::steady_clock::now();
  const MeshQuery query(mesh, {making_.field.compute.sign, {.threads = threads_}});
  const TrainingPoints made = training_points(query, choice.grid.bounds(), *making_.points, threads_);
  row["mesh"]["hash"] = hash_text(content_hash(query.mesh()));
  row["points"] = making_.points->count;
  add_sign_report(row, query.sign());
  seconds_["compute"] = seconds_since(start);
  start = std::chrono::steady_clock::now();
  note_result(sink_->put(order.mesh, made, query), row);
  seconds_["write"] = seconds_since(start);
}

}  // namespace standoff::cli
