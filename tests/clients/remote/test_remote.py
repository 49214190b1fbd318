"""`hairbake submit` and the like, and `python3 -m hairbake`, against the real daemon: both must do the same."""
import json
import os
import random
import re
import shlex
import signal
import socket
import subprocess
import unittest
from pathlib import Path

from rig import (PROGRAMS, QUICK, LastingDaemon, Liar, Proxy, TcpLiar, Workshop, first_word, sha256, tls_of_localhost,
                 until)
from harness import hair_bytes, hdr_bytes, quick_request, slow_request

ENDED = "0" * 64  # the bake of a Liar
NATIVE, PYTHON = [str(PROGRAMS / "hairbake")], ["/usr/bin/python3", "-m", "hairbake"]


class Case(unittest.TestCase):
    command = None

    def setUp(self):
        self.shop = Workshop(self.command)
        self.addCleanup(self.shop.folder.cleanup)
        self.hair = self.shop.write("groom.hair", hair_bytes())
        self.sky = self.shop.write("sky.hdr", hdr_bytes())

    def daemon(self, **settings):
        daemon = LastingDaemon(**settings)
        daemon.__enter__()
        self.addCleanup(daemon.__exit__)
        daemon.url = f"http://127.0.0.1:{daemon.port}"
        return daemon

    def run_ok(self, *words, url):
        done = self.shop.run(*words, url=url)
        self.assertEqual(done.code, 0, done)
        return done

    def run_failing(self, code, *words, url):
        done = self.shop.run(*words, url=url)
        self.assertEqual(done.code, code, done)
        self.assertNotIn("Traceback", done.err)
        return done


