// SPDX-License-Identifier: Apache-2.0
#include "view/live/live_view.h"

#include <chrono>
#include <cmath>
#include <utility>

namespace standoff::view {
namespace {

// To look whether the page still waits is a call of the system: not for every tile.
constexpr std::chrono::milliseconds kLook{20};

}  // namespace

LiveView::LiveView(std::string name, Mesh mesh, const LiveSettings& settings, std::int64_t memory_limit)
    : memory_limit_(memory_limit),
      subject_{std::move(name), std::make_shared<const Mesh>(std::move(mesh)), 1},
      settings_(settings) {
  validate(*subject_.mesh);
}

LiveView::Subject LiveView::subject() const {
  const std::lock_guard lock(mutex_);
  return subject_;
}

LiveSettings LiveView::settings() const {
  const std::lock_guard lock(mutex_);
  return settings_;
}

LiveView::Stage LiveView::stage() const {
  const std::lock_guard lock(mutex_);
  return stage_;
}

SignReport LiveView::sign() const {
  const std::lock_guard lock(mutex_);
  return sign_;
}

void LiveView::replace(std::string name, Mesh mesh) {
  validate(mesh);
  auto shared = std::make_shared<const Mesh>(std::move(mesh));
  ++latest_;
  const std::lock_guard lock(mutex_);
  subject_ = {std::move(name), std::move(shared), subject_.version + 1};
}

std::optional<std::string> LiveView::field(const LiveSettings& settings, const std::function<bool()>& abandoned) {
  const std::uint64_t ticket = ++latest_;
  const std::lock_guard computing(computing_);  // what was asked for before notices that it has been overtaken
  if (latest_ != ticket) return {};
  Subject subject;
  {
    const std::lock_guard lock(mutex_);
    settings_ = settings;
    subject = subject_;
  }
  auto looked = std::chrono::steady_clock::now();
  ComputeOptions options{.sign = settings.sign, .execution = settings.execution, .memory_limit = memory_limit_};
  options.progress = [&](const Progress& progress) {
    {
      const std::lock_guard lock(mutex_);
      stage_ = {progress.stage, progress.fraction};
    }
    if (latest_ != ticket) return false;
    if (std::chrono::steady_clock::now() - looked < kLook) return true;
    looked = std::chrono::steady_clock::now();
    return !abandoned();
  };
  try {
    const Box box = bounds(*subject.mesh);
    const Padding padding =
        settings.thickness_in_samples ? padding_for_samples(settings.thickness) : padding_for(settings.thickness);
    const Grid grid = fit_resolution(box, settings.samples, padding);
    const double thickness =
        settings.thickness_in_samples ? settings.thickness * grid.max_spacing() : settings.thickness;
    SignReport sign = compute_into(*subject.mesh, grid, thickness, field_, options).sign;
    const std::lock_guard lock(mutex_);
    sign_ = std::move(sign);
  } catch (const Error& error) {
    if (error.code() == ErrorCode::interrupted) return {};
    throw;
  }
  if (latest_ != ticket) return {};
  // Over loopback bytes cost less than packing them does.
  return page_data(PageField{subject.name, &field_}, {.compression = 0});
}

std::shared_ptr<const MeshQuery> LiveView::query() {
  const Subject subject = this->subject();
  SignMethod sign = settings().sign.method;
  if (!find_info(sign)->at_points || sign == SignMethod::shell) sign = SignMethod::automatic;
  if (!query_ || query_version_ != subject.version || query_sign_ != sign) {
    query_ = std::make_shared<const MeshQuery>(*subject.mesh, MeshQueryOptions{.sign = {.method = sign}});
    query_version_ = subject.version;
    query_sign_ = sign;
  }
  return query_;
}

LiveView::At LiveView::at(Vec3 point) {
  std::shared_ptr<const MeshQuery> query;
  {
    const std::lock_guard lock(asking_);
    query = this->query();
  }
  At answer;
  query->closest({&point, 1}, {&answer.closest, 1});
  answer.gradient = query->gradient(point, answer.closest);
  return answer;
}

}  // namespace standoff::view
