// SPDX-License-Identifier: Apache-2.0
#include "cli/verb.h"

#include <algorithm>
#include <numeric>
#include <vector>

#include "cli/console.h"
#include "standoff/error.h"
#include "standoff/version.h"

namespace standoff::cli {
namespace {

constexpr const char* kUsageExamples = R"(standoff: exact distance fields of triangle meshes

Examples:
  standoff compute bunny.obj                              every sample of a 256-sample grid, into bunny.vti
  standoff compute part.stl -o part.nrrd -r 400 -t 3s     a band of 3 samples, 400 on the longest side
  standoff slice bunny.vti -o bunny.png                   a picture of its middle
  standoff verify bunny.vti bunny.obj                     test it against brute force
  standoff help compute                                   all options of a verb
)";

constexpr const char* kFooter = R"(Messages go to stderr, data to stdout. Output files appear whole or not at all.

Exit codes: 0 done, 1 internal error, 2 wrong usage, 3 unusable input, 4 cannot write, 5 over a limit,
6 no such device, 7 verify found wrong values, 8 the sign is not certain,
130 interrupted.)";

class HelpFormatter : public CLI::Formatter {
 public:
  HelpFormatter() { column_width(28); }
  std::string make_usage(const CLI::App* app, std::string name) const override {
    std::string usage = "Usage: " + name;
    if (!app->get_subcommands({}).empty()) return usage + " VERB ...\n";
    for (const CLI::Option* option : app->get_options([](const CLI::Option* o) { return o->get_positional(); }))
      usage += " " + make_option_usage(option);
    return usage + " [OPTIONS]\n";
  }
  // Our descriptions say what excludes what where it needs saying.
  std::string make_option_opts(const CLI::Option* option) const override {
    return option->get_option_text().empty() ? "" : " " + option->get_option_text();
  }
  std::string make_subcommand(const CLI::App* verb) const override {
    const std::string description = verb->get_description();
    std::string name = verb->get_name() + ' ';
    name.resize(std::max<std::size_t>(name.size(), 12), ' ');
    return "  " + name + description.substr(0, description.find('\n')) + "\n";
  }
};

// Not App::help, which answers for the verb on the command line whomever it is asked about.
std::string help_about(const CLI::App& app) {
  const std::string name = app.get_parent() ? "standoff " + app.get_name() : "standoff";
  std::string text = app.get_formatter()->make_help(&app, name, CLI::AppFormatMode::Normal);
  for (auto at = text.find("\n\n\n"); at != std::string::npos; at = text.find("\n\n\n", at)) text.erase(at, 1);
  return text;
}

// Insertions, deletions and replacements that turn one word into the other.
std::size_t edits(const std::string& a, const std::string& b) {
  std::vector<std::size_t> row(b.size() + 1);
  std::iota(row.begin(), row.end(), std::size_t{0});
  for (std::size_t i = 0; i < a.size(); ++i) {
    std::size_t diagonal = row[0]++;
    for (std::size_t j = 0; j < b.size(); ++j)
      diagonal = std::exchange(row[j + 1], std::min({row[j] + 1, row[j + 1] + 1, diagonal + (a[i] != b[j])}));
  }
  return row.back();
}

// "; did you mean 'X'?" for the nearest of the words, when one is near.
std::string suggestion(const std::string& word, const std::vector<std::string>& words) {
  const std::string* nearest = nullptr;
  std::size_t least = std::max<std::size_t>(2, word.size() / 3) + 1;
  for (const auto& candidate : words)
    if (const auto distance = edits(word, candidate); distance < least) {
      least = distance;
      nearest = &candidate;
    }
  return nearest ? "; did you mean '" + *nearest + "'?" : "";
}

std::vector<std::string> verbs(const CLI::App& program) {
  std::vector<std::string> names;
  for (const CLI::App* verb : program.get_subcommands({})) names.push_back(verb->get_name());
  return names;
}

