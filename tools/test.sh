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

build ci
if [ $long = yes ]; then
    build asan
    run_tests asan asan
    run_tests ci validation
    run_tests ci slow
fi
run_tests ci ci

if [ $status -eq 0 ]; then say "All tests passed"; else say "Some tests failed"; fi
exit $status
