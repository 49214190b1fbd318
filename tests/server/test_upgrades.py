"""An upgrade with a queue: stages of another algorithm version are planned again, and their bakes keep their ids.

A program of another version is not at hand. So the tests write rows as it would have left them: with other keys and ids.
"""
import contextlib
import sqlite3
import unittest

from harness import hair_bytes, hdr_bytes, quick_request, sha256
from test_troubles import Queue

ID_COLUMNS = {"bakes": "id", "bake_names": "bake", "batch_bakes": "bake"}
KEY_COLUMNS = {"stages": "key", "stage_inputs": "stage", "stage_files": "stage", "bake_stages": "stage"}


def of_other_version(key):
    return sha256(b"another version" + key.encode())


def queries(daemon, *statements):
    """The rows of the last statement."""
    with contextlib.closing(sqlite3.connect(daemon.path / "store/hairbake.db")) as database, database:
        for statement in statements:
            rows = database.execute(statement).fetchall()
        return rows


def become_other_version(daemon, where="1"):
    """The daemon is stopped. Its stages get the keys of another algorithm version, and its bakes the ids that follow; `where`
    chooses the bakes. The workers' manifests, which name the core's key, are only read for done stages."""
    with contextlib.closing(sqlite3.connect(daemon.path / "store/hairbake.db")) as database, database:
        database.create_function("other", 1, of_other_version)
        bakes = f"(SELECT seq FROM bakes WHERE {where})"
        database.execute(f"CREATE TEMP TABLE old AS SELECT DISTINCT stage FROM bake_stages WHERE bake IN {bakes}")
        database.execute(f"CREATE TEMP TABLE old_ids AS SELECT id FROM bakes WHERE {where}")
        database.execute("UPDATE stages SET core_key = other(core_key) WHERE key IN (SELECT stage FROM old)")
        for table, column in KEY_COLUMNS.items():
            database.execute(f"UPDATE {table} SET {column} = other({column}) WHERE {column} IN (SELECT stage FROM old)")
        for table, column in ID_COLUMNS.items():
            database.execute(f"UPDATE {table} SET {column} = other({column}) WHERE {column} IN (SELECT id FROM old_ids)")


