#!/bin/sh
# Runs a command on Debian's own kernel (kernel/get_debian_kernel.sh) in QEMU without KVM. Time is the number of instructions (-icount) on one CPU:
# a busy machine makes it slow, not late. What User Mode Linux cannot run, such as AddressSanitizer, runs here.
#   run_qemu.sh [--edid FILE] [--timeout SECONDS] [--log FOLDER] -- COMMAND ARGUMENTS...
# Options and exit codes: guest.sh.
here=$(dirname "$(readlink -f "$0")")
. "$here/guest.sh"

kernel=$("$here/kernel/get_debian_kernel.sh" --path) || { echo "run_qemu.sh: the kernel cannot start." >&2; exit 125; }
command -v qemu-system-x86_64 >/dev/null 2>&1 || { echo "run_qemu.sh: QEMU is missing. Install: apt-get install qemu-system-x86" >&2; exit 125; }
read_options run_qemu.sh "$@"
printf "kernel_folder='%s'\n" "$kernel" >"$work/out/settings"
firmware=
if [ -n "$edid" ]; then
    echo 'vkms=vkms' >>"$work/out/settings"
    firmware="firmware_class.path=/run/out/firmware drm.edid_firmware=edid/headset.bin"
fi
ended=0
timeout -k 2 "$limit" qemu-system-x86_64 -M pc -accel tcg,thread=single -icount shift=0,sleep=on -cpu max -smp 1 -m 3072 -nodefaults \
    -no-user-config -display none -no-reboot -kernel "$kernel/vmlinux" -initrd "$kernel/initial.gz" \
    -append "console=ttyS0 quiet panic=-1 mitigations=off nokaslr $firmware" -serial "file:$work/out/console" \
    -fsdev local,id=host,path=/,security_model=none,readonly=on,multidevs=remap -device virtio-9p-pci,fsdev=host,mount_tag=host \
    -fsdev "local,id=out,path=$work/out,security_model=none" -device virtio-9p-pci,fsdev=out,mount_tag=out </dev/null >&2 || ended=$?
guest_ended $ended
