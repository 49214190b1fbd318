"""Starts of a store with another database than its own: no file is removed."""
import contextlib
import os
import random
import shutil
import sqlite3
import subprocess
import time
import unittest
from pathlib import Path

from harness import Daemon, sha256
from stores import Store, StoreTest, files_below


class OtherDatabase(StoreTest):
    """Fault: a start with another database removed every blob that it did not know."""

    def test_a_start_without_the_database_stops_and_its_return_heals(self):
        def empty_file(d):
            d.database.write_bytes(b"")

        def empty_database(d):
            with contextlib.closing(sqlite3.connect(d.database)) as made:
                made.execute("VACUUM")  # a valid file without tables
            self.assertGreater(d.database.stat().st_size, 0)

        for name, put_there in {"put aside": lambda d: None, "an empty file": empty_file, "no tables": empty_database}.items():
            for with_id in (True, False):  # a store of an earlier version has no id
                with self.subTest(name, with_id=with_id), Store() as d:
                    kept, mark = d.path / "aside", d.path / "mark"
                    d.database.rename(kept)
                    if not with_id:
                        (d.store / "store-id").rename(mark)
                    put_there(d)
                    self.assert_stops(d, "is missing or empty", f"{len(d.files) - 1} files in blobs and 1 in uploads",
                                      "hairbaked store accept")
                    self.assertRaises(subprocess.CalledProcessError, d.accept)  # that needs a database
                    self.assertEqual(files_below(d.store), d.files)
                    kept.rename(d.database)
                    if not with_id:
                        mark.rename(d.store / "store-id")
                    d.start()
                    self.assert_serves_all(d)

    def test_a_database_of_which_only_the_log_is_left_stops_the_start_and_the_log_stays(self):
        for empty in (False, True):
            with self.subTest(empty=empty), Store() as d:
                d.start()
                data = os.urandom(100)
                d.data[d.put(data)] = data  # in the log alone
                d.kill()
                log, kept = d.store / "hairbake.db-wal", d.path / "aside"
                whole = log.read_bytes()
                self.assertGreater(len(whole), 0)
                d.database.rename(kept)
                if empty:
                    d.database.write_bytes(b"")
                found = "is empty" if empty else "is missing"
                self.assert_stops(d, found, "hairbake.db-wal", "Put the database back beside it")
                self.assertEqual(log.read_bytes(), whole)
                kept.rename(d.database)
                d.start()
                self.assert_serves_all(d)

    def test_a_database_without_its_log_is_an_older_one(self):
        with Store() as d:
            d.start()
            data = os.urandom(100)
            digest = d.put(data)
            d.kill()
            log = d.store / "hairbake.db-wal"
            self.assertGreater(log.stat().st_size, 0)
            log.rename(d.path / "aside")
            self.assert_stops(d, "older than the store", "with its -wal")
            (d.path / "aside").rename(log)
            d.start()
            self.assertEqual(d.ask("GET", f"/v1/blobs/{digest}").body, data)

    def test_an_older_copy_stops_the_start_and_after_accept_unknown_files_are_in_lost_and_found(self):
        with Store() as d:
            copy = d.path / "copy"
            shutil.copy(d.database, copy)
            known = dict(d.data)
            late = [os.urandom(500 + n) for n in range(3)]
            for data in late:
                d.add(data)
            shutil.copy(copy, d.database)
            self.assert_stops(d, "older than the store", "hairbaked store accept", "lost+found")
            self.assert_stops(d, "older than the store")  # a refused start does not make the next one succeed
            d.accept()
            (d.path / "log").write_text("")
            d.start()
            self.assertEqual(d.lost_and_found(), {sha256(data): data for data in late})
            self.assertIn(f"moved 3 files of {sum(map(len, late))} bytes to {d.store}/lost+found/", d.log)
            self.assertNotIn("removed", d.log.replace("Nothing was changed or removed", ""))
            d.data = known
            self.assert_serves_all(d)
            d.stop()
            d.start()  # lost+found itself stays
            self.assertEqual(len(d.lost_and_found()), 3)

    def test_a_copy_made_while_the_daemon_ran_is_older_after_its_stop(self):
        with Store() as d:
            d.start()
            copy = d.path / "copy"
            with contextlib.closing(sqlite3.connect(d.database)) as source, contextlib.closing(sqlite3.connect(copy)) as to:
                source.backup(to)
            data = os.urandom(700)
            digest = d.put(data)
            d.stop()
            shutil.copy(copy, d.database)
            self.assert_stops(d, "older than the store")
            self.assertEqual(d.blob_file(digest).read_bytes(), data)

    def test_a_copy_that_is_too_young_to_be_told_moves_unknown_files_and_removes_none(self):
        """A copy of the running generation, put back after a kill: blobs and uploads go to lost+found."""
        with Store() as d:
            d.start()
            copy = d.path / "copy"
            with contextlib.closing(sqlite3.connect(d.database)) as source, contextlib.closing(sqlite3.connect(copy)) as to:
                source.backup(to)
            late = os.urandom(700)
            d.put(late)
            upload, empty = (d.create_upload(b"a late upload").headers["Location"].rsplit("/", 1)[1] for _ in range(2))
            self.assertEqual(d.append(f"/v1/uploads/{upload}", 0, b"a late").status, 204)
            d.kill()
            for end in ("-wal", "-shm"):
                Path(f"{d.database}{end}").unlink()
            shutil.copy(copy, d.database)
            d.start()
            self.assertEqual(d.lost_and_found(), {sha256(late): late, upload: b"a late"})
            self.assertFalse((d.store / "uploads" / empty).exists())
            self.assertIn("removed 1 files of 0 bytes: empty uploads that the database does not know", d.log)
            self.assert_serves_all(d)

    def test_the_database_of_another_store_stops_the_start_of_both(self):
        with Store() as one, Store() as other:
            kept = one.path / "aside"
            one.database.rename(kept)
            other.database.rename(one.database)
            kept.rename(other.database)
            for d in (one, other):
                self.assert_stops(d, one.id, other.id, "folder of its own store")

    def test_a_database_of_the_version_without_id_is_older_than_a_store_with_one(self):
        with Store() as d:
            d.sql("PRAGMA user_version = 5")
            before = d.database.read_bytes()
            self.assert_stops(d, "older than the store", "version 5")
            self.assertEqual(d.database.read_bytes(), before)

    def test_the_database_of_another_program_stops_the_start_and_is_not_changed(self):
        with Store() as d:
            d.database.unlink()
            d.sql("CREATE TABLE somebody(x)")
            before = d.database.read_bytes()
            self.assertIn("another program", d.refused())
            self.assertEqual((d.database.read_bytes(), files_below(d.store)), (before, d.files))

    def test_a_crash_between_database_and_file_is_told_from_an_old_folder(self):
        for ahead, starts in ((0, True), (1, True), (2, False)):
            with self.subTest(ahead=ahead), Store() as d:
                d.sql(f"UPDATE store SET generation = {d.generation + ahead}")
                if starts:
                    d.start()
                    self.assert_serves_all(d)
                else:
                    self.assert_stops(d, "older than its database", "Put the newer folder back")

    def test_a_folder_without_its_id_stops_the_start(self):
        with Store() as d:
            for spoil in (lambda mark: mark.unlink(), lambda mark: mark.write_text("id\n")):
                spoil(d.store / "store-id")
                self.assert_stops(d, "store-id", "hairbaked store accept")
                d.accept()
                d.start()
                self.assert_serves_all(d)
                d.stop()


    def test_the_advice_for_a_broken_database_loses_nothing(self):
        with Store() as d:
            copy = d.path / "copy"
            shutil.copy(d.database, copy)
            late = os.urandom(900)
            d.add(late)
            d.database.write_bytes(b"broken" * 1000)
            log = d.refused()
            self.assertIn("restore a copy and run `hairbaked store accept --config FILE`", log)
            self.assertEqual({name: data for name, data in files_below(d.store).items() if name in d.files}, d.files)
            d.database.rename(d.path / "broken")
            shutil.copy(copy, d.database)
            d.accept()
            d.start()
            self.assertEqual(d.lost_and_found(), {sha256(late): late})
            del d.data[sha256(late)]
            self.assert_serves_all(d)

    def test_a_deleted_database_can_be_saved_while_the_daemon_runs(self):
        """The commands of docs/deployment.md."""
        with Store() as d:
            d.start()
            data = os.urandom(700)
            d.data[d.put(data)] = data
            for end in ("", "-wal", "-shm"):
                Path(f"{d.database}{end}").unlink()
            self.assertEqual(d.ask("GET", "/readyz").status, 503)
            opened = {os.readlink(file): file for file in Path(f"/proc/{d.process.pid}/fd").iterdir()}
            for end in ("", "-wal"):
                shutil.copy(opened[f"{d.database}{end} (deleted)"], d.path / f"saved{end}")
            self.assertEqual(d.stop()[0], 0)
            for end in ("", "-wal"):
                (d.path / f"saved{end}").rename(f"{d.database}{end}")
            d.start()
            self.assert_serves_all(d)

    def test_a_first_start_that_is_killed_can_be_repeated(self):
        """Relative: a folder that holds a part of a new store is no folder of somebody else."""
        rng = random.Random(7)
        with Daemon() as d:
            d.stop()
            for _ in range(20):
                shutil.rmtree(d.path / "store")
                process = d.spawn()
                time.sleep(rng.uniform(0, 0.15))
                process.kill()
                process.wait()
                process.stdout.close()
                d.start()
                self.assertEqual(d.ask("GET", f"/v1/blobs/{d.put(b'data')}").body, b"data")
                d.stop()


if __name__ == "__main__":
    unittest.main()
