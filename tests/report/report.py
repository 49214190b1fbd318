"""Makes the report: pictures, tables and the command line behind each, as build/report/index.html.

Usage: report.py ROOT PROGRAM FOLDER [--full | --tiny] [--data DIR] [--only SECTION...]. Paths are relative to ROOT. FOLDER is made anew.
Needs Python's standard library and the programs only (oiiotool for the pictures of docs/accuracy.md).
"""
import argparse
import shutil
import subprocess
import sys
import time
from pathlib import Path

import lighting_sections as lighting
import transmittance_sections as transmittance
from page import Page
from programs import Hairbake, hardware
from real_data_section import real_data
from settings import Scene, Size


def document_pictures(root, folder):
    """The pictures of docs/accuracy.md: several put side by side, at three quarters of their size. Copy them to docs/images."""
    pictures = folder / "pictures"
    sheets = {
        "decoupling.png": ["reference-sky.png", "decoupled-sky-0.png", "decoupled-sky-5.png",
                           "reference-studio.png", "decoupled-studio-0.png", "decoupled-studio-5.png"],
        "specular_maps.png": ["specular-brute.png", "specular-33.png", "specular-9.png", "specular-5.png"],
        "transmittance.png": ["with-sky.png", "without-sky.png", "with-overcast.png", "without-overcast.png"],
    }
    (root / folder / "document").mkdir()
    for name, parts in sheets.items():
        columns = 3 if len(parts) == 6 else 4
        if all((root / pictures / part).exists() for part in parts):
            subprocess.run(["oiiotool", *[str(pictures / part) for part in parts], "--mosaic:pad=4",
                            f"{columns}x{len(parts) // columns}", "--resize", "75%", "-o", str(folder / "document" / name)],
                           cwd=root, check=True)


def main():
    """Runs every section in turn."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("root", type=Path)
    parser.add_argument("program")
    parser.add_argument("folder", type=Path)
    parser.add_argument("--full", action="store_true",
                        help="more hair, less noise, and the published models, 0.7 to 1.5 million vertices")
    parser.add_argument("--tiny", action="store_true", help="everything so small that it shows nothing: for the test")
    parser.add_argument("--data", type=Path, help="folder with hair/sintel.hair and env/*.hdr")
    parser.add_argument("--only", nargs="+", help="names of the sections to make, such as offline_times")
    options = parser.parse_args()
    root, folder = options.root.resolve(), options.folder
    if (root / folder).exists():
        shutil.rmtree(root / folder)
    (root / folder / "pictures").mkdir(parents=True)
    size = Size.tiny() if options.tiny else Size.published() if options.full else Size()
    start = time.monotonic()
    hairbake = Hairbake(root, options.program)
    version = hairbake.run("--version").strip()
    scene = Scene(hairbake, folder, size)
    page = Page(root, folder, "hairbake: report",
                f"{version}, {time.strftime('%Y-%m-%d %H:%M')}, on {hardware()}. A generated groom of {size.vertices:,} "
                f"vertices, strands {size.width_scale:g} times as wide as hair so that they cover the head as hair does, "
                f"generated skies. Pictures of {size.pixels} x {size.pixels} pixels, {size.samples} samples each; "
                f"{size.light_samples} lights for each sample of the reference. "
                "Commands run from the project's folder.")
    page.commands(line for line in hairbake.take_commands() if "--version" not in line)
    for section in (transmittance.with_and_without, lighting.decoupling, lighting.specular_maps, lighting.sh_maps,
                    lighting.map_sizes, lighting.map_update, transmittance.estimators, transmittance.directions,
                    transmittance.offline_times):
        if options.only and section.__name__ not in options.only:
            continue
        section(scene, page)
        page.write()
    if options.data and (options.data / "hair" / "sintel.hair").exists() and not options.only:
        real_data(scene, page, options.data)
    document_pictures(root, folder)
    page.note(f"Made in {time.monotonic() - start:.0f} s.")
    print(f"the report is {page.write().relative_to(root)}")


if __name__ == "__main__":
    sys.exit(main())
