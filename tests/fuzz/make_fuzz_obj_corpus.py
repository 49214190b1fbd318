"""Writes a small seed corpus of OBJ files into a folder: every form of a face, a number and a line's end."""
import sys
from pathlib import Path

CORNERS = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nvt 0 0\nvn 0 0 1\nvn 0 1 0\n"
SEEDS = {
    "plain": CORNERS + "f 1 2 3\n",
    "quad": CORNERS + "f 1 2 3 4\n",
    "textured": CORNERS + "f 1/1 2/1 3/1\n",
    "normals": CORNERS + "f 1//1 2//1 3//2\nf 1/1/1 3/1/2 4/1/2\n",
    "relative": CORNERS + "f -4 -3 -2\nf -4//-2 -2//-1 -1//-1\n",
    "joined": CORNERS + "f 1 \\\n2 3\n",
    "groups": "# text\nmtllib a.mtl\no head\ng a b\ns off\nusemtl skin\n" + CORNERS + "l 1 2\nf 1 2 3 # end\n",
    "carriage": (CORNERS + "f 1 2 3\n").replace("\n", "\r\n"),
    "numbers": "v +1e-3 -.5 2.\nv 1e18 -1E18 0x1\nv nan inf 1e400\nv 1 2\nv 1 2 3 0.5 0.5 0.5\n" + CORNERS + "f 1 2 3",
    "indices": CORNERS + "f 0 1 2\nf 1 2 99\nf 4294967297 1 2\nf 1 2\nf 1 1 2\nf 1//9 2//9 3//9\n",
    "tetrahedron": "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 3 1 4\n",
    "concave": "v 0 0 0\nv 3 0 0\nv 3 1 0\nv 1 1 0\nv 1 3 0\nv 0 3 0\nf 1 2 3 4 5 6\nf 4 5 6 1 2 3\n",
    "crossing": CORNERS + "f 1 3 2 4\nf 1 2 3 1 4 3\n",
    "mark": "\ufeff" + CORNERS + "f 1//1 2//1 3//1\n",
    "turned": "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 2 3\nf 1 2 4\nf 2 3 4\nf 3 1 4\n",
    "many": CORNERS + "f " + "1 2 3 4 " * 60 + "\n",
}


def main():
    folder = Path(sys.argv[1])
    folder.mkdir(parents=True, exist_ok=True)
    for name, text in SEEDS.items():
        (folder / f"{name}.obj").write_bytes(text.encode())


if __name__ == "__main__":
    main()
