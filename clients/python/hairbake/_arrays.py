"""Reads the .npy files of a result: as numpy arrays if numpy is installed, else as memoryviews of the same shape."""
from __future__ import annotations

import ast
import struct
from pathlib import Path
from typing import Any, Dict, Tuple

from ._errors import HairbakeError

Array = Any  #: numpy.ndarray, or memoryview with `shape`, indexed the same way


def _read_plain(file: Path) -> memoryview:
    """float32 in C order, as hairbake writes it."""
    data = file.read_bytes()
    try:
        if data[:8] != b"\x93NUMPY\x01\x00":
            raise ValueError("not version 1.0 of npy")
        (length,) = struct.unpack("<H", data[8:10])
        head = ast.literal_eval(data[10:10 + length].decode("latin-1"))
        shape: Tuple[int, ...] = head["shape"]
        if head["descr"] != "<f4" or head["fortran_order"]:
            raise ValueError("not float32 in C order")
        return memoryview(data)[10 + length:].cast("B").cast("f", shape=list(shape))
    except (ValueError, KeyError, SyntaxError, TypeError, struct.error) as error:
        raise HairbakeError(f"{file} cannot be read: {error}") from error


def read_array(file: Path) -> Array:
    try:
        import numpy
    except ImportError:
        return _read_plain(file)
    return numpy.load(file, allow_pickle=False)


def read_arrays(folder: Path) -> Dict[str, Array]:
    """All arrays of a result folder by name: "transmittance", "diffuse", "specular" ..."""
    return {file.stem: read_array(file) for file in sorted(folder.glob("*.npy"))}
