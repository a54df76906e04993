#!/bin/sh
# Installs what is missing, builds, and shows what Entoptic does: a small office seen on the virtual headset by day, at dusk, by starlight
# and at night with a lamp, each without simulation (`off`) and as an eye sees it (`combined`). Needs no headset and no GPU.
#   tools/demo.sh [--panel WxH] [--frames N] [--output FOLDER]
. "$(dirname "$0")/common.sh"

panel=720x800
frames=12
output=build/demo
while [ $# -gt 0 ]; do
    case "$1" in
        --panel) panel=$2 ;;
        --frames) frames=$2 ;;
        --output) output=$2 ;;
        *) echo "usage: tools/demo.sh [--panel WxH] [--frames N] [--output FOLDER]" >&2; exit 2 ;;
    esac
    shift 2
done

tools/install-dependencies.sh
build dev entoptic openxr_entoptic entoptic-demo

programs=build/dev/bin
rm -rf "$output"
mkdir -p "$output"

# shot <name> <preset> <demo options...>: one run; keeps the last frame of the left eye and the report.
shot() {
    name=$1
    preset=$2
    shift 2
    printf '  %-12s %-12s ' "$name" "$preset"
    dump="$output/frames/${name}_$preset"
    "$programs/entoptic" run --hmd virtual --clock lockstep --panel "$panel" --frames "$frames" --preset "$preset" \
        --dump "$dump" --dump-stages panel,seen --dump-every "$((frames - 1))" --report "$output/${name}_$preset.json" \
        -- "$programs/entoptic-demo" "$@" >"$output/${name}_$preset.log" 2>&1 </dev/null ||
        { echo "failed:"; cat "$output/${name}_$preset.log"; exit 1; }
    for stage in panel seen; do
        last=$(find "$dump" -name "*_left_$stage.png" | sort | tail -n 1)
        [ -n "$last" ] || { echo "no picture of stage $stage in $dump"; exit 1; }
        case $stage in
            panel) cp "$last" "$output/office_${name}_${preset}_panel.png" ;;
            seen) cp "$last" "$output/office_${name}_$preset.png" ;;
        esac
    done
    echo "done"
}

say "Running the office on the virtual headset (2 x $panel, $frames frames a run)"
for preset in off combined luidolt2020; do
    shot day "$preset" --light day --lamp off
    shot dusk "$preset" --light dusk --lamp off
    shot starlight "$preset" --light starlight --lamp off
    shot lamp "$preset" --light night --lamp on
done

say "Pictures: the left eye's view through the lens, before (off), as a wearer is shown it (combined), and a paper's picture (luidolt2020)"
for name in day dusk starlight lamp; do
    printf '  %s  %s  %s\n' "$output/office_${name}_off.png" "$output/office_${name}_combined.png" "$output/office_${name}_luidolt2020.png"
done
printf '  What the panel itself shows: %s\n' "$output/office_*_panel.png"
say "Report: $output/lamp_combined.json"
printf '  One a run: %s\n' "$output/*.json"
