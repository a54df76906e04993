#!/bin/sh
# Builds the kernel that the device tests run on: Debian's own Linux 6.1 sources as a user program (User Mode Linux), about five minutes on
# two cores, once: the result is kept in ${XDG_CACHE_HOME:-~/.cache}/entoptic, by source version, configuration and this script.
# Needs neither root nor KVM; needs Debian's package sources (apt-get download) and gcc, make, flex, bison, bc, xz-utils.
#   build_um_kernel.sh            build if need be; print the kernel's path
#   build_um_kernel.sh --path     print the path of the kernel that is there; fail (3) when there is none
set -eu

here=$(dirname "$(readlink -f "$0")")
cache=${XDG_CACHE_HOME:-${HOME:-/tmp}/.cache}/entoptic
package=linux-source-6.1

say() { printf '%s\n' "$*" >&2; }

wanted=${1:-}
if [ -n "$wanted" ] && [ "$wanted" != "--path" ]; then
    say "usage: build_um_kernel.sh [--path]"
    exit 2
fi

recipe=$(cat "$here/um.config" "$here/vkms_panel.sh" "$here/build_um_kernel.sh" | sha256sum | cut -c1-12)
if [ "$wanted" = "--path" ]; then
    kernel=$(ls -t "$cache"/um-*-"$recipe" 2>/dev/null | head -n 1)
    if [ -z "$kernel" ]; then
        say "The kernel of the device tests has not been built yet. Build it (five minutes): tests/devices/kernel/build_um_kernel.sh"
        exit 3
    fi
    printf '%s\n' "$kernel"
    exit 0
fi

for tool in gcc make flex bison bc xz dpkg-deb apt-get; do
    if ! command -v $tool >/dev/null 2>&1; then
        say "$tool is missing. Install: apt-get install build-essential flex bison bc xz-utils"
        exit 3
    fi
done
version=$(apt-cache policy $package | awk '/Candidate:/ {print $2}')
if [ -z "$version" ] || [ "$version" = "(none)" ]; then
    say "This system's package sources have no $package (Debian 12 has). Run: apt-get update"
    exit 3
fi
kernel=$cache/um-$version-$recipe
if [ -x "$kernel" ]; then
    printf '%s\n' "$kernel"
    exit 0
fi

work=$(mktemp -d "${TMPDIR:-/tmp}/entoptic-um.XXXXXX")
trap 'rm -rf "$work"' EXIT
chmod 755 "$work"
cd "$work"
say "Building Linux $version for user mode in $work."
apt-get -q download "$package=$version" >&2
dpkg-deb --fsys-tarfile $package\_*.deb | tar -xO ./usr/src/$package.tar.xz | tar -xJ
rm -f $package\_*.deb
cd $package

"$here/vkms_panel.sh" drivers/gpu/drm/vkms/vkms_output.c

out=$work/out
mkdir -p "$out" "$cache"
make -s ARCH=um O="$out" tinyconfig >&2
ARCH=um scripts/kconfig/merge_config.sh -m -O "$out" "$out/.config" "$here/um.config" >&2
make -s ARCH=um O="$out" olddefconfig >&2
for option in USBIP_VHCI_HCD HIDRAW USB_VIDEO_CLASS DRM_VKMS DRM_LOAD_EDID_FIRMWARE UML_TIME_TRAVEL_SUPPORT HOSTFS OVERLAY_FS; do
    if ! grep -q "^CONFIG_$option=y" "$out/.config"; then
        say "The kernel's configuration lost CONFIG_$option; um.config does not fit $version."
        exit 1
    fi
done
nice -n 10 make -s ARCH=um O="$out" -j"$(nproc)" linux >"$work/build.log" 2>&1 || {
    tail -n 30 "$work/build.log" >&2
    say "The kernel did not build."
    exit 1
}
strip -o "$kernel.part" "$out/linux"
mv "$kernel.part" "$kernel"
printf '%s\n' "$kernel"
