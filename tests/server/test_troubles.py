"""A passing trouble of the machine: the queue pauses, says why, and goes on by itself. No bake fails."""
import contextlib
import http.client
import os
import resource
import shutil
import signal
import sqlite3
import subprocess
import time
import unittest

from harness import PATIENCE, PROGRAMS, Daemon, hair_bytes, hdr_bytes, quick_request, sha256, slow_request
from test_hostile import write_worker

STRANGER = 61234  # a user id that no other process has


class Queue(Daemon):
    """A daemon whose worker program the test takes away and changes."""

    def __init__(self, **more):
        super().__init__(**more)
        self.program = self.path / "worker"
        self.limits = f'program = "{self.program}"\n' + self.limits
        self.heal()

    def heal(self):
        """The program is hairbake-worker again, in one step."""
        fresh = self.path / "fresh"
        shutil.copy(PROGRAMS / "hairbake-worker", fresh)
        fresh.rename(self.program)

    def become_stranger(self):
        """Starts anew with a user of its own. The limit of processes counts those of a user, and does not hold for root."""
        self.stop()
        subprocess.run(["chown", "-R", str(STRANGER), self.path], check=True)
        self.as_stranger = ["setpriv", f"--reuid={STRANGER}", f"--regid={STRANGER}", "--clear-groups", "--bounding-set=-all"]
        self.before = self.as_stranger
        self.start()

    def limit_processes(self, most=None):
        """Of the stranger, threads included; None: as many as at the start."""
        if most is None:
            most = resource.getrlimit(resource.RLIMIT_NPROC)[1]
            most = "unlimited" if most == resource.RLIM_INFINITY else most
        subprocess.run([*self.as_stranger, "prlimit", f"--pid={self.process.pid}", f"--nproc={most}:"], check=True)

    def post(self, hair, count, first=0):
        """That many bakes, which differ in their seeds."""
        ids = []
        for seed in range(first, first + count):
            reply = self.ask("POST", "/v1/bakes", quick_request(hair, transmittance={"seed": seed, "direction_set": "random"}))
            assert reply.status == 202, reply.body
            ids.append(reply.json["id"])
        return ids

    def post_in_shortage(self, hair, seed):
        """One bake, while the daemon may lack a thread for the connection: it then closes it, and the client asks again."""
        end = time.monotonic() + PATIENCE
        while True:
            try:
                return self.post(hair, 1, first=seed)
            except (http.client.RemoteDisconnected, ConnectionResetError):
                if time.monotonic() > end:
                    raise
                time.sleep(0.2)

    def wait_for_pause(self, word=""):
        """What /readyz says, once the queue is paused for a reason with that word."""
        end = time.monotonic() + PATIENCE
        while True:
            ready = self.ask("GET", "/readyz")
            if ready.status == 503 and "the queue is paused" in ready.json["detail"] and word in ready.json["detail"]:
                return ready.json["detail"]
            assert time.monotonic() < end, ready.body
            time.sleep(0.05)

    def wait_for_rest(self, bakes):
        """Until none of the bakes' stages runs: the queue is paused, and the next try is a second away."""
        end = time.monotonic() + PATIENCE
        while any(stage["state"] == "running" for bake in bakes for stage in self.ask("GET", f"/v1/bakes/{bake}").json["stages"]):
            assert time.monotonic() < end
            time.sleep(0.05)

    def metric(self, name):
        return [line for line in self.ask("GET", "/metrics").body.decode().splitlines() if line.startswith(name)]


