// SPDX-License-Identifier: Apache-2.0
#include "tests/grammar/traps.h"

#include <sys/stat.h>

#include <fstream>

#include "tests/grammar/judge.h"

namespace standoff::grammar {
namespace {

void write(const std::filesystem::path& path, const std::string& bytes) {
  std::ofstream(path, std::ios::binary).write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
}

}  // namespace

void set_traps(const std::filesystem::path& folder) {
  if (::mkfifo((folder / kPipe).c_str(), 0600) != 0)
    throw std::filesystem::filesystem_error("mkfifo", folder / kPipe, std::error_code());
  std::filesystem::create_directory(folder / kFolder);
  std::filesystem::create_symlink(kLoop, folder / kLoop);
  write(folder / kOutside, std::string(std::size_t{1} << 16, kOutsideByte));
}

std::filesystem::path put(const Grammar& grammar, const File& file, const std::filesystem::path& folder) {
  for (const auto& [name, bytes] : file.beside) write(folder / name, bytes);
  const std::filesystem::path path = folder / (std::string("made.") + grammar.extension);
  write(path, file.bytes);
  return path;
}

}  // namespace standoff::grammar
