#!/usr/bin/env python3
"""Quality of approximations in JOD (10: no difference; one less: 75 % of people prefer the full path), by metrics that are not part of this
repository. Makes pictures of the demo's office with entoptic-demo and `entoptic simulate`, the full path's and the approximation's, and has
the metric compare them as they look on the example panel (130 to 0.04 cd/m2, sRGB). Prints a table in Markdown.

  tools/jod.py --foveated FOLDER    FovVideoVDP (github.com/gfxdisp/FovVideoVDP): foveated processing, which needs a metric that knows the gaze
  tools/jod.py --colour FOLDER      ColorVideoVDP (github.com/gfxdisp/ColorVideoVDP): depth of field, with its colours

FOLDER is a checkout. On Debian 12, with its Python: apt-get install python3-torch python3-torchvision python3-scipy python3-pil python3-tqdm; that
PyTorch, 1.13, wants indices of 64 bits: torch.int32 in pycvvdp/interp.py, function get_interpolants_quick, has to be torch.int64.
Both take some minutes on two CPU cores. Run it after a build, from the repository's folder.
"""
import argparse
import importlib
import math
import os
import subprocess
import sys
import tempfile
import types

WHITE, BLACK = 130.0, 0.04   # cd/m2, of the example panel
PIXELS_A_DEGREE = 13.85      # of the headset, in the mean


class Pictures:
    """What the programs draw, each picture once."""

    def __init__(self, programs, folder):
        self.programs, self.folder, self.known = programs, folder, {}

    def run(self, program, *arguments):
        done = subprocess.run([os.path.join(self.programs, program), *arguments], capture_output=True, text=True, check=False)
        if done.returncode != 0:
            sys.exit(f"{program} {' '.join(arguments)}\nfailed: {done.stderr}{done.stdout}")

    def once(self, key, draw):
        if key not in self.known:
            self.known[key] = os.path.join(self.folder, str(len(self.known)))
            draw(self.known[key])
        return self.known[key]

    def scene(self, size, fov, light):
        draw = lambda path: self.run("entoptic-demo", "--offscreen", path, "--size", f"{size[0]}x{size[1]}", "--fov", f"{fov:g}", *light)
        return os.path.join(self.once(("scene", size, fov, light), draw), "left.exr")

    def seen(self, size, fov, light, options):
        scene = self.scene(size, fov, light)
        draw = lambda path: self.run("entoptic", "simulate", scene, "-o", path + ".png", "--fov", f"{fov:g}", *options)
        return self.once(("seen", scene, options), draw) + ".png"


def load(path):
    import numpy
    from PIL import Image
    return numpy.asarray(Image.open(path).convert("RGB"))


def import_metric(folder, name):
    """The metric's package. Of what it imports for video files and plots, which are not needed here, empty modules stand in when missing."""
    sys.path.insert(0, folder)
    for missing in ("imageio", "imageio.v2", "ffmpeg", "einops", "einops.layers", "einops.layers.torch", "huggingface_hub", "pyexr", "cv2"):
        try:
            importlib.import_module(missing)
        except ImportError:
            module = types.ModuleType(missing)
            module.__getattr__ = lambda attribute: None if not attribute.startswith("__") else (_ for _ in ()).throw(AttributeError(attribute))
            sys.modules[missing] = module
    return importlib.import_module(name)


def foveated_metric(folder, size, fov):
    metric = import_metric(folder, "pyfvvdp")
    panel = metric.fvvdp_display_photo_eotf(WHITE, contrast=WHITE / BLACK, EOTF="sRGB")
    geometry = metric.fvvdp_display_geometry(size, fov_horizontal=fov)
    judge = metric.fvvdp(display_photometry=panel, display_geometry=geometry, foveated=True)

    def compare(test, reference, gaze_deg):
        import numpy
        per_radian = 0.5 * size[0] / math.tan(math.radians(fov / 2))
        fixation = numpy.array([size[0] / 2 + per_radian * math.tan(math.radians(gaze_deg[0])),
                                size[1] / 2 - per_radian * math.tan(math.radians(gaze_deg[1])) / math.cos(math.radians(gaze_deg[0]))])
        return float(judge.predict(test, reference, dim_order="HWC", fixation_point=fixation)[0])
    return compare, judge.get_info_string()


def colour_metric(folder, size):
    metric = import_metric(folder, "pycvvdp")
    panel = metric.vvdp_display_photo_eotf(WHITE, contrast=WHITE / BLACK, source_colorspace="sRGB")
    judge = metric.cvvdp(display_photometry=panel, display_geometry=metric.vvdp_display_geometry(size, ppd=PIXELS_A_DEGREE))
    return lambda test, reference: float(judge.predict(test, reference, dim_order="HWC")[0]), judge.get_info_string()


