#!/bin/busybox sh
# The first program of run_qemu.sh's guest: reaches the host's root, puts a file system in memory over it, and runs the command.
b=/bin/busybox
$b mkdir -p /proc /sys /dev /host /memory /run/out
$b mount -t proc proc /proc
$b mount -t sysfs sys /sys
$b mount -t devtmpfs dev /dev
for module in /modules/*.ko; do $b insmod "$module" >/dev/kmsg 2>&1; done
share=trans=virtio,version=9p2000.L,msize=512000
$b mount -t 9p -o $share,cache=loose,ro host /host
$b mount -t 9p -o $share,cache=none out /run/out
$b mount -t tmpfs memory /memory
$b mkdir /memory/upper /memory/work /memory/new
r=/memory/new
$b mount -t overlay -o lowerdir=/host,upperdir=/memory/upper,workdir=/memory/work overlay $r
$b mkdir -p /dev/pts /dev/shm
for folder in proc sys dev; do $b mount -o bind /$folder $r/$folder; done
$b mount -t tmpfs shm $r/dev/shm
$b mount -t devpts pts $r/dev/pts
$b mount -t tmpfs run $r/run
$b mkdir -p $r/run/out
$b mount -o bind /run/out $r/run/out
. /run/out/settings
release=$($b uname -r)
$b mkdir -p $r/usr/lib/modules/$release
$b mount -o bind "$r$kernel_folder/lib/modules/$release" $r/usr/lib/modules/$release
$b ip link set lo up
for module in vhci-hcd usbhid hid-generic uvcvideo ${vkms:-}; do $b chroot $r /sbin/modprobe $module >/dev/kmsg 2>&1; done
export PATH=/usr/local/sbin:/usr/local/bin:/usr/sbin:/usr/bin:/sbin:/bin HOME=/tmp LANG=C.UTF-8
$b chroot $r /bin/sh /run/out/command.sh </dev/null >/run/out/output 2>&1
echo $? >/run/out/code
$b dmesg >/run/out/dmesg
$b sync
$b poweroff -f
