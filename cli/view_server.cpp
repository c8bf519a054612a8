// SPDX-License-Identifier: Apache-2.0
#include "cli/view_server.h"

#include <algorithm>
#include <cmath>
#include <thread>
#include <utility>

#include "cli/json.h"
#include "cli/parse.h"
#include "cli/text.h"
#include "files/atomic_file.h"
#include "standoff/cuda.h"
#include "standoff/io.h"

namespace standoff::cli {
namespace {

using view::LiveSettings;
using view::Refusal;
using view::Reply;
using view::Request;

constexpr const char* kJsonType = "application/json";
constexpr const char* kBytesType = "application/octet-stream";
constexpr std::int64_t kMostSamplesShown = 1024;  // along the longest side: a full field of that is 4 GiB

const std::string& needed(const Request& request, const char* name) {
  if (const std::string* value = request.parameter(name)) return *value;
  throw Error(ErrorCode::usage, std::string(name) + " is missing");
}

std::string thickness_text(const LiveSettings& settings) {
  if (std::isinf(settings.thickness)) return "inf";
  return exact_number(settings.thickness) + (settings.thickness_in_samples ? "s" : "");
}

std::string sign_text(const LiveSettings& settings) { return find_info(settings.sign.method)->name; }

// What a page offers.
Json signs() {
  Json names = Json::array();
  for (const SignMethodInfo& info : kSignMethods)
    if (info.method != SignMethod::shell) names.push_back(info.name);
  return names;
}

std::string device_text(const Execution& execution) {
  const BackendInfo& info = *find_info(execution.backend);
  return info.has_devices ? std::string(info.name) + ":" + std::to_string(execution.device) : info.name;
}

Json devices() {
  Json names = {"auto", "cpu"};
  for (std::size_t n = 0; n < cuda::devices().size(); ++n) names.push_back("cuda:" + std::to_string(n));
  return names;
}

LiveSettings settings_of(const Request& request, LiveSettings settings) {
  settings.samples = parse_count("resolution", needed(request, "resolution"), 8, kMostSamplesShown);
  const Thickness thickness = parse_thickness("thickness", needed(request, "thickness"));
  settings.thickness = thickness.value;
  settings.thickness_in_samples = thickness.in_samples;
  const SignChoice sign = parse_sign("sign", needed(request, "sign"));
  if (sign.method == SignMethod::shell)
    throw Error(ErrorCode::usage, "sign 'shell': is not offered here; use standoff compute");
  settings.sign.method = sign.method;
  settings.execution.backend = parse_backend("device", needed(request, "device"), settings.execution.device);
  return settings;
}

// The extension of a file's name, if it is that of a mesh; nothing else of the name is used.
std::string mesh_suffix(std::string_view name) {
  const auto dot = name.rfind('.');
  std::string extension(dot == std::string_view::npos ? std::string_view() : name.substr(dot + 1));
  std::ranges::transform(extension, extension.begin(), [](char c) { return c >= 'A' && c <= 'Z' ? char(c + 32) : c; });
  std::string known;
  for (const FileFormat& format : mesh_formats()) {
    if (format.readable && format.extension == extension) return "." + extension;
    if (format.readable) known += (known.empty() ? "." : ", .") + format.extension;
  }
  throw Error(ErrorCode::usage, "'" + one_line(std::string(name)) + "': not a mesh by its name; drop one of " + known);
}

}  // namespace

std::vector<PageMesh> ViewSubject::page_meshes() const {
  std::vector<PageMesh> all;
  for (const auto& [name, mesh, up] : meshes) all.push_back({name, mesh, up});
  return all;
}

std::vector<PageField> ViewSubject::page_fields() const {
  std::vector<PageField> all;
  for (std::size_t n = 0; n < fields.size(); ++n) all.push_back({field_names[n], &fields[n]});
  return all;
}

ViewServer::ViewServer(ViewSubject subject, const PageOptions& page, const std::optional<LiveSettings>& live,
                       std::int64_t memory_limit, const Console& console)
    : subject_(std::move(subject)), page_(page), console_(console) {
  page_.served = true;
  if (!page_.up) page_.up = up_axis(subject_.page_meshes(), subject_.page_fields());
  if (!live) return;
  auto& [name, mesh, up] = subject_.meshes.front();
  live_ = std::make_unique<view::LiveView>(name, std::move(mesh), *live, memory_limit);
  subject_.meshes.erase(subject_.meshes.begin());
}

void ViewServer::answer(const Request& request, std::string_view route, Reply& reply) {
  const bool post = request.method == "POST";
  if (post != (route == "compute" || route == "upload"))
    return reply.refuse({405, post ? "this is asked for by GET" : "this is asked for by POST"});
  if (route.empty()) return reply.send(200, "text/html; charset=utf-8", make_page({}, {}, page_));
  if (route == "state") return reply.send(200, kJsonType, state());
  if (route == "events") return events(reply);
  if (route == "data") {
    if (const auto packed = data(needed(request, "id"))) return reply.send(200, kBytesType, *packed);
    return reply.refuse({404, "there is no such thing here"});
  }
  if (!live_) return;
  if (route == "compute") return compute(request, reply);
  if (route == "point") return point(request, reply);
  if (route == "upload") return upload(request, reply);
}

std::string ViewServer::state(std::optional<Axis> up) const {
  Json items = Json::array();
  for (std::size_t n = 0; n < subject_.meshes.size(); ++n)
    items.push_back({{"id", "mesh" + std::to_string(n)}, {"kind", "mesh"}});
  for (std::size_t n = 0; n < subject_.fields.size(); ++n)
    items.push_back({{"id", "field" + std::to_string(n)}, {"kind", "field"}});
  Json json = {{"kind", "view"}, {"items", items}};
  if (live_) {
    const auto subject = live_->subject();
    const LiveSettings settings = live_->settings();
    json["live"] = {{"name", one_line(subject.name)},
                    {"version", subject.version},
                    {"triangles", subject.mesh->triangles.size()},
                    {"longest_side", json_number(bounds(*subject.mesh).longest_side())},
                    {"resolution", settings.samples},
                    {"most_resolution", kMostSamplesShown},
                    {"thickness", thickness_text(settings)},
                    {"sign", sign_text(settings)},
                    {"signs", signs()},
                    {"device", device_text(settings.execution)},
                    {"devices", devices()}};
    if (up) json["live"]["up"] = std::string(1, name_of(*up));
  }
  // Names of files may be no UTF-8.
  return json.dump(-1, ' ', false, Json::error_handler_t::replace);
}

std::shared_ptr<const std::string> ViewServer::data(const std::string& id) {
  const std::lock_guard lock(packing_);
  std::string key = id;
  view::LiveView::Subject live;
  if (live_ && id == "live") {
    live = live_->subject();
    key += std::to_string(live.version);
  }
  if (const auto found = packed_.find(key); found != packed_.end()) return found->second;
  std::optional<std::string> packed;
  if (live.mesh) {
    packed = page_data(PageMesh{live.name, *live.mesh}, page_);
    std::erase_if(packed_, [](const auto& item) { return item.first.starts_with("live"); });
  }
  for (std::size_t n = 0; n < subject_.meshes.size(); ++n)
    if (id == "mesh" + std::to_string(n))
      packed = page_data(PageMesh{subject_.meshes[n].name, subject_.meshes[n].mesh}, page_);
  for (std::size_t n = 0; n < subject_.fields.size(); ++n)
    if (id == "field" + std::to_string(n))
      packed = page_data(PageField{subject_.field_names[n], &subject_.fields[n]}, page_);
  if (!packed) return nullptr;
  return packed_[key] = std::make_shared<const std::string>(std::move(*packed));
}

void ViewServer::compute(const Request& request, Reply& reply) {
  const auto field = live_->field(settings_of(request, live_->settings()), [&] { return reply.abandoned(); });
  if (!field) return reply.refuse({409, "something newer was asked for"});
  say_new_sign();
  reply.send(200, kBytesType, *field);
}

// Once for each decision, not for each grid that is tried.
void ViewServer::say_new_sign() {
  const SignReport sign = live_->sign();
  const std::lock_guard lock(saying_);
  if (std::exchange(said_, sign.why) != sign.why) say_sign(console_, sign);
}

void ViewServer::point(const Request& request, Reply& reply) {
  const Vec3 point = parse_point("at", needed(request, "at"));
  const auto [closest, gradient] = live_->at(point);
  const Json json = {{"distance", json_number(closest.distance)},
                     {"point", json_point(closest.point)},
                     {"triangle", json_triangle(closest.triangle)},
                     {"gradient", json_point(gradient)}};
  reply.send(200, kJsonType, json.dump());
}

void ViewServer::upload(const Request& request, Reply& reply) {
  const std::string& name = needed(request, "name");
  auto [mesh, read] = [&] {
    const TempFile file(mesh_suffix(name), request.body);
    try {
      return read_mesh(file.path());
    } catch (const Error& error) {
      // The file is the user's by its own name alone.
      std::string text = error.what();
      if (const auto at = text.find(file.path().string()); at != std::string::npos)
        text.replace(at, file.path().string().size(), one_line(name));
      throw Error(error.code(), text);
    }
  }();
  live_->replace(name, std::move(mesh));
  reply.send(200, kJsonType, state(read.up));
}

// How far the field has come. The stream also says that the page is open.
void ViewServer::events(Reply& reply) {
  const view::PageWatch::Open open(watch_);
  if (!reply.begin_stream("text/event-stream")) return;
  view::LiveView::Stage told;
  reply.part(": open\n\n");
  // A page that is closed is noticed within this time too.
  for (; !reply.abandoned(); std::this_thread::sleep_for(std::chrono::milliseconds(50))) {
    if (!live_) continue;
    const auto stage = live_->stage();
    if (stage == told) continue;
    told = stage;
    const Json json = {{"stage", stage.name}, {"fraction", stage.fraction}};
    if (!reply.part("data: " + json.dump() + "\n\n")) return;
  }
}

}  // namespace standoff::cli