DAY, DUSK, LAMP = ("--light", "day", "--lamp", "off"), ("--light", "dusk", "--lamp", "off"), ("--light", "night", "--lamp", "on")


def foveated_table(pictures, folder):
    size, fov = (1040, 1156), 104.0
    compare, info = foveated_metric(folder, size, fov)
    print(f"{info}, {size[0]}x{size[1]}, {fov:g} degrees\n\n| picture | exact, reduction 1 | 2 | 3 | 4 | fitted, 2 |\n|---|---|---|---|---|---|")
    scenes = [("night with the lamp, gaze on the wall", LAMP, (0, 0), "combined"), ("night with the lamp, gaze on it", LAMP, (-20, -9), "combined"),
              ("dusk", DUSK, (0, 0), "combined"), ("dusk, `jacobs2015`", DUSK, (0, 0), "jacobs2015")]
    for what, light, gaze, preset in scenes:
        base = ("--preset", preset, f"--gaze={gaze[0]},{gaze[1]}")
        full = load(pictures.seen(size, fov, light, base))
        cells = []
        for inverse, reduction in (("exact", 1), ("exact", 2), ("exact", 3), ("exact", 4), ("fitted", 2)):
            more = ("--set", f"foveation.inverse={inverse}", "--set", f"foveation.reduction={reduction}")
            cells.append(f"{compare(load(pictures.seen(size, fov, light, base + more)), full, gaze):.2f}")
        print(f"| {what} | {' | '.join(cells)} |", flush=True)


def depth_of_field_table(pictures, folder):
    size = (640, 712)
    fov = 2 * math.degrees(math.atan(0.5 * size[0] / (PIXELS_A_DEGREE * 180 / math.pi)))
    compare, info = colour_metric(folder, size)
    print(f"{info}, {size[0]}x{size[1]}\n\n| approximation | of | focus 0.5/m, pupil 4 mm | focus 3/m, pupil 6 mm |\n|---|---|---|---|")
    disc, rng = ("--model", "dof=dioptric_disc"), ("--model", "dof=liu_range")
    put = lambda text: ("--set", f"dof.{text}")
    rows = [("`dioptric_disc`, `roulette` 1", disc + put("roulette=1"), "all pixels", disc),
            ("`dioptric_disc`, `max_radius_px` 16", disc + put("max_radius_px=16"), "32", disc),
            ("`dioptric_disc`, `max_radius_px` 8", disc + put("max_radius_px=8"), "32", disc),
            ("`liu_range`, `roulette` 1", rng + put("roulette=1"), "all pixels", rng),
            ("`liu_range`, `lca` 1 (coloured rows)", rng + put("lca=1"), "`dioptric_disc`, `lca` 1", disc + put("lca=1")),
            ("`liu_range` (equation 13)", rng, "`dioptric_disc` (equation 12)", disc),
            ("`liu_range`, `as_printed` 1", rng + put("as_printed=1"), "`liu_range`", rng),
            ("preset `liu2021`: coloured rows, roulette", rng + put("lca=1") + put("roulette=1"), "`dioptric_disc`, `lca` 1", disc + put("lca=1")),
            ("no depth of field", (), "`dioptric_disc`", disc)]
    eyes = [("--pupil", "4") + put("focus_dioptre=0.5"), ("--pupil", "6") + put("focus_dioptre=3")]
    tone = ("--preset", "off")
    for what, approximation, of, full in rows:
        cells = []
        for eye in eyes:
            see = lambda options: load(pictures.seen(size, fov, DAY, tone + options + (eye if options else eye[:2])))
            cells.append(f"{compare(see(approximation), see(full)):.2f}")
        print(f"| {what} | {of} | {' | '.join(cells)} |", flush=True)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--foveated", metavar="FOLDER", help="checkout of FovVideoVDP")
    parser.add_argument("--colour", metavar="FOLDER", help="checkout of ColorVideoVDP")
    parser.add_argument("--programs", default="build/dev/bin", help="where entoptic and entoptic-demo are")
    options = parser.parse_args()
    if not options.foveated and not options.colour:
        parser.error("name a metric's checkout with --foveated or --colour")
    with tempfile.TemporaryDirectory() as folder:
        pictures = Pictures(options.programs, folder)
        if options.foveated:
            foveated_table(pictures, options.foveated)
        if options.colour:
            depth_of_field_table(pictures, options.colour)


if __name__ == "__main__":
    main()
