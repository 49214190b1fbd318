"""Reads the half-float containers of maps with numpy and ktx-parse and compares them with the .npy files beside them.

Usage: check_half_maps.py ktx2|dds|raw FOLDER SCALE. Prints what it found, or ends with an exception.
"""
import json
import subprocess
import sys
from pathlib import Path

import numpy as np

NPM = Path(__file__).resolve().parents[2] / "npm"
FACES = ["+X", "-X", "+Y", "-Y", "+Z", "-Z"]


def halves_of(values, scale):
    """What the container must hold, bit for bit: numpy rounds to the nearest half, ties to even."""
    stored = (values.astype(np.float64) / scale).astype(np.float32).astype(np.float16)
    return np.concatenate([stored, np.ones(stored.shape[:-1] + (1,), np.float16)], axis=-1)


def same_bits(found, expected, what):
    assert found.shape == expected.shape, (what, found.shape, expected.shape)
    assert np.array_equal(found.view(np.uint16), expected.view(np.uint16)), what


def check_scale(maps, scale):
    largest = max(np.abs(m).max() for m in maps) / scale
    assert largest <= 65504 and (scale == 1 or largest > 32752), (largest, scale)


# ---- ktx2 ------------------------------------------------------------------------------------------------------------

def read_ktx2(file):
    level = file.with_suffix(".level")
    run = subprocess.run(["node", NPM / "read_ktx2.mjs", file, level], capture_output=True, text=True)
    assert run.returncode == 0, run.stderr + "\n(./dev test installs what this needs)"
    return json.loads(run.stdout), np.fromfile(level, "<f2")


def check_ktx2(folder, diffuse, specular, scale):
    for name, values, layers in [("diffuse", diffuse[None], 0), ("specular", specular, len(specular))]:
        header, level = read_ktx2(folder / (name + ".ktx2"))
        n = diffuse.shape[1]
        expected = {"vkFormat": 97, "typeSize": 2, "pixelWidth": n, "pixelHeight": n, "pixelDepth": 0,
                    "layerCount": layers, "faceCount": 6, "levelCount": 1, "levels": 1, "supercompressionScheme": 0}
        for key, value in expected.items():
            assert header[key] == value, (name, key, header[key], value)
        [format] = header["dataFormatDescriptor"]
        assert (format["colorModel"], format["colorPrimaries"], format["transferFunction"]) == (1, 4, 1), format
        assert [s["channelType"] & 15 for s in format["samples"]] == [0, 1, 2, 15]
        texts = header["texts"]
        assert list(texts) == sorted(texts)
        assert texts["KTXorientation"] == "rd" and texts["KTXwriter"].startswith("hairbake ")
        assert texts["hairbake:map"] == name and texts["hairbake:model"] == "kajiya-kay"
        assert texts["hairbake:faceOrder"].split() == FACES and texts["hairbake:primaries"] == "Rec.2020"
        assert float(texts["hairbake:scale"]) == scale and float(texts["hairbake:exponent"]) == 64
        assert texts["hairbake:units"] and texts["hairbake:frame"]
        if name == "specular":
            angles = [float(t) for t in texts["hairbake:thetaPrimeDeg"].split()]
            assert angles == list(np.linspace(0, 180, layers)) and int(texts["hairbake:specularMaps"]) == layers
        same_bits(level.reshape(values.shape[:-1] + (4,)), halves_of(values, scale), name)
        # The level begins at a multiple of 8 and is the end of the file.
        raw = (folder / (name + ".ktx2")).read_bytes()
        offset = int.from_bytes(raw[80:88], "little")
        assert offset % 8 == 0 and offset + level.nbytes == len(raw)
    return radiance_of(level.reshape(-1, 6, n, n, 4)[0], scale)


def radiance_of(cube, scale):
    return cube[..., :3].astype(np.float64) * scale


# ---- dds -------------------------------------------------------------------------------------------------------------

def solid_angles(n):
    """By 3 x 3 Gauss points a texel; the relative error is below 1e-5 for n >= 4."""
    points, weights = np.polynomial.legendre.leggauss(3)
    x = ((np.arange(n) + 0.5)[:, None] + points / 2) * 2 / n - 1
    w = np.tile(weights / n, (n, 1))
    a, b = x.reshape(-1)[None], x.reshape(-1)[:, None]
    dense = w.reshape(-1)[None] * w.reshape(-1)[:, None] / (1 + a * a + b * b) ** 1.5
    return dense.reshape(n, 3, n, 3).sum((1, 3))


