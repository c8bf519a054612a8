// SPDX-License-Identifier: Apache-2.0
// The main() of a fuzzer where libFuzzer is not: runs it on every file below the folders that are given, and on a few
// damaged copies of each, the same ones every time. script/test runs this under the address sanitizer, in the build
// that the other tests use; libFuzzer needs a build of its own (script/test --all).
#include <algorithm>
#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <random>
#include <vector>

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size);

namespace {

using Bytes = std::vector<std::uint8_t>;
constexpr std::size_t kMostBytes = 8192;  // as libFuzzer's -max_len in CMakeLists.txt
constexpr int kCopies = 30;

Bytes read(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  Bytes bytes((std::istreambuf_iterator<char>(file)), {});
  bytes.resize(std::min(bytes.size(), kMostBytes));
  return bytes;
}

// Changes some bytes, and loses some.
Bytes damaged(Bytes bytes, std::mt19937& random) {
  if (bytes.empty()) return bytes;
  const auto place = [&] { return static_cast<std::ptrdiff_t>(random() % bytes.size()); };
  for (auto n = random() % 8 + 1; n > 0; --n)
    bytes[static_cast<std::size_t>(place())] = static_cast<std::uint8_t>(random());
  if (random() % 2 == 0) {
    const std::ptrdiff_t from = place();
    bytes.erase(bytes.begin() + from, bytes.begin() + std::min(from + 16, std::ssize(bytes)));
  }
  return bytes;
}

}  // namespace

int main(int argc, char** argv) {
  std::vector<std::filesystem::path> files;
  for (int n = 1; n < argc; ++n)
    for (const auto& entry : std::filesystem::recursive_directory_iterator(argv[n]))
      if (entry.is_regular_file()) files.push_back(entry.path());
  if (files.empty()) {
    std::fputs("there is no file to run on; give folders\n", stderr);
    return 1;
  }
  std::ranges::sort(files);
  std::mt19937 random(1);
  for (const auto& path : files) {
    const Bytes bytes = read(path);
    LLVMFuzzerTestOneInput(bytes.data(), bytes.size());
    for (int copy = 0; copy < kCopies; ++copy) {
      const Bytes changed = damaged(bytes, random);
      LLVMFuzzerTestOneInput(changed.data(), changed.size());
    }
  }
  std::printf("%zu files, %d damaged copies of each\n", files.size(), kCopies);
}
