"""A section about real hair and real skies, where they are."""
from lighting_sections import where_lit


def real_data(scene, page, data):
    """Sintel's hair under real maps from `data`."""
    hair, head = data / "hair" / "sintel.hair", data / "mesh" / "sintel.obj"
    page.section("Real hair under real skies", f"From {data}, credits in its CREDITS.md: Sintel's hair, maps of Poly Haven. "
                 "Left: the run time's picture (mode baked); right: what it leaves out of the reference.")
    pictures, rows = [], []
    for name in ("kloppenheim_05_1k", "studio_small_03_1k"):
        sky = data / "env" / f"{name}.hdr"
        folder = scene.folder / "bake" / f"sintel-{name}"
        scene.hairbake.bake(folder, hair, sky)
        show = lambda short, *words, source=folder: scene.picture(short, source, *words, hair=hair, exposure="auto",
                                                                     view=("--azimuth", "35", "--elevation", "8"))
        beauty = show(f"sintel-{name}", "--mesh", head)
        baked = show(f"sintel-{name}-baked", "--no-background", "--mesh", head, "--mesh-albedo", "0,0,0")
        truth = show(f"sintel-{name}-reference", "--no-background", "--mesh", head, "--mesh-albedo", "0,0,0", "--mode",
                     "reference", "--light-samples", scene.size.light_samples)
        figures = scene.hairbake.diff(truth, baked)
        pictures += [(f"{beauty}.png", f"{name}, baked"), (figures["picture"], f"{name}, hair alone, baked minus reference")]
        rows.append([name, where_lit(figures)])
    page.pictures(pictures)
    page.table(["environment", "decoupling error: RMSE / mean where lit"], rows)
    page.commands(scene.hairbake.take_commands())
