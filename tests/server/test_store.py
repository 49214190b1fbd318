"""The store: damaged and unreadable files, and the budget."""
import os
import unittest

from harness import TUS, Daemon, hair_bytes, quick_request, sha256


class Blobs(unittest.TestCase):
    """Files of the store that changed behind the daemon's back."""

    def test_bytes_that_rotted_are_replaced_when_they_are_sent_again(self):
        data = hair_bytes()

        def put(d):
            self.assertIn(d.ask("PUT", f"/v1/blobs/{sha256(data)}", data).status, (200, 201))

        def tus(d):
            self.assertEqual(d.append(d.create_upload(data).headers["Location"], 0, data).status, 204)

        def post(d):
            headers = {"Content-Type": "application/octet-stream"}
            self.assertIn(d.ask("POST", "/v1/models", data, headers).status, (200, 201))

        for send in (put, tus, post):
            with Daemon() as d:
                digest = d.put(data)
                d.stop()
                d.blob_file(digest).write_bytes(data[:200] + bytes([data[200] ^ 1]) + data[201:])
                d.start()
                send(d)
                reply = d.ask("GET", f"/v1/blobs/{digest}")
                self.assertEqual((reply.status, reply.body == data), (200, True), send.__name__)
                self.assertEqual(d.leftovers(), [])

    def test_a_model_whose_file_is_another_one_has_no_facts_until_it_is_sent_again(self):
        with Daemon() as d:
            right, wrong = hair_bytes(strands=40, points=10), hair_bytes(strands=20, points=20)
            self.assertEqual(len(right), len(wrong))
            digest = d.put(right)
            d.stop()
            d.blob_file(digest).write_bytes(wrong)
            d.start()
            reply = d.ask("POST", "/v1/models", {"sha256": digest})
            self.assertEqual((reply.status, reply.headers["Content-Type"]), (422, "application/problem+json"), reply.body)
            self.assertIn(f"send the file sha256:{digest} again", reply.json["detail"])
            self.assertEqual(d.ask("GET", f"/v1/models/{digest}").status, 404)
            self.assertEqual(d.ask("HEAD", f"/v1/blobs/{digest}").status, 404)
            self.assertEqual(d.ask("POST", "/v1/models", {"sha256": digest}).status, 422)  # the file must be sent first
            self.assertEqual(d.put(right), digest)
            reply = d.ask("POST", "/v1/models", {"sha256": digest})
            self.assertEqual(reply.status, 201, reply.body)
            self.assertEqual((reply.json["facts"]["strands"], reply.json["facts"]["longest_strand"]), (40, 10))

    def test_a_spoiled_result_whose_input_was_deleted_says_what_to_send(self):
        with Daemon() as d:
            hair = d.put(hair_bytes())
            self.assertEqual(d.ask("POST", "/v1/models", {"sha256": hair}).status, 201)
            bake = d.ask("POST", "/v1/bakes", quick_request(hair)).json["id"]
            file = next(f for f in d.wait(bake)["files"] if f["name"] == "transmittance.npy")
            self.assertEqual(d.ask("DELETE", f"/v1/models/{hair}?force=1").status, 204)
            d.stop()
            stored = d.blob_file(file["sha256"])
            stored.write_bytes(stored.read_bytes()[:-1] + b"!")
            d.start()
            self.assertIn(d.ask("GET", file["href"]).status, (409, 503))
            view = d.wait(bake)
            self.assertEqual((view["state"], view["error"]["kind"]), ("failed", "bad_input"), view)
            self.assertIn("send the input again", view["error"]["message"])
            reply = d.ask("POST", "/v1/bakes", quick_request(hair))
            self.assertEqual((reply.status, reply.json["field"]), (422, "hair"), reply.body)
            self.assertEqual(d.put(hair_bytes()), hair)
            self.assertEqual(d.ask("POST", "/v1/bakes", quick_request(hair)).json["id"], bake)
            self.assertEqual(d.wait(bake)["state"], "done")
            self.assertEqual(sha256(d.ask("GET", file["href"]).body), file["sha256"])

    def test_a_file_that_cannot_be_read_for_a_moment_is_not_forgotten(self):
        for name, hide in self.obstacles().items():
            for verified in (True, False):  # since the start
                with self.subTest(obstacle=name, verified=verified), Daemon() as d:
                    d.become_bound_to_modes()
                    hair = d.put(hair_bytes())
                    bake = d.ask("POST", "/v1/bakes", quick_request(hair)).json["id"]
                    view = d.wait(bake)
                    self.assertEqual(view["state"], "done")
                    result = next(f for f in view["files"] if f["name"] == "transmittance.npy")
                    addresses = {hair: f"/v1/blobs/{hair}", result["sha256"]: result["href"]}
                    d.stop()
                    d.start()
                    for digest, address in addresses.items():
                        if verified:
                            self.assertEqual(d.ask("GET", address).status, 200)
                        show = hide(d.blob_file(digest))
                        reply = d.ask("GET", address)
                        self.assertEqual((reply.status, reply.headers["Content-Type"]), (503, "application/problem+json"))
                        self.assertIn("cannot be read now: Permission denied", reply.json["detail"])
                        self.assertIn("chmod u+rwX", reply.json["detail"])
                        self.assertEqual(d.ask("GET", f"/v1/bakes/{bake}").json["state"], "done")
                        show()
                        reply = d.ask("GET", address)
                        self.assertEqual((reply.status, sha256(reply.body)), (200, digest))
                    self.assertEqual(d.ask("GET", f"/v1/bakes/{bake}").json["stages"], view["stages"])  # nothing ran again

    @staticmethod
    def obstacles():
        """By name, what makes a file unreadable and returns what makes it readable again."""
        def mode(path):
            before = path.stat().st_mode
            path.chmod(0)
            return lambda: path.chmod(before)

        return {"mode": mode, "mode of its folder": lambda file: mode(file.parent)}


