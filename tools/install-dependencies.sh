#!/bin/sh
# Installs everything Entoptic needs from Debian 12's packages. Does nothing when all of them are there already.
# Needs root or sudo only when something is missing.
#   tools/install-dependencies.sh            install what is missing
#   tools/install-dependencies.sh --list     print the packages, one a line, and install nothing
#   tools/install-dependencies.sh --device-tests   also what tools/device_tests.sh needs
set -eu

packages="
build-essential cmake ninja-build ccache pkg-config
libvulkan-dev mesa-vulkan-drivers vulkan-validationlayers glslang-tools libglm-dev
libopenxr-dev libopenxr-loader1 libopenxr-utils openxr-layer-corevalidation openxr-layer-apidump
libopenexr-dev libpng-dev libturbojpeg0-dev libusb-1.0-0-dev libeigen3-dev libtomlplusplus-dev nlohmann-json3-dev libcli11-dev libfmt-dev libspdlog-dev libexpected-dev
libfftw3-dev libgtest-dev libbenchmark-dev
libxcb1-dev libxcb-randr0-dev libdrm-dev libudev-dev libwayland-dev wayland-protocols xvfb xauth
libgl-dev libopengl-dev libegl-dev libx11-dev libxcb-glx0-dev libglx-mesa0 libegl-mesa0 libgl1-mesa-dri
libhidapi-dev libceres-dev zlib1g-dev
python3 ca-certificates
"

device_packages="flex bison bc xz-utils busybox-static qemu-system-x86 cpio kmod xserver-xorg-core x11-xserver-utils"

say() { printf '%s\n' "$*" >&2; }

if [ "${1:-}" = "--list" ]; then
    printf '%s\n' $packages
    exit 0
elif [ "${1:-}" = "--device-tests" ]; then
    packages="$packages $device_packages"
elif [ $# -gt 0 ]; then
    say "usage: tools/install-dependencies.sh [--list | --device-tests]"
    exit 2
fi

system="an unknown system"
if [ -r /etc/os-release ]; then
    system=$(. /etc/os-release && printf '%s %s' "${ID:-unknown}" "${VERSION_ID:-}")
fi
if [ "$system" != "debian 12" ]; then
    say "This is not Debian 12 but $system. Entoptic is built and tested on Debian 12 only; trying all the same."
fi
if ! command -v apt-get >/dev/null 2>&1; then
    say "There is no apt-get here, so install the equivalents of these packages yourself:" $packages
    exit 3
fi

wanted=""
for package in $packages; do
    state=$(dpkg-query -W -f '${db:Status-Status}' "$package" 2>/dev/null || true)
    [ "$state" = "installed" ] || wanted="$wanted $package"
done
if [ -z "$wanted" ]; then
    exit 0
fi

if [ "$(id -u)" -eq 0 ]; then
    as_root="env"
elif command -v sudo >/dev/null 2>&1; then
    as_root="sudo env"
else
    say "These packages are missing, and installing them needs root or sudo:$wanted"
    say "Run as root: apt-get install --no-install-recommends$wanted"
    exit 3
fi

say "Installing:$wanted"
export DEBIAN_FRONTEND=noninteractive
apt="$as_root DEBIAN_FRONTEND=noninteractive apt-get -q -y -o Dpkg::Use-Pty=0 -o DPkg::Lock::Timeout=300"
$apt update </dev/null
# shellcheck disable=SC2086
$apt install --no-install-recommends $wanted </dev/null
