"""Files that lie about themselves, and small whole ones of the same kinds. Standard library only."""
import struct


def _attribute(name, kind, value):
    return name.encode() + b"\0" + kind.encode() + b"\0" + struct.pack("<i", len(value)) + value


def exr_header(width, height, tiled=False):
    """Of a float RGB EXR without compression whose windows say width x height."""
    channels = b"".join(c + b"\0" + struct.pack("<iB3xii", 2, 0, 1, 1) for c in (b"B", b"G", b"R")) + b"\0"
    window = struct.pack("<iiii", 0, 0, width - 1, height - 1)
    head = struct.pack("<ii", 20000630, 2 | (0x200 if tiled else 0))
    head += _attribute("channels", "chlist", channels) + _attribute("compression", "compression", b"\0")
    head += _attribute("dataWindow", "box2i", window) + _attribute("displayWindow", "box2i", window)
    head += _attribute("lineOrder", "lineOrder", b"\0") + _attribute("pixelAspectRatio", "float", struct.pack("<f", 1))
    head += _attribute("screenWindowCenter", "v2f", struct.pack("<ff", 0, 0))
    head += _attribute("screenWindowWidth", "float", struct.pack("<f", 1))
    if tiled:
        head += _attribute("tiles", "tiledesc", struct.pack("<IIB", 0x7FFFFFFF, 0x7FFFFFFF, 0))
    return head + b"\0"


def exr_bytes(width=16, height=8):
    """A whole one, every channel 0.5."""
    head = exr_header(width, height)
    line = struct.pack(f"<{3 * width}f", *[0.5] * (3 * width))
    first = len(head) + 8 * height
    offsets = b"".join(struct.pack("<Q", first + y * (8 + len(line))) for y in range(height))
    return head + offsets + b"".join(struct.pack("<ii", y, len(line)) + line for y in range(height))


def hair_header(strands, points, arrays=2, segments=9):
    return struct.pack("<4sIIIIfffff", b"HAIR", strands, points, arrays, segments, 0.01, 0, 0.5, 0.5, 0.5)[:40].ljust(128, b"\0")


def hostile_hair():
    """By name: bytes that no hair reader may believe."""
    return {
        "4 G points": hair_header(1, 0xFFFFFFFF),
        "4 G strands": hair_header(0xFFFFFFFF, 4, segments=1) + bytes(48),
        "4 G points and room for ten": hair_header(1, 0xFFFFFFFF, segments=0xFFFFFFFE) + bytes(120),
        "segments that end elsewhere": hair_header(2, 4, arrays=3) + struct.pack("<HH", 65535, 65535) + bytes(48),
        "no number": hair_header(1, 10) + struct.pack("<f", float("nan")) * 30,
        "unknown arrays": hair_header(1, 10, arrays=0xFFFFFFFF) + bytes(120),
        "JSON": b'{"hair": ' * 1000,
        "nothing": b"",
    }


def hostile_environments():
    whole, hdr = exr_bytes(), b"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n"
    return {
        "EXR of 2^31 pixels a side": exr_header(0x7FFFFFFF, 0x7FFFFFFF) + bytes(64),
        "EXR of 2^30 x 2": exr_header(1 << 30, 2) + bytes(64),
        "EXR of negative size": exr_header(-5, -5) + bytes(64),
        "EXR of absurd tiles": exr_header(64, 32, tiled=True) + bytes(64),
        "EXR without pixels": whole[:len(exr_header(16, 8)) + 64],
        "EXR cut in a line": whole[:-100],
        "EXR cut in the header": whole[:60],
        "EXR whose lines lie outside": whole[:len(exr_header(16, 8))] + b"\xff" * 64 + whole[len(exr_header(16, 8)) + 64:],
        "HDR of 10^9 a side": hdr + b"-Y 999999999 +X 999999999\n",
        "HDR of 2^31 a side": hdr + b"-Y 2147483648 +X 2147483648\n" + bytes(100),
        "HDR of negative size": hdr + b"-Y -8 +X 16\n" + bytes(100),
        "HDR cut short": hdr + b"-Y 8 +X 16\n" + bytes([128, 64, 32, 129]) * 100,
        "HDR whose runs are too long": hdr + b"-Y 8 +X 16\n" + (b"\2\2\0\x10" + b"\xff\1" * 64) * 8,
        "nothing": b"",
    }
