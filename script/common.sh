# SPDX-License-Identifier: Apache-2.0
# Shared by the scripts: where we are, how to speak, how to build. Sourced, not run.
# shellcheck shell=bash
set -euo pipefail
self=$(realpath "$0")
cd "$(dirname "${BASH_SOURCE[0]}")/.."

jobs=${JOBS:-$(nproc)}

say() { printf '\n== %s\n' "$*"; }
fail() {
  printf '%s: %s\n' "script/${self##*/}" "$*" >&2
  exit 1
}

# Prints the comment at the top of the script that runs.
print_help() { sed -n '3,/^[^#]/{/^#/s/^# \{0,1\}//p}' "$self"; }

if command -v ccache >/dev/null; then
  export CMAKE_CXX_COMPILER_LAUNCHER=${CMAKE_CXX_COMPILER_LAUNCHER-ccache}
  # Another clone of the same sources, somewhere else, has the same objects.
  export CCACHE_BASEDIR=${CCACHE_BASEDIR-$PWD} CCACHE_NOHASHDIR=${CCACHE_NOHASHDIR-1}
  export CCACHE_SLOPPINESS=${CCACHE_SLOPPINESS-pch_defines,time_macros}  # else it caches nothing of precompiled headers
fi

# configure PRESET [CMAKE ARGUMENTS], silent unless it fails or has something to tell.
configure() {
  local preset=$1 log
  shift
  log=$(mktemp)
  if ! cmake --preset "$preset" "$@" >"$log" 2>&1; then
    cat "$log" >&2
    rm -f "$log"
    return 1
  fi
  grep -E 'not found|Warning' "$log" || true
  rm -f "$log"
}

# build PRESET [CMAKE ARGUMENTS]: configures and builds a preset into build/PRESET.
build() {
  configure "$@" && cmake --build "build/$1" --parallel "$jobs"
}

# The C++ files of the project: those git tracks, or all where there is no git.
cpp_files() {
  { git ls-files -co --exclude-standard 2>/dev/null || find . -path ./build -prune -o -type f -printf '%P\n'; } |
    grep -E '\.(h|inl|cpp|cuh|cu)$' | sort
}
