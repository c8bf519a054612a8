// SPDX-License-Identifier: Apache-2.0
// standoff batch: fields, or points with distances, of many meshes.
#include <algorithm>
#include <chrono>
#include <filesystem>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <thread>
#include <unordered_map>
#include <utility>

#include "batch/content_hash.h"
#include "cli/batch/list.h"
#include "cli/batch/manifest.h"
#include "cli/batch/pool.h"
#include "cli/batch/report.h"
#include "cli/batch/sink.h"
#include "cli/batch/work.h"
#include "cli/console.h"
#include "cli/field_options.h"
#include "cli/files.h"
#include "cli/options.h"
#include "cli/parse.h"
#include "cli/process.h"
#include "cli/text.h"
#include "cli/verb.h"
#include "files/atomic_file.h"
#include "standoff/error.h"
#include "standoff/io.h"

namespace standoff::cli {
namespace {

namespace fs = std::filesystem;

constexpr const char* kBatchExamples =
    R"(  standoff batch meshes/ -o out -r 64 -t 3s             a band for every mesh in a folder and below
  find . -name '*.stl' | standoff batch - -o out -r 64   of a list, here from standard input
  standoff batch list.txt -o out -r 64 --resume          what is not done yet, or has changed
  standoff batch list.txt -o out -r 64 --shard 3/64      one part of 64, on this machine
  standoff batch --merge -o out                          all parts' manifests into one
  standoff batch meshes/ -o out --points 100000 --normalize unit-sphere    training points
  standoff batch --report -o out                         a page about what failed
)";

constexpr const char* kArrayFormat = "array";  // in place of an extension

struct BatchCommand {
  std::string list;
  fs::path folder;
  Shard shard;
  bool zeros = false, resume = false, force = false, merge = false, report = false;
  bool retry_failed = false;
  CacheOption cache;
  double timeout_s = std::numeric_limits<double>::infinity();
  BatchMaking making;
  TrainingPointOptions points;
  bool points_asked = false, point_options_given = false, format_given = false, uncompressed = false;
  Console console;

  void add_to(CLI::App& verb);
  void run();

 private:
  void add_list(CLI::App& verb);
  void add_run(CLI::App& verb);
  void add_result(CLI::App& verb);
  void check();
  void make_folder() const;
  void check_places(bool goes_on_here) const;
  BatchSummary work_through();
  void tell(const BatchSummary& summary, const char* what) const;
};

/// One run over a list: what is asked of the pool, and what becomes of its answers.
class BatchRun {
 public:
  BatchRun(const BatchCommand& command, Listing& listing, ManifestWriter& manifest, const EarlierRows& earlier,
           const std::string& parameters)
      : command_(command), listing_(listing), manifest_(manifest), earlier_(earlier) {
    summary_.shard = command.shard;
    summary_.parameters = parameters;
  }

  /// Works through the list. Errors: interrupted; those of list and manifest.
  BatchSummary run(std::shared_ptr<ResultSink> sink);

 private:
  WorkerPool::Next next(PoolTask& task);
  bool shares_a_file(const BatchOrder& order) const;
  void ended(std::int64_t number, const TaskEnd& end);
  bool is_wanted(BatchOrder& order) const;
  void keep(const MeshId& mesh);

