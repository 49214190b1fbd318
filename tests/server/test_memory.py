"""The daemon's memory under hostile requests: at most 64 MB more than when it is idle."""
import json
import sqlite3
import threading
import unittest
from concurrent.futures import ThreadPoolExecutor

from harness import Daemon, hair_bytes, hdr_bytes, quick_request
from hostile_bodies import LIMITS, NAME, hostile_bodies
from test_hostile import write_worker

GROWTH_MB = 64  # the promise of docs/architecture.md
AT_ONCE = 60    # of the daemon's 64 threads
JSON = {"Content-Type": "application/json"}
REFUSALS = {400, 413, 422}


def send(daemon, path, body, headers=JSON):
    """The status and the length of the reply. None when the connection was closed before the reply: the body was refused
    while it was sent."""
    method = "PUT" if path == NAME else "POST"
    try:
        reply = daemon.ask(method, path, body, headers)
        return reply.status, len(reply.body)
    except (BrokenPipeError, ConnectionResetError):
        return None, 0


def in_chunks(body):
    """An iterable body is sent chunked."""
    return (body[i:i + 50_000] for i in range(0, len(body), 50_000))


class Memory(unittest.TestCase):
    """One daemon for each test: the most memory that it ever had counts."""

    def setUp(self):
        self.daemon = Daemon().__enter__()
        self.addCleanup(self.daemon.__exit__)
        self.assertEqual(self.daemon.ask("POST", "/v1/bakes", {}).status, 422)  # the schemas are read
        self.idle = self.daemon.memory_kb("VmRSS")

    def check_growth(self, name):
        grown = (self.daemon.memory_kb("VmHWM") - self.idle) / 1024
        self.assertLessEqual(grown, GROWTH_MB, name)
        return grown


class HostileBodies(Memory):
    def test_each_is_refused_with_a_short_reply_and_little_memory(self):
        for (path, name), body in hostile_bodies().items():
            for data in (body, in_chunks(body)):
                status, length = send(self.daemon, path, data)
                self.assertIn(status, REFUSALS | {None}, (path, name))
                self.assertLess(length, 4000, (path, name))
            self.check_growth((path, name))
        self.assertEqual(self.daemon.leftovers(), [])

    def test_many_at_once_take_no_more(self):
        with ThreadPoolExecutor(AT_ONCE) as pool:
            for (path, name), body in hostile_bodies().items():
                found = set(pool.map(lambda _, p=path, b=body: send(self.daemon, p, b)[0], range(AT_ONCE)))
                self.assertLessEqual(found, REFUSALS | {429, None}, (path, name))
                self.check_growth((path, name))

    def test_all_kinds_at_once_take_no_more_and_a_good_request_passes(self):
        cases = list(hostile_bodies().items()) * 3
        done = threading.Event()

        def ask_good():
            while not done.is_set():
                self.assertEqual(self.daemon.ask("POST", "/v1/bakes", {"hair": "sha256:" + "0" * 64}).status, 422)
        with ThreadPoolExecutor(AT_ONCE + 1) as pool:
            good = pool.submit(ask_good)
            for status, _ in pool.map(lambda case: send(self.daemon, case[0][0], case[1]), cases):
                self.assertIn(status, REFUSALS | {429, None})
            done.set()
            good.result()
        self.check_growth("all kinds")

    def test_slow_bodies_hold_no_memory_and_let_others_pass(self):
        """Relative: each has sent all of 4 MB but the last byte; before, each would have held its bytes."""
        size = LIMITS["/v1/rebakes"]
        head = f"POST /v1/rebakes HTTP/1.1\r\nHost: localhost\r\nContent-Type: application/json\r\nContent-Length: {size}\r\n\r\n"
        slow = [self.daemon.connect() for _ in range(40)]
        try:
            for s in slow:
                s.sendall(head.encode() + b" " * (size - 1))
            reply = self.daemon.ask("POST", "/v1/rebakes", {"environment": "x", "bakes": ["0" * 64] * 2000})  # a long one
            self.assertEqual(reply.status, 422)
            self.check_growth("slow bodies")
        finally:
            for s in slow:
                s.close()

    def test_a_body_on_the_bounds_is_taken(self):
        """So that the bounds are those of the schema."""
        lights = [{"direction": [0, 1, 0], "irradiance": [1, 1, 1]}] * 64
        outputs = ["npy", "exr", "hair", "ktx2", "dds", "raw", "glb", "vdb"]
        sky = self.daemon.put(hdr_bytes())
        good = {"environment": f"sha256:{sky}", "irradiance": {"lights": lights, "face_size": 4, "specular_maps": 3}, "outputs": outputs}
        self.assertIn(self.daemon.ask("POST", "/v1/bakes", good).status, (200, 202))
        for field, words in (({"irradiance": {"lights": lights + lights[:1]}}, "irradiance.lights is a list of more than 64 items"),
                             ({"outputs": outputs + ["npy"]}, "outputs is a list of more than 8 items"),
                             ({"environment_settings": {"tint": [1, 1, 1, 1]}}, "tint is a list of more than 3 items"),
                             ({"irradiance": {"rotation_deg": [1, 1, 1, 1]}}, "rotation_deg is a list of more than 3 items")):
            reply = self.daemon.ask("POST", "/v1/bakes", {**good, **field})
            self.assertEqual(reply.status, 422)
            self.assertIn(words, reply.json["detail"])
            self.assertTrue(reply.json["pointer"])
        twice = self.daemon.ask("POST", "/v1/bakes", '{"hair": null, "hair": null}', JSON)
        self.assertEqual((twice.status, twice.json["field"]), (422, "hair"))