std::vector<std::string> options(const CLI::App& verb) {
  std::vector<std::string> names;
  for (const CLI::Option* option : verb.get_options())
    for (const auto& name : option->get_lnames()) names.push_back("--" + name);
  return names;
}

[[noreturn]] void fail(const std::string& what) { throw Error(ErrorCode::usage, what); }

// What the command line parser has to say, in our words.
[[noreturn]] void fail(const CLI::App& program, const CLI::ParseError& error) {
  const auto named = program.get_subcommands();
  const CLI::App& verb = named.empty() ? program : *named.front();
  const std::string see = named.empty() ? "; see standoff help" : "; see standoff help " + verb.get_name();
  std::string what = error.what();
  if (const auto at = what.find(" excludes "); at != std::string::npos)
    fail(what.replace(at, 10, " and ") + " cannot go together; give one of them");
  if (const auto at = what.find(" requires "); at != std::string::npos)
    fail(what.replace(at, 10, " needs ") + "; give both or neither");
  if (const auto remaining = program.remaining(true); !remaining.empty()) {
    const std::string& word = remaining.front();
    if (named.empty() && word.find('.') != std::string::npos)
      fail("'" + word + "' is no verb; for its field: standoff compute " + word);
    if (named.empty()) fail("'" + word + "' is no verb" + suggestion(word, verbs(program)) + see);
    if (word.starts_with('-'))
      fail("unknown option '" + word + "'" + suggestion(word.substr(0, word.find('=')), options(verb)) + see);
    const bool writes = verb.get_option_no_throw("--output") != nullptr;
    fail("'" + word + "' is one argument too many" + (writes ? "; name the output with -o, as in -o " + word : see));
  }
  if (const auto colon = what.find(": ");
      colon != std::string::npos && dynamic_cast<const CLI::ArgumentMismatch*>(&error)) {
    const bool missing = what.ends_with("missing");
    fail(what.substr(0, colon) + (missing ? ": its value is missing" : ": given more than once; give it once") + see);
  }
  fail(what + see);
}

}  // namespace

void set_up_help(CLI::App& program) {
  program.name("standoff");
  program.description(kUsageExamples);
  program.footer(kFooter);
  program.formatter(std::make_shared<HelpFormatter>());
  program.set_help_flag("-h,--help", "print this help");
  program.require_subcommand(0,
                             1);  // at most one: `help` may be followed by a verb's name, and a file be called as one
}

CLI::App* add_verb(CLI::App& program, const std::string& name, const std::string& line, const std::string& examples) {
  auto* verb = program.add_subcommand(name, line + "\n\nExamples:\n" + examples);
  verb->group("Verbs");
  return verb;
}

void add_version_and_help(CLI::App& program) {
  auto* version = add_verb(program, "version", "print the version", "  standoff version\n");
  version->callback([] { print(std::string("standoff ") + standoff::version() + "\n"); });
  program.set_version_flag(
      "--version", [] { return std::string("standoff ") + standoff::version(); }, "print the version");

  auto* help = add_verb(program, "help", "print help, about a verb when one is named", "  standoff help compute\n");
  const auto about = std::make_shared<std::string>();
  help->add_option("VERB", *about, "a verb");
  help->callback([&program, about] {
    if (about->empty()) return print(help_about(program));
    for (const CLI::App* verb : program.get_subcommands({}))
      if (verb->get_name() == *about) return print(help_about(*verb));
    fail("'" + *about + "' is no verb" + suggestion(*about, verbs(program)) + "; see standoff help");
  });
}

void parse(CLI::App& program, int argc, char** argv) {
  if (argc < 2) fail("no verb given; see standoff help, or begin with standoff compute MESH");
  try {
    program.parse(argc, argv);
  } catch (const CLI::CallForHelp&) {
    const auto named = program.get_subcommands();
    print(help_about(named.empty() ? program : *named.front()));
  } catch (const CLI::CallForVersion& version) {
    print(std::string(version.what()) + "\n");
  } catch (const CLI::ParseError& error) {
    fail(program, error);
  }
}

}  // namespace standoff::cli
