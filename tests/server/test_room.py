"""The room of the store: real bytes count, and inputs are never evicted."""
import contextlib
import os
import sqlite3
import unittest

from harness import TUS, Daemon, hair_bytes, hdr_bytes, quick_request, sha256
from rooms import BUDGET, OCTETS, PATCH, SMALL, RoomTest, chunk, eventually, head, under_way


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
            self.assertEqual(d.ask("GET", f"/v1/bakes/{bake}").status, 410)  # a result makes room
            for name, digest in inputs.items():
                self.assertEqual(sha256(d.ask("GET", f"/v1/blobs/{digest}").body), digest, name)
            self.assertEqual(d.ask("GET", f"/v1/models/{inputs['listed hair']}/thumbnail.png").status, 200)


if __name__ == "__main__":
    unittest.main()
