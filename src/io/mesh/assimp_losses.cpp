// SPDX-License-Identifier: Apache-2.0
#ifdef STANDOFF_HAVE_ASSIMP

#include "io/mesh/assimp_losses.h"

#include <assimp/DefaultLogger.hpp>
#include <assimp/LogStream.hpp>
#include <mutex>
#include <string_view>
#include <thread>

namespace standoff {
namespace {

std::mutex one_reader_at_a_time;

}  // namespace

struct AssimpLosses::Listener : Assimp::LogStream {
  void write(const char* text) override {
    if (std::this_thread::get_id() != reader || !first.empty()) return;
    // 3DS: a corner that is no vertex, which assimp replaces by the last one.
    const std::string_view message = text;
    if (message.find("Vertex index overflow") != message.npos) first = message;
  }

  std::unique_lock<std::mutex> alone{one_reader_at_a_time};
  std::thread::id reader = std::this_thread::get_id();
  std::string first;
};

AssimpLosses::AssimpLosses() : listener_(std::make_unique<Listener>()) {
  own_logger_ = Assimp::DefaultLogger::isNullLogger();
  if (own_logger_) Assimp::DefaultLogger::create("", Assimp::Logger::NORMAL, 0);
  Assimp::DefaultLogger::get()->attachStream(listener_.get(), Assimp::Logger::Warn);
}

AssimpLosses::~AssimpLosses() {
  Assimp::DefaultLogger::get()->detachStream(listener_.get(), Assimp::Logger::Warn);
  if (own_logger_) Assimp::DefaultLogger::kill();
}

const std::string& AssimpLosses::first() const { return listener_->first; }

}  // namespace standoff

#endif  // STANDOFF_HAVE_ASSIMP
