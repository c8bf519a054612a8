"""What README.md and docs/*.md show in fenced blocks is run as it stands there.

sh     lines `standoff ...` are run, in order; of the project's own scripts the help is asked for
cpp    is compiled, linked as the README's cmake block says, and run; without a main it is the inside of one
cmake  is a project's way to standoff, tried with the cpp blocks
text, and blocks without a language, are pictures of text and passed over.
"""
import os
import pathlib
import re
import shlex
import shutil
import subprocess
import sys

SOURCE = pathlib.Path(os.environ["STANDOFF_SOURCE_DIR"])
PROGRAM = pathlib.Path(os.environ["STANDOFF"])
MODELS = pathlib.Path("/usr/share/glmark2/models")
# A mesh where the package with the README's is not installed: two triangles.
STAND_IN = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 1 1 0.5\nf 1 2 3\nf 2 4 3\n"
PROJECT = """cmake_minimum_required(VERSION 3.22)
project(app LANGUAGES CXX)
add_executable(app app.cpp)
"""


def snippets(language):
    for page in [SOURCE / "README.md", *sorted((SOURCE / "docs").glob("*.md"))]:
        for match in re.finditer(r"^```(\w*)\n(.*?)^```$", page.read_text(), re.M | re.S):
            if match[1] not in ("sh", "cpp", "cmake", "text", ""):
                sys.exit(f"{page}: a block of '{match[1]}', which no test runs; teach {__file__} to")
            if match[1] == language:
                yield page.name, match[2]


def run(where, *command, **how):
    print(f"{where}: {shlex.join(map(str, command))}", flush=True)
    done = subprocess.run(command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, **how)
    if done.returncode != 0:
        sys.exit(f"{where}: exit code {done.returncode}\n{done.stdout}")


def run_shell():
    ran = 0
    for page, text in snippets("sh"):
        for line in text.splitlines():
            words = shlex.split(line, comments=True)
            if words and words[0] == "standoff":
                run(page, PROGRAM, *words[1:])
                ran += 1
            elif words and words[0].startswith("script/"):
                run(page, SOURCE / words[0], "--help")
            elif words:
                sys.exit(f"{page}: '{line}' is neither standoff nor a script of it; teach {__file__} to run it")
    return ran


def with_main(text):
    if re.search(r"\bint main\b", text):
        return text
    lines = text.splitlines()
    inside = [line for line in lines if not line.startswith("#")]
    return "\n".join([line for line in lines if line.startswith("#")] + ["int main() {", *inside, "}", ""])


def run_programs():
    [(_, cmake)] = snippets("cmake")
    run("install", "cmake", "--install", PROGRAM.parent, "--prefix", pathlib.Path("prefix").resolve())
    ran = 0
    for page, text in snippets("cpp"):
        folder = pathlib.Path(f"app{ran}")
        folder.mkdir()
        (folder / "app.cpp").write_text(with_main(text))
        (folder / "CMakeLists.txt").write_text(PROJECT + cmake)
        run(page, "cmake", "-S", folder, "-B", folder / "build", f"-DCMAKE_PREFIX_PATH={pathlib.Path('prefix').resolve()}")
        run(page, "cmake", "--build", folder / "build")
        run(page, folder / "build" / "app")
        ran += 1
    return ran


def main():
    for mesh in ("bunny.obj",):
        if (MODELS / mesh).exists():
            shutil.copy(MODELS / mesh, mesh)
        else:
            pathlib.Path(mesh).write_text(STAND_IN)
    commands = run_shell()
    for name in ("bunny.vti", "band.npz", "bunny.png"):
        if not pathlib.Path(name).stat().st_size:
            sys.exit(f"{name} is empty")
    programs = run_programs()
    # Were the blocks called otherwise one day, nothing would be run and nothing would fail.
    if commands < 5 or programs < 1:
        sys.exit(f"only {commands} commands and {programs} programs were found; are the blocks still marked sh and cpp?")


main()
