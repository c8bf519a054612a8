// SPDX-License-Identifier: Apache-2.0
#include "cli/manual.h"

#include <algorithm>
#include <cctype>
#include <string_view>

#include "cli/verb.h"
#include "scenes/scenes.h"
#include "standoff/io.h"
#include "standoff/sign.h"

namespace standoff::cli {
namespace {

std::string on_one_line(std::string text) {
  std::ranges::replace(text, '\n', ' ');
  return text;
}

// The extensions that a help names, as in "a field file (.vti, .nrrd or .npz)".
std::vector<std::string> extensions_in(const std::string& help) {
  std::vector<std::string> found;
  for (std::size_t at = help.find('.'); at != help.npos; at = help.find('.', at + 1)) {
    if (at == 0 || std::string_view(" \n(").find(help[at - 1]) == std::string_view::npos) continue;
    std::size_t end = at + 1;
    while (end < help.size() && std::isalnum(static_cast<unsigned char>(help[end])) != 0) ++end;
    const std::string extension = help.substr(at + 1, end - at - 1);
    if (!extension.empty() && std::ranges::find(found, extension) == found.end()) found.push_back(extension);
  }
  return found;
}

std::vector<std::string> readable(const std::vector<FileFormat>& formats) {
  std::vector<std::string> found;
  for (const FileFormat& format : formats)
    if (format.readable) found.push_back(format.extension);
  return found;
}

template <class Table>
std::vector<std::string> names_of(const Table& table) {
  std::vector<std::string> names;
  for (const auto& row : table) names.emplace_back(row.name);
  return names;
}

bool is_one_of(const std::string& name, std::initializer_list<const char*> names) {
  return std::ranges::find(names, name) != names.end();
}

// The help of an option says what its value is: by the word that stands for it, and by the extensions that it names.
ManualValue value_of(const CLI::Option& option, const CLI::App& program) {
  ManualValue value;
  const bool positional = option.get_positional();
  value.name = value_name(option);
  if (value.name.empty()) return value;
  const std::string name = positional ? value.name : option.get_name(false);
  if (name == "VERB") {
    for (const CLI::App* verb : program.get_subcommands({})) value.words.push_back(verb->get_name());
  } else if (name == "SCENE") {
    value.words = names_of(scenes::all());
  } else if (name == "SHELL") {
    value.words = {"bash", "zsh", "fish"};
  } else if (name.find("--sign") != name.npos) {
    value.words = names_of(kSignMethods);
  } else if (name.find("--device") != name.npos) {
    value.words = names_of(kBackends);
  } else if (value.name == "FOLDER") {
    value.folders = true;
  } else if (positional || is_one_of(value.name, {"FILE", "FIELD", "MESH", "PNG", "CSV", "ANSWERS"})) {
    value.files = true;
    value.extensions = extensions_in(option.get_description());
    if (value.extensions.empty() && value.name == "FIELD") value.extensions = readable(field_formats());
    if (value.extensions.empty() && value.name == "MESH") value.extensions = readable(mesh_formats());
  }
  return value;
}

ManualPage page_of(const CLI::App& app, const CLI::App& program) {
  ManualPage page;
  page.name = app.get_parent() ? app.get_name() : "";
  const std::string description = app.get_description();
  page.line = description.substr(0, description.find('\n'));
  if (const auto at = description.find("Examples:\n"); at != description.npos)
    page.examples = description.substr(at + std::string_view("Examples:\n").size());
  page.footer = app.get_footer();
  for (const CLI::Option* option : app.get_options()) {
    if (option->get_positional()) {
      page.arguments.push_back({value_of(*option, program), on_one_line(option->get_description()),
                                !option->get_required(), option->get_items_expected_max() > 1});
      continue;
    }
    ManualOption found;
    for (const auto& name : option->get_snames()) found.names.push_back("-" + name);
    for (const auto& name : option->get_lnames()) found.names.push_back("--" + name);
    found.value = value_of(*option, program);
    found.help = on_one_line(option->get_description());
    found.group = option->get_group();
    // A group stands once, though other options may have been added between its own.
    auto place = std::find_if(page.options.rbegin(), page.options.rend(),
                              [&](const ManualOption& other) { return other.group == found.group; });
    page.options.insert(place == page.options.rend() ? page.options.end() : place.base(), std::move(found));
  }
  return page;
}

}  // namespace

std::vector<ManualPage> manual(const CLI::App& program) {
  std::vector<ManualPage> pages{page_of(program, program)};
  for (const CLI::App* verb : program.get_subcommands({})) pages.push_back(page_of(*verb, program));
  return pages;
}

namespace {

// Text as man(7) takes it: no line begins with a dot or a quote, and a hyphen is the one of command lines.
std::string roff(const std::string& text) {
  std::string safe;
  for (const char c : text) {
    const bool line_begins = safe.empty() || safe.back() == '\n';
    if (line_begins && (c == '.' || c == '\'')) safe += "\\&";
    if (c == '\\')
      safe += "\\e";
    else if (c == '-')
      safe += "\\-";
    else
      safe += c;
  }
  return safe;
}

std::string upper(std::string text) {
  std::ranges::transform(text, text.begin(), [](unsigned char c) { return std::toupper(c); });
  return text;
}

std::string full_name(const ManualPage& page) { return page.name.empty() ? "standoff" : "standoff-" + page.name; }

// The paragraph of an option: its names in bold, its value in italics, and its help below.
std::string option_paragraph(const ManualOption& option) {
  std::string text = ".TP\n";
  for (std::size_t n = 0; n < option.names.size(); ++n)
    text += (n == 0 ? "\\fB" : ", \\fB") + roff(option.names[n]) + "\\fR";
  if (!option.value.name.empty()) text += " \\fI" + roff(option.value.name) + "\\fR";
  return text + "\n" + roff(option.help) + "\n";
}

std::string synopsis(const ManualPage& page) {
  if (page.name.empty()) return "\\fBstandoff\\fR \\fIVERB\\fR ...\n";
  std::string text = "\\fBstandoff " + roff(page.name) + "\\fR";
  for (const ManualArgument& argument : page.arguments) {
    const std::string name = "\\fI" + roff(argument.value.name) + "\\fR" + (argument.repeats ? "..." : "");
    text += argument.optional ? " [" + name + "]" : " " + name;
  }
  return text + " [\\fIOPTIONS\\fR]\n";
}

}  // namespace

std::string man_page(const ManualPage& page, const std::vector<ManualPage>& pages) {
  const std::string name = full_name(page);
  std::string text = ".TH " + upper(roff(name)) + " 1 \"\" \"standoff\" \"User commands\"\n.SH NAME\n";
  text +=
      roff(name) + " \\- " + roff(page.name.empty() ? "exact distance fields of triangle meshes" : page.line) + "\n";
  text += ".SH SYNOPSIS\n" + synopsis(page);
  if (!page.arguments.empty()) {
    text += ".SH ARGUMENTS\n";
    for (const ManualArgument& argument : page.arguments)
      text += ".TP\n\\fI" + roff(argument.value.name) + "\\fR\n" + roff(argument.help) + "\n";
  }
  if (page.name.empty()) {
    text += ".SH VERBS\n";
    for (const ManualPage& verb : pages)
      if (!verb.name.empty()) text += ".TP\n\\fB" + roff(verb.name) + "\\fR\n" + roff(verb.line) + "\n";
  }
  text += ".SH OPTIONS\n";
  std::string group = page.options.empty() ? "" : page.options.front().group;
  for (const ManualOption& option : page.options) {
    if (option.group != group) text += ".SS " + roff(option.group) + "\n";
    group = option.group;
    text += option_paragraph(option);
  }
  text += ".SH EXAMPLES\n.nf\n" + roff(page.examples) + ".fi\n";
  text += ".SH EXIT STATUS\n" + roff(page.footer) + "\n.SH SEE ALSO\n";
  std::string others;
  for (const ManualPage& other : pages)
    if (other.name.empty() != page.name.empty())
      others += (others.empty() ? "" : ",\n") + (".BR " + roff(full_name(other)) + " (1)");
  return text + others + "\n";
}

namespace {

// Text in a cell of a table.
std::string in_cell(const std::string& text) {
  std::string safe;
  for (const char c : text) {
    if (std::string_view("|*_<>`\\[]").find(c) != std::string_view::npos) safe += '\\';
    safe += c;
  }
  return safe;
}

std::string row(const std::string& names, const std::string& help) {
  return "| `" + names + "` | " + in_cell(help) + " |\n";
}

std::string table_of(const std::string& heading) { return "\n## " + heading + "\n\n| | |\n|---|---|\n"; }

}  // namespace

std::string markdown_page(const ManualPage& page) {
  std::string text = "# " + (page.name.empty() ? "standoff" : page.name) + "\n\n" + page.line + "\n\n```text\n" +
                     page.examples + "```\n";
  if (!page.arguments.empty()) text += table_of("Arguments");
  for (const ManualArgument& argument : page.arguments)
    text += row(argument.value.name + (argument.repeats ? "..." : ""), argument.help);
  std::string group;
  for (const ManualOption& option : page.options) {
    if (option.group != group) text += table_of(option.group);
    group = option.group;
    std::string names;
    for (const std::string& name : option.names) names += (names.empty() ? "" : ", ") + name;
    text += row(names + (option.value.name.empty() ? "" : " " + option.value.name), option.help);
  }
  return text;
}

}  // namespace standoff::cli
