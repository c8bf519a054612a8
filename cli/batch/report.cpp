// SPDX-License-Identifier: Apache-2.0
#include "cli/batch/report.h"

#include <algorithm>
#include <string>
#include <string_view>
#include <unordered_map>
#include <vector>

#include "cli/batch/pool.h"
#include "cli/files.h"
#include "cli/process.h"
#include "cli/text.h"
#include "files/atomic_file.h"
#include "page/page.h"
#include "standoff/error.h"
#include "standoff/picture.h"

namespace standoff::cli {
namespace {

namespace fs = std::filesystem;

// More rows than anybody reads, and more pictures than a browser likes in one page.
constexpr std::size_t kMostFailures = 5000, kMostPictures = 300;

struct Failure {
  std::int64_t index = 0;
  std::string path, status, message;
  std::string picture;  // PNG, base64
};

struct Findings {
  ReportedCounts counts;
  std::vector<Failure> failures;  // the first ones, in the order of the list
  std::int64_t failed = 0;
};

std::vector<fs::path> manifests_in(const fs::path& folder) {
  std::error_code ignored;
  if (const fs::path whole = manifest_path(folder, {}); fs::exists(whole, ignored)) return {whole};
  std::vector<fs::path> found;
  for (const auto& entry : fs::directory_iterator(folder, ignored)) {
    const std::string name = entry.path().filename().string();
    if (name.starts_with("manifest-") && name.ends_with(".jsonl")) found.push_back(entry.path());
  }
  if (found.empty())
    throw Error(ErrorCode::usage,
                folder.string() + ": there is no manifest in it; give the folder that a batch wrote to");
  std::ranges::sort(found);
  return found;
}

Findings look_through(const std::vector<fs::path>& manifests) {
  struct Last {
    std::size_t manifest;
    std::uint64_t line;
    int code;
    bool unsure;
  };
  std::unordered_map<std::int64_t, Last> last;  // of each mesh
  for (std::size_t m = 0; m < manifests.size(); ++m)
    each_row(manifests[m], [&](const Json& row, const ManifestLine& line) {
      last[row.at("index").get<std::int64_t>()] = {m, line.number, row.at("code").get<int>(), is_unsure(row)};
    });
  Findings found;
  for (const auto& [index, row] : last) {
    ++found.counts.by_status[row.code];
    found.counts.unsure += row.unsure;
    found.failed += row.code != 0;
  }
  for (std::size_t m = 0; m < manifests.size(); ++m)
    each_row(manifests[m], [&](const Json& row, const ManifestLine& line) {
      const Last& of = last.at(row.at("index").get<std::int64_t>());
      if (of.code == 0 || of.manifest != m || of.line != line.number) return;
      if (found.failures.size() >= 2 * kMostFailures) return;
      found.failures.push_back({row.at("index"), row.at("path"), row.at("status"), row.at("message"), ""});
    });
  std::ranges::sort(found.failures, {}, &Failure::index);
  if (found.failures.size() > kMostFailures) found.failures.resize(kMostFailures);
  return found;
}

// The mesh as a picture in base64, or nothing. Runs in a process of its own.
std::string draw(const std::string& path) {
  try {
    check_input(path);
    MeshInput input;
    input.set_name(path);
    const Mesh mesh = input.read();
    const TempFile file(".png", "");
    write_mesh_png(file.path(), mesh, {.width = 240, .height = 180, .shadows = false, .legend = false, .threads = 1});
    std::string picture;
    page::append_base64(picture, read_text(file.path()));
    return picture;
  } catch (...) {
    return {};
  }
}

void draw_failures(std::vector<Failure>& failures, const ReportOptions& options, const Console& console) {
  const std::size_t count = std::min(failures.size(), kMostPictures);
  std::size_t begun = 0, done = 0;
  WorkerPool pool(options.workers, options.timeout_s,
                  [](const std::string& path, const std::function<void()>&) { return draw(path); });
  const auto bar = console.progress(false);
  const Cancellable cancellable;
  WorkerPool::Caller caller;
  caller.next = [&](PoolTask& task) {
    if (begun == count) return WorkerPool::Next::end;
    task = {static_cast<std::int64_t>(begun), failures[begun].path, false};
    ++begun;
    return WorkerPool::Next::task;
  };
  caller.ended = [&](std::int64_t n, TaskEnd end) {
    failures[static_cast<std::size_t>(n)].picture = std::move(end.answer);
    ++done;
  };
  caller.tick = [&] { bar({"pictures", static_cast<double>(done) / static_cast<double>(count)}); };
  if (count > 0) pool.run(caller);
}

std::string escaped_html(std::string_view text) {
  std::string safe;
  for (const char c : text) {
    if (c == '<')
      safe += "&lt;";
    else if (c == '>')
      safe += "&gt;";
    else if (c == '&')
      safe += "&amp;";
    else if (c == '"')
      safe += "&quot;";
    else
      safe += c;
  }
  return safe;
}

constexpr std::string_view kPageBegin = R"(<!doctype html>
<html lang="en"><head><meta charset="utf-8"><meta name="viewport" content="width=device-width">
<meta http-equiv="Content-Security-Policy" content="default-src 'none'; img-src data:; style-src 'unsafe-inline'">
<title>standoff batch</title><style>
body { font: 15px/1.45 system-ui, sans-serif; margin: 2rem auto; max-width: 76rem; padding: 0 1rem; color-scheme: light dark; }
table { border-collapse: collapse; margin: 1rem 0 2rem; }
th, td { padding: .35rem .9rem .35rem 0; text-align: left; vertical-align: top; border-bottom: 1px solid #8884; }
td.n { text-align: right; font-variant-numeric: tabular-nums; }
td.path, td.message { overflow-wrap: anywhere; }
img { width: 120px; height: 90px; display: block; }
</style></head><body>
)";

std::string html_of(const fs::path& folder, const Findings& found) {
  std::int64_t all = 0;
  for (const auto& [code, count] : found.counts.by_status) all += count;
  std::string html(kPageBegin);
  html += "<h1>" + escaped_html(folder.string()) + "</h1>\n<p>" + counted(all, "mesh") + ", " + grouped(found.failed) +
          " failed" +
          (found.counts.unsure > 0 ? "; the sign of " + grouped(found.counts.unsure) + " is not certain" : "") +
          ".</p>\n<table><tr><th>status<th>exit code<th>meshes</tr>\n";
  for (const auto& [code, count] : found.counts.by_status)
    html += "<tr><td>" + std::string(status_name(code)) + "<td class=n>" + std::to_string(code) + "<td class=n>" +
            grouped(count) + "</tr>\n";
  html += "</table>\n";
  if (found.failed > 0) {
    html += "<h2>Failures</h2>\n";
    if (found.failed > static_cast<std::int64_t>(found.failures.size()))
      html += "<p>The first " + grouped(static_cast<std::int64_t>(found.failures.size())) + " of " +
              grouped(found.failed) + "; the manifest has all.</p>\n";
    html += "<table><tr><th>mesh<th>path<th>status<th>message<th></tr>\n";
    for (const Failure& failure : found.failures)
      html += "<tr><td class=n>" + std::to_string(failure.index) + "<td class=path>" + escaped_html(failure.path) +
              "<td>" + escaped_html(failure.status) + "<td class=message>" + escaped_html(failure.message) + "<td>" +
              (failure.picture.empty() ? "" : "<img alt=\"\" src=\"data:image/png;base64," + failure.picture + "\">") +
              "</tr>\n";
    html += "</table>\n";
  }
  return html + "</body></html>\n";
}

}  // namespace

ReportedCounts write_batch_report(const fs::path& folder, const ReportOptions& options, const Console& console) {
  Findings found = look_through(manifests_in(folder));
  draw_failures(found.failures, options, console);
  write_text(folder / "report.html", html_of(folder, found));
  return found.counts;
}

}  // namespace standoff::cli
