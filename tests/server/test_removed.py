"""Bakes whose record was removed: the reply says that there was one, why it went, and what to do."""
import os
import subprocess
import time
import unittest

from harness import PATIENCE, Daemon, hair_bytes, hdr_bytes, quick_request, slow_request
from pathlib import Path

PYTHON_CLIENT = Path(__file__).resolve().parents[2] / "clients/python"
SMALL = "budget_mb = 1\nblob_mb = 2\nkeep_free_mb = 0"


def large_request(sky):
    """1 + 6 maps of 6 x 32 x 32 texels of 12 bytes are 516 kB."""
    return quick_request(environment=sky, irradiance={"face_size": 32, "specular_maps": 6})


class Removed(unittest.TestCase):
    def assert_gone(self, reply, words):
        self.assertEqual((reply.status, reply.headers["Content-Type"]), (410, "application/problem+json"), reply.body)
        self.assertEqual(reply.json["type"], "urn:hairbake:problem:gone")
        self.assertRegex(reply.json["detail"], words)

    def assert_evicted_everywhere(self, d, bake, sky):
        removed = f"the result of bake {bake} was removed at 20.* to make room in the store.*The same request sent again bakes it anew"
        for method, path in (("GET", ""), ("DELETE", ""), ("GET", "/files/manifest.json"), ("GET", "/files/nothing")):
            self.assert_gone(d.ask(method, f"/v1/bakes/{bake}{path}"), removed)
        rebake = d.ask("POST", "/v1/rebakes", {"bakes": [bake], "environment": f"sha256:{sky}"})
        self.assertEqual((rebake.status, rebake.json["field"]), (422, "bakes"))
        self.assertRegex(rebake.json["detail"], removed)

    def test_an_evicted_bake_is_told_from_one_that_never_was(self):
        """Fault: 404 "there is no bake". Relatives: its files, its cancellation, a rebake of it, after a restart, a client."""
        with Daemon(config=SMALL) as d:
            sky = d.put(hdr_bytes())
            bake = d.ask("POST", "/v1/bakes", large_request(sky)).json["id"]
            self.assertEqual(d.wait(bake)["state"], "done")
            filler = d.put(os.urandom(600_000))
            for _ in range(2):
                self.assert_evicted_everywhere(d, bake, sky)
                d.stop()
                d.start()
            client = subprocess.run(["python3", "-m", "hairbake", "wait", bake, "--server", f"http://127.0.0.1:{d.port}"],
                                    env={**os.environ, "PYTHONPATH": str(PYTHON_CLIENT)}, capture_output=True, text=True,
                                    timeout=PATIENCE)
            self.assertEqual(client.returncode, 7, client.stderr)
            self.assertIn("to make room in the store", client.stderr)
            self.assertIn("The same request sent again bakes it anew", client.stderr)
            for path in ("", "/files/manifest.json"):
                reply = d.ask("GET", f"/v1/bakes/{'0' * 64}{path}")
                self.assertEqual((reply.status, reply.json["detail"]), (404, f"there is no bake {'0' * 64}"))
            self.assertEqual(d.ask("DELETE", f"/v1/blobs/{filler}").status, 204)
            again = d.ask("POST", "/v1/bakes", large_request(sky))
            self.assertEqual((again.status, again.json["id"]), (202, bake))
            self.assertEqual(d.wait(bake)["state"], "done")
            self.assertEqual(d.ask("GET", f"/v1/bakes/{bake}/files/manifest.json").status, 200)

    def test_an_evicted_bake_keeps_no_input(self):
        """Relative: of two bakes of one input, the deletion lists the one that is stored."""
        with Daemon(config=SMALL) as d:
            sky = d.put(hdr_bytes())
            large = d.ask("POST", "/v1/bakes", large_request(sky)).json["id"]
            self.assertEqual(d.wait(large)["state"], "done")
            small = d.ask("POST", "/v1/bakes", quick_request(environment=sky)).json["id"]
            self.assertEqual(d.wait(small)["state"], "done")
            for listed, filler in (([small, large], 0), ([small], 600_000), ([], 420_000)):
                if filler:
                    d.put(os.urandom(filler))
                kept = [bake for bake in (small, large) if d.ask("GET", f"/v1/bakes/{bake}").status == 200]
                self.assertEqual(kept, listed)
                refused = d.ask("DELETE", f"/v1/blobs/{sky}")
                if not listed:
                    self.assertEqual(refused.status, 204, refused.body)
                    continue
                self.assertEqual(refused.status, 409)
                self.assertEqual([bake["id"] for bake in refused.json["needed_by"]["bakes"]["first"]], listed)
            for bake, request in ((large, large_request(sky)), (small, quick_request(environment=sky))):
                self.assert_gone(d.ask("GET", f"/v1/bakes/{bake}"), "to make room")
                reply = d.ask("POST", "/v1/bakes", request)
                self.assertEqual(reply.status, 422, reply.body)
                self.assertIn("which is not stored; send it first", reply.json["detail"])

    def test_relative_failed_and_cancelled_bakes_whose_records_went_by_age(self):
        with Daemon(config="keep_failed_s = 1") as d:
            failed = d.ask("POST", "/v1/bakes", quick_request(d.put(b"no hair model"))).json["id"]
            self.assertEqual(d.wait(failed)["state"], "failed")
            cancelled = d.ask("POST", "/v1/bakes", quick_request(d.put(hair_bytes(strands=4000)))).json["id"]
            self.assertEqual(d.ask("DELETE", f"/v1/bakes/{cancelled}").json["state"], "cancelled")
            time.sleep(1.1)
            d.stop()
            d.start()  # removes old records
            for bake, state in ((failed, "failed"), (cancelled, "cancelled")):
                self.assert_gone(d.ask("GET", f"/v1/bakes/{bake}"),
                                 f"bake {bake} ended as {state}, and its record was removed at 20.*sent again bakes it anew")

    def test_a_failed_bake_keeps_its_record_when_its_other_stage_is_evicted(self):
        """Fault: 410, and the reason was lost. Relatives: a cancelled bake, after a restart, the same request sent again."""
        with Daemon(config=SMALL) as d:
            sky = d.put(hdr_bytes())
            other = large_request(sky)
            bakes = {"done": other, "failed": {**other, "hair": f"sha256:{d.put(b'no hair model')}"},
                     "cancelled": {**slow_request(d.put(hair_bytes())), **{k: other[k] for k in ("environment", "irradiance")}}}
            ids = {}
            for state, request in bakes.items():
                ids[state] = d.ask("POST", "/v1/bakes", request).json["id"]
                if state == "cancelled":
                    self.assertEqual(d.ask("DELETE", f"/v1/bakes/{ids[state]}").status, 200)
                self.assertEqual(d.wait(ids[state])["state"], state)
            error = d.ask("GET", f"/v1/bakes/{ids['failed']}").json["error"]
            self.assertEqual(error["kind"], "bad_input")
            filler = d.put(os.urandom(600_000))
            for _ in range(2):
                self.assert_gone(d.ask("GET", f"/v1/bakes/{ids['done']}"), "to make room")
                for state in ("failed", "cancelled"):
                    reply = d.ask("GET", f"/v1/bakes/{ids[state]}")
                    self.assertEqual((reply.status, reply.json["state"]), (200, state), reply.body)
                    stages = {stage["kind"]: stage["state"] for stage in reply.json["stages"]}
                    self.assertEqual(stages, {"transmittance": state, "irradiance": "cancelled"})
                    self.assertEqual(reply.json["error"], error if state == "failed" else None)
                d.stop()
                d.start()
            self.assertEqual(d.ask("DELETE", f"/v1/blobs/{filler}").status, 204)
            for state in ("failed", "done"):
                again = d.ask("POST", "/v1/bakes", bakes[state])
                self.assertEqual(again.json["id"], ids[state])
                self.assertEqual(d.wait(ids[state])["state"], state)


if __name__ == "__main__":
    unittest.main()
