# Read by the scripts of this folder: where the repository is, and how it is configured, built and tested.
set -eu

root=$(cd "$(dirname "$0")/.." && pwd)
cd "$root"

# One compiler cache for all clones of this user, which finds its objects whatever folder the clone is in.
export CCACHE_DIR="${CCACHE_DIR:-${XDG_CACHE_HOME:-${HOME:-/tmp}/.cache}/ccache}"
export CCACHE_BASEDIR="${CCACHE_BASEDIR:-$root}"
export CCACHE_NOHASHDIR="${CCACHE_NOHASHDIR:-1}"

say() { printf '\n== %s\n' "$*"; }

# build <preset> [target...]: configures and builds under build/<preset>.
build() {
    preset=$1
    shift
    say "Building preset $preset in build/$preset"
    cmake --preset "$preset"
    if [ $# -gt 0 ]; then
        cmake --build --preset "$preset" --target "$@"
    else
        cmake --build --preset "$preset"
    fi
}

status=0
# run_tests <build folder> <test preset>: stdout ends with ctest's own summary. status becomes 1 when something failed.
run_tests() {
    say "Testing preset $2"
    ctest --preset "$2" --no-tests=error --parallel "${ENTOPTIC_TEST_JOBS:-2}" </dev/null || status=1
    # A test that skips itself has tested nothing.
    skipped=$(grep -F '[  SKIPPED ]' "build/$1/Testing/Temporary/LastTest.log" 2>/dev/null | sort -u || true)
    if [ -n "$skipped" ]; then
        echo "$skipped"
        say "These tests skipped themselves, which counts as failing"
        status=1
    fi
}
