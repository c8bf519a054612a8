// SPDX-License-Identifier: Apache-2.0
#include "files/line_reader.h"

#include <algorithm>
#include <cstring>

#include "standoff/error.h"

namespace standoff {
namespace {

constexpr std::string_view kMark = "\xEF\xBB\xBF";

}  // namespace

bool LineReader::next(std::string_view& line) {
  if (!begun_) begin();
  while (next_raw(line)) {
    line = line.substr(0, line.find('#'));
    line = line.substr(0, line.find_last_not_of(" \t\r\v\f") + 1);
    if (!line.empty()) return true;
  }
  return false;
}

void LineReader::begin() {
  begun_ = true;
  buffer_.resize(kLongestLine + 1);
  while (end_ < buffer_.size() && refill()) {
  }
  const std::string_view start(buffer_.data(), end_);
  if (start.starts_with(kMark)) at_ = kMark.size();
  if (start.find('\n') == std::string_view::npos && start.find('\r') != std::string_view::npos) line_end_ = '\r';
}

// Moves what is left to the front, and reads more after it.
bool LineReader::refill() {
  if (ended_) return false;
  std::memmove(buffer_.data(), buffer_.data() + at_, end_ - at_);
  end_ -= at_;
  at_ = 0;
  const std::size_t got = input_.read(buffer_.data() + end_, buffer_.size() - end_);
  end_ += got;
  ended_ = got == 0;
  return got > 0;
}

bool LineReader::next_raw(std::string_view& line) {
  for (std::size_t looked = 0;;) {
    const char* begin = buffer_.data() + at_;
    const void* stop = std::memchr(begin + looked, line_end_, end_ - at_ - looked);
    if (stop) {
      line = {begin, static_cast<std::size_t>(static_cast<const char*>(stop) - begin)};
      at_ += line.size() + 1;
      ++number_;
      return true;
    }
    looked = end_ - at_;
    if (looked > kLongestLine) {
      ++number_;
      fail("a line of more than " + std::to_string(kLongestLine) + " bytes; it is no table of points, check the file");
    }
    if (refill()) continue;
    if (looked == 0) return false;
    line = {buffer_.data() + at_, looked};
    at_ = end_;
    ++number_;
    return true;
  }
}

void LineReader::fail_at(std::uint64_t number, const std::string& message) const {
  throw Error(ErrorCode::input, name() + ":line " + std::to_string(number) + ": " + message,
              {.file = name(), .line = static_cast<std::int64_t>(number)});
}

}  // namespace standoff
