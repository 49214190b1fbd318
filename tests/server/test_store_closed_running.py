"""Folders and files of the store that are closed to the daemon while it runs: the messages name them and what to do."""
import contextlib
import os
import subprocess
import time
import unittest

from harness import PATIENCE, TUS, Daemon, hair_bytes, quick_request, sha256


class Closed(unittest.TestCase):
    """Fault: a store whose folder was closed to the daemon was told to be replaced."""

    def test_a_folder_that_is_closed_is_told_with_the_reason_and_what_to_do(self):
        with Daemon() as d:
            d.become_bound_to_modes()
            digest = d.put(b"kept")
            store = d.path / "store"
            # The database may be a link into another folder.
            d.stop()
            elsewhere = store / "elsewhere"
            elsewhere.mkdir()
            for end in ("", "-wal", "-shm"):
                if (store / f"hairbake.db{end}").exists():
                    (store / f"hairbake.db{end}").rename(elsewhere / f"hairbake.db{end}")
            (store / "hairbake.db").symlink_to(elsewhere / "hairbake.db")
            d.start()
            for closed in (store, elsewhere):
                with self.subTest(closed.name):
                    mode = closed.stat().st_mode
                    closed.chmod(0)
                    try:
                        ready = d.ask("GET", "/readyz")
                        written = d.ask("PUT", "/v1/names/mesh/x", {"sha256": digest})
                    finally:
                        closed.chmod(mode)
                    for reply in (ready, written):
                        self.assertEqual(reply.status, 503)
                        self.assertIn("cannot be reached: Permission denied; nothing is written", reply.json["detail"])
                        self.assertIn(f"may not use {closed}: it belongs to user {os.geteuid()} and has the mode 0000",
                                      reply.json["detail"])
                        self.assertIn(f"`chmod u+rwX {closed}`", reply.json["detail"])
                        self.assertNotIn("replaced", reply.json["detail"])
                    self.assertEqual(d.ask("GET", "/readyz").status, 200)
            # A database that is closed while the daemon has it open keeps working.
            (elsewhere / "hairbake.db").chmod(0)
            self.assertEqual(d.ask("GET", "/readyz").status, 200)
            self.assertEqual(d.ask("PUT", "/v1/names/mesh/x", {"sha256": digest}).status, 200)

    def test_relative_parts_that_may_not_be_written(self):
        """The message had neither the path nor what to do."""
        with Daemon() as d:
            d.become_bound_to_modes()
            upload = d.create_upload(b"an upload").headers["Location"]
            data = b"new"
            for part, ask in (("tmp", lambda: d.ask("GET", "/readyz")),
                              ("tmp", lambda: d.ask("PUT", f"/v1/blobs/{sha256(data)}", data)),
                              ("uploads", lambda: d.create_upload(b"another")),
                              ("uploads", lambda: d.append(upload, 0, b"an upload"))):
                closed = d.path / "store" / part
                mode = closed.stat().st_mode
                closed.chmod(0)
                try:
                    reply = ask()
                finally:
                    closed.chmod(mode)
                self.assertEqual(reply.status, 503, reply.body)
                self.assertIn(f"in {closed}: Permission denied. ", reply.json["detail"])
                self.assertIn(f"`chmod u+rwX {closed}`", reply.json["detail"])
            self.assertEqual(d.append(upload, 0, b"an upload").status, 204)

    def assert_tells(self, reply, folder, mode="0000"):
        self.assertEqual(reply.status, 503, reply.body)  # and not 507: the disk has room
        detail = reply.json["detail"]
        self.assertIn(f"may not use {folder}: it belongs to user {os.geteuid()} and has the mode {mode}", detail)
        self.assertIn(f"`chmod u+rwX {folder}`", detail)
        self.assertNotIn("filesystem error", detail)

    def test_the_folders_of_blobs(self):
        """Fault: the refusal of a PUT named the daemon's own temporary file, and /readyz stayed ready. Relatives: one folder of
        the blobs, a folder that may be read and not written, a POST of a model, the end of a resumable upload."""
        data = hair_bytes(seed=3)
        digest = sha256(data)
        with Daemon() as d:
            d.become_bound_to_modes()
            upload = d.create_upload(data).headers["Location"]
            for part in ("blobs", f"blobs/{digest[:2]}"):
                for mode in (0o000, 0o500):
                    closed = d.path / "store" / part
                    if part == "blobs" and mode:
                        continue  # new files go into its folders
                    with self.subTest(part, mode=oct(mode)):
                        right = closed.stat().st_mode
                        closed.chmod(mode)
                        try:
                            replies = [d.ask("PUT", f"/v1/blobs/{digest}", data), d.ask("GET", "/readyz"),
                                       d.ask("POST", "/v1/models", data, {"Content-Type": "application/octet-stream"}),
                                       d.append(upload, int(d.ask("HEAD", upload, headers=TUS).headers["Upload-Offset"]), data)]
                        finally:
                            closed.chmod(right)
                        for reply in replies[:3]:
                            self.assert_tells(reply, closed, f"{mode:04o}")
                            self.assertNotIn("store/tmp", reply.json["detail"])
                        self.assertNotEqual(replies[3].status, 204)
                        self.assertEqual(d.ask("GET", "/readyz").status, 200)
            self.assertEqual(d.put(data), digest)

    def test_an_attribute_that_forbids_changes_is_named(self):
        """Fault: the advice named owner and mode, which were right. Relatives: the folder of new files, the one of a blob, its
        file; immutable and append only."""
        with Daemon() as d, contextlib.ExitStack() as stack:
            kept, data = d.put(b"kept"), b"new"
            ask = {"tmp": lambda: d.ask("PUT", f"/v1/blobs/{sha256(data)}", data),
                   f"blobs/{kept[:2]}": lambda: d.ask("DELETE", f"/v1/blobs/{kept}"),
                   f"blobs/{kept[:2]}/{kept}": lambda: d.ask("DELETE", f"/v1/blobs/{kept}")}
            for part in ask:
                path = d.path / "store" / part
                stack.callback(subprocess.run, ["chattr", "-i", "-a", path], stderr=subprocess.DEVNULL)
                for attribute in ("i",) if part == "tmp" else ("i", "a"):
                    if subprocess.run(["chattr", f"+{attribute}", path], stderr=subprocess.DEVNULL).returncode != 0:
                        self.skipTest("the file system has no attributes, or this user may not set them")
                    reply = ask[part]()
                    subprocess.run(["chattr", f"-{attribute}", path], check=True)
                    with self.subTest(part, attribute=attribute):
                        self.assertEqual((reply.status, reply.json["type"]), (503, "urn:hairbake:problem:unwritable"), reply.body)
                        self.assertIn(f"{path} has the attribute {attribute} ", reply.json["detail"])
                        self.assertIn(f"`chattr -{attribute} {path}`", reply.json["detail"])
                        self.assertNotIn("chown", reply.json["detail"])
                        self.assertEqual(d.ask("GET", f"/v1/blobs/{kept}").body, b"kept")
            self.assertEqual(d.ask("DELETE", f"/v1/blobs/{kept}").status, 204)
            self.assertFalse(d.blob_file(kept).exists())

    def test_a_folder_of_blobs_that_is_missing_is_told(self):
        with Daemon() as d:
            (d.path / "store/blobs/ab").rmdir()
            ready = d.ask("GET", "/readyz")
            self.assertEqual(ready.status, 503)
            self.assertIn(f"the folder {d.path}/store/blobs/ab is missing. Put it back with its files, or restart the daemon, which "
                          "makes an empty one", ready.json["detail"])
            d.stop()
            d.start()
            self.assertEqual(d.ask("GET", "/readyz").status, 200)

    def test_what_a_bake_cannot_read(self):
        """Fault: /readyz had "filesystem error: status: Permission denied [...]", or nothing of what to do. Relatives: the folder
        of all blobs, the folder of the input, and the input itself."""
        with Daemon() as d:
            d.become_bound_to_modes()
            hair = d.put(hair_bytes())
            for seed, closed in enumerate((d.path / "store/blobs", d.blob_file(hair).parent, d.blob_file(hair)), 1):
                with self.subTest(closed.name):
                    right = closed.stat().st_mode
                    closed.chmod(0)
                    try:
                        bake = d.ask("POST", "/v1/bakes", quick_request(hair, transmittance={
                            "seed": seed, "direction_set": "random"})).json["id"]
                        end = time.monotonic() + PATIENCE
                        while not (trouble := d.ask("GET", f"/v1/bakes/{bake}").json["stages"][0].get("trouble")):
                            self.assertLess(time.monotonic(), end)
                            time.sleep(0.02)
                        self.assertIn("Permission denied", trouble)
                        self.assertIn(f"`chmod u+rwX the store/{closed.relative_to(d.path / 'store')}`", trouble)  # for clients
                        self.assert_tells(d.ask("GET", "/readyz"), closed)
                    finally:
                        closed.chmod(right)
                    self.assertEqual(d.wait(bake)["state"], "done")
            self.assertNotIn("filesystem error", (d.path / "log").read_text())


if __name__ == "__main__":
    unittest.main()
