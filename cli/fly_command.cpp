// SPDX-License-Identifier: Apache-2.0
// standoff fly: the fly in the labyrinth, as in the thesis and without its accidents.
#include <algorithm>
#include <chrono>
#include <memory>
#include <mutex>
#include <numbers>

#include "cli/console.h"
#include "cli/files.h"
#include "cli/flight_output.h"
#include "cli/flight_server.h"
#include "cli/options.h"
#include "cli/parse.h"
#include "cli/process.h"
#include "cli/text.h"
#include "cli/verb.h"
#include "standoff/experimental/simulation.h"

namespace standoff::cli {
namespace {

using namespace experimental;

constexpr const char* kFlyExamples =
    R"(  standoff fly --steps 100000 --speed 0.04 --path out.csv      one fly, where it flew as a table
  standoff fly --mode thesis --minimum 3 --speed 5             Algorithm 2: watch the wall crossings
  standoff fly --flies 1000 --steps 1000 --json                many at once
  standoff fly --speed 0.2 --steps 600 -o fly.html             a page that plays the flight; -o fly.mp4: a video
)";

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
  void watch(const CollisionModel& maze, const CollisionModel& flier);
  void record(const CollisionModel& maze, const CollisionModel& flier);
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

void FlyCommand::watch(const CollisionModel& maze, const CollisionModel& flier) {
  auto flight = std::make_unique<fly::Flight>(maze, flier, options, flies);
  FlightServer page(fly::flight_subject(labyrinth, maze, flier, options.execution), std::move(flight));
  server.serve(console, page.watch(), [&](auto&&... asked) { page.answer(asked...); });
}

void FlyCommand::record(const CollisionModel& maze, const CollisionModel& flier) {
  fly::Flight flight(maze, flier, options, flies);
  std::vector<fly::FlightFrame> frames;
  {
    const Cancellable cancellable;
    frames = fly::recorded(flight, steps, film.every(), console.progress());
    film.write(fly::flight_subject(labyrinth, maze, flier, options.execution), frames, options.execution.threads,
               console.progress());
  }
  std::int64_t collisions = 0, crossings = 0;
  for (const fly::Flying& it : frames.back().bodies) collisions += it.collisions, crossings += it.crossings;
  console.say(film.path().string() + ": " + counted(std::ssize(frames), "frame") + ", " +
              counted(collisions, "collision") + ", " + counted(crossings, "wall crossing") + ", " +
              bytes_text(film.bytes()));
  if (!console.json()) return;
  Json json = json_answer("fly");
  json["mode"] = fly::name_of(options.mode);
  json["steps"] = steps;
  json["flies"] = flies;
  json["speed"] = options.speed;
  json["seed"] = options.seed;
  json["frames"] = frames.size();
  json["collisions"] = collisions;
  json["wall_crossings"] = options.check ? Json(crossings) : Json();
  json["output"] = {{"file", film.path().string()}, {"bytes", film.bytes()}};
  print(json, film.path());
}

void FlyCommand::run() {
  check_mode();
  for (const std::string& name : {labyrinth, fly}) check_input(name);
  check_outputs();
  if (!view) server.check_unused("without --view nothing is served");
  if (view && console.json())
    throw Error(ErrorCode::usage, "--json: a page that is served has no result; leave it out");
  const CollisionModel maze = read_body(labyrinth, console), flier = read_body(fly, console);
  if (const double longest = length(maze.bounds().extent()); options.speed > longest)
    throw Error(ErrorCode::usage, "--speed " + number(options.speed) + ": a step is longer than the labyrinth, " +
                                      number(longest) + " from corner to corner; take a lower speed");
  if (view) return watch(maze, flier);
  if (film.given()) return record(maze, flier);
  std::vector<PathPoint> points;
  std::mutex adding;
  double seconds = 0;
  std::int64_t collisions = 0, crossings = 0;
  Grid grid;
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
    for (const Flier& it : world.fliers()) collisions += it.collisions, crossings += it.crossings;
  }
  options.progress = nullptr;
  if (interrupted()) throw Error(ErrorCode::interrupted, "interrupted");
  if (path.given()) {
    std::ranges::sort(points, {}, [](const PathPoint& p) { return std::pair(p.flier, p.step); });
    write_path(path.path(), points, path.existing());
  }
  const double rate = static_cast<double>(steps * flies) / std::max(seconds, 1e-9);
  const bool thesis = options.mode == FlightMode::thesis;
  const auto tell = [this](const auto& what) { path.given() ? print(what, path.path()) : print(what); };
  if (console.json()) {
    Json json = json_answer("fly");
    json["mode"] = thesis ? "thesis" : "sweep";
    json["steps"] = steps;
    json["flies"] = flies;
    json["speed"] = options.speed;
    json["seed"] = options.seed;
    json["seconds"] = {{"run", seconds}};
    json["steps_per_second"] = rate;
    json["collisions"] = collisions;
    json["wall_crossings"] = options.check ? Json(crossings) : Json();
    json["grid"] = json_grid(grid);
    if (path.given()) json["output"] = json_output(path.path());
    return tell(json);
  }
  tell(counted(steps, "step") + (flies > 1 ? " of each of " + grouped(flies) + " flies" : "") + ", " + number(rate) +
       " a second" + (flies > 1 ? " in all" : "") + "; grid " + size_text(grid.size) + "\n" +
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
  add_threads(*verb, "Flight", options.execution.threads);
  it->path.add_to(*verb, "FILE", "where each fly starts, turns and ends: .csv or .ply", "--path");
  it->force = verb->get_option("--force");
  verb->add_flag("--view", it->view, "watch it in a browser: speed, mode and number of flies\nchange while they fly")
      ->group("Watching")
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
  verb->callback([command] { command->run(); });
}

}  // namespace standoff::cli
