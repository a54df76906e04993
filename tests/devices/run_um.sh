#!/bin/sh
# Runs a command on the device tests' own kernel (kernel/build_um_kernel.sh), on this machine's own root: read-only, under a file system in
# memory that is gone afterwards. No root, no KVM. Time is virtual: the clock moves only when every program waits, so that two runs give
# the same output however busy the machine is.
#   run_um.sh [--real-time] [--edid FILE] [--timeout SECONDS] [--log FOLDER] -- COMMAND ARGUMENTS...
# Exit code: the command's; 124 it took too long; 125 the kernel died or did not start.
set -eu

here=$(dirname "$(readlink -f "$0")")
limit=300
log=
edid=
time=time-travel=inf-cpu
while [ $# -gt 0 ]; do
    case $1 in
        --real-time) time= ;;
        --timeout) limit=$2; shift ;;
        --log) log=$2; shift ;;
        --edid) edid=$(readlink -f "$2"); shift ;;
        --) shift; break ;;
        *) echo "usage: run_um.sh [--real-time] [--edid FILE] [--timeout SECONDS] [--log FOLDER] -- COMMAND..." >&2; exit 2 ;;
    esac
    shift
done
kernel=$("$here/kernel/build_um_kernel.sh" --path) || { echo "run_um.sh: the kernel cannot start." >&2; exit 125; }
busybox=$(command -v busybox) || { echo "run_um.sh: busybox is missing. Install: apt-get install busybox-static" >&2; exit 125; }

work=$(mktemp -d "${TMPDIR:-/tmp}/entoptic-um.XXXXXX")
trap 'rm -rf "$work"' EXIT
mkdir -p "$work/out" "$work/firmware/edid"
echo 125 >"$work/out/code"
firmware=
if [ -n "$edid" ]; then
    cp "$edid" "$work/firmware/edid/headset.bin"
    firmware="firmware_class.path=$work/firmware drm.edid_firmware=edid/headset.bin"
fi

# The command with its arguments quoted, in this folder and with the variables that tests read.
{
    printf 'cd %s\n' "'$PWD'"
    env | grep -E '^(ENTOPTIC_|GTEST_|LD_LIBRARY_PATH=|ASAN_|UBSAN_)' | sed "s/'/'\\\\''/g; s/^\([^=]*\)=\(.*\)$/export \1='\2'/" || true
    printf 'exec'
    for word in "$@"; do printf " '%s'" "$(printf '%s' "$word" | sed "s/'/'\\\\''/g")"; done
    printf '\n'
} >"$work/command.sh"

cat >"$work/init" <<I
#!$busybox sh
b=$busybox
export PATH=/usr/local/sbin:/usr/local/bin:/usr/sbin:/usr/bin:/sbin:/bin HOME=/tmp LANG=C.UTF-8
\$b mount -t proc proc /proc
\$b mount -t tmpfs memory /run
cd /run
\$b mkdir upper work new out
\$b mount -t hostfs out /run/out -o $work/out
\$b mount -t overlay -o lowerdir=/,upperdir=/run/upper,workdir=/run/work overlay /run/new
r=/run/new
\$b mount -t proc proc \$r/proc
\$b mount -t sysfs sys \$r/sys
\$b mount -t devtmpfs dev \$r/dev
\$b mkdir -p \$r/dev/shm \$r/dev/pts
\$b mount -t tmpfs shm \$r/dev/shm
\$b mount -t devpts pts \$r/dev/pts
\$b mount -t tmpfs run \$r/run
\$b ip link set lo up
\$b chroot \$r /bin/sh $work/command.sh </dev/null >/run/out/output 2>&1
echo \$? >/run/out/code
\$b dmesg >/run/out/dmesg
\$b sync
\$b poweroff -f
I
chmod +x "$work/init"

ended=0
# shellcheck disable=SC2086
timeout -k 2 "$limit" "$kernel" mem=1536M rootfstype=hostfs rootflags=/ ro "init=$work/init" con=null con0=null,fd:2 quiet $firmware $time \
    </dev/null >"$work/out/console" 2>&1 || ended=$?
cat "$work/out/output" 2>/dev/null || true
if [ -n "$log" ]; then
    mkdir -p "$log"
    cp "$work/out/"* "$log/"
fi
code=$(cat "$work/out/code")
if [ "$ended" = 124 ] || [ "$ended" = 137 ]; then
    echo "run_um.sh: stopped after $limit s." >&2
    exit 124
fi
if [ "$code" = 125 ]; then
    echo "run_um.sh: the kernel died:" >&2
    tail -n 15 "$work/out/console" >&2
fi
exit "$code"
