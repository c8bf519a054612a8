// SPDX-License-Identifier: Apache-2.0
// What the parsers know of the program, as data: the manual's pages and the completions of shells are made of it.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>

namespace standoff::cli {

/// What may stand for a value.
struct ManualValue {
  std::string name;                     ///< "FIELD"; empty for a flag
  bool files = false;                   ///< the name of a file
  bool folders = false;                 ///< the name of a folder
  std::vector<std::string> extensions;  ///< of files, without dots; empty: any
  std::vector<std::string> words;       ///< one of these
};

struct ManualOption {
  std::vector<std::string> names;  ///< "-o", "--output"
  ManualValue value;
  std::string help;  ///< one line
  std::string group;
};

struct ManualArgument {
  ManualValue value;
  std::string help;  ///< one line
  bool optional = false;
  bool repeats = false;  ///< there may be several
};

/// A verb, or the program itself, which has no name.
struct ManualPage {
  std::string name;
  std::string line;      ///< "compute the distance field of a mesh"
  std::string examples;  ///< a line each, with two blanks before it
  std::string footer;
  std::vector<ManualArgument> arguments;
  std::vector<ManualOption> options;  ///< those of a group side by side
};

/// The page of the program, and then one for each verb, in the order of the help.
std::vector<ManualPage> manual(const CLI::App& program);

/// The page in the language of man(7); `pages` are those of manual().
std::string man_page(const ManualPage& page, const std::vector<ManualPage>& pages);

/// The same page in Markdown, for the documentation's site.
std::string markdown_page(const ManualPage& page);

enum class Shell : std::uint8_t { bash, zsh, fish };

/// The script that completes command lines in a shell: it asks for completions().
const char* completion_script(Shell shell);

/// What may stand for the last of the words behind the program's name: "words" and one on each line, with its help
/// where the shell shows it; "files", or "files obj|stl", for these extensions; "folders"; nothing behind what is no
/// verb.
std::string completions(const std::vector<ManualPage>& pages, Shell shell, const std::vector<std::string>& words);

}  // namespace standoff::cli
