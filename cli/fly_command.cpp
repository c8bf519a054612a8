// SPDX-License-Identifier: Apache-2.0
// standoff fly: the fly in the labyrinth, as in the thesis and without its accidents.
#include <algorithm>
#include <chrono>
#include <filesystem>
#include <memory>
#include <mutex>
#include <numbers>
#include <span>
#include <string>
#include <vector>

#include "cli/console.h"
#include "cli/files.h"
#include "cli/options.h"
#include "cli/parse.h"
#include "cli/process.h"
#include "cli/serve.h"
#include "cli/text.h"
#include "cli/verb.h"
#include "files/atomic_file.h"
#include "fly/film.h"
#include "fly/flight_page.h"
#include "fly/world.h"
#include "standoff/error.h"
#include "standoff/picture.h"

namespace standoff::cli {
namespace {

namespace fs = std::filesystem;

using fly::FlightMode;
using fly::FlightOptions;
using fly::OnContact;
using fly::PathPoint;
using fly::World;

constexpr const char* kWatchGroup = "Watching";

constexpr const char* kFlyExamples =
    R"(  standoff fly --steps 100000 --speed 0.04 --path out.csv      one fly, where it flew as a table
  standoff fly --mode thesis --minimum 3 --speed 5             Algorithm 2: watch the wall crossings
  standoff fly --mode thesis --recompute --device cuda         a new field at every step, on a GPU
  standoff fly --flies 1000 --steps 1000 --json                many at once
  standoff fly --speed 0.2 --steps 600 -o fly.html             a page that plays the flight; -o fly.mp4: a video
)";

/// What a flight is recorded into: a page, pictures in a folder, or a video.
class FlightOutput {
 public:
  /// Adds -o, --every, --rate and the options of pictures; returns -o.
  CLI::Option* add_to(CLI::App& verb);

  bool given() const { return !name_.empty(); }
  const std::filesystem::path& path() const { return file_.path(); }
  std::int64_t every() const { return every_; }
  /// Tells before anything is flown what would go wrong after it. `like` has the same --force. Errors: usage, output.
  void check(const FileOutput& like, const std::vector<std::string>& inputs);
  /// Draws and writes. Errors: as write_frames and write_video; output.
  void write(const fly::FlightSubject& subject, std::span<const fly::FlightFrame> frames, int threads,
             const ProgressCallback& progress) const;
  /// Of all that was written.
  std::int64_t bytes() const;

 private:
  enum class Kind { page, folder, video };

