"""A store whose disk is full or cannot be written."""
import os
import time
import unittest

from disks import SmallDisk
from harness import PATIENCE, TUS, hair_bytes, hdr_bytes, quick_request, sha256


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

    def test_a_file_that_is_stored_is_taken_again_on_a_full_disk(self):
        """Fault: 507, although nothing is written. Relatives: a body in chunks, one that fills the disk on its way, one of other
        bytes, and a stored file whose bytes were spoiled."""
        with SmallDisk() as d:
            data = os.urandom(300_000)
            digest = d.put(data)
            path = f"/v1/blobs/{digest}"
            for leave in (0, 100_000):
                d.fill(leave=leave)
                for body in (data, iter([data[:200_000], data[200_000:]])):
                    reply = d.ask("PUT", path, body)
                    self.assertEqual((reply.status, reply.json), (200, {"sha256": digest, "bytes": len(data)}))
                wrong = d.ask("PUT", path, os.urandom(300_000))
                self.assertEqual((wrong.status, wrong.json["field"]), (422, "sha256"))
                self.assert_full(d.ask("PUT", f"/v1/blobs/{sha256(bytes(300_000))}", bytes(300_000)))
                self.assertEqual(d.leftovers(), [])
                self.assertEqual(d.ask("GET", path).body, data)
                d.free_filler()
            (d.inside / "blobs" / digest[:2] / digest).write_bytes(b"spoiled")
            d.fill(leave=60_000)  # for the database, which forgets the spoiled bytes
            reply = d.ask("PUT", path, data)
            self.assertEqual((reply.status, reply.json["type"]), (503, "urn:hairbake:problem:busy"), reply.body)
            self.assertIn("Make room on the disk, then send the file again", reply.json["detail"])
            d.free_filler()
            self.assertEqual(d.ask("PUT", path, data).status, 201)

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

    def test_a_store_that_cannot_be_written_is_503_and_readyz_says_so(self):
        with SmallDisk() as d:
            hair = d.put(hair_bytes())
            bake = d.ask("POST", "/v1/bakes", quick_request(hair)).json["id"]
            self.assertEqual(d.wait(bake)["state"], "done")
            d.run_inside('mount --bind "$0" "$0" && mount -o remount,bind,ro "$0"')
            reply = d.ask("PUT", f"/v1/blobs/{sha256(b'x')}", b"x")
            self.assertEqual((reply.status, reply.json["type"]), (503, "urn:hairbake:problem:unwritable"), reply.body)
            self.assertIn("Retry-After", reply.headers)
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


if __name__ == "__main__":
    unittest.main()
