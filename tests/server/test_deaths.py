"""Workers that are ended from outside: by the system without memory, by somebody. A passing trouble fails no bake, and an
input that kills its worker fails with the reason."""
import contextlib
import sqlite3
import unittest

from harness import Daemon, hair_bytes, quick_request, slow_request
from test_hostile import write_worker
from rooms import eventually
from test_troubles import Queue


class Deadly(Queue):
    """A daemon whose workers die by a signal while the file `killer` is there. Each writes a line into the file `runs`."""

    def __init__(self, which="*bake*", signal_name="KILL", **more):
        super().__init__(**more)
        self.killer, self.runs = self.path / "killer", self.path / "runs"
        self.killer.touch()
        self.runs.touch()
        self.program.unlink()
        write_worker(self, f"""*'"task":"trial"'*) real "$@" ;;
{which}) echo run >> {self.runs}
    if [ -e {self.killer} ]; then say '{{"begin":{{}}}}'; kill -{signal_name} $$; fi
    real "$@" ;;""")

    def run_count(self):
        return len(self.runs.read_text().splitlines())

    def trouble(self, bake):
        return self.ask("GET", f"/v1/bakes/{bake}").json["stages"][0].get("trouble", "")

    def crashes(self):
        with contextlib.closing(sqlite3.connect(self.path / "store/hairbake.db")) as database:
            return database.execute("SELECT sum(crashes) FROM stages").fetchone()[0]


class Deaths(unittest.TestCase):
    def test_a_killer_that_goes_after_some_seconds_fails_no_bake(self):
        """Fault: six kills within 12 s failed a bake for good, because each retry came at once. Relatives: another signal from
        outside, and one of the worker's own."""
        for signal_name in ("KILL", "TERM", "SEGV"):
            with self.subTest(signal_name), Deadly(signal_name=signal_name, max_crashes=2, crash_wait=1) as d:
                bake = d.post(d.put(hair_bytes()), 1)[0]
                eventually(lambda: d.run_count() == 2)
                eventually(lambda: "workers of this stage died 2 times, and the next one starts after a wait of" in d.trouble(bake))
                d.killer.unlink()
                view = d.wait(bake)
                self.assertEqual((view["state"], view["stages"][0]["attempts"]), ("done", 3), view)
                self.assertEqual(d.ask("GET", "/readyz").status, 200)

    def test_relative_the_waits_survive_a_restart(self):
        """A daemon that starts again and again must not try again and again."""
        with Deadly(max_crashes=2, crash_wait=1) as d:
            bake = d.post(d.put(hair_bytes()), 1)[0]
            eventually(lambda: "died 2 times" in d.trouble(bake))
            for end in (d.stop, d.kill):
                end()
                d.start()
                self.assertIn("(SIGKILL); workers of this stage died 2 times", d.trouble(bake))
            self.assertEqual(d.run_count(), 2)
            d.killer.unlink()
            view = d.wait(bake)
            self.assertEqual((view["state"], view["stages"][0]["attempts"]), ("done", 3), view)

    def test_relative_a_stage_that_ran_when_daemons_were_killed_waits_while_others_have_their_turn(self):
        with Daemon(crash_wait=60) as d:
            hair = d.put(hair_bytes(strands=2000, points=60))
            slow = d.ask("POST", "/v1/bakes", slow_request(hair)).json["id"]
            for ends in range(2):
                d.wait_for_worker()
                d.kill()
                d.start()
            stage = d.ask("GET", f"/v1/bakes/{slow}").json["stages"][0]
            self.assertEqual(stage["state"], "queued")
            self.assertIn("the daemon was ended while the stage ran; that happened 2 times", stage["trouble"])
            other = d.ask("POST", "/v1/bakes", quick_request(d.put(hair_bytes()))).json["id"]
            self.assertEqual(d.wait(other)["state"], "done")
            self.assertEqual(d.ask("DELETE", f"/v1/bakes/{slow}").status, 200)
            self.assertEqual(d.ask("POST", "/v1/bakes", slow_request(hair)).status, 202)
            d.wait_for_worker()  # asked for anew, it waits no more

    def test_workers_of_several_stages_that_are_killed_pause_the_queue_and_no_death_counts(self):
        """Fault: the system without memory killed what ran, and each death counted against its input."""
        with Deadly(workers=2, max_crashes=1, crash_wait=1) as d:
            bakes = d.post(d.put(hair_bytes()), 2)
            detail = d.wait_for_pause("different stages in the last time")
            self.assertIn("the worker was ended by a signal: Killed (SIGKILL)", detail)
            self.assertIn("short of memory", detail)
            self.assertGreaterEqual(int(d.ask("GET", "/readyz").headers["Retry-After"]), 1)
            self.assertEqual(len(d.metric("hairbake_queue_paused{reason=")), 1)
            eventually(lambda: d.run_count() > 4)  # more than two for a stage: if they counted, it would have failed
            d.killer.unlink()
            views = [d.wait(bake) for bake in bakes]
            self.assertEqual([view["state"] for view in views], ["done"] * 2, views)
            self.assertEqual(d.crashes(), 0)
            self.assertEqual(d.ask("GET", "/readyz").status, 200)

    def test_one_stage_whose_workers_are_killed_while_others_work_fails_with_the_count_and_the_remedy(self):
        """Fault: the message told of one death. Relative: a fault of the worker's own has another remedy."""
        for signal_name, words in (("KILL", ("Killed (SIGKILL)", "look at the machine's memory and its log, then submit")),
                                   ("SEGV", ("Segmentation fault (SIGSEGV)", "check them, then submit the request again"))):
            with self.subTest(signal_name), Deadly("""*'"seed":1,'*""", signal_name, max_crashes=2, crash_wait=1) as d:
                bakes = d.post(d.put(hair_bytes()), 4)
                others = [d.wait(bake)["state"] for bake in (bakes[0], bakes[2], bakes[3])]
                view = d.wait(bakes[1])
                self.assertEqual((others, view["state"], view["error"]["kind"]), (["done"] * 3, "failed", "internal"))
                self.assertRegex(view["error"]["message"],
                                 r"^workers of this stage died 3 times within \d+ s \(3 times: the worker was ended by a signal: ")
                for part in (*words, "allowed are 2 deaths ([workers] max_crashes)"):
                    self.assertIn(part, view["error"]["message"])
                self.assertEqual(d.ask("GET", "/readyz").status, 200)
                d.killer.unlink()
                self.assertEqual(d.ask("POST", "/v1/bakes", view["request"]).status, 202)
                self.assertEqual(d.wait(bakes[1])["state"], "done")  # the deaths before do not count

    def test_relative_an_inspection_whose_workers_are_killed_is_asked_for_again(self):
        """The file was blamed: 422."""
        with Deadly("*inspect*") as d:
            hair = d.put(hair_bytes())
            reply = d.ask("POST", "/v1/models", {"sha256": hair})
            self.assertEqual((reply.status, reply.json["type"]), (503, "urn:hairbake:problem:busy"), reply.body)
            self.assertIn("Killed (SIGKILL)", reply.json["detail"])
            d.killer.unlink()
            self.assertEqual(d.ask("POST", "/v1/models", {"sha256": hair}).status, 201)


if __name__ == "__main__":
    unittest.main()