  std::string name_;
  Kind kind_ = Kind::page;
  FileOutput file_;
  std::int64_t every_ = 1;
  double frames_per_second_ = 60;
  PictureOptions picture_{.width = 1280, .height = 720, .elevation_deg = 40};
  std::vector<const CLI::Option*> of_films_, of_pictures_;
};

CLI::Option* FlightOutput::add_to(CLI::App& verb) {
  CLI::Option* const output = add_parsed(
      verb,
      {"-o,--output", "FILM", "record it: a page (.html), a video (.mp4, by ffmpeg), or a\nfolder of pictures (NAME/)",
       kWatchGroup},
      [this](S o, S t) {
        if (t.empty()) throw Error(ErrorCode::usage, o + " '': give the name of a file or folder");
        name_ = t;
      });
  of_films_.push_back(add_parsed(verb, {"--every", "K", "of -o: record each K-th step (default 1)", kWatchGroup},
                                 [this](S o, S t) { every_ = parse_count(o, t, 1, 1'000'000'000); }));
  of_films_.push_back(add_parsed(verb, {"--rate", "F", "of -o: frames a second (default 60)", kWatchGroup},
                                 [this](S o, S t) { frames_per_second_ = parse_positive(o, t, 1000); }));
  of_pictures_ = add_picture_options(verb, picture_);
  return output;
}

void FlightOutput::check(const FileOutput& like, const std::vector<std::string>& inputs) {
  file_ = like;
  file_.set_path(name_);
  const auto refuse = [](const std::vector<const CLI::Option*>& options, const char* what) {
    for (const CLI::Option* option : options)
      if (option->count() > 0) throw Error(ErrorCode::usage, option->get_name() + what);
  };
  if (!given()) {
    refuse(of_films_, ": there is no film; give -o, or leave it out");
    refuse(of_pictures_, ": there are no pictures; give -o NAME/ or -o NAME.mp4, or leave it out");
    return;
  }
  std::error_code ignored;
  const fs::path& path = file_.path();
  if (!path.has_filename() || fs::is_directory(path, ignored)) {
    kind_ = Kind::folder;
    return fly::check_frames(path, file_.existing());
  }
  kind_ = path.extension() == ".mp4" ? Kind::video : Kind::page;
  file_.check({{"html", "a page", false, true}, {"mp4", "a video", false, true}});
  for (const std::string& input : inputs) file_.check_differs(input);
  if (kind_ == Kind::video) return fly::check_video(path, picture_);
  refuse(of_pictures_, ": a page has no pictures; give -o NAME/ or -o NAME.mp4, or leave it out");
}

void FlightOutput::write(const fly::FlightSubject& subject, std::span<const fly::FlightFrame> frames, int threads,
                         const ProgressCallback& progress) const {
  if (kind_ == Kind::page)
    return write_text(path(),
                      fly::flight_page(subject, frames, frames_per_second_, "standoff fly: " + subject.walls_name),
                      file_.existing());
  fly::Film film{subject, frames, frames_per_second_, picture_};
  film.picture.threads = threads;
  if (!film.picture.up) film.picture.up = subject.up;
  const auto write = kind_ == Kind::folder ? fly::write_frames : fly::write_video;
  write(path(), film, file_.existing(), progress);
}

std::int64_t FlightOutput::bytes() const {
  std::error_code ignored;
  if (kind_ != Kind::folder) return static_cast<std::int64_t>(fs::file_size(path(), ignored));
  std::int64_t sum = 0;
  for (const auto& entry : fs::directory_iterator(path(), ignored))
    if (entry.is_regular_file(ignored)) sum += static_cast<std::int64_t>(entry.file_size(ignored));
  return sum;
}

struct FlyCommand {
  std::string labyrinth = "scene:labyrinth", fly = "scene:fly";
  std::int64_t steps = 10'000, flies = 1;
  FlightOptions options;
  FileOutput path;
  FlightOutput film;
  bool view = false;
  ServeOptions server;
  Console console;

  const CLI::Option* force = nullptr;
  std::vector<const CLI::Option*> of_thesis, of_sweep;  // options that the other mode does not know

  void check_mode() const;
  void check_outputs();
  void run();
  void watch(const fly::FlightSubject& subject);
  void record(const fly::FlightSubject& subject);
  Json json_flight(const World& world) const;
};

void FlyCommand::check_mode() const {
  const bool thesis = options.mode == FlightMode::thesis;
  for (const CLI::Option* option : thesis ? of_sweep : of_thesis)
    if (option->count() > 0)
      throw Error(ErrorCode::usage, option->get_name() + ": only --mode " + (thesis ? "sweep" : "thesis") +
                                        " knows it; leave it out, or fly in that mode");
  if (thesis && options.on_contact == OnContact::reflect)
    throw Error(ErrorCode::usage, "--on-contact 'reflect': --mode thesis knows no normals to reflect by; give back");
}

void FlyCommand::check_outputs() {
  film.check(path, {labyrinth, fly});
  if (path.given()) {
    path.check({{"csv", "", false, true, false}, {"ply", "", false, true, false}});
    path.check_differs(labyrinth);
    path.check_differs(fly);
  }
  if (force->count() > 0 && !path.given() && !film.given())
    throw Error(ErrorCode::usage, "--force needs --path or -o: there is nothing to overwrite; give one of them");
  if ((view || film.given()) && flies > fly::kMostBodies)
    throw Error(ErrorCode::usage, "--flies " + std::to_string(flies) + ": too many to watch; give " +
                                      std::to_string(fly::kMostBodies) + " at the most");
}

void FlyCommand::watch(const fly::FlightSubject& subject) {
  auto flight = std::make_unique<fly::Flight>(subject.walls, subject.fly, options, flies);
  fly::FlightServer page(subject, std::move(flight));
  server.serve(console, page.watch(), [&](auto&&... asked) { page.answer(asked...); });
}

void FlyCommand::record(const fly::FlightSubject& subject) {
  fly::Flight flight(subject.walls, subject.fly, options, flies);
  std::vector<fly::FlightFrame> frames;
  {
    const Cancellable cancellable;
    frames = fly::recorded(flight, steps, film.every(), console.progress());
    film.write(subject, frames, options.threads, console.progress());
  }
  std::int64_t collisions = 0, crossings = 0;
  for (const fly::Flying& it : frames.back().bodies) collisions += it.collisions, crossings += it.crossings;
  console.say(film.path().string() + ": " + counted(std::ssize(frames), "frame") + ", " +
              counted(collisions, "collision") + ", " + counted(crossings, "wall crossing") + ", " +
              bytes_text(film.bytes()));
  if (!console.json()) return;
  Json json = json_flight(flight.world());
  json["frames"] = frames.size();
  json["collisions"] = collisions;
  json["wall_crossings"] = options.check ? Json(crossings) : Json();
  json["output"] = {{"file", film.path().string()}, {"bytes", film.bytes()}};
  print(json, film.path());
}

Json FlyCommand::json_flight(const World& world) const {
  Json json = json_answer("fly");
  json["mode"] = fly::name_of(options.mode);
  json["recompute"] = options.recompute;
  json["device"] = name_of(world.backend());
  json["device_name"] = world.device_name();
  json["steps"] = steps;
  json["flies"] = flies;
  json["speed"] = options.speed;
  json["seed"] = options.seed;
  return json;
}

void FlyCommand::run() {
  check_mode();
  for (const std::string& name : {labyrinth, fly}) check_input(name);
  check_outputs();
  if (!view) server.check_unused("without --view nothing is served");
  if (view && console.json())
    throw Error(ErrorCode::usage, "--json: a page that is served has no result; leave it out");
  Axis up = Axis::y;
  const Body maze = read_body(labyrinth, console, &up), flier = read_body(fly, console);
  if (const double longest = length(maze.bounds().extent()); options.speed > longest)
    throw Error(ErrorCode::usage, "--speed " + number(options.speed) + ": a step is longer than the labyrinth, " +
                                      number(longest) + " from corner to corner; take a lower speed");
  if (view || film.given()) {
    fly::FlightSubject subject = fly::flight_subject(labyrinth, maze, flier, options.threads);
    subject.up = up;
    return view ? watch(subject) : record(subject);
  }
  std::vector<PathPoint> points;
  std::mutex adding;
  double seconds = 0;
  std::int64_t collisions = 0, crossings = 0;
  Grid grid, fly_grid;
  Json json;
  std::string where;
  {
    const Cancellable cancellable;
    options.progress = console.progress();
    options.bounds = maze.bounds();
    World world(flier, options);
    world.add(maze);
    grid = world.grid(0);
    for (std::int64_t n = 0; n < flies; ++n) world.add_flier(maze.bounds());
    const Vec3 middle = flier.bounds().center();
    World::Visit visit;
    if (path.given())
      visit = [&](std::size_t n, std::int64_t step, const Pose& pose) {
        const std::lock_guard lock(adding);
        points.push_back({static_cast<std::int64_t>(n), step, apply(pose, middle)});
      };
    const auto start = std::chrono::steady_clock::now();
    world.run(steps, visit);
    seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    for (const fly::Flier& it : world.fliers()) collisions += it.collisions, crossings += it.crossings;
    fly_grid = world.flier_grid();
    json = json_flight(world);
    if (world.backend() != Backend::cpu)
      where = std::string(" on ") + name_of(world.backend()) + " (" + world.device_name() + ")";
  }
  options.progress = nullptr;
  if (interrupted()) throw Error(ErrorCode::interrupted, "interrupted");
  if (path.given()) {
    std::ranges::sort(points, {}, [](const PathPoint& p) { return std::pair(p.flier, p.step); });
    write_path(path.path(), points, path.existing());
  }
  const double rate = static_cast<double>(steps * flies) / std::max(seconds, 1e-9);
  const auto tell = [this](const auto& what) { path.given() ? print(what, path.path()) : print(what); };
  if (console.json()) {
    json["seconds"] = {{"run", seconds}};
    json["steps_per_second"] = rate;
    json["collisions"] = collisions;
    json["wall_crossings"] = options.check ? Json(crossings) : Json();
    json["grid"] = json_grid(grid);
    json["fly_grid"] = json_grid(fly_grid);
    if (path.given()) json["output"] = json_output(path.path());
    return tell(json);
  }
  tell(counted(steps, "step") + (flies > 1 ? " of each of " + grouped(flies) + " flies" : "") + ", " + number(rate) +
       " a second" + (flies > 1 ? " in all" : "") + where + "; grid " + size_text(grid.size) +
       (options.recompute ? ", the fly's at each step anew, " + size_text(fly_grid.size) : "") + "\n" +
       counted(collisions, "collision") + (options.check ? ", " + counted(crossings, "wall crossing") : "") + "\n");
}

}  // namespace

void add_fly(CLI::App& program) {
  auto* verb = add_verb(program, "fly", "let flies fly through a labyrinth", kFlyExamples);
  const auto command = std::make_shared<FlyCommand>();
  FlyCommand* const it = command.get();
  FlightOptions& options = it->options;
  const auto add = [verb](const char* name, const char* value, const char* help, const char* group, auto set) {
    return add_parsed(*verb, {name, value, help, group}, set);
  };
  verb->add_option("--labyrinth", it->labyrinth, "the standing body: a mesh, scene:NAME or .body (scene:labyrinth)")
      ->option_text("BODY")
      ->group("Bodies");
  verb->add_option("--fly", it->fly, "the flying body (scene:fly)")->option_text("BODY")->group("Bodies");
  add("--flies", "K", "how many (default 1)", "Bodies",
      [it](S o, S t) { it->flies = parse_count(o, t, 1, 10'000'000); });
  add("--steps", "N", "of each fly (default 10000)", "Flight",
      [it](S o, S t) { it->steps = parse_count(o, t, 1, 100'000'000'000); });
  add("--speed", "V", "world units a step (default 0.02)", "Flight",
      [&options](S o, S t) { options.speed = parse_positive(o, t); });
  add("--seed", "S", "of places and directions (default 1)", "Flight", [&options](S o, S t) {
    options.seed = static_cast<std::uint64_t>(parse_count(o, t, 0, std::numeric_limits<std::int64_t>::max()));
  });
  add("--on-contact", "WHAT", "back (default) or reflect", "Flight", [&options](S o, S t) {
    options.on_contact = parse_choice(o, t, {"back", "reflect"}) == 0 ? OnContact::turn_back : OnContact::reflect;
  });
  add("--scatter", "DEGREES", "turn at random by up to this after a contact (default 28.6)", "Flight",
      [&options](S o, S t) { options.scatter_rad = parse_degrees(o, t, 180) * std::numbers::pi / 180; });
  it->of_sweep.push_back(add("--tolerance", "D", "as near as this is touching (default: 3e-5 of the fly)", "Collision",
                             [&options](S o, S t) { options.tolerance = parse_positive(o, t); }));
  verb->add_flag_callback(
          "--no-check", [&options] { options.check = false; }, "do not look for wall crossings: faster")
      ->group("Collision");
  add_threads(*verb, "Flight", options.threads);
  it->path.add_to(*verb, "FILE", "where each fly starts, turns and ends: .csv or .ply", "--path");
  it->force = verb->get_option("--force");
  verb->add_flag("--view", it->view, "watch it in a browser: speed, mode and number of flies\nchange while they fly")
      ->group(kWatchGroup)
      ->excludes("--path")
      ->excludes("--steps");
  it->film.add_to(*verb)->excludes("--view")->excludes("--path");
  it->server.add_to(*verb);
  it->console.add_to(*verb, Console::kMessages | Console::kJson | Console::kProgress);
  add("--mode", "MODE", "sweep (default) or thesis", kThesisGroup, [&options](S o, S t) {
    options.mode = parse_choice(o, t, {"sweep", "thesis"}) == 0 ? FlightMode::sweep : FlightMode::thesis;
  });
  it->of_thesis.push_back(add("--minimum", "E", "with --mode thesis: the minimum grid's factor, 1 or more (default 2)",
                              kThesisGroup, [&options](S o, S t) { options.minimum = parse_positive(o, t); }));
  it->of_thesis.push_back(add("--thickness", "T", "with --mode thesis: of the fields (default 2)", kThesisGroup,
                              [&options](S o, S t) { options.thickness = parse_positive(o, t); }));
  it->of_thesis.push_back(add("--threshold", "D",
                              "with --mode thesis: of the sum of two values (default: the larger spacing)",
                              kThesisGroup, [&options](S o, S t) { options.threshold = parse_positive(o, t); }));
  it->of_thesis.push_back(
      verb->add_flag("--recompute", options.recompute,
                     "with --mode thesis: compute the fly's field anew at each step,\nby Algorithm 1")
          ->group(kThesisGroup));
  it->of_thesis.push_back(add_device(*verb, kThesisGroup, options.backend, options.device));
  verb->callback([command] { command->run(); });
}

}  // namespace standoff::cli
