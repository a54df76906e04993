# Read by the scripts of this folder: where the repository is, and how it is configured and built.
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
