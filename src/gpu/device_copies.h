// SPDX-License-Identifier: Apache-2.0
// Copies of something in the memory of devices, made on first use and freed with it.
#pragma once

#include <map>
#include <memory>
#include <mutex>
#include <utility>

#include "standoff/execution.h"

namespace standoff::gpu {

/// What lies in a device's memory; the backend derives from it.
class DeviceCopy {
 public:
  DeviceCopy() = default;
  virtual ~DeviceCopy() = default;
  DeviceCopy(const DeviceCopy&) = delete;
  DeviceCopy& operator=(const DeviceCopy&) = delete;
};

/// The copies of one thing. Safe to use from many threads.
class DeviceCopies {
 public:
  /// The copy for a device, from make() where there is none yet.
  template <class Make>
  std::shared_ptr<const DeviceCopy> get(Backend backend, int device, Make make) const {
    const std::lock_guard lock(mutex_);
    auto& copy = copies_[{backend, device}];
    if (!copy) copy = make();
    return copy;
  }

 private:
  mutable std::mutex mutex_;
  mutable std::map<std::pair<Backend, int>, std::shared_ptr<const DeviceCopy>> copies_;
};

}  // namespace standoff::gpu
