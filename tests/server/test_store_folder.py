"""Starts in another folder, with missing files, on another device, or beside another daemon: no file is removed."""
import os
import shutil
import sqlite3
import tempfile
import unittest
from pathlib import Path

from harness import Daemon, hair_bytes, hdr_bytes, quick_request
from stores import Store, StoreTest, end_of


class OtherFolder(StoreTest):
    """Fault: the daemon emptied a folder that it was given by mistake."""

    def test_a_folder_of_somebody_else_stops_the_start_and_keeps_every_file(self):
        for entry in ("notes.txt", "tmp/session", "tmp/" + 32 * "a", "blobs/photo.jpg", "uploads/letter", "src/main.c"):
            with self.subTest(entry), Daemon() as d:
                d.stop()
                store = d.path / "elsewhere"
                (store / entry).parent.mkdir(parents=True)
                (store / entry).write_text("mine")
                d.write_config = lambda d=d: (d.path / "hairbake.toml").write_text(
                    '[listen]\nport = 0\n[store]\nfolder = "elsewhere"\n')
                self.assertEqual(end_of(d.spawn()), 3)
                self.assertIn("Nothing was changed or removed", (d.path / "log").read_text())
                self.assertEqual([p.relative_to(store).as_posix() for p in store.rglob("*") if p.is_file()], [entry])

    def test_a_new_file_system_is_an_empty_folder(self):
        with Daemon() as d:
            d.stop()
            shutil.rmtree(d.path / "store")
            (d.path / "store/lost+found").mkdir(parents=True)
            (d.path / "store/lost+found").chmod(0)
            d.start()
            self.assertEqual(d.ask("GET", "/readyz").status, 200)

    def test_files_of_others_in_tmp_of_a_store_stay(self):
        with Store() as d:
            (d.store / "tmp/session").write_text("mine")
            (d.store / "tmp" / (32 * "a")).mkdir()
            (d.store / "tmp" / (32 * "a") / "words.jsonl").write_text("a work folder of a daemon that was killed")
            d.start()
            self.assertEqual(d.leftovers(), ["session"])
            self.assertIn("removed 1 files of 41 bytes: bodies and results", d.log)

    def test_a_disk_that_is_not_mounted_stops_the_start(self):
        with Store() as d:
            d.config = f'id = "{(store_id := d.id)}"'
            d.start()
            d.stop()
            d.store.rename(d.path / "the disk")
            d.store.mkdir()  # the mount point
            self.assert_stops(d, "Is its disk mounted?", store_id)
            shutil.rmtree(d.store)
            (d.path / "the disk").rename(d.store)
            d.start()
            self.assert_serves_all(d)

    def test_blobs_that_are_all_missing_stop_the_start(self):
        """As when the folder blobs is the mount point of a disk that is not mounted; the disk of another store is no better."""
        with Store() as d:
            (d.store / "blobs").rename(d.path / "aside")
            for other in (None, "ab/" + 64 * "a"):
                (d.store / "blobs").mkdir(exist_ok=True)
                if other:
                    (d.store / "blobs/ab" / (64 * "a")).write_text("of another store")
                self.assert_stops(d, "holds none of the", "Is its disk mounted?")
            shutil.rmtree(d.store / "blobs")
            (d.path / "aside").rename(d.store / "blobs")
            d.start()
            self.assert_serves_all(d)
            d.stop()
            # Whoever has lost them for good says so.
            shutil.rmtree(d.store / "blobs")
            d.accept()
            d.start()
            self.assertEqual(d.ask("HEAD", f"/v1/blobs/{d.hair}").status, 404)
            d.put(d.data[d.hair])
            d.ask("POST", "/v1/bakes", quick_request(d.hair))
            self.assertEqual(d.wait(d.bake)["state"], "done")

    def test_another_id_in_the_settings_stops_the_start(self):
        with Store() as d:
            d.config = f'id = "{32 * "0"}"'
            self.assert_stops(d, d.id, 32 * "0", "Does [store] folder name the right folder, and is its disk mounted?",
                              f"To serve this store, set id to {d.id} or remove it")
            d.config = f'id = "{d.id}"'
            d.start()
            self.assert_serves_all(d)

    def test_inputs_that_are_missing_are_named(self):
        """Fault: a start that found all blobs but one missing said how many. Relatives: bytes of another size, and bytes
        that are found missing while the daemon runs."""
        with Store() as d:
            d.start()
            sky, mesh = hdr_bytes(), b"a mesh"
            named = {"model": (d.hair, "hero/hair"), "environment": (d.put(sky), "dusk"), "mesh": (d.put(mesh), "head")}
            for kind, (digest, name) in named.items():
                for path in ("an/older/name", name):
                    self.assertEqual(d.ask("PUT", f"/v1/names/{kind}/{path}", {"sha256": digest}).status, 200)
            unnamed = d.put(hair_bytes(seed=7))
            self.assertEqual(d.ask("POST", "/v1/models", {"sha256": unnamed}).status, 201)
            result = d.ask("GET", f"/v1/bakes/{d.bake}").json["files"][1]["sha256"]
            d.stop()
            kept = next(digest for digest in d.data if digest != d.hair)
            for digest in [f.name for f in (d.store / "blobs").rglob("*") if f.is_file() and f.name != kept]:
                if digest == unnamed:
                    d.blob_file(digest).write_bytes(b"cut")
                else:
                    d.blob_file(digest).unlink()
            (d.path / "log").write_text("")
            d.start()
            lost = [digest for digest in (*d.data, *(digest for digest, _ in named.values()), unnamed) if digest != kept]
            d.wait_for_log(f"{len(set(lost))} inputs are missing or spoiled. They are forgotten and must be sent again:")
            for kind, (digest, name) in named.items():
                self.assertIn(f"send the {kind} {name}@1 (sha256:{digest}) again", d.log)
            self.assertIn(f"send the model sha256:{unnamed} again", d.log)
            for digest in set(d.data) - {d.hair, kept}:
                self.assertIn(f"send the file sha256:{digest} again", d.log)
            for digest in (kept, result):
                self.assertNotIn(digest, d.log)
            self.assertRegex(d.log, "[0-9]+ stored results are missing or spoiled")
            self.assertEqual(d.ask("GET", f"/v1/blobs/{kept}").body, d.data[kept])
            self.assertEqual(d.put(mesh), named["mesh"][0])
            d.blob_file(named["mesh"][0]).unlink()
            reply = d.ask("GET", f"/v1/blobs/{named['mesh'][0]}")
            self.assertEqual(reply.status, 404)
            self.assertIn(f"send the mesh head@1 (sha256:{named['mesh'][0]}) again", reply.json["detail"])
            d.wait_for_log(reply.json["detail"])

    def test_a_database_that_is_refused_gets_no_log_beside_it(self):
        """Fault: reading a database left an empty -wal and a -shm beside it. Relatives: each reason that is found by reading."""
        def of_another_program(d):
            d.database.unlink()
            d.sql("PRAGMA journal_mode = WAL")
            d.sql("CREATE TABLE notes(text)")

        def newer(d):
            d.sql("PRAGMA user_version = 1000")

        def without_row(d):
            d.sql("DELETE FROM store")

        def of_another_store(d):
            d.sql("UPDATE store SET id = '" + 32 * "0" + "'")

        def older(d):
            d.sql("UPDATE store SET generation = 1")

        def without_blobs(d):
            shutil.rmtree(d.store / "blobs")

        for spoil in (of_another_program, newer, without_row, of_another_store, older, without_blobs):
            with self.subTest(spoil.__name__), Store() as d:
                spoil(d)
                before = d.database.read_bytes()
                self.assertEqual(sorted(f.name for f in d.store.glob("hairbake.db*")), ["hairbake.db"])
                for _ in range(2):
                    d.refused()
                    self.assertEqual(sorted(f.name for f in d.store.glob("hairbake.db*")), ["hairbake.db"])
                    self.assertEqual(d.database.read_bytes(), before)

    def test_a_refused_database_keeps_the_log_that_it_had(self):
        with Store() as d:
            connection = sqlite3.connect(d.database)
            connection.execute("PRAGMA user_version = 1000")
            connection.commit()
            shutil.copytree(d.store, d.path / "copy")  # with the log, which closing would write into the database
            connection.close()
            shutil.rmtree(d.store)
            (d.path / "copy").rename(d.store)
            before = {end: d.store.joinpath(f"hairbake.db{end}").read_bytes() for end in ("", "-wal")}
            self.assertGreater(len(before["-wal"]), 0)
            self.assertIn("1000", d.refused())
            self.assertEqual({end: d.store.joinpath(f"hairbake.db{end}").read_bytes() for end in before}, before)

    def test_a_part_on_another_device_stops_the_start(self):
        for part in ("blobs", "tmp", "uploads", "blobs/ab", "lost+found"):
            with self.subTest(part), Store() as d:
                (d.store / part).mkdir(exist_ok=True)
                d.before = ["unshare", "--map-root-user", "--mount", "sh", "-c", 'mount -t tmpfs none "$0" && exec "$@"',
                            d.store / part]
                self.assert_stops(d, f"{d.store / part} is on another device", "mount the whole folder")
                d.before = []
                d.start()
                self.assert_serves_all(d)

    def test_a_database_on_another_device_stops_the_start(self):
        with Store() as d, tempfile.TemporaryDirectory(dir="/dev/shm") as elsewhere:
            if os.stat(elsewhere).st_dev == os.stat(d.store).st_dev:
                self.skipTest("/dev/shm is on the device of the store")
            moved = Path(elsewhere) / "hairbake.db"
            shutil.move(d.database, moved)
            d.database.symlink_to(moved)
            self.assert_stops(d, f"{elsewhere} is on another device")

    def test_a_second_daemon_stops_although_the_lock_file_was_deleted(self):
        for deleted in (False, True):
            with self.subTest(deleted=deleted), Daemon() as d:
                if deleted:
                    (d.path / "store/lock").unlink()
                self.assertEqual(end_of(d.spawn()), 2)
                self.assertIn("another hairbaked works on the store", (d.path / "log").read_text())


if __name__ == "__main__":
    unittest.main()
