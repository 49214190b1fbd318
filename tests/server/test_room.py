"""The room of the store: real bytes count, bodies under way are reserved, inputs are never evicted."""
import contextlib
import os
import random
import re
import sqlite3
import threading
import time
import unittest

from harness import PATIENCE, PROGRAMS, TUS, Daemon, base64_text, hair_bytes, hdr_bytes, quick_request, sha256
from test_disk import SmallDisk

BUDGET = 1 << 20
SMALL = "budget_mb = 1\nblob_mb = 2\nkeep_free_mb = 0"
OCTETS = {"Content-Type": "application/octet-stream"}
PATCH = {**TUS, "Content-Type": "application/offset+octet-stream"}


def head(method, path, length, headers=()):
    """A request's head. Without a length the body comes in chunks."""
    size = "Transfer-Encoding: chunked" if length is None else f"Content-Length: {length}"
    lines = [f"{method} {path} HTTP/1.1", "Host: localhost", size, *(f"{k}: {v}" for k, v in dict(headers).items())]
    return ("\r\n".join(lines) + "\r\n\r\n").encode()


def chunk(data):
    return f"{len(data):x}\r\n".encode() + data + b"\r\n"


@contextlib.contextmanager
def under_way(d, begun):
    """A request whose body does not end; it is cut at the end of the block."""
    connection = d.connect()
    try:
        connection.sendall(begun)
        yield connection
    finally:
        connection.close()


def eventually(holds):
    """Waits until `holds()`, for a change that the daemon makes after a connection ended."""
    end = time.monotonic() + PATIENCE
    while not holds():
        if time.monotonic() > end:
            raise AssertionError("it does not happen")
        time.sleep(0.02)


class RoomTest(unittest.TestCase):
    def fill_budget(self, d, stack, kind):
        """Leaves 100 bytes of room, with the usual hair and an input, an upload or a body under way (until `stack` ends).
        Returns the hair's digest, and the path whose DELETE makes room, or None for a body."""
        hair, data = d.put(hair_bytes()), os.urandom(BUDGET - len(hair_bytes()) - 100)
        if kind == "input":
            return hair, f"/v1/blobs/{d.put(data)}"
        if kind == "upload":
            filler = d.create_upload(data + b"the rest").headers["Location"]
            self.assertEqual(d.append(filler, 0, data).status, 204)
            return hair, filler
        stack.enter_context(under_way(d, head("PUT", f"/v1/blobs/{'0' * 64}", len(data)) + data[:-1]))
        eventually(lambda: [f.stat().st_size for f in (d.path / "store/tmp").iterdir()] == [len(data) - 1])
        return hair, None

    def assert_full(self, reply):
        self.assertEqual((reply.status, reply.headers["Content-Type"]), (507, "application/problem+json"), reply.body)
        self.assertEqual(reply.json["type"], "urn:hairbake:problem:full")

    def assert_busy(self, reply):
        """Bodies under way have the room: the client tries again."""
        self.assertEqual((reply.status, reply.json["type"]), (503, "urn:hairbake:problem:busy"), reply.body)
        self.assertGreater(int(reply.headers["Retry-After"]), 0)
        self.assertIn("bodies", reply.json["detail"])

    def assert_refused_before_the_body(self, d, begun, status=507):
        """The reply comes although no byte of the body does."""
        with d.connect() as connection:
            connection.sendall(begun)
            answer = connection.recv(4096)
            self.assertIn(b" %d " % status, answer.splitlines()[0])
            self.assertEqual(b"\r\nretry-after:" in answer.lower(), status == 503)

    @staticmethod
    def stored(d):
        return sum(file.stat().st_size for file in (d.path / "store/blobs").rglob("*") if file.is_file())

    def bake_some(self, d, count):
        """Bakes of one groom with different seeds; their results are different."""
        hair = d.put(hair_bytes())
        bakes = [d.ask("POST", "/v1/bakes", quick_request(hair, transmittance={"seed": seed, "direction_set": "random"})).json["id"]
                 for seed in range(1, count + 1)]
        for bake in bakes:
            self.assertEqual(d.wait(bake)["state"], "done")
        return bakes

    def kept(self, d, bakes):
        return [bake for bake in bakes if d.ask("GET", f"/v1/bakes/{bake}").status == 200]


