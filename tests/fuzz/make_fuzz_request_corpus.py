"""Writes requests as seeds: the presets' and one that names most fields."""
import json
import sys
from pathlib import Path

FULL = {
    "hair": "a.hair", "environment": "b.hdr", "occluder": "c.obj", "receiver": None,
    "strand": {"width": 0.25, "width_scale": 2, "opacity": "from_file"},
    "transmittance": {"method": "opacity_maps", "directions": 49, "direction_set": "stratified", "seed": 9, "voxels": 64,
                      "voxel_size": 0.5, "sh_bands": 2, "bent_cone": True, "reference_vertices": 7,
                      "opacity_maps": {"layers": 4, "layer_spacing": 1.5, "resolution": 64}},
    "irradiance": {"face_size": 8, "specular_maps": 5, "exponent": 12.5, "method": "sh", "sh_error": 0.5,
                   "sh_bands": {"diffuse": 3, "specular": "auto"}, "layout": "faces", "latlong": "openexr",
                   "rotation_deg": [1, 2, 3], "tint": [0.5, 1, 2], "exposure_stops": -1, "invalid_radiance": "clamp",
                   "lights": [{"direction": [0, 1, 0], "irradiance": [1, 2, 3]}]},
    "outputs": ["npy", "ktx2", "raw"],
}


def main():
    folder = Path(sys.argv[1])
    folder.mkdir(parents=True, exist_ok=True)
    presets = Path(__file__).resolve().parents[2] / "config" / "presets"
    for preset in presets.glob("*.json"):
        (folder / preset.name).write_text(json.dumps(json.loads(preset.read_text())["request"]))
    (folder / "full.json").write_text(json.dumps(FULL))
    for name, block in FULL.items():
        (folder / f"{name}.json").write_text(json.dumps({name: block}))


if __name__ == "__main__":
    main()
