// SPDX-License-Identifier: Apache-2.0
// What every fuzzer of files that are written by grammar does.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <initializer_list>
#include <span>
#include <string_view>

#include "tests/grammar/judge.h"
#include "tests/support/temp_folder.h"

namespace standoff::grammar {

/// A folder with the traps, for as long as the process lives.
inline const std::filesystem::path& fuzz_folder() {
  static const TempFolder own;
  static const std::filesystem::path folder = [] {
    const std::filesystem::path made = own / "files";
    std::filesystem::create_directory(made);
    set_traps(made);
    return made;
  }();
  return folder;
}

/// The first byte picks one of the formats, those after it decide what its grammar writes; read, it must be what it is.
inline int fuzz_one_of(std::initializer_list<std::string_view> extensions, const std::uint8_t* data, std::size_t size) {
  if (size == 0) return 0;
  const std::string_view wanted = extensions.begin()[data[0] % extensions.size()];
  const Grammar& grammar = *std::ranges::find(kGrammars, wanted, &Grammar::extension);
  Choices choices(std::span(data + 1, size - 1));
  const File file = grammar.make(choices);
  const Verdict verdict = judge(grammar, file, choices.tricks() == 0, put(grammar, file, fuzz_folder()));
  if (verdict.fault.empty()) return 0;
  std::fprintf(stderr, "%s: %s\n", grammar.extension, verdict.fault.c_str());
  std::abort();
}

}  // namespace standoff::grammar
