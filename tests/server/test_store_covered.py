"""A folder of blobs that another one covers or replaces for a moment: its files are not lost."""
import shutil
import unittest

from disks import SmallDisk
from harness import Daemon, hair_bytes, quick_request
from rooms import eventually


def nothing(_, __):
    pass


def empty(folder, _):
    folder.mkdir()


def other_bytes(folder, digest):
    folder.mkdir()
    (folder / digest).write_bytes(b"older bytes")


def file(folder, _):
    folder.write_bytes(b"a file")


class Covered(unittest.TestCase):
    """Fault: one GET meanwhile, and the input was forgotten for good; the next start moved its file to lost+found."""

    def assert_waits(self, d, digest, data, words):
        for reply in (d.ask("GET", f"/v1/blobs/{digest}"), d.ask("PUT", f"/v1/blobs/{digest}", data),
                      d.ask("POST", "/v1/models", {"sha256": digest}), d.ask("DELETE", f"/v1/blobs/{digest}")):
            self.assertEqual((reply.status, reply.json["type"]), (503, "urn:hairbake:problem:busy"), reply.body)
            self.assertIn("Retry-After", reply.headers)
            self.assertIn(words, reply.json["detail"])
            self.assertIn("Put the folder back", reply.json["detail"])
        self.assertEqual(d.ask("HEAD", f"/v1/blobs/{digest}").status, 503)
        self.assertEqual(d.ask("GET", "/readyz").status, 503)

    def assert_is_there(self, d, digest, data, bake):
        self.assertEqual(d.ask("GET", f"/v1/blobs/{digest}").body, data)
        if bake:
            self.assertEqual(d.wait(bake)["state"], "done")
        self.assertEqual(d.ask("GET", "/readyz").status, 200)

    def test_an_input_outlives_the_absence_of_its_folder(self):
        """Relatives: an empty folder, one with other bytes, a file or nothing in its place; a bake that needs the input."""
        with Daemon() as d:
            for seed, replace in enumerate((empty, other_bytes, file, nothing)):
                with self.subTest(replace.__name__):
                    data = hair_bytes(seed=seed)
                    digest = d.put(data)
                    folder, away = d.blob_file(digest).parent, d.path / "away"
                    folder.rename(away)
                    replace(folder, digest)
                    self.assert_waits(d, digest, data, f"{folder} was ")
                    bake = d.ask("POST", "/v1/bakes", quick_request(digest)).json["id"]
                    eventually(lambda: "trouble" in d.ask("GET", f"/v1/bakes/{bake}").json["stages"][0])
                    if folder.is_dir():
                        shutil.rmtree(folder)
                    else:
                        folder.unlink(missing_ok=True)
                    away.rename(folder)
                    self.assert_is_there(d, digest, data, bake)
            d.stop()
            d.start()
            self.assert_is_there(d, digest, data, bake)
            self.assertFalse((d.path / "store/lost+found").exists())

    def test_relative_a_file_system_that_is_mounted_over_it(self):
        with SmallDisk() as d:
            data = hair_bytes()
            digest = d.put(data)
            d.run_inside(f'mount -t tmpfs none "$0/blobs/{digest[:2]}"')
            self.assert_waits(d, digest, data, f"{d.store}/blobs/{digest[:2]} was replaced")
            d.run_inside(f'umount "$0/blobs/{digest[:2]}"')
            self.assert_is_there(d, digest, data, None)

    def test_relative_the_scrub(self):
        with Daemon(config="scrub_s = 1") as d:
            data = hair_bytes()
            digest = d.put(data)
            folder, away = d.blob_file(digest).parent, d.path / "away"
            folder.rename(away)
            folder.mkdir()
            d.wait_for_log(f"{folder} was replaced")
            folder.rmdir()
            away.rename(folder)
            self.assert_is_there(d, digest, data, None)


if __name__ == "__main__":
    unittest.main()
