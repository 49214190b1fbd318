"""Writes a small seed corpus of glTF files into a folder: GLB and JSON, nodes, strips, quantized and sparse accessors."""
import base64
import json
import struct
import sys
from pathlib import Path

POSITIONS = struct.pack("<12f", 0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0)
DATA = POSITIONS + struct.pack("<12f", *(0, 0, 1) * 4) + struct.pack("<6H", 0, 1, 2, 0, 2, 3)
VIEWS = [{"buffer": 0, "byteLength": 48}, {"buffer": 0, "byteOffset": 48, "byteLength": 48},
         {"buffer": 0, "byteOffset": 96, "byteLength": 12}]
ACCESSORS = [{"bufferView": 0, "componentType": 5126, "count": 4, "type": "VEC3"},
             {"bufferView": 1, "componentType": 5126, "count": 4, "type": "VEC3"},
             {"bufferView": 2, "componentType": 5123, "count": 6, "type": "SCALAR"}]
TURN = {"rotation": [0, 0, 0.7071, 0.7071], "translation": [1, 2, 3], "scale": [-1, 2, 1]}


def model(primitive, nodes=({"mesh": 0},), **more):
    return {"asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0]}], "nodes": list(nodes),
            "meshes": [{"primitives": [primitive]}], "buffers": [{"byteLength": len(DATA)}], "bufferViews": VIEWS,
            "accessors": ACCESSORS, **more}


def glb(value):
    text = json.dumps(value).encode()
    text += b" " * (-len(text) % 4)
    return (struct.pack("<4sIIII", b"glTF", 2, 28 + len(text) + len(DATA), len(text), 0x4E4F534A) + text
            + struct.pack("<II", len(DATA), 0x004E4942) + DATA)


def embedded(value):
    uri = "data:application/octet-stream;base64," + base64.b64encode(DATA).decode()
    return json.dumps({**value, "buffers": [{"byteLength": len(DATA), "uri": uri}]}).encode()


INDEXED = {"attributes": {"POSITION": 0, "NORMAL": 1}, "indices": 2}
QUANTIZED = [{**ACCESSORS[0], "componentType": 5122, "normalized": True, "count": 4}, *ACCESSORS[1:]]
SEEDS = {
    "plain.glb": glb(model(INDEXED)),
    "nodes.glb": glb(model(INDEXED, [{"children": [1, 2], **TURN}, {"mesh": 0, **TURN}, {"mesh": 0}])),
    "matrix.glb": glb(model(INDEXED, [{"mesh": 0, "matrix": [1, 0, 0, 0, 0, 2, 0, 0, 0, 0, 3, 0, 4, 5, 6, 1]}])),
    "strip.glb": glb(model({"attributes": {"POSITION": 0}, "mode": 5})),
    "fan.glb": glb(model({"attributes": {"POSITION": 0}, "mode": 6})),
    "quantized.glb": glb(model(INDEXED, accessors=QUANTIZED)),
    "sparse.glb": glb(model(INDEXED, accessors=[{**ACCESSORS[0], "sparse": {
        "count": 1, "indices": {"bufferView": 2, "componentType": 5123}, "values": {"bufferView": 0}}}, *ACCESSORS[1:]])),
    "skin.glb": glb(model(INDEXED, [{"mesh": 0, "skin": 0}], skins=[{"joints": [0]}])),
    "json.gltf": embedded(model(INDEXED)),
    "outside.gltf": json.dumps(model(INDEXED, buffers=[{"byteLength": 4, "uri": "a.bin"}])).encode(),
}


def main():
    folder = Path(sys.argv[1])
    folder.mkdir(parents=True, exist_ok=True)
    for name, data in SEEDS.items():
        (folder / name).write_bytes(data)


if __name__ == "__main__":
    main()
