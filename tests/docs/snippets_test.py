# SPDX-License-Identifier: Apache-2.0
"""What README.md and docs/*.md show in fenced blocks is run as it stands there.

README.md is one session in a shell, from the clone to a program that uses the library, in an empty folder that is also the
home. Two of its commands get stand-ins: `git clone` copies this source tree, without its bootstrap, and `cmake` passes over the
building of what is built already. The demo, the installation and the user's program are real.

Of each of docs/*.md the blocks of sh run in order in a folder of its own with bunny.obj; of the project's own scripts the help
is asked for. The blocks of cpp are compiled with the library that README.md's session installed and run; without a main they are the inside of
one. Blocks of text are passed over."""
# labels: builds
import os
import pathlib
import re
import shlex
import shutil
import subprocess
import sys

from snippets import PAGES, README, blocks, session

SOURCE = pathlib.Path(os.environ["STANDOFF_SOURCE_DIR"])
BUILD = pathlib.Path(os.environ["STANDOFF"]).parent
MODELS = pathlib.Path("/usr/share/glmark2/models")
PROJECT = """cmake_minimum_required(VERSION 3.22)
project(app LANGUAGES CXX)
find_package(standoff REQUIRED)
add_executable(app app.cpp)
target_link_libraries(app PRIVATE standoff::standoff)
"""
GIT = f"""#!/usr/bin/env bash
set -eu
[[ $1 == clone && $2 == https://example.org/standoff ]]
mkdir -p "$3/build"
cp -r {SOURCE}/script "$3/"
for entry in {SOURCE}/*; do [[ -e $3/${{entry##*/}} || $entry == */out ]] || ln -s "$entry" "$3/"; done
printf '#!/bin/sh\\nexit 0\\n' > "$3/script/bootstrap"
ln -s {BUILD} "$3/build/demo"
"""
CMAKE = f"""#!/usr/bin/env bash
case "$*" in
  "--preset demo" | "--build build/demo"*) exit 0 ;;
  *) exec {shutil.which("cmake")} "$@" ;;
esac
"""


def run(where, *command, **how):
    print(f"{where}: {shlex.join(map(str, command))}", flush=True)
    done = subprocess.run(command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, **how)
    if done.returncode != 0:
        sys.exit(f"{where}: exit code {done.returncode}\n{done.stdout}")
    return done.stdout


def run_readme(home):
    stand_ins = home / "bin"
    stand_ins.mkdir()
    for name, text in (("git", GIT), ("cmake", CMAKE)):
        (stand_ins / name).write_text(text)
        (stand_ins / name).chmod(0o755)
    script = session(README).replace("\nscript/test", "\nscript/test --help")
    # Nothing of this test's own surroundings: what a new user has not set is not set.
    path = f"{stand_ins}:/usr/local/bin:/usr/bin:/bin"
    said = run("README.md", "bash", "-c", script, cwd=home,
               env={"HOME": str(home), "PATH": path, "URL": "https://example.org/standoff", "PYTHON": ""})
    for name in ("out/bunny.vti", "out/bunny.png", "out/horse.vti", "out/band.npz", "out/band.png", "app/bunny.vti"):
        if not (home / "standoff" / name).stat().st_size:
            sys.exit(f"README.md: {name} is empty")
    # Were the blocks called otherwise one day, nothing would be run and nothing would fail.
    commands = len(re.findall(r"^\++ (?:standoff|script/|cmake|git|build/app)", said, re.M))
    if commands < 12:
        sys.exit(f"README.md: only {commands} commands ran; are its blocks still marked sh?\n{said}")


def run_shell_of(page, folder):
    script = ["set -euo pipefail"]
    for language, text, _ in blocks(page):
        if language == "sh":
            script += [re.sub(r"^(script/[\w-]+).*", rf'"{SOURCE}"/\1 --help >/dev/null', line) for line in text.splitlines()]
    if len(script) > 1:
        path = f"{BUILD}:{os.environ['PATH']}"
        run(page.name, "bash", "-c", "\n".join(script), cwd=folder, env={**os.environ, "PATH": path})


def with_main(text):
    if re.search(r"\bint main\b", text):
        return text
    lines = text.splitlines()
    inside = [line for line in lines if not line.startswith("#")]
    return "\n".join([line for line in lines if line.startswith("#")] + ["int main() {", *inside, "}", ""])


def run_programs_of(page, folder, home):
    for n, (language, text, _) in enumerate(blocks(page)):
        if language == "cpp":
            app = folder / f"{page.stem}{n}"
            app.mkdir()
            (app / "app.cpp").write_text(with_main(text))
            (app / "CMakeLists.txt").write_text(PROJECT)
            run(page.name, "cmake", "-S", app, "-B", app / "build", f"-DCMAKE_PREFIX_PATH={home / '.local'}")
            run(page.name, "cmake", "--build", app / "build")
            run(page.name, app / "build" / "app", cwd=folder)


def main():
    if not (MODELS / "bunny.obj").exists():
        sys.exit(f"no {MODELS}: the demo's meshes are missing; run script/bootstrap build")
    home = pathlib.Path("home").resolve()
    home.mkdir()
    run_readme(home)
    for page in PAGES:
        folder = pathlib.Path("docs", page.stem).resolve()
        folder.mkdir(parents=True)
        shutil.copy(MODELS / "bunny.obj", folder)
        run_shell_of(page, folder)
        run_programs_of(page, folder, home)


main()
