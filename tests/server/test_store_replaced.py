"""Files and folders of the store that are moved, deleted or replaced while the daemon runs."""
import os
import shutil
import sqlite3
import unittest

from harness import TUS, Daemon, hair_bytes, quick_request, sha256


class Replaced(unittest.TestCase):
    """Fault: the database file was deleted, and the daemon went on answering 2xx to writes that no restart would find."""

    def obstacles(self):
        """By name, what is done to the store's folder; returns what undoes it."""
        def away(name):
            def move(store):
                (store / name).rename(store.parent / "aside")
                return lambda: (store.parent / "aside").rename(store / name)
            return move

        def copied(name):
            def copy(store):
                path = store / name
                path.rename(store.parent / "aside")
                (shutil.copytree if (store.parent / "aside").is_dir() else shutil.copy)(store.parent / "aside", path)
                return lambda: ((shutil.rmtree if path.is_dir() else os.unlink)(path), (store.parent / "aside").rename(path))
            return copy

        found = {f"{name} is gone": away(name) for name in ("hairbake.db", "hairbake.db-wal", "hairbake.db-shm", "blobs", "tmp",
                                                            "uploads", "lock", "")}
        found |= {f"{name or 'the folder'} is replaced by a copy": copied(name) for name in ("hairbake.db", "blobs", "")}
        return found

    def writes(self, d):
        """Requests that must write, by name; none repeats what is stored."""
        data = os.urandom(300)
        return {"PUT blob": lambda: d.ask("PUT", f"/v1/blobs/{sha256(data)}", data),
                "PUT name": lambda: d.ask("PUT", "/v1/names/mesh/x", {"sha256": d.kept}),
                "POST bake": lambda: d.ask("POST", "/v1/bakes", quick_request(d.kept, transmittance={"voxels": 33})),
                "POST upload": lambda: d.create_upload(data),
                "PATCH upload": lambda: d.append(d.upload, 0, b"half"),
                "DELETE upload": lambda: d.ask("DELETE", d.upload, headers=TUS)}

    def test_readyz_and_writes_fail_at_once_and_what_is_put_back_heals(self):
        with Daemon() as d:
            d.kept = d.put(hair_bytes())
            d.upload = d.create_upload(b"half an upload").headers["Location"]
            store = d.path / "store"
            for name, spoil in self.obstacles().items():
                with self.subTest(name):
                    self.assertEqual(d.ask("GET", "/readyz").status, 200)
                    heal = spoil(store)
                    ready = d.ask("GET", "/readyz")
                    self.assertEqual((ready.status, ready.json["type"]), (503, "urn:hairbake:problem:not-ready"))
                    self.assertRegex(ready.json["detail"], "was (moved or deleted|replaced) while the daemon works with it")
                    for write, ask in self.writes(d).items():
                        reply = ask()
                        self.assertEqual((reply.status, reply.headers["Retry-After"]), (503, "5"), (write, reply.body))
                        self.assertIn(str(store), reply.json["detail"], write)
                    # What is read may be read.
                    away = not (store / "uploads").is_dir()
                    self.assertEqual(d.ask("HEAD", d.upload, headers=TUS).status, 503 if away else 200)
                    self.assertEqual(d.ask("GET", "/v1/blobs").status, 200)
                    heal()
                    self.assertEqual(d.ask("GET", "/readyz").status, 200)
            offset = int(d.ask("HEAD", d.upload, headers=TUS).headers["Upload-Offset"])
            for write, ask in {name: ask for name, ask in self.writes(d).items() if "PATCH" not in name}.items():
                self.assertIn(ask().status, (200, 201, 202, 204), write)
            self.assertEqual(offset, 0)

    def test_a_database_that_is_put_there_while_the_daemon_ends_keeps_its_log(self):
        """Relative: the last connection that closes deletes the log at its path, no matter whose it is."""
        with Daemon() as d:
            kept = d.put(b"kept")
            d.stop()
            store = d.path / "store"
            other = d.path / "other"
            shutil.copytree(store, other)
            connection = sqlite3.connect(other / "hairbake.db")
            connection.execute("INSERT INTO names VALUES('mesh', 'in the log', 1, ?, '', '', 0)", (kept,))
            connection.commit()
            d.start()
            for end in ("", "-wal", "-shm"):
                (store / f"hairbake.db{end}").unlink()
                shutil.copy(other / f"hairbake.db{end}", store / f"hairbake.db{end}")
            whole = (store / "hairbake.db-wal").read_bytes()
            self.assertEqual(d.stop()[0], 0)
            self.assertEqual((store / "hairbake.db-wal").read_bytes(), whole)
            connection.close()

    def test_blobs_are_not_forgotten_while_their_folder_is_away(self):
        with Daemon() as d:
            hair = d.put(hair_bytes())
            bake = d.ask("POST", "/v1/bakes", quick_request(hair)).json["id"]
            self.assertEqual(d.wait(bake)["state"], "done")
            for name in ("blobs", f"blobs/{hair[:2]}", ""):
                folder, aside = d.path / "store" / name, d.path / "aside"
                folder.rename(aside)
                self.assertEqual(d.ask("GET", f"/v1/blobs/{hair}").status, 503)
                aside.rename(folder)
                self.assertEqual(d.ask("GET", f"/v1/blobs/{hair}").body, hair_bytes())

    def test_a_bake_whose_end_cannot_be_written_goes_on_when_the_database_is_back(self):
        with Daemon() as d:
            hair = d.put(hair_bytes(strands=400, points=40))
            bake = d.ask("POST", "/v1/bakes", quick_request(hair, transmittance={"directions": 512, "voxels": 96})).json["id"]
            database, aside = d.path / "store/hairbake.db", d.path / "aside"
            database.rename(aside)
            d.wait_for_log("was moved or deleted while the daemon works with it")
            aside.rename(database)
            self.assertEqual(d.wait(bake)["state"], "done")


