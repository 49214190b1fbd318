"""Older copies of the database that are put beside the log of a newer one, or over the open file."""
import contextlib
import os
import shutil
import sqlite3
import subprocess
import unittest
from pathlib import Path

from harness import Daemon, hair_bytes, quick_request, sha256
from stores import Store, StoreTest, files_below


class OlderCopyBesideTheLog(StoreTest):
    """Fault: an older copy of hairbake.db beside the -wal of the newer one started, and acknowledged inputs went to
    lost+found: the generation was read through the -wal."""

    def aged(self, d):
        """An older copy; since then, 20 inputs and names came, the daemon was stopped, and a last input came before a kill."""
        older = d.path / "older.db"
        shutil.copy(d.database, older)
        d.start()
        for n in range(20):
            data = os.urandom(400 + n)
            d.data[d.put(data)] = data
            self.assertEqual(d.ask("PUT", f"/v1/names/model/k{n}", {"sha256": sha256(data)}).status, 200)
        d.stop()
        d.start()
        data = os.urandom(900)
        d.data[d.put(data)] = data
        d.kill()
        self.assertGreater((d.store / "hairbake.db-wal").stat().st_size, 0)
        return older

    def test_the_start_stops_and_the_newer_database_heals(self):
        with Store() as d:
            older, newest = self.aged(d), d.path / "newest"
            shutil.copy(d.database, newest)
            log = (d.store / "hairbake.db-wal").read_bytes()
            shutil.copy(older, d.database)
            for _ in range(2):
                self.assert_stops(d, "is older than the store", "that of a newer one", "move that -wal and its -shm away")
            self.assertRaises(subprocess.CalledProcessError, d.accept)  # relative: accept would mix both
            self.assertEqual((d.store / "hairbake.db-wal").read_bytes(), log)
            self.assertEqual(d.database.read_bytes(), older.read_bytes())
            shutil.copy(newest, d.database)
            d.start()
            self.assert_serves_all(d)
            self.assertEqual(d.lost_and_found(), {})

    def test_relative_the_true_database_and_log_of_a_killed_daemon_start(self):
        with Store() as d:
            self.aged(d)
            for _ in range(3):
                d.start()
                self.assert_serves_all(d)
                d.kill()
            d.start()
            self.assertEqual(d.lost_and_found(), {})

    def test_the_advice_to_work_with_the_older_copy_works(self):
        with Store() as d:
            known = dict(d.data)
            shutil.copy(self.aged(d), d.database)
            for end in ("-wal", "-shm"):
                Path(f"{d.database}{end}").rename(d.path / f"aside{end}")
            d.accept()
            d.start()
            late = {digest: data for digest, data in d.data.items() if digest not in known}
            self.assertEqual(d.lost_and_found(), late)
            d.data = known
            self.assert_serves_all(d)

    def test_relative_a_copy_that_is_renamed_over_the_open_database(self):
        with Store() as d:
            older = d.path / "older.db"
            shutil.copy(d.database, older)
            late = os.urandom(800)
            d.add(late)
            d.start()
            d.data[d.put(b"last")] = b"last"
            older.rename(d.database)
            self.assertEqual(d.ask("GET", "/readyz").status, 503)
            d.stop()
            self.assert_stops(d, "is older than the store")

    def test_relative_a_log_of_an_earlier_time_beside_the_newest_database(self):
        with Store() as d:
            d.start()
            d.put(b"early")
            d.kill()
            shutil.copy(d.store / "hairbake.db-wal", d.path / "early-wal")
            for data in (b"one", b"two"):
                d.add(data)
            shutil.copy(d.path / "early-wal", d.store / "hairbake.db-wal")
            self.assert_stops(d, "the log", "is older than the database beside it", "move this one away")
            (d.store / "hairbake.db-wal").unlink()
            d.start()
            self.assert_serves_all(d)

    def test_relative_a_copy_made_before_a_long_log_was_written_into_the_database(self):
        """Within one run: more than 1000 pages make a checkpoint, and with it a new generation."""
        with Store() as d:
            d.start()
            shutil.copy(d.database, d.path / "older.db")
            before = d.generation
            for n in range(2000):
                if d.generation > before + 1:
                    break
                data = os.urandom(50)
                d.data[d.put(data)] = data
            self.assertGreater(d.generation, before + 1, "no checkpoint came")
            d.kill()
            shutil.copy(d.database, d.path / "newest")
            shutil.copy(d.path / "older.db", d.database)
            self.assert_stops(d, "is older than the store")
            shutil.copy(d.path / "newest", d.database)
            d.start()
            self.assert_serves_all(d)


