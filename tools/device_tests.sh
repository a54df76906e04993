#!/bin/sh
# Runs the drivers on a kernel of their own with emulated devices (tests/devices/devices.md): installs what is missing, builds that kernel
# (once, five minutes on two cores; it is kept in ~/.cache/entoptic), builds the tests, and runs them.
#   tools/device_tests.sh          some minutes
#   tools/device_tests.sh --long   also ten virtual minutes of everything, a hundred unplugs, and full-size pictures
. "$(dirname "$0")/common.sh"

preset=device
case "${1:-}" in
    "") ;;
    --long) preset=device-long ;;
    *) echo "usage: tools/device_tests.sh [--long]" >&2; exit 2 ;;
esac

tools/install-dependencies.sh --device-tests
say "Building the kernel"
tests/devices/kernel/build_um_kernel.sh
build device
run_tests device $preset
if [ $status -eq 0 ]; then say "All device tests passed"; else say "Some device tests failed"; fi
exit $status
