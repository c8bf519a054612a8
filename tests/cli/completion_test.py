#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""The manual's pages and the completions of shells have every verb and option that the help has, and complete in real
shells. What needs zsh, fish or a program that checks pages is skipped, with a line, where there is none."""

import os
import pty
import re
import select
import shutil
import signal
import subprocess
import unittest
from pathlib import Path

from program import STANDOFF, run

HOME_HERE = dict(os.environ, HOME=os.getcwd(), PATH=f"{Path(STANDOFF).parent}:{os.environ['PATH']}")


def told(*arguments):
    return run(*arguments).stdout


VERBS = re.findall(r"^  (\w+) ", told("help").split("\nVerbs:\n")[1].split("\n\n")[0], re.MULTILINE)
OPTIONS = {
    verb: re.findall(r"(?:^  |,)(--?[\w-]+)", told("help", verb).split("\nOptions:")[1], re.MULTILINE) for verb in VERBS
}
SCRIPTS = {shell: told("completion", shell) for shell in ("bash", "zsh", "fish")}


def needs(program):
    return unittest.skipUnless(shutil.which(program), f"there is no {program} here")


class Completion(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        for shell, script in SCRIPTS.items():
            Path(f"completion.{shell}").write_text(script)
        for name in ("bunny.obj", "bunny.vti", "part.STL", "scan.ply.gz", "notes.txt", "two words.obj", "p.csv"):
            Path(name).touch()
        Path("folder").mkdir(exist_ok=True)
        Path("folder/a=b.vti").touch()
        if not Path("folder/standoff").exists():
            Path("folder/standoff").symlink_to(Path(STANDOFF).resolve())

    def bash(self, *words, program="standoff"):
        """What bash offers for the last of the words, which readline parts at = and : too."""
        words = [program, *words]
        script = (
            'set -u; source completion.bash; COMP_WORDS=("$@"); COMP_CWORD=$(($# - 1)); _standoff; '
            '((${#COMPREPLY[@]})) && printf "%s\\n" "${COMPREPLY[@]}"; true'
        )
        ran = subprocess.run(
            ["bash", "--norc", "-c", script, "bash", *words], check=True, capture_output=True, text=True, env=HOME_HERE
        )
        self.assertEqual(ran.stderr, "")
        return set(ran.stdout.splitlines())

    def test_the_help_was_understood(self):
        self.assertGreater(len(VERBS), 20)
        self.assertIn("--resolution", OPTIONS["compute"])
        self.assertIn("-r", OPTIONS["compute"])
        self.assertIn("--sign", OPTIONS["points"])

    def test_bash_offers_every_verb_and_option(self):
        self.assertEqual(self.bash(""), set(VERBS))
        self.assertEqual(self.bash("com"), {"compute", "completion"})
        for verb in VERBS:
            offered = self.bash(verb, "-")
            self.assertEqual({name for name in OPTIONS[verb] if name.startswith("--")} - offered, set(), verb)
        self.assertEqual(self.bash("compute", "--reso"), {"--resolution"})
        self.assertEqual(self.bash("--v"), {"--version"})

    def test_bash_offers_files_by_the_verb(self):
        meshes = {"bunny.obj", "part.STL", "scan.ply.gz", "two words.obj", "folder"}
        self.assertEqual(self.bash("compute", ""), meshes)
        self.assertEqual(self.bash("-v", "compute", "b"), {"bunny.obj"})
        self.assertEqual(self.bash("slice", "b"), {"bunny.vti"})
        self.assertEqual(self.bash("verify", "bunny.vti", "b"), {"bunny.obj"})
        self.assertEqual(self.bash("verify", "--samples", "10", "bunny.vti", "b"), {"bunny.obj"})
        self.assertEqual(self.bash("points", "bunny.obj", "p"), {"p.csv"})
        self.assertEqual(self.bash("view", "bunny.obj", "bunny.vti", "b"), {"bunny.obj", "bunny.vti"})
        self.assertEqual(self.bash("compute", "bunny.obj", "-o", "b"), {"bunny.vti"})
        self.assertEqual(self.bash("compute", "bunny.obj", "--output", "=", "b"), {"bunny.vti"})
        self.assertEqual(self.bash("compute", "bunny.obj", "--output", "="), {"bunny.vti", "folder"})
        self.assertEqual(self.bash("compute", "bunny.obj", "--cache", ""), {"folder"})
        self.assertEqual(self.bash("compute", "bunny.obj", "-r", ""), set())
        # An option that has its value is done with.
        self.assertEqual(self.bash("compute", "-r", "64", "b"), {"bunny.obj"})
        self.assertEqual(self.bash("compute", "--sign", "flood", "b"), {"bunny.obj"})
        self.assertEqual(self.bash("compute", "-o", "=", "x.vti", "b"), {"bunny.obj"})
        self.assertEqual(self.bash("compute", "--", "-"), set())
        self.assertEqual(self.bash("compute", "~/fold"), {"~/folder"})
        self.assertEqual(self.bash("points", "scene", ":", "fly", "p"), {"p.csv"})

    def test_bash_asks_the_program_that_is_typed_or_the_one_on_the_path(self):
        for program in ("~/folder/standoff", "./folder/standoff", "an_alias", "$HOME/folder/standoff"):
            self.assertEqual(self.bash("slice", "b", program=program), {"bunny.vti"}, program)
        self.assertEqual(self.bash("nosuch", "b"), set())

    def test_bash_offers_names(self):
        self.assertIn("winding", self.bash("compute", "--sign", ""))
        self.assertEqual(self.bash("compute", "--device", "cu"), {"cuda"})
        self.assertEqual(self.bash("generate", "laby"), {"labyrinth"})
        self.assertEqual(self.bash("help", "inf"), {"info"})
        self.assertEqual(self.bash("completion", ""), {"bash", "zsh", "fish"})

    def test_zsh_and_fish_are_told_every_verb_and_option_with_its_help(self):
        for shell, between in (("zsh", ":"), ("fish", "\t")):
            lines = told("completion", shell, "--", "").splitlines()
            self.assertEqual([line.split(between)[0] for line in lines], ["words", *VERBS])
            for verb in VERBS:
                lines = told("completion", shell, "--", verb, "-").splitlines()
                helps = dict(line.split(between, 1) for line in lines[1:])
                self.assertEqual(set(OPTIONS[verb]) - {"words", *helps}, set(), verb)
                self.assertTrue(all(helps.values()), verb)

    @needs("zsh")
    def test_zsh_reads_it(self):
        subprocess.run(["zsh", "-fn", "completion.zsh"], check=True)
        script = "autoload -U compinit; compinit -D -u; source ./completion.zsh; print -r -- $_comps[standoff]"
        ran = subprocess.run(["zsh", "-fc", script], check=True, capture_output=True, text=True)
        self.assertEqual((ran.stdout, ran.stderr), ("_standoff\n", ""))

    @needs("zsh")
    def test_zsh_completes(self):
        """What becomes of a line at zsh's own terminal when its end is completed."""
        setup = (
            "PROMPT= PS2= RPS1=; autoload -U compinit; compinit -D -u; source ./completion.zsh; "
            "show() { print -r -- \"<$BUFFER>\" }; zle -N show; bindkey '^X' show; print RE''ADY\n"
        )

        def becomes(line):
            process, terminal = pty.fork()
            if process == 0:
                os.execvpe("zsh", ["zsh", "-fi"], {**HOME_HERE, "TERM": "dumb"})

            def until(pattern):
                said = ""
                while not (found := re.search(pattern, said)):
                    self.assertTrue(select.select([terminal], [], [], 20)[0], said)
                    said += os.read(terminal, 4096).decode(errors="replace")
                return found

            try:
                os.write(terminal, setup.encode())
                until("READY\r\n")
                os.write(terminal, line.encode() + b"\t\x18")
                return until("<(standoff[^>]*)>")[1]
            finally:
                os.close(terminal)
                os.kill(process, signal.SIGKILL)
                os.waitpid(process, 0)

        self.assertEqual(becomes("standoff compute --sign=flo").strip(), "standoff compute --sign=flood")
        self.assertEqual(becomes("standoff compute --sign flo").strip(), "standoff compute --sign flood")
        self.assertEqual(becomes("standoff compute -- bunny.o").strip(), "standoff compute -- bunny.obj")
        self.assertEqual(becomes("standoff compute -- --reso").strip(), "standoff compute -- --reso")
        of_a_name = "standoff compute bunny.obj --output=folder/a="
        self.assertEqual(becomes(of_a_name).strip(), of_a_name + "b.vti")
        self.assertEqual(becomes("standoff compute --reso").strip(), "standoff compute --resolution")
        self.assertEqual(becomes("standoff -v slice b").strip(), "standoff -v slice bunny.vti")
        self.assertEqual(becomes("standoff comple").strip(), "standoff completion")

    @needs("fish")
    def test_fish_completes(self):
        def offered(line):
            script = f"source completion.fish; complete -C '{line}'"
            home = dict(HOME_HERE, XDG_CONFIG_HOME=os.getcwd(), XDG_DATA_HOME=os.getcwd())
            ran = subprocess.run(["fish", "-N", "-c", script], check=True, capture_output=True, text=True, env=home)
            self.assertEqual(ran.stderr, "")
            return {row.split("\t")[0] for row in ran.stdout.splitlines()}

        self.assertTrue(set(VERBS) <= offered("standoff "))
        self.assertEqual(offered("standoff slice b"), {"bunny.vti"})
        self.assertEqual(offered("standoff compute bunny.obj -o b"), {"bunny.vti"})
        self.assertTrue({"--resolution", "--sign"} <= offered("standoff compute --"))
        self.assertEqual(offered("standoff points bunny.obj p"), {"p.csv"})
        self.assertIn("winding", offered("standoff compute --sign "))
        self.assertEqual(offered('standoff compute "two w'), {"two words.obj"})
        self.assertEqual(offered("standoff compute ~/fold"), {"~/folder/"})
        self.assertEqual(offered("standoff compute --sign=wi"), {"--sign=winding"})
        self.assertEqual(offered("standoff compute bunny.obj --output=b"), {"--output=bunny.vti"})
        self.assertEqual(offered("standoff compute --cache fo"), {"folder/"})
        self.assertEqual(offered("~/folder/standoff slice b"), {"bunny.vti"})
        self.assertEqual(offered("nosuch/standoff slice b"), set())

    def test_the_manual_has_every_verb_and_option(self):
        self.assertEqual(told("man", "--list").split(), VERBS)
        page = told("man")
        for verb in VERBS:
            self.assertIn(f"\n.TP\n\\fB{verb}\\fR\n", page)
            verb_page = told("man", verb)
            self.assertTrue(verb_page.startswith(f".TH STANDOFF\\-{verb.upper()} 1 "), verb)
            missing = [name for name in OPTIONS[verb] if "\\fB" + name.replace("-", "\\-") + "\\fR" not in verb_page]
            self.assertEqual(missing, [], verb)
            self.assertIn(".SH EXIT STATUS\n", verb_page)
            rows = [line.split("` |")[0] for line in told("man", verb, "--markdown").splitlines() if line.startswith("| `")]
            headings = re.findall(r"^## .*$", told("man", verb, "--markdown"), re.M)
            self.assertEqual(len(headings), len(set(headings)), f"{verb}: a group stands once")
            names = {name for row in rows for name in re.findall(r"-+[\w-]+", row)}
            self.assertEqual(set(OPTIONS[verb]) - names, set(), verb)
            self.assertIn(f"standoff {verb}".replace("-", "\\-"), verb_page.split(".SH EXAMPLES\n")[1])

    def check_pages(self, *command):
        for verb in ("", *VERBS):
            Path("page.1").write_text(told("man", *filter(None, [verb])))
            ran = subprocess.run(
                [*command, "page.1"], capture_output=True, text=True, env={**os.environ, "LC_ALL": "C.UTF-8"}
            )
            said = (ran.stdout if command[0] == "mandoc" else "") + ran.stderr
            # A page has no date of its own: it is as old as the program that prints it.
            faults = [line for line in said.splitlines() if "missing date" not in line]
            self.assertEqual(faults, [], verb)

    @needs("mandoc")
    def test_mandoc_finds_no_fault(self):
        self.check_pages("mandoc", "-Tlint", "-Wwarning")

    @needs("groff")
    def test_groff_finds_no_fault(self):
        self.check_pages("groff", "-man", "-Tutf8", "-ww", "-z")

    def test_misuse(self):
        for words, message in (
            (["completion"], "SHELL is required"),
            (["completion", "tcsh"], "completion 'tcsh': give bash, zsh or fish"),
            (["man", "compuet"], "'compuet' is no verb; did you mean 'compute'?"),
            (["man", "foo"], "'foo' is no verb; see standoff man --list"),
        ):
            ran = subprocess.run([STANDOFF, *words], capture_output=True, text=True)
            self.assertEqual(ran.returncode, 2)
            self.assertIn(message, ran.stderr)


if __name__ == "__main__":
    unittest.main(verbosity=0)