class RestartMends(unittest.TestCase):
    """Fault: the advice for a deleted `lock` was to put the file back, which nobody can."""

    def test_a_part_that_a_restart_makes_anew(self):
        """Relatives: a lock that was replaced, the folders tmp and uploads, a folder blobs that is a copy, SQLite's -shm."""
        def deleted(path):
            path.rmdir() if path.is_dir() else path.unlink()

        def replaced(path):
            aside = path.parent.parent / "aside"
            path.rename(aside)
            (shutil.copytree if aside.is_dir() else shutil.copy)(aside, path)
            shutil.rmtree(aside) if aside.is_dir() else aside.unlink()

        for name, spoil in (("lock", deleted), ("lock", replaced), ("tmp", deleted), ("uploads", deleted), ("blobs", replaced),
                            ("hairbake.db-shm", deleted)):
            with self.subTest(f"{name} {spoil.__name__}"), Daemon() as d:
                kept = d.put(hair_bytes())
                self.assertEqual(d.ask("PUT", "/v1/names/model/x", {"sha256": kept}).status, 200)
                path = d.path / "store" / name
                spoil(path)
                for reply in (d.ask("GET", "/readyz"), d.ask("PUT", "/v1/names/model/x", {"sha256": kept})):
                    self.assertEqual(reply.status, 503)
                    self.assertIn(f"{path} was {'moved or deleted' if spoil is deleted else 'replaced'} while the daemon works "
                                  "with it; nothing is written. ", reply.json["detail"])
                    self.assertIn("restart the daemon", reply.json["detail"])
                self.assertEqual(d.stop()[0], 0)
                d.start()
                self.assertEqual(d.ask("GET", "/readyz").status, 200)
                self.assertEqual(d.ask("GET", f"/v1/blobs/{kept}").body, hair_bytes())
                self.assertEqual(d.ask("GET", "/v1/names/model/x").json["sha256"], kept)

    def test_relative_a_deleted_database_is_not_mended_by_a_restart(self):
        with Daemon() as d:
            for name in ("hairbake.db", "hairbake.db-wal"):
                path = d.path / "store" / name
                path.rename(d.path / "aside")
                detail = d.ask("GET", "/readyz").json["detail"]
                self.assertIn("docs/deployment.md tells how to save a deleted database", detail)
                self.assertNotIn("restart", detail)
                (d.path / "aside").rename(path)


if __name__ == "__main__":
    unittest.main()
