"""What happens to the store while the daemon runs: bytes that rot, removals in the log."""
import contextlib
import json
import os
import re
import sqlite3
import time
import unittest

from harness import PATIENCE, TUS, Daemon, hair_bytes, quick_request, sha256


def rewrite(file, data):
    """Other bytes in place, with the old mtime. Time must have passed since the last change, else ctime is the same."""
    before = file.stat()
    while file.stat().st_ctime_ns == before.st_ctime_ns:
        file.write_bytes(data)
        os.utime(file, ns=(before.st_atime_ns, before.st_mtime_ns))
    assert file.stat().st_mtime_ns == before.st_mtime_ns


class Rot(unittest.TestCase):
    """Fault: a blob was verified once after the start; a byte that rotted later was served."""

    def spoiled(self, data):
        flipped = bytes([data[0] ^ 1]) + data[1:]
        return {"a byte": flipped, "cut": data[:-1], "longer": data + b"x", "empty": b""}

    def test_bytes_that_change_after_they_were_served_are_not_served_again(self):
        with Daemon() as d:
            for name in self.spoiled(b"xx"):
                with self.subTest(name):
                    data = os.urandom(5000)
                    digest = d.put(data)
                    self.assertEqual(d.ask("GET", f"/v1/blobs/{digest}").body, data)
                    wrong = self.spoiled(data)[name]
                    rewrite(d.blob_file(digest), wrong)
                    reply = d.ask("GET", f"/v1/blobs/{digest}")
                    # Waiting does not bring an input back.
                    self.assertEqual((reply.status, reply.headers["Content-Type"]), (404, "application/problem+json"))
                    self.assertIsNone(reply.headers["Retry-After"])
                    self.assertIn(f"send the file sha256:{digest} again", reply.json["detail"])
                    self.assertEqual(d.ask("HEAD", f"/v1/blobs/{digest}").status, 404)
                    self.assertIn(wrong, [file.read_bytes() for file in (d.path / "store/lost+found").rglob(digest)])
                    self.assertEqual(d.put(data), digest)
                    self.assertEqual(d.ask("GET", f"/v1/blobs/{digest}").body, data)

    def test_a_result_that_changes_after_it_was_served_is_baked_again(self):
        with Daemon() as d:
            bake = d.ask("POST", "/v1/bakes", quick_request(d.put(hair_bytes()))).json["id"]
            file = next(f for f in d.wait(bake)["files"] if f["name"] == "transmittance.npy")
            right = d.ask("GET", file["href"]).body
            rewrite(d.blob_file(file["sha256"]), right[:-1] + bytes([right[-1] ^ 1]))
            reply = d.ask("GET", file["href"])
            self.assertEqual((reply.status, reply.headers["Retry-After"]), (503, "5"))  # it comes back by itself
            self.assertIn("the result is baked again", reply.json["detail"])
            self.assertEqual(d.wait(bake)["state"], "done")
            self.assertEqual(d.ask("GET", file["href"]).body, right)

    def test_bytes_that_changed_are_replaced_when_they_are_sent_again(self):
        with Daemon() as d:
            data = os.urandom(5000)
            digest = d.put(data)
            rewrite(d.blob_file(digest), self.spoiled(data)["a byte"])
            self.assertEqual(d.ask("PUT", f"/v1/blobs/{digest}", data).status, 200)
            self.assertEqual(d.ask("GET", f"/v1/blobs/{digest}").body, data)

    def test_a_file_that_was_touched_and_has_its_bytes_stays(self):
        with Daemon() as d:
            data = os.urandom(5000)
            digest = d.put(data)
            rewrite(d.blob_file(digest), data)
            os.utime(d.blob_file(digest))
            d.blob_file(digest).chmod(0o600)
            self.assertEqual(d.ask("GET", f"/v1/blobs/{digest}").body, data)
            self.assertFalse((d.path / "store/lost+found").exists())

    def test_the_scrub_finds_what_nobody_asks_for(self):
        with Daemon(config="scrub_s = 1") as d:
            hair = d.put(hair_bytes())
            bake = d.ask("POST", "/v1/bakes", quick_request(hair)).json["id"]
            result = next(f for f in d.wait(bake)["files"] if f["name"] == "transmittance.npy")["sha256"]
            missing, good = d.put(os.urandom(3000)), d.put(os.urandom(3000))
            spoiled = d.put(os.urandom(3000))
            rewrite(d.blob_file(spoiled), b"x" * 3000)
            right = d.blob_file(result).read_bytes()
            rewrite(d.blob_file(result), b"x" + right[1:])
            d.blob_file(missing).unlink()
            for digest in (spoiled, result, missing):
                d.wait_for_log(f"the stored bytes of sha256:{digest} were lost or spoiled")
            for digest, status in ((spoiled, 404), (missing, 404), (good, 200), (hair, 200)):
                self.assertEqual(d.ask("HEAD", f"/v1/blobs/{digest}").status, status)
            self.assertEqual(d.wait(bake)["state"], "done")
            self.assertEqual(d.ask("GET", f"/v1/blobs/{result}").body, right)  # baked again
            self.assertNotIn(good, (d.path / "log").read_text())

    def test_the_scrub_can_be_switched_off_and_records_its_checks(self):
        def checks(d):
            with contextlib.closing(sqlite3.connect(d.path / "store/hairbake.db")) as database:
                return dict(database.execute("SELECT sha256, checked FROM blobs"))

        with Daemon(config="scrub_s = 0") as d:
            digest = d.put(b"data")
            d.stop()
            before = checks(d)
            d.config = "scrub_s = 1"
            d.start()
            end = time.monotonic() + PATIENCE
            while checks(d)[digest] == before[digest] and time.monotonic() < end:
                time.sleep(0.1)
            self.assertGreater(checks(d)[digest], before[digest])