class Jobs:
    def test_submit_and_fetch_gives_the_files_of_a_bake_here(self):
        daemon = self.daemon()
        done = self.run_ok("submit", "--hair", self.hair, "--env", self.sky, *QUICK, "--fetch", "out", url=daemon.url)
        here = [*NATIVE, "bake", "--hair", self.hair, "--env", self.sky, *QUICK, "--out", "here"]
        subprocess.run(here, check=True, cwd=self.shop.path, capture_output=True)
        ours, theirs = self.shop.files("out"), self.shop.files("here")
        self.assertEqual(first_word(done.out), json.loads(theirs["manifest.json"])["id"])
        # The service has a contact sheet a stage, and its manifest measures other times; all else is the same.
        for name in ("preview.png", "manifest.json"):
            del theirs[name]
        sheets = {"manifest.json", "preview_transmittance.png", "preview_irradiance.png"}
        self.assertEqual({name: data for name, data in ours.items() if name not in sheets}, theirs)
        self.assertEqual(self.shop.names(), ["groom.hair", "here", "out", "sky.hdr"])  # nothing hidden is left
        # What is fetched is a result like any other.
        subprocess.run([*NATIVE, "info", "out"], check=True, cwd=self.shop.path, capture_output=True)

    def test_submit_alone_prints_the_id_and_status_wait_and_fetch_take_it(self):
        daemon = self.daemon()
        submitted = self.run_ok("submit", "--hair", self.hair, *QUICK, "--priority", "3", url=daemon.url)
        self.assertEqual(len(submitted.out.splitlines()), 1)
        bake = first_word(submitted.out)
        self.assertIn(f"{bake} done", self.run_ok("wait", bake, url=daemon.url).out)
        self.assertIn(f"{bake} done", self.run_ok("status", bake, url=daemon.url).out)
        self.assertIn(f"{bake} done", self.run_ok("status", url=daemon.url).out)
        self.assertIn(f"{bake} done", self.run_ok("status", "--state", "done", url=daemon.url).out)
        self.assertEqual(self.run_ok("status", "--state", "failed", url=daemon.url).out, "")
        self.run_ok("fetch", bake, "--out", "out", url=daemon.url)
        self.assertIn("transmittance.npy", self.shop.files("out"))
        self.assertEqual(daemon.ask("GET", f"/v1/bakes/{bake}").json["priority"], 3)

    def test_warnings_of_stages_are_printed_by_submit_wait_and_fetch(self):
        """Relatives: a bake that was done already, JSON lines, several bakes, a bake without warnings."""
        daemon = self.daemon()
        mesh = self.shop.write("far.obj", b"v 900 0 0\nv 900.1 0 0\nv 900 0.1 0\nf 1 2 3\n")
        words = ["--hair", self.hair, "--occluder", mesh, *QUICK]
        first = self.run_ok("submit", *words, "--wait", url=daemon.url)
        bake = first_word(first.out)
        fetched = self.run_ok("fetch", bake, "--out", "out", url=daemon.url)
        again = self.run_ok("submit", *words, url=daemon.url)
        waited = self.run_ok("wait", bake, url=daemon.url)
        expected = json.loads(self.shop.files("out")["manifest.json"])["warnings"]
        self.assertGreaterEqual(len(expected), 2)
        for done in (first, fetched, again, waited):
            for warning in expected:
                self.assertIn(f"warning: {warning}", done.err)
        event = self.run_ok("submit", *words, "--fetch", "out", "--progress", "json", url=daemon.url).events[-1]
        self.assertEqual(event["warnings"], expected)
        other = self.shop.write("other.hair", hair_bytes(seed=5))
        both = self.run_ok("submit", *words, "--hair", other, "--wait", url=daemon.url)
        self.assertIn(f"warning: bake {bake}: {expected[0]}", both.err)
        hair_alone = [word for setting in QUICK if setting.startswith("transmittance.") for word in ("--set", setting)]
        plain = self.run_ok("submit", "--hair", self.hair, *hair_alone, "--outputs", "npy", "--wait", url=daemon.url)
        self.assertNotIn("warning", plain.err)

    def test_the_bar_fits_the_terminal(self):
        """Relatives: a dumb terminal, one of few columns, one too narrow for a bar."""
        daemon = self.daemon()
        words = [*self.command, "submit", "--hair", self.hair, "--env", self.sky, *QUICK, "--wait", "--server",
                 daemon.url]
        lines = {}
        for name, variables in (("dumb", {"TERM": "dumb"}), ("narrow", {"TERM": "xterm", "COLUMNS": "40"}),
                                ("none", {"TERM": "xterm", "COLUMNS": "16"})):
            done = subprocess.run(["script", "-qec", shlex.join(words), "/dev/null"], cwd=self.shop.path,
                                  env={**self.shop.environment, **variables, "NO_COLOR": "1"}, stdin=subprocess.DEVNULL,
                                  capture_output=True, check=True)
            lines[name] = done.stdout.decode()
        self.assertNotIn("\033", lines["dumb"])
        for name, columns in (("narrow", 40), ("none", 16)):
            shown = re.findall(r"\r([^\r\n\033]*)\033\[K", lines[name])
            self.assertTrue(shown, lines[name])
            self.assertLess(max(map(len, shown)), columns)
            self.assertEqual(any(line.startswith("[") for line in shown), name == "narrow")

    def test_status_shows_names_and_times(self):
        """Relatives: the time of a batch, an input without a name."""
        daemon = self.daemon()
        digest = daemon.put(hair_bytes())
        daemon.ask("POST", "/v1/models", {"sha256": digest})
        daemon.ask("PUT", "/v1/names/model/crowd/jane", {"sha256": digest, "note": ""})
        bake = first_word(self.run_ok("submit", "--hair", "name:crowd/jane", "--env", self.sky, *QUICK, "--wait",
                                      url=daemon.url).out)
        view = daemon.ask("GET", f"/v1/bakes/{bake}").json
        line = self.run_ok("status", bake, url=daemon.url).out
        self.assertIn(f"; hair crowd/jane@1; environment {view['environment'][:12]}; created {view['created']}; "
                      f"finished {view['finished']}", line)
        dark = self.shop.write("dark.hdr", hdr_bytes(red=90))
        batch = first_word(self.run_ok("rebake", "--bake", bake, "--env", dark, url=daemon.url).out)
        self.assertIn(f"; created {daemon.ask('GET', f'/v1/batches/{batch}').json['created']}",
                      self.run_ok("status", "--batch", batch, url=daemon.url).out)

    def test_several_hairs_are_a_bake_each(self):
        daemon = self.daemon()
        other = self.shop.write("other.hair", hair_bytes(seed=5))
        done = self.run_ok("submit", "--hair", self.hair, "--hair", other, "--env", self.sky, *QUICK, "--fetch", "all",
                           url=daemon.url)
        self.assertEqual(len({first_word(line) for line in done.out.splitlines()}), 2)
        groom, second = self.shop.files("all/groom"), self.shop.files("all/other")
        self.assertNotEqual(groom["transmittance.npy"], second["transmittance.npy"])
        self.assertEqual(groom["diffuse.npy"], second["diffuse.npy"])

    def test_an_input_that_the_server_has_is_not_sent_again(self):
        daemon = self.daemon()
        hair = self.shop.write("large.hair", hair_bytes(strands=2000, points=60))  # 12 bytes a point: 1.4 MB
        with Proxy(daemon) as proxy:
            self.run_ok("submit", "--hair", hair, *QUICK, "--wait", url=proxy.url)
            self.assertGreater(proxy.sent, 1_440_000)
            proxy.sent = 0
            self.run_ok("submit", "--hair", hair, "--env", self.sky, *QUICK, "--wait", url=proxy.url)
            self.assertLess(proxy.sent, 100_000)  # requests alone, under 1 KB each

    def test_json_lines_tell_everything(self):
        daemon = self.daemon()
        done = self.run_ok("submit", "--hair", self.hair, *QUICK, "--fetch", "out", "--progress", "json",
                           url=daemon.url)
        events = done.events
        self.assertEqual({event["event"] for event in events}, {"progress", "submitted", "done"})
        self.assertEqual((events[-1]["event"], events[-1]["folder"]), ("done", "out"))
        self.assertLessEqual({"upload", "bake", "fetch"}, {event.get("phase") for event in events})
        failed = self.run_failing(7, "status", "0" * 64, "--progress", "json", url=daemon.url)
        self.assertEqual((failed.events[-1]["event"], failed.events[-1]["kind"]), ("error", "refused"))

    def test_a_failed_bake_tells_its_reason_with_the_path_of_the_file(self):
        daemon = self.daemon()
        broken = self.shop.write("broken.hair", hair_bytes()[:200])
        done = self.run_failing(8, "submit", "--hair", broken, *QUICK, "--fetch", "out", url=daemon.url)
        self.assertIn(broken, done.err)
        self.assertNotIn("sha256:", done.err)
        self.assertNotIn("out", self.shop.names())

    def test_cancel(self):
        daemon = self.daemon()
        model = daemon.put(hair_bytes(strands=2000, points=60))
        bake = daemon.ask("POST", "/v1/bakes", slow_request(model)).json["id"]
        self.assertEqual(self.run_ok("cancel", bake, url=daemon.url).out, f"{bake} cancelled\n")
        self.run_ok("cancel", bake, url=daemon.url)  # cancelled already is as good
        self.assertIn("cancelled", self.run_failing(9, "wait", bake, url=daemon.url).err)

    def test_an_interrupted_wait_leaves_the_bake_running_and_says_how_to_go_on(self):
        daemon = self.daemon()
        hair = self.shop.write("large.hair", hair_bytes(strands=2000, points=60))
        slow = [word for setting in ("transmittance.method=trace", "transmittance.directions=4096",
                                     "transmittance.direction_set=random") for word in ("--set", setting)]
        for number in (signal.SIGINT, signal.SIGHUP):
            with self.subTest(number):
                self.interrupt(daemon, hair, slow, number)

    def interrupt(self, daemon, hair, slow, number):
        signal.signal(signal.SIGHUP, signal.SIG_DFL)  # the tests may run under nohup
        with Proxy(daemon) as proxy:
            self.shop.write("our certificates.pem", b"")  # not read for http
            process = self.shop.start("submit", "--hair", hair, *slow, "--wait", "--ca-file", "our certificates.pem",
                                      url=proxy.url)
            until(lambda: any(head.startswith("GET /v1/bakes/") for head in proxy.heads), "a poll")
            bake = daemon.ask("GET", "/v1/bakes").json["bakes"][0]["id"]
            process.send_signal(number)
            done = self.shop.end(process)
        self.assertEqual(done.code, 5, done)
        for command in ("wait", "cancel"):
            self.assertIn(f"hairbake {command} {bake} --server {proxy.url} --ca-file 'our certificates.pem'", done.err)
        self.assertIn(daemon.ask("GET", f"/v1/bakes/{bake}").json["state"], ("queued", "running"))
        self.run_ok("cancel", bake, url=daemon.url)

    def test_a_field_at_its_first_place_gives_way_to_a_later_setting(self):
        daemon = self.daemon()
        old = self.shop.write("old.json", json.dumps({"irradiance": {"exponent": 11, "face_size": 4}}).encode())
        done = self.run_ok("submit", "--env", self.sky, "--outputs", "npy", "--request", old, "--set",
                           "fiber.kajiya_kay.exponent=12", "--wait", url=daemon.url)
        self.assertIn("irradiance.exponent is deprecated", done.err)
        request = daemon.ask("GET", f"/v1/bakes/{first_word(done.out)}").json["request"]
        self.assertEqual(request["fiber"]["kajiya_kay"]["exponent"], 12)

    def test_rebake_computes_no_transmittance_again(self):
        daemon = self.daemon()
        bake = first_word(self.run_ok("submit", "--hair", self.hair, "--env", self.sky, *QUICK, "--fetch", "old",
                                      url=daemon.url).out)
        dusk = self.shop.write("dusk.hdr", hdr_bytes(red=200))
        forecast = self.run_ok("rebake", "--env", dusk, "--bake", bake, "--dry-run", "--progress", "json",
                               url=daemon.url).events
        for kind, stage in (("reused_stages", "transmittance"), ("computed_stages", "irradiance")):
            self.assertEqual({name: count for name, count in forecast[-1][kind].items() if count}, {stage: 1})
        brighter = ["rebake", "--env", dusk, "--bake", bake, "--environment-settings", '{"exposure_stops": 1}',
                    "--fiber", '{"kajiya_kay": {"exponent": 8}}', "--dry-run"]
        words = '"irradiance": 1' if self.command == PYTHON else "1 irradiance stages would be computed"
        self.assertIn(words, self.run_ok(*brighter, url=daemon.url).out)
        old_place = self.run_ok("rebake", "--env", dusk, "--bake", bake, "--irradiance", '{"exponent": 8}', "--dry-run",
                                url=daemon.url)
        self.assertIn("irradiance.exponent is deprecated", old_place.err)
        done = self.run_ok("rebake", "--env", dusk, "--replaces", self.sky, "--fetch", "new", url=daemon.url)
        again = first_word(done.out)
        old, new = self.shop.files("old"), self.shop.files(f"new/{again}")
        self.assertEqual(old["transmittance.npy"], new["transmittance.npy"])
        self.assertNotEqual(old["diffuse.npy"], new["diffuse.npy"])
        views = [daemon.ask("GET", f"/v1/bakes/{id}").json for id in (bake, again)]
        self.assertEqual(views[0]["stages"][0], views[1]["stages"][0])  # its attempts too: it ran once
        batch = first_word(self.run_ok("rebake", "--env", dusk, "--bake", bake, url=daemon.url).out)
        counts = self.run_ok("status", "--batch", batch, url=daemon.url).out
        self.assertTrue(counts.startswith(f"{batch}: 1 done; created 2"), counts)
        self.assertIn(f"{again} done", self.run_ok("wait", "--batch", batch, url=daemon.url).out)

    def test_names(self):
        daemon = self.daemon()
        stored = self.run_ok("upload", self.sky, "--as", "environment", "--name", "stage1/noon", "--note", "v1",
                             url=daemon.url)
        self.assertEqual(first_word(stored.out), f"sha256:{sha256(hdr_bytes())}")
        bake = first_word(self.run_ok("submit", "--hair", self.hair, "--env", "name:stage1/noon", *QUICK, "--wait",
                                      url=daemon.url).out)
        view = daemon.ask("GET", f"/v1/bakes/{bake}").json
        self.assertEqual(view["names"]["environment"], {"path": "stage1/noon", "version": 1})
        self.assertEqual(daemon.ask("GET", f"/v1/environments/{sha256(hdr_bytes())}").status, 200)

    def test_delete_lists_what_refers_to_the_input_and_force_deletes_it(self):
        # Relatives of a model: an environment with a name, and a mesh, which no list has.
        daemon = self.daemon()
        mesh = self.shop.write("head.obj", b"v 0 0 0\nv 0.1 0 0\nv 0 0.1 0\nf 1 2 3\n")
        self.run_ok("upload", self.hair, "--as", "model", url=daemon.url)
        self.run_ok("upload", self.sky, "--as", "environment", "--name", "stage1/noon", url=daemon.url)
        bake = first_word(self.run_ok("submit", "--hair", self.hair, "--env", self.sky, "--occluder", mesh, *QUICK, "--wait",
                                      url=daemon.url).out)
        for number in range(22):
            daemon.ask("PUT", f"/v1/names/mesh/n{number}", {"sha256": sha256(open(mesh, "rb").read())})
        for file, kind, lines in ((self.hair, ["--as", "model"], [f"bake {bake} (done)"]),
                                  (self.sky, ["--as", "environment"], [f"bake {bake} (done)", "name environment/stage1/noon@1"]),
                                  (mesh, [], [f"bake {bake} (done)", "name mesh/n21@1", "and 2 more versions of names"])):
            reference = "sha256:" + sha256(open(file, "rb").read())
            err = self.run_failing(7, "delete", reference, *kind, url=daemon.url).err
            for line in [*lines, "--force deletes it all the same"]:
                self.assertIn(line, [text.strip() for text in err.splitlines()])
            self.assertEqual(daemon.ask("HEAD", f"/v1/blobs/{reference[7:]}").status, 200)
            done = self.run_ok("delete", reference, *kind, "--force", url=daemon.url)
            self.assertEqual(done.out, f"{reference} deleted\n")
            self.assertEqual(daemon.ask("HEAD", f"/v1/blobs/{reference[7:]}").status, 404)
        self.assertEqual(daemon.ask("GET", f"/v1/bakes/{bake}").json["state"], "done")
        for words, code in ((["delete", "sha256:12"], 2), (["delete", "sha256:" + "0" * 64], 7)):
            self.run_failing(code, *words, url=daemon.url)

    def test_a_refused_delete_says_which_kind_to_name(self):
        """Fault: without --as, the refusal named an address of the service, and no flag. Relatives: the wrong kind."""
        daemon = self.daemon()
        mesh = self.shop.write("head.obj", b"v 0 0 0\nv 0.1 0 0\nv 0 0.1 0\nf 1 2 3\n")
        self.run_ok("upload", self.hair, "--as", "model", url=daemon.url)
        self.run_ok("upload", self.sky, "--as", "environment", url=daemon.url)
        self.run_ok("upload", mesh, url=daemon.url)
        def reference_of(file):
            return "sha256:" + sha256(Path(file).read_bytes())

        for file, wrong, right in ((self.hair, [], "model"), (self.hair, ["--as", "environment"], "model"),
                                   (self.sky, ["--as", "mesh"], "environment"), (mesh, ["--as", "model"], "mesh")):
            err = self.run_failing(7, "delete", reference_of(file), *wrong, url=daemon.url).err
            self.assertIn(f"--as {right} deletes it", [text.strip() for text in err.splitlines()])
        for file, kind in ((self.hair, "model"), (self.sky, "environment"), (mesh, "mesh")):
            self.run_ok("delete", reference_of(file), "--as", kind, url=daemon.url)


