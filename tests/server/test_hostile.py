"""Hostile inputs and workers that misbehave: the job fails with the reason, the daemon and the other jobs go on."""
import json
import unittest

from harness import PROGRAMS, Daemon, hair_bytes, quick_request, sha256
from hostile_files import exr_bytes, hostile_environments, hostile_hair

GROWTH_MB = 64  # of the daemon, which reads none of these files


class HostileInputs(unittest.TestCase):
    def test_each_fails_its_bake_with_the_reason_and_the_next_bake_works(self):
        with Daemon(workers=2, limits="memory_mb = 1024") as d:
            hair, sky = d.put(hair_bytes()), d.put(exr_bytes())
            before = d.memory_kb("VmRSS")
            asked = {}
            for field, files in (("hair", hostile_hair()), ("environment", hostile_environments()),
                                 ("occluder", {"an absurd face": b"v 0 0 0\nf 1 2 999999999999\n", "no mesh": b"\0" * 100})):
                for name, data in files.items():
                    request = {**quick_request(hair if field == "occluder" else None), field: f"sha256:{d.put(data)}"}
                    reply = d.ask("POST", "/v1/bakes", request)
                    self.assertEqual(reply.status, 202, (name, reply.body))
                    asked[field, name] = reply.json["id"]
            for key, bake in asked.items():
                view = d.wait(bake)
                self.assertEqual(view["state"], "failed", key)
                self.assertEqual(view["error"]["kind"], "bad_input", (key, view["error"]))
                self.assertIn("sha256:", view["error"]["message"], key)  # which file; not its place in the store
                self.assertNotIn(str(d.path), json.dumps(view), key)
                self.assertEqual(view["stages"][0]["attempts"], 1, key)  # it would fail again
            good = d.ask("POST", "/v1/bakes", quick_request(hair, sky)).json["id"]
            self.assertEqual(d.wait(good)["state"], "done")
            self.assertLessEqual(d.memory_kb("VmHWM") - before, GROWTH_MB * 1024)
            self.assertEqual(d.leftovers(), [])

    def test_a_hostile_body_is_refused(self):
        with Daemon() as d:
            for name, body in {"nested arrays": "[" * 500_000, "nested objects": '{"a":' * 150_000,
                               "deep and whole": '{"hair":' + "[" * 1000 + "]" * 1000 + "}",
                               "no UTF-8": b'{"hair": "\xff\xfe"}', "two values": "{} {}", "a number too large": '{"hair": 1e999}',
                               "a comment": "{/* */}", "nothing": "", "zeros": b"\0" * 1000}.items():
                for path in ("/v1/bakes", "/v1/rebakes", "/v1/models", "/v1/environments"):
                    reply = d.ask("POST", path, body, {"Content-Type": "application/json"})
                    self.assertEqual(reply.status in (400, 413, 422), True, (name, path, reply.status, reply.body[:200]))
                    self.assertEqual(reply.headers["Content-Type"], "application/problem+json")
            self.assertEqual(d.ask("GET", "/healthz").status, 200)


# Stands for hairbake-worker: misbehaves as the rules say, else becomes the real one. Its last argument is the work folder.
WORKER = """#!/bin/sh
for folder; do :; done
task=$(cat "$folder/task.json")
real() { exec "REAL" "$@"; }
make() { "REAL" --parent=$$ "$folder"; }
say() { printf '%s\\n' "$1" >> "$folder/words.jsonl"; }
case $task in
RULES
*) real "$@" ;;
esac
"""

RULES = """
*'"seed":11,'*) say '{"begin":{}}'; kill -SEGV $$ ;;
*'"seed":12,'*) exec sleep 1000 ;;
*'"seed":13,'*) trap '' TERM; sleep 1000; sleep 1000 ;;
*'"seed":14,'*) exec > "$folder/words.jsonl"; while :; do printf 'xxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxx'; done ;;
*'"seed":15,'*) say '{"done":{}}' ;;
*'"seed":16,'*) say '{"begin":{}}'; exit 3 ;;
*'"seed":17,'*) say '{"error":{"kind":"bad_input","message":"as I say","field":"hair"}}'; exit 1 ;;
*'"seed":18,'*) say '{"phase":"write","fraction":"x"}'; say '[[[['; say '{"error":[]}'; say '{"done":'; exit 0 ;;
*'"seed":19,'*) say '{"begin":{}}'; sleep 1000 & exit 3 ;;
*'"seed":20,'*) make; rm "$folder/result/transmittance.npy"; mkfifo "$folder/result/transmittance.npy" ;;
*'"seed":21,'*) make; rm "$folder/result/manifest.json"; mkfifo "$folder/result/manifest.json" ;;
*'"seed":22,'*) make; mv "$folder/result/transmittance.npy" "$folder"; ln -s "$folder/transmittance.npy" "$folder/result" ;;
"""


