"""What makes room on a full disk: deletions, evictions, a cancellation."""
import os
import unittest

from disks import LastingDisk, SmallDisk
from harness import TUS, hair_bytes, hdr_bytes, quick_request, sha256, slow_request


class DeletionOnFullDisk(unittest.TestCase):
    """Fault: a DELETE needed a little room on the disk, so a full disk refused the remedy."""

    def test_a_deletion_makes_room_on_a_full_disk(self):
        """Relatives: a mesh, a model with its thumbnail, an environment by force, an unfinished upload."""
        with SmallDisk(size_mb=64) as d:
            hair, sky, mesh = d.put(hair_bytes()), d.put(hdr_bytes()), d.put(os.urandom(2 << 20))
            for kind, digest in (("model", hair), ("environment", sky)):
                self.assertEqual(d.ask("POST", f"/v1/{kind}s", {"sha256": digest}).status, 201)
            self.assertEqual(d.ask("PUT", "/v1/names/environment/dusk", {"sha256": sky}).status, 200)
            upload = d.create_upload(bytes(300_000)).headers["Location"]
            self.assertEqual(d.append(upload, 0, bytes(200_000)).status, 204)
            for path, headers in ((f"/v1/models/{hair}", {}), (f"/v1/environments/{sky}?force=1", {}), (upload, TUS),
                                  (f"/v1/blobs/{mesh}", {})):
                with self.subTest(path):
                    d.make_log_full()
                    self.assertEqual(d.ask("PUT", "/v1/names/mesh/x", {"sha256": mesh}).status, 507)
                    reply = d.ask("DELETE", path, headers=headers)
                    self.assertEqual(reply.status, 204, reply.body)
                    d.free_filler()
                    self.assertEqual(d.ask("GET", "/readyz").status, 200)
            self.assertIn("are given to a deletion", (d.path / "log").read_text())
            self.assertEqual([blob["sha256"] for blob in d.ask("GET", "/v1/blobs").json["blobs"]], [])

    def test_successive_deletions_while_another_program_takes_what_is_freed(self):
        """Fault: the first deletion used up the reserve, and the second one was refused. Relatives: a model, small files that free
        less than their deletion writes, the cancellation of a bake, an unfinished upload."""
        with SmallDisk(size_mb=24) as d:
            hair = d.put(hair_bytes())
            self.assertEqual(d.ask("POST", "/v1/models", {"sha256": hair}).status, 201)
            worked_on = d.put(hair_bytes(seed=1))
            bake = d.ask("POST", "/v1/bakes", slow_request(worked_on)).json["id"]
            upload = d.create_upload(bytes(300_000)).headers["Location"]
            self.assertEqual(d.append(upload, 0, bytes(2_000)).status, 204)
            large, *small = [d.put(os.urandom(size)) for size in (1 << 20, *[3_000] * 12)]
            d.make_log_full(name="filler 0")
            for number, (path, headers, status) in enumerate((
                    (f"/v1/blobs/{large}", {}, 204), *[(f"/v1/blobs/{digest}", {}, 204) for digest in small],
                    (f"/v1/bakes/{bake}", {}, 200), (upload, TUS, 204), (f"/v1/models/{hair}", {}, 204)), 1):
                with self.subTest(path):
                    reply = d.ask("DELETE", path, headers=headers)
                    self.assertEqual(reply.status, status, reply.body)
                    self.assertGreater((d.inside / "reserve").stat().st_size, 256 << 10)
                    d.fill(name=f"filler {number}")
            self.assertEqual([blob["sha256"] for blob in d.ask("GET", "/v1/blobs").json["blobs"]], [worked_on])

    def test_relative_the_name_of_an_input_needs_room_and_leaves_the_reserve(self):
        with SmallDisk(size_mb=16) as d:
            kept, large = d.put(b"kept"), d.put(os.urandom(3 << 20))
            d.make_log_full()
            reserve = (d.inside / "reserve").stat().st_size
            name = {"sha256": kept}
            reply = d.ask("PUT", "/v1/names/mesh/x", name)
            self.assertEqual((reply.status, reply.json["type"]), (507, "urn:hairbake:problem:full"))
            self.assertIn("delete inputs that nothing needs", reply.json["detail"])
            self.assertEqual((d.inside / "reserve").stat().st_size, reserve)
            self.assertEqual(d.ask("DELETE", f"/v1/blobs/{large}").status, 204)
            self.assertEqual(d.ask("PUT", "/v1/names/mesh/x", name).status, 200)

    def test_relative_an_eviction_makes_room_on_a_full_disk(self):
        with SmallDisk(config="budget_mb = 8\nkeep_free_mb = 0", size_mb=24) as d:
            # (33 + 1) maps of 6 x 48 x 48 texels of 12 bytes are 5.6 MB.
            request = quick_request(environment=d.put(hdr_bytes()), irradiance={"face_size": 48, "specular_maps": 33})
            bake = d.ask("POST", "/v1/bakes", request).json["id"]
            self.assertEqual(d.wait(bake)["state"], "done")
            stored = sum(file.stat().st_size for file in (d.inside / "blobs").rglob("*") if file.is_file())
            d.put(os.urandom((8 << 20) - stored - 1_000))
            d.make_log_full(leave=12_000)
            data = os.urandom(5_000)
            reply = d.ask("PUT", f"/v1/blobs/{sha256(data)}", data)
            self.assertEqual(reply.status, 201, reply.body)
            self.assertEqual(d.ask("GET", f"/v1/bakes/{bake}").status, 410)
            d.wait_for_log("are given to a deletion")