def check_dds(folder, diffuse, specular, scale):
    n = diffuse.shape[1]
    sizes = [n]
    while sizes[-1] > 1:
        sizes.append(sizes[-1] // 2)
    names = ["diffuse"] + ["specular_%02d" % m for m in range(len(specular))]
    for name, values in zip(names, [diffuse, *specular]):
        raw = (folder / (name + ".dds")).read_bytes()
        header = np.frombuffer(raw[:148], "<u4")
        assert raw[:4] == b"DDS " and list(header[1:8]) == [124, 0x2100F, n, n, 8 * n, 0, len(sizes)]
        assert list(header[19:21]) == [32, 4] and raw[84:88] == b"DX10" and list(header[27:29]) == [0x401008, 0xFE00]
        assert list(header[32:]) == [10, 3, 4, 1, 0]
        assert not header[8:19].any() and not header[22:27].any() and not header[29:32].any()
        faces = np.frombuffer(raw[148:], "<f2").reshape(6, -1)
        assert faces.shape[1] == 4 * sum(s * s for s in sizes)
        begin = 0
        for size in sizes:
            level = faces[:, begin:begin + 4 * size * size].reshape(6, size, size, 4)
            begin += 4 * size * size
            if size == n:
                same_bits(level, halves_of(values, scale), name)
            assert (level[..., 3] == 1).all()
            if n % size or n & (n - 1):
                continue  # the mean over odd sizes is tested in C++
            # The mean over solid angle of level 0, straight: right however many levels lie between. A half float errs by
            # 2^-12 of the value or 2^-25.
            weights = solid_angles(n)[None, :, :, None]
            k = n // size
            blocks = lambda x: x.reshape(x.shape[0], size, k, size, k, x.shape[-1]).sum((2, 4))
            mean = blocks(values.astype(np.float64) * weights) / blocks(weights)
            error = np.abs(radiance_of(level, scale) - mean)
            bound = np.abs(blocks(np.abs(values) * weights) / blocks(weights)) * (2.0 ** -11 + 1e-5) + 2.0 ** -24 * scale
            assert (error <= bound).all(), (name, size, (error / bound).max())
    return radiance_of(np.frombuffer((folder / "diffuse.dds").read_bytes()[148:], "<f2")
                        .reshape(6, -1)[:, :4 * n * n].reshape(6, n, n, 4), scale)


# ---- raw -------------------------------------------------------------------------------------------------------------

def check_raw(folder, diffuse, specular, scale):
    page = json.loads((folder / "maps.json").read_text())
    n = diffuse.shape[1]
    data = (folder / page["file"]).read_bytes()
    assert page["type"] == "float16" and page["byte_order"] == "little" and page["channels"] == "RGBA"
    assert page["shape"] == [1 + len(specular), 6, n, n, 4] and page["face_size"] == n and page["faces"] == FACES
    assert page["scale"] == scale and page["exponent"] == 64 and page["model"] == "kajiya-kay"
    assert page["primaries"] == "Rec.2020" and page["rows"] == "from the top"
    assert [m["name"] for m in page["maps"]] == ["diffuse"] + ["specular"] * len(specular)
    assert [m["theta_prime_deg"] for m in page["maps"][1:]] == list(np.linspace(0, 180, len(specular)))
    assert sum(m["bytes"] for m in page["maps"]) == len(data)
    for entry, values in zip(page["maps"], [diffuse, *specular]):
        found = np.frombuffer(data, "<f2", entry["bytes"] // 2, entry["offset"]).reshape(6, n, n, 4)
        same_bits(found, halves_of(values, scale), entry)
    return radiance_of(np.frombuffer(data, "<f2", 6 * n * n * 4).reshape(6, n, n, 4), scale)


# ---- orientation -----------------------------------------------------------------------------------------------------

def check_labelled(cube):
    """The labelled cube, by the table of the OpenGL specification: s to the right and t down select the direction r with
    s = (sc / |ma| + 1) / 2, t = (tc / |ma| + 1) / 2."""
    table = {"+X": ("-z", "-y", "+x"), "-X": ("+z", "-y", "-x"), "+Y": ("+x", "+z", "+y"),
             "-Y": ("+x", "-z", "-y"), "+Z": ("+x", "-y", "+z"), "-Z": ("-x", "-y", "-z")}
    n = cube.shape[1]
    at = (2 * np.arange(n) + 1) / n - 1
    for face, name in enumerate(FACES):
        direction = np.empty((n, n, 3))
        for value, axis in zip((at[None, :], at[:, None], 1.0), table[name]):
            direction[..., "xyz".index(axis[1])] = value if axis[0] == "+" else -np.asarray(value)
        colour = np.where(direction > 0.75, 1, np.where(direction < -0.75, 1 / 16, 0.5))
        arrow, letters = (cube[face] == 0).all(-1), (cube[face] == 4).all(-1)
        plain = ~arrow & ~letters
        assert np.array_equal(cube[face][plain], colour[plain]), name
        rows = np.nonzero(arrow)[0]
        assert rows.size > 4 and rows.max() < n / 2 - 1, (name, "the arrow points up")
        widths = [arrow[row].sum() for row in range(rows.min(), rows.max() + 1)]
        assert widths[0] < widths[-1] and letters.sum() > 10, (name, widths)


def main():
    kind, folder, scale = sys.argv[1], Path(sys.argv[2]), float(sys.argv[3])
    diffuse, specular = np.load(folder / "diffuse.npy"), np.load(folder / "specular.npy")
    check_scale([diffuse, specular], scale)
    cube = {"ktx2": check_ktx2, "dds": check_dds, "raw": check_raw}[kind](folder, diffuse, specular, scale)
    labelled = "labelled" in sys.argv[4:]
    if labelled:
        check_labelled(cube)
    print("read, oriented" if labelled else "read")


main()
