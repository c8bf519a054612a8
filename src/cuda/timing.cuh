// Clocks and recordings for measurements, on either platform.
#pragma once

#include <chrono>
#include <functional>

#include "cuda/platform.cuh"

namespace difi::DIFI_PLATFORM {

#ifdef __CUDACC__

/// Milliseconds between two points of a stream, by CUDA events.
class StreamClock {
 public:
  StreamClock() {
    check_call(cudaEventCreate(&begin_), "cudaEventCreate");
    check_call(cudaEventCreate(&end_), "cudaEventCreate");
  }
  ~StreamClock() {
    cudaEventDestroy(begin_);
    cudaEventDestroy(end_);
  }
  StreamClock(const StreamClock&) = delete;
  StreamClock& operator=(const StreamClock&) = delete;
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
  cudaEvent_t begin_ = nullptr, end_ = nullptr;
};

/// A stream of its own, and what was put on it once, as a CUDA graph.
class Recorded {
 public:
  explicit Recorded(const std::function<void(Stream)>& enqueue) {
    check_call(cudaStreamCreate(&stream_), "cudaStreamCreate");
    check_call(cudaStreamBeginCapture(stream_, cudaStreamCaptureModeThreadLocal), "cudaStreamBeginCapture");
    enqueue(stream_);
    cudaGraph_t graph = nullptr;
    check_call(cudaStreamEndCapture(stream_, &graph), "cudaStreamEndCapture");
    check_call(cudaGraphInstantiate(&graph_, graph, 0), "cudaGraphInstantiate");
    cudaGraphDestroy(graph);
  }
  ~Recorded() {
    cudaGraphExecDestroy(graph_);
    cudaStreamDestroy(stream_);
  }
  Recorded(const Recorded&) = delete;
  Recorded& operator=(const Recorded&) = delete;
  Stream stream() const { return stream_; }
  void play() { check_call(cudaGraphLaunch(graph_, stream_), "cudaGraphLaunch"); }

 private:
  cudaStream_t stream_ = nullptr;
  cudaGraphExec_t graph_ = nullptr;
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

 private:
  std::function<void(Stream)> enqueue_;
};

#endif

}  // namespace difi::DIFI_PLATFORM