class LongAddresses(Memory):
    def test_queries_with_many_values_take_little(self):
        queries = ("&".join(f"state{i}=x" for i in range(700)), "&".join(["state=queued"] * 600), "limit=" + "9" * 8000,
                   "&" * 8000, "%41" * 2600 + "=1")
        with ThreadPoolExecutor(AT_ONCE) as pool:
            for query in queries:
                found = set(pool.map(lambda _, q=query: self.daemon.ask("GET", f"/v1/bakes?{q}").status, range(AT_ONCE * 4)))
                self.assertLessEqual(found, {200, 400, 414, 422}, query[:50])
        self.check_growth("queries")

    def test_heads_of_many_long_lines_end_early(self):
        """Relative: 100 lines of 8 kB would be 800 kB for each connection."""
        head = b"GET /healthz HTTP/1.1\r\nHost: localhost\r\n" + b"".join(b"X-%d: %s\r\n" % (i, b"a" * 8000) for i in range(90))
        held = [self.daemon.connect() for _ in range(AT_ONCE)]
        for s in held:
            try:
                s.sendall(head)  # without its end
            except (BrokenPipeError, ConnectionResetError):
                pass
        for s in held:
            self.assertIn(b" 400 ", s.recv(100))
            s.close()
        self.check_growth("heads")


