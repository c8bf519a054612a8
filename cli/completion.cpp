// SPDX-License-Identifier: Apache-2.0
// The scripts by which shells complete command lines of the program. Each holds the same: verbs; the options of a verb;
// what stands for the value of an option, and for the arguments in their order.
#include <string>
#include <vector>

#include "cli/manual.h"

namespace standoff::cli {
namespace {

std::string with_between(const std::vector<std::string>& words, const std::string& between) {
  std::string text;
  for (const std::string& word : words) text += (text.empty() ? "" : between) + word;
  return text;
}

// In single quotes of a shell.
std::string quoted(const std::string& text) {
  std::string safe = "'";
  for (const char c : text)
    if (c == '\'')
      safe += "'\\''";
    else
      safe += c;
  return safe + "'";
}

constexpr const char* kFirstLine = "# Made by standoff completion %, out of the tables that its help comes from.\n";

std::string first_line(const std::string& shell) {
  std::string line = kFirstLine;
  return line.replace(line.find('%'), 1, shell);
}

// The bash command that completes a value.
std::string bash_value(const ManualValue& value) {
  if (!value.words.empty()) return "_standoff_words " + quoted(with_between(value.words, " "));
  if (value.folders) return "_standoff_folders";
  if (value.files) return "_standoff_files " + quoted(with_between(value.extensions, "|"));
  return ":";
}

// With `asking` these offer nothing: then it only matters which of them is called.
constexpr const char* kBashHelpers = R"(
_standoff_words() { [[ $asking ]] || mapfile -t COMPREPLY < <(compgen -W "$1" -- "$cur"); }
_standoff_folders() {
  if [[ $asking ]]; then return; fi
  compopt -o filenames 2>/dev/null
  mapfile -t COMPREPLY < <(compgen -d -- "$cur")
}
# Files of these extensions, with bars between, and folders to look into; without extensions any file.
_standoff_files() {
  local name lower
  if [[ $asking ]]; then return; fi
  compopt -o filenames 2>/dev/null
  while IFS= read -r name; do
    lower=${name,,}
    if [[ -d ${name/#~\//$HOME/} || -z $1 || $lower =~ \.($1)(\.gz)?$ ]]; then COMPREPLY+=("$name"); fi
  done < <(compgen -f -- "$cur")
}
)";

}  // namespace

std::string bash_completion(const std::vector<ManualPage>& pages) {
  std::string verbs, options, values, arguments;
  for (const ManualPage& page : pages) {
    std::vector<std::string> names;
    for (const ManualOption& option : page.options) {
      for (const std::string& name : option.names)
        if (name.starts_with("--") || option.names.size() == 1) names.push_back(name);
      if (option.value.name.empty()) continue;
      std::vector<std::string> patterns;
      for (const std::string& name : option.names) patterns.push_back(page.name + ":" + name);
      values += "    " + with_between(patterns, "|") + ") " + bash_value(option.value) + " ;;\n";
    }
    options +=
        "    " + (page.name.empty() ? "''" : page.name) + ") options=" + quoted(with_between(names, " ")) + " ;;\n";
    if (page.name.empty()) continue;
    verbs += (verbs.empty() ? "" : " ") + page.name;
    for (std::size_t n = 0; n < page.arguments.size(); ++n)
      arguments += "    " + page.name + ":" + (page.arguments[n].repeats ? "*" : std::to_string(n)) + ") " +
                   bash_value(page.arguments[n].value) + " ;;\n";
  }
  return first_line("bash") + kBashHelpers + R"(
# Completes the value of the option $1 of the verb; false where it takes none.
_standoff_value() {
  case $verb:$1 in
)" + values +
         R"(    *) return 1 ;;
  esac
}
_standoff_takes_value() {
  local asking=yes
  _standoff_value "$1"
}
_standoff() {
  local cur=${COMP_WORDS[COMP_CWORD]} verb= options= asking= word= option= n=0 only_arguments=
  local -i at
  COMPREPLY=()
  for ((at = 1; at < COMP_CWORD; ++at)); do
    word=${COMP_WORDS[at]}
    if [[ -z $verb ]]; then
      [[ $word == -* ]] || verb=$word
    elif [[ $word == -- && -z $only_arguments ]]; then
      only_arguments=yes
    elif [[ $word == -* && -z $only_arguments ]]; then
      if _standoff_takes_value "$word"; then
        ((++at))
        [[ ${COMP_WORDS[at]} == = ]] && ((++at))
        if ((at >= COMP_CWORD)); then option=$word; fi  # whose value is at the cursor
      fi
    else
      ((++n))
    fi
  done
  if [[ $cur == = ]]; then cur=; fi
  if [[ $option ]] && _standoff_value "$option"; then return; fi
  case $verb in
)" + options +
         R"(  esac
  if [[ $cur == -* && -z $only_arguments ]]; then
    _standoff_words "$options"
  elif [[ -z $verb ]]; then
    _standoff_words ')" +
         verbs + R"('
  else
    case $verb:$n in
)" + arguments +
         R"(    esac
  fi
}
complete -F _standoff standoff
)";
}

