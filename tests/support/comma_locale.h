// SPDX-License-Identifier: Apache-2.0
// A locale that writes 1,5 for one and a half, as many do, whatever the machine has installed.
#pragma once

#include <stdlib.h>

#include <clocale>
#include <cstdio>
#include <string>

#include "tests/support/temp_folder.h"

namespace standoff {

/// The process's locale for numbers while it lives, made by the system's localedef. Check is_set(): without localedef
/// there is none.
class CommaLocale {
 public:
  CommaLocale() : before_(std::setlocale(LC_NUMERIC, nullptr)) {
    const auto source = folder_.file("source",
                                     "comment_char %\nescape_char /\n"
                                     "LC_NUMERIC\ndecimal_point \",\"\nthousands_sep \".\"\ngrouping 3;3\n"
                                     "END LC_NUMERIC\nLC_CTYPE\ncopy \"POSIX\"\nEND LC_CTYPE\n");
    const std::string make = "localedef -c -i '" + source.string() + "' -f ANSI_X3.4-1968 '" +
                             (folder_ / "comma").string() + "' >'" + (folder_ / "log").string() + "' 2>&1";
    made_ = std::system(make.c_str());
    ::setenv("LOCPATH", folder_.path().c_str(), 1);
    std::setlocale(LC_NUMERIC, "comma");
  }
  CommaLocale(const CommaLocale&) = delete;
  CommaLocale& operator=(const CommaLocale&) = delete;
  ~CommaLocale() {
    std::setlocale(LC_NUMERIC, before_.c_str());
    ::unsetenv("LOCPATH");
  }

  bool is_set() const {
    char text[8];
    std::snprintf(text, sizeof text, "%.1f", 1.5);
    return std::string(text) == "1,5";
  }

 private:
  TempFolder folder_;
  std::string before_;
  int made_ = 0;  // localedef warns of what it was not given; is_set() tells what came of it
};

}  // namespace standoff
