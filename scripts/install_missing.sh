#!/usr/bin/env bash
# Installs the Debian packages of programs that are missing: scripts/install_missing.sh PROGRAM[=PACKAGE]...
# The package is named like the program unless it is given.
set -euo pipefail

packages=()
for program in "$@"; do
    command -v "${program%%=*}" >/dev/null || packages+=("${program#*=}")
done
[ ${#packages[@]} -gt 0 ] || exit 0
echo "Installing ${packages[*]}"
root=; [ "$(id -u)" -eq 0 ] || root=sudo
$root apt-get update -qq
$root env DEBIAN_FRONTEND=noninteractive apt-get install -y -qq "${packages[@]}" >/dev/null