class FullFromTheStart(unittest.TestCase):
    """Fault: a disk that was full when the daemon started had no reserve, so no deletion worked."""

    def full_store(self, d, sizes):
        """Starts anew on a full disk and without a reserve. Returns the digests of files of these sizes."""
        digests = [d.put(os.urandom(size)) for size in sizes]
        self.upload = d.create_upload(bytes(700_000)).headers["Location"]
        self.assertEqual(d.append(self.upload, 0, bytes(600_000)).status, 204)
        d.stop()
        (d.inside / "reserve").unlink()
        d.fill(leave=48 << 10)  # SQLite's -shm has 32 KiB
        d.start()
        d.fill(name="filler 2")
        (d.inside / "reserve").unlink(missing_ok=True)
        d.fill(name="filler 3")
        return digests

    def test_a_deletion_uses_the_bytes_of_its_own_file(self):
        with LastingDisk() as d:
            small, large, *others = self.full_store(d, (5_000, 600_000, 700_000, 6_000))
            refused = d.ask("DELETE", f"/v1/blobs/{small}")
            self.assertEqual(refused.status, 507)
            detail = refused.json["detail"]
            self.assertTrue(detail.startswith(f"nothing was changed: the database {d.store}/hairbake.db cannot grow: its disk is full."))
            for words in ("Delete an input of at least 256 KiB first", "GET /v1/blobs lists inputs with their sizes",
                          "Or free 256 KiB on this disk by hand: files of other programs", f"files in {d.store}/lost+found",
                          f"Do not remove files in {d.store}/blobs by hand"):
                self.assertIn(words, detail)
            self.assertEqual(len(d.ask("GET", f"/v1/blobs/{small}").body), 5_000)
            for number, digest in enumerate((large, small, *others), 4):  # what is freed is kept for the next
                reply = d.ask("DELETE", f"/v1/blobs/{digest}")
                self.assertEqual(reply.status, 204, reply.body)
                self.assertEqual(d.ask("HEAD", f"/v1/blobs/{digest}").status, 404)
                d.fill(name=f"filler {number}")
            self.assertEqual(d.ask("DELETE", self.upload, headers=TUS).status, 204)
            d.stop()
            d.start()
            self.assertEqual(d.ask("GET", "/v1/blobs").json["blobs"], [])
            self.assertFalse((d.inside / "lost+found").exists())

    def test_relative_an_unfinished_upload(self):
        with LastingDisk() as d:
            small, = self.full_store(d, (5_000,))
            self.assertEqual(d.ask("DELETE", f"/v1/blobs/{small}").status, 507)
            reply = d.ask("DELETE", self.upload, headers=TUS)
            self.assertEqual(reply.status, 204, reply.body)
            self.assertEqual(d.ask("DELETE", f"/v1/blobs/{small}").status, 204)

    def test_relative_a_refusal_for_another_reason_leaves_the_bytes(self):
        """A name refers to the file: 409, though its bytes would make room."""
        with LastingDisk() as d:
            data = os.urandom(600_000)
            self.assertEqual(d.ask("PUT", "/v1/names/mesh/x", {"sha256": d.put(data)}).status, 200)
            self.full_store(d, ())
            path = f"/v1/blobs/{sha256(data)}"
            self.assertEqual(d.ask("DELETE", path).status, 409)
            self.assertEqual(d.ask("GET", path).body, data)
            self.assertEqual(d.ask("DELETE", f"{path}?force=1").status, 204)

    def test_relative_the_start_itself_uses_the_reserve(self):
        with LastingDisk() as d:
            kept = d.put(b"kept")
            d.stop()
            self.assertEqual((d.inside / "reserve").stat().st_size, 1 << 20)
            d.fill()
            d.start()
            d.wait_for_log("is removed, so that the store can be opened")
            self.assertEqual(d.ask("GET", f"/v1/blobs/{kept}").body, b"kept")
            self.assertEqual(d.ask("DELETE", f"/v1/blobs/{kept}").status, 204)

    def test_relative_a_cut_file_that_a_kill_left_is_forgotten_at_the_next_start(self):
        """As when the daemon is killed between the cut and the commit."""
        with LastingDisk() as d:
            only = d.put(os.urandom(600_000))
            d.kill()
            os.truncate(d.inside / "blobs" / only[:2] / only, 0)
            d.start()
            self.assertEqual(d.ask("HEAD", f"/v1/blobs/{only}").status, 404)
            self.assertEqual(d.ask("GET", "/readyz").status, 200)


if __name__ == "__main__":
    unittest.main()
