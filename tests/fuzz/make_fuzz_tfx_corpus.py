"""Writes a small seed corpus of TressFX files, versions 3.0 and 4.0, with and without colours, into a folder."""
import struct
import sys
from pathlib import Path


def floats(count):
    return struct.pack(f"<{count}f", *(0.5 + 0.01 * i for i in range(count)))


def tfx_4(strands, points, colors):
    count = strands * points
    uv = 160 + 16 * count
    header = struct.pack("<f7I", 4.0, strands, points, 160, uv, 0, 0, uv + 8 * strands if colors else 0) + bytes(128)
    return header + floats(4 * count) + floats(2 * strands) + (floats(4 * count) if colors else b"")


def tfx_3(strands, points, colors):
    count = strands * points
    offsets = struct.pack("<6I", 296, 0, 0, 296 + 12 * count if colors else 0, 0, 0)
    header = struct.pack("<f4I", 3.0, strands, points, 4, 0) + bytes(124) + offsets + bytes(128)
    return header + floats(3 * count) + (floats(4 * count) if colors else b"")


def main():
    folder = Path(sys.argv[1])
    folder.mkdir(parents=True, exist_ok=True)
    for version, make in ((3, tfx_3), (4, tfx_4)):
        for colors in (False, True):
            for strands, points in ((0, 4), (1, 1), (1, 4), (3, 8)):
                (folder / f"seed_{version}_{colors}_{strands}_{points}.tfx").write_bytes(make(strands, points, colors))


if __name__ == "__main__":
    main()
