#!/bin/sh
# Makes the pictures on the models' pages, docs/images/models/<model>.png: the demo's office, in light in which the model has something to do,
# shown for the page by `entoptic simulate` with that model, adaptation and a tone map, and little else. Run it after a build.
#   tools/pictures.sh [--programs FOLDER, default build/dev/bin] [MODEL...]
. "$(dirname "$0")/common.sh"

programs=build/dev/bin
if [ "${1:-}" = --programs ]; then
    programs=$2
    shift 2
fi
wanted=" $* "
output=docs/images/models
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
mkdir -p "$output"

# scene <name> <field of view> <options of the demo...>: the office as a radiance map.
scene() {
    name=$1
    fov=$2
    shift 2
    "$programs/entoptic-demo" --offscreen "$work/$name" --size 320x240 --fov "$fov" "$@" >"$work/log" 2>&1 || { cat "$work/log"; exit 1; }
}

# picture <model> <scene> <field of view> <options of simulate...>: nothing of the base preset is kept but what is named.
picture() {
    model=$1
    map="$work/$2/left.exr"
    fov=$3
    shift 3
    case "$wanted" in *" $model "* | "  ") ;; *) return 0 ;; esac
    "$programs/entoptic" simulate "$map" -o "$output/$model.png" --fov "$fov" --preset off "$@" >/dev/null 2>"$work/log" || { cat "$work/log"; exit 1; }
    echo "  $output/$model.png"
}
night="--model adaptation=krawczyk_exp_log --model tone=key_reinhard"

scene day 60 --light day --lamp off
scene dusk 60 --light dusk --lamp off
scene starlight 60 --light starlight --lamp off
scene charts 24 --light starlight --lamp off --pitch 4
scene lamp 60 --light night --lamp on

# The eye comes from a lit room (10 cd/m²) and has had a second.
for model in krawczyk_exp_linear krawczyk_exp_log jacobs_ramp pattanaik_slow; do
    picture $model dusk 60 --model adaptation=$model --model tone=key_reinhard --adapted-to 10 --at 1
done
for model in display_identity key_reinhard naka_rushton; do
    picture $model lamp 60 --model adaptation=krawczyk_exp_log --model tone=$model
done
for model in luidolt_spectral closed_form cie135; do
    picture $model lamp 60 $night --model glare=$model --pupil 6 --photographic
done
picture fraunhofer_mask lamp 60 $night --model glare=fraunhofer_mask --pupil 6 --photographic --set glare.lid_open=0.5
for model in luidolt_eq12 krawczyk_larson larson_increment jacobs_bands; do
    picture $model charts 24 $night --model acuity=$model --photographic
done
for model in jacobs_mesopic mes2 luidolt_tint krawczyk_tint; do
    picture $model starlight 60 $night --model mesopic=$model --photographic
done
picture rod_noise starlight 60 $night --model noise=rod_noise --photographic
picture foveal_scotoma starlight 60 $night --model scotoma=foveal_scotoma --photographic --set scotoma.inner_deg=1.8 --set scotoma.outer_deg=4.5
for model in dioptric_disc liu_range; do
    picture $model day 60 $night --model dof=$model --set dof.focus_dioptre=3 --pupil 6
done
printf 'time_s,blink\n0,0\n1,1\n' >"$work/blink.csv"
picture blink day 60 $night --trace "$work/blink.csv" --at 1.07 --model eyelid=blink

# The same room for a tracker's pupil of 2.5 and of 6 mm, this user's before a white and a black frame: 2 and 8 mm, seen in the depth of field.
case "$wanted" in
*" luidolt_pupil "* | "  ")
    for frame in white:2.5 black:6; do
        "$programs/entoptic" simulate "$work/day/left.exr" -o "$output/luidolt_pupil_${frame%%:*}.png" --fov 60 --preset off $night --model pupil=luidolt_pupil \
            --pupil "${frame#*:}" --model dof=dioptric_disc --set dof.focus_dioptre=3 >/dev/null 2>"$work/log" || { cat "$work/log"; exit 1; }
        echo "  $output/luidolt_pupil_${frame%%:*}.png"
    done
    ;;
