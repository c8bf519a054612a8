// SPDX-License-Identifier: Apache-2.0
// The verbs: the table of them, the program's help, and its words for command lines that make no sense.
#pragma once

#include <memory>
#include <string>

#include <CLI/CLI.hpp>

namespace standoff::cli {

/// The program's own help. Call before verbs are added: they inherit from it.
void set_up_help(CLI::App& program);

/// Adds the verbs `version` and `help`, and --version. Call after the other verbs.
void add_version_and_help(CLI::App& program);

/// A verb with a line about it and its examples, which come first in its help.
CLI::App* add_verb(CLI::App& program, const std::string& name, const std::string& line, const std::string& examples);

/// The same of a command, in whose hands the verb is: add_to() says what it takes, run() does it.
template <class Command>
void add_command(CLI::App& program, const char* name, const char* line, const char* examples) {
  CLI::App* const verb = add_verb(program, name, line, examples);
  const auto command = std::make_shared<Command>();
  command->add_to(*verb);
  verb->callback([command] { command->run(); });
}

/// The word that stands for the value of an option, or for an argument, in the help: "FIELD". Empty for a flag.
std::string value_name(const CLI::Option& option);

/// Runs the verb that the command line names, or prints the help it asks for. Errors: usage, and the verb's own.
void parse(CLI::App& program, int argc, char** argv);

/// The table of verbs, in the order of the help: ROW(x) is the verb that add_x() adds to the program, in a file here.
#define STANDOFF_VERBS(ROW) \
  ROW(compute)              \
  ROW(batch)                \
  ROW(info)                 \
  ROW(slice)                \
  ROW(render)               \
  ROW(view)                 \
  ROW(verify)               \
  ROW(generate)             \
  ROW(convert)              \
  ROW(surface)              \
  ROW(points)               \
  ROW(crossings)            \
  ROW(voxels)               \
  ROW(build)                \
  ROW(collide)              \
  ROW(distance)             \
  ROW(sweep)                \
  ROW(fly)                  \
  ROW(devices)              \
  ROW(completion)           \
  ROW(man)

#define STANDOFF_ROW(verb) void add_##verb(CLI::App& program);
STANDOFF_VERBS(STANDOFF_ROW)
#undef STANDOFF_ROW

}  // namespace standoff::cli
