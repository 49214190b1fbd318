#!/usr/bin/env python3
"""Compares what two builds of hairbake bake: for a change that must not change a number.

Usage: same_numbers.py BEFORE AFTER [NAME..]
    BEFORE, AFTER  build folders (bin/hairbake, and BEFORE/bin/labelled_cube_pictures)
    NAME           only bakes whose names contain one of these words

Bakes some thirty requests with both programs, in /tmp/hairbake-same-numbers, where results of BEFORE are kept for the
next run. Compares every file byte by byte; of EXR files that differ the pixels, of KTX2 files the texels (their text may
change). Compares the id, and the manifest's blocks that hold numbers. Prints a line a bake; exit code 0 when all are the same.
"""
import hashlib
import json
import shutil
import struct
import subprocess
import sys
from pathlib import Path

WORK = Path("/tmp/hairbake-same-numbers")
DATA = Path(__file__).resolve().parents[3] / "shared" / "data"
NUMBERS = ("transmittance", "error_bar", "irradiance", "inputs", "repairs", "stages")
LIGHT = '{"direction": [0, 1, 0.5], "irradiance": [3, 3, 2.5]}'


def run(program, *arguments):
    done = subprocess.run([str(program), *map(str, arguments)], capture_output=True, text=True, check=False)
    return done.returncode, done.stderr.strip()


def make_inputs(before):
    if (WORK / "cubes").is_dir():
        return
    run(before / "bin/hairbake", "sample", WORK / "sample", "--vertices", 60000, "--style", "wavy")
    run(before / "bin/hairbake", "sample", WORK / "small", "--vertices", 3000, "--style", "curly", "--map-width", 256)
    (WORK / "cubes").mkdir()
    run(before / "bin/labelled_cube_pictures", WORK / "cubes")


def settings(**fields):
    """--set for each field; "__" stands for "." """
    return [word for name, value in fields.items() for word in ("--set", f"{name.replace('__', '.')}={value}")]


def hair_bakes(sample, small):
    hair, head = ["--hair", sample / "groom.hair"], sample / "head.obj"
    small_hair = ["--hair", small / "groom.hair", "--occluder", small / "head.obj", "--receiver", small / "head.obj"]
    directional = {"transmittance__sh_bands": 2, "transmittance__bent_cone": "true"}
    return {
        "occluder_receiver": [*hair, "--occluder", head, "--receiver", head, "--outputs", "npy,hair,raw,glb,vdb",
                              *settings(**directional)],
        "receiver_alone": [*hair, "--receiver", head, *settings(transmittance__voxels=128)],
        "stratified_512": [*hair, *settings(transmittance__voxels=512, transmittance__directions=49, strand__opacity=0.5,
                                            transmittance__direction_set="stratified", strand__width_scale=2)],
        "random_few": [*hair, *settings(transmittance__directions=3, transmittance__direction_set="random",
                                        transmittance__sh_bands=3)],
        "trace": [*small_hair, *settings(transmittance__method="trace", transmittance__directions=36, **directional)],
        "opacity_maps": [*hair, "--receiver", head, *settings(transmittance__method="opacity_maps", **directional)],
    }


def map_bakes(sample, small):
    sky = ["--env", sample / "sky.hdr"]
    edit = settings(irradiance__rotation_deg="10,20,30", irradiance__exposure_stops=1.5, irradiance__tint="1,0.5,0.25")
    return {
        "sh_auto": [*sky, "--method", "sh", "--outputs", "npy,exr,ktx2,dds,raw"],
        "lights": [*sky, "--specular-maps", 9, *settings(irradiance__lights=f"[{LIGHT}]"), *edit],
        "lights_sh": [*sky, "--method", "sh", "--sh-bands", 12, *settings(irradiance__lights=f"[{LIGHT}]",
                                                                          irradiance__clamp_negative="false")],
        "filament": [*sky, "--face-size", 8, *settings(irradiance__latlong="filament")],
        "openexr": [*sky, "--face-size", 4, *settings(irradiance__latlong="openexr")],
        "p0": [*sky, "--exponent", 0, "--face-size", 8, "--specular-maps", 5],
        "p1.5": [*sky, "--exponent", 1.5, "--face-size", 8, "--specular-maps", 2],
        "p512": [*sky, "--exponent", 512, "--face-size", 32, "--specular-maps", 17],
        "face_32": ["--env", small / "studio.hdr", "--face-size", 32, "--specular-maps", 65, "--exponent", 16],
        "result_as_strip": ["--env", WORK / "before/default/diffuse.exr", "--layout", "vertical_strip"],
    }


