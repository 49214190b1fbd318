"""Sections about the irradiance maps and the decoupling of light and transmittance."""
import math
import statistics

from settings import CROWN_VIEW, EXPOSURES, SAMPLE_VIEW, SKIES


def percent(value):
    """A share for people."""
    return "-" if value is None else f"{100 * value:.3g} %"


def where_lit(figures):
    """RMSE over the mean, both over the pixels that show hair."""
    return percent(figures["lit"]["rmse_over_mean"])


def specular_maps(scene, page):
    """Brute force against 5, 9, 17 and 33 maps."""
    page.section("Specular component: every light, and 5 to 33 maps",
                 "Specular part only, without a background, straight hair under a sun. Published (Xing 2012, figure 3): "
                 "five maps lose a ring of the highlight that nine keep.")
    arguments = ["--channel", "specular", "--no-background", "--no-transmittance"]
    hair = scene.hairs["straight"]
    pictures, rows = [], []
    for maps in (33, 17, 9, 5):
        folder, manifest = scene.bake(f"maps-{maps}", "sky", hair, irradiance__specular_maps=maps)
        if not pictures:
            brute = scene.picture("specular-brute", folder, *arguments, "--mode", "brute", hair=hair, view=CROWN_VIEW)
            pictures.append((f"{brute}.png", "every light of the environment, exact kernel"))
        baked = scene.picture(f"specular-{maps}", folder, *arguments, hair=hair, view=CROWN_VIEW)
        figures = scene.hairbake.diff(brute, baked, scene.specular_scale)
        pictures += [(f"{baked}.png", f"{maps} maps"), (figures["picture"], f"{maps} maps minus every light")]
        rows.append([maps, where_lit(figures), f"{figures['max_abs']:.3g}",
                     percent(manifest["irradiance"]["interpolation_bound_relative"])])
    page.pictures(pictures)
    page.table(["specular maps", "RMSE / mean where lit", "largest difference", "bound of interpolation (manifest)"], rows)
    page.commands(scene.hairbake.take_commands())


def sh_maps(scene, page):
    """Maps from spherical harmonics against exact ones."""
    page.section("Maps from spherical harmonics",
                 "Published: 9 coefficients (3 bands) for the diffuse map and 64 (8 bands) for the specular ones. "
                 "Measured: RMS of the difference from the exact maps over the largest value, both of the diffuse map or of "
                 "the specular maps; predicted: what the bake's manifest says beforehand.")
    rows, pictures = [], []
    for sky, label in SKIES.items():
        exact, _ = scene.bake(f"exact-{sky}", sky, head=True)
        for bands in ("published", 12, 16, 24, "auto"):
            diffuse, specular = (3, 8) if bands == "published" else (bands, bands)
            folder, manifest = scene.bake(f"sh-{bands}-{sky}", sky, irradiance__method="sh",
                                          irradiance__sh_bands__diffuse=diffuse,
                                          irradiance__sh_bands__specular=specular)
            maps, compared = manifest["irradiance"], scene.hairbake.compare(exact, folder)

            def rms(kind, values=compared):
                """Over all maps of the kind together, as the prediction is."""
                of_kind = [value for name, value in values.items() if name.startswith(kind)]
                return math.sqrt(statistics.fmean(v["rms"] ** 2 for v in of_kind)) / max(v["largest"] for v in of_kind)

            rows.append([label, f"{maps['sh_bands']['diffuse']} and {maps['sh_bands']['specular']}",
                         percent(maps["predicted_error"]["diffuse"]), percent(rms("diffuse")),
                         percent(maps["predicted_error"]["specular"]), percent(rms("specular_"))])
            if sky == "studio" and bands in ("published", 24):
                arguments = ["--channel", "specular", "--no-background", "--no-transmittance"]
                truth = scene.picture("sh-exact", exact, *arguments, exposure="2")
                shown = scene.picture(f"sh-{bands}", folder, *arguments, exposure="2")
                figures = scene.hairbake.diff(truth, shown, scene.specular_scale)
                pictures += [(f"{truth}.png", "exact maps, studio")] if not pictures else []
                pictures += [(f"{shown}.png", f"SH, {maps['sh_bands']['specular']} bands"),
                             (figures["picture"], f"minus exact; RMSE / mean {where_lit(figures)}")]
    page.pictures(pictures)
    page.table(["sky", "bands, diffuse and specular", "predicted, diffuse", "measured", "predicted, specular",
                "measured"], rows)
    page.commands(scene.hairbake.take_commands())


def map_sizes(scene, page):
    """Faces of 4 to 32 texels."""
    page.section("Size of the maps", "Texels on the edge of a cube face, 33 specular maps, sun; against every light.")
    pictures, rows = [], []
    for texels in (4, 8, 16, 32):
        folder, _ = scene.bake(f"faces-{texels}", "sky", irradiance__face_size=texels)
        brute = scene.picture("faces-brute", folder, "--no-background", "--mode", "brute")
        baked = scene.picture(f"faces-{texels}", folder, "--no-background")
        figures = scene.hairbake.diff(brute, baked, scene.beauty_scale)
        pictures += [] if pictures else [(f"{brute}.png", "every light")]
        pictures += [(figures["picture"], f"{texels}x{texels}x6 minus every light")]
        rows.append([f"{texels}x{texels}x6", where_lit(figures), f"{figures['max_abs']:.3g}"])
    page.pictures(pictures)
    page.table(["map", "RMSE / mean where lit", "largest difference"], rows)
    page.commands(scene.hairbake.take_commands())