class RemovalLog(unittest.TestCase):
    """Each removal of a file of the store is a line of the log with the number of files and bytes."""

    def removals(self, d):
        """(files, bytes, reason) of each line."""
        messages = [json.loads(line)["message"] for line in (d.path / "log").read_text().splitlines() if line.startswith("{")]
        found = [re.fullmatch(r"removed (\d+) files of (\d+) bytes: (.*)", message) for message in messages]
        return [(int(m[1]), int(m[2]), m[3]) for m in found if m]

    def test_every_reason_is_counted(self):
        with Daemon(config="budget_mb = 1\nblob_mb = 1\nupload_lifetime_s = 1000") as d:
            first = os.urandom(700_000)
            d.put(first)
            hair = d.put(hair_bytes())
            self.assertEqual(d.ask("POST", "/v1/models", {"sha256": hair}).status, 201)
            thumbnail = d.ask("GET", f"/v1/models/{hair}/thumbnail.png").body
            self.assertEqual(d.ask("DELETE", f"/v1/models/{hair}").status, 204)
            self.assertEqual(d.ask("DELETE", f"/v1/blobs/{d.put(b'loose')}").status, 204)
            data = b"an upload"
            upload = d.create_upload(data).headers["Location"]
            self.assertEqual(d.append(upload, 0, data[:4]).status, 204)
            self.assertEqual(d.ask("DELETE", upload, headers=TUS).status, 204)
            upload = d.create_upload(data).headers["Location"]
            self.assertEqual(d.append(upload, 0, data).status, 204)
            upload = d.create_upload(data, digest=sha256(b"other")).headers["Location"]
            self.assertEqual(d.append(upload, 0, data).status, 422)
            self.assertEqual(self.removals(d), [(2, len(hair_bytes()) + len(thumbnail), "the model was deleted on request"),
                                                (1, 5, "the file was deleted on request"),
                                                (1, 4, "the upload was deleted on request"),
                                                (1, len(data), "the upload became a blob, which keeps the bytes"),
                                                (1, len(data), "the upload's digest is wrong")])

    def test_results_that_make_room_are_counted(self):
        with Daemon(config="budget_mb = 1\nblob_mb = 1") as d:
            hair = d.put(hair_bytes())
            bake = d.ask("POST", "/v1/bakes", quick_request(hair)).json["id"]
            files = d.wait(bake)["files"][1:]
            for number in range(2):  # more than what is left without the results
                blob = d.put(os.urandom((1 << 20) // 2 - 9000))
                d.ask("PUT", f"/v1/names/mesh/{number}", {"sha256": blob})
            self.assertEqual(d.ask("GET", f"/v1/bakes/{bake}").status, 410)
            self.assertIn((len({f["sha256"] for f in files}), sum({f["sha256"]: f["bytes"] for f in files}.values()),
                           "the budget is used up; least recently used first"), self.removals(d))

    def test_a_start_counts_lost_and_found_after_the_last_move(self):
        """Fault: an unknown upload was moved after the count. Relative: a second start counts the same."""
        with Daemon() as d:
            d.stop()
            unknown = "0" * 64
            (d.blob_file(unknown)).write_bytes(b"a blob")
            (d.path / "store/uploads/unknown").write_bytes(b"an upload")
            for _ in range(2):
                (d.path / "log").write_text("")
                d.start()
                self.assertIn(f"{d.path}/store/lost+found holds 2 files of 15 bytes", (d.path / "log").read_text())
                d.stop()

    def test_a_removal_that_a_kill_interrupted_is_completed_and_a_blob_that_came_again_stays(self):
        """Relative: files without a row that may go, and files without a row that may not."""
        with Daemon() as d:
            removed, again = os.urandom(800), os.urandom(900)
            for data in (removed, again):
                d.put(data)
            d.stop()
            with contextlib.closing(sqlite3.connect(d.path / "store/hairbake.db")) as database, database:
                for data in (removed, again):
                    database.execute("DELETE FROM blobs WHERE sha256 = ?", (sha256(data),))
                    database.execute("INSERT INTO removals VALUES(?, ?)", (sha256(data), time.time()))
            time.sleep(0.1)  # so that the file is younger than its removal
            d.blob_file(sha256(again)).unlink()
            d.blob_file(sha256(again)).write_bytes(again)
            d.start()
            self.assertEqual(self.removals(d), [(1, 800, "their blobs were removed before the daemon ended")])
            self.assertEqual([file.read_bytes() for file in (d.path / "store/lost+found").rglob(sha256(again))], [again])


if __name__ == "__main__":
    unittest.main()
