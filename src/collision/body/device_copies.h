// What devices keep of a body, made when first asked for and freed with the body.
#pragma once

#include <map>
#include <memory>
#include <mutex>
#include <utility>

#include "standoff/compute.h"

namespace standoff::collision {

/// A body's data in a device's memory: the backend's own business.
class OnDevice {
 public:
  OnDevice() = default;
  virtual ~OnDevice() = default;
  OnDevice(const OnDevice&) = delete;
  OnDevice& operator=(const OnDevice&) = delete;
};

/// The copies of one body. Safe to use from many threads.
class DeviceCopies {
 public:
  /// The copy for a device, from make() where there is none yet.
  template <class Make>
  std::shared_ptr<const OnDevice> get(Backend backend, int device, Make make) const {
    const std::lock_guard lock(mutex_);
    auto& copy = copies_[{backend, device}];
    if (!copy) copy = make();
    return copy;
  }

 private:
  mutable std::mutex mutex_;
  mutable std::map<std::pair<Backend, int>, std::shared_ptr<const OnDevice>> copies_;
};

}  // namespace standoff::collision
