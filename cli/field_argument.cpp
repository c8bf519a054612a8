// SPDX-License-Identifier: Apache-2.0
#include "cli/field_argument.h"

#include "cli/files.h"
#include "cli/memory.h"
#include "cli/options.h"
#include "cli/parse.h"
#include "cli/spinner.h"
#include "standoff/error.h"

namespace standoff::cli {

void FieldArgument::add_to(CLI::App& verb, const std::string& what) {
  const std::string help = "most memory for " + what + ", as in 500M or 8G\n(default: 80 % of the machine's)";
  add_parsed(verb, {"--memory-limit", "SIZE", help.c_str(), "Input"},
             [this](const std::string& o, const std::string& t) { memory_limit_ = parse_bytes(o, t); });
}

FieldReadOptions FieldArgument::options_for(const std::string& name) const {
  if (kind_of(name) != FileKind::field)
    throw Error(ErrorCode::input, name + ": this is no field, as " + extensions(field_formats(), false) +
                                      " are; compute the field of a mesh with standoff compute");
  return {.memory_limit = memory_limit()};
}

std::int64_t FieldArgument::memory_limit() const { return memory_limit_ ? *memory_limit_ : default_memory_limit(); }

DistanceField FieldArgument::read(const std::string& name, const Console& console) const {
  const FieldReadOptions options = options_for(name);
  return with_spinner(console, "reading " + name, [&] { return read_field(name, options); });
}

FieldFile FieldArgument::read_file(const std::string& name, const Console& console) const {
  const FieldReadOptions options = options_for(name);
  return with_spinner(console, "reading " + name, [&] { return read_field_file(name, options); });
}

void FieldArgument::check_unused(const std::string& name) const {
  if (memory_limit_)
    throw Error(ErrorCode::usage, "--memory-limit: it is for fields, and " + name + " is none; leave it out");
}

}  // namespace standoff::cli
