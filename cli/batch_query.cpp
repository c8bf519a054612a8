// SPDX-License-Identifier: Apache-2.0
#include "cli/batch_query.h"

#include <algorithm>
#include <filesystem>
#include <string_view>

#include "cli/options.h"
#include "cli/parse.h"
#include "cli/text.h"
#include "files/atomic_file.h"
#include "files/file_view.h"
#include "standoff/error.h"

namespace standoff::cli {
namespace {

// Returns read(numbers) of each line that holds numbers.
template <class T, class Read>
std::vector<T> read_lines(const std::string& name, Read read) {
  LineReader lines{InputStream(name)};
  std::vector<T> found;
  for (std::string_view line; lines.next(line);) {
    try {
      found.push_back(read(numbers_in(line)));
    } catch (const Error& error) {
      throw Error(ErrorCode::input, lines.name() + ":" + std::to_string(lines.number()) + ": " + error.what());
    }
  }
  return found;
}

}  // namespace

std::vector<Pose> read_poses(const std::string& name) { return read_lines<Pose>(name, pose_of); }

std::vector<RigidMotion> read_motions(const std::string& name, Vec3 center) {
  return read_lines<RigidMotion>(name, [center](const std::vector<double>& v) {
    const std::size_t half = v.size() / 2;
    if (half != 3 && half != 7 && half != 12)
      throw Error(ErrorCode::usage, std::to_string(v.size()) +
                                        " numbers; give those of two poses, from and to: two times x,y,z; "
                                        "x,y,z,ax,ay,az,degrees; or twelve of a 3x4 matrix");
    return RigidMotion{pose_of(std::span(v).first(half)), pose_of(std::span(v).subspan(half)), center};
  });
}

namespace {

constexpr const char* kBatchGroup = "Many at once";

}  // namespace

void Table::cell(double value) { cell(exact_number(value)); }

void Table::point(bool there, Vec3 point) {
  for (const double c : {point.x, point.y, point.z}) cell(there ? exact_number(c) : "");
}

void Table::triangle(std::uint32_t index) { cell(index == kNoTriangle ? "" : std::to_string(index)); }

CLI::Option* BatchQuery::add_to(CLI::App& verb, const char* name, const char* help, const char* noun) {
  noun_ = noun;
  option_ =
      add_parsed(verb, {name, "FILE", help, kBatchGroup}, [this](const std::string& option, const std::string& text) {
        if (text.empty())
          throw Error(ErrorCode::usage, option + " '': give the name of a file, or - for standard input");
        file_ = text;
      });
  output_.add_to(verb, "CSV", "the answers, one on each line: .csv (default: standard output)");
  auto* output = verb.get_option("--output");
  output->needs(option_);
  verb.get_option("--force")->needs(output);
  add_threads(verb, kBatchGroup, execution_.threads)->needs(option_);
  return option_;
}

void BatchQuery::add_device_to(CLI::App& verb) {
  add_device(verb, kBatchGroup, execution_.backend, execution_.device)->needs(option_);
}

void BatchQuery::check(std::initializer_list<std::string> inputs) const {
  if (!output_.given()) return;
  output_.check({{"csv", "", false, true, false}});
  output_.check_differs(file_ == "-" ? "/dev/stdin" : file_);
  for (const std::string& input : inputs) output_.check_differs(input);
}

std::string BatchQuery::asked() const { return counted(count_, noun_); }

void BatchQuery::deliver(const char* verb, const Answers& answers, const Console& console) const {
  const std::string& table = answers.table.text();
  const std::string file = output_.path().string();
  if (output_.given())
    with_spinner(console, "writing " + file, [&] { write_text(output_.path(), table, output_.existing()); });
  else if (!console.json())
    print(table);
  std::string kinds;
  for (const auto& [kind, count] : answers.counts) {
    std::string words = kind;
    std::ranges::replace(words, '_', ' ');
    kinds += (kinds.empty() ? "" : ", ") + grouped(count) + " " + words;
  }
  const std::int64_t again = report_.undecided + report_.overflowed;
  console.say((output_.given() ? file + ": " : "") + asked() + ": " + kinds + "; in " + seconds_text(seconds_) +
              " on " + report_.backend + (report_.device.empty() ? "" : " (" + report_.device + ")") +
              (report_.backend == "cpu" ? "" : ", " + grouped(again) + " of them taken again by the CPU"));
  if (!console.json()) return;
  Json json = json_answer(verb);
  json["queries"] = count_;
  for (const auto& [kind, count] : answers.counts) json["counts"][kind] = count;
  json["seconds"] = {{"query", seconds_}};
  json["device"] = report_.backend;
  json["device_name"] = report_.device;
  json["on_device"] = report_.on_device;
  json["recomputed"] = {{"undecided", report_.undecided}, {"overflowed", report_.overflowed}};
  if (!output_.given()) return print(json);
  json["output"] = json_output(output_.path());
  print(json, output_.path());
}

}  // namespace standoff::cli
