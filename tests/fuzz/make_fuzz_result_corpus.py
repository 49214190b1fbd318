"""Writes seeds for the reader of result folders: a byte that names the file, then the file."""
import io
import json
import sys
from pathlib import Path

import numpy


def npy(shape, value=0.5):
    stream = io.BytesIO()
    numpy.save(stream, numpy.full(shape, value, numpy.float32))
    return stream.getvalue()


def main():
    folder = Path(sys.argv[1])
    folder.mkdir(parents=True, exist_ok=True)
    for number, shape in enumerate(((7,), (7, 1), (7, 4), (6, 4, 4, 3), (2, 6, 4, 4, 3))):
        (folder / f"seed_{number}").write_bytes(bytes([number]) + npy(shape))
    manifest = {"format": "hairbake result", "inputs": {"hair": {"sha256": "aa"}}, "request": {"hair": "a.hair"},
                "files": [{"name": "transmittance.npy", "sha256": "bb"}]}
    (folder / "seed_manifest").write_bytes(b"\x05" + json.dumps(manifest).encode())


if __name__ == "__main__":
    main()