def write_worker(daemon, rules):
    """The path of the misbehaving worker."""
    program = daemon.path / "worker"
    program.write_text(WORKER.replace("RULES", rules.strip()).replace("REAL", str(PROGRAMS / "hairbake-worker")))
    program.chmod(0o755)
    return program


class BadWorkers(unittest.TestCase):
    # 20 to 22: reading a pipe in the place of a result would keep the daemon's thread for ever, and a link would become a blob.
    def test_each_fails_its_job_with_the_reason_and_leaves_the_others_alone(self):
        with Daemon(workers=2, max_crashes=0) as d:
            d.stop()
            d.limits = f'program = "{write_worker(d, RULES)}"\nwall_s = 30'
            d.start()
            hair = d.put(hair_bytes())

            def post(seed):
                reply = d.ask("POST", "/v1/bakes", quick_request(hair, transmittance={"seed": seed, "direction_set": "random"}))
                self.assertEqual(reply.status, 202, reply.body)
                return reply.json["id"]

            words = {11: "Segmentation fault", 12: "not done after 30 seconds", 13: "not done after 30 seconds",
                     14: "a line of more than 1 MiB", 15: "manifest", 16: "ended with code 3", 17: "as I say",
                     18: "ended with code 0", 19: "ended with code 3", 20: "transmittance.npy is not as its manifest",
                     21: "manifest is a named pipe", 22: "transmittance.npy is not as its manifest"}
            bakes = {seed: post(seed) for seed in [*words, 1, 2]}
            for seed, word in words.items():
                view = d.wait(bakes[seed])
                self.assertEqual(view["state"], "failed", seed)
                self.assertIn(word, view["error"]["message"], seed)
            for seed in (1, 2):
                self.assertEqual(d.wait(bakes[seed])["state"], "done")
            d.wait_for_worker(running=False)
            self.assertEqual(d.leftovers(), [])
            self.assertLess(d.memory_kb("VmHWM"), 256 * 1024)  # the words of the babbling worker were not kept
            self.assertEqual(d.ask("GET", "/readyz").status, 200)


class BadInspections(unittest.TestCase):
    def test_each_is_refused_with_the_reason_and_the_next_one_works(self):
        words = ("dies", "dies once", "is short", "is wrong", "is good")
        models = {word: hair_bytes(seed=number) for number, word in enumerate(words)}
        rules = """
*dies*) say '{"begin":{}}'; kill -SEGV $$ ;;
*dies-once*) if [ -e MARK ]; then real "$@"; else touch MARK; say '{"begin":{}}'; kill -SEGV $$; fi ;;
*is-short*) say '{"error":{"kind":"out_of_resources","message":"memory is short","field":""}}'; exit 1 ;;
*is-wrong*) say '{"error":{"kind":"internal","message":"a mistake of ours","field":""}}'; exit 1 ;;
"""
        with Daemon() as d:
            d.stop()
            for word, data in sorted(models.items(), key=lambda item: -len(item[0])):
                rules = rules.replace(f"*{word.replace(' ', '-')}*", f"*{sha256(data)}*")
            program = write_worker(d, rules.replace("MARK", str(d.path / "mark")))
            d.limits = f'program = "{program}"'
            d.start()

            def inspect(word):
                return d.ask("POST", "/v1/models", {"sha256": d.put(models[word])})

            dead = inspect("dies")
            self.assertEqual((dead.status, dead.json["type"]), (422, "urn:hairbake:problem:unprocessable"), dead.body)
            self.assertIn("Segmentation fault", dead.json["detail"])
            once = inspect("dies once")  # the second attempt was successful
            self.assertEqual((once.status, once.json.get("facts", {}).get("strands")), (201, 40), once.body)
            short = inspect("is short")
            self.assertEqual((short.status, short.json["type"]), (507, "urn:hairbake:problem:full"), short.body)
            self.assertIn("memory is short", short.json["detail"])
            wrong = inspect("is wrong")
            self.assertEqual((wrong.status, wrong.json["type"]), (500, "urn:hairbake:problem:internal"), wrong.body)
            for word in ("dies", "is short", "is wrong"):
                self.assertEqual(d.ask("GET", f"/v1/models/{sha256(models[word])}").status, 404)
                self.assertEqual(d.ask("HEAD", f"/v1/blobs/{sha256(models[word])}").status, 200)  # it may be tried again
            self.assertEqual(inspect("is good").status, 201)
            self.assertEqual(d.leftovers(), [])
            d.wait_for_worker(running=False)
            self.assertEqual(d.ask("GET", "/readyz").status, 200)


if __name__ == "__main__":
    unittest.main()
