// SPDX-License-Identifier: Apache-2.0
#include "cli/verb.h"

#include <algorithm>
#include <array>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "cli/console.h"
#include "cli/suggest.h"
#include "cli/text.h"
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

}  // namespace

std::string value_name(const CLI::Option& option) {
  if (option.get_positional()) return option.get_name(true);
  if (option.get_items_expected_max() == 0) return "";
  return option.get_option_text().empty() ? "TEXT" : option.get_option_text();
}

namespace {

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
    return value_name(*option).empty() || option->get_positional() ? "" : " " + value_name(*option);
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

// The end of a message about a word that is none of these: which may have been meant, or else where they stand.
std::string instead_of(const std::string& word, const std::vector<std::string>& words, const std::string& see) {
  const std::string near = did_you_mean(word, words);
  return near.empty() ? see : near;
}

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
  if (const auto early = program.remaining(false); !early.empty() && (!named.empty() || early.front().starts_with('-')))
    fail("'" + early.front() + "' stands before the verb; begin with the verb, as in standoff compute MESH");
  if (const auto remaining = program.remaining(true); !remaining.empty()) {
    const std::string& word = remaining.front();
    if (named.empty() && word.find('.') != std::string::npos)
      fail("'" + word + "' is no verb; for its field: standoff compute " + word);
    if (named.empty()) fail("'" + word + "' is no verb" + instead_of(word, verbs(program), see));
    if (word.starts_with('-'))
      fail("unknown option '" + word + "'" + instead_of(word.substr(0, word.find('=')), options(verb), see));
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
    const std::vector<std::string> known = verbs(program);
    fail("'" + *about + "' is no verb" + instead_of(*about, known, "; take " + joined(known)));
  });
}

namespace {

// Flags that most verbs have are taken before the verb too, as many programs take them: they are moved behind it.
void move_flags_behind_verb(std::vector<char*>& words) {
  constexpr std::array<std::string_view, 5> kFlags{"-q", "--quiet", "-v", "--verbose", "--json"};
  const auto verb = std::find_if(words.begin() + 1, words.end(), [&](std::string_view word) {
    return std::ranges::find(kFlags, word) == kFlags.end();
  });
  if (verb != words.end() && **verb != '-') std::rotate(words.begin() + 1, verb, verb + 1);
}

}  // namespace

void parse(CLI::App& program, int argc, char** argv) {
  if (argc < 2) fail("no verb given; see standoff help, or begin with standoff compute MESH");
  std::vector<char*> words(argv, argv + argc);
  move_flags_behind_verb(words);
  try {
    program.parse(argc, words.data());
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