class Refusals:
    def test_what_is_wrong_is_said_in_words_and_by_the_exit_code(self):
        daemon = self.daemon()
        for code, words, said in (
                (3, ["submit", "--hair", "nothing.hair"], "nothing.hair"),
                (2, ["submit", "--hair", self.hair, "--env", str(self.shop.path)], "one file"
                    if self.command is NATIVE else "single files"),
                (2, ["submit", "--hair", str(self.shop.path)], "a folder"),
                (2, ["rebake", "--env", self.sky, "--bake", "0" * 64, "--irradiance", 60_000 * "["], "irradiance"),
                (7, ["submit", "--hair", "name:nobody/knows"], "hair"),
                (7, ["submit", "--hair", "sha256:" + "0" * 64], "which is not stored"),
                (7, ["wait", "0" * 64], "there is no bake"),
                (7, ["rebake", "--env", self.sky, "--name", "nothing"], "name")):
            with self.subTest(words):
                self.assertIn(said, self.run_failing(code, *words, url=daemon.url).err)

    def test_a_wrong_token_is_refused_and_no_token_is_printed(self):
        token = "t0ken-of-the-tests-that-nobody-may-read-0123456789"
        tokens = f'[[token]]\nname = "farm"\nsha256 = "{sha256(token.encode())}"\nscopes = ["read", "upload", "bake"]\n'
        daemon = self.daemon(tokens=tokens)
        good, bad = self.shop.write("good", token.encode() + b"\n"), self.shop.write("bad", b"wrong-" + token.encode())
        os.chmod(good, 0o600)
        os.chmod(bad, 0o644)
        for words in (["status"], ["status", "--token-file", bad]):
            done = self.run_failing(7, *words, url=daemon.url)
            self.assertIn("token", done.err)
            self.assertNotIn(token, done.out + done.err)
        self.assertIn("can be read by everybody", done.err)
        done = self.run_ok("submit", "--hair", self.hair, *QUICK, "--wait", "--token-file", good, url=daemon.url)
        self.assertNotIn("everybody", done.err)
        self.shop.environment.update(HAIRBAKE_SERVER=daemon.url, HAIRBAKE_TOKEN_FILE=good)
        self.run_ok("status", url=None)

    def test_a_folder_with_other_files_is_left_alone(self):
        daemon = self.daemon()
        (self.shop.path / "mine").mkdir()
        self.shop.write("mine/diary.txt", b"dear diary")
        done = self.run_failing(2, "submit", "--hair", self.hair, *QUICK, "--fetch", "mine", url=daemon.url)
        self.assertIn("mine", done.err)
        self.assertEqual(self.shop.files("mine"), {"diary.txt": b"dear diary"})

    def test_what_can_be_known_is_said_before_the_server_is_asked(self):
        """The misspelled second input, and its relatives: nothing answers at this address."""
        with socket.create_server(("127.0.0.1", 0)) as free:
            url = f"http://127.0.0.1:{free.getsockname()[1]}"
        (self.shop.path / "mine").mkdir()
        self.shop.write("mine/diary.txt", b"dear diary")
        os.mkfifo(self.shop.path / "pipe")
        for code, words, said in (
                (3, ["submit", "--hair", self.hair, "--env", "skyy.hdr"], "skyy.hdr"),
                (3, ["submit", "--hair", self.hair, "--occluder", "none.obj"], "none.obj"),
                (3, ["rebake", "--env", self.sky, "--model", self.hair, "--model", "none.hair"], "none.hair"),
                (3, ["upload", self.hair, "none.hdr"], "none.hdr"),
                (3, ["submit", "--hair", "pipe"], "pipe"),
                (3, ["submit", "--hair", self.hair, "--fetch", "/proc/hairbake/out"], "/proc/hairbake/out"),
                (3, ["fetch", "0" * 64, "--out", "/proc/hairbake/out"], "/proc/hairbake/out"),
                (3, ["rebake", "--env", self.sky, "--name", "a", "--fetch", "/proc/hairbake"], "/proc/hairbake"),
                (2, ["fetch", "0" * 64, "--out", "mine"], "mine")):
            with self.subTest(words):
                self.assertIn(said, self.run_failing(code, *words, "--patience", "0", url=url).err)
        self.assertEqual(self.shop.names(), ["groom.hair", "mine", "pipe", "sky.hdr"])

    def test_an_input_in_the_folder_of_the_result_is_never_deleted(self):
        daemon = self.daemon()
        self.run_ok("submit", "--hair", self.hair, *QUICK[:-1], "npy,hair", "--fetch", "out", url=daemon.url)
        inside = str(self.shop.path / "out/transmittance.hair")
        os.symlink(inside, self.shop.path / "link.hair")
        for hair in (inside, "out/transmittance.hair", "link.hair"):
            with self.subTest(hair):
                done = self.run_failing(2, "submit", "--hair", hair, *QUICK, "--fetch", "out", url=daemon.url)
                self.assertIn("lies in the result folder", done.err)
        self.assertIn("transmittance.hair", self.shop.files("out"))
        self.run_ok("submit", "--hair", inside, *QUICK, "--fetch", "other", url=daemon.url)

    def test_output_that_cannot_be_written_is_an_error(self):
        daemon = self.daemon()
        bake = first_word(self.run_ok("submit", "--hair", self.hair, *QUICK, "--wait", url=daemon.url).out)
        for words in (["status"], ["status", bake, "--progress", "json"], ["wait", bake], ["wait", bake, "--progress", "json"],
                      ["submit", "--hair", self.hair, *QUICK], ["upload", self.hair], ["--help"], ["wait", "--help"],
                      ["rebake", "--env", self.sky, "--bake", bake, "--dry-run"], ["fetch", bake, "--out", "out"]):
            server = [] if "--help" in words else ["--server", daemon.url]
            with self.subTest(words), open("/dev/full", "w") as full:
                done = subprocess.run([*self.command, *words, *server], cwd=self.shop.path, env=self.shop.environment,
                                      stdin=subprocess.DEVNULL, stdout=full, stderr=subprocess.PIPE, text=True)
                self.assertEqual(done.returncode, 4, done)
                self.assertIn("standard output cannot be written", done.stderr)
                self.assertNotIn("Exception ignored", done.stderr)

    def test_habits(self):
        """Numbers as people write them, and unknown options as typed."""
        daemon = self.daemon()
        done = self.run_ok("submit", "--hair", self.hair, *QUICK, "--set", "strand.width=.05", "--set",
                           "transmittance.seed=+7", "--set", "strand.width_scale=1.", "--wait", url=daemon.url)
        bake = daemon.ask("GET", f"/v1/bakes/{first_word(done.out)}").json
        self.assertEqual((bake["request"]["strand"]["width"], bake["request"]["transmittance"]["seed"]), (0.05, 7))
        for words, said in ((["status", "--btach", "x"], "status has no option --btach (did you mean --batch?)"),
                            (["status", "--progrss=json"], "no option --progrss=json (did you mean --progress?)")):
            self.assertIn(said, self.run_failing(2, *words, url=daemon.url).err)

    def test_a_server_that_is_not_there(self):
        with socket.create_server(("127.0.0.1", 0)) as free:
            url = f"http://127.0.0.1:{free.getsockname()[1]}"
        self.assertIn(url, self.run_failing(6, "status", "--patience", "0.3", url=url).err)
        self.run_failing(2, "status", url="ftp://127.0.0.1")

    def test_a_certificate_is_checked(self):
        context, certificate = tls_of_localhost(self.shop.path)
        with Proxy(self.daemon(), tls=context) as proxy:
            self.run_ok("submit", "--hair", self.hair, *QUICK, "--fetch", "out", "--ca-file", certificate,
                        url=proxy.url)
            self.assertIn("certificate", self.run_failing(6, "status", url=proxy.url).err)


