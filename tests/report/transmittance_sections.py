"""Sections about A: what it does, directions, the published estimator, times."""
import statistics

from lighting_sections import where_lit
from settings import EXPOSURES, SKIES


def with_and_without(scene, page):
    """Pictures with and without A."""
    page.section("With and without transmittance",
                 "Maps of the default size, the same exposure with A and with A = 1 (nothing casts a shadow on the hair). The head hides light.")
    pictures, rows = [], []
    for sky, label in SKIES.items():
        folder, _ = scene.bake(f"exact-{sky}", sky, head=True)
        common = ("--mesh", scene.mesh)
        lit = scene.picture(f"with-{sky}", folder, *common, exposure=EXPOSURES[sky])
        bare = scene.picture(f"without-{sky}", folder, *common, "--no-transmittance", exposure=EXPOSURES[sky])
        black = ("--no-background", "--mesh", scene.mesh, "--mesh-albedo", "0,0,0")  # so that hair alone is compared
        figures = scene.hairbake.diff(scene.picture(f"with-{sky}-alone", folder, *black),
                                      scene.picture(f"without-{sky}-alone", folder, *black, "--no-transmittance"))
        pictures += [(f"{lit}.png", f"{label}, with A"), (f"{bare}.png", f"{label}, without A")]
        rows.append([label, where_lit(figures)])
    for channel in ("transmittance", "tangent"):
        picture = scene.picture(channel, scene.bake("exact-sky", "sky", head=True)[0], "--channel", channel, "--mesh", scene.mesh)
        pictures.append((f"{picture}.png", f"channel {channel}"))
    page.pictures(pictures)
    page.table(["sky", "RMS of what A takes away / mean with A, where there is hair"], rows)
    page.commands(scene.hairbake.take_commands())


def estimators(scene, page):
    """Opacity maps beside the volume sweep."""
    page.section("The published estimator beside the volume sweep",
                 "Deep opacity maps with three layers (Yuksel and Keyser 2008), as published, and the volume method, at "
                 "the same Fibonacci directions. RMSE and bias against the true strands, traced with 1,024 directions from "
                 f"{scene.size.reference_vertices} vertices (95 % interval); wall seconds of the whole stage, the best of three.")
    rows = []
    for count in (9, 25, 64, 100):
        for method, label in (("opacity_maps", "opacity maps"), ("volume", "volume sweep")):
            _, manifest = scene.bake(f"{method}-{count}", transmittance__method=method, transmittance__directions=count,
                                     transmittance__reference_vertices=scene.size.reference_vertices)
            bar = manifest["error_bar"]
            low, high = bar["ci95"]["rmse"]
            seconds = scene.hairbake.seconds("transmittance", scene.folder / "bake" / f"{method}-{count}-time", scene.hair,
                                             strand__width_scale=scene.size.width_scale, transmittance__method=method,
                                             transmittance__directions=count, transmittance__reference_vertices=0)
            rows.append([count, label, f"{bar['rmse']:.4f} ({low:.4f} to {high:.4f})", f"{bar['bias']:+.4f}",
                         f"{seconds:.2f}"])
    page.table(["directions", "method", "RMSE", "bias", "seconds"], rows)
    page.commands(scene.hairbake.take_commands())


def direction_bakes(scene, kind, count):
    """Folders of a bake for each seed: what is random is shown by five of them."""
    seeds = (1,) if kind == "fibonacci" else range(1, 6)
    return [scene.bake(f"directions-{kind}-{count}-{seed}", transmittance__direction_set=kind, transmittance__directions=count,
                       transmittance__seed=seed)[0] for seed in seeds]


def directions(scene, page):
    """9 to 100 directions, random, jittered on a grid and Fibonacci."""
    page.section("Number and kind of directions",
                 "Published: random directions, 100 taken as the truth. Here the truth is the same method with 1,024 "
                 "Fibonacci directions, so that only the directions differ. Channel transmittance; the figures are over "
                 "all vertices; of random and stratified (jittered) directions, the mean of five seeds, and the range of "
                 "the RMS; the pictures show the first seed.")
    truth, _ = scene.bake("directions-1024", transmittance__directions=1024)
    arguments = ("--channel", "transmittance")
    best = scene.picture("directions-1024", truth, *arguments)
    pictures, rows = [(f"{best}.png", "A of 1,024 directions")], []
    for kind in ("random", "stratified", "fibonacci"):
        for count in (9, 25, 64, 100):
            folders = direction_bakes(scene, kind, count)
            shown = scene.picture(f"directions-{kind}-{count}", folders[0], *arguments)
            pictures.append((scene.hairbake.diff(best, shown, 0.2)["picture"], f"{count} {kind}, minus 1,024"))
            found = [scene.hairbake.compare(truth, folder)["transmittance"] for folder in folders]
            rms = [one["rms"] for one in found]
            mean = lambda name, found=found: statistics.fmean(one[name] for one in found)
            rows.append([kind, count, f"{mean('rms'):.4f}" + (f" ({min(rms):.4f} to {max(rms):.4f})" if len(rms) > 1 else ""),
                         f"{mean('max_abs'):.4f}", f"{mean('bias'):+.4f}"])
    page.pictures(pictures)
    page.table(["directions", "number", "RMS", "largest difference", "bias"], rows)
    page.commands(scene.hairbake.take_commands())


def offline_times(scene, page):
    """The published models' sizes."""
    page.section("Offline time", "Wall time from hair in memory to A in memory, 256 voxels, the best of three. Published: Xing 2012, tables 1 "
                 "and 2, on one CPU of 2012. Our grooms are generated with the published numbers of vertices.")
    if not scene.size.full:
        rows = []
        for count in (9, 25, 64, 100):
            seconds = scene.hairbake.seconds("transmittance", scene.folder / "bake" / f"volume-{count}-time", scene.hair,
                                             strand__width_scale=scene.size.width_scale, transmittance__method="volume",
                                             transmittance__directions=count, transmittance__reference_vertices=0)
            rows.append([f"{scene.size.vertices:,}", count, f"{seconds:.2f} s"])
        page.table(["vertices", "directions", "ours"], rows)
        page.note("The published models are made and baked by <code>./dev report --full</code>.")
        page.commands(scene.hairbake.take_commands())
        return
    published = {1: {100: 103}, 2: {100: 46}, 3: {100: 65}, 4: {9: 5.5, 25: 14.9, 64: 39.3, 100: 63.4}}
    rows = []
    for model, times in published.items():
        sample = scene.folder / f"model-{model}"
        scene.hairbake.run("sample", sample, "--paper-model", model, "--map-width", 16)
        for count, minutes in times.items():
            folder, groom = scene.folder / "bake" / f"model-{model}-{count}", sample / "groom.hair"
            manifest = scene.hairbake.bake(folder, groom, transmittance__directions=count, transmittance__reference_vertices=256)
            seconds = scene.hairbake.seconds("transmittance", f"{folder}-time", groom, transmittance__directions=count,
                                             transmittance__reference_vertices=0)
            bar = manifest["error_bar"]
            rows.append([model, f"{manifest['inputs']['hair']['vertices']:,}", count, f"{minutes} min", f"{seconds:.2f} s",
                         f"{60 * minutes / seconds:,.0f}", f"{bar['rmse']:.4f}"])
        (scene.hairbake.root / sample / "groom.hair").unlink()
    page.table(["model", "vertices", "directions", "published", "ours", "ratio", "our RMSE"], rows)
    page.commands(scene.hairbake.take_commands())
