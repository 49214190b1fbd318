"""Seeds for fuzz_environment: PFM and HDR pictures of every layout, OpenEXR of luminance and chroma, and some that are no
environment.

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


def luminance_chroma(width, height):
    """An uncompressed OpenEXR file of half floats: Y, and RY and BY in every second pixel of every second line."""
    def attribute(name, kind, data):
        return name + b"\0" + kind + b"\0" + struct.pack("<i", len(data)) + data

    channels = b"".join(name + struct.pack("<xiB3xii", 1, 0, step, step) for name, step in ((b"BY", 2), (b"RY", 2), (b"Y", 1)))
    window = struct.pack("<4i", 0, 0, width - 1, height - 1)
    head = struct.pack("<II", 20000630, 2) + b"".join((
        attribute(b"channels", b"chlist", channels + b"\0"), attribute(b"compression", b"compression", b"\0"),
        attribute(b"dataWindow", b"box2i", window), attribute(b"displayWindow", b"box2i", window),
        attribute(b"lineOrder", b"lineOrder", b"\0"), attribute(b"pixelAspectRatio", b"float", struct.pack("<f", 1)),
        attribute(b"screenWindowCenter", b"v2f", struct.pack("<2f", 0, 0)),
        attribute(b"screenWindowWidth", b"float", struct.pack("<f", 1)))) + b"\0"
    rows = [struct.pack(f"<{count}e", *(value(i) / 64 for i in range(count)))
            for count in (width if y % 2 else 2 * width for y in range(height))]
    rows = [struct.pack("<ii", y, len(row)) + row for y, row in enumerate(rows)]
    places = [len(head) + 8 * height + sum(map(len, rows[:y])) for y in range(height)]
    return head + struct.pack(f"<{height}Q", *places) + b"".join(rows)


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
    (folder / "luminance_chroma.exr").write_bytes(luminance_chroma(8, 4))
    (folder / "xyze.hdr").write_bytes(hdr(8, 4).replace(b"rle_rgbe", b"rle_xyze"))
    for name, bad in {"negative": -3.0, "nan": float("nan"), "infinite": float("inf"), "tiny": -1e-40}.items():
        for layout in ("latlong", "vertical_cross"):
            (folder / f"{layout}_{name}.pfm").write_bytes(pfm(*SIZES[layout], spoiled(bad)))


if __name__ == "__main__":
    main()
