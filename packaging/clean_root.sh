# SPDX-License-Identifier: Apache-2.0
# A fresh Debian 12 to install packages in, for script/wheel-test and script/deb-test. Sourced after script/common.sh.
# shellcheck shell=bash

# Says why there can be no clean root here, or nothing.
why_no_clean_root() {
  if [[ $(id -u) != 0 ]]; then
    echo "only root can make one"
  elif ! script/bootstrap package >&2 || ! command -v debootstrap >/dev/null; then
    echo "debootstrap is missing (script/bootstrap package)"
  elif ! unshare --mount true 2>/dev/null; then
    echo "nothing can be mounted here"
  fi
}

# clean_root FOLDER: makes it a Debian in which nothing was installed, but that it can make virtual environments. The first
# time takes a minute; a copy of what was unpacked stays in build/package.
clean_root() {
  local kept=build/package/bookworm.tar log=build/package/debootstrap.log
  mkdir -p build/package
  if [[ ! -f $kept ]]; then
    rm -rf build/package/unpacked
    debootstrap --variant=minbase --include=python3-venv bookworm build/package/unpacked >"$log" 2>&1 || {
      tail -n 5 "$log" >&2
      fail "debootstrap failed; all of its words are in $log"
    }
    tar -C build/package/unpacked -cf "$kept.part" .
    mv "$kept.part" "$kept"
    rm -rf build/package/unpacked
  fi
  rm -rf --one-file-system "$1"
  mkdir -p "$1"
  tar -C "$1" -xf "$kept"
  # The mirrors and proxies that this machine takes its packages from.
  cp -a /etc/apt/. "$1/etc/apt/"
  cp -L /etc/resolv.conf /etc/hosts "$1/etc/"
}

# in_clean_root FOLDER COMMAND ...: runs it there, in mounts of its own that go when it ends.
in_clean_root() {
  # shellcheck disable=SC2016  # the inner shell expands them
  unshare --mount bash -c 'mount -t proc proc "$1/proc" && root=$1 && shift &&
    exec env -i PATH=/usr/local/sbin:/usr/local/bin:/usr/sbin:/usr/bin:/sbin:/bin HOME=/root LC_ALL=C.UTF-8 chroot "$root" "$@"' - "$@"
}
