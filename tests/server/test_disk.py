"""A store whose disk is full or cannot be written: a small tmpfs in a mount namespace of the daemon's own."""
import errno
import os
import subprocess
import time
import unittest
from pathlib import Path

from harness import PATIENCE, TUS, Daemon, hair_bytes, hdr_bytes, quick_request, sha256

SIZE_MB = 8


class SmallDisk(Daemon):
    """The store is a tmpfs of SIZE_MB that only the daemon and its workers see; it is gone when the daemon ends."""

    def __init__(self, config="keep_free_mb = 0", size_mb=SIZE_MB):
        super().__init__(config=config)
        self.store = self.path / "store"
        self.store.mkdir()
        mount = f'mount -t tmpfs -o size={size_mb}m none "$0" && exec "$@"'
        self.before = ["unshare", "--map-root-user", "--mount", "sh", "-c", mount, self.store]

    @property
    def inside(self):
        """The store as the daemon sees it."""
        return Path(f"/proc/{self.process.pid}/root{self.store}")

    def run_inside(self, script):
        subprocess.run(["nsenter", "--target", str(self.process.pid), "--user", "--mount", "--preserve-credentials", "sh", "-c",
                        script, self.store], check=True, timeout=PATIENCE)

    def fill(self, leave=0):
        """Writes until nothing fits any more, then gives `leave` bytes free."""
        with open(self.inside / "filler", "wb", buffering=0) as filler:
            try:
                while filler.write(bytes(4096)):
                    pass
            except OSError as error:
                assert error.errno == errno.ENOSPC, error
            filler.truncate(filler.tell() - leave)

    def free_filler(self):
        (self.inside / "filler").unlink()

    def leftovers(self):
        return sorted(p.name for p in (self.inside / "tmp").iterdir())


def verified(test, d, bake):
    """Every file of the bake has the bytes that its digest names."""
    files = d.ask("GET", f"/v1/bakes/{bake}").json["files"][1:]
    test.assertTrue(files)
    for file in files:
        test.assertEqual(sha256(d.ask("GET", file["href"]).body), file["sha256"])


