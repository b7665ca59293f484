#!/usr/bin/env bash
# What must hold before anything is published: workflows, citation, packages and what they contain. Compiles nothing.
#
#     scripts/check_publishing.sh             # less than a minute
#     scripts/check_publishing.sh --sdist     # also installs the source distribution as a user would, which compiles it
#
# Tools that are missing are installed where that is possible; where it is not, the check says that it was skipped.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

with_sdist=false
case "${1:-}" in
    "") ;;
    --sdist) with_sdist=true ;;
    *) sed -n '2,/^[^#]/s/^# \{0,1\}//p' "$0"; exit 2 ;;
esac

tools="$PWD/target/publishing"
mkdir -p "$tools/bin"
export PATH="$tools/bin:$PATH"
[ -x "$tools/venv/bin/python" ] || "${PYTHON:-python3}" -m venv "$tools/venv"
"$tools/venv/bin/python" -m pip install --quiet --disable-pip-version-check -r packaging/requirements.txt

# Installs what is missing of TOOL=PACKAGE ... with apt-get.
from_apt() {
    local pair packages=()
    for pair in "$@"; do
        command -v "${pair%%=*}" >/dev/null || packages+=("${pair#*=}")
    done
    [ ${#packages[@]} -gt 0 ] && command -v apt-get >/dev/null && [ "$(id -u)" = 0 ] || return 0
    { apt-get update -qq && DEBIAN_FRONTEND=noninteractive apt-get install -y -qq --no-install-recommends "${packages[@]}"; } \
        >/dev/null || echo "not to be had from apt-get: ${packages[*]}"
}

# Runs a check if its tool is there: TOOL COMMAND...
with() {
    if command -v "$1" >/dev/null; then
        "${@:2}"
    else
        echo "skipped, there is no $1: ${*:2}"
    fi
}

from_apt shellcheck=shellcheck ruby=ruby
# Its own folder has the pinned version; another one on the machine may find more or less.
wanted=1.7.7
if ! "$tools/bin/actionlint" -version 2>/dev/null | grep -q "v\{0,1\}${wanted//./\\.}"; then
    from_apt go=golang-go
    if command -v go >/dev/null; then
        GOBIN="$tools/bin" go install "github.com/rhysd/actionlint/cmd/actionlint@v$wanted" || echo "actionlint $wanted was not built"
    fi
fi

# With shellcheck it reads the commands in the workflows, too.
with actionlint actionlint
with shellcheck shellcheck .ci/run scripts/*.sh
"$tools/venv/bin/cffconvert" --validate -i CITATION.cff
with ruby ruby -c packaging/homebrew/slcal.rb
"$tools/venv/bin/hadolint" packaging/docker/Dockerfile
"$tools/venv/bin/python" scripts/check_packages.py
# The version is the same wherever it is stated, and the changelog has a section for it, which need not be dated yet.
"$tools/venv/bin/python" scripts/release_notes.py --draft "$(sed -n 's/^version = "\(.*\)"/\1/p' Cargo.toml)" >/dev/null

# Uncommitted changes are no hindrance here; `cargo publish` refuses them. Nothing is verified, for that compiles.
rm -rf "$tools/package" "$tools/sdist"
cargo package --locked --quiet --no-verify --allow-dirty -p slcal-core -p slcal-cli --target-dir "$tools" 2>&1 |
    # Left out on purpose: `exclude` in Cargo.toml.
    sed '/^warning: ignoring \(test\|benchmark\) /d'
"$tools/venv/bin/maturin" sdist --manifest-path crates/slcal-py/Cargo.toml --out "$tools/sdist" >"$tools/sdist.log" 2>&1 || {
    cat "$tools/sdist.log"
    exit 1
}
"$tools/venv/bin/python" scripts/check_packages.py "$tools"/package/*.crate "$tools"/sdist/*.tar.gz

install_sdist() {
    "${PYTHON:-python3}" scripts/fresh_wheel.py "$tools"/sdist/*.tar.gz
}
if $with_sdist; then install_sdist; fi