class Interruptions:
    """What is cut goes on where it stopped."""

    def big_file(self):
        return self.shop.write("big.obj", random.Random(1).randbytes(8_000_000))

    def bake_with_large_files(self, daemon):
        """specular.npy has 33 maps of 6 x 64 x 64 x 3 floats: 9.7 MB."""
        sky = daemon.put(hdr_bytes())
        request = quick_request(environment=sky, irradiance={"face_size": 64, "specular_maps": 33})
        bake = daemon.ask("POST", "/v1/bakes", request).json["id"]
        daemon.wait(bake)
        return bake

    def offsets(self, proxy):
        """Upload-Offset of the PATCH requests."""
        lines = [line for head in proxy.heads if head.startswith("PATCH") for line in head.lower().split("\r\n")]
        return [int(line.split(":")[1]) for line in lines if line.startswith("upload-offset")]

    def test_an_upload_goes_on_after_a_lost_connection(self):
        daemon, big = self.daemon(), self.big_file()
        with Proxy(daemon, cut_sent=4_000_000) as proxy:
            done = self.run_ok("upload", big, url=proxy.url)
            first, second = self.offsets(proxy)
            self.assertEqual(first, 0)
            self.assertGreater(second, 0)
            # The daemon had received everything that was forwarded, but for what its socket held.
            self.assertLess(proxy.sent, 8_000_000 + 1_000_000)
        digest = first_word(done.out).split(":")[1]
        self.assertEqual(daemon.ask("HEAD", f"/v1/blobs/{digest}").status, 200)

    def test_an_upload_of_a_process_that_ended_goes_on_in_the_next(self):
        daemon, big = self.daemon(), self.big_file()
        with Proxy(daemon, cut_sent=4_000_000, stall=True) as proxy:
            process = self.shop.start("upload", big, url=proxy.url)
            self.assertTrue(proxy.stalled.wait(60))
            process.send_signal(signal.SIGINT)
            self.assertEqual(self.shop.end(process).code, 5)
            upload = next((self.shop.path / "cache/hairbake/uploads").iterdir())
        with Proxy(daemon, port=proxy.port) as again:  # uploads are remembered by the server's address
            self.run_ok("upload", big, url=again.url)
            self.assertEqual(len(self.offsets(again)), 1)
            self.assertGreater(self.offsets(again)[0], 0)
        self.assertFalse(upload.exists())  # it is whole: nothing to remember

    def test_a_fetch_goes_on_after_a_lost_connection(self):
        daemon = self.daemon()
        bake = self.bake_with_large_files(daemon)
        with Proxy(daemon, cut_received=4_000_000) as proxy:
            self.run_ok("fetch", bake, "--out", "out", url=proxy.url)
            self.assertEqual(sum("\r\nrange:" in head.lower() for head in proxy.heads), 1)
            size = sum(len(data) for data in self.shop.files("out").values())
            self.assertGreater(size, 9_700_000)
            self.assertLess(proxy.received, size + 1_000_000)  # heads, and what the client's socket held at the cut
        self.assertEqual(sha256(self.shop.files("out")["specular.npy"]), sha256(daemon.file(bake, "specular.npy")))

    def test_a_fetch_of_a_process_that_ended_goes_on_in_the_next(self):
        daemon = self.daemon()
        bake = self.bake_with_large_files(daemon)
        with Proxy(daemon, cut_received=4_000_000, stall=True) as proxy:
            process = self.shop.start("fetch", bake, "--out", "out", url=proxy.url)
            self.assertTrue(proxy.stalled.wait(60))
            part = lambda: sum(f.stat().st_size for f in (self.shop.path / ".out.hairbake-fetch").iterdir())
            until(lambda: part() > 1_000_000, "a part on the disk")
            process.send_signal(signal.SIGTERM)
            self.assertEqual(self.shop.end(process).code, 5)
            self.assertNotIn("out", self.shop.names())
            self.assertGreater(part(), 1_000_000)
        with Proxy(daemon) as again:
            self.run_ok("fetch", bake, "--out", "out", url=again.url)
            self.assertLess(again.received, 9_700_000)
        self.assertEqual(self.shop.files("out")["specular.npy"], daemon.file(bake, "specular.npy"))
        self.assertNotIn(".out.hairbake-fetch", self.shop.names())

    def test_a_part_with_wrong_bytes_is_fetched_anew(self):
        daemon = self.daemon()
        bake = self.bake_with_large_files(daemon)
        specular = daemon.file(bake, "specular.npy")
        (self.shop.path / ".out.hairbake-fetch").mkdir()
        self.shop.write(f".out.hairbake-fetch/{sha256(specular)}", b"x" * 1000)
        self.run_ok("fetch", bake, "--out", "out", url=daemon.url)
        self.assertEqual(self.shop.files("out")["specular.npy"], specular)

    def test_what_the_folder_has_already_is_not_fetched_again(self):
        daemon = self.daemon()
        bake = self.bake_with_large_files(daemon)
        self.run_ok("fetch", bake, "--out", "out", url=daemon.url)
        with Proxy(daemon) as proxy:
            self.run_ok("fetch", bake, "--out", "out", url=proxy.url)
            self.assertLess(proxy.received, 1_000_000)  # the manifest

    def test_wait_outlasts_a_killed_daemon(self):
        daemon = self.daemon()
        model = daemon.put(hair_bytes(strands=100))
        bake = daemon.ask("POST", "/v1/bakes", slow_request(model)).json["id"]
        process = self.shop.start("wait", bake, url=daemon.url)
        daemon.wait_for_worker()
        daemon.kill()
        with self.assertRaises(subprocess.TimeoutExpired):
            process.wait(1.5)  # it goes on trying
        daemon.start()
        done = self.shop.end(process)
        self.assertEqual(done.code, 0, done)
        self.assertIn(f"{bake} done", done.out)


