"""The Python package as a pipeline script uses it."""
import sys
import unittest

from rig import ROOT, LastingDaemon, Workshop
from harness import hair_bytes, hdr_bytes

sys.path.insert(0, str(ROOT / "clients/python"))
import hairbake  # noqa: E402
import numpy  # noqa: E402

FIELDS = {"transmittance": {"directions": 16, "voxels": 32, "reference_vertices": 0},
          "irradiance": {"face_size": 4, "specular_maps": 3}, "outputs": ["npy"]}


class Api(unittest.TestCase):
    def setUp(self):
        self.shop = Workshop(["/usr/bin/python3"])
        self.addCleanup(self.shop.folder.cleanup)
        self.daemon = LastingDaemon()
        self.daemon.__enter__()
        self.addCleanup(self.daemon.__exit__)
        self.url = f"http://127.0.0.1:{self.daemon.port}"
        self.hair = self.shop.write("groom.hair", hair_bytes())
        self.sky = self.shop.write("sky.hdr", hdr_bytes())
        self.client = hairbake.Client(self.url, patience_s=5)

    def test_submit_wait_fetch_and_arrays(self):
        bake = self.client.submit(hair=self.hair, environment=self.sky, **FIELDS)
        result = self.client.fetch(self.client.wait(bake), self.shop.path / "out")
        arrays = result.arrays()
        self.assertEqual(arrays["transmittance"].shape, (400,))  # 40 strands of 10 points
        self.assertEqual(arrays["specular"].shape, (3, 6, 4, 4, 3))
        self.assertEqual(arrays["transmittance"].dtype, numpy.float32)
        self.assertEqual(result.manifest()["id"], bake.id)
        self.assertEqual([other.id for other in self.client.list(state="done")], [bake.id])
        # The same request again is done at once.
        self.assertEqual(self.client.submit(hair=self.hair, environment=self.sky, **FIELDS).state, "done")

    def test_warnings_come_with_results_and_bakes(self):
        """Relative: a bake without any."""
        mesh = self.shop.write("far.obj", b"v 900 0 0\nv 900.1 0 0\nv 900 0.1 0\nf 1 2 3\n")
        bake = self.client.wait(self.client.submit(hair=self.hair, occluder=mesh, **FIELDS))
        result = self.client.fetch(bake, self.shop.path / "out")
        self.assertEqual(result.warnings(), result.manifest()["warnings"])
        self.assertEqual(self.client.warnings(bake), result.warnings())
        self.assertIn("the occluder", result.warnings()[0])
        plain = self.client.wait(self.client.submit(hair=self.hair, **FIELDS))
        self.assertEqual(self.client.warnings(plain), [])

    def test_arrays_without_numpy_have_the_same_shape_and_values(self):
        bake = self.client.wait(self.client.submit(hair=self.hair, environment=self.sky, **FIELDS))
        self.client.fetch(bake, self.shop.path / "out")
        script = ("import sys; sys.modules['numpy'] = None\n"
                  "from pathlib import Path\nfrom hairbake._arrays import read_arrays\n"
                  "a = read_arrays(Path('out'))\n"
                  "print(a['specular'].shape, a['specular'][2, 5, 1, 2, 0], a['transmittance'][399])")
        done = self.shop.run("-c", script)
        there = {name: numpy.load(self.shop.path / f"out/{name}.npy") for name in ("specular", "transmittance")}
        expected = ((3, 6, 4, 4, 3), float(there["specular"][2, 5, 1, 2, 0]), float(there["transmittance"][399]))
        self.assertEqual(done.out, f"{expected[0]} {expected[1]} {expected[2]}\n", done)

    def test_failures_are_exceptions_with_the_field(self):
        with self.assertRaises(hairbake.Refused) as refused:
            self.client.submit(hair=self.hair, transmittance={"voxels": 7})
        self.assertEqual((refused.exception.field, refused.exception.status), ("transmittance.voxels", 422))
        with self.assertRaises(hairbake.BakeFailed) as failed:
            self.client.wait(self.client.submit(hair=self.shop.write("broken.hair", hair_bytes()[:200])))
        self.assertIn("broken.hair", str(failed.exception))
        self.daemon.kill()
        with self.assertRaises(hairbake.Unreachable):
            hairbake.Client(self.url, patience_s=0).list()
        self.daemon.start()

    def test_a_refused_deletion_has_the_list_of_what_refers_to_the_input(self):
        sky = self.client.upload(self.shop.write("other.hdr", hdr_bytes(red=77)), "environment", "stage1/dusk")
        with self.assertRaises(hairbake.Refused) as caught:
            self.client.delete(sky, "environment")
        self.assertEqual((caught.exception.status, caught.exception.field), (409, "force"))
        self.assertEqual(caught.exception.needed_by["names"],
                         {"count": 1, "first": [{"kind": "environment", "path": "stage1/dusk", "version": 1}]})
        self.client.delete(sky, "environment", force=True)

    def test_the_example_bakes_a_folder_under_three_lightings_and_transmittance_once(self):
        (self.shop.path / "grooms").mkdir()
        for name, seed in (("fringe", 1), ("bun", 2)):
            self.shop.write(f"grooms/{name}.hair", hair_bytes(seed=seed))
        reds = {"dawn": 90, "noon": 200, "dusk": 30}
        skies = [self.shop.write(f"{name}.hdr", hdr_bytes(red=red)) for name, red in reds.items()]
        self.shop.environment["HAIRBAKE_SERVER"] = self.url
        done = self.shop.run(ROOT / "clients/python/examples/three_lightings.py", "grooms", *skies, "out")
        self.assertEqual(done.code, 0, done)
        load = lambda sky, groom, array: numpy.load(self.shop.path / f"out/{sky}/{groom}/{array}.npy")
        for groom in ("fringe", "bun"):
            for sky in ("noon", "dusk"):
                for array, same in (("transmittance", True), ("diffuse", False)):
                    equal = numpy.array_equal(load("dawn", groom, array), load(sky, groom, array))
                    self.assertEqual(equal, same, (groom, sky, array))
        # 2 grooms and 3 skies: five stages for six bakes, and each ran once.
        bakes = [self.client.status(bake) for bake in self.client.list()]
        stages = {stage["key"]: stage["attempts"] for bake in bakes for stage in bake.view["stages"]}
        self.assertEqual((len(bakes), len(stages), set(stages.values())), (6, 5, {1}))


if __name__ == "__main__":
    unittest.main()
