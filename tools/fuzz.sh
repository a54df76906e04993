#!/bin/sh
# Fuzzes every parser that has a target (*_fuzz.cpp) with libFuzzer under AddressSanitizer and UndefinedBehaviorSanitizer, one after the other.
#   tools/fuzz.sh [SECONDS [TARGET...]]     600 seconds each, all targets
# Starts from the corpus in tests/fuzz/corpus and what earlier runs found (tests/fuzz/found), and leaves them alone; what it finds on the way stays in build/fuzz/corpus, and an input that
# breaks something in build/fuzz/findings. See tests/fuzz/fuzz.md.
. "$(dirname "$0")/common.sh"

limit=${1:-600}
case $limit in *[!0-9]* | "") echo "usage: tools/fuzz.sh [SECONDS [TARGET...]]" >&2; exit 2 ;; esac
if [ $# -gt 0 ]; then shift; fi
targets=${*:-$(ls tests/fuzz/corpus)}
command -v clang++ >/dev/null 2>&1 || { echo "clang++ is missing. Install: apt-get install clang" >&2; exit 3; }
# shellcheck disable=SC2086
build fuzz $targets

status=0
mkdir -p build/fuzz/findings
for target in $targets; do
    say "Fuzzing $target for $limit s"
    mkdir -p "build/fuzz/corpus/$target"
    tar -C "build/fuzz/corpus/$target" -xJf "tests/fuzz/found/$target.tar.xz"
    UBSAN_OPTIONS=halt_on_error=1:print_stacktrace=1 nice -n 19 "build/fuzz/bin/$target" -max_total_time="$limit" -timeout=20 -rss_limit_mb=3000 \
        -max_len=65536 -print_final_stats=1 -artifact_prefix="build/fuzz/findings/$target-" "build/fuzz/corpus/$target" "tests/fuzz/corpus/$target" \
        >"build/fuzz/$target.log" 2>&1 || status=1
    grep -E "SUMMARY|^stat::(number_of_executed_units|peak_rss_mb)|DONE" "build/fuzz/$target.log" || true
done
if [ $status -eq 0 ]; then say "No finding"; else say "There are findings: see build/fuzz/*.log and build/fuzz/findings"; fi
exit $status