def bakes():
    """Command lines by name. Fields stand at the places of the first version, which every version takes."""
    sample, small = WORK / "sample", WORK / "small"
    both = ["--hair", sample / "groom.hair", "--env"]
    found = {
        "default": [*both, sample / "sky.hdr"],
        "all_outputs": [*both, sample / "sky.hdr", "--outputs", "npy,exr,hair,ktx2,dds,raw,glb,vdb",
                        *settings(transmittance__sh_bands=4, transmittance__bent_cone="true")],
        "paper": [*both, sample / "studio.hdr", "--preset", "paper"],
        "draft": [*both, sample / "overcast.hdr", "--preset", "draft"],
        **hair_bakes(sample, small), **map_bakes(sample, small),
    }
    for layout in ("horizontal_cross", "vertical_cross", "horizontal_strip", "vertical_strip"):
        found[f"cube_{layout}"] = ["--env", WORK / "cubes" / f"layout_{layout}.png", "--face-size", 8]
    for file in sorted([*DATA.glob("hair/**/*.hair"), *DATA.glob("hair/**/*.tfx")]):
        width = ["--width", 0.05] if file.suffix == ".tfx" else []
        found[f"real_{file.stem}"] = ["--hair", file, *width, *settings(transmittance__bent_cone="true")]
    for file in sorted([*DATA.glob("env/*.hdr"), *DATA.glob("env/*.exr")]):
        found[f"real_{file.stem}"] = ["--env", file, "--face-size", 8, *settings(irradiance__invalid_radiance="clamp")]
    return found


def content(file):
    """What must be equal of a file whose bytes differ."""
    data = file.read_bytes()
    if file.suffix == ".exr":
        info = subprocess.run(["oiiotool", "--hash", "--info", str(file)], capture_output=True, text=True, check=True)
        return info.stdout.split("SHA-1:")[-1]
    if file.suffix == ".ktx2":
        offset, size = struct.unpack_from("<QQ", data, 80)
        return hashlib.sha256(data[offset:offset + size]).hexdigest()
    return hashlib.sha256(data).hexdigest()


def bake(build, arguments, folder):
    """The manifest, or the exit code of a refusal."""
    if not (folder / "manifest.json").exists():
        folder.parent.mkdir(parents=True, exist_ok=True)
        code, message = run(build / "bin/hairbake", "bake", *arguments, "--out", folder, "--progress", "none")
        if code:
            return {"refused": code, "message": message}
    return json.loads((folder / "manifest.json").read_text())


def differences(before, after, first, second):
    if "refused" in first or "refused" in second:
        return [] if first.get("refused") == second.get("refused") else [f"{first.get('message')} / {second.get('message')}"]
    found = [key for key in ("id", *NUMBERS) if first.get(key) != second.get(key)]
    names = {file.name for folder in (before, after) for file in folder.iterdir()} - {"manifest.json"}
    for name in sorted(names):
        pair = before / name, after / name
        if not all(file.exists() for file in pair):
            found.append(f"{name} is missing on one side")
        elif pair[0].read_bytes() != pair[1].read_bytes() and content(pair[0]) != content(pair[1]):
            found.append(name)
    return found


def main():
    before, after = (Path(folder).resolve() for folder in sys.argv[1:3])
    words, worst = sys.argv[3:], 0
    WORK.mkdir(exist_ok=True)
    make_inputs(before)
    for name, arguments in bakes().items():
        if words and not any(word in name for word in words):
            continue
        folders = WORK / "before" / name, WORK / "after" / name
        shutil.rmtree(folders[1], ignore_errors=True)
        found = differences(*folders, bake(before, arguments, folders[0]), bake(after, arguments, folders[1]))
        print(f"{'differs' if found else 'same'}: {name}{': ' if found else ''}{', '.join(found)}", flush=True)
        worst = worst or int(bool(found))
    return worst


if __name__ == "__main__":
    sys.exit(main())
