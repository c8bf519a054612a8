// SPDX-License-Identifier: Apache-2.0
// How shells complete command lines of the program: they ask it what may stand for the word at the cursor.
#include <algorithm>
#include <span>
#include <string>
#include <vector>

#include "cli/manual.h"

namespace standoff::cli {

const char* completion_script(Shell shell) {
  constexpr const char* kBash = R"(_standoff() {
  local cur=${COMP_WORDS[COMP_CWORD]} name lower
  local program=${COMP_WORDS[0]/#~\//$HOME/}
  local -a told
  if [[ $cur == = ]]; then cur=; fi
  type -P -- "$program" >/dev/null || program=standoff
  mapfile -t told < <("$program" completion bash -- "${COMP_WORDS[@]:1:COMP_CWORD}" 2>/dev/null)
  COMPREPLY=()
  case ${told[0]-} in
    words) mapfile -t COMPREPLY < <(compgen -W "${told[*]:1}" -- "$cur") ;;
    folders)
      compopt -o filenames 2>/dev/null
      mapfile -t COMPREPLY < <(compgen -d -- "$cur") ;;
    files*)
      compopt -o filenames 2>/dev/null
      while IFS= read -r name; do
        lower=${name,,}
        if [[ -d ${name/#~\//$HOME/} || ${told[0]} == files || $lower =~ \.(${told[0]#files })(\.gz)?$ ]]; then
          COMPREPLY+=("$name")
        fi
      done < <(compgen -f -- "$cur") ;;
  esac
}
complete -F _standoff standoff
)";
  constexpr const char* kZsh = R"zsh(#compdef standoff
_standoff() {
  local -a told
  told=("${(@f)$(${(Q)~words[1]} completion zsh -- "${(@)words[2,CURRENT]}" 2>/dev/null)}")
  compset -P 1 '--*='
  case $told[1] in
    words) shift told; _describe -t words word told ;;
    folders) _files -/ ;;
    files) _files ;;
    files*) _files -g "(#i)*.(${told[1]#files })(|.gz)(-.)" ;;
  esac
}
if [[ $funcstack[1] == _standoff ]]; then _standoff "$@"; else compdef _standoff standoff; fi
)zsh";
  constexpr const char* kFish = R"(function __standoff_complete
    set -l words (commandline -opc)
    set -l word (commandline -ct)
    set -l program (string replace -r '^~(?=/)' $HOME -- $words[1])
    type -q $program; or return
    set -l told ($program completion fish -- $words[2..-1] "$word" 2>/dev/null)
    set -l name (string match -r -- '^--[^=]*=' "$word")
    set -l end '.*'
    switch "$told[1]"
        case ''
            return
        case words
            set -q told[2]; and printf "$name%s\n" $told[2..-1]
            return
        case folders
            set end /
        case 'files *'
            set end '\.('(string sub -s 7 -- $told[1])')(\.gz)?'
    end
    # Of those that fish offers: it knows about quotes and homes.
    for line in (complete -C "__fish_command_without_completions "(string replace -r -- '^--[^=]*=' '' "$word"))
        set -l found (string split -m 1 \t -- $line)[1]
        string match -qir -- "(/|$end)\$" $found; and echo "$name$found"
    end
end
complete -c standoff -f -k -a '(__standoff_complete)'
)";
  return shell == Shell::bash ? kBash : shell == Shell::zsh ? kZsh : kFish;
}

namespace {

// A name that may stand there, with its help as the shell takes it.
std::string line_of(Shell shell, std::string name, const std::string& help) {
  if (shell == Shell::zsh)
    for (std::size_t at = 0; (at = name.find(':', at)) != name.npos; at += 2) name.insert(at, "\\");
  return name + (shell == Shell::bash || help.empty() ? "" : (shell == Shell::zsh ? ":" : "\t") + help) + "\n";
}

std::string answer(Shell shell, const ManualValue& value) {
  if (value.folders) return "folders\n";
  std::string text = value.files ? "files" : "words\n";
  for (const std::string& word : value.words) text += line_of(shell, word, "");
  for (const std::string& extension : value.extensions) text += (text == "files" ? " " : "|") + extension;
  return value.files ? text + "\n" : text;
}

// The words, but two for --name=value, which some shells part in three, and one for a:b, which bash parts in three.
std::vector<std::string> parted(const std::vector<std::string>& words, Shell shell) {
  std::vector<std::string> all;
  bool follows_colon = false;
  for (const std::string& word : words) {
    const bool is_colon = shell == Shell::bash && word == ":" && !all.empty();
    if (is_colon || follows_colon) {
      all.back() += word;
      follows_colon = is_colon;
      continue;
    }
    const std::size_t equals = word.starts_with("--") ? word.find('=') : word.npos;
    if (word != "=") all.push_back(word.substr(0, equals));
    if (equals != word.npos) all.push_back(word.substr(equals + 1));
  }
  if (words.empty() || words.back() == "=") all.emplace_back();
  return all;
}

}  // namespace

std::string completions(const std::vector<ManualPage>& pages, Shell shell, const std::vector<std::string>& given) {
  const std::vector<std::string> words = parted(given, shell);
  const ManualPage* page = &pages.front();
  const ManualValue* value = nullptr;  // of the option before
  bool only_arguments = false;
  std::size_t arguments = 0;
  for (const std::string& word : std::span(words).first(words.size() - 1)) {
    if (value) {
      value = nullptr;
    } else if (word == "--" && !only_arguments) {
      only_arguments = true;
    } else if (word.starts_with('-') && !only_arguments) {
      for (const ManualOption& option : page->options)
        if (!option.value.name.empty() && std::ranges::find(option.names, word) != option.names.end())
          value = &option.value;
    } else if (page->name.empty()) {
      const auto verb = std::ranges::find(pages, word, &ManualPage::name);
      if (verb == pages.end()) return "";
      page = &*verb;
    } else {
      ++arguments;
    }
  }
  if (value) return answer(shell, *value);
  std::string text = "words\n";
  if (words.back().starts_with('-') && !only_arguments) {
    for (const ManualOption& option : page->options)
      for (const std::string& name : option.names) text += line_of(shell, name, option.help);
  } else if (page->name.empty()) {
    for (const ManualPage& verb : pages)
      if (!verb.name.empty()) text += line_of(shell, verb.name, verb.line);
  } else if (!page->arguments.empty()) {
    const ManualArgument& last = page->arguments.back();
    if (arguments < page->arguments.size()) return answer(shell, page->arguments[arguments].value);
    if (last.repeats) return answer(shell, last.value);
  }
  return text;
}

}  // namespace standoff::cli
