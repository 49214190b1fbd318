"""Stores of earlier database versions: the daemon opens them, brings them to its version and serves what they hold."""
import contextlib
import json
import sqlite3
import tarfile
import unittest
from pathlib import Path

from harness import PATIENCE, TUS, Daemon, hair_bytes, hdr_bytes, sha256

DATA = Path(__file__).parent / "data"

# Statements that turn a database of each version into the one before: version 1 did not know who began an upload, version 2 knew
# only the latest name that a bake was asked by, version 3 did not know the age of the bakes of a name and of a batch.
BACK_TO_3 = """DROP INDEX batch_bakes_by_age; ALTER TABLE batch_bakes DROP COLUMN seq; DROP INDEX bake_names_by_path;
    ALTER TABLE bake_names DROP COLUMN seq; CREATE INDEX bake_names_by_path ON bake_names(path);
    DROP INDEX inputs_by_blob; DROP INDEX inputs_by_thumbnail;"""
BACK_TO_2 = "DROP TABLE bake_names;"
BACK_TO_1 = "ALTER TABLE uploads DROP COLUMN token;"
BACK = {4: "", 3: BACK_TO_3, 2: BACK_TO_3 + BACK_TO_2, 1: BACK_TO_3 + BACK_TO_2 + BACK_TO_1}


class OldStore(Daemon):
    """Starts on the store that data/store_4.tar.xz holds, brought back to `version`. `expected` is what its daemon answered."""

    def __init__(self, version=4):
        super().__init__(limits='program = "/bin/false"')  # nothing is baked
        with tarfile.open(DATA / "store_4.tar.xz") as archive:
            archive.extractall(self.path)  # our own archive
        self.expected = json.loads((self.path / "expected.json").read_text())
        self.run_sql(f"{BACK[version]} PRAGMA user_version = {version}")

    def run_sql(self, statements):
        with contextlib.closing(sqlite3.connect(self.path / "store/hairbake.db")) as database:
            database.executescript(statements)


class Migration(unittest.TestCase):
    maxDiff = None

    def assert_serves(self, d):
        for path, answer in d.expected["answers"].items():
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

    def test_the_requests_of_a_store_of_version_4_are_done_under_the_same_ids(self):
        with OldStore() as d:
            for name, request in d.expected["requests"].items():
                if name == "failed":
                    continue
                reply = d.ask("POST", "/v1/bakes", request)
                self.assertEqual((reply.status, reply.json["id"], reply.json["state"]),
                                 (200, d.expected["ids"][name], "done"), name)
            failed = d.ask("POST", "/v1/bakes", d.expected["requests"]["failed"])
            self.assertEqual((failed.status, failed.json["id"]), (202, d.expected["ids"]["failed"]))
            forecast = d.ask("POST", "/v1/rebakes?dry_run=1", {"bakes": [d.expected["ids"]["both"]],
                                                               "environment": d.expected["requests"]["both"]["environment"]})
            self.assertEqual(forecast.json["done_bakes"], 1, forecast.body)
            d.stop()
            self.assertNotIn("attempt 1: done", (d.path / "log").read_text())  # no worker was successful

    def test_a_store_of_each_earlier_version_is_served(self):
        for version in (3, 2, 1):
            with self.subTest(version), OldStore(version) as d:
                self.assert_serves(d)
                self.assertEqual(d.ask("GET", f"/v1/bakes?batch={d.expected['batch']['id']}").json, d.expected["batch_bakes"])
                self.assertEqual(d.create_upload(b"some hair").status, 201)

    def test_the_inputs_of_an_older_store_are_known_as_such(self):
        """They are never evicted; results and thumbnails are no inputs."""
        for version in BACK:
            with self.subTest(version), OldStore(version) as d:
                d.stop()
                with contextlib.closing(sqlite3.connect(d.path / "store/hairbake.db")) as database:
                    sent = {row[0] for row in database.execute("SELECT sha256 FROM sent_blobs")}
                    self.assertEqual(sent, {sha256(data) for data in (hair_bytes(strands=30), hdr_bytes(), hdr_bytes(red=99),
                                                                      b"no hair model")})
                    self.assertGreater(database.execute("SELECT count(*) FROM blobs").fetchone()[0], len(sent))

    def test_a_store_of_a_later_version_stops_the_start(self):
        with OldStore() as d:
            d.stop()
            d.run_sql("PRAGMA user_version = 1000")
            process = d.spawn()
            self.assertEqual(process.wait(PATIENCE), 3)
            process.stdout.close()
            self.assertIn("its version is 1000", (d.path / "log").read_text())
            d.run_sql("PRAGMA user_version = 6")
            d.start()


if __name__ == "__main__":
    unittest.main()
