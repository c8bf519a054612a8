// SPDX-License-Identifier: Apache-2.0
// One way to add an option whose text is parsed at once, so that a bad value is told before any work; and the options
// that several verbs have.
#pragma once

#include <string>

#include <CLI/CLI.hpp>

#include "standoff/compute.h"

namespace standoff::cli {

/// The group of the options that rebuild the thesis. It stands last in a verb's help: add them last.
inline constexpr const char* kThesisGroup = "The thesis of 2008 (docs/thesis.md)";

struct OptionText {
  const char* name;   ///< "-r,--resolution"
  const char* value;  ///< "N", as shown in the help
  const char* help;
  const char* group;
};

/// What add_parsed() passes on: an option's long name, or what was given for it.
using S = const std::string&;

/// `set(name, given)` gets the option's long name, for messages, and what was given.
template <class Set>
CLI::Option* add_parsed(CLI::App& verb, const OptionText& text, Set set) {
  const std::string name = text.name;
  const auto parsed = [set, shown = name.substr(name.find("--"))](const std::string& given) { set(shown, given); };
  return verb.add_option_function<std::string>(name, parsed, text.help)->option_text(text.value)->group(text.group);
}

/// Adds --device.
CLI::Option* add_device(CLI::App& verb, const char* group, Backend& backend, int& device);
/// Adds --uncompressed, for fields that are written.
void add_uncompressed(CLI::App& verb, bool& uncompressed);
/// Adds -j.
CLI::Option* add_threads(CLI::App& verb, const char* group, int& threads);

}  // namespace standoff::cli
