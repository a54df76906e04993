#!/usr/bin/env python3
"""Writes an EDID 1.4 (VESA E-EDID A.2) of a Vive Pro's panel: vendor HVR, product 0xaa02, 2880x1600 at 90.04 Hz, 1624 lines in all. The
blanking beside the lines is this file's own choice: no dump of a real Vive Pro's EDID was at hand.

    vive_panel_edid.py FILE [WIDTHxHEIGHT]"""
import sys

WIDTH, HEIGHT, BLANK, LINES, HZ = 2880, 1600, 80, 24, 90.04


def timing(width, height):
    clock = round((width + BLANK) * (height + LINES) * HZ / 10_000)
    front, pulse, line_front, line_pulse = 8, 32, 3, 8
    return bytes([clock & 255, clock >> 8, width & 255, BLANK, width >> 8 << 4 | BLANK >> 8, height & 255, LINES,
                  height >> 8 << 4 | LINES >> 8, front, pulse, line_front << 4 | line_pulse, 0, 122, 68, 0, 0, 0, 0x1a])


def text(kind, words):
    return bytes([0, 0, 0, kind, 0]) + (words + "\n").ljust(13).encode("ascii")


def edid(width, height):
    vendor = bytes([0x22, 0xd2])                       # H V R, five bits each
    block = bytes([0, 255, 255, 255, 255, 255, 255, 0]) + vendor + (0xaa02).to_bytes(2, "little") + (1).to_bytes(4, "little")
    block += bytes([1, 28, 1, 4])                      # week 1 of 2018, EDID 1.4
    block += bytes([0xa5, 12, 7, 120, 0x06])           # digital DisplayPort 8 bit, size in cm, gamma 2.2, preferred mode is native
    block += bytes([0xee, 0x91, 0xa3, 0x54, 0x4c, 0x99, 0x26, 0x0f, 0x50, 0x54])   # sRGB's primaries and white
    block += bytes(3) + bytes([1, 1] * 8)              # no established, no standard timings
    block += timing(width, height) + text(0xfc, "VIVE Pro") + text(0xff, "EMULATED") + text(0xfe, "") + bytes(1)
    assert len(block) == 127, len(block)
    return block + bytes([-sum(block) % 256])


if __name__ == "__main__":
    if len(sys.argv) not in (2, 3):
        sys.exit(__doc__)
    size = tuple(int(n) for n in sys.argv[2].split("x")) if len(sys.argv) == 3 else (WIDTH, HEIGHT)
    with open(sys.argv[1], "wb") as out:
        out.write(edid(*size))
