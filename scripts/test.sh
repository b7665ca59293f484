#!/usr/bin/env bash
# Runs every test: the Rust workspace, the Python package as an installed wheel, and the figures on rendered photographs
# where those are at hand. Needs cargo and python3 (3.10 or newer); makes .venv for the rest.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
# Tests run in several folders; without the rendered scenes some of them say that they were skipped.
SLCAL_SHARED=$(realpath -m "${SLCAL_SHARED:-../shared}")
export SLCAL_SHARED

[ -x .venv/bin/python ] || "${PYTHON:-python3}" -m venv .venv
.venv/bin/python -m pip install --quiet --disable-pip-version-check -r tests/requirements.txt

echo "== Rust"
cargo test --locked
# The library as programs see it that ask for one of its features, or for none.
for feature in "" report advise evaluate exchange npz stages simulate; do
    RUSTFLAGS="-D warnings" cargo check --locked --quiet -p slcal-core --features "$feature" --target-dir target/bare
done
# The command without the browser window.
RUSTFLAGS="-D warnings" cargo check --locked --quiet -p slcal-cli --no-default-features --target-dir target/bare

echo "== Python"
rm -rf target/wheels
.venv/bin/maturin build --release --locked --quiet --interpreter .venv/bin/python \
    --manifest-path crates/slcal-py/Cargo.toml --out target/wheels
.venv/bin/python -m pip install --quiet --disable-pip-version-check --force-reinstall --no-deps target/wheels/slcal-*.whl
.venv/bin/python scripts/check_packages.py target/wheels/slcal-*.whl
.venv/bin/python scripts/fresh_wheel.py target/wheels/slcal-*.whl
(
    cd crates/slcal-py
    ../../.venv/bin/python -m mypy --strict python/slcal
    ../../.venv/bin/python -m mypy.stubtest slcal._slcal
    ../../.venv/bin/python -m pytest -q -rs
)

echo "== Figures on rendered photographs"
cargo build --locked --release --quiet -p slcal-cli
.venv/bin/python tests/rendered/check_figures.py --slcal target/release/slcal --shared "$SLCAL_SHARED"

echo "== Reports in a browser"
.venv/bin/python tests/browser/check_reports.py --slcal target/release/slcal

echo "== The studio in a browser"
.venv/bin/python tests/browser/check_studio.py --slcal target/release/slcal

echo "== Commands in the documentation"
.venv/bin/python scripts/console_blocks.py --check
