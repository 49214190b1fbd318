"""Bakes every groom of a folder under three lightings: python3 three_lightings.py GROOMS SKY1 SKY2 SKY3 OUT

The service and its token come from HAIRBAKE_SERVER and HAIRBAKE_TOKEN_FILE. Transmittance does not depend on the
lighting: it is computed once a groom, and the maps once a lighting. Results go to OUT/SKY/GROOM.
"""
import os
import sys
from pathlib import Path
from typing import Any, Dict, List

import hairbake

FIELDS: Dict[str, Any] = {"transmittance": {"directions": 64, "voxels": 128}, "outputs": ["npy"]}


def main(grooms: str, skies: List[str], out: str) -> None:
    client = hairbake.Client(os.environ["HAIRBAKE_SERVER"], token_file=os.environ.get("HAIRBAKE_TOKEN_FILE"))
    first, *others = skies
    name_of = {}  # of a groom, by its model's digest
    bakes = []
    for file in sorted(Path(grooms).glob("*.hair")):
        bakes.append(client.submit(hair=file, environment=first, **FIELDS))
        name_of[bakes[-1].view["model"]] = file.stem
    by_sky = {first: client.wait_all(bakes)}
    for sky in others:
        by_sky[sky] = client.wait_batch(client.rebake(sky, bakes=bakes))
    for sky, done in by_sky.items():
        for bake in client.wait_all(done):  # raises when one has failed
            result = client.fetch(bake, Path(out, Path(sky).stem, name_of[bake.view["model"]]))
            a = result.arrays()
            print(f"{result.folder}: A of {a['transmittance'].shape[0]} vertices, maps {list(a['diffuse'].shape)}")


if __name__ == "__main__":
    if len(sys.argv) != 6:
        sys.exit(__doc__)
    main(sys.argv[1], sys.argv[2:5], sys.argv[5])
