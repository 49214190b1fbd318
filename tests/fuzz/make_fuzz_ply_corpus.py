"""Writes a small seed corpus of PLY files into a folder: text and both byte orders, all types, strips."""
import struct
import sys
from pathlib import Path

VERTEX = "element vertex 4\nproperty float x\nproperty float y\nproperty float z\n"
FACE = "element face 2\nproperty list uchar int vertex_indices\n"
POINTS = [(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0)]
TEXT_POINTS = "".join(f"{x} {y} {z}\n" for x, y, z in POINTS)


def header(kind, body):
    return f"ply\nformat {kind} 1.0\ncomment seed\n{body}end_header\n".encode()


def binary(order):
    kind = "binary_big_endian" if order == ">" else "binary_little_endian"
    body = "element a 1\nproperty list ushort double b\n" + VERTEX.replace("float x", "double x").replace(
        "float y", "short y") + "property uchar red\n" + "property float nx\nproperty float ny\nproperty float nz\n" + FACE
    data = struct.pack(order + "Hdd", 2, 1.5, 2.5)
    for x, y, z in POINTS:
        data += struct.pack(order + "dhfBfff", x, y, z, 255, 0, 0, 1)
    return header(kind, body) + data + struct.pack(order + "BiiiBiii", 3, 0, 1, 2, 3, 0, 2, 3)


SEEDS = {
    "text": header("ascii", VERTEX + FACE) + (TEXT_POINTS + "3 0 1 2\n3 0 2 3\n").encode(),
    "carriage": (header("ascii", VERTEX + FACE) + (TEXT_POINTS + "3 0 1 2\n3 0 2 3\n").encode()).replace(b"\n", b"\r\n"),
    "strips": header("ascii", VERTEX + "element tristrips 1\nproperty list int int vertex_indices\n")
    + (TEXT_POINTS + "7 0 1 3 -1 1 2 3\n").encode(),
    "little": binary("<"),
    "big": binary(">"),
    "counts": header("binary_little_endian", VERTEX.replace("4", "4000000000") + FACE) + bytes(200),
    "numbers": header("ascii", VERTEX + FACE) + b"nan inf 1e400\n-1e18 +1 .5\n0x1 1. 2\n",
}


def main():
    folder = Path(sys.argv[1])
    folder.mkdir(parents=True, exist_ok=True)
    for name, data in SEEDS.items():
        (folder / f"{name}.ply").write_bytes(data)


if __name__ == "__main__":
    main()