class LongBatches(Memory):
    """Relatives: valid requests whose plans and views would be large."""

    def test_one_bake_named_50000_times_is_planned_once(self):
        d = self.daemon
        bake = d.ask("POST", "/v1/bakes", quick_request(d.put(hair_bytes()), d.put(hdr_bytes()))).json["id"]
        new = d.put(hdr_bytes(red=7))
        body = json.dumps({"environment": f"sha256:{new}", "bakes": [bake] * 50_000}).encode()
        dry = d.ask("POST", "/v1/rebakes?dry_run=1", body, JSON)
        self.assertEqual((dry.status, dry.json["bakes"]), (200, 1))
        batch = d.ask("POST", "/v1/rebakes", body, JSON)
        self.assertEqual((batch.status, batch.json["bakes"]), (202, 1))
        self.assertEqual(len(batch.json["request"]["bakes"]), 100)  # the view shows the first ones
        self.check_growth("one bake")

    def test_20000_bakes_are_planned_one_at_a_time(self):
        d = self.daemon
        hair = d.put(hair_bytes())
        bake = d.ask("POST", "/v1/bakes", quick_request(hair, d.put(hdr_bytes()))).json["id"]
        self.assertEqual(d.wait(bake)["state"], "done")
        d.stop()
        with sqlite3.connect(d.path / "store/hairbake.db") as database:  # posting so many would take minutes
            columns = ", ".join(row[1] for row in database.execute("PRAGMA table_info(bakes)") if row[1] not in ("id", "seq"))
            for number in range(20_000):
                database.execute(f"INSERT INTO bakes(id, {columns}) SELECT ?, {columns} FROM bakes WHERE id = ?", (f"{number:064x}", bake))
            database.execute("UPDATE bakes SET request = json_set(request, '$.strand.time', seq)")  # each another bake
        d.start()
        self.idle = d.memory_kb("VmRSS")
        body = {"environment": f"sha256:{d.put(hdr_bytes(red=7))}", "bakes": [f"{number:064x}" for number in range(20_000)]}
        with ThreadPoolExecutor(1) as pool:
            dry = pool.submit(d.ask, "POST", "/v1/rebakes?dry_run=1", body)
            passed = 0
            while not dry.done():  # others read and write meanwhile
                self.assertEqual(d.ask("GET", "/v1/bakes?limit=1").status, 200)
                self.assertEqual(d.ask("PUT", NAME, {"sha256": hair, "note": str(passed)}).status, 200)
                passed += 1
            self.assertEqual((dry.result().status, dry.result().json["bakes"]), (200, 20_000))
            self.assertGreater(passed, 5)
        reply = d.ask("POST", "/v1/rebakes", body)
        self.assertEqual((reply.status, reply.json["bakes"]), (202, 20_000))
        self.check_growth("20,000 bakes")
        view = d.ask("GET", reply.headers["Location"])
        self.assertLess(len(view.body), 20_000)


    def test_a_name_of_5000_versions_has_a_short_view(self):
        d = self.daemon
        digest = d.put(hair_bytes())
        self.assertEqual(d.ask("PUT", NAME, {"sha256": digest}).status, 200)
        d.stop()
        with sqlite3.connect(d.path / "store/hairbake.db") as database:
            database.executemany("INSERT INTO names(kind, path, version, sha256, note, token, created) VALUES('model', 'x', ?, ?, ?, 't', 0)",
                                 [(number, digest, "n" * 500) for number in range(2, 5001)])
        d.start()
        self.idle = d.memory_kb("VmRSS")
        view = d.ask("GET", NAME).json
        self.assertEqual((view["version"], len(view["versions"]), view["versions"][-1]["version"]), (5000, 500, 4501))
        with ThreadPoolExecutor(AT_ONCE) as pool:
            self.assertEqual(set(pool.map(lambda _: d.ask("GET", NAME).status, range(AT_ONCE))), {200})
        self.check_growth("versions")


