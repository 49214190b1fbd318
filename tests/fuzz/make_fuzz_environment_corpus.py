"""Seeds for fuzz_environment: PFM and HDR pictures of every layout, and some that are no environment.

Usage: make_fuzz_environment_corpus.py FOLDER
"""
import struct
import sys
from pathlib import Path

SIZES = {"latlong": (8, 4), "horizontal_cross": (8, 6), "vertical_cross": (6, 8), "horizontal_strip": (12, 2),
         "vertical_strip": (2, 12), "odd_faces": (9, 12), "square": (4, 4), "point": (2, 1), "single": (1, 6)}


def value(i):
    return (i % 7) * 0.25 + 2.0 ** (i % 11 - 5)


def pfm(width, height, change=lambda values: values, channels=3):
    values = change([value(i) for i in range(width * height * channels)])
    head = f"{'PF' if channels == 3 else 'Pf'}\n{width} {height}\n-1.0\n".encode()
    return head + struct.pack(f"<{len(values)}f", *values)


def hdr(width, height):
    head = f"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y {height} +X {width}\n".encode()
    return head + bytes(byte for i in range(width * height) for byte in (i * 37 % 256, i * 91 % 256, 200, 120 + i % 20))


def spoiled(bad):
    def change(values):
        values[5] = bad
        return values
    return change


def main():
    folder = Path(sys.argv[1])
    folder.mkdir(parents=True, exist_ok=True)
    for name, (width, height) in SIZES.items():
        (folder / f"{name}.pfm").write_bytes(pfm(width, height))
        (folder / f"{name}_grey.pfm").write_bytes(pfm(width, height, channels=1))
        (folder / f"{name}.hdr").write_bytes(hdr(width, height))
    for name, bad in {"negative": -3.0, "nan": float("nan"), "infinite": float("inf"), "tiny": -1e-40}.items():
        for layout in ("latlong", "vertical_cross"):
            (folder / f"{layout}_{name}.pfm").write_bytes(pfm(*SIZES[layout], spoiled(bad)))


if __name__ == "__main__":
    main()