esac

# The whole picture shows what the wearer does not see: reduction 4, the gaze on the chart.
case "$wanted" in
*" visual_polar "* | "  ")
    "$programs/entoptic-demo" --offscreen "$work/wide" --size 560x420 --fov 90 --light day --lamp off >"$work/log" 2>&1 || { cat "$work/log"; exit 1; }
    "$programs/entoptic" simulate "$work/wide/left.exr" -o "$output/visual_polar.png" --fov 90 --preset off $night --gaze=0,8 --set foveation.inverse=exact \
        --set foveation.reduction=4 >/dev/null 2>"$work/log" || { cat "$work/log"; exit 1; }
    echo "  $output/visual_polar.png"
    ;;
esac

# Three seconds with the gaze on the burning lamp, then it is switched off.
case "$wanted" in
*" jacobs "* | "  ")
    for i in 00 01 02 03 04 05 06 07 08 09 10 11; do cp "$work/lamp/left.exr" "$work/after_$i.exr"; done
    cp "$work/starlight/left.exr" "$work/after_12.exr"
    "$programs/entoptic" simulate "$work/after_%02d.exr" --fps 4 -o "$work/seen_%02d.png" --fov 60 --gaze=-20,-9 --set afterimage.j1=0.1 --preset off $night \
        --model afterimage=jacobs --photographic >/dev/null 2>"$work/log" || { cat "$work/log"; exit 1; }
    cp "$work/seen_12.png" "$output/jacobs.png"
    echo "  $output/jacobs.png"
    ;;
esac

# Figure 5 of Jacobs 2015: flashes of 1e3 (below) to 1e8 cd/m² for 1/8 s, and what is left of them after some seconds.
case "$wanted" in
*" jacobs_figure5 "* | "  ")
    mkdir -p "$work/flashes"
    "$programs/entoptic" stimulus flash_series -o "$work/flashes/in_%04d.exr" --size 120x120 --fov 16 --fps 8 --seconds 5 >"$work/log" 2>&1 || { cat "$work/log"; exit 1; }
    "$programs/entoptic" simulate "$work/flashes/in_%04d.exr" --fps 8 -o "$work/flashes/out_%04d.png" --fov 16 --preset jacobs2015 --model glare=none \
        --set afterimage.j1=0.1 --adapted-to 100 >/dev/null 2>"$work/log" || { cat "$work/log"; exit 1; }
    for after in 0005:0 0009:0.5 0013:1 0021:2 0037:4; do
        cp "$work/flashes/out_${after%%:*}.png" "$output/jacobs_figure5_${after#*:}s.png"
        echo "  $output/jacobs_figure5_${after#*:}s.png"
    done
    ;;
esac

# Figure 5 of Kakimoto 2004: a lamp of two pixels through six apertures.
case "$wanted" in
*" kakimoto_figure5 "* | "  ")
    "$programs/entoptic" stimulus point_light -o "$work/point_%04d.exr" --size 200x200 --fov 14 --fps 1 --seconds 1 >"$work/log" 2>&1 || { cat "$work/log"; exit 1; }
    aperture() {
        letter=$1
        shift
        "$programs/entoptic" simulate "$work/point_0000.exr" -o "$output/kakimoto_figure5_$letter.png" --fov 14 --preset kakimoto2004 --set glare.wavelengths=16 \
            --set glare.three_lines=0 --set glare.texel_px=1 --set glare.near_px=24 "$@" >/dev/null 2>"$work/log" || { cat "$work/log"; exit 1; }
        echo "  $output/kakimoto_figure5_$letter.png"
    }
    open="--set glare.lids=0 --set glare.lashes=0"
    aperture a --pupil 8 --set glare.lid_open=0.5
    aperture b --pupil 2 --set glare.lid_open=0.5
    aperture c --pupil 6 --set glare.lid_open=0.5
    aperture d --pupil 6 $open --set glare.filter_directions=2
    aperture e --pupil 6 $open --set glare.filter_directions=3
    aperture f --pupil 6 $open --set glare.blades=6
    ;;
esac
