#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Runs a command in a new folder that is removed afterwards.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
"$@"