class Lies:
    """Servers are not trusted either."""

    def refuses(self, listed, files=None, **lie):
        with Liar(listed, files or {}, **lie) as liar:
            done = self.run_failing(7, "fetch", ENDED, "--out", "out", url=liar.url)
        self.assertEqual([name for name in self.shop.names() if not name.startswith(".")], ["groom.hair", "sky.hdr"])
        return done

    def test_names_in_a_manifest_cannot_leave_the_folder(self):
        data, outside = b"evil", self.shop.path.parent / "hairbake-evil"
        for name in ("../hairbake-evil", str(outside), "a/b", "..", ".", ".bashrc", "", "manifest.json", "a\\b", "a\nb",
                     "a%2fb"):
            with self.subTest(name):
                entry = {"name": name, "sha256": sha256(data), "bytes": len(data)}
                self.refuses([entry], {name: data, name.rsplit("/", 1)[-1]: data})
                self.assertFalse(outside.exists())

    def test_a_digest_cannot_name_a_place(self):
        self.refuses([{"name": "a.npy", "sha256": "../../../../tmp/x", "bytes": 1}])
        self.refuses([{"name": "a.npy", "sha256": 5, "bytes": 1}])
        self.refuses([{"name": "a.npy", "sha256": "0" * 64, "bytes": -1}])
        self.refuses([{"name": "a.npy", "sha256": "0" * 64, "bytes": "many"}])
        self.refuses("everything")

    def test_other_bytes_than_the_digest_says_are_refused(self):
        entry = {"name": "a.npy", "sha256": sha256(b"good"), "bytes": 4}
        self.assertIn("a.npy", self.refuses([entry], {"a.npy": b"evil"}).err)
        self.assertIn("a.npy", self.refuses([entry], {"a.npy": b"good and more"}).err)
        self.assertIn("manifest", self.refuses([], manifest_tag="0" * 64).err)

    def test_answers_without_end_are_cut(self):
        files = f"/v1/bakes/{ENDED}/files"
        self.refuses([], endless=f"{files}/manifest.json")
        self.refuses([{"name": "a.npy", "sha256": "0" * 64, "bytes": 100}], endless=f"{files}/a.npy")
        with Liar([], {}, endless=f"/v1/bakes/{ENDED}") as liar:
            self.run_failing(7, "status", ENDED, url=liar.url)

    def test_what_is_no_service_is_told_so(self):
        with Liar([], {"bakes?limit=20": b"<html>hello</html>", ENDED: b'{"id": 7, "state": []}'}) as liar:
            self.run_failing(7, "status", ENDED, url=liar.url)
        with TcpLiar(b"HTTP/1.1 200 OK\r\n", b"X-More: " + b"x" * 1000 + b"\r\n") as liar:
            self.run_failing(self.endless_headers, "status", "--patience", "0", url=liar.url)
        with TcpLiar(b"HTTP/1.1 200 OK\r\nContent-Length: 2000\r\n\r\n", b"[" * 2000) as liar:
            self.run_failing(7, "status", ENDED, url=liar.url)

    @property
    def endless_headers(self):
        return 7 if self.command is NATIVE else 6  # Python's library ends the connection itself

    def test_control_characters_of_a_server_do_not_reach_the_terminal(self):
        problem = json.dumps({"title": "\x1b[31mred\x07", "detail": "\x1b]0;title\x07"}).encode()
        head = f"HTTP/1.1 422 No\r\nContent-Type: application/problem+json\r\nContent-Length: {len(problem)}\r\n\r\n"
        with TcpLiar(head.encode() + problem, b"") as liar:
            done = self.run_failing(7, "status", ENDED, url=liar.url)
        self.assertNotIn("\x1b", done.err)
        self.assertNotIn("\x07", done.err)


def both(kind):
    """A class of tests for each of the two clients."""
    return (type(f"Native{kind.__name__}", (kind, Case), {"command": NATIVE}),
            type(f"Python{kind.__name__}", (kind, Case), {"command": PYTHON}))


NativeJobs, PythonJobs = both(Jobs)
NativeRefusals, PythonRefusals = both(Refusals)
NativeInterruptions, PythonInterruptions = both(Interruptions)
NativeLies, PythonLies = both(Lies)

if __name__ == "__main__":
    unittest.main()
