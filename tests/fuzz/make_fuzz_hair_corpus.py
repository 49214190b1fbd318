"""Writes a small seed corpus of HAIR files into a folder: every combination of the arrays over a few strands."""
import struct
import sys
from pathlib import Path

SEGMENTS, POINTS, THICKNESS, TRANSPARENCY, COLORS = 1, 2, 4, 8, 16


def hair_file(arrays, segments):
    count = sum(s + 1 for s in segments)
    data = struct.pack("<4s4I5f88s", b"HAIR", len(segments), count, arrays, segments[0] if segments else 0,
                       0.01, 0.0, 0.5, 0.3, 0.1, b"seed")
    if arrays & SEGMENTS:
        data += struct.pack(f"<{len(segments)}H", *segments)
    for bit, floats in ((POINTS, 3), (THICKNESS, 1), (TRANSPARENCY, 1), (COLORS, 3)):
        if arrays & bit:
            data += struct.pack(f"<{floats * count}f", *(0.5 + 0.01 * i for i in range(floats * count)))
    return data


def main():
    folder = Path(sys.argv[1])
    folder.mkdir(parents=True, exist_ok=True)
    for arrays in range(32):
        for number, segments in enumerate(([], [0], [2, 2], [0, 3, 1])):
            (folder / f"seed_{arrays}_{number}.hair").write_bytes(hair_file(arrays, segments))
    (folder / "header_only").write_bytes(hair_file(POINTS, [])[:128])


if __name__ == "__main__":
    main()
