// SPDX-License-Identifier: Apache-2.0
#include "cli/flight_output.h"

#include "cli/options.h"
#include "cli/parse.h"
#include "files/atomic_file.h"
#include "fly/film.h"
#include "standoff/error.h"

namespace standoff::cli {
namespace {

namespace fs = std::filesystem;

constexpr const char* kWatchGroup = "Watching";

}  // namespace

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

}  // namespace standoff::cli