class RealBytes(RoomTest):
    """Budget: what a client announces evicts nothing; what arrives does."""

    def test_a_length_without_bytes_evicts_no_result(self):
        # Relatives of a PUT: a POST of a model, the creation of an upload, its PATCH, and a body in chunks.
        with Daemon(config=SMALL) as d:
            bakes = self.bake_some(d, 6)
            d.put(os.urandom(BUDGET - self.stored(d) - 1000))  # 1,000 bytes are left
            size = 1000 + self.stored(d) // 100  # it needs some of the results' room
            data = os.urandom(size)
            created = d.create_upload(data)
            self.assertEqual(created.status, 201)
            upload = created.headers["Location"]
            bodies = {"put": head("PUT", f"/v1/blobs/{sha256(data)}", size), "post": head("POST", "/v1/models", size, OCTETS),
                      "patch": head("PATCH", upload, size, {**PATCH, "Upload-Offset": 0}),
                      "chunks": head("PUT", f"/v1/blobs/{sha256(data)}", None)}
            for name, begun in bodies.items():
                with self.subTest(name), under_way(d, begun + data[:500] if name != "chunks" else begun + chunk(data[:500])):
                    eventually(lambda: d.leftovers() or name == "patch")
                    self.assertEqual(self.kept(d, bakes), bakes)
                eventually(lambda: d.leftovers() == [])
            eventually(lambda: d.ask("DELETE", upload, headers=TUS).status == 204)  # 409 while the cut PATCH ends
            self.assertEqual(self.kept(d, bakes), bakes)
            d.put(data)  # the same bytes, when they arrive
            self.assertLess(len(self.kept(d, bakes)), len(bakes))
            self.assertLessEqual(self.stored(d), BUDGET)

    def test_a_body_that_cannot_fit_is_refused_before_it_and_evicts_nothing(self):
        # Relatives of a PUT: a POST of an environment, the creation of an upload, its PATCH.
        with Daemon(config=SMALL) as d:
            upload = d.create_upload(bytes(900_000)).headers["Location"]
            bakes = self.bake_some(d, 3)
            d.put(os.urandom(BUDGET // 2))
            size = 900_000  # more than all results could give
            self.assert_refused_before_the_body(d, head("PUT", f"/v1/blobs/{'0' * 64}", size))
            self.assert_refused_before_the_body(d, head("POST", "/v1/environments", size, OCTETS))
            self.assert_refused_before_the_body(d, head("PATCH", upload, size, {**PATCH, "Upload-Offset": 0}))
            self.assertEqual(d.ask("DELETE", upload, headers=TUS).status, 204)
            self.assert_full(d.create_upload(bytes(size), "0" * 64))
            self.assertEqual(self.kept(d, bakes), bakes)
            self.assertEqual(d.leftovers(), [])

    def test_the_bytes_of_unfinished_uploads_count_also_after_a_start(self):
        with Daemon(config=SMALL) as d:
            data, rest = os.urandom(500_000), os.urandom(BUDGET - 300_000)
            upload = d.create_upload(data).headers["Location"]
            self.assertEqual(d.append(upload, 0, data[:300_000]).status, 204)
            for _ in range(2):
                self.assert_full(d.ask("PUT", f"/v1/blobs/{sha256(rest + b'x')}", rest + b"x"))
                d.stop()
                d.start()
            self.assertEqual(d.ask("PUT", f"/v1/blobs/{sha256(rest)}", rest).status, 201)  # it fits to the byte
            self.assert_full(d.append(upload, 300_000, data[300_000:]))
            self.assertEqual(d.ask("DELETE", upload, headers=TUS).status, 204)
            self.assertEqual(d.put(os.urandom(300_000)) and self.stored(d), BUDGET)  # its bytes went back

    def wait_for_trouble(self, d, bake, *words):
        """The bake waits for room, and its stage says why; /readyz does, too."""
        eventually(lambda: d.ask("GET", f"/v1/bakes/{bake}").json["stages"][0].get("trouble"))
        stage, ready = d.ask("GET", f"/v1/bakes/{bake}").json["stages"][0], d.ask("GET", "/readyz")
        self.assertEqual(ready.status, 503)
        for word in words:
            self.assertIn(word, stage["trouble"])
            self.assertIn(word, ready.json["detail"])

    def test_a_result_that_has_no_room_waits_and_takes_no_input(self):
        # Relatives of a budget that inputs fill: an unfinished upload fills it, and a body under way.
        for name in ("input", "upload", "body"):
            with self.subTest(name), Daemon(config=SMALL) as d, contextlib.ExitStack() as stack:
                hair, filler = self.fill_budget(d, stack, name)
                bake = d.ask("POST", "/v1/bakes", quick_request(hair)).json["id"]
                self.wait_for_trouble(d, bake, "budget_mb")
                self.assertIn(d.ask("GET", f"/v1/bakes/{bake}").json["state"], ("queued", "running"))
                self.assertEqual(d.ask("HEAD", f"/v1/blobs/{hair}").status, 200)
                if name == "input":
                    self.assertEqual(self.stored(d), BUDGET - 100)
                    self.assertEqual(d.ask("DELETE", filler).status, 204)
                elif name == "upload":
                    self.assertEqual(d.ask("DELETE", filler, headers=TUS).status, 204)
                stack.close()
                view = d.wait(bake)
                self.assertEqual((view["state"], view["error"], view["stages"][0]["attempts"]), ("done", None, 1), view)
                eventually(lambda: d.ask("GET", "/readyz").status == 200)

    def test_a_result_that_is_larger_than_the_budget_fails_its_stage_and_the_queue_goes_on(self):
        with Daemon(config=SMALL) as d:
            # 1 + 9 maps of 6 x 48 x 48 texels of 12 bytes are 1.7 MB.
            large = quick_request(environment=d.put(hdr_bytes()), irradiance={"face_size": 48, "specular_maps": 9})
            small = quick_request(d.put(hair_bytes()))
            failed, done = (d.ask("POST", "/v1/bakes", request).json["id"] for request in (large, small))
            view = d.wait(failed)
            self.assertEqual((view["state"], view["error"]["kind"]), ("failed", "out_of_resources"), view)
            self.assertIn("budget_mb is 1;", view["error"]["message"])
            self.assertEqual(d.wait(done)["state"], "done")
            self.assertEqual(d.ask("GET", "/readyz").status, 200)
            self.assertEqual(d.leftovers(), [])

    def test_results_that_a_kill_left_without_references_are_no_inputs(self):
        """A kill can come between the rows of a result's blobs and the row of its stage."""
        with Daemon(config=SMALL) as d:
            sent = d.put(b"sent")
            d.stop()
            data = os.urandom(BUDGET // 2)
            left = sha256(data)
            d.blob_file(left).write_bytes(data)
            with contextlib.closing(sqlite3.connect(d.path / "store/hairbake.db")) as database, database:
                database.execute("INSERT INTO blobs(sha256, bytes, created, used) VALUES(?, ?, 0, 0)", (left, len(data)))
            d.start()
            self.assertEqual([blob["sha256"] for blob in d.ask("GET", "/v1/blobs").json["blobs"]], [sent])
            self.assertEqual(d.ask("HEAD", f"/v1/blobs/{left}").status, 200)
            other = d.put(os.urandom(BUDGET // 2))
            self.assertEqual([d.ask("HEAD", f"/v1/blobs/{x}").status for x in (sent, left, other)], [200, 404, 200])


class Inputs(RoomTest):
    """Budget: an uploaded input is never evicted."""

    def test_inputs_of_every_kind_stay_when_the_store_is_full(self):
        # Hair models, environments, meshes; listed or not, baked or not, named now or by an older version, or sent by tus.
        with Daemon(config=SMALL) as d:
            mesh = b"v 0 0 0\nv 0.1 0 0\nv 0 0.1 0\nf 1 2 3\n"
            inputs = {"baked hair": d.put(hair_bytes()), "baked environment": d.put(hdr_bytes()), "baked mesh": d.put(mesh),
                      "listed hair": d.put(hair_bytes(seed=1)), "listed environment": d.put(hdr_bytes(red=77)),
                      "old version": d.put(b"version 1"), "new version": d.put(b"version 2"), "loose": d.put(b"loose")}
            for digest in ("old version", "new version"):
                d.ask("PUT", "/v1/names/mesh/head", {"sha256": inputs[digest]})
            self.assertEqual(d.ask("POST", "/v1/models", {"sha256": inputs["listed hair"]}).status, 201)
            self.assertEqual(d.ask("POST", "/v1/environments", {"sha256": inputs["listed environment"]}).status, 201)
            upload = d.create_upload(b"by tus").headers["Location"]
            self.assertEqual(d.append(upload, 0, b"by tus").status, 204)
            inputs["by tus"] = sha256(b"by tus")
            request = {**quick_request(inputs["baked hair"], inputs["baked environment"]), "occluder": f"sha256:{inputs['baked mesh']}"}
            bake = d.ask("POST", "/v1/bakes", request).json["id"]
            view = d.wait(bake)
            self.assertEqual(view["state"], "done", view)
            result = next(file for file in view["files"] if file["name"] == "transmittance.npy")
            data = d.ask("GET", result["href"]).body
            inputs["a result that was sent"] = d.put(data)
            while self.stored(d) < BUDGET - 100_000:  # many, so that the order of use does not matter
                inputs[f"filler {len(inputs)}"] = d.put(os.urandom(100_000))
            self.assert_full(d.ask("PUT", f"/v1/blobs/{sha256(bytes(200_000))}", bytes(200_000)))
            self.assertEqual(d.ask("GET", f"/v1/bakes/{bake}").json["state"], "done")  # a refused body evicts nothing
            inputs["last"] = d.put(os.urandom(BUDGET - self.stored(d) + 1))
            self.assertEqual(d.ask("GET", f"/v1/bakes/{bake}").status, 404)  # a result makes room
            for name, digest in inputs.items():
                self.assertEqual(sha256(d.ask("GET", f"/v1/blobs/{digest}").body), digest, name)
            self.assertEqual(d.ask("GET", f"/v1/models/{inputs['listed hair']}/thumbnail.png").status, 200)


class BodiesUnderWay(RoomTest):
    """Bodies under way are reserved against the budget, and what they do not use goes back."""

    def assert_room(self, d, size):
        """A body of the size has room, and one byte more has none. Waits for a cut request to end."""
        def has_room():
            with d.connect() as connection:
                connection.sendall(head("PUT", f"/v1/blobs/{'1' * 64}", size))
                connection.settimeout(0.2)
                try:
                    answer = connection.recv(4096)
                    return b" 507 " not in answer and b" 503 " not in answer
                except TimeoutError:
                    return True  # it waits for the body
        eventually(has_room)
        eventually(lambda: d.leftovers() == [])
        self.assert_refused_before_the_body(d, head("PUT", f"/v1/blobs/{'1' * 64}", size + 1))

    def test_bodies_under_way_together_stay_within_the_budget(self):
        # Relatives: the first body is a PUT, a POST, in chunks, or the PATCH of an upload.
        data = os.urandom(600_000)
        for name in ("put", "post", "chunks", "patch"):
            with self.subTest(name), Daemon(config=SMALL) as d:
                begun = {"put": head("PUT", f"/v1/blobs/{sha256(data)}", len(data)) + data[:10],
                         "post": head("POST", "/v1/models", len(data), OCTETS) + data[:10],
                         "chunks": head("PUT", f"/v1/blobs/{sha256(data)}", None) + chunk(data)}
                if name == "patch":
                    upload = d.create_upload(data).headers["Location"]
                    begun["patch"] = head("PATCH", upload, len(data), {**PATCH, "Upload-Offset": 0}) + data[:10]
                with under_way(d, begun[name]):
                    if name == "patch":
                        # The daemon reads the body. Before, the offset alone is refused, with 409 too.
                        eventually(lambda: "another request is writing" in d.append(upload, 10, b"").json["detail"])
                    else:
                        eventually(lambda: d.leftovers())
                    if name == "chunks":
                        file = d.path / "store/tmp"
                        eventually(lambda: [f.stat().st_size for f in file.iterdir()] == [len(data)])
                    other = os.urandom(600_000)
                    self.assert_refused_before_the_body(d, head("PUT", f"/v1/blobs/{sha256(other)}", len(other)), 503)
                    self.assert_busy(d.ask("PUT", f"/v1/blobs/{sha256(other)}", iter([other])))
                    if name != "patch":  # of one token more than half of the budget is 429
                        self.assert_busy(d.create_upload(other))
                    self.assert_refused_before_the_body(d, head("PUT", f"/v1/blobs/{sha256(other)}", BUDGET + 1))
                    small = os.urandom(BUDGET - len(data) - 1000)
                    if name != "chunks":  # which may be promised up to the next MiB
                        self.assertEqual(d.ask("PUT", f"/v1/blobs/{sha256(small)}", small).status, 201)
                        eventually(lambda: d.ask("DELETE", f"/v1/blobs/{sha256(small)}").status == 204)
                self.assert_room(d, BUDGET - (10 if name == "patch" else 0))  # of a cut upload the bytes that arrived stay

    def test_a_refused_body_is_taken_when_the_other_has_ended(self):
        # Relative: what stays is stored then, and the same request gets 507.
        data, other = os.urandom(600_000), os.urandom(600_000)
        path = f"/v1/blobs/{sha256(other)}"
        with Daemon(config=SMALL) as d:
            with under_way(d, head("PUT", f"/v1/blobs/{sha256(data)}", len(data)) + data[:10]):
                eventually(lambda: d.leftovers())
                self.assert_busy(d.ask("PUT", path, iter([other])))
            eventually(lambda: d.leftovers() == [])
            self.assertEqual(d.ask("PUT", path, other).status, 201)
            self.assertEqual(d.ask("DELETE", path).status, 204)
            d.put(data)
            self.assert_full(d.ask("PUT", path, other))

    def test_all_room_comes_back_after_a_storm_of_bodies(self):
        """Whole, cut, refused and wrong bodies of four clients at once. Afterwards all of the budget is free again."""
        def act(d, dice):
            data = dice.randbytes(dice.randrange(1, 400_000))
            path, half = f"/v1/blobs/{sha256(data)}", data[:len(data) // 2]
            what = dice.choice(("put", "chunks", "wrong", "cut", "cut chunks", "tus", "delete"))
            if what == "put":
                d.ask("PUT", path, data)
            elif what == "chunks":
                d.ask("PUT", path, iter([data]))
            elif what == "wrong":
                d.ask("PUT", f"/v1/blobs/{'0' * 64}", data)
            elif what == "cut":
                with under_way(d, head("PUT", path, len(data)) + half):
                    pass
            elif what == "cut chunks":
                with under_way(d, head("PUT", path, None) + chunk(half)):
                    pass
            elif what == "tus" and (upload := d.create_upload(data).headers["Location"]):
                with under_way(d, head("PATCH", upload, len(data), {**PATCH, "Upload-Offset": 0}) + half):
                    pass
                if dice.random() < 0.7:
                    eventually(lambda: d.ask("DELETE", upload, headers=TUS).status == 204)
            elif what == "delete":
                for blob in d.ask("GET", "/v1/blobs?limit=2").json["blobs"]:
                    d.ask("DELETE", blob["links"]["self"])
            return what

        def storm(d, seed, done, faults):
            dice = random.Random(seed)
            for _ in range(25):
                try:
                    done.append(act(d, dice))
                except ConnectionError:  # a body that is refused may end with a reset
                    pass
                except Exception as fault:
                    faults.append(fault)

        with Daemon(config=SMALL) as d:
            done, faults = [], []
            threads = [threading.Thread(target=storm, args=(d, seed, done, faults)) for seed in range(4)]
            for thread in threads:
                thread.start()
            for thread in threads:
                thread.join()
            self.assertEqual(faults, [])
            self.assertEqual(len(set(done)), 7)  # every action at least once
            self.assertLessEqual(self.stored(d), BUDGET)
            for file in (d.path / "store/uploads").iterdir():
                eventually(lambda: d.ask("DELETE", f"/v1/uploads/{file.name}", headers=TUS).status == 204)
            for blob in d.ask("GET", "/v1/blobs?limit=1000").json["blobs"]:
                self.assertEqual(d.ask("DELETE", blob["links"]["self"]).status, 204)
            self.assert_room(d, BUDGET)

    def test_what_is_stored_needs_no_room_when_it_is_sent_again(self):
        with Daemon(config=SMALL) as d:
            data = os.urandom(BUDGET)
            digest = d.put(data)
            with under_way(d, head("PUT", f"/v1/blobs/{digest}", len(data)) + data[:10]):
                eventually(lambda: d.leftovers())
                self.assertEqual(d.ask("PUT", f"/v1/blobs/{digest}", data).status, 200)
                self.assertEqual(d.ask("PUT", f"/v1/blobs/{digest}", iter([data])).status, 200)
                upload = d.create_upload(data)
                self.assertEqual(upload.status, 201)
                self.assertEqual(d.append(upload.headers["Location"], 0, data).status, 204)

    def test_a_blob_that_is_deleted_while_it_is_sent_again_needs_room(self):
        with Daemon(config=SMALL) as d:
            data = os.urandom(600_000)
            digest = d.put(data)
            with under_way(d, head("PUT", f"/v1/blobs/{digest}", len(data)) + data[:10]) as connection:
                eventually(lambda: d.leftovers())
                self.assertEqual(d.ask("DELETE", f"/v1/blobs/{digest}").status, 204)
                other = d.put(os.urandom(600_000))
                connection.sendall(data[10:])
                self.assertIn(b" 507 ", connection.recv(4096).splitlines()[0])
            self.assertEqual([d.ask("HEAD", f"/v1/blobs/{x}").status for x in (digest, other)], [404, 200])


class KeepFree(RoomTest):
    """The disk: bodies leave keep_free_mb free, and those under way are reserved."""

    @staticmethod
    def free(d):
        disk = os.statvfs(d.inside)
        return disk.f_bavail * disk.f_frsize

    def test_bodies_leave_room_on_the_disk(self):
        # Relatives of a PUT: the creation of an upload, a body in chunks, and a blob that is stored already.
        with SmallDisk(config="keep_free_mb = 2") as d:
            known = os.urandom(1_500_000)
            d.put(known)
            too_long = self.free(d) - (2 << 20) + 1
            self.assertGreater(too_long, 1_500_000)
            self.assert_refused_before_the_body(d, head("PUT", f"/v1/blobs/{'0' * 64}", too_long))
            self.assert_full(d.create_upload(bytes(too_long), "0" * 64))
            half = too_long // 2 + 1
            with under_way(d, head("PUT", f"/v1/blobs/{'0' * 64}", half)):
                eventually(lambda: d.leftovers())
                self.assert_refused_before_the_body(d, head("PUT", f"/v1/blobs/{'1' * 64}", half), 503)
                self.assert_refused_before_the_body(d, head("PUT", f"/v1/blobs/{'1' * 64}", too_long))
            eventually(lambda: d.leftovers() == [])
            data = os.urandom(too_long + (1 << 20))
            self.assert_full(d.ask("PUT", f"/v1/blobs/{sha256(data)}", iter([data[i:i + 65536] for i in range(0, len(data), 65536)])))
            self.assertEqual(d.leftovers(), [])
            d.fill(leave=(2 << 20) + 1_000_000)
            self.assert_refused_before_the_body(d, head("PUT", f"/v1/blobs/{sha256(known)}", len(known)))
            self.assertEqual(d.ask("PUT", f"/v1/blobs/{sha256(b'small')}", b"small").status, 201)
            d.free_filler()
            self.assertEqual(d.ask("PUT", f"/v1/blobs/{sha256(known)}", known).status, 200)

    def test_a_disk_that_fills_up_while_a_body_is_under_way_stops_it(self):
        with SmallDisk(config="keep_free_mb = 2") as d:
            data = os.urandom(2_000_000)
            upload = d.create_upload(data).headers["Location"]
            with under_way(d, head("PATCH", upload, len(data), {**PATCH, "Upload-Offset": 0}) + data[:1000]) as connection:
                eventually(lambda: (d.inside / "uploads" / upload.rpartition("/")[2]).stat().st_size == 1000)
                d.fill(leave=2 << 20)
                connection.sendall(data[1000:])
                self.assertIn(b" 507 ", connection.recv(4096).splitlines()[0])
            d.free_filler()
            offset = int(d.ask("HEAD", upload, headers=TUS).headers["Upload-Offset"])
            self.assertGreaterEqual(offset, 1000)
            self.assertEqual(d.append(upload, offset, data[offset:]).status, 204)

    def test_a_disk_that_is_smaller_than_the_budget_is_told_at_the_start(self):
        with SmallDisk(config="keep_free_mb = 0") as d:
            log = (d.path / "log").read_text()
            self.assertIn("budget_mb is 204800; the disk of", log)
        for config, told in (("budget_mb = 6\nkeep_free_mb = 1", False), ("budget_mb = 6\nkeep_free_mb = 3", True)):  # of 8 MB
            with SmallDisk(config=config) as d:
                self.assertEqual("budget_mb is 6; the disk of" in (d.path / "log").read_text(), told, config)

    def test_inputs_that_alone_exceed_the_budget_are_told(self):
        """Fault: nothing said so at the start. Relatives: /readyz says it, too, until inputs are deleted; results do not
        count, and a disk that is smaller than the budget is told there."""
        with Daemon(config="keep_free_mb = 0\nbudget_mb = 3") as d:
            for digest in [d.put(os.urandom(1 << 20)) for _ in range(2)]:
                last = digest
            self.bake_some(d, 2)
            self.assertEqual(d.ask("GET", "/readyz").json, {"status": "ready"})
            d.stop()
            d.config = SMALL
            d.start()
            told = "inputs have 21"
            d.wait_for_log("which are 1048576 bytes: inputs are never evicted")
            warnings = d.ask("GET", "/readyz").json["warnings"]
            self.assertEqual(len(warnings), 1)
            self.assertIn(told, warnings[0])
            self.assertIn("budget_mb is 1, which are 1048576 bytes: inputs are never evicted, so uploads are refused and no result "
                          "can be stored. Delete inputs (GET /v1/blobs lists them), or raise budget_mb to more than 3", warnings[0])
            self.assertEqual(d.ask("DELETE", f"/v1/blobs/{last}").status, 204)
            self.assertEqual(len(d.ask("GET", "/readyz").json["warnings"]), 1)  # the others exceed it still
            for blob in d.ask("GET", "/v1/blobs?unneeded=1").json["blobs"]:
                self.assertEqual(d.ask("DELETE", f"/v1/blobs/{blob['sha256']}").status, 204)
            self.assertEqual(d.ask("GET", "/readyz").json, {"status": "ready"})
        with SmallDisk(config="keep_free_mb = 0") as d:
            self.assertIn("budget_mb is 204800; the disk of", d.ask("GET", "/readyz").json["warnings"][0])


class Waiting(RoomTest):
    """Results that find no room in the budget. The worker counts its runs."""

    @staticmethod
    def troubles(d):
        """How often the machine kept a stage from running."""
        return int(re.search(r"hairbake_machine_troubles (\d+)", d.ask("GET", "/metrics").body.decode())[1])

    @staticmethod
    def counting(d):
        """Starts the daemon with a worker that writes a line into a file each time it bakes."""
        runs = d.path / "runs"
        runs.write_text("")
        program = d.path / "worker"
        program.write_text(f"""#!/bin/sh
for folder; do :; done
grep -q '"task":"bake"' "$folder/task.json" && echo run >> {runs}
exec {PROGRAMS / "hairbake-worker"} "$@"
""")
        program.chmod(0o755)
        d.stop()
        d.limits = f'program = "{program}"'
        d.start()
        return lambda: len(runs.read_text().splitlines())

    def test_a_result_without_room_is_baked_once_until_there_is_room(self):
        """Fault: each try baked again. Relatives: an input fills the budget, an unfinished upload, a body under way."""
        for name in ("input", "upload", "body"):
            with self.subTest(name), Daemon(config=SMALL) as d, contextlib.ExitStack() as stack:
                runs = self.counting(d)
                hair, filler = self.fill_budget(d, stack, name)
                bake = d.ask("POST", "/v1/bakes", quick_request(hair)).json["id"]
                eventually(lambda: self.troubles(d) >= 3)
                self.assertEqual(runs(), 1)
                eventually(lambda: "budget" in d.ask("GET", f"/v1/bakes/{bake}").json["stages"][0].get("trouble", ""))
                if name != "body":
                    self.assertEqual(d.ask("DELETE", filler, headers=TUS).status, 204)
                stack.close()
                view = d.wait(bake)
                self.assertEqual((view["state"], view["stages"][0]["attempts"]), ("done", 1), view)
                self.assertEqual(runs(), 2)

    def test_relative_a_result_without_room_on_the_disk(self):
        with SmallDisk() as d:
            runs = self.counting(d)
            # (33 + 1) maps of 6 x 48 x 48 texels of 12 bytes are 5.6 MB: more than is left, less than the disk.
            request = quick_request(environment=d.put(hdr_bytes()), irradiance={"face_size": 48, "specular_maps": 33})
            d.fill(leave=1 << 20)
            bake = d.ask("POST", "/v1/bakes", request).json["id"]
            eventually(lambda: self.troubles(d) >= 3)
            self.assertEqual(runs(), 1)
            self.assertIn(f"in {d.store}/tmp: No space left on device. Make room on its disk", d.ask("GET", "/readyz").json["detail"])
            os.truncate(d.inside / "filler", (d.inside / "filler").stat().st_size - (1 << 20))  # too little: one more try
            eventually(lambda: runs() == 2)
            seen = self.troubles(d)
            eventually(lambda: self.troubles(d) > seen)
            d.free_filler()
            view = d.wait(bake)
            self.assertEqual((view["state"], view["stages"][0]["attempts"]), ("done", 1), view)
            self.assertEqual(runs(), 3)

    def test_a_result_that_never_fits_beside_its_inputs_fails_with_the_numbers(self):
        """Fault: it waited for ever. Relative: the result of another stage of the same bake takes the room."""
        with Daemon(config=SMALL) as d:
            hair = d.put(hair_bytes(strands=4000))  # 480 kB; 1 + 6 maps of 6 x 32 x 32 texels of 12 bytes are 516 kB
            request = quick_request(hair, d.put(hdr_bytes()), irradiance={"face_size": 32, "specular_maps": 6})
            view = d.wait(d.ask("POST", "/v1/bakes", request).json["id"])
            self.assertEqual((view["state"], view["error"]["kind"]), ("failed", "out_of_resources"), view)
            self.assertRegex(view["error"]["message"], r"the result of \d+ bytes, and inputs and other results of the same bake of "
                             r"\d+ bytes, are together \d+ bytes, more than the whole store may be: budget_mb is 1; ask for a "
                             "smaller result, or raise budget_mb")
            result, beside, both = map(int, re.findall(r"(\d+) bytes", view["error"]["message"]))
            self.assertEqual(result + beside, both)
            self.assertGreater(both, BUDGET)
            self.assertLess(max(result, beside), BUDGET)
            self.assertGreaterEqual(beside, len(hair_bytes(strands=4000)) + len(hdr_bytes()))
            self.assertEqual(d.ask("GET", "/readyz").status, 200)
            self.assertEqual(d.leftovers(), [])

    def test_relative_a_result_that_fits_when_other_inputs_go_waits(self):
        with Daemon(config=SMALL) as d:
            other = d.put(os.urandom(600_000))
            request = quick_request(environment=d.put(hdr_bytes()), irradiance={"face_size": 32, "specular_maps": 6})
            bake = d.ask("POST", "/v1/bakes", request).json["id"]
            eventually(lambda: self.troubles(d) >= 2)
            self.assertIn(d.ask("GET", f"/v1/bakes/{bake}").json["state"], ("queued", "running"))
            self.assertEqual(d.ask("DELETE", f"/v1/blobs/{other}").status, 204)
            self.assertEqual(d.wait(bake)["state"], "done")


if __name__ == "__main__":
    unittest.main()
