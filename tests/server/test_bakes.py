"""Bakes, batches, names and inputs through the real daemon."""
import json
import math
import sqlite3
import subprocess
import tempfile
import time
import unittest
from pathlib import Path

from harness import PATIENCE, PROGRAMS, Daemon, hair_bytes, hdr_bytes, quick_request, sha256, slow_request


class Bakes(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.daemon = Daemon().__enter__()
        cls.hair, cls.sky = cls.daemon.put(hair_bytes()), cls.daemon.put(hdr_bytes())

    @classmethod
    def tearDownClass(cls):
        cls.daemon.__exit__()

    def post(self, request, status=202):
        reply = self.daemon.ask("POST", "/v1/bakes", request)
        self.assertEqual(reply.status, status, reply.body)
        return reply

    def bake(self, request):
        reply = self.daemon.ask("POST", "/v1/bakes", request)
        self.assertIn(reply.status, (200, 202), reply.body)  # 200: its stages are stored
        view = self.daemon.wait(reply.json["id"])
        self.assertEqual(view["state"], "done", view)
        return view

    def test_gives_the_same_files_as_the_command_line(self):
        view = self.bake(quick_request(self.hair, self.sky))
        with tempfile.TemporaryDirectory() as folder:
            hair, sky, out = (Path(folder) / name for name in ("groom.hair", "sky.hdr", "out"))
            hair.write_bytes(hair_bytes())
            sky.write_bytes(hdr_bytes())
            subprocess.run([PROGRAMS / "hairbake", "bake", "--hair", hair, "--env", sky, "--out", out, "--directions", "16",
                            "--voxels", "32", "--face-size", "4", "--specular-maps", "3", "--outputs", "npy",
                            "--set", "transmittance.reference_vertices=0"], check=True, capture_output=True)
            manifest = json.loads((out / "manifest.json").read_text())
            self.assertEqual(view["id"], manifest["id"])
            ours = json.loads(self.daemon.file(view["id"], "manifest.json"))
            self.assertEqual(ours["stages"], manifest["stages"])
            for block in ("transmittance", "irradiance", "repairs", "warnings", "conventions", "versions"):
                self.assertEqual(ours[block], manifest[block], block)
            for field, facts in manifest["inputs"].items():  # the service has no file that a person named
                stored = {key: value for key, value in facts.items() if key not in ("path", "absolute_path")}
                self.assertEqual(ours["inputs"][field], stored, field)
            for file in manifest["files"]:
                if file["name"] != "preview.png":  # the service makes one sheet for each stage
                    self.assertEqual(sha256(self.daemon.file(view["id"], file["name"])), file["sha256"])

    def test_fields_at_their_deprecated_places_give_the_same_bake_and_a_warning(self):
        new = self.post(quick_request(environment=self.sky, environment_settings={"rotation_deg": [0, 30, 0], "exposure_stops": 1},
                                      fiber={"kajiya_kay": {"exponent": 50}}))
        self.assertIsNone(new.headers["Warning"])
        self.assertEqual(self.daemon.wait(new.json["id"])["state"], "done")
        old = self.post(quick_request(environment=self.sky, irradiance={"rotation_deg": [0, 30, 0], "exposure_stops": 1,
                                                                        "exponent": 50}), status=200)
        self.assertEqual(old.json["id"], new.json["id"])
        warnings = old.headers.get_all("Warning")
        self.assertEqual(len(warnings), 3)
        for field in ("irradiance.rotation_deg", "irradiance.exposure_stops", "irradiance.exponent"):
            self.assertTrue(any(w.startswith("299 - ") and field in w for w in warnings), (field, warnings))
        wrong = self.post(quick_request(environment=self.sky, irradiance={"exponent": 99999}), status=422)
        self.assertEqual(wrong.json["pointer"], "/irradiance/exponent")  # where the body has it

    def test_files_are_what_the_manifest_says(self):
        view = self.bake(quick_request(self.hair, self.sky, outputs=["npy", "exr", "hair"]))
        manifest = json.loads(self.daemon.file(view["id"], "manifest.json"))
        self.assertEqual(manifest["request"]["hair"], f"sha256:{self.hair}")
        names = {file["name"] for file in manifest["files"]}
        self.assertLessEqual({"transmittance.npy", "transmittance.hair", "diffuse.exr", "preview_transmittance.png",
                              "preview_irradiance.png"}, names)
        self.assertEqual(names | {"manifest.json"}, {file["name"] for file in view["files"]})
        for file in manifest["files"]:
            body = self.daemon.file(view["id"], file["name"])
            self.assertEqual((sha256(body), len(body)), (file["sha256"], file["bytes"]))

    def test_a_repeated_request_is_answered_from_the_store(self):
        view = self.bake(quick_request(self.hair, self.sky, irradiance={"exponent": 12}))
        again = self.post(quick_request(self.hair, self.sky, irradiance={"exponent": 12}), status=200)
        self.assertEqual(again.json["id"], view["id"])
        self.assertEqual(again.headers["Location"], f"/v1/bakes/{view['id']}")

    def test_two_bakes_share_the_stage_that_both_need(self):
        first = self.bake(quick_request(self.hair, self.sky, transmittance={"seed": 7}, irradiance={"exponent": 20}))
        second = self.bake(quick_request(self.hair, self.sky, transmittance={"seed": 7}, irradiance={"exponent": 21}))
        self.assertNotEqual(first["id"], second["id"])
        self.assertEqual(first["stages"][0], second["stages"][0])  # attempts included: it ran once
        self.assertEqual(second["stages"][0]["attempts"], 1)

    def test_one_stage_alone(self):
        for request in (quick_request(self.hair), quick_request(environment=self.sky)):
            view = self.bake(request)
            self.assertEqual(len(view["stages"]), 1)
            self.daemon.file(view["id"], "manifest.json")

    def test_refuses_what_is_wrong_and_names_the_field(self):
        hair = f"sha256:{self.hair}"
        for request, field in (({"hair": "/etc/passwd"}, "hair"), ({"hair": "../x"}, "hair"), ({"hair": "sha256:12"}, "hair"),
                               ({"hair": "sha256:" + "0" * 64}, "hair"), ({"hair": "name:none"}, "hair"),
                               ({"hair": hair, "colour": 1}, "colour"), ({}, "hair"),
                               ({"hair": hair, "transmittance": {"voxels": 7}}, "transmittance.voxels"),
                               ({"hair": hair, "outputs": ["png"]}, "outputs[0]"), ({"hair": 12}, "hair"),
                               ({"hair": hair, "transmittance": {"seed": "1"}}, "transmittance.seed"),
                               ({"environment": [hair] * 6}, "environment"), ({"hair": hair, "strand": {"opacity": 2}}, "strand.opacity"),
                               ({"environment": hair, "irradiance": {"lights": [{"direction": [0, 1], "irradiance": [1, 1, 1]}]}}, "irradiance.lights[0].direction"),
                               ({"environment": hair, "irradiance": {"lights": [{"direction": [0, 1, 0]}]}},
                                "irradiance.lights[0].irradiance"), ({"hair": hair, "priority": 11}, "priority")):
            reply = self.daemon.ask("POST", "/v1/bakes", request)
            self.assertEqual((reply.status, reply.json["field"]), (422, field), reply.body)
            self.assertEqual(reply.json["pointer"], "/" + field.replace(".", "/").replace("[", "/").replace("]", ""))
            self.assertEqual(reply.headers["Content-Type"], "application/problem+json")
        detail = self.daemon.ask("POST", "/v1/bakes", {"hair": hair, "transmittance": {"voxels": 7}}).json["detail"]
        self.assertIn("transmittance.voxels is 7; allowed is", detail)
        self.assertIn('"minimum":32', detail)
        self.assertEqual(self.daemon.ask("POST", "/v1/bakes", "{").status, 400)
        nested = self.daemon.ask("POST", "/v1/bakes", "[" * 100000)
        self.assertEqual(nested.status, 422)
        self.assertIn("the body is [...]; allowed is", nested.json["detail"])

    def test_a_hostile_input_fails_its_bake_with_the_reason_and_nothing_else(self):
        broken = self.daemon.put(hair_bytes()[:200])
        view = self.daemon.wait(self.post(quick_request(broken, self.sky)).json["id"])
        self.assertEqual(view["state"], "failed")
        self.assertIn(f"sha256:{broken}", view["error"]["message"])  # not the path in the store
        self.assertNotIn(str(self.daemon.path), json.dumps(view))
        self.bake(quick_request(self.hair, self.sky, irradiance={"exponent": 33}))
        # Requested again, it starts again under the same id.
        again = self.post(quick_request(broken, self.sky))
        self.assertEqual((again.json["id"], again.json["attempts"]), (view["id"], 2))
        self.daemon.wait(view["id"])

    def test_cancel_ends_the_worker_and_a_new_request_starts_anew(self):
        model = self.daemon.put(hair_bytes(strands=2000, points=60))
        bake = self.post(slow_request(model)).json["id"]
        self.daemon.wait_for_worker()
        reply = self.daemon.ask("DELETE", f"/v1/bakes/{bake}")
        self.assertEqual((reply.status, reply.json["state"]), (200, "cancelled"))
        self.daemon.wait_for_worker(running=False)
        self.assertEqual(self.daemon.ask("DELETE", f"/v1/bakes/{bake}").status, 409)
        self.assertEqual(self.daemon.ask("GET", f"/v1/bakes/{bake}/files/manifest.json").status, 409)
        self.assertEqual(self.post(slow_request(model)).json["attempts"], 2)
        self.daemon.ask("DELETE", f"/v1/bakes/{bake}")

    def test_polling_is_cheap(self):
        view = self.bake(quick_request(self.hair, self.sky, irradiance={"exponent": 40}))
        first = self.daemon.ask("GET", f"/v1/bakes/{view['id']}")
        again = self.daemon.ask("GET", f"/v1/bakes/{view['id']}", headers={"If-None-Match": first.headers["ETag"]})
        self.assertEqual((again.status, again.body), (304, b""))

    def test_lists_filter_and_page(self):
        model = self.daemon.put(hair_bytes(seed=5))
        ids = [self.bake(quick_request(model, transmittance={"seed": s, "direction_set": "random"}))["id"] for s in (1, 2, 3)]
        page = self.daemon.ask("GET", f"/v1/bakes?model={model}&state=done&limit=2").json
        self.assertEqual([b["id"] for b in page["bakes"]], ids[:0:-1])  # newest first
        rest = self.daemon.ask("GET", f"/v1/bakes?model={model}&limit=2&cursor={page['next']}").json
        self.assertEqual(([b["id"] for b in rest["bakes"]], rest["next"]), (ids[:1], None))
        self.assertEqual(self.daemon.ask("GET", "/v1/bakes?limit=0").json["field"], "limit")


def stage_counts(transmittance, irradiance):
    """By kind; every kind that there is has a number."""
    return {"transmittance": transmittance, "irradiance": irradiance, "effective_transmittance": 0}


class Rebakes(unittest.TestCase):
    def test_a_new_lighting_runs_one_stage_for_a_whole_batch(self):
        with Daemon() as d:
            models = [d.put(hair_bytes(seed=s)) for s in range(5)]
            old, new = d.put(hdr_bytes(red=100)), d.put(hdr_bytes(red=200))
            for model in models:
                d.ask("POST", "/v1/bakes", quick_request(model, old))
            for bake in d.ask("GET", "/v1/bakes").json["bakes"]:
                self.assertEqual(d.wait(bake["id"])["state"], "done")
            body = {"environment": f"sha256:{new}", "replaces": f"sha256:{old}"}
            dry = d.ask("POST", "/v1/rebakes?dry_run=1", body).json
            self.assertEqual(dry, {"bakes": 5, "done_bakes": 0, "reused_stages": stage_counts(5, 0),
                                   "computed_stages": stage_counts(0, 1)})
            self.assertEqual(d.ask("GET", f"/v1/bakes?environment={new}").json["bakes"], [])  # a dry run changes nothing
            reply = d.ask("POST", "/v1/rebakes", body)
            self.assertEqual(reply.status, 202)
            batch = reply.headers["Location"]
            members = d.ask("GET", reply.json["links"]["bakes"]).json["bakes"]
            for bake in members:
                self.assertEqual(d.wait(bake["id"])["state"], "done")
            self.assertEqual(d.ask("GET", batch).json["states"]["done"], 5)
            stages = {s["key"]: s for b in members for s in d.ask("GET", f"/v1/bakes/{b['id']}").json["stages"]}
            self.assertEqual(len(stages), 6)  # five grooms, one lighting
            self.assertEqual({s["attempts"] for s in stages.values()}, {1})
            # The maps show the new lighting: red is brighter by 200/100, green is unchanged.
            manifests = [json.loads(d.file(b["id"], "manifest.json")) for b in members]
            before = json.loads(d.file(d.ask("GET", f"/v1/bakes?environment={old}").json["bakes"][0]["id"], "manifest.json"))
            ratio = [n / o for n, o in zip(manifests[0]["irradiance"]["diffuse"]["mean"], before["irradiance"]["diffuse"]["mean"])]
            self.assertAlmostEqual(ratio[0], 2.0, delta=1e-5)  # float32 maps
            self.assertAlmostEqual(ratio[1], 1.0, delta=1e-5)
            self.assertEqual(d.ask("POST", "/v1/rebakes", {"environment": f"sha256:{new}"}).status, 422)

    def test_a_name_or_a_list_of_models_says_what_is_baked_again(self):
        with Daemon() as d:
            models = [d.put(hair_bytes(seed=s)) for s in range(3)]
            dusk, noon, new = (d.put(hdr_bytes(red=red)) for red in (100, 150, 200))
            d.ask("PUT", "/v1/names/environment/stage1/dusk", {"sha256": dusk})
            for model in models[:2]:
                self.bake(d, {**quick_request(model), "environment": "name:stage1/dusk"})
            self.bake(d, quick_request(models[2], noon))
            # Two were baked under the name. Their transmittance is stored; the new lighting is not.
            body = {"environment": f"sha256:{new}", "name": "stage1/dusk"}
            self.rebake(d, body, reused=(2, 0), computed=(0, 1), members={(models[0], new), (models[1], new)})
            # Now the new lighting is stored as well: the reply says that all bakes are done.
            body = {"environment": f"sha256:{new}", "models": [f"sha256:{models[2]}"]}
            self.rebake(d, body, reused=(1, 1), computed=(0, 0), members={(models[2], new)})
            # A name that has moved to another version can be the new environment.
            d.ask("PUT", "/v1/names/environment/stage1/dusk", {"sha256": noon})
            body = {"environment": "name:stage1/dusk", "models": [f"sha256:{m}" for m in models]}
            batch = self.rebake(d, body, reused=(3, 1), computed=(0, 0), members={(m, noon) for m in models}, done=1)
            self.assertEqual([b["names"].get("environment") for b in batch], [{"path": "stage1/dusk", "version": 2}] * 3)
            for wrong, field in (({"name": "stage1/dawn"}, "name"), ({"models": [f"sha256:{new}"]}, "models"),
                                 ({"models": [f"sha256:{models[0]}"], "name": "stage1/dusk"}, None)):  # exactly one selection is allowed
                reply = d.ask("POST", "/v1/rebakes", {"environment": f"sha256:{new}", **wrong})
                self.assertEqual((reply.status, reply.json.get("field")), (422, field), reply.body)

    def test_a_new_lighting_may_come_with_other_settings_of_its_maps(self):
        with Daemon() as d:
            models = [d.put(hair_bytes(seed=s)) for s in range(2)]
            old, new = d.put(hdr_bytes(red=100)), d.put(hdr_bytes(red=200))
            for model in models:
                self.bake(d, quick_request(model, old))
            body = {"environment": f"sha256:{new}", "models": [f"sha256:{m}" for m in models], "irradiance": {"face_size": 8}}
            batch = self.rebake(d, body, reused=(2, 0), computed=(0, 1), members={(m, new) for m in models})
            for bake in batch:
                settings = d.ask("GET", f"/v1/bakes/{bake['id']}").json["request"]["irradiance"]
                self.assertEqual((settings["face_size"], settings["specular_maps"]), (8, 3))  # the new one and the old one
                manifest = json.loads(d.file(bake["id"], "manifest.json"))
                self.assertEqual(manifest["irradiance"]["face_size"], 8)
                # Six faces of 8 x 8 texels of three floats, behind numpy's header of a multiple of 64 bytes.
                self.assertIn(len(d.file(bake["id"], "diffuse.npy")) - 6 * 8 * 8 * 3 * 4, (64, 128))
            body["environment_settings"] = {"exposure_stops": 1}
            batch = self.rebake(d, body, reused=(2, 0), computed=(0, 1), members={(m, new) for m in models})
            for bake in batch:
                settings = d.ask("GET", f"/v1/bakes/{bake['id']}").json["request"]
                self.assertEqual((settings["environment_settings"]["exposure_stops"], settings["irradiance"]["face_size"]), (1, 8))
            body["irradiance"]["exposure_stops"] = body.pop("environment_settings")["exposure_stops"]  # the deprecated place
            reply = d.ask("POST", "/v1/rebakes?dry_run=1", body)
            self.assertEqual(reply.json["done_bakes"], 2, reply.body)
            self.assertIn("irradiance.exposure_stops", reply.headers["Warning"])
            body["irradiance"] = {"face_size": -8}
            self.assertEqual(d.ask("POST", "/v1/rebakes", body).json["field"], "irradiance.face_size")

    def test_what_is_stored_outlives_the_files_that_it_was_made_of(self):
        with Daemon() as d:
            hair, old, new = d.put(hair_bytes()), d.put(hdr_bytes(red=100)), d.put(hdr_bytes(red=200))
            self.assertEqual(d.ask("POST", "/v1/models", {"sha256": hair}).status, 201)
            self.assertEqual(d.ask("POST", "/v1/environments", {"sha256": old}).status, 201)
            bake = self.bake(d, quick_request(hair, old))
            for kind, digest in (("models", hair), ("environments", old)):
                self.assertEqual(d.ask("DELETE", f"/v1/{kind}/{digest}?force=1").status, 204)
                self.assertEqual(d.ask("HEAD", f"/v1/blobs/{digest}").status, 404)
                again = d.ask("POST", "/v1/bakes", quick_request(hair, old))
                self.assertEqual((again.status, again.json.get("id")), (200, bake["id"]), again.body)
            for file in bake["files"][1:]:
                self.assertEqual(sha256(d.ask("GET", file["href"]).body), file["sha256"])
            # Each stage alone is stored too.
            self.assertEqual(d.ask("POST", "/v1/bakes", quick_request(hair)).status, 200)
            self.assertEqual(d.ask("POST", "/v1/bakes", quick_request(environment=old)).status, 200)
            # A new lighting needs the stored transmittance of the groom, and nothing of the old lighting.
            body = {"environment": f"sha256:{new}", "replaces": f"sha256:{old}"}
            batch = self.rebake(d, body, reused=(1, 0), computed=(0, 1), members={(hair, new)})
            stages = d.ask("GET", f"/v1/bakes/{batch[0]['id']}").json["stages"]
            self.assertEqual(stages[0], bake["stages"][0])  # attempts included: it ran once
            # A stage that must be computed from a deleted file is refused, and the reply names the file.
            for request, field in ((quick_request(hair, new, transmittance={"seed": 2, "direction_set": "random"}), "hair"),
                                   (quick_request(hair, old, irradiance={"exponent": 9}), "environment"),
                                   (quick_request(environment=old, irradiance={"exponent": 9}), "environment")):
                reply = d.ask("POST", "/v1/bakes", request)
                self.assertEqual((reply.status, reply.json["field"]), (422, field), reply.body)
                self.assertIn("not stored", reply.json["detail"])
            body = {"environment": f"sha256:{old}", "irradiance": {"exponent": 9}, "models": [f"sha256:{hair}"]}
            reply = d.ask("POST", "/v1/rebakes", body)
            self.assertEqual((reply.status, reply.json["field"]), (422, "environment"), reply.body)
            # After the file is sent again, the request is baked.
            d.put(hair_bytes())
            self.bake(d, quick_request(hair, new, transmittance={"seed": 2, "direction_set": "random"}))

    def bake(self, d, request):
        reply = d.ask("POST", "/v1/bakes", request)
        self.assertIn(reply.status, (200, 202), reply.body)
        view = d.wait(reply.json["id"])
        self.assertEqual(view["state"], "done", view)
        return view

    def rebake(self, d, body, reused, computed, members, done=0):
        """The batch's bakes, once done. `reused` and `computed` count transmittance and irradiance stages; `members` are pairs of
        model and environment; `done` of them were done before."""
        dry = d.ask("POST", "/v1/rebakes?dry_run=1", body)
        self.assertEqual(dry.status, 200, dry.body)
        self.assertEqual(dry.json, {"bakes": len(members), "done_bakes": done, "reused_stages": stage_counts(*reused),
                                    "computed_stages": stage_counts(*computed)})
        reply = d.ask("POST", "/v1/rebakes", body)
        self.assertEqual((reply.status, reply.json["bakes"]), (202, len(members)), reply.body)
        if computed == (0, 0):
            self.assertEqual(reply.json["states"]["done"], len(members))
        batch = d.ask("GET", reply.json["links"]["bakes"]).json["bakes"]
        self.assertEqual({(bake["model"], bake["environment"]) for bake in batch}, members)
        self.assertEqual([d.wait(bake["id"])["state"] for bake in batch], ["done"] * len(members))
        again = d.ask("POST", "/v1/rebakes?dry_run=1", body).json
        self.assertEqual((again["done_bakes"], again["computed_stages"]), (len(members), stage_counts(0, 0)))
        return batch


class ManyRebakes(unittest.TestCase):
    GROOMS = 1000  # tests/bench/bench_service.py measures the time

    def test_the_maps_are_baked_once_for_a_thousand_grooms(self):
        with Daemon(workers=2) as d:
            old, new = d.put(hdr_bytes(red=100)), d.put(hdr_bytes(red=200))
            for seed in range(self.GROOMS):
                reply = d.ask("POST", "/v1/bakes", quick_request(d.put(hair_bytes(strands=4, points=4, seed=seed)), old))
                self.assertIn(reply.status, (200, 202), reply.body)
            # A bake whose maps are stored is running while its groom waits for a worker.
            for state in ("queued", "running"):
                self.wait_until(d, lambda: not d.ask("GET", f"/v1/bakes?state={state}&limit=1").json["bakes"])
            body = {"environment": f"sha256:{new}", "replaces": f"sha256:{old}"}
            dry = d.ask("POST", "/v1/rebakes?dry_run=1", body).json
            self.assertEqual(dry, {"bakes": self.GROOMS, "done_bakes": 0, "reused_stages": stage_counts(self.GROOMS, 0),
                                   "computed_stages": stage_counts(0, 1)})
            reply = d.ask("POST", "/v1/rebakes", body)
            batch = reply.headers["Location"]
            self.wait_until(d, lambda: d.ask("GET", batch).json["states"]["done"] == self.GROOMS)
            d.stop()
            with sqlite3.connect(d.path / "store/hairbake.db") as database:
                ran = dict(database.execute("SELECT kind, sum(attempts) FROM stages GROUP BY kind"))
                self.assertEqual(ran, {"transmittance": self.GROOMS, "irradiance": 2})  # the old maps and the new
                self.assertEqual(database.execute("SELECT count(*) FROM bakes WHERE state = 'done'").fetchone()[0], 2 * self.GROOMS)

    def wait_until(self, d, holds):
        end = time.monotonic() + 10 * PATIENCE
        while not holds():
            self.assertLess(time.monotonic(), end, "the bakes do not end")
            time.sleep(0.2)


class Names(unittest.TestCase):
    def test_a_name_keeps_its_versions_and_a_bake_records_which_it_got(self):
        with Daemon() as d:
            first, second, hair = d.put(hdr_bytes(red=90)), d.put(hdr_bytes(red=91)), d.put(hair_bytes())
            for digest, note in ((first, "warm"), (second, "cold"), (second, "again")):
                reply = d.ask("PUT", "/v1/names/environment/stage1/sunset", {"sha256": digest, "note": note})
                self.assertEqual(reply.status, 200, reply.body)
            name = d.ask("GET", "/v1/names/environment/stage1/sunset").json
            self.assertEqual([(v["version"], v["sha256"], v["note"]) for v in name["versions"]],
                             [(2, second, "cold"), (1, first, "warm")])
            for asked, version, digest in (("name:stage1/sunset", 2, second), ("name:stage1/sunset@1", 1, first)):
                reply = d.ask("POST", "/v1/bakes", {**quick_request(hair), "environment": asked}).json
                self.assertEqual(reply["environment"], digest)
                self.assertEqual(reply["names"]["environment"], {"path": "stage1/sunset", "version": version})
            self.assertEqual(len(d.ask("GET", "/v1/bakes?name=stage1/sunset").json["bakes"]), 2)
            # A done bake that is requested by a name belongs to that name from then on.
            bake = d.wait(d.ask("POST", "/v1/bakes", quick_request(hair, d.put(hdr_bytes(red=92)))).json["id"])["id"]
            d.ask("PUT", "/v1/names/environment/dusk", {"sha256": sha256(hdr_bytes(red=92))})
            self.assertEqual(d.ask("GET", "/v1/bakes?name=dusk").json["bakes"], [])
            reply = d.ask("POST", "/v1/bakes", {**quick_request(hair), "environment": "name:dusk"})
            self.assertEqual((reply.status, reply.json["id"]), (200, bake))
            self.assertEqual(reply.json["names"], {"environment": {"path": "dusk", "version": 1}})
            self.assertEqual([b["id"] for b in d.ask("GET", "/v1/bakes?name=dusk").json["bakes"]], [bake])
            self.assertEqual(d.ask("GET", "/v1/names/environment").json["names"][-1]["version"], 2)
            for path, status in (("environment/a%2fb", 400), ("environment/a/../b", 400), ("colour/x", 404), ("model/a%20b", 422)):
                self.assertEqual(d.ask("PUT", f"/v1/names/{path}", {"sha256": first}).status, status, path)
            self.assertEqual(d.ask("PUT", "/v1/names/model/x", {"sha256": "0" * 64}).status, 422)


class Inputs(unittest.TestCase):
    def test_a_worker_tells_the_facts_of_models_and_environments(self):
        with Daemon() as d:
            hair = d.put(hair_bytes(strands=40, points=10))
            reply = d.ask("POST", "/v1/models", {"sha256": hair})
            self.assertEqual(reply.status, 201, reply.body)
            facts = reply.json["facts"]
            self.assertEqual((facts["strands"], facts["vertices"]), (40, 400))
            self.assertEqual(d.ask("POST", "/v1/models", {"sha256": hair}).status, 200)  # known
            picture = d.ask("GET", f"/v1/models/{hair}/thumbnail.png")
            self.assertEqual((picture.status, picture.body[:8]), (200, b"\x89PNG\r\n\x1a\n"))

            sky = hdr_bytes(red=128, width=16)
            reply = d.ask("POST", "/v1/environments", sky, {"Content-Type": "application/octet-stream"})
            self.assertEqual((reply.status, reply.json["id"]), (201, sha256(sky)))
            facts = reply.json["facts"]
            # RGBE with exponent 129: mantissa / 256 * 2^(129 - 128)
            self.assertEqual((facts["width"], facts["height"]), (16, 8))
            for channel, mantissa in zip(facts["mean_radiance"], (128, 64, 32)):
                self.assertAlmostEqual(channel, mantissa / 128, delta=1e-6)
            self.assertEqual(d.ask("GET", f"/v1/environments/{sha256(sky)}/thumbnail.png").status, 200)
            self.assertEqual([e["id"] for e in d.ask("GET", "/v1/environments").json["environments"]], [sha256(sky)])

            self.assertEqual(d.ask("POST", "/v1/models", {"sha256": sha256(sky)}).status, 422)  # no hair model
            self.assertEqual(d.ask("POST", "/v1/environments", b"#?RADIANCE\n\n-Y 99999 +X 99999\n",
                                   {"Content-Type": "application/octet-stream"}).status, 422)
            self.assertEqual(d.ask("POST", "/v1/models", b"x", {"Content-Type": "text/plain"}).status, 415)

    def test_the_facts_of_a_model_are_those_of_its_bytes(self):
        with Daemon() as d:
            facts = d.ask("POST", "/v1/models", {"sha256": d.put(hair_bytes(strands=40, points=10))}).json["facts"]
            # Strand s begins at (s % 7 * 0.1, 0, s // 7 * 0.1); its point p lies (0.02 p, 0.1 p, 0) from there.
            self.assert_near(facts["bounds"]["minimum"], (0, 0, 0))
            self.assert_near(facts["bounds"]["maximum"], (6 * 0.1 + 9 * 0.02, 9 * 0.1, 39 // 7 * 0.1))
            self.assertEqual(facts["longest_strand"], 10)
            self.assertAlmostEqual(facts["thickness"]["default"], 0.01, delta=1e-7)  # the header's
            self.assertEqual((facts["transparency"], facts["colors"]), ({"default": 0.0}, [0.5, 0.5, 0.5]))
            self.assertEqual(facts["info"], "test")
            self.assertNotIn("warnings", facts)

    def test_the_facts_of_an_environment_are_those_of_its_bytes(self):
        with Daemon() as d:
            width, height, row, column = 16, 8, 2, 5
            sky = bytearray(hdr_bytes(red=128, width=width))
            at = len(sky) - 4 * (width * height - row * width - column)
            sky[at:at + 4] = bytes([200, 100, 50, 132])
            facts = d.ask("POST", "/v1/environments", bytes(sky), {"Content-Type": "application/octet-stream"}).json["facts"]
            # mantissa / 256 * 2^(exponent - 128)
            flat, bright = (1, 0.5, 0.25), (12.5, 6.25, 3.125)
            pixel = facts["brightest_pixel"]
            self.assertEqual((pixel["row"], pixel["column"]), (row, column))
            self.assert_near(pixel["radiance"], bright)
            # Up is y: the middle of row 2 of 8 is 2.5/8 of the way from the zenith down.
            self.assertAlmostEqual(pixel["direction"][1], math.cos(2.5 / 8 * math.pi), delta=1e-6)
            self.assertAlmostEqual(math.hypot(*pixel["direction"]), 1, delta=1e-6)
            # The pixel's share of the sphere: 1/16 of the zone between 2/8 and 3/8 of the way down, which is half the difference
            # of their cosines. The energy is this mean times 4 pi.
            share = (math.cos(2 / 8 * math.pi) - math.cos(3 / 8 * math.pi)) / 2 / width
            self.assert_near(facts["mean_radiance"], [f + (b - f) * share for f, b in zip(flat, bright)])
            self.assertEqual(facts["invalid_pixels"], {"negative": 0, "nan": 0, "infinite": 0})
            self.assertFalse(facts["low_dynamic_range"])

    def assert_near(self, found, expected):
        for one, other in zip(found, expected, strict=True):
            self.assertAlmostEqual(one, other, delta=1e-6)  # float32

    def test_lists_of_inputs_and_names_go_on_page_by_page(self):
        with Daemon(workers=2) as d:
            added = {"models": [], "environments": [], "names/model": []}
            for number in range(3):
                hair, sky = d.put(hair_bytes(seed=number)), d.put(hdr_bytes(red=100 + number))
                self.assertEqual(d.ask("POST", "/v1/models", {"sha256": hair}).status, 201)
                self.assertEqual(d.ask("POST", "/v1/environments", {"sha256": sky}).status, 201)
                self.assertEqual(d.ask("PUT", f"/v1/names/model/{'cab'[number]}/x", {"sha256": hair}).status, 200)
                added["models"].insert(0, hair)  # newest first
                added["environments"].insert(0, sky)
            added["names/model"] = ["a/x", "b/x", "c/x"]  # by name
            for path, expected in added.items():
                found, pages, cursor = [], 0, ""
                while cursor is not None:
                    page = d.ask("GET", f"/v1/{path}?limit=1" + (f"&cursor={cursor}" if cursor else "")).json
                    entries = page["names" if "names" in path else path]
                    self.assertEqual(len(entries), 1)
                    found += [entry["path" if "names" in path else "id"] for entry in entries]
                    cursor, pages = page["next"], pages + 1
                    self.assertLessEqual(pages, 3)
                self.assertEqual(found, expected)
                self.assertEqual(d.ask("GET", f"/v1/{path}?limit=0").json["field"], "limit")

    def test_what_a_live_bake_uses_is_not_deleted(self):
        with Daemon() as d:
            model = d.put(hair_bytes(strands=2000, points=60))
            self.assertEqual(d.ask("POST", "/v1/models", {"sha256": model}).status, 201)
            bake = d.ask("POST", "/v1/bakes", slow_request(model)).json["id"]
            self.assertEqual(d.ask("DELETE", f"/v1/models/{model}").status, 409)
            d.ask("DELETE", f"/v1/bakes/{bake}")
            self.assertEqual(d.ask("DELETE", f"/v1/models/{model}").status, 204)
            self.assertEqual(d.ask("GET", f"/v1/models/{model}").status, 404)
            self.assertEqual(d.ask("GET", f"/v1/blobs/{model}").status, 404)


if __name__ == "__main__":
    unittest.main()