class Budget(unittest.TestCase):
    def test_what_is_stored_may_be_sent_to_a_full_store(self):
        with Daemon(config="budget_mb = 1\nblob_mb = 1") as d:
            # 1,048,576 bytes are allowed. These 1,000,000 stay, since names point at them.
            kept = [os.urandom(600_000), os.urandom(400_000)]
            for number, data in enumerate(kept):
                d.ask("PUT", f"/v1/names/mesh/{number}", {"sha256": d.put(data)})
            loose = d.put(b"nothing needs this")
            for data in kept:
                self.assertEqual(d.ask("PUT", f"/v1/blobs/{sha256(data)}", data).status, 200)
                self.assertEqual(d.ask("HEAD", f"/v1/blobs/{loose}").status, 200)  # it was not evicted
            other = os.urandom(600_000)
            self.assertEqual(d.ask("PUT", f"/v1/blobs/{sha256(other)}", other).status, 507)
            for data in kept:
                self.assertEqual(d.ask("GET", f"/v1/blobs/{sha256(data)}").body, data)

    def test_a_body_in_chunks_that_does_not_fit_is_refused(self):
        with Daemon(config="budget_mb = 1\nblob_mb = 1") as d:
            # Of 1,048,576 bytes 600,000 stay: they are an input.
            kept, big, small = os.urandom(600_000), os.urandom(448_577), os.urandom(448_576)
            d.put(kept)
            file = {"Content-Type": "application/octet-stream"}
            for reply in (d.ask("PUT", f"/v1/blobs/{sha256(big)}", iter([big])), d.ask("POST", "/v1/models", iter([big]), file)):
                self.assertEqual((reply.status, reply.json["type"]), (507, "urn:hairbake:problem:full"), reply.body)
                self.assertEqual(d.ask("HEAD", f"/v1/blobs/{sha256(big)}").status, 404)
                self.assertEqual(d.leftovers(), [])
            self.assertEqual(d.ask("PUT", f"/v1/blobs/{sha256(small)}", iter([small])).status, 201)
            self.assertEqual(d.ask("PUT", f"/v1/blobs/{sha256(kept)}", iter([kept])).status, 200)  # stored already: needs no room
            self.assertEqual(d.ask("GET", f"/v1/blobs/{sha256(small)}").body, small)

    def test_an_upload_that_finds_no_room_waits_for_it(self):
        with Daemon(config="budget_mb = 1\nblob_mb = 1") as d:
            data = os.urandom(500_000)
            upload = d.create_upload(data).headers["Location"]
            self.assertEqual(d.append(upload, 0, data[:1000]).status, 204)
            kept = d.put(os.urandom(600_000))  # together more than 1,048,576
            self.assertEqual(d.append(upload, 1000, data[1000:448_576]).status, 204)  # the rest of the room, to the byte
            for _ in range(2):  # before and after a start
                reply = d.append(upload, 448_576, data[448_576:])
                self.assertEqual((reply.status, reply.json["type"]), (507, "urn:hairbake:problem:full"), reply.body)
                self.assertEqual(d.ask("HEAD", upload, headers=TUS).headers["Upload-Offset"], "448576")
                self.assertEqual(d.ask("HEAD", f"/v1/blobs/{kept}").status, 200)
                self.assertEqual(d.leftovers(), [])
                d.stop()
                d.start()
            self.assertEqual(d.ask("DELETE", f"/v1/blobs/{kept}").status, 204)
            reply = d.append(upload, 448_576, data[448_576:])
            self.assertEqual((reply.status, reply.headers["Hairbake-Blob"]), (204, f"/v1/blobs/{sha256(data)}"))
            self.assertEqual(d.ask("GET", f"/v1/blobs/{sha256(data)}").body, data)
            self.assertEqual(d.ask("HEAD", upload, headers=TUS).status, 404)

    def test_results_go_until_three_hundredths_are_free_and_inputs_stay(self):
        with Daemon(config="budget_mb = 1\nblob_mb = 1") as d:
            budget, models, bakes = 1 << 20, [], []
            for seed in range(12):
                models.append(d.put(hair_bytes(strands=4, points=4, seed=seed)))
                bakes.append(d.ask("POST", "/v1/bakes", quick_request(models[-1])).json["id"])
                self.assertEqual(d.wait(bakes[-1])["state"], "done")
            results = [sum(file["bytes"] for file in d.ask("GET", f"/v1/bakes/{bake}").json["files"][1:]) for bake in bakes]
            self.assertGreater(sum(results[1:]), budget // 100 * 3)  # else there is not enough to evict
            d.put(os.urandom(budget - self.stored(d)))  # it fits to the byte: all stay
            self.assertEqual({d.ask("GET", f"/v1/bakes/{bake}").status for bake in bakes}, {200})
            d.put(b"x")
            gone = [size for bake, size in zip(bakes, results) if d.ask("GET", f"/v1/bakes/{bake}").status == 410]
            free = budget - self.stored(d)
            self.assertGreaterEqual(free, budget // 100 * 3)
            self.assertLess(free - max(gone), budget // 100 * 3)  # the last eviction was necessary
            self.assertLess(len(gone), len(bakes))
            for model in models:
                self.assertEqual(d.ask("HEAD", f"/v1/blobs/{model}").status, 200)

    @staticmethod
    def stored(d):
        return sum(file.stat().st_size for file in (d.path / "store/blobs").rglob("*") if file.is_file())

    def test_the_oldest_results_go_first_and_inputs_stay(self):
        with Daemon(config="budget_mb = 1\nblob_mb = 1") as d:
            hair = d.put(hair_bytes())
            bake = d.ask("POST", "/v1/bakes", quick_request(hair)).json["id"]
            self.assertEqual(d.wait(bake)["state"], "done")
            first, second = (d.put(os.urandom(size)) for size in (600_000, 448_576 - len(hair_bytes())))
            self.assertEqual(d.ask("GET", f"/v1/bakes/{bake}").status, 410)  # forgotten
            self.assertEqual([d.ask("HEAD", f"/v1/blobs/{x}").status for x in (hair, first, second)], [200] * 3)
            reply = d.ask("PUT", f"/v1/blobs/{sha256(b'y' * 2_000_000)}", b"y" * 2_000_000)
            self.assertEqual(reply.status, 413)
            reply = d.ask("PUT", f"/v1/blobs/{sha256(b'z')}", b"z")
            self.assertEqual((reply.status, reply.json["type"]), (507, "urn:hairbake:problem:full"))
            self.assertEqual(d.ask("DELETE", f"/v1/blobs/{first}").status, 204)
            self.assertEqual(d.ask("POST", "/v1/bakes", quick_request(hair)).json["id"], bake)  # the same request bakes again
            self.assertEqual(d.wait(bake)["state"], "done")


if __name__ == "__main__":
    unittest.main()