class Upgrades(unittest.TestCase):
    def files_of(self, d, bake):
        """Name -> bytes of the files of a done bake, checked against their digests."""
        files = {}
        for file in d.ask("GET", f"/v1/bakes/{bake}").json["files"]:
            files[file["name"]] = d.ask("GET", file["href"]).body
            if "sha256" in file:
                self.assertEqual(sha256(files[file["name"]]), file["sha256"])
        self.assertTrue(files)
        return files

    def assert_done(self, d, bake, attempts={1}):
        view = d.wait(bake)
        self.assertEqual((view["state"], view["error"]), ("done", None), view)
        self.assertLessEqual({stage["attempts"] for stage in view["stages"]}, attempts)
        return view

    def test_none_of_20_queued_bakes_fails_and_all_keep_their_ids(self):
        with Queue(max_crashes=0) as d:
            hair, sky = d.put(hair_bytes()), d.put(hdr_bytes())
            d.program.unlink()
            requests = [quick_request(hair, sky, transmittance={"seed": seed, "direction_set": "random"}) for seed in range(20)]
            ids = [d.ask("POST", "/v1/bakes", request).json["id"] for request in requests]
            d.stop()
            # As a kill leaves a stage that runs.
            queries(d, "UPDATE stages SET state = 'running', attempts = 1 WHERE seq = 1")
            become_other_version(d)
            d.heal()
            d.start()
            d.wait_for_log("queued stages of another version of hairbake were planned again")
            for new, request in zip(ids, requests):
                old = of_other_version(new)
                self.assert_done(d, old)
                again = d.ask("POST", "/v1/bakes", request)  # under the id of this version: the same stages
                self.assertEqual((again.json["id"], again.json["state"]), (new, "done"))
                old_files, new_files = self.files_of(d, old), self.files_of(d, new)
                old_files.pop("manifest.json"), new_files.pop("manifest.json")
                self.assertEqual(old_files, new_files)
            self.assertEqual(queries(d, "SELECT count(*) FROM stages WHERE attempts > 1"), [(0,)])
            self.assertEqual(queries(d, "SELECT count(*) FROM bakes WHERE state = 'failed'"), [(0,)])
            self.assertEqual(d.ask("GET", "/readyz").status, 200)

    def test_relatives_batches_names_and_rebakes_of_queued_and_of_done_bakes(self):
        with Queue(max_crashes=0) as d:
            hair, sky, dusk, dawn = d.put(hair_bytes()), *(d.put(hdr_bytes(red)) for red in (10, 20, 30))
            self.assertEqual(d.ask("PUT", "/v1/names/environment/sky", {"sha256": sky}).status, 200)
            done = d.ask("POST", "/v1/bakes", {**quick_request(hair), "environment": "name:sky"}).json["id"]
            self.assert_done(d, done)
            before = self.files_of(d, done)
            d.program.unlink()
            batch = d.ask("POST", "/v1/rebakes", {"name": "sky", "environment": f"sha256:{dusk}"}).json["id"]
            d.stop()
            become_other_version(d)
            d.heal()
            d.start()
            old = of_other_version(done)
            after = self.files_of(d, old)  # a result of another version stays readable
            before.pop("manifest.json"), after.pop("manifest.json")
            self.assertEqual(before, after)
            queued = [bake["id"] for bake in d.ask("GET", f"/v1/bakes?batch={batch}").json["bakes"]]
            self.assertEqual(len(queued), 1)
            self.assert_done(d, queued[0])
            states = d.ask("GET", f"/v1/batches/{batch}").json["states"]
            self.assertEqual((states["done"], states["failed"]), (1, 0))
            self.assertIn(old, [bake["id"] for bake in d.ask("GET", "/v1/bakes?name=sky").json["bakes"]])
            again = d.ask("POST", "/v1/rebakes", {"bakes": [old, queued[0]], "environment": f"sha256:{dawn}"})
            self.assertEqual((again.status, again.json["bakes"]), (202, 1), again.body)  # both are of the same model
            for bake in d.ask("GET", f"/v1/bakes?batch={again.json['id']}").json["bakes"]:
                self.assert_done(d, bake["id"])

    def test_relative_a_bake_with_one_stage_done_and_one_queued(self):
        """The done stage is used as it is; the queued one is made by this version."""
        with Queue(max_crashes=0) as d:
            hair, sky = d.put(hair_bytes()), d.put(hdr_bytes())
            self.assert_done(d, d.ask("POST", "/v1/bakes", quick_request(hair)).json["id"])
            d.program.unlink()
            bake = d.ask("POST", "/v1/bakes", quick_request(hair, sky)).json["id"]
            d.stop()
            become_other_version(d, f"id = '{bake}'")
            d.heal()
            d.start()
            view = self.assert_done(d, of_other_version(bake))
            self.assertEqual([stage["kind"] for stage in view["stages"]], ["transmittance", "irradiance"])
            keys = {stage["kind"]: stage["key"] for stage in view["stages"]}
            self.assertEqual(queries(d, f"SELECT attempts FROM stages WHERE key = '{keys['transmittance']}'"), [(1,)])
            self.files_of(d, view["id"])

    def test_relative_a_stage_that_this_version_has_made_is_not_made_again(self):
        with Queue(max_crashes=0) as d:
            hair = d.put(hair_bytes())
            d.program.unlink()
            bake = d.ask("POST", "/v1/bakes", quick_request(hair)).json["id"]
            d.stop()
            become_other_version(d)
            d.program.write_bytes(b"no program")
            d.program.chmod(0o755)
            d.start()  # it has been planned again
            key = d.ask("GET", f"/v1/bakes/{of_other_version(bake)}").json["stages"][0]["key"]
            new = d.ask("POST", "/v1/bakes", quick_request(hair)).json
            self.assertEqual((new["id"], new["stages"][0]["key"]), (bake, key))
            d.heal()
            self.assert_done(d, bake)
            self.assert_done(d, of_other_version(bake))
            self.assertEqual(queries(d, "SELECT count(*), sum(attempts) FROM stages WHERE state = 'done'"), [(1, 1)])

    def test_relative_a_result_of_another_version_that_was_lost_is_made_by_this_one(self):
        with Queue(max_crashes=0) as d:
            hair = d.put(hair_bytes())
            bakes = [d.ask("POST", "/v1/bakes", quick_request(hair, transmittance={"seed": seed, "direction_set": "random"})).json["id"]
                     for seed in (1, 2)]
            names = [next(f for f in self.assert_done(d, bake)["files"] if f["name"] == "transmittance.npy") for bake in bakes]
            d.stop()
            become_other_version(d)
            d.blob_file(names[0]["sha256"]).unlink()  # found at the start
            d.start()
            self.assert_done(d, of_other_version(bakes[0]))
            self.files_of(d, of_other_version(bakes[0]))
            d.blob_file(names[1]["sha256"]).unlink()  # found when it is served
            self.assertEqual(d.ask("GET", f"/v1/blobs/{names[1]['sha256']}").status, 503)
            self.assert_done(d, of_other_version(bakes[1]))
            self.files_of(d, of_other_version(bakes[1]))


if __name__ == "__main__":
    unittest.main()
