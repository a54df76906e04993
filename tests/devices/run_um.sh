#!/bin/sh
# Runs a command on the device tests' own kernel (kernel/build_um_kernel.sh), User Mode Linux. Time is virtual: the clock moves only when
# every program waits, so that two runs give the same output however busy the machine is.
#   run_um.sh [--real-time] [--edid FILE] [--timeout SECONDS] [--log FOLDER] -- COMMAND ARGUMENTS...
# Options and exit codes: guest.sh.
here=$(dirname "$(readlink -f "$0")")
. "$here/guest.sh"

time=time-travel=inf-cpu
own_option() {
    [ "$1" = --real-time ] && time=
}
kernel=$("$here/kernel/build_um_kernel.sh" --path) || { echo "run_um.sh: the kernel cannot start." >&2; exit 125; }
read_options run_um.sh "$@"
firmware=
[ -z "$edid" ] || firmware="firmware_class.path=$work/out/firmware drm.edid_firmware=edid/headset.bin"

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
\$b chroot \$r /bin/sh $work/out/command.sh </dev/null >/run/out/output 2>&1
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
guest_ended $ended
