"""How large the report's bakes and pictures are."""
from dataclasses import dataclass

SKIES = {"sky": "sun", "studio": "studio", "overcast": "overcast"}  # file of `hairbake sample` -> name


EXPOSURES = {"sky": "0", "studio": "1.5", "overcast": "0.5"}  # stops of the PNG pictures


@dataclass
class Size:
    """Default: a few minutes on two cores, which the decoupling's sums over every light take most of."""
    vertices: int = 100_000
    width_scale: float = 8  # so that fewer strands cover the head as hair does
    map_width: int = 1024
    pixels: int = 200
    samples: int = 4
    light_samples: int = 16
    reference_vertices: int = 500
    full: bool = False  # also the published models

    @staticmethod
    def published():
        """For docs/accuracy.md: more hair, larger pictures, less noise, and the published models too."""
        return Size(vertices=200_000, width_scale=5, pixels=320, light_samples=64, full=True)

    @staticmethod
    def tiny():
        """For the test that runs the whole report in seconds."""
        return Size(vertices=3000, width_scale=30, map_width=64, pixels=24, samples=1, light_samples=2,
                    reference_vertices=20)


SAMPLE_VIEW = ("--target", "0,-7,0", "--distance", "74", "--azimuth", "35", "--elevation", "8")
CROWN_VIEW = ("--target", "0,0,0", "--distance", "46", "--azimuth", "35", "--elevation", "42")


class Scene:
    """The sample data, and what all bakes and pictures of them share."""

    beauty_scale, specular_scale = 0.1, 0.05  # of false colours, so that pictures of one section can be compared

    def __init__(self, hairbake, folder, size):
        self.hairbake, self.folder, self.size = hairbake, folder, size
        self.hairs = {}
        for style in ("wavy", "straight"):
            sample = folder / f"sample-{style}"
            hairbake.run("sample", sample, "--style", style, "--vertices", size.vertices, "--map-width", size.map_width)
            self.hairs[style] = sample / "groom.hair"
        self.sample = folder / "sample-wavy"
        self.hair, self.mesh = self.hairs["wavy"], self.sample / "head.obj"

    def sky(self, name):
        """File of a sky."""
        return self.sample / f"{name}.hdr"

    def bake(self, name, sky=None, hair=None, head=False, **fields):
        """Folder and manifest of a bake of the wavy groom (or `hair`) with the report's strand settings; `head`: the head
        stops light."""
        defaults = {"strand__width_scale": self.size.width_scale, "transmittance__method": "volume",
                    "transmittance__reference_vertices": 0}
        defaults.update({"occluder": self.mesh} if head else {})
        folder = self.folder / "bake" / name
        manifest = self.hairbake.bake(folder, hair or self.hair, self.sky(sky) if sky else None, **{**defaults, **fields})
        return folder, manifest

    def picture(self, name, folder, *arguments, hair=None, exposure="0", view=SAMPLE_VIEW):
        """Renders a result folder; gives the picture's name without ending."""
        size = self.size
        return self.hairbake.render(self.folder / "pictures" / name, folder, "--hair", hair or self.hair, "--size",
                                    f"{size.pixels}x{size.pixels}", "--samples", size.samples, "--exposure", exposure,
                                    *view, *arguments)