class Troubles(unittest.TestCase):
    def assert_all_done(self, d, bakes):
        """None has failed, and the tries during the trouble are not counted."""
        views = [d.wait(bake) for bake in bakes]
        self.assertEqual([view["error"] for view in views], [None] * len(bakes))
        self.assertEqual({view["state"] for view in views}, {"done"})
        self.assertEqual({stage["attempts"] for view in views for stage in view["stages"]}, {1})

    @staticmethod
    def key_of(d, bake):
        return d.ask("GET", f"/v1/bakes/{bake}").json["stages"][0]["key"]

    def assert_over(self, d):
        self.assertEqual(d.ask("GET", "/readyz").status, 200)
        self.assertEqual(d.metric("hairbake_queue_paused"), ["hairbake_queue_paused 0"])
        self.assertEqual(d.leftovers(), [])

    def test_a_worker_program_that_is_away_for_4_s_fails_none_of_100_bakes(self):
        with Queue(workers=2, max_crashes=0) as d:
            hair = d.put(hair_bytes())
            d.program.unlink()
            bakes = d.post(hair, 100)
            missing = (f"the worker program {d.program} cannot be started: No such file or directory. Install hairbake again, or "
                       "let [workers] program name the file")
            d.wait_for_pause(missing)
            self.assertEqual(d.metric("hairbake_queue_paused"), [f'hairbake_queue_paused{{reason="{missing}"}} 1'])
            last = d.ask("GET", f"/v1/bakes/{bakes[-1]}").json  # it was not tried yet
            self.assertIn("cannot be started", last["stages"][0]["trouble"])
            time.sleep(4)
            self.assertNotEqual(d.metric("hairbake_machine_troubles"), ["hairbake_machine_troubles 0"])
            self.assertEqual(d.metric('hairbake_bakes{state="failed"}'), ['hairbake_bakes{state="failed"} 0'])
            d.heal()
            self.assert_all_done(d, bakes)
            self.assert_over(d)

    def test_only_callers_with_a_token_or_of_this_machine_learn_where_files_are(self):
        """Of /readyz, which anybody may ask through nginx."""
        token = "a" * 43
        tokens = f'[[token]]\nname = "farm"\nsha256 = "{sha256(token.encode())}"\nscopes = ["read"]\n'
        forwarded = {"X-Forwarded-For": "192.0.2.1"}
        with Queue(tokens=tokens) as d:
            d.program.unlink()
            for headers, told in ((forwarded, False), ({**forwarded, "Authorization": f"Bearer {token}"}, True), ({}, True)):
                ready = d.ask("GET", "/readyz", headers=headers)
                self.assertEqual(ready.status, 503)
                self.assertIn("the worker program ", ready.json["detail"])
                self.assertIn("worker cannot be started: No such file or directory", ready.json["detail"])
                self.assertEqual(str(d.path) in ready.json["detail"], told, headers)

    def test_a_daemon_that_says_that_it_listens_has_all_its_threads(self):
        """So a shortage that comes later cannot end it."""
        with Queue() as d:
            at_once = len(os.listdir(f"/proc/{d.process.pid}/task"))
            d.put(hair_bytes())
            time.sleep(1)
            self.assertEqual(len(os.listdir(f"/proc/{d.process.pid}/task")), at_once)

    def test_relative_a_start_without_threads_ends_with_the_reason(self):
        with Queue() as d:
            d.become_stranger()
            d.stop()
            d.before = [*d.as_stranger, "prlimit", "--nproc=20", "--"]
            daemon = d.spawn()
            self.assertEqual(daemon.communicate(timeout=PATIENCE)[0], b"")
            self.assertEqual(daemon.returncode, 1)
            d.wait_for_log("the system gives no 65 threads for connections (see [listen] threads): Resource temporarily")

    def test_a_start_without_the_worker_program_serves_and_pauses_the_queue(self):
        """Relatives: with and without a queued bake, and a program without the right to run it."""
        with Queue(max_crashes=0) as d:
            data = hair_bytes()
            hair, bakes = d.put(data), []
            for spoil, word in ((lambda: d.program.unlink(), "No such file or directory"),
                                (lambda: d.program.chmod(0o600), "Permission denied")):
                for queued in (False, True):
                    with self.subTest(word, queued=queued):
                        spoil()
                        if queued:
                            bakes += d.post(hair, 1, len(bakes))
                        d.stop()
                        (d.path / "log").write_text("")
                        d.start()
                        d.wait_for_log(f"the worker program {d.program} cannot be started: {word}")
                        self.assertEqual(d.ask("GET", f"/v1/blobs/{hair}").body, data)
                        self.assertEqual(d.ask("GET", "/readyz").status, 503)
                        if not queued:
                            bakes += d.post(hair, 1, len(bakes))
                        d.wait_for_pause(word)
                        d.heal()
                        self.assert_all_done(d, bakes)
                        self.assert_over(d)

    def test_relative_a_folder_in_place_of_the_worker_program_stops_the_start(self):
        with Queue() as d:
            d.stop()
            d.program.unlink()
            d.program.mkdir()
            process = d.spawn()
            self.assertEqual(process.wait(), 2)
            process.stdout.close()
            self.assertIn(f"workers.program is the folder {d.program}; allowed is a program", (d.path / "log").read_text())

    def test_relative_a_worker_program_that_cannot_run_or_ends_at_once(self):
        """During an upgrade: a file that is no program, without the right to run it, or whose libraries are missing. With
        libraries missing, the worker ends without a word; so it does on a processor that lacks an instruction."""
        def no_program(d):
            d.program.write_bytes(b"half a program")

        def no_right(d):
            d.program.chmod(0o600)

        def no_interpreter(d):
            d.program.write_bytes(b"#!/nowhere/sh\n")

        def ends(d):
            d.program.write_bytes(b"#!/bin/sh\nexit 127\n")

        def crashes(d):
            d.program.write_bytes(b"#!/bin/sh\nkill -ILL $$\n")

        with Queue(workers=2, max_crashes=0) as d:
            hair = d.put(hair_bytes())
            for number, (spoil, word) in enumerate({no_program: "install hairbake again", no_right: f"`chmod a+rx {d.program}`",
                                                    no_interpreter: "the interpreter that it names is missing",
                                                    ends: "code 127", crashes: "Illegal instruction"}.items()):
                d.program.unlink()  # not the bytes of a worker that runs
                d.heal()
                d.program.write_bytes(b"")
                spoil(d)
                bakes = d.post(hair, 5, first=10 * number)
                d.wait_for_pause(word)
                d.heal()
                self.assert_all_done(d, bakes)
                self.assert_over(d)

    def test_a_machine_without_processes_fails_none_of_20_bakes(self):
        with Queue(max_crashes=0) as d:
            d.become_stranger()
            hair = d.put(hair_bytes())
            d.limit_processes(1)
            bakes = d.post(hair, 20)
            self.assertRegex(d.wait_for_pause("Resource temporarily unavailable"),
                             r"The system gives user \d+ no more processes.*TasksMax.*lower \[workers\] count")
            d.limit_processes()
            self.assert_all_done(d, bakes)
            self.assert_over(d)

    def test_relative_a_machine_with_processes_for_workers_and_not_for_their_threads(self):
        with Queue(max_crashes=0) as d:
            d.become_stranger()
            hair, sky = d.put(hair_bytes()), d.put(hdr_bytes())
            daemon = len(os.listdir(f"/proc/{d.process.pid}/task"))
            for more in range(1, 9):  # the worker lacks its first thread, or a later one, as libraries start them
                d.limit_processes(daemon + more)
                bakes = d.post_in_shortage(hair, 10 * more)
                if more < 4:
                    d.wait_for_pause()
                else:  # how many threads it needs depends on the machine
                    d.wait_for_log(f"stage transmittance {self.key_of(d, bakes[0])[:12]} attempt 1: ")
                d.limit_processes()
                self.assert_all_done(d, bakes)

    def test_a_store_without_write_permission_for_3_s_fails_none_of_30_bakes(self):
        with Queue(workers=2, max_crashes=0) as d:
            d.become_bound_to_modes()
            hair = d.put(hair_bytes())
            folder = d.path / "store/tmp"
            bakes = d.post(hair, 30)
            folder.chmod(0o500)
            d.wait_for_pause("Permission denied")
            time.sleep(3)
            folder.chmod(0o750)
            self.assert_all_done(d, bakes)
            self.assert_over(d)

    def test_relative_a_result_that_cannot_be_taken_into_the_store(self):
        """The folders of blobs, and the database, refuse while stages end."""
        with Queue(max_crashes=0) as d:
            d.become_bound_to_modes()
            hair = d.put(hair_bytes())
            blobs = [folder for folder in (d.path / "store/blobs").iterdir()]
            for folder in blobs:
                folder.chmod(0o500)
            bakes = d.post(hair, 3)
            d.wait_for_pause("Permission denied")
            for folder in blobs:
                folder.chmod(0o750)
            self.assert_all_done(d, bakes)
            d.program.unlink()
            bakes = d.post(hair, 3, first=10)
            d.wait_for_pause("No such file")
            with contextlib.closing(sqlite3.connect(d.path / "store/hairbake.db", isolation_level=None)) as database:
                database.execute("BEGIN IMMEDIATE")
                d.heal()
                d.wait_for_pause("another program holds the lock of the database")
                database.execute("ROLLBACK")
            self.assert_all_done(d, bakes)
            self.assert_over(d)

    def test_relative_an_input_that_cannot_be_read_keeps_its_own_bake_waiting_alone(self):
        with Queue(max_crashes=0) as d:
            d.become_bound_to_modes()
            closed, hair = d.put(hair_bytes(seed=1)), d.put(hair_bytes())
            sky = d.put(hdr_bytes())
            d.blob_file(closed).chmod(0)
            waiting = d.post(closed, 1) + [d.ask("POST", "/v1/bakes", quick_request(environment=sky)).json["id"]]
            d.blob_file(sky).chmod(0)
            d.wait_for_pause("Permission denied")
            self.assert_all_done(d, d.post(hair, 3))
            view = d.ask("GET", f"/v1/bakes/{waiting[0]}").json
            self.assertIn(view["state"], ("queued", "running"))
            if view["state"] == "queued":
                self.assertIn("Permission denied", view["stages"][0]["trouble"])
                self.assertIn(f"sha256:{closed}", view["stages"][0]["trouble"])
                self.assertNotIn(str(d.path), view["stages"][0]["trouble"])
            for digest in (closed, sky):
                d.blob_file(digest).chmod(0o640)
            self.assert_all_done(d, waiting)
            self.assert_over(d)

    def test_relative_a_missing_input_fails_its_bake_with_the_reason(self):
        """Waiting does not bring it back; sending it again does."""
        with Queue() as d:
            hair = d.put(hair_bytes())
            d.blob_file(hair).unlink()
            view = d.wait(d.post(hair, 1)[0])
            self.assertEqual((view["state"], view["error"]["kind"]), ("failed", "bad_input"), view)
            self.assertIn(f"send the file sha256:{hair} again", view["error"]["message"])
            self.assertEqual(d.put(hair_bytes()), hair)
            self.assert_all_done(d, d.post(hair, 1))

    def test_relative_a_work_folder_that_is_deleted_while_its_worker_runs(self):
        with Queue(max_crashes=0) as d:
            real = PROGRAMS / "hairbake-worker"
            d.program.unlink()
            write_worker(d, f'*) if [ -e "{d.path}/go" ]; then exec "{real}" "$@"; fi; touch "{d.path}/begun"; '
                            f'while [ ! -e "{d.path}/go" ]; do sleep 0.05; done; exec "{real}" "$@" ;;')
            hair = d.put(hair_bytes())
            bakes = d.post(hair, 1)
            while not (d.path / "begun").exists():
                time.sleep(0.02)
            shutil.rmtree(d.path / "store/tmp" / d.leftovers()[0])
            (d.path / "go").touch()
            d.wait_for_pause()
            self.assert_all_done(d, bakes)
            self.assert_over(d)

    def test_relative_a_worker_of_another_version(self):
        """The program was replaced and the daemon was not started again: the keys in its manifests differ."""
        with Queue(max_crashes=0) as d:
            real = PROGRAMS / "hairbake-worker"
            d.program.unlink()
            write_worker(d, f"""*trial*) say '{{"done":{{"versions":"transmittance 1"}}}}' ;;
*) "{real}" "$folder"; sed -i 's/"key": "[0-9a-f]*"/"key": "other"/' "$folder/result/manifest.json" ;;""")
            bakes = d.post(d.put(hair_bytes()), 3)
            detail = d.wait_for_pause("start the daemon again")
            self.assertIn(f'the versions of the worker program {d.program} are "transmittance 1"; allowed are those of the '
                          "daemon", detail)
            d.heal()
            self.assert_all_done(d, bakes)
            self.assert_over(d)

    def test_relative_an_inspection_is_asked_for_again_and_the_file_is_not_at_fault(self):
        with Queue() as d:
            hair = d.put(hair_bytes())
            d.program.unlink()
            for spoil in (lambda: None, lambda: d.program.write_bytes(b"#!/bin/sh\nexit 127\n") and d.program.chmod(0o755)):
                spoil()
                reply = d.ask("POST", "/v1/models", {"sha256": hair})
                self.assertEqual((reply.status, reply.json["type"]), (503, "urn:hairbake:problem:busy"), reply.body)
                self.assertIsNotNone(reply.headers["Retry-After"])
            d.program.unlink()
            d.heal()
            self.assertEqual(d.ask("POST", "/v1/models", {"sha256": hair}).status, 201)
            self.assertEqual(d.leftovers(), [])

    def test_an_input_that_kills_its_worker_fails_alone(self):
        """The worker dies by one input and not by a trial, so the input is at fault."""
        with Queue(max_crashes=2) as d:
            d.program.unlink()
            write_worker(d, """*'"seed":1,'*) say '{"begin":{}}'; kill -SEGV $$ ;;""")
            hair = d.put(hair_bytes())
            bakes = d.post(hair, 3)
            view = d.wait(bakes[1])
            self.assertEqual((view["state"], view["stages"][0]["attempts"]), ("failed", 3))
            self.assertIn("Segmentation fault", view["error"]["message"])
            self.assert_all_done(d, [bakes[0], bakes[2]])
            self.assert_over(d)

    def test_relative_workers_that_die_by_every_input(self):
        """A trial, which has no input of the store, dies too. So no input is at fault."""
        with Queue(workers=2, max_crashes=0) as d:
            d.program.unlink()
            write_worker(d, """*) say '{"begin":{}}'; kill -ILL $$ ;;""")
            bakes = d.post(d.put(hair_bytes()), 5)
            d.wait_for_pause("a trial without an input failed, too: the worker was ended by a signal: Illegal instruction")
            d.wait_for_rest(bakes)  # a stage that has died while its trial has not would be at fault
            d.heal()
            self.assert_all_done(d, bakes)
            self.assert_over(d)

    def test_relative_a_worker_that_somebody_else_stops_counts_as_dead(self):
        """Its last word is that it was stopped, and nobody of the service did so."""
        with Queue(max_crashes=1) as d:
            bake = d.ask("POST", "/v1/bakes", slow_request(d.put(hair_bytes(strands=2000, points=60)))).json["id"]
            for attempt in (1, 2):
                while (stage := d.ask("GET", f"/v1/bakes/{bake}").json["stages"][0])["attempts"] < attempt or not stage.get("phase"):
                    time.sleep(0.05)
                os.kill(d.wait_for_worker(), signal.SIGTERM)
            view = d.wait(bake)  # twice is more than max_crashes, and the trials were successful
            self.assertEqual((view["state"], view["stages"][0]["attempts"]), ("failed", 2))

    def test_relative_a_worker_that_takes_itself_for_an_orphan(self):
        """Under a wrapper the worker is no child of the daemon: every worker ends at once, with the word that it was stopped."""
        with Queue(max_crashes=0) as d:
            real = PROGRAMS / "hairbake-worker"
            d.program.unlink()
            write_worker(d, f'*) "{real}" "$@"; exit $? ;;')
            bakes = d.post(d.put(hair_bytes()), 3)
            d.wait_for_pause("the daemon is gone")
            d.heal()
            self.assert_all_done(d, bakes)
            self.assert_over(d)

    def test_a_cancelled_queue_is_not_paused_any_more(self):
        with Queue() as d:
            d.program.unlink()
            bakes = d.post(d.put(hair_bytes()), 2)
            d.wait_for_pause()
            for bake in bakes:
                d.ask("DELETE", f"/v1/bakes/{bake}")
            d.heal()
            end = time.monotonic() + PATIENCE
            while d.ask("GET", "/readyz").status != 200:
                self.assertLess(time.monotonic(), end)
                time.sleep(0.1)
            self.assert_over(d)

    def test_a_stop_during_a_pause_is_quick_and_keeps_the_queue(self):
        with Queue() as d:
            d.program.unlink()
            bakes = d.post(d.put(hair_bytes()), 3)
            d.wait_for_pause()
            self.assertEqual(d.stop()[0], 0)
            d.heal()
            d.start()
            self.assert_all_done(d, bakes)


if __name__ == "__main__":
    unittest.main()
