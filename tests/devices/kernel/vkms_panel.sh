#!/bin/sh
# vkms_panel.sh <vkms_output.c>: makes the kernel's virtual display a headset's panel. Its connector becomes a DisplayPort (a virtual one has no
# EDID), and an EDID given on the kernel's command line (drm.edid_firmware) counts. Otherwise it is Debian's.
set -eu
sed -i -e 's/DRM_MODE_CONNECTOR_VIRTUAL/DRM_MODE_CONNECTOR_DisplayPort/' \
       -e 's/^\tcount = drm_add_modes_noedid(/\tcount = drm_add_override_edid_modes(connector);\n\tif (count > 0)\n\t\treturn count;\n&/' "$1"
if [ "$(grep -c -e drm_add_override_edid_modes -e DRM_MODE_CONNECTOR_DisplayPort "$1")" != 2 ]; then
    echo "$1 is not the one that vkms_panel.sh knows how to change." >&2
    exit 1
fi