  const BatchCommand& command_;
  Listing& listing_;
  ManifestWriter& manifest_;
  const EarlierRows& earlier_;
  std::shared_ptr<ResultSink> sink_;
  BatchSummary summary_;
  std::unordered_map<std::int64_t, BatchOrder> under_way_;
  std::optional<BatchOrder> waits_;  // for a mesh of the same name that is under way
  std::int64_t failed_ = 0, rows_ = 0;
  bool doubted_ = false;  // of one mesh: others are alike
};

BatchSummary BatchRun::run(std::shared_ptr<ResultSink> sink) {
  const auto start = std::chrono::steady_clock::now();
  sink_ = std::move(sink);
  const auto work = std::make_shared<MeshWork>(command_.making, sink_, summary_.parameters);
  WorkerPool pool(command_.making.workers, command_.timeout_s,
                  [work](const std::string& order, const std::function<void()>& wait_to_be_alone) {
                    return work->make(BatchOrder::of(order), wait_to_be_alone).text();
                  });
  pool.keep_from_workers(manifest_.descriptor());
  const auto bar = command_.console.progress(false);
  std::string shown;
  WorkerPool::Caller caller;
  caller.next = [this](PoolTask& task) { return next(task); };
  caller.ended = [this](std::int64_t number, const TaskEnd& end) { ended(number, end); };
  caller.tick = [&] {
    shown = counted(rows_ + summary_.skipped, "mesh") + (failed_ > 0 ? ", " + grouped(failed_) + " failed" : "");
    bar({shown.c_str(), listing_.fraction()});
  };
  caller.descriptor = listing_.descriptor();
  const Cancellable cancellable;
  const char* const again = command_.force                             ? " with --resume in place of -f"
                            : command_.resume || command_.retry_failed ? ""
                                                                       : " with --resume";
  const auto go_on = [&] {
    next_step_is(counted(rows_, "row") + (rows_ == 1 ? " is" : " are") + " written: the same command" + again +
                 " goes on from here");
  };
  next_step_is(std::string("what is done is kept: the same command") + again + " goes on from here");
  try {
    pool.run(caller);
  } catch (const Error& error) {
    if (error.code() == ErrorCode::interrupted) go_on();
    throw;
  }
  next_step_is("");
  summary_.seconds = seconds_since(start);
  return summary_;
}

WorkerPool::Next BatchRun::next(PoolTask& task) {
  const auto hand_out = [&](BatchOrder order) {
    task = {order.mesh.index, order.text(), is_large_file(order.path, command_.making)};
    under_way_.emplace(order.mesh.index, std::move(order));
    return WorkerPool::Next::task;
  };
  if (waits_) {
    if (shares_a_file(*waits_)) return WorkerPool::Next::later;
    return hand_out(*std::exchange(waits_, std::nullopt));
  }
  std::string name;
  // Meshes that are not wanted cost little, but there may be millions of them: signals and answers come in between.
  for (int looked_at = 0; looked_at < 1000; ++looked_at) {
    switch (listing_.next(name)) {
      case Listing::Next::end:
        return WorkerPool::Next::end;
      case Listing::Next::not_yet:
        return WorkerPool::Next::not_yet;
      case Listing::Next::mesh:
        break;
    }
    BatchOrder order{.mesh = MeshId::of(summary_.listed++, name), .path = listing_.path_of(name)};
    summary_.list_hash = content_hash(hash_text(summary_.list_hash) + hash_text(order.mesh.hash));
    if (!command_.shard.has(order.mesh.index)) continue;
    if (!is_wanted(order)) {
      keep(order.mesh);
      continue;
    }
    if (shares_a_file(order)) {
      waits_ = std::move(order);
      return WorkerPool::Next::later;
    }
    return hand_out(std::move(order));
  }
  return WorkerPool::Next::not_yet;
}

// Whether a mesh of the same name is under way: two workers would replace one file at once, and each find the other's
// gone. Rows of an array are places, which no two meshes have.
bool BatchRun::shares_a_file(const BatchOrder& order) const {
  return !command_.making.array &&
         std::ranges::any_of(under_way_, [&](const auto& other) { return other.second.mesh.hash == order.mesh.hash; });
}

// Notes in the order what an earlier run knows of the mesh.
bool BatchRun::is_wanted(BatchOrder& order) const {
  const EarlierRows::Row* const earlier = earlier_.find(order.mesh);
  // The places of an array depend on the list, which may be another one: what rows say is looked at, as by --resume.
  if (command_.retry_failed && !command_.making.array) return !earlier || earlier->code != 0;
  if (!earlier || earlier->code != 0 || !earlier->same_parameters) return true;
  order.earlier_hash = earlier->file_hash;
  order.earlier_bytes = earlier->bytes;
  order.earlier_result = earlier->result;
  return true;
}

// Leaves a mesh with the row that it has.
void BatchRun::keep(const MeshId& mesh) {
  ++summary_.skipped;
  if (const auto row = earlier_.moved_row(mesh)) manifest_.append(*row);
}

void BatchRun::ended(std::int64_t number, const TaskEnd& end) {
  const auto found = under_way_.find(number);
  const BatchAnswer answer = end.kind == TaskEnd::Kind::answered
                                 ? BatchAnswer::of(end.answer)
                                 : answer_of_lost(found->second, summary_.parameters, end, command_.timeout_s);
  const MeshId mesh = std::move(found->second.mesh);
  under_way_.erase(found);
  if (answer.holds) return keep(mesh);
  if (!answer.doubt.empty() && !std::exchange(doubted_, true)) command_.console.warn(mesh.name + ": " + answer.doubt);
  if (answer.code != 0) sink_->forget(mesh);
  manifest_.append(answer.row);
  ++summary_.counts[answer.code];
  summary_.unsure += answer.unsure;
  ++rows_;
  failed_ += answer.code != 0;
}

void BatchCommand::add_to(CLI::App& verb) {
  add_list(verb);
  add_run(verb);
  add_result(verb);
  making.field.add_grid_to(verb);
  making.mesh.add_scale_to(verb);
  making.field.add_sign_to(verb);
  making.field.add_work_to(verb);
  add_parsed(verb, {"--timeout", "S", "seconds that a mesh may take (default: any)", "Work"},
             [this](S o, S t) { timeout_s = parse_positive(o, t, 1e9); });
  cache.add_to(verb, "Work");
  console.add_to(verb, Console::kMessages | Console::kJson | Console::kProgress);
  making.field.add_thesis_to(verb);
}

void BatchCommand::add_list(CLI::App& verb) {
  verb.add_option("LIST", list,
                  "a file with the path of a mesh on each line, - for standard\ninput, or a folder: all meshes in it "
                  "and below");
  verb.add_flag("-0,--null", zeros, "a zero byte ends each path, as find -print0 writes them")->group("List");
  add_parsed(
      verb,
      {"--shard", "I/N", "only every N-th mesh, from the I-th on (1 to N): for N\nmachines, each with a part", "List"},
      [this](S o, S t) { shard = parse_shard(o, t); });
}

void BatchCommand::add_run(CLI::App& verb) {
  add_parsed(verb, {"-o,--output", "FOLDER", "the folder of the results and of manifest.jsonl", "Output"},
             [this](S o, S t) {
               if (t.empty()) throw Error(ErrorCode::usage, o + " '': give the name of a folder");
               folder = t;
             })
      ->required();
  verb.add_flag("-f,--force", force, "begin anew where there is a manifest")->group("Output");
  verb.add_flag("--resume", resume, "go on: leave out meshes that are done and have not changed")->group("Output");
  add_parsed(verb, {"--retry", "WHAT", "failed: only meshes that are not done", "Output"}, [this](S o, S t) {
    parse_choice(o, t, {"failed"});
    retry_failed = true;
  });
  verb.add_flag("--merge", merge, "make one manifest of those of all shards; takes no LIST")->group("Output");
  verb.add_flag("--report", report,
                "write report.html, with pictures of failed meshes; without\na LIST of earlier runs")
      ->group("Output");
}

void BatchCommand::add_result(CLI::App& verb) {
  std::string formats;
  for (const FileFormat& format : field_formats())
    if (format.writable)
      formats +=
          (formats.empty() ? "" : ", ") + format.extension + (format.extension == making.extension ? " (default)" : "");
  formats = wrapped(formats + ": a file for each mesh; or array: one Zarr array of all fields, a row for each mesh",
                    kHelpColumns);
  add_parsed(verb, {"--format", "NAME", formats.c_str(), "Result"}, [this](S o, S t) {
    std::vector<std::string> names;
    for (const FileFormat& format : field_formats())
      if (format.writable) names.push_back(format.extension);
    names.emplace_back(kArrayFormat);
    making.extension = names[parse_choice(o, t, names)];
    format_given = true;
  });
  verb.add_flag("--uncompressed", uncompressed,
                "write the samples of .vti, .nrrd, .npz, .zarr and of the array\nas they are: larger files that are "
                "read faster")
      ->group("Result");
  add_parsed(
      verb,
      {"--normalize", "KIND",
       "move and scale each mesh first: none (default), unit-cube\n(longest side 1) or unit-sphere (radius 1), "
       "both about the\norigin",
       "Mesh"},
      [this](S o, S t) {
        making.normalization = static_cast<Normalization>(parse_choice(o, t, {"none", "unit-cube", "unit-sphere"}));
      });
  const auto add = [&](const char* name, const char* value, const char* help, auto set) {
    add_parsed(verb, {name, value, help, "Points in place of fields"}, [this, set](S o, S t) {
      point_options_given = true;
      set(o, t);
    });
  };
  add_parsed(verb,
             {"--points", "N", "N points with exact distances, in .npz: training data", "Points in place of fields"},
             [this](S o, S t) {
               points.count = parse_count(o, t, 1, std::int64_t{1} << 31);
               points_asked = true;
             });
  add("--near", "SHARE",
      "of the points that lie near the surface (default 0.8); the\nothers are uniform in the grid's box",
      [this](S o, S t) { points.near_share = parse_share(o, t); });
  add("--sigma", "A,B",
      "deviations of the offsets from the surface, as shares of the\nbox's longest side, by turns (default 0.02,0.005)",
      [this](S o, S t) {
        const std::vector<double> sigma = numbers_in(t);
        if (sigma.size() != 2 || sigma[0] < 0 || sigma[1] < 0)
          throw Error(ErrorCode::usage, o + " '" + t + "': give two numbers, zero or above, as 0.02,0.005");
        points.sigma = {sigma[0], sigma[1]};
      });
  add("--seed", "N", "other points for other numbers (default 0)", [this](S o, S t) {
    points.seed = static_cast<std::uint64_t>(parse_count(o, t, 0, std::numeric_limits<std::int64_t>::max()));
  });
}

void BatchCommand::check() {
  const auto refuse = [](const std::string& what) { throw Error(ErrorCode::usage, what); };
  if (merge && !list.empty()) refuse("--merge and LIST cannot go together; give one of them");
  if (merge && (resume || retry_failed)) refuse("--merge goes through manifests alone; leave --resume and --retry out");
  if (list.empty() && !merge && !report)
    refuse("batch: no LIST given; give a folder of meshes, a list of them, or - for standard input");
  if (force && (resume || retry_failed)) refuse("-f begins anew, and --resume and --retry go on; give one of them");
  if (resume && retry_failed) refuse("--resume and --retry cannot go together; give one of them");
  if (point_options_given && !points_asked) refuse("--near, --sigma and --seed are for points; give --points too");
  if (points_asked && cache.given()) refuse("--cache keeps fields, and --points makes none; leave one out");
  if (points_asked && (format_given || uncompressed))
    refuse("--points are written as .npz; leave --format and --uncompressed out");
  if (points_asked) {
    const SignMethodInfo& sign = *find_info(making.field.compute.sign.method);
    if (!sign.at_points) refuse(std::string("--sign ") + sign.name + " needs a grid; take another for --points");
    making.points = points;
  }
  making.compress = !uncompressed;
  if (making.extension == kArrayFormat) {
    const std::optional<Size3> shape = making.field.known_size();
    if (!shape)
      refuse(
          "--format array: its rows have one shape, and these options give each mesh a grid of its own; give "
          "--size NX,NY,NZ, or --bounds");
    making.array = FieldArrayLayout{*shape, making.compress};
    if (cache.given() && making.array->chunks().count() > 1)
      refuse("--cache keeps files, and a row of more than 256 samples on an axis has several; leave it out");
  }
  if (cache.given() && std::ranges::any_of(field_formats(), [this](const FileFormat& format) {
        return format.folder && format.extension == making.extension;
      }))
    refuse("--cache keeps files, and a result of --format " + making.extension + " is a folder; leave one out");
  const int asked = making.field.compute.execution.threads;
  making.workers = asked > 0 ? asked : static_cast<int>(std::max(1u, std::thread::hardware_concurrency()));
}

void BatchCommand::make_folder() const {
  std::error_code error;
  fs::create_directories(folder, error);
  if (error || !fs::is_directory(folder, error))
    throw Error(ErrorCode::output,
                folder.string() + ": cannot make the folder: " + (error ? error.message() : "a file is in the way") +
                    "; give another one with -o, or see to its permissions");
}

// The rows of an array are places in one list. Runs that share the array without sharing a manifest, whose lock and
// whose merging tell, would write over each other's rows.
// `goes_on_here`: this part's manifest was there before. Beside parts one of the whole is what --merge has made.
void BatchCommand::check_places(bool goes_on_here) const {
  std::error_code ignored;
  const fs::path whole = manifest_path(folder, {});
  std::optional<fs::path> other;
  bool first = !goes_on_here;
  for (const Shard& part : parts_in(folder)) {
    if (part.of != shard.of) other = manifest_path(folder, part);
    if (part.of == shard.of && part.part != shard.part) first = false;
  }
  if (first && shard.of > 1 && fs::exists(whole, ignored)) other = whole;
  if (other)
    throw Error(ErrorCode::usage, other->string() +
                                      ": the rows of the array are counted by a run of other parts; go on "
                                      "with the same --shard, or give another folder");
}

BatchSummary BatchCommand::work_through() {
  const auto listing = open_listing(list, zeros, folder);
  make_folder();
  if (cache.given()) making.cache.emplace(cache.open());
  const fs::path manifest = manifest_path(folder, shard), summary = summary_path(folder, shard);
  std::error_code ignored;
  const bool goes_on = resume || retry_failed;
  if (!goes_on && !force && fs::exists(manifest, ignored))
    throw Error(ErrorCode::usage, manifest.string() + ": it exists; give --resume to go on, or -f to begin anew");
  if (retry_failed && !fs::exists(manifest, ignored))
    throw Error(ErrorCode::usage, manifest.string() + ": there is none, so nothing has failed; leave --retry out");
  const Json asked = making.parameters();
  const std::string text = json_text(asked), hash = hash_text(content_hash(std::string_view(text)));
  const bool was_there = fs::exists(manifest, ignored);
  if (making.array) check_places(was_there);
  ManifestWriter rows(manifest, goes_on ? ManifestWriter::Start::go_on : ManifestWriter::Start::anew);
  try {
    if (making.array) check_places(was_there);  // again: of two that began at once each has its manifest there by now
  } catch (const Error&) {
    if (!was_there) fs::remove(manifest, ignored);
    throw;
  }
  const EarlierRows earlier = goes_on ? EarlierRows(manifest, hash, making.array.has_value()) : EarlierRows();
  if (making.array && retry_failed && earlier.has_others())  // of one array all rows are made in the same way
    throw Error(ErrorCode::usage, manifest.string() +
                                      ": rows of the array were made with other options, or by another version; give "
                                      "--resume in place of --retry to make them anew, or the options of before");
  fs::remove(summary, ignored);  // until this run has come to its end
  if (const fs::path kept = folder / ("parameters-" + hash + ".json");
      !fs::exists(kept, ignored) || read_text(kept) != text)
    write_text(kept, text);
  forget_finished();

  std::shared_ptr<ResultSink> sink =
      making.array ? array_sink(folder, *making.array)
                   : file_sink(folder, making.points ? "points" : "fields", making.extension, making.compress);
  if (making.array) FieldArray(folder / kArrayName, *making.array).begin();
  BatchSummary found = BatchRun(*this, *listing, rows, earlier, hash).run(std::move(sink));
  if (found.listed == 0)
    throw Error(ErrorCode::input, (list == "-" ? "standard input" : list) +
                                      ": there is no mesh in it; give a list with a path on each line, or a folder of "
                                      "meshes (" +
                                      extensions(mesh_formats(), false) + ")");
  if (making.array && shard.of == 1) end_array(folder, *making.array, found.listed, hash);
  wait_for_disk(folder);
  write_text(summary, json_text(summary_json(found)));
  return found;
}

void BatchCommand::tell(const BatchSummary& summary, const char* what) const {
  std::int64_t rows = 0;
  for (const auto& [code, count] : summary.counts) rows += count;
  const std::string manifest = manifest_path(folder, shard).string();
  std::string line = manifest + ": " + what + counted(rows, "mesh") + ": " + counts_text(summary.counts);
  if (summary.skipped > 0) line += "; " + grouped(summary.skipped) + " were done before";
  if (summary.seconds > 0)
    line += "; in " + seconds_text(summary.seconds) + ", " + number(static_cast<double>(rows) / summary.seconds) +
            " a second";
  console.say(line);
  if (summary.unsure > 0)
    console.warn("the sign of " + counted(summary.unsure, "mesh") + " is not certain: sign.sure is false in " +
                 manifest + ", and sign.why says more");
}

void BatchCommand::run() {
  check();
  BatchSummary summary;
  if (merge) {
    summary = merge_shards(folder);
    tell(summary, "merged, ");
  } else if (!list.empty()) {
    summary = work_through();
    tell(summary, "");
  }
  if (report) {
    const ReportedCounts reported = write_batch_report(folder, {.workers = making.workers}, console);
    console.say((folder / "report.html").string() + ": " + counts_text(reported.by_status));
    if (list.empty() && !merge) {
      summary.counts = reported.by_status;
      summary.unsure = reported.unsure;
    }
  }
  if (console.json()) print(summary_json(summary));
  std::int64_t failed = 0;
  for (const auto& [code, count] : summary.counts) failed += code == 0 ? 0 : count;
  if (failed > 0 && (merge || !list.empty()))
    throw Error(ErrorCode::input, counted(failed, "mesh") + " failed; " + manifest_path(folder, shard).string() +
                                      " says why, and standoff batch --report shows them");
}

}  // namespace

void add_batch(CLI::App& program) {
  add_command<BatchCommand>(program, "batch", "fields of many meshes, or points with distances", kBatchExamples);
}

}  // namespace standoff::cli
