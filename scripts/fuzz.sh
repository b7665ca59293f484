#!/usr/bin/env bash
# Fuzzes the targets of fuzz/, all of them or those that are named, for some seconds each:
#
#     scripts/fuzz.sh [--seconds 60] [--seed N] [TARGET ...]
#
# With a seed, and without what earlier runs learned, every run goes through the same inputs in the same order.
# Needs a C++ compiler; no cargo-fuzz and no nightly compiler. What it learns stays in fuzz/corpus, inputs that break something are
# written to fuzz/artifacts and named at the end.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/../fuzz"

seconds=60
seed=0
while true; do
    case "${1:-}" in
        --seconds) seconds=$2; shift 2 ;;
        --seed) seed=$2; shift 2 ;;
        *) break ;;
    esac
done
if [ $# = 0 ]; then
    set -- fuzz_targets/*.rs
    set -- "${@##*/}"
    set -- "${@%.rs}"
fi

# The instrumentation that cargo-fuzz asks for. A target is named so that build scripts do without it.
flags=(
    --cfg fuzzing -C passes=sancov-module -C llvm-args=-sanitizer-coverage-level=4
    -C llvm-args=-sanitizer-coverage-inline-8bit-counters -C llvm-args=-sanitizer-coverage-pc-table
    -C llvm-args=-sanitizer-coverage-trace-compares
)
export RUSTFLAGS="${flags[*]}"
host=$(rustc -vV | sed -n 's/^host: //p')
cargo build --release --locked --quiet --target "$host"

broken=()
for target in "$@"; do
    mkdir -p "corpus/$target" "artifacts/$target"
    echo "== $target"
    "target/$host/release/$target" "corpus/$target" "seeds/$target" -max_total_time="$seconds" -seed="$seed" -timeout=10 \
        -rss_limit_mb=2048 -max_len=16384 -artifact_prefix="artifacts/$target/" -print_final_stats=1 \
        >"artifacts/$target.log" 2>&1 || broken+=("$target")
    grep -E "number_of_executed_units|^SUMMARY|panicked at|Test unit written" "artifacts/$target.log" || true
done
if [ ${#broken[@]} -gt 0 ]; then echo "broken: ${broken[*]}"; exit 1; fi
