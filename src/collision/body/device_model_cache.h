// SPDX-License-Identifier: Apache-2.0
// A model's copies in the memory of devices, made on first use and freed with the model.
#pragma once

#include <map>
#include <memory>
#include <mutex>
#include <utility>

#include "standoff/compute.h"

namespace standoff::collision {

/// A model's data in a device's memory; the backend derives from it.
class CachedDeviceModel {
 public:
  CachedDeviceModel() = default;
  virtual ~CachedDeviceModel() = default;
  CachedDeviceModel(const CachedDeviceModel&) = delete;
  CachedDeviceModel& operator=(const CachedDeviceModel&) = delete;
};

/// The copies of one model. Safe to use from many threads.
class DeviceModelCache {
 public:
  /// The copy for a device, from make() where there is none yet.
  template <class Make>
  std::shared_ptr<const CachedDeviceModel> get(Backend backend, int device, Make make) const {
    const std::lock_guard lock(mutex_);
    auto& copy = copies_[{backend, device}];
    if (!copy) copy = make();
    return copy;
  }

 private:
  mutable std::mutex mutex_;
  mutable std::map<std::pair<Backend, int>, std::shared_ptr<const CachedDeviceModel>> copies_;
};

}  // namespace standoff::collision
