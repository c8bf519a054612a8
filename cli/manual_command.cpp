// SPDX-License-Identifier: Apache-2.0
// standoff completion: the script by which a shell completes command lines. standoff man: a page of the manual.
#include <algorithm>
#include <memory>
#include <string>
#include <vector>

#include "cli/console.h"
#include "cli/manual.h"
#include "cli/parse.h"
#include "cli/suggest.h"
#include "cli/verb.h"
#include "standoff/error.h"

namespace standoff::cli {
namespace {

constexpr const char* kCompletionExamples =
    R"(  standoff completion bash >~/.local/share/bash-completion/completions/standoff
  standoff completion zsh >~/.zsh/_standoff                 in a folder of $fpath
  standoff completion fish >~/.config/fish/completions/standoff.fish
  source <(standoff completion bash)                        for this shell alone
)";

constexpr const char* kManExamples = R"(  standoff man | man -l -                    the page of the program
  standoff man compute | man -l -            that of a verb
  standoff man --list                        the verbs that have one
  standoff man compute --markdown            the same for a site
)";

void print_page(const CLI::App& program, const std::string& verb, bool markdown) {
  const std::vector<ManualPage> pages = manual(program);
  const auto found = std::ranges::find(pages, verb, &ManualPage::name);
  if (found != pages.end()) return print(markdown ? markdown_page(*found) : man_page(*found, pages));
  std::vector<std::string> verbs;
  for (const ManualPage& page : pages)
    if (!page.name.empty()) verbs.push_back(page.name);
  const std::string near = did_you_mean(verb, verbs);
  throw Error(ErrorCode::usage, "man: '" + verb + "' is no verb" + (near.empty() ? "; see standoff man --list" : near));
}

}  // namespace

void add_completion(CLI::App& program) {
  auto* verb =
      add_verb(program, "completion", "print the script that completes command lines in a shell", kCompletionExamples);
  const auto shell = std::make_shared<std::string>();
  const auto words = std::make_shared<std::vector<std::string>>();
  verb->add_option("SHELL", *shell, "bash, zsh or fish")->required();
  auto* const line =
      verb->add_option("WORD", *words, "of a command line: what may stand for the last, as the script asks");
  verb->callback([&program, shell, words, line] {
    const auto which = static_cast<Shell>(parse_choice("completion", *shell, {"bash", "zsh", "fish"}));
    print(line->count() == 0 ? completion_script(which) : completions(manual(program), which, *words));
  });
}

void add_man(CLI::App& program) {
  auto* verb = add_verb(program, "man", "print a page of the manual, for man", kManExamples);
  const auto about = std::make_shared<std::string>();
  const auto list = std::make_shared<bool>(false), markdown = std::make_shared<bool>(false);
  verb->add_option("VERB", *about, "a verb (default: the program)");
  verb->add_flag("--list", *list, "print the names of the verbs instead");
  verb->add_flag("--markdown", *markdown, "in Markdown");
  verb->callback([&program, about, list, markdown] {
    if (!*list) return print_page(program, *about, *markdown);
    std::string text;
    for (const ManualPage& page : manual(program))
      if (!page.name.empty()) text += page.name + "\n";
    print(text);
  });
}

}  // namespace standoff::cli
