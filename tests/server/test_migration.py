"""Stores of earlier database versions: the daemon opens them, brings them to its version and serves what they hold."""
import contextlib
import json
import random
import shutil
import sqlite3
import tarfile
import time
import unittest
from pathlib import Path

from harness import PATIENCE, TUS, Daemon, hair_bytes, hdr_bytes, sha256

DATA = Path(__file__).parent / "data"

# Statements that turn a database of each version into the one before: version 7 did not know the deaths of workers and the
# bakes that were removed, version 6 did not know what clients sent, version 1 did not know who began an upload, version 2 knew
# only the latest name that a bake was asked by, version 3 did not know the age of the bakes of a name and of a batch.
BACK_TO_3 = """DROP INDEX batch_bakes_by_age; ALTER TABLE batch_bakes DROP COLUMN seq; DROP INDEX bake_names_by_path;
    ALTER TABLE bake_names DROP COLUMN seq; CREATE INDEX bake_names_by_path ON bake_names(path);
    DROP INDEX inputs_by_blob; DROP INDEX inputs_by_thumbnail;"""
BACK_TO_2 = "DROP TABLE bake_names;"
BACK_TO_7 = "DROP TABLE forgotten_bakes; ALTER TABLE stages DROP COLUMN deaths; ALTER TABLE stages DROP COLUMN ends;"
BACK_TO_6 = BACK_TO_7 + "DROP TRIGGER forget_sent_blob; DROP TABLE sent_blobs; PRAGMA user_version = 6"
BACK_TO_1 = "ALTER TABLE uploads DROP COLUMN token;"
BACK = {5: "", 4: "", 3: BACK_TO_3, 2: BACK_TO_3 + BACK_TO_2, 1: BACK_TO_3 + BACK_TO_2 + BACK_TO_1}


class OldStore(Daemon):
    """Starts on the store that data/store_5.tar.xz or store_4.tar.xz holds, brought back to `version`. `expected` is what its
    daemon answered."""

    def __init__(self, version=4, limits='program = "/bin/false"'):  # nothing is baked
        super().__init__(limits=limits)
        with tarfile.open(DATA / f"store_{max(version, 4)}.tar.xz") as archive:
            archive.extractall(self.path)  # our own archive
        self.expected = json.loads((self.path / "expected.json").read_text())
        self.run_sql(f"{BACK[version]} PRAGMA user_version = {version}")

    def run_sql(self, statements):
        with contextlib.closing(sqlite3.connect(self.path / "store/hairbake.db")) as database:
            database.executescript(statements)