class Overwritten(unittest.TestCase):
    """Fault: `cp older.db hairbake.db` over the open file: /readyz said 200 and writes were acknowledged."""

    def spoils(self, older):
        def shortened(path, bytes_left):
            return lambda store: os.truncate(store / path, bytes_left)

        def damaged(path, at):
            def write(store):
                with open(store / path, "r+b") as file:
                    file.seek(at)
                    file.write(bytes([255]) * 64)
            return write

        return {"an older copy": lambda store: (store / "hairbake.db").write_bytes(older),
                "cut to nothing": shortened("hairbake.db", 0),
                "cut by a page": lambda store: os.truncate(store / "hairbake.db", (store / "hairbake.db").stat().st_size - 4096),
                "no database": damaged("hairbake.db", 0),
                "the log cut to nothing": shortened("hairbake.db-wal", 0),
                "the log cut": shortened("hairbake.db-wal", 4096),
                "the head of another log": damaged("hairbake.db-wal", 0)}

    def test_readyz_and_writes_refuse_at_once_and_the_bytes_put_back_heal(self):
        with Daemon() as d:
            kept = d.put(b"kept")
            d.stop()
            store = d.path / "store"
            older = (store / "hairbake.db").read_bytes()
            d.start()
            d.put(b"more")
            d.stop()
            d.start()
            d.put(b"in the log")
            for name, spoil in self.spoils(older).items():
                with self.subTest(name):
                    self.assertEqual(d.ask("GET", "/readyz").status, 200)
                    whole = {end: (store / f"hairbake.db{end}").read_bytes() for end in ("", "-wal")}
                    spoil(store)
                    replies = {"readyz": d.ask("GET", "/readyz"), "PUT": d.ask("PUT", f"/v1/blobs/{sha256(b'x')}", b"x"),
                               "name": d.ask("PUT", "/v1/names/model/x", {"sha256": kept}),
                               "DELETE": d.ask("DELETE", f"/v1/blobs/{kept}")}
                    for end, data in whole.items():  # in place
                        with open(store / f"hairbake.db{end}", "r+b") as file:
                            file.write(data)
                    for request, reply in replies.items():
                        self.assertEqual(reply.status, 503, (request, reply.body))
                        self.assertIn("was overwritten or cut by another program", reply.json["detail"], request)
                        self.assertIn(str(store / "hairbake.db"), reply.json["detail"], request)
            self.assertEqual(d.ask("GET", "/readyz").status, 200)
            late = d.put(b"late")
            d.stop()
            d.start()
            for digest in (kept, late):
                self.assertEqual(d.ask("GET", f"/v1/blobs/{digest}").status, 200)

    def test_a_checkpoint_of_another_program_is_no_fault(self):
        with Daemon() as d:
            for n in range(3):
                d.put(b"data %d" % n)
                with contextlib.closing(sqlite3.connect(d.path / "store/hairbake.db")) as other:
                    other.execute("PRAGMA wal_checkpoint(TRUNCATE)")
                self.assertEqual(d.ask("GET", "/readyz").status, 200)
            self.assertEqual(d.ask("GET", f"/v1/blobs/{d.put(b'after')}").status, 200)

    def test_an_overwritten_database_is_told_at_the_next_start(self):
        with Store() as d:
            older = d.database.read_bytes()
            d.add(os.urandom(500))
            d.start()
            d.put(b"last")
            d.database.write_bytes(older)
            d.stop()
            files = files_below(d.store)
            self.assertIn("is older than the store", d.refused())
            self.assertEqual(files_below(d.store), files)


class Spoiled(unittest.TestCase):
    """Fault: a broken page that a request met was 500, and /readyz named neither file nor remedy."""

    def test_requests_are_503_and_readyz_names_the_file_and_the_remedy(self):
        with Daemon() as d:
            hair = d.put(hair_bytes())
            self.assertEqual(d.ask("PUT", "/v1/names/model/x", {"sha256": hair}).status, 200)
            bake = d.ask("POST", "/v1/bakes", quick_request(hair)).json["id"]
            self.assertEqual(d.wait(bake)["state"], "done")
            d.stop()
            database = d.path / "store/hairbake.db"
            d.start()
            with contextlib.closing(sqlite3.connect(database)) as other:
                other.execute("PRAGMA wal_checkpoint(TRUNCATE)")
            with open(database, "r+b") as file:  # all pages but the first
                file.seek(4096)
                file.write(os.urandom(database.stat().st_size - 4096))
            for reply in (d.ask("GET", "/v1/bakes?limit=50"), d.ask("GET", f"/v1/bakes/{bake}"), d.ask("GET", "/readyz"),
                          d.ask("PUT", f"/v1/blobs/{sha256(b'x')}", b"x")):
                self.assertEqual(reply.status, 503, reply.body)
                self.assertIn(f"the database {database} is spoiled", reply.json["detail"])
                self.assertIn("restore a copy and run `hairbaked store accept", reply.json["detail"])


if __name__ == "__main__":
    unittest.main()