class Disk(unittest.TestCase):
    def assert_full(self, reply):
        self.assertEqual((reply.status, reply.headers["Content-Type"]), (507, "application/problem+json"), reply.body)
        self.assertEqual(reply.json["type"], "urn:hairbake:problem:full")

    def test_a_full_disk_is_507_nothing_wrong_is_served_and_space_heals_it(self):
        with SmallDisk() as d:
            hair, sky = d.put(hair_bytes()), d.put(hdr_bytes())
            bake = d.ask("POST", "/v1/bakes", quick_request(hair, sky)).json["id"]
            self.assertEqual(d.wait(bake)["state"], "done")
            data = os.urandom(300_000)
            upload = d.create_upload(data).headers["Location"]
            d.fill()
            self.assert_full(d.ask("PUT", f"/v1/blobs/{sha256(data)}", data))
            self.assertEqual(d.ask("HEAD", f"/v1/blobs/{sha256(data)}").status, 404)
            self.assert_full(d.append(upload, 0, data))
            self.assert_full(d.ask("PUT", "/v1/names/model/x", {"sha256": hair}))
            self.assert_full(d.ask("POST", "/v1/bakes", quick_request(hair, sky, irradiance={"exponent": 9})))
            self.assertEqual(d.ask("GET", "/healthz").status, 200)
            ready = d.ask("GET", "/readyz")
            self.assertEqual((ready.status, ready.json["type"]), (503, "urn:hairbake:problem:not-ready"))
            self.assertIn("No space left", ready.json["detail"])
            self.assertEqual(d.ask("POST", "/v1/bakes", quick_request(hair, sky)).status, 200)  # a done bake: nothing is written
            verified(self, d, bake)
            self.assertEqual(d.leftovers(), [])

            d.free_filler()
            self.assertEqual(d.ask("GET", "/readyz").status, 200)
            offset = int(d.ask("HEAD", upload, headers=TUS).headers["Upload-Offset"])
            self.assertEqual(d.append(upload, offset, data[offset:]).status, 204)
            self.assertEqual(d.ask("GET", f"/v1/blobs/{sha256(data)}").body, data)
            again = d.ask("POST", "/v1/bakes", quick_request(hair, sky, irradiance={"exponent": 9}))
            self.assertEqual(d.wait(again.json["id"])["state"], "done")
            verified(self, d, again.json["id"])

    def wait_for_pause(self, d, bake, word):
        """The bake waits, and its stage says why; /readyz does, too."""
        end = time.monotonic() + PATIENCE
        while not (stage := (view := d.ask("GET", f"/v1/bakes/{bake}").json)["stages"][0]).get("trouble"):
            self.assertIn(view["state"], ("queued", "running"), view)
            self.assertLess(time.monotonic(), end, view)
            time.sleep(0.02)
        self.assertIn(word, stage["trouble"])
        ready = d.ask("GET", "/readyz")
        self.assertEqual(ready.status, 503)
        self.assertIn(word, ready.json["detail"])

    def test_a_result_that_does_not_fit_waits_and_space_lets_it_bake(self):
        with SmallDisk() as d:
            sky = d.put(hdr_bytes())
            # (33 + 1) maps of 6 x 48 x 48 texels of 12 bytes are 5.6 MB: more than is left, less than the disk.
            request = quick_request(environment=sky, irradiance={"face_size": 48, "specular_maps": 33})
            d.fill(leave=1 << 20)
            bake = d.ask("POST", "/v1/bakes", request).json["id"]
            self.wait_for_pause(d, bake, "No space left")
            self.assertEqual(d.ask("GET", f"/v1/bakes/{bake}/files/specular.npy").status, 409)
            d.free_filler()
            view = d.wait(bake)
            self.assertEqual((view["state"], view["stages"][0]["attempts"]), ("done", 1))
            self.assertEqual(d.leftovers(), [])
            verified(self, d, bake)

    def test_a_store_that_cannot_be_written_is_507_and_readyz_says_so(self):
        with SmallDisk() as d:
            hair = d.put(hair_bytes())
            bake = d.ask("POST", "/v1/bakes", quick_request(hair)).json["id"]
            self.assertEqual(d.wait(bake)["state"], "done")
            d.run_inside('mount --bind "$0" "$0" && mount -o remount,bind,ro "$0"')
            reply = d.ask("PUT", f"/v1/blobs/{sha256(b'x')}", b"x")
            self.assert_full(reply)
            self.assertIn("cannot be written", reply.json["detail"])
            ready = d.ask("GET", "/readyz")
            self.assertEqual(ready.status, 503)
            self.assertIn("Read-only", ready.json["detail"])
            other = quick_request(hair, transmittance={"seed": 2, "direction_set": "random"})
            waiting = d.ask("POST", "/v1/bakes", other).json["id"]  # the database was open before
            self.wait_for_pause(d, waiting, "Read-only")
            verified(self, d, bake)
            d.run_inside('umount --lazy "$0"')  # a reply's file may be open still
            self.assertEqual(d.wait(waiting)["state"], "done")
            self.assertEqual(d.ask("GET", "/readyz").status, 200)

    def test_a_store_that_cannot_be_written_stops_the_start_with_the_reason(self):
        with SmallDisk() as d:
            d.stop()
            d.before[5] = 'mount -t tmpfs -o ro none "$0" && exec "$@"'
            process = d.spawn()
            self.assertNotEqual(process.wait(PATIENCE), 0)
            process.stdout.close()
            self.assertIn("Read-only file system", (d.path / "log").read_text())


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
                    self.make_log_full(d)
                    self.assertEqual(d.ask("PUT", "/v1/names/mesh/x", {"sha256": mesh}).status, 507)
                    reply = d.ask("DELETE", path, headers=headers)
                    self.assertEqual(reply.status, 204, reply.body)
                    d.free_filler()
                    self.assertEqual(d.ask("GET", "/readyz").status, 200)
                    # The next deletion makes the reserve again; so does the daemon once a minute.
                    self.assertEqual(d.ask("DELETE", f"/v1/blobs/{d.put(b'small')}").status, 204)
            self.assertIn("are given to a deletion", (d.path / "log").read_text())
            self.assertEqual([blob["sha256"] for blob in d.ask("GET", "/v1/blobs").json["blobs"]], [])

    def make_log_full(self, d):
        """Fills the disk so that the database's log cannot grow. The log keeps the size that it once had, and is begun anew
        after a checkpoint: so it is emptied first."""
        database = d.inside / "hairbake.db"
        subprocess.run(["nsenter", "--target", str(d.process.pid), "--user", "--mount", "--preserve-credentials", "python3", "-c",
                        "import sqlite3, sys; sqlite3.connect(sys.argv[1]).execute('PRAGMA wal_checkpoint(TRUNCATE)')",
                        d.store / "hairbake.db"], check=True, timeout=PATIENCE)
        self.assertEqual((database.parent / "hairbake.db-wal").stat().st_size, 0)
        d.fill()

    def test_relative_without_a_reserve_the_reply_says_why_not_and_what_to_do(self):
        """A small disk has no reserve."""
        with SmallDisk() as d:
            mesh = d.put(os.urandom(1 << 20))
            self.assertFalse((d.inside / "reserve").exists())
            self.make_log_full(d)
            reply = d.ask("DELETE", f"/v1/blobs/{mesh}")
            self.assertEqual(reply.status, 507)
            self.assertRegex(reply.json["detail"], f"^nothing was changed: the database {d.store}/hairbake.db cannot .*disk")
            self.assertEqual(d.ask("HEAD", f"/v1/blobs/{mesh}").status, 200)
            ready = d.ask("GET", "/readyz")
            self.assertEqual(ready.status, 503)
            self.assertIn(f"the store cannot grow in {d.store}/tmp: No space left on device. Make room on its disk: delete inputs "
                          "that nothing needs (GET /v1/blobs?unneeded=1 lists them)", ready.json["detail"])
            d.free_filler()
            self.assertEqual(d.ask("DELETE", f"/v1/blobs/{mesh}").status, 204)


if __name__ == "__main__":
    unittest.main()
