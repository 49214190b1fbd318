"""Kills, dead workers, restarts: nothing that was acknowledged is lost."""
import base64
import contextlib
import http.client
import os
import random
import signal
import sqlite3
import threading
import time
import unittest

from harness import PATIENCE, TUS, Daemon, hair_bytes, hdr_bytes, quick_request, sha256, slow_request

ROUNDS = int(os.environ.get("HAIRBAKE_KILL_ROUNDS", "10"))


class Kills(unittest.TestCase):
    def test_nothing_that_was_answered_is_lost(self):
        """kill -9 of daemon, worker or both at random moments under a stream of uploads and submissions."""
        self.bakes, self.blobs, self.uploads = set(), {}, {}  # that the daemon acknowledged
        with Daemon(workers=2) as d:
            self.kill_under_load(d)
            self.assertGreater(len(self.bakes), ROUNDS // 2)
            self.finish_uploads(d)
            unfinished = d.create_upload(b"hello").headers["Location"]
            self.assertEqual(d.append(unfinished, 0, b"he").status, 204)
            self.wait_for_all_bakes(d)
            d.kill()
            d.start()
            self.assert_everything_is_served(d)
            self.assertEqual(d.leftovers(), [])
            d.stop()
            self.assert_rows_match_files(d, unfinished.rsplit("/", 1)[1])

    def kill_under_load(self, d):
        rng, stop = random.Random(4), threading.Event()
        threads = [threading.Thread(target=self.submit_bakes, args=(d, stop, n)) for n in range(2)]
        threads.append(threading.Thread(target=self.send_uploads, args=(d, stop)))
        for thread in threads:
            thread.start()
        for _ in range(ROUNDS):
            time.sleep(rng.uniform(0.05, 1.0))
            what = rng.choice(["daemon", "worker", "both"])
            for child in d.workers_running() if what != "daemon" else []:
                try:
                    os.kill(child, signal.SIGKILL)
                except ProcessLookupError:
                    pass
            if what != "worker":
                d.kill()
                d.start()
        stop.set()
        for thread in threads:
            thread.join()

    def submit_bakes(self, d, stop, number):
        step = 0
        while not stop.is_set():
            step += 1
            data, sky = hair_bytes(seed=number * 1000 + step), hdr_bytes(red=100 + step % 50)
            try:
                for blob in (data, sky):
                    if d.ask("PUT", f"/v1/blobs/{sha256(blob)}", blob).status in (200, 201):
                        self.blobs[sha256(blob)] = blob
                reply = d.ask("POST", "/v1/bakes", quick_request(sha256(data), sha256(sky)))
                if reply.status in (200, 202):
                    self.bakes.add(reply.json["id"])
                time.sleep(0.25)  # else the queue gets too long for the test
            except (OSError, ValueError, http.client.HTTPException):
                time.sleep(0.02)  # the daemon is being killed or started

    def send_uploads(self, d, stop):
        step, upload = 0, None
        while not stop.is_set():
            try:
                if not upload:
                    step += 1
                    data = hair_bytes(seed=50_000 + step)
                    reply = d.create_upload(data)
                    if reply.status == 201:
                        upload = reply.headers["Location"]
                        self.uploads[upload] = {"data": data, "answered": 0}
                elif self.go_on(d, upload, self.uploads[upload], piece=700):
                    self.blobs[sha256(data)] = data
                    del self.uploads[upload]
                    upload = None
                time.sleep(0.02)
            except (OSError, ValueError, http.client.HTTPException):
                time.sleep(0.02)

    def finish_uploads(self, d):
        """The acknowledged bytes of an upload are there, and the rest can follow."""
        for upload, state in self.uploads.items():
            while not self.go_on(d, upload, state, piece=len(state["data"])):
                pass
            self.blobs[sha256(state["data"])] = state["data"]

    def wait_for_all_bakes(self, d):
        """The queue may be long: waits as long as it moves."""
        live = ("queued", "running")
        while left := {bake for bake in self.bakes if d.ask("GET", f"/v1/bakes/{bake}").json["state"] in live}:
            d.wait(min(left, key=lambda bake: d.ask("GET", f"/v1/bakes/{bake}").json["created"]))
        for bake in self.bakes:
            view = d.wait(bake)
            self.assertEqual(view["state"], "done", view)

    def assert_everything_is_served(self, d):
        for bake in self.bakes:
            for file in d.ask("GET", f"/v1/bakes/{bake}").json["files"][1:]:
                self.assertEqual(sha256(d.ask("GET", file["href"]).body), file["sha256"])
        for digest, data in self.blobs.items():
            self.assertEqual(d.ask("GET", f"/v1/blobs/{digest}").body, data)

    def assert_rows_match_files(self, d, unfinished):
        with sqlite3.connect(d.path / "store/hairbake.db") as database:
            self.assertEqual(database.execute("PRAGMA integrity_check").fetchall(), [("ok",)])
            rows = {r[0] for r in database.execute("SELECT sha256 FROM blobs")}
            open_uploads = {r[0] for r in database.execute("SELECT id FROM uploads")}
            sent = {r[0] for r in database.execute("SELECT sha256 FROM sent_blobs")}
            results = {r[0] for r in database.execute("SELECT sha256 FROM stage_files")}
        self.assertIn(unfinished, open_uploads)
        self.assertEqual({f.name for f in (d.path / "store/uploads").iterdir()}, open_uploads)
        files = {f.name for f in (d.path / "store/blobs").rglob("*") if f.is_file()}
        self.assertEqual(rows, files)
        self.assertLessEqual(set(self.blobs), sent)  # what was acknowledged is never evicted, and results are
        self.assertLessEqual(sent, rows)
        self.assertEqual(sent & results, set())

    def go_on(self, d, upload, state, piece):
        """Sends the next piece; True when the upload has become a blob. `state` keeps the offset that was answered last."""
        data = state["data"]
        head = d.ask("HEAD", upload, headers=TUS)
        if head.status == 404:  # the last reply was lost
            self.assertEqual(d.ask("GET", f"/v1/blobs/{sha256(data)}").body, data, f"{state['answered']} bytes were answered")
            return True
        if head.status != 200:
            return False
        offset = int(head.headers["Upload-Offset"])
        self.assertGreaterEqual(offset, state["answered"])
        reply = d.append(upload, offset, data[offset:offset + piece])
        if reply.status != 204:
            return False
        state["answered"] = int(reply.headers["Upload-Offset"])
        self.assertEqual(state["answered"], min(offset + piece, len(data)))
        return state["answered"] == len(data)


class Workers(unittest.TestCase):
    def test_a_stage_whose_worker_dies_again_and_again_fails_with_the_reason(self):
        with Daemon(max_crashes=1) as d:
            model = d.put(hair_bytes(strands=2000, points=60))
            bake = d.ask("POST", "/v1/bakes", slow_request(model)).json["id"]
            for attempt in (1, 2):
                while (stage := d.ask("GET", f"/v1/bakes/{bake}").json["stages"][0])["attempts"] < attempt or not stage.get("phase"):
                    time.sleep(0.05)  # the worker works: it is not the trial, which follows each death
                child = d.wait_for_worker()
                os.kill(child, signal.SIGKILL)
                while child in d.workers_running():
                    time.sleep(0.01)  # a killed process ends
            view = d.wait(bake)
            self.assertEqual((view["state"], view["stages"][0]["attempts"]), ("failed", 2))
            self.assertIn("Killed", view["error"]["message"])
            other = d.ask("POST", "/v1/bakes", quick_request(d.put(hair_bytes()))).json["id"]
            self.assertEqual(d.wait(other)["state"], "done")

    def test_limits_of_memory_and_time_fail_the_job_with_the_reason(self):
        for limit, word in (("memory_mb = 40", "memory"), ("cpu_s = 1", "CPU"), ("wall_s = 1", "not done after")):
            with Daemon(max_crashes=0) as d:
                d.stop()
                write = d.write_config
                d.write_config = lambda: (write(), (d.path / "hairbake.toml").write_text(
                    (d.path / "hairbake.toml").read_text().replace("[workers]\n", f"[workers]\n{limit}\n")))
                d.start()
                model = d.put(hair_bytes(strands=2000, points=60))
                view = d.wait(d.ask("POST", "/v1/bakes", slow_request(model)).json["id"])
                self.assertEqual(view["state"], "failed", limit)
                self.assertIn(word, view["error"]["message"])
                self.assertEqual(d.ask("GET", "/readyz").status, 200)


class Restarts(unittest.TestCase):
    def test_a_graceful_stop_is_quick_and_its_work_goes_on_later(self):
        with Daemon() as d:
            model = d.put(hair_bytes(strands=2000, points=60))
            bake = d.ask("POST", "/v1/bakes", slow_request(model)).json["id"]
            child = d.wait_for_worker()
            code, seconds = d.stop()
            self.assertEqual(code, 0)
            self.assertLess(seconds, 5)  # the promise of docs/architecture.md
            self.assertRaises(ProcessLookupError, os.kill, child, 0)
            d.start()
            d.wait_for_worker()  # it runs again
            self.assertEqual(d.ask("GET", f"/v1/bakes/{bake}").json["state"], "running")

    def test_one_store_has_one_daemon(self):
        with Daemon() as d:
            second = d.spawn()
            self.assertEqual(second.wait(PATIENCE), 2)
            second.stdout.close()
            self.assertIn("another hairbaked works on the store", (d.path / "log").read_text())

    def test_a_spoiled_result_is_baked_again_and_never_served(self):
        with Daemon() as d:
            bake = d.ask("POST", "/v1/bakes", quick_request(d.put(hair_bytes()))).json["id"]
            file = next(f for f in d.wait(bake)["files"] if f["name"] == "transmittance.npy")
            for spoil in (lambda p: p.write_bytes(p.read_bytes()[:-1] + b"!"), lambda p: p.unlink()):
                d.stop()
                spoil(d.path / "store/blobs" / file["sha256"][:2] / file["sha256"])
                d.start()
                reply = d.ask("GET", file["href"])
                self.assertIn(reply.status, (409, 503), reply.body)  # found at boot, or on serving
                self.assertEqual(d.wait(bake)["state"], "done")
                self.assertEqual(sha256(d.ask("GET", file["href"]).body), file["sha256"])

    def test_a_whole_upload_that_cannot_become_a_blob_at_the_start_waits_for_its_sender(self):
        with Daemon() as d:
            d.become_bound_to_modes()
            data = hair_bytes()
            upload = d.create_upload(data).headers["Location"]
            self.assertEqual(d.append(upload, 0, data[:-1]).status, 204)
            d.stop()
            file = d.path / "store/uploads" / upload.rsplit("/", 1)[1]
            with open(file, "ab") as grown:
                grown.write(data[-1:])  # the state after a kill between the last byte and the commit
            file.chmod(0)
            d.start()
            self.assertEqual(d.ask("HEAD", f"/v1/blobs/{sha256(data)}").status, 404)
            self.assertEqual(d.ask("HEAD", upload, headers=TUS).headers["Upload-Offset"], str(len(data)))
            file.chmod(0o640)
            reply = d.append(upload, len(data), b"")
            self.assertEqual((reply.status, reply.headers["Hairbake-Blob"]), (204, f"/v1/blobs/{sha256(data)}"))
            self.assertEqual(d.ask("GET", f"/v1/blobs/{sha256(data)}").body, data)

    def test_a_blob_that_was_forgotten_and_not_baked_again_is_found_at_the_next_start(self):
        """The state of the database after a kill between the two transactions."""
        with Daemon() as d:
            hair, gone = d.put(hair_bytes()), d.put(hair_bytes(seed=1))
            self.assertEqual(d.ask("POST", "/v1/models", {"sha256": gone}).status, 201)
            requests = [quick_request(model) for model in (hair, gone)]
            bakes = [d.ask("POST", "/v1/bakes", request).json["id"] for request in requests]
            files = [next(f for f in d.wait(bake)["files"] if f["name"] == "transmittance.npy") for bake in bakes]
            d.stop()
            for digest in (gone, *(file["sha256"] for file in files)):
                self.alter(d, f"DELETE FROM blobs WHERE sha256 = '{digest}'")
                d.blob_file(digest).unlink()
            d.start()
            view = d.wait(bakes[0])
            self.assertEqual((view["state"], view["stages"][0]["attempts"]), ("done", 1))  # of the new run
            self.assertEqual(sha256(d.ask("GET", files[0]["href"]).body), files[0]["sha256"])
            # The model of the other bake is lost, too: the error says so, and the facts are forgotten.
            view = d.wait(bakes[1])
            self.assertEqual((view["state"], view["error"]["kind"]), ("failed", "bad_input"), view)
            self.assertIn("send the input again", view["error"]["message"])
            with contextlib.closing(sqlite3.connect(d.path / "store/hairbake.db")) as database:
                self.assertEqual(database.execute("SELECT count(*) FROM inputs").fetchone(), (0,))
            self.assertEqual(d.put(hair_bytes(seed=1)), gone)
            self.assertEqual(d.ask("POST", "/v1/bakes", requests[1]).status, 202)
            self.assertEqual(d.wait(bakes[1])["state"], "done")

    def test_a_spoiled_input_fails_the_bake_instead_of_giving_a_wrong_result(self):
        with Daemon() as d:
            data = hair_bytes()
            digest = d.put(data)
            path = d.path / "store/blobs" / digest[:2] / digest
            path.write_bytes(data[:200] + b"\0" + data[201:])
            view = d.wait(d.ask("POST", "/v1/bakes", quick_request(digest)).json["id"])
            self.assertEqual(view["state"], "failed")
            self.assertIn("spoiled", view["error"]["message"])
            self.assertEqual(d.put(data), digest)  # sent again, it is taken again
            self.assertEqual(d.wait(d.ask("POST", "/v1/bakes", quick_request(digest)).json["id"])["state"], "done")

    @staticmethod
    def alter(daemon, statements):
        with contextlib.closing(sqlite3.connect(daemon.path / "store/hairbake.db")) as database:
            database.executescript(statements)

    def test_a_broken_database_stops_the_start_and_says_what_to_do(self):
        with Daemon() as d:
            d.stop()
            (d.path / "store/hairbake.db").write_bytes(b"not a database" * 100)
            process = d.spawn()
            self.assertEqual(process.wait(PATIENCE), 3)
            process.stdout.close()
            self.assertIn("restore a copy", (d.path / "log").read_text())
            self.assertRaises(AssertionError, d.start)
            d.process.wait(PATIENCE)
            d.process.stdout.close()


    def test_a_broken_page_of_the_database_stops_the_start_and_says_what_to_do(self):
        with Daemon() as d:
            blob = d.put(b"what is kept")
            d.stop()
            database, page = d.path / "store/hairbake.db", 4096
            self.alter(d, "VACUUM")  # no free pages, whose bytes mean nothing
            whole = database.read_bytes()
            self.assertGreater(len(whole) // page, 20)  # every table and every index has one at least
            for number in (1, len(whole) // page // 2, len(whole) // page - 1):
                begin = number * page
                broken = bytes(byte ^ 0xff for byte in whole[begin:begin + page])
                database.write_bytes(whole[:begin] + broken + whole[begin + page:])
                (d.path / "log").write_text("")
                process = d.spawn()
                self.assertEqual(process.wait(PATIENCE), 3, number)
                process.stdout.close()
                self.assertIn("restore a copy", (d.path / "log").read_text())
            database.write_bytes(whole)  # the copy
            d.start()
            self.assertEqual(d.ask("GET", f"/v1/blobs/{blob}").body, b"what is kept")


if __name__ == "__main__":
    unittest.main()
