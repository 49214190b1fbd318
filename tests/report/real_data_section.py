"""A section about real hair and real skies, where they are."""
from lighting_sections import percent, reference_with_noise, without_noise


def real_data(scene, page, data):
    """Sintel's hair under real maps from `data`."""
    hair, head = data / "hair" / "sintel.hair", data / "mesh" / "sintel.obj"
    page.section("Real hair under real skies", f"From {data}, credits in its CREDITS.md: Sintel's hair, maps of Poly Haven. "
                 "The head hides light too. Left: the run time's picture (mode baked); right: what it leaves out of the reference.")
    pictures, rows, view = [], [], ("--azimuth", "35", "--elevation", "8")
    for name in ("kloppenheim_05_1k", "studio_small_03_1k"):
        folder = scene.folder / "bake" / f"sintel-{name}"
        scene.hairbake.bake(folder, hair, data / "env" / f"{name}.hdr", occluder=head)
        show = lambda short, *words, source=folder: scene.picture(short, source, *words, hair=hair, exposure="auto", view=view)
        black = ("--no-background", "--mesh", head, "--mesh-albedo", "0,0,0")
        beauty = show(f"sintel-{name}", "--mesh", head)
        baked = show(f"sintel-{name}-baked", *black)
        truth, noise = reference_with_noise(scene, f"sintel-{name}-reference", folder, *black, hair=hair, exposure="auto",
                                            view=view)
        figures = scene.hairbake.diff(truth, baked)
        pictures += [(f"{beauty}.png", f"{name}, baked"), (figures["picture"], f"{name}, hair alone, baked minus reference")]
        rows.append([name, without_noise(figures, noise), percent(noise)])
    page.pictures(pictures)
    page.table(["environment", "decoupling error: RMSE / mean where lit", "noise of the reference, taken off"], rows)
    page.commands(scene.hairbake.take_commands())
