#!/bin/sh
# Installs what is missing, builds with warnings as errors, and runs the tests.
#   tools/test.sh          everything but the slow suite
#   tools/test.sh --long   also the slow suite, and all tests under AddressSanitizer, UBSan and the Vulkan validation layer
. "$(dirname "$0")/common.sh"

long=no
case "${1:-}" in
    "") ;;
    --long) long=yes ;;
    *) echo "usage: tools/test.sh [--long]" >&2; exit 2 ;;
esac

tools/install-dependencies.sh

status=0
# run_tests <preset> [ctest options]: stdout ends with ctest's own summary.
run_tests() {
    preset=$1
    shift
    say "Testing preset $preset"
    ctest --preset "$preset" --no-tests=error --parallel "${ENTOPTIC_TEST_JOBS:-2}" "$@" </dev/null || status=1
    # A test that skips itself has tested nothing.
    binaries=build/$preset
    [ "$preset" = slow ] && binaries=build/dev
    skipped=$(grep -F '[  SKIPPED ]' "$binaries/Testing/Temporary/LastTest.log" 2>/dev/null | sort -u || true)
    if [ -n "$skipped" ]; then
        echo "$skipped"
        say "These tests skipped themselves, which counts as failing"
        status=1
    fi
}

if [ $long = yes ]; then
    for preset in asan validation; do
        build "$preset"
        run_tests "$preset"
    done
    build dev
    run_tests slow
fi
build ci
run_tests ci

if [ $status -eq 0 ]; then say "All tests passed"; else say "Some tests failed"; fi
exit $status
