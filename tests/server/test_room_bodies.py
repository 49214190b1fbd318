"""The room of the store: bodies under way are reserved."""
import os
import random
import threading
import unittest

from harness import TUS, Daemon, sha256
from rooms import BUDGET, OCTETS, PATCH, SMALL, RoomTest, chunk, eventually, head, under_way


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


if __name__ == "__main__":
    unittest.main()