class Migration(unittest.TestCase):
    maxDiff = None

    def assert_serves(self, d, only=""):
        """All that its daemon served, or the addresses that begin with `only`."""
        for path, answer in d.expected["answers"].items():
            if path.startswith(only):
                self.assertEqual(d.ask("GET", path).json, answer, path)
        for href, digest in d.expected["digests"].items():
            reply = d.ask("GET", href)
            self.assertEqual((reply.status, sha256(reply.body)), (200, digest), href)

    def test_a_store_of_version_4_is_served_byte_for_byte(self):
        with OldStore() as d:
            self.assert_serves(d)
            batch = d.expected["batch"]
            self.assertEqual(d.ask("GET", f"/v1/batches/{batch['id']}").json, batch)
            self.assertEqual(d.ask("GET", f"/v1/bakes?batch={batch['id']}").json, d.expected["batch_bakes"])
            upload = d.expected["upload"]
            data = upload["data"].encode()
            self.assertEqual(d.ask("HEAD", upload["path"], headers=TUS).headers["Upload-Offset"], str(upload["offset"]))
            self.assertEqual(d.append(upload["path"], upload["offset"], data[upload["offset"]:]).status, 204)
            self.assertEqual(d.ask("GET", f"/v1/blobs/{sha256(data)}").body, data)

    def test_a_request_of_a_store_of_version_4_is_planned_anew_and_the_old_result_stays(self):
        """The algorithm versions of both stages are higher than then (CHANGELOG.md), so a request has another id.

        Relatives: both stages, each alone, a request by names, a failed one, and a re-bake of an old bake.
        """
        with OldStore(limits="") as d:
            requests, old_ids = d.expected["requests"], d.expected["ids"]
            rebake = {"bakes": [old_ids["both"]], "environment": requests["both"]["environment"]}
            forecast = d.ask("POST", "/v1/rebakes?dry_run=1", rebake).json
            self.assertEqual((forecast["bakes"], forecast["done_bakes"]), (1, 0))
            for name, request in requests.items():
                with self.subTest(name):
                    reply = d.ask("POST", "/v1/bakes", request)
                    self.assertEqual(reply.status, 202, reply.body)
                    new = reply.json["id"]
                    self.assertNotEqual(new, old_ids[name])
                    end = "failed" if name == "failed" else "done"
                    self.assertEqual(d.wait(new)["state"], end)
                    again = d.ask("POST", "/v1/bakes", request)
                    self.assertEqual((again.status, again.json["id"]), (202 if name == "failed" else 200, new))
            batch = d.ask("POST", "/v1/rebakes", rebake).json["id"]  # with the old bake's values of all fields
            (bake,) = d.ask("GET", f"/v1/bakes?batch={batch}").json["bakes"]
            self.assertEqual(d.wait(bake["id"])["state"], "done")
            self.assertNotEqual(bake["id"], old_ids["both"])
            self.assertEqual(d.ask("POST", "/v1/rebakes?dry_run=1", rebake).json["done_bakes"], 1)
            self.assert_serves(d, only="/v1/bakes/")

    def test_a_store_of_each_earlier_version_is_served(self):
        for version in (3, 2, 1):
            with self.subTest(version), OldStore(version) as d:
                self.assert_serves(d)
                self.assertEqual(d.ask("GET", f"/v1/bakes?batch={d.expected['batch']['id']}").json, d.expected["batch_bakes"])
                self.assertEqual(d.create_upload(b"some hair").status, 201)

    def test_a_store_of_version_5_gets_an_id_at_its_first_start(self):
        with OldStore(5) as d:
            self.assert_serves(d)
            words = (d.path / "store/store-id").read_text().split()
            self.assertRegex(words[1], "^[0-9a-f]{32}$")
            for _ in range(2):
                d.stop()
                with contextlib.closing(sqlite3.connect(d.path / "store/hairbake.db")) as database:
                    self.assertEqual(database.execute("SELECT id FROM store").fetchall(), [(words[1],)])
                d.start()
                self.assert_serves(d)
            self.assertFalse((d.path / "store/lost+found").exists())

    def test_a_start_between_the_upgrade_and_the_id_is_repeated(self):
        """Relative: a kill after the database was upgraded, before the file with the id was written."""
        with OldStore(5) as d:
            d.stop()
            (d.path / "store/store-id").unlink()
            d.run_sql("UPDATE store SET generation = 0")
            d.run_sql("PRAGMA application_id = 0")
            d.start()
            self.assert_serves(d)

    def test_a_first_start_that_is_killed_can_be_repeated(self):
        rng = random.Random(5)
        with OldStore(5) as d:
            d.stop()
            for _ in range(10):
                shutil.rmtree(d.path / "store")
                with tarfile.open(DATA / "store_5.tar.xz") as archive:
                    archive.extractall(d.path)
                process = d.spawn()
                time.sleep(rng.uniform(0, 0.15))
                process.kill()
                process.wait()
                process.stdout.close()
                d.start()
                d.stop()
                self.assertFalse((d.path / "store/lost+found").exists())
            d.start()
            self.assert_serves(d)

    def test_files_that_a_killed_daemon_of_version_5_left_are_not_removed(self):
        with OldStore(5) as d:
            d.stop()
            shutil.rmtree(d.path / "store")
            with tarfile.open(DATA / "store_5.tar.xz") as archive:
                archive.extractall(d.path)
            blob, upload = "ab" + 62 * "0", 32 * "c"
            d.blob_file(blob).write_bytes(b"without a row")
            (d.path / "store/uploads" / upload).write_bytes(b"without a row, too")
            d.start()
            self.assert_serves(d)
            found = {file.name: file.read_bytes() for file in (d.path / "store/lost+found").rglob("*") if file.is_file()}
            self.assertEqual(found, {blob: b"without a row", upload: b"without a row, too"})

    SENT = {sha256(data) for data in (hair_bytes(strands=30), hdr_bytes(), hdr_bytes(red=99), b"no hair model")}

    def assert_knows_its_inputs(self, d):
        with contextlib.closing(sqlite3.connect(d.path / "store/hairbake.db")) as database:
            self.assertEqual({row[0] for row in database.execute("SELECT sha256 FROM sent_blobs")}, self.SENT)
            self.assertGreater(database.execute("SELECT count(*) FROM blobs").fetchone()[0], len(self.SENT))
            self.assertEqual(database.execute("PRAGMA user_version").fetchone()[0], 8)

    def test_the_inputs_of_an_older_store_are_known_as_such(self):
        """They are never evicted; results and thumbnails are no inputs."""
        for version in BACK:
            with self.subTest(version), OldStore(version) as d:
                d.stop()
                self.assert_knows_its_inputs(d)

    def test_a_store_of_version_6_is_served_and_knows_its_inputs(self):
        with OldStore(5) as d:
            words = (d.path / "store/store-id").read_text()
            for _ in range(2):
                d.stop()
                d.run_sql(BACK_TO_6)
                d.start()
                self.assert_serves(d)
                self.assert_knows_its_inputs(d)
                self.assertEqual((d.path / "store/store-id").read_text().split()[1], words.split()[1])

    def test_a_store_of_version_7_is_served_and_its_deaths_begin_anew(self):
        with OldStore(5, limits="") as d:
            request = d.expected["requests"]["both"]
            d.stop()
            d.run_sql(BACK_TO_7 + "UPDATE stages SET crashes = 5; PRAGMA user_version = 7")
            d.start()
            self.assert_serves(d)
            self.assertEqual(d.wait(d.ask("POST", "/v1/bakes", request).json["id"])["state"], "done")
            self.assertEqual(d.ask("GET", f"/v1/bakes/{'0' * 64}").status, 404)

    def test_bytes_of_an_older_store_that_are_neither_result_nor_thumbnail_count_as_sent(self):
        """Nobody can tell whether a client sent them. Those of a store of this version are told apart: see test_room."""
        with OldStore(5) as d:
            loose = d.put(b"loose")
            d.stop()
            d.run_sql(BACK_TO_6)
            d.start()
            with contextlib.closing(sqlite3.connect(d.path / "store/hairbake.db")) as database:
                self.assertEqual({row[0] for row in database.execute("SELECT sha256 FROM sent_blobs")}, self.SENT | {loose})

    def test_a_store_of_a_later_version_stops_the_start(self):
        with OldStore() as d:
            d.stop()
            d.run_sql("PRAGMA user_version = 1000")
            process = d.spawn()
            self.assertEqual(process.wait(PATIENCE), 3)
            process.stdout.close()
            self.assertIn("its version is 1000", (d.path / "log").read_text())
            d.run_sql("PRAGMA user_version = 8")
            d.start()


if __name__ == "__main__":
    unittest.main()
