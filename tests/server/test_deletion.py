"""Deletions of inputs: what refers to them is listed, and nothing that another needs goes."""
import contextlib
import sqlite3
import unittest

from harness import Daemon, hair_bytes, hdr_bytes, quick_request, sha256, slow_request

MESH = b"v 0 0 0\nv 0.1 0 0\nv 0 0.1 0\nf 1 2 3\n"


class Deletion(unittest.TestCase):
    def bake(self, d, request):
        reply = d.ask("POST", "/v1/bakes", request)
        self.assertIn(reply.status, (200, 202), reply.body)
        view = d.wait(reply.json["id"])
        self.assertEqual(view["state"], "done", view)
        return view

    def assert_needed(self, reply, bakes=(), names=(), field="force"):
        """409 with the list; `names` are (kind, path, version)."""
        self.assertEqual((reply.status, reply.json["type"]), (409, "urn:hairbake:problem:conflict"), reply.body)
        self.assertEqual(reply.json.get("field"), field)
        needed = reply.json["needed_by"]
        self.assertEqual({bake["id"] for bake in needed["bakes"]["first"]}, set(bakes))
        self.assertEqual([(n["kind"], n["path"], n["version"]) for n in needed["names"]["first"]], list(names))
        self.assertEqual((needed["bakes"]["count"], needed["names"]["count"]), (len(bakes), len(names)))

    def assert_files(self, d, view):
        for file in view["files"][1:]:
            self.assertEqual(sha256(d.ask("GET", file["href"]).body), file["sha256"])

    def test_an_input_of_done_bakes_is_deleted_by_force_alone(self):
        # Relatives of a hair model: an environment, an occluder and a receiver; a bake of a batch refers, too.
        with Daemon() as d:
            hair, sky, dusk, occluder, receiver = (d.put(data) for data in (hair_bytes(), hdr_bytes(), hdr_bytes(red=99), MESH,
                                                                           MESH + b"\n"))
            for path, digest in (("models", hair), ("environments", sky)):
                self.assertEqual(d.ask("POST", f"/v1/{path}", {"sha256": digest}).status, 201)
            bake = self.bake(d, {**quick_request(hair, sky), "occluder": f"sha256:{occluder}", "receiver": f"sha256:{receiver}"})
            alone = self.bake(d, quick_request(hair))
            batch = d.ask("POST", "/v1/rebakes", {"environment": f"sha256:{dusk}", "bakes": [bake["id"]]}).json
            again = d.ask("GET", batch["links"]["bakes"]).json["bakes"][0]["id"]
            self.assertEqual(d.wait(again)["state"], "done")
            needed_by = {f"/v1/models/{hair}": (bake["id"], alone["id"], again), f"/v1/environments/{sky}": (bake["id"],),
                         f"/v1/blobs/{occluder}": (bake["id"], again), f"/v1/blobs/{receiver}": (bake["id"], again),
                         f"/v1/blobs/{dusk}": (again,)}
            for path, bakes in needed_by.items():
                for query in ("", "?force=0"):
                    self.assert_needed(d.ask("DELETE", path + query), bakes)
                self.assertEqual(d.ask("GET", path).status, 200)
            for path in needed_by:
                self.assertEqual(d.ask("DELETE", path + "?force=1").status, 204, path)
                self.assertEqual(d.ask("GET", path).status, 404)
            for digest in (hair, sky, dusk, occluder, receiver):
                self.assertEqual(d.ask("HEAD", f"/v1/blobs/{digest}").status, 404)
            self.assert_files(d, bake)
            self.assertEqual(d.ask("POST", "/v1/bakes", quick_request(hair)).json["id"], alone["id"])

    def test_a_flag_of_the_query_is_0_or_1(self):
        # Relatives of force: dry_run and unneeded, and force of each kind of input.
        with Daemon() as d:
            hair, sky = d.put(hair_bytes()), d.put(hdr_bytes())
            for path, digest in (("models", hair), ("environments", sky)):
                self.assertEqual(d.ask("POST", f"/v1/{path}", {"sha256": digest}).status, 201)
            bake = self.bake(d, quick_request(hair, sky))
            rebake = {"environment": f"sha256:{d.put(hdr_bytes(red=99))}", "bakes": [bake["id"]]}
            cases = (("DELETE", f"/v1/blobs/{hair}", "force", None), ("DELETE", f"/v1/models/{hair}", "force", None),
                     ("DELETE", f"/v1/environments/{sky}", "force", None), ("POST", "/v1/rebakes", "dry_run", rebake),
                     ("GET", "/v1/blobs", "unneeded", None))
            for method, path, name, body in cases:
                for value in ("false", "no", "", "true", "01", "2"):
                    with self.subTest(path=path, name=name, value=value):
                        reply = d.ask(method, f"{path}?{name}={value}", body)
                        self.assertEqual((reply.status, reply.json.get("field")), (422, name), reply.body)
                        self.assertIn(f'{name} is "{value}"; allowed are 0 and 1', reply.json["detail"])
            self.assertEqual(len(d.ask("GET", "/v1/bakes").json["bakes"]), 1)
            self.assertEqual([d.ask("HEAD", f"/v1/blobs/{digest}").status for digest in (hair, sky)], [200, 200])
            self.assertEqual(d.ask("POST", "/v1/rebakes?dry_run=1", rebake).status, 200)
            self.assertEqual(d.ask("POST", "/v1/rebakes?dry_run=0", rebake).status, 202)

    def test_an_input_that_any_version_of_a_name_means_is_deleted_by_force_alone(self):
        # Relatives: the newest version, an older one, two names, and names of a mesh.
        with Daemon() as d:
            first, second, mesh = d.put(hdr_bytes()), d.put(hdr_bytes(red=99)), d.put(MESH)
            for digest in (first, second):
                self.assertEqual(d.ask("POST", "/v1/environments", {"sha256": digest}).status, 201)
                d.ask("PUT", "/v1/names/environment/stage1/sunset", {"sha256": digest})
            d.ask("PUT", "/v1/names/environment/b", {"sha256": second})
            d.ask("PUT", "/v1/names/mesh/head", {"sha256": mesh})
            lists = {f"/v1/environments/{first}": [("environment", "stage1/sunset", 1)],
                     f"/v1/environments/{second}": [("environment", "b", 1), ("environment", "stage1/sunset", 2)],
                     f"/v1/blobs/{mesh}": [("mesh", "head", 1)]}
            for path, names in lists.items():
                self.assert_needed(d.ask("DELETE", path), names=names)
                self.assertEqual(d.ask("GET", path).status, 200)
                self.assertEqual(d.ask("DELETE", path + "?force=1").status, 204)
                self.assertEqual(d.ask("HEAD", f"/v1/blobs/{path.rpartition('/')[2]}").status, 404)
            reply = d.ask("POST", "/v1/bakes", {**quick_request(), "environment": "name:stage1/sunset"})
            self.assertEqual((reply.status, reply.json["field"]), (422, "environment"))
            self.assertEqual(len(d.ask("GET", "/v1/names/environment/stage1/sunset").json["versions"]), 2)  # versions stay
            d.put(hdr_bytes(red=99))
            self.bake(d, {**quick_request(), "environment": "name:stage1/sunset"})

    def test_the_list_is_bounded(self):
        with Daemon() as d:
            sky = d.put(hdr_bytes())
            self.assertEqual(d.ask("POST", "/v1/environments", {"sha256": sky}).status, 201)
            for number in range(23):
                d.ask("PUT", f"/v1/names/environment/n{number}", {"sha256": sky})
            bake = self.bake(d, quick_request(environment=sky))["id"]
            d.stop()
            bakes = [bake, *(sha256(str(n).encode()) for n in range(21))]
            with contextlib.closing(sqlite3.connect(d.path / "store/hairbake.db")) as database, database:
                columns = "state, request, names, hair, environment, priority, attempts, error, created, finished"
                for twin in bakes[1:]:  # as if it had other outputs
                    database.execute(f"INSERT INTO bakes(id, {columns}) SELECT ?, {columns} FROM bakes WHERE id = ?", (twin, bake))
                    database.execute("INSERT INTO bake_stages(bake, kind, stage) SELECT b.seq, m.kind, m.stage FROM bakes b, "
                                     "bake_stages m WHERE b.id = ? AND m.bake = (SELECT seq FROM bakes WHERE id = ?)", (twin, bake))
            d.start()
            needed = d.ask("DELETE", f"/v1/environments/{sky}").json["needed_by"]
            self.assertEqual((needed["bakes"]["count"], needed["names"]["count"]), (22, 23))
            self.assertEqual([b["id"] for b in needed["bakes"]["first"]], bakes[:1:-1])  # the newest 20
            self.assertEqual([n["path"] for n in needed["names"]["first"]], [f"n{n}" for n in range(22, 2, -1)])

    def test_an_entry_of_one_kind_leaves_what_another_kind_needs(self):
        # Relatives of a model whose file a mesh's name means: an environment and a model's name, and no name but an older version.
        with Daemon() as d:
            for path, kind, other, data in (("models", "model", "mesh", hair_bytes()),
                                            ("environments", "environment", "model", hdr_bytes())):
                digest = d.put(data)
                self.assertEqual(d.ask("POST", f"/v1/{path}", {"sha256": digest}).status, 201)
                d.ask("PUT", f"/v1/names/{other}/x", {"sha256": digest})
                d.ask("PUT", f"/v1/names/{other}/x", {"sha256": d.put(b"newer")})
                self.assert_needed(d.ask("DELETE", f"/v1/{path}/{digest}"), names=[(other, "x", 1)])
                self.assertEqual(d.ask("DELETE", f"/v1/{path}/{digest}?force=1").status, 204)
                self.assertEqual(d.ask("GET", f"/v1/{path}/{digest}").status, 404)
                self.assertEqual(d.ask("GET", f"/v1/blobs/{digest}").body, data)  # the name means it
                self.assertEqual(d.ask("DELETE", f"/v1/blobs/{digest}").status, 409)
                self.assertEqual(d.ask("DELETE", f"/v1/blobs/{digest}?force=1").status, 204)
                self.assertEqual(d.ask("GET", f"/v1/blobs/{digest}").status, 404)

    def test_what_nothing_refers_to_goes_at_once_with_its_thumbnail(self):
        with Daemon() as d:
            hair, mesh = d.put(hair_bytes()), d.put(MESH)
            self.assertEqual(d.ask("POST", "/v1/models", {"sha256": hair}).status, 201)
            for path in (f"/v1/models/{hair}", f"/v1/blobs/{mesh}"):
                self.assertEqual(d.ask("DELETE", path).status, 204)
                self.assertEqual(d.ask("DELETE", path).status, 404)
            self.assertEqual([f for f in (d.path / "store/blobs").rglob("*") if f.is_file()], [])

    def test_the_files_that_clients_sent_are_listed(self):
        # Relatives: results and thumbnails are not; with unneeded, neither is what a bake, a name or a list needs.
        with Daemon() as d:
            hair, sky, mesh, listed, loose = (d.put(data) for data in (hair_bytes(), hdr_bytes(), MESH, hair_bytes(seed=1), b"loose"))
            broken = d.put(b"no hair model")
            self.assertEqual(d.wait(d.ask("POST", "/v1/bakes", quick_request(broken)).json["id"])["state"], "failed")
            self.assertEqual(d.ask("POST", "/v1/models", {"sha256": listed}).status, 201)
            d.ask("PUT", "/v1/names/mesh/head", {"sha256": mesh})
            self.bake(d, quick_request(hair, sky))
            everything = sorted((hair, sky, mesh, listed, loose, broken))
            found, cursor = [], ""
            while cursor is not None:
                page = d.ask("GET", f"/v1/blobs?limit=4&cursor={cursor}").json
                found += page["blobs"]
                cursor = page["next"]
            self.assertEqual([blob["sha256"] for blob in found], everything)
            self.assertEqual({blob["sha256"] for blob in found if blob["kind"] == "model"}, {listed})
            self.assertEqual({blob["bytes"] for blob in found if blob["sha256"] == mesh}, {len(MESH)})
            unneeded = [blob["sha256"] for blob in d.ask("GET", "/v1/blobs?unneeded=1").json["blobs"]]
            self.assertEqual(unneeded, sorted((loose, broken)))
            for digest in unneeded:
                self.assertEqual(d.ask("DELETE", f"/v1/blobs/{digest}").status, 204)
            self.assertEqual(d.ask("GET", "/v1/blobs?unneeded=1").json, {"blobs": [], "next": None})

    def test_a_live_bake_keeps_its_inputs_also_against_force(self):
        # Relatives: a listed model, a mesh alone, and a bake that waits.
        with Daemon() as d:
            hair, mesh = d.put(hair_bytes(strands=2000, points=60)), d.put(MESH)
            self.assertEqual(d.ask("POST", "/v1/models", {"sha256": hair}).status, 201)
            running = d.ask("POST", "/v1/bakes", slow_request(hair)).json["id"]
            d.wait_for_worker()
            waiting = d.ask("POST", "/v1/bakes", {**slow_request(hair, seed=2), "occluder": f"sha256:{mesh}"}).json["id"]
            for path, bakes in ((f"/v1/models/{hair}", (running, waiting)), (f"/v1/blobs/{mesh}", (waiting,))):
                for query in ("", "?force=1"):
                    self.assert_needed(d.ask("DELETE", path + query), bakes, field=None)
            for bake in (waiting, running):
                self.assertEqual(d.ask("DELETE", f"/v1/bakes/{bake}").status, 200)
            for path in (f"/v1/models/{hair}", f"/v1/blobs/{mesh}"):
                self.assertEqual(d.ask("DELETE", path).status, 204)  # cancelled bakes need nothing

    def test_a_file_that_is_not_an_input_alone_is_not_deleted_as_a_blob(self):
        # A listed model, a thumbnail, a result; a result that was sent stays as a result.
        with Daemon() as d:
            hair = d.put(hair_bytes())
            self.assertEqual(d.ask("POST", "/v1/models", {"sha256": hair}).status, 201)
            thumbnail = sha256(d.ask("GET", f"/v1/models/{hair}/thumbnail.png").body)
            view = self.bake(d, quick_request(hair))
            result = next(file for file in view["files"] if file["name"] == "transmittance.npy")
            for digest, words in ((hair, f"DELETE /v1/models/{hair}"), (thumbnail, "thumbnail"), (result["sha256"], "result")):
                reply = d.ask("DELETE", f"/v1/blobs/{digest}?force=1")
                self.assertEqual((reply.status, reply.json["type"]), (409, "urn:hairbake:problem:conflict"), reply.body)
                self.assertIn(words, reply.json["detail"])
            d.put(d.ask("GET", result["href"]).body)
            self.assertEqual(d.ask("DELETE", f"/v1/blobs/{result['sha256']}").status, 204)
            self.assertEqual(d.ask("DELETE", f"/v1/blobs/{result['sha256']}").status, 409)  # a result alone again
            self.assert_files(d, view)
            self.assertEqual(d.ask("DELETE", f"/v1/blobs/{'0' * 64}").status, 404)
            self.assertEqual(d.ask("DELETE", "/v1/blobs/x").status, 422)

    def test_the_end_of_a_bake_leaves_the_stages_that_another_shares(self):
        # Relatives: a bake that is done, and a name: neither is deleted at all.
        with Daemon() as d:
            hair, sky, dusk = d.put(hair_bytes(strands=2000, points=60)), d.put(hdr_bytes()), d.put(hdr_bytes(red=99))
            first, second = (d.ask("POST", "/v1/bakes", {**slow_request(hair), "environment": f"sha256:{x}"}).json for x in (sky, dusk))
            self.assertEqual(first["stages"][0]["key"], second["stages"][0]["key"])
            worker = d.wait_for_worker()
            self.assertEqual(d.ask("DELETE", f"/v1/bakes/{first['id']}").status, 200)
            self.assertEqual(d.ask("GET", f"/v1/bakes/{second['id']}").json["stages"][0]["state"], "running")
            self.assertIn(worker, d.workers_running())
            self.assertEqual(d.ask("DELETE", f"/v1/bakes/{second['id']}").status, 200)
            d.wait_for_worker(running=False)
            view = self.bake(d, quick_request(environment=sky))
            self.assertEqual(d.ask("DELETE", f"/v1/bakes/{view['id']}").status, 409)
            d.ask("PUT", "/v1/names/environment/sky", {"sha256": sky})
            self.assertEqual(d.ask("DELETE", "/v1/names/environment/sky").status, 405)
            self.assert_files(d, view)


if __name__ == "__main__":
    unittest.main()
