// SPDX-License-Identifier: Apache-2.0
// Clocks and recordings for measurements, on either platform.
#pragma once

#include <chrono>
#include <functional>

#include "gpu/platform.cuh"

#ifdef __CUDACC__
#include <cuda_profiler_api.h>
#endif

namespace standoff::STANDOFF_PLATFORM {

#ifdef __CUDACC__

/// Something of CUDA's that is given back, whatever happens.
template <class T, cudaError_t (*kDestroy)(T)>
class Owned {
 public:
  Owned() = default;
  ~Owned() {
    if (it_) kDestroy(it_);
  }
  Owned(const Owned&) = delete;
  Owned& operator=(const Owned&) = delete;
  T* made() { return &it_; }
  operator T() const { return it_; }

 private:
  T it_ = nullptr;
};

/// Milliseconds between two points of a stream, by CUDA events.
class StreamClock {
 public:
  StreamClock() {
    check_call(cudaEventCreate(begin_.made()), "cudaEventCreate");
    check_call(cudaEventCreate(end_.made()), "cudaEventCreate");
  }
  void start(Stream stream) { check_call(cudaEventRecord(begin_, stream), "cudaEventRecord"); }
  /// Waits for what was put on the stream since start().
  double stop(Stream stream) {
    float milliseconds = 0;
    check_call(cudaEventRecord(end_, stream), "cudaEventRecord");
    check_call(cudaEventSynchronize(end_), "cudaEventSynchronize");
    check_call(cudaEventElapsedTime(&milliseconds, begin_, end_), "cudaEventElapsedTime");
    return milliseconds;
  }

 private:
  Owned<cudaEvent_t, cudaEventDestroy> begin_, end_;
};

/// A stream of its own, which waits for what is on the default one and lets it wait, and what was put on it once, as a
/// CUDA graph.
class Recorded {
 public:
  explicit Recorded(const std::function<void(Stream)>& enqueue) {
    check_call(cudaStreamCreate(stream_.made()), "cudaStreamCreate");
    check_call(cudaStreamBeginCapture(stream_, cudaStreamCaptureModeThreadLocal), "cudaStreamBeginCapture");
    Owned<cudaGraph_t, cudaGraphDestroy> graph;
    enqueue(stream_);
    check_call(cudaStreamEndCapture(stream_, graph.made()), "cudaStreamEndCapture");
    check_call(cudaGraphInstantiate(graph_.made(), graph, 0), "cudaGraphInstantiate");
  }
  Stream stream() const { return stream_; }
  void play() { check_call(cudaGraphLaunch(graph_, stream_), "cudaGraphLaunch"); }
  void wait() { check_call(cudaStreamSynchronize(stream_), "cudaStreamSynchronize"); }

 private:
  Owned<cudaStream_t, cudaStreamDestroy> stream_;
  Owned<cudaGraphExec_t, cudaGraphExecDestroy> graph_;
};

/// For as long as it lives, a profiler that was told to wait (ncu --profile-from-start off) looks.
class Profiled {
 public:
  Profiled() { check_call(cudaProfilerStart(), "cudaProfilerStart"); }
  ~Profiled() { cudaProfilerStop(); }
  Profiled(const Profiled&) = delete;
  Profiled& operator=(const Profiled&) = delete;
};

#else

class StreamClock {
 public:
  void start(Stream) { began_ = std::chrono::steady_clock::now(); }
  double stop(Stream) {
    return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - began_).count();
  }

 private:
  std::chrono::steady_clock::time_point began_;
};

class Recorded {
 public:
  explicit Recorded(std::function<void(Stream)> enqueue) : enqueue_(std::move(enqueue)) {}
  Stream stream() const { return nullptr; }
  void play() { enqueue_(nullptr); }
  void wait() {}

 private:
  std::function<void(Stream)> enqueue_;
};

class Profiled {
 public:
  Profiled() {}  // nobody looks
};

#endif

}  // namespace standoff::STANDOFF_PLATFORM