class LongLists(Memory):
    """The reply of a list holds text alone, and nothing that it does not show."""
    READERS = 20

    def read_by_many(self, path, name, count):
        self.idle = self.daemon.memory_kb("VmRSS")

        def read(_):
            entries, cursor = [], ""
            while cursor is not None:
                reply = self.daemon.ask("GET", f"{path}?limit=1000" + (f"&cursor={cursor}" if cursor else ""))
                self.assertEqual(reply.status, 200)
                self.assertLess(len(reply.body), 600_000)
                entries += reply.json[name]
                cursor = reply.json["next"]
            return len(entries)
        with ThreadPoolExecutor(self.READERS) as pool:
            self.assertEqual(set(pool.map(read, range(self.READERS * 3))), {count})
        self.check_growth(path)

    def fill(self, statement, rows):
        self.daemon.stop()
        with sqlite3.connect(self.daemon.path / "store/hairbake.db") as database:
            database.executemany(statement, rows)
        self.daemon.start()

    def test_bakes_of_64_lights(self):
        d = self.daemon
        lights = [{"direction": [0.123456789, 1, 0], "irradiance": [1.23456789, 1, 1]}] * 64
        request = quick_request(environment=d.put(hdr_bytes()), irradiance={"face_size": 4, "specular_maps": 3, "lights": lights})
        bake = d.ask("POST", "/v1/bakes", request).json["id"]
        self.assertEqual(d.wait(bake)["state"], "done")
        with sqlite3.connect(d.path / "store/hairbake.db") as database:
            names = ", ".join(row[1] for row in database.execute("PRAGMA table_info(bakes)") if row[1] not in ("id", "seq"))
            self.assertGreater(len(database.execute("SELECT request FROM bakes").fetchone()[0]), 4000)
        self.fill(f"INSERT INTO bakes(id, {names}) SELECT ?, {names} FROM bakes WHERE id = ?",
                  [(f"{number:064x}", bake) for number in range(999)])
        self.read_by_many("/v1/bakes", "bakes", 1000)

    def test_names_with_long_notes(self):
        """Relative: 1,000 entries are more than one page may hold, and the cursor leads through all of them."""
        digest = self.daemon.put(hair_bytes())
        self.fill("INSERT INTO names(kind, path, version, sha256, note, token, created) VALUES('model', ?, 1, ?, ?, 't', 0)",
                  [(f"{number:04}" + "x" * 190, digest, "n" * 500) for number in range(1000)])
        self.read_by_many("/v1/names/model", "names", 1000)

    def test_bakes_of_long_errors(self):
        """Relative: what fails shows its error in the list."""
        d = self.daemon
        bake = d.ask("POST", "/v1/bakes", quick_request(d.put(hair_bytes()))).json["id"]
        self.assertEqual(d.wait(bake)["state"], "done")
        with sqlite3.connect(d.path / "store/hairbake.db") as database:
            names = ", ".join(row[1] for row in database.execute("PRAGMA table_info(bakes)") if row[1] not in ("id", "seq", "error"))
        error = json.dumps({"kind": "internal", "message": "m" * 4000})
        self.fill(f"INSERT INTO bakes(id, error, {names}) SELECT ?, ?, {names} FROM bakes WHERE id = ?",
                  [(f"{number:064x}", error, bake) for number in range(999)])
        self.read_by_many("/v1/bakes", "bakes", 1000)


class HostileWorkers(unittest.TestCase):
    """Relative: what a worker writes is bounded too. The dump of deep values once ended the daemon."""
    RULES = """
*'"seed":21,'*) mkdir "$folder/result"; head -c 400000 /dev/zero | tr '\\0' '[' > "$folder/result/manifest.json"; say '{"done":{}}' ;;
*'"seed":22,'*) mkdir "$folder/result"; head -c 50000000 /dev/zero | tr '\\0' ' ' > "$folder/result/manifest.json"; say '{"done":{}}' ;;
*'"seed":23,'*) say '{"begin":{}}'; say '{"done":'"$(head -c 400000 /dev/zero | tr '\\0' '[')$(head -c 400000 /dev/zero | tr '\\0' ']')"'}'; exit 3 ;;
*'"seed":24,'*) say '{"error":{"kind":"bad_input","message":"'"$(head -c 900000 /dev/zero | tr '\\0' 'x')"'"}}'; exit 1 ;;
"""

    def test_long_and_deep_words_and_manifests_fail_the_stage_alone(self):
        with Daemon(max_crashes=0) as d:
            d.stop()
            d.limits = f'program = "{write_worker(d, self.RULES)}"'
            d.start()
            idle = d.memory_kb("VmRSS")
            hair = d.put(hair_bytes())
            for seed, words in ((21, "manifest is longer than 524288 bytes, or nested deeper than 64 levels"),
                                (22, "manifest is longer than 524288 bytes"), (23, "ended with code 3"), (24, "xxxxxxxxxx...")):
                bake = d.ask("POST", "/v1/bakes", quick_request(hair, transmittance={"seed": seed, "direction_set": "random"})).json["id"]
                view = d.wait(bake)
                self.assertEqual(view["state"], "failed", seed)
                self.assertIn(words, view["error"]["message"], seed)
                self.assertLess(len(json.dumps(view)), 20_000, seed)
            self.assertLessEqual((d.memory_kb("VmHWM") - idle) / 1024, GROWTH_MB)


if __name__ == "__main__":
    unittest.main()
