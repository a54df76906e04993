#!/bin/sh
# Gets Debian's own kernel for run_qemu.sh: the distribution's image and modules as they are, and its vkms, which Debian does not build, from its
# sources with the change of vkms_panel.sh. Kept in ${XDG_CACHE_HOME:-~/.cache}/entoptic, by version and this folder's scripts. No root.
#   get_debian_kernel.sh            get it if need be; print its folder
#   get_debian_kernel.sh --path     print the folder that is there; fail (3) when there is none
set -eu

here=$(dirname "$(readlink -f "$0")")
cache=${XDG_CACHE_HOME:-${HOME:-/tmp}/.cache}/entoptic
say() { printf '%s\n' "$*" >&2; }

case ${1:-} in "" | --path) ;; *) say "usage: get_debian_kernel.sh [--path]"; exit 2 ;; esac
recipe=$(cat "$here/get_debian_kernel.sh" "$here/vkms_panel.sh" | sha256sum | cut -c1-12)
if [ "${1:-}" = "--path" ]; then
    folder=$(ls -td "$cache"/debian-*-"$recipe" 2>/dev/null | head -n 1)
    [ -n "$folder" ] || { say "Debian's kernel has not been fetched yet: tests/devices/kernel/get_debian_kernel.sh"; exit 3; }
    printf '%s\n' "$folder"
    exit 0
fi
for tool in gcc make xz cpio depmod dpkg-deb apt-get python3 busybox; do
    command -v $tool >/dev/null 2>&1 || { say "$tool is missing. Install: apt-get install build-essential xz-utils cpio kmod busybox-static"; exit 3; }
done
image=$(apt-cache depends linux-image-amd64 | awk '/Depends:/ {print $2; exit}')
[ -n "$image" ] || { say "This system's package sources have no linux-image-amd64 (Debian 12 has). Run: apt-get update"; exit 3; }
release=${image#linux-image-}
version=$(apt-cache policy "$image" | awk '/Candidate:/ {print $2}')
folder=$cache/debian-$version-$recipe
if [ -e "$folder/vmlinux" ]; then
    printf '%s\n' "$folder"
    exit 0
fi

work=$(mktemp -d "${TMPDIR:-/tmp}/entoptic-debian.XXXXXX")
trap 'rm -rf "$work"' EXIT
chmod 755 "$work"
cd "$work"
say "Fetching Debian's $image $version."
common=linux-headers-${release%-*}-common
apt-get -q download "$image=$version" "linux-source-6.1=$version" "linux-headers-$release=$version" "$common=$version" "linux-kbuild-6.1=$version" >&2
for package in "$image" "linux-headers-$release" "$common" linux-kbuild-6.1; do dpkg-deb -x "$package"_*.deb packages; done
dpkg-deb --fsys-tarfile linux-source-6.1_*.deb | tar -xO ./usr/src/linux-source-6.1.tar.xz | tar -xJ linux-source-6.1/drivers/gpu/drm/vkms

# vkms as a module against Debian's headers, whose makefile names them where they would be installed.
"$here/vkms_panel.sh" linux-source-6.1/drivers/gpu/drm/vkms/vkms_output.c
sed -i "s#/usr/src/#$work/packages/usr/src/#g" "packages/usr/src/linux-headers-$release/Makefile"
make -s -C "packages/usr/src/linux-headers-$release" M="$work/linux-source-6.1/drivers/gpu/drm/vkms" CONFIG_DRM_VKMS=m modules >build.log 2>&1 || {
    tail -n 20 build.log >&2
    say "vkms did not build."
    exit 1
}

out=$work/out
mkdir -p "$out/lib"
mv "packages/lib/modules" "$out/lib/modules"
cp linux-source-6.1/drivers/gpu/drm/vkms/vkms.ko "$out/lib/modules/$release/kernel/drivers/gpu/drm/"
depmod -b "$out" "$release"
# QEMU starts an unpacked kernel (its PVH entry) a second or two sooner than one that unpacks itself.
python3 - "packages/boot/vmlinuz-$release" "$out/vmlinux" <<'P'
import lzma, sys
data = open(sys.argv[1], "rb").read()
open(sys.argv[2], "wb").write(lzma.LZMADecompressor().decompress(data[data.find(b"\xfd7zXZ\0"):]))
P

# An initial file system of busybox and what reaches the host's root.
mkdir -p initial/bin initial/modules
cp "$(command -v busybox)" initial/bin/busybox
number=10
for module in virtio_ring virtio virtio_pci_legacy_dev virtio_pci_modern_dev virtio_pci netfs fscache 9pnet 9pnet_virtio 9p overlay; do
    file=$(find "$out/lib/modules" -name "$module.ko" | head -n 1)
    [ -z "$file" ] || cp "$file" "initial/modules/$number-$module.ko"
    number=$((number + 1))
done
cp "$here/qemu_init.sh" initial/init
chmod +x initial/init
(cd initial && find . | cpio -o -H newc --quiet | gzip -1) >"$out/initial.gz"
mkdir -p "$cache"
rm -rf "$folder"
mv "$out" "$folder"
printf '%s\n' "$folder"
