# Read by run_um.sh and run_qemu.sh: their options, and the command as the guest runs it. No root, no KVM.
#   run_....sh [--edid FILE] [--timeout SECONDS] [--log FOLDER] -- COMMAND ARGUMENTS...
# The command runs on this machine's own root: read-only, under a file system in memory that is gone afterwards.
# Exit code: the command's; 124 it took too long; 125 the kernel died or did not start; 2 wrong usage.
# Sets limit, edid, busybox, work; work/out is the guest's /run/out. read_options' `own_option` takes what only one of them has.
set -eu

limit=300
log=
edid=
say() { printf '%s\n' "$name: $*" >&2; }

own_option() { return 1; }

read_options() {
    name=$1
    shift
    while [ $# -gt 0 ]; do
        case $1 in
            --timeout) limit=$2; shift ;;
            --log) log=$2; shift ;;
            --edid) edid=$(readlink -f "$2"); shift ;;
            --) shift; break ;;
            *) own_option "$1" || { echo "usage: $name [--edid FILE] [--timeout SECONDS] [--log FOLDER] -- COMMAND..." >&2; exit 2; } ;;
        esac
        shift
    done
    busybox=$(command -v busybox) || { say "busybox is missing. Install: apt-get install busybox-static"; exit 125; }
    work=$(mktemp -d "${TMPDIR:-/tmp}/entoptic-guest.XXXXXX")
    trap 'rm -rf "$work"' EXIT
    mkdir -p "$work/out/firmware/edid"
    echo 125 >"$work/out/code"
    [ -z "$edid" ] || cp "$edid" "$work/out/firmware/edid/headset.bin"
    # The command with its arguments quoted, in this folder and with the variables that tests read.
    {
        printf 'cd %s\n' "'$PWD'"
        env | grep -E '^(ENTOPTIC_|GTEST_|LD_LIBRARY_PATH=|ASAN_|UBSAN_)' | sed "s/'/'\\\\''/g; s/^\([^=]*\)=\(.*\)$/export \1='\2'/" || true
        printf 'exec'
        for word in "$@"; do printf " '%s'" "$(printf '%s' "$word" | sed "s/'/'\\\\''/g")"; done
        printf '\n'
    } >"$work/out/command.sh"
}

# guest_ended <exit code of what ran the kernel>: the command's output, the logs, and the exit code.
guest_ended() {
    cat "$work/out/output" 2>/dev/null || true
    if [ -n "$log" ]; then
        mkdir -p "$log"
        for file in output console dmesg code; do cp "$work/out/$file" "$log/" 2>/dev/null || true; done
    fi
    code=$(cat "$work/out/code")
    if [ "$1" = 124 ] || [ "$1" = 137 ]; then
        say "stopped after $limit s."
        exit 124
    fi
    if [ "$code" = 125 ]; then
        say "the kernel died:"
        tail -n 15 "$work/out/console" >&2
    fi
    exit "$code"
}