namespace {

// Of an entry of _arguments: brackets and colons part it.
std::string zsh_text(const std::string& text) {
  std::string safe;
  for (const char c : text) {
    if (c == '[' || c == ']' || c == ':' || c == '\\') safe += '\\';
    safe += c;
  }
  return safe;
}

// ":FIELD:_files -g .." after what is described.
std::string zsh_value(const ManualValue& value) {
  if (value.name.empty()) return "";
  std::string action;
  if (!value.words.empty())
    action = "(" + with_between(value.words, " ") + ")";
  else if (value.folders)
    action = "_files -/";
  else if (value.files && value.extensions.empty())
    action = "_files";
  else if (value.files)
    action = "_files -g \"(#i)*.(" + with_between(value.extensions, "|") + ")(|.gz)(-.)\"";
  return ":" + zsh_text(value.name) + ":" + action;
}

// A value may stand behind the name with = between, or in the same word behind a letter.
std::string zsh_option(const ManualOption& option) {
  const std::string rest = "[" + zsh_text(option.help) + "]" + zsh_value(option.value);
  std::vector<std::string> names = option.names;
  if (!option.value.name.empty())
    for (std::string& name : names) name += name.starts_with("--") ? "=" : "+";
  if (names.size() == 1) return quoted(names.front() + rest);
  return quoted("(" + with_between(option.names, " ") + ")") + "{" + with_between(names, ",") + "}" + quoted(rest);
}

}  // namespace

std::string zsh_completion(const std::vector<ManualPage>& pages) {
  std::string verbs, cases;
  for (const ManualPage& page : pages) {
    if (page.name.empty()) continue;
    verbs += "    " + quoted(page.name + ":" + page.line) + "\n";
    cases += "    " + page.name + ")\n      _arguments -S";
    for (const ManualOption& option : page.options) cases += " \\\n        " + zsh_option(option);
    for (std::size_t n = 0; n < page.arguments.size(); ++n)
      cases += " \\\n        " +
               quoted((page.arguments[n].repeats ? "*" : std::to_string(n + 1)) + zsh_value(page.arguments[n].value));
    cases += "\n      ;;\n";
  }
  std::string program;
  for (const ManualOption& option : pages.front().options) program += " \\\n    " + zsh_option(option);
  return "#compdef standoff\n" + first_line("zsh") + R"(
_standoff() {
  local curcontext=$curcontext state line
  local -a verbs
  verbs=(
)" + verbs +
         R"(  )
  _arguments -C)" +
         program + R"( \
    '1: :->verb' '*:: :->arguments'
  if [[ $state == verb ]]; then
    _describe -t verbs verb verbs
    return
  fi
  [[ $state == arguments ]] || return
  case $words[1] in
)" + cases +
         R"(  esac
}

if [[ $funcstack[1] == _standoff ]]; then
  _standoff "$@"
else
  compdef _standoff standoff
fi
)";
}

namespace {

// The arguments of complete that say what the value of an option, or an argument of a verb, may be.
std::string fish_value(const ManualValue& value) {
  if (!value.words.empty()) return " -x -a " + quoted(with_between(value.words, " "));
  if (value.folders) return " -x -a '(__fish_complete_directories)'";
  if (value.files && value.extensions.empty()) return " -r -F";
  if (value.files) {
    std::string suffixes;
    for (const std::string& extension : value.extensions) suffixes += " ." + extension;
    return " -x -k -a '(__standoff_files" + suffixes + ")'";
  }
  return value.name.empty() ? "" : " -x";
}

constexpr const char* kFishHelpers = R"(
# Files of these extensions, and folders to look into, of those that fish offers: it knows about quotes and homes.
function __standoff_files
    for line in (complete -C "__fish_command_without_completions "(commandline -ct))
        set -l name (string split -m 1 \t -- $line)[1]
        string match -q -- '*/' $name; and echo $name
        for extension in $argv
            string match -qir -- (string escape --style=regex $extension)'(\.gz)?$' $name; and echo $name
        end
    end
end
# Whether the verb is $argv[1], and so many arguments stand behind it as $argv[2] says; without it any number. The
# values of options are counted as arguments where they stand apart: a verb's last argument is offered for all beyond.
function __standoff_verb
    set -l words (commandline -opc)
    set -l verb
    set -l count 0
    for word in $words[2..-1]
        string match -q -- '-*' $word; and continue
        if test -z "$verb"
            set verb $word
        else
            set count (math $count + 1)
        end
    end
    test "$verb" = $argv[1]; or return 1
    set -q argv[2]; or return 0
    test $count -ge $argv[2]
end
complete -c standoff -f
)";

}  // namespace

std::string fish_completion(const std::vector<ManualPage>& pages) {
  std::string text = first_line("fish") + kFishHelpers;
  for (const ManualPage& page : pages) {
    const bool program = page.name.empty();
    const std::string begin =
        "complete -c standoff -n " + quoted(program ? "__fish_use_subcommand" : "__standoff_verb " + page.name);
    if (!program)
      text += "complete -c standoff -n __fish_use_subcommand -a " + page.name + " -d " + quoted(page.line) + "\n";
    for (const ManualOption& option : page.options) {
      text += begin;
      for (const std::string& name : option.names)
        text += name.starts_with("--") ? " -l " + name.substr(2) : " -s " + name.substr(1);
      text += fish_value(option.value) + " -d " + quoted(option.help) + "\n";
    }
    for (std::size_t n = 0; n < page.arguments.size(); ++n) {
      const std::string count = n == 0 ? "" : " " + std::to_string(n);
      text += "complete -c standoff -n " + quoted("__standoff_verb " + page.name + count) +
              fish_value(page.arguments[n].value) + "\n";
    }
  }
  return text;
}

}  // namespace standoff::cli