def map_update(scene, page):
    """Times of the irradiance stage."""
    page.section("Time to make the maps",
                 "One diffuse and nine specular maps of 16x16x6, as published: 32 ms from SH on a GPU, below a "
                 "second on a CPU. Wall time of the irradiance stage: environment in memory to "
                 f"maps in memory, environment {scene.size.map_width} wide; the best of three. The times hold what the manifest "
                 "tells besides: the bound of the interpolation, statistics, the environment's own harmonics.")
    rows = []
    for label, fields in (("SH, 3 and 8 bands (published)", {"irradiance__method": "sh", "irradiance__sh_bands__diffuse": 3,
                                                             "irradiance__sh_bands__specular": 8}),
                          ("SH, auto", {"irradiance__method": "sh"}), ("exact sum over every light", {})):
        seconds = scene.hairbake.seconds("irradiance", scene.folder / "bake" / f"update-{len(rows)}", None, scene.sky("sky"),
                                         irradiance__specular_maps=9, **fields)
        rows.append([label, f"{1000 * seconds:.1f} ms"])
    page.table(["method", "time"], rows)
    page.commands(scene.hairbake.take_commands())


def reference_with_noise(scene, name, folder, *arguments, hair=None, exposure="0", view=SAMPLE_VIEW):
    """The reference's picture, and its noise as RMSE over the mean where lit. A second picture has the same samples of the
    pixels and one light sample more at each, which draws other lights: the variances are v and about v n / (n + 1), and their
    difference has the sum of both."""
    count = scene.size.light_samples
    show = lambda short, lights: scene.picture(short, folder, *arguments, "--mode", "reference", "--light-samples", lights,
                                               hair=hair, exposure=exposure, view=view)
    reference, other = show(name, count), show(f"{name}-again", count + 1)
    difference = scene.hairbake.diff(reference, other, scene.beauty_scale)["lit"]["rmse_over_mean"] or 0
    return reference, difference / math.sqrt(1 + count / (count + 1))


def without_noise(figures, noise):
    """RMSE over the mean where lit, the reference's noise taken off, for people."""
    return percent(max(0, (figures["lit"]["rmse_over_mean"] or 0) ** 2 - noise**2) ** 0.5)


def decoupling(scene, page):
    """Mode 1 against mode 3."""
    page.section("The decoupling error",
                 "The method takes the transmittance out of the integral: A(x) times the light, instead of the light "
                 "times the transmittance of its direction. Nobody has published what that costs. Reference: the sum over "
                 "the environment with traced shadow rays inside (mode reference). RMSE over the mean, over the pixels "
                 "that show hair; the head hides light too. The rows leave one approximation out after another; "
                 "directional transmittance is baked by the same sweep and put inside the sum; effective transmittance "
                 "is baked for the light itself.")
    table = {}
    # Bakes of hair alone may be lit by any sky.
    traced, _ = scene.bake("traced", head=True, transmittance__method="trace")
    harmonics = {bands: scene.bake(f"sh-transmittance-{bands}", head=True, transmittance__sh_bands=bands,
                                   transmittance__bent_cone="true")[0] for bands in (2, 3, 4)}
    for sky, label in SKIES.items():
        folder, _ = scene.bake(f"exact-{sky}", sky, head=True)
        effective, _ = scene.bake(f"effective-{sky}", sky, head=True, effective_transmittance__enabled="true")
        black = ("--no-background", "--mesh", scene.mesh, "--mesh-albedo", "0,0,0")
        lit = ("--env", scene.sky(sky))
        reference, noise = reference_with_noise(scene, f"reference-{sky}", folder, *black, exposure=EXPOSURES[sky])
        variants = {"maps and A (mode baked)": (folder, ()), "every light, A (mode brute)": (folder, ("--mode", "brute")),
                    "every light, traced A": (traced, ("--mode", "brute", *lit)),
                    "maps and effective transmittance": (effective, ("--mode", "effective"))}
        for bands, more in harmonics.items():
            variants[f"every light, SH transmittance of {bands} bands"] = (more, ("--mode", "directional", *lit))
        variants["every light, bent cone"] = (harmonics[2], ("--mode", "directional", "--directional",
                                                              "bent-cone", *lit))
        shown = [(f"{reference}.png", f"{label}: reference")]
        for name, (source, arguments) in variants.items():
            short = f"decoupled-{sky}-{list(variants).index(name)}"
            picture = scene.picture(short, source, *black, *arguments, exposure=EXPOSURES[sky])
            figures = scene.hairbake.diff(reference, picture, scene.beauty_scale)
            table.setdefault(name, []).append(without_noise(figures, noise))
            if name.startswith("maps") or "of 4" in name or "cone" in name:
                shown += [(f"{picture}.png", f"{label}: {name}"), (figures["picture"], f"{label}: minus reference")]
        table.setdefault("noise of the reference, taken off above", []).append(percent(noise))
        page.pictures(shown)
    page.table(["against the reference", *SKIES.values()], [[name, *values] for name, values in table.items()])
    page.commands(scene.hairbake.take_commands())
