"""The room on the disk, and results that wait for room."""
import contextlib
import os
import re
import unittest

from disks import SmallDisk
from harness import PROGRAMS, TUS, Daemon, hair_bytes, hdr_bytes, quick_request, sha256
from rooms import BUDGET, PATCH, SMALL, RoomTest, eventually, head, under_way


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
            # What is stored already is taken for its digest alone: nothing is written.
            self.assertEqual(d.ask("PUT", f"/v1/blobs/{sha256(known)}", known).status, 200)
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
        for config, told in (("budget_mb = 5\nkeep_free_mb = 1", False), ("budget_mb = 5\nkeep_free_mb = 3", True)):  # of 8 MB; the reserve has 1
            with SmallDisk(config=config) as d:
                self.assertEqual("budget_mb is 5; the disk of" in (d.path / "log").read_text(), told, config)

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

    def two_bakes_that_hold_each_others_room(self, priorities):
        """Each has its maps stored (1 + 6 maps of 6 x 25 x 25 texels of 12 bytes are 315 kB) and lacks the room for its
        transmittance: 10,000 points of 4 bytes. Hair and a filler leave 20 kB."""
        d = Daemon(config=SMALL, workers=4)
        d.program, d.go = d.path / "worker", d.path / "go"
        d.program.write_text(f'''#!/bin/sh
for folder; do :; done
if grep -q '"stages":."transmittance"' "$folder/task.json"; then while [ ! -e "{d.go}" ]; do sleep 0.05; done; fi
exec {PROGRAMS / "hairbake-worker"} "$@"
''')
        d.program.chmod(0o755)
        d.limits = f'program = "{d.program}"'
        d.start()
        hair, bakes = d.put(hair_bytes(strands=1000)), []
        for number, priority in enumerate(priorities):
            request = quick_request(hair, d.put(hdr_bytes(red=100 + number)), irradiance={"face_size": 25, "specular_maps": 6},
                                    transmittance={"seed": number, "direction_set": "random"})
            bakes.append(d.ask("POST", "/v1/bakes", {**request, "priority": priority}).json["id"])
        for bake in bakes:
            eventually(lambda: [s["state"] for s in d.ask("GET", f"/v1/bakes/{bake}").json["stages"]] == ["running", "done"])
        d.put(os.urandom(BUDGET - self.stored(d) - 20_000))
        return d, bakes

    def test_bakes_that_hold_the_room_of_each_other_come_one_after_the_other(self):
        """Fault: they waited for each other for ever. Relatives: the older goes first; the one with the higher priority does; a
        cancelled bake of the maps that give way keeps its record."""
        for priorities, first in (((0, 0), 0), ((0, 5), 1)):
            d, bakes = self.two_bakes_that_hold_each_others_room(priorities)
            with self.subTest(priorities), contextlib.ExitStack() as stack:
                stack.push(d)
                begin = (d.path / "log").stat().st_size
                view = d.ask("GET", f"/v1/bakes/{bakes[1 - first]}").json
                request = {**view["request"], "transmittance": {**view["request"]["transmittance"], "seed": 9}}
                cancelled = d.ask("POST", "/v1/bakes", request).json["id"]
                self.assertEqual(d.ask("DELETE", f"/v1/bakes/{cancelled}").status, 200)
                d.go.touch()
                ends = []

                def all_end():
                    for bake in bakes:
                        reply = d.ask("GET", f"/v1/bakes/{bake}")
                        if bake not in ends and (reply.status == 410 or reply.json["state"] == "done"):
                            ends.append(bake)
                    return len(ends) == 2
                eventually(all_end)
                self.assertEqual(ends, [bakes[first], bakes[1 - first]])
                log = (d.path / "log").read_text()[begin:]
                self.assertEqual(log.count("an earlier bake needs the room"), 1, log)
                self.assertEqual(d.ask("GET", f"/v1/bakes/{cancelled}").json["state"], "cancelled")
                last = d.ask("GET", f"/v1/bakes/{bakes[1 - first]}").json
                self.assertEqual(len(last["files"]), 7, last["files"])
                for file in last["files"]:
                    self.assertEqual(d.ask("GET", file["href"]).status, 200)
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
