"""Replies and messages that people read: which field or file, what was found, what is allowed, what to do."""
import contextlib
import os
import subprocess
import time
import unittest

from disks import SmallDisk
from harness import PATIENCE, PROGRAMS, TUS, Daemon, hair_bytes, hdr_bytes, quick_request, sha256
from rooms import eventually, head, under_way

OCTETS = {"Content-Type": "application/octet-stream"}


class Texts(unittest.TestCase):
    def test_the_place_of_what_is_not_parsed_is_named(self):
        """Fault: "the body is not a field", and refusals that named no field. Relatives: other routes with a body."""
        large = "1" * 40_000
        for path, field in (("/v1/bakes", "hair"), ("/v1/rebakes", "environment"), ("/v1/models", "sha256")):
            with Daemon() as d:
                for body, status, words in (
                        ('{"": 1}', 422, '"" is not a field; allowed are '),
                        (f'{{"{field}": "{large}"}}', 422, f"{field} is a text or number of more than 32768 bytes; allowed are"),
                        (f'{{"{field}": {large}}}', 422, f"{field} is a text or number of more than 32768 bytes"),
                        (f'{{"{large}": 1}}', 422, "the body has a field whose name is a text or number"),
                        (f'{{"{field}": {"[" * 50_000}', 422, f"{field} is [...]; allowed is"),
                        (f'{{"{field}": "'.encode() + b'\xe2\x82"}', 400,
                         f"{field} is no UTF-8: the byte 0xe2 at byte {len(field) + 6} of the body begins no whole character"),
                        ('{"' + "ü" * 40 + '": 1}', 422, "ü" * 30 + "... is not a field")):
                    with self.subTest(path, words=words):
                        reply = d.ask("POST", path, body if isinstance(body, bytes) else body.encode(),
                                      {"Content-Type": "application/json"})
                        self.assertEqual(reply.status, status, reply.body)
                        self.assertIn(words, reply.json["detail"])
                        self.assertNotIn("\ufffd", reply.json["detail"])

    def test_a_digest_may_have_its_prefix_everywhere(self):
        """Fault: PUT of a name refused "sha256:". Relatives: every other address and field that takes a digest."""
        with Daemon() as d:
            hair, sky = d.put(hair_bytes()), d.put(hdr_bytes())
            self.assertEqual(d.ask("POST", "/v1/models", {"sha256": f"sha256:{hair}"}).status, 201)
            for digest in (hair, f"sha256:{hair}"):
                name = d.ask("PUT", "/v1/names/model/hero/hair", {"sha256": digest})
                self.assertEqual((name.status, name.json["sha256"], name.json["version"]), (200, hair, 1))
                model = d.ask("GET", f"/v1/models/{digest}")
                self.assertEqual((model.status, model.json["id"]), (200, hair))
                self.assertEqual(d.ask("GET", f"/v1/models/{digest}/thumbnail.png").status, 200)
                self.assertEqual(sha256(d.ask("GET", f"/v1/blobs/{digest}").body), hair)
                self.assertEqual(d.ask("PUT", f"/v1/blobs/{digest}", hair_bytes()).headers["Location"], f"/v1/blobs/{hair}")
                upload = d.create_upload(hair_bytes(), digest)
                self.assertEqual(upload.status, 201)
                done = d.append(upload.headers["Location"], 0, hair_bytes())
                self.assertEqual((done.status, done.headers["Hairbake-Blob"]), (204, f"/v1/blobs/{hair}"))
            self.assertEqual(d.ask("DELETE", f"/v1/models/sha256:{hair}?force=1").status, 204)
            self.assertEqual(d.ask("DELETE", f"/v1/blobs/sha256:{sky}").status, 204)
            for wrong in (hair[:-1], f"sha256:{hair.upper()}", f"sha256:sha256:{hair}", f"md5:{hair}"):
                self.assertEqual(d.ask("PUT", "/v1/names/model/x", {"sha256": wrong}).status, 422, wrong)
                self.assertEqual(d.ask("GET", f"/v1/blobs/{wrong}").status, 422, wrong)

    def test_a_deletion_says_as_what_the_file_is_stored(self):
        """Fault: a file without a kind was "stored as the kind mesh". Relative: one that a name uses as an environment."""
        with Daemon() as d:
            hair, mesh = d.put(hair_bytes()), d.put(b"a mesh")
            self.assertEqual(d.ask("PUT", "/v1/names/environment/dusk", {"sha256": mesh}).status, 200)
            self.assertEqual(d.ask("POST", "/v1/models", {"sha256": hair}).status, 201)
            for path, status, words in ((f"/v1/blobs/{hair}", 409, f"the kind model; DELETE /v1/models/{hair} deletes it"),
                                        (f"/v1/environments/{hair}", 404, f"the kind model; DELETE /v1/models/{hair} deletes it"),
                                        (f"/v1/models/{mesh}", 404, f"is stored, and as no model or environment; DELETE /v1/blobs/{mesh} deletes it")):
                reply = d.ask("DELETE", path)
                self.assertEqual((reply.status, reply.json["field"]), (status, "kind"), reply.body)
                self.assertIn(words, reply.json["detail"])
            reply = d.ask("DELETE", f"/v1/models/{'0' * 64}")
            self.assertEqual((reply.status, reply.json.get("field")), (404, None))

    def test_help_is_no_error(self):
        for words in (["--help"], ["-h"], ["store", "accept", "--help"], ["token", "--help"]):
            run = subprocess.run([PROGRAMS / "hairbaked", *words], capture_output=True, text=True, timeout=PATIENCE)
            self.assertEqual((run.returncode, run.stderr), (0, ""), words)
            self.assertIn("hairbaked [--config FILE]", run.stdout)
        run = subprocess.run([PROGRAMS / "hairbaked", "--halp"], capture_output=True, text=True, timeout=PATIENCE)
        self.assertEqual((run.returncode, run.stdout), (2, ""))
        self.assertIn("hairbaked [--config FILE]", run.stderr)


    def test_what_the_json_library_says_is_told_in_plain_words_with_the_place(self):
        """Fault: "[json.exception.out_of_range.406] number overflow". Relatives: surrogates, other routes, other mistakes."""
        cases = (
            ('{"transmittance": {"directions": 1e999}}',
             "transmittance.directions is not JSON: the number 1e999 is too large; allowed are numbers up to 1.797e308"),
            ('{"irradiance": {"lights": [{"direction": [0, -1e4000, 0]}]}}', "irradiance.lights[0].direction[1] is not JSON: the number"),
            ('{"hair": "\\uD800x"}', "hair is not JSON: a text has one half of a pair"),
            ('{"hair": "\\uDC00"}', "hair is not JSON: a text has one half of a pair"),
            ('{"\\uD800": 1}', "the body is not JSON: a text has one half of a pair"),
            ('{"hair": "a\nb"}', "hair is not JSON: parse error at line 2"),
            ('{"hair": tru}', "hair is not JSON: parse error at line 1, column 13"),
            ('{"hair": null', "the body is not JSON: parse error at line 1, column 14"),
            ('', "the body is not JSON: parse error at line 1, column 1"))
        with Daemon() as d:
            for body, words in cases:
                with self.subTest(body):
                    reply = d.ask("POST", "/v1/bakes", body.encode(), {"Content-Type": "application/json"})
                    self.assertEqual((reply.status, reply.json["type"]), (400, "urn:hairbake:problem:malformed"), reply.body)
                    self.assertIn(words, reply.json["detail"])
                    self.assertNotIn("json.exception", reply.json["detail"])
            for path, field in (("/v1/rebakes", "priority"), ("/v1/models", "sha256")):
                reply = d.ask("POST", path, f'{{"{field}": 1e999}}'.encode(), {"Content-Type": "application/json"})
                self.assertEqual((reply.status, reply.json["field"]), (400, field))
                self.assertIn(f"{field} is not JSON: the number 1e999 is too large", reply.json["detail"])
            worker = d.path / "worker"  # its manifest, whose faults reach the bake's error
            worker.write_text("#!/bin/sh\nfor folder; do :; done\n"
                              "grep -q trial \"$folder/task.json\" && exec " + str(PROGRAMS / "hairbake-worker") + " \"$@\"\n"
                              "mkdir \"$folder/result\"; echo '{}' > \"$folder/result/manifest.json\"\n"
                              "echo '{\"done\": {}}' > \"$folder/words.jsonl\"\n")
            worker.chmod(0o755)
            d.stop()
            d.limits, d.max_crashes = f'program = "{worker}"', 0
            d.start()
            view = d.wait(d.ask("POST", "/v1/bakes", quick_request(d.put(hair_bytes()))).json["id"])
            self.assertIn("the worker's manifest is not of the known form: key 'stages' not found", view["error"]["message"])

    def test_control_characters_are_shown(self):
        """Fault: a NUL cut the message. Relatives: other characters, a query, a path, a header."""
        with Daemon() as d:
            for character, shown in (("\0", "\\u0000"), ("\n", "\\u000a"), ("\x1b", "\\u001b"), ("\x7f", "\\u007f")):
                with self.subTest(shown):
                    reply = d.ask("POST", "/v1/bakes", {"hair": f"name:a{character}b"})
                    self.assertEqual(reply.status, 422)
                    self.assertEqual(reply.json["detail"], f"hair asks for name:a{shown}b, which is no name of the kind model")
                    reply = d.ask("POST", "/v1/bakes", {"hair": f"{character}b"})
                    self.assertIn(f'hair is "{shown}b"; allowed is', reply.json["detail"])
                    reply = d.ask("POST", "/v1/bakes", {f"ha{character}ir": 1})
                    self.assertIn(f"ha{shown}ir is not a field; allowed are", reply.json["detail"])
                    reply = d.ask("PUT", "/v1/names/model/x", {"sha256": f"a{character}b"})
                    self.assertEqual(reply.status, 422, reply.body)
                    self.assertNotIn(character, reply.json["detail"])
                    encoded = f"%{ord(character):02x}"
                    reply = d.ask("GET", f"/v1/bakes/a{encoded}b?state=x")
                    self.assertEqual(reply.status, 400)
                    self.assertIn(f'the address "/v1/bakes/a{encoded}b?state=x" is not a plain path; allowed is', reply.json["detail"])
            answer = d.raw(b"GET /healthz HTTP/1.1\r\nHost: localhost\r\nX-Test: a%01b\r\n\r\n")
            self.assertIn(b'the header \\"X-Test\\" has a control character: \\"a\\\\u0001b\\"', answer)

    def test_routes_are_printed_alone(self):
        """Fault: the lines of a store's log stood before them. Relative: a new token."""
        run = subprocess.run([PROGRAMS / "hairbaked", "routes"], capture_output=True, text=True, timeout=PATIENCE)
        self.assertEqual((run.returncode, run.stderr), (0, ""))
        for line in run.stdout.splitlines():
            self.assertRegex(line, r"^(GET|HEAD|POST|PUT|PATCH|DELETE|OPTIONS) /\S* (open|read|upload|bake|admin) \d+( \S+/\S+)*$")
        run = subprocess.run([PROGRAMS / "hairbaked", "token", "new"], capture_output=True, text=True, timeout=PATIENCE)
        self.assertEqual((run.returncode, run.stderr), (0, ""))

    def test_a_limit_of_file_size_is_told_with_the_file_and_the_remedy(self):
        """Fault: "the store/result/transmittance.npy cannot be written: File too large". Relative: a full disk."""
        with Daemon() as d:
            worker = d.path / "worker"
            worker.write_text(f"#!/bin/sh\nulimit -f 4\nexec {PROGRAMS / 'hairbake-worker'} \"$@\"\n")
            worker.chmod(0o755)
            d.stop()
            d.limits = f'program = "{worker}"'
            d.start()
            bake = d.ask("POST", "/v1/bakes", quick_request(d.put(hair_bytes(strands=1000)))).json["id"]
            trouble = lambda: d.ask("GET", f"/v1/bakes/{bake}").json["stages"][0].get("trouble", "")
            eventually(lambda: "File too large" in trouble())
            self.assertRegex(trouble(), r"^the result's file transmittance\.npy cannot be written: File too large\. A limit of the "
                             r"size of files holds for this process \(`ulimit -f`, LimitFSIZE= of its unit\)")
        with SmallDisk() as d:
            # (33 + 1) maps of 6 x 48 x 48 texels of 12 bytes are 5.6 MB
            request = quick_request(environment=d.put(hdr_bytes()), irradiance={"face_size": 48, "specular_maps": 33})
            d.fill(leave=1 << 20)
            bake = d.ask("POST", "/v1/bakes", request).json["id"]
            trouble = lambda: d.ask("GET", f"/v1/bakes/{bake}").json["stages"][0].get("trouble", "")
            eventually(lambda: "No space left on device" in trouble())
            self.assertIn("ake room on", trouble())
            self.assertNotIn("the store/", trouble())

    def test_a_deletion_that_cannot_remove_the_file_is_refused(self):
        """Fault: 204 without a log line, and the file stayed. Relatives: a model, a result that should be evicted, an upload."""
        with Daemon(config="budget_mb = 1\nblob_mb = 2\nkeep_free_mb = 0") as d:
            d.become_bound_to_modes()
            mesh, model = d.put(b"a mesh"), d.put(hair_bytes())
            self.assertEqual(d.ask("POST", "/v1/models", {"sha256": model}).status, 201)
            upload = d.create_upload(b"an upload").headers["Location"]
            store = d.path / "store"
            for path, folder, file in ((f"/v1/blobs/{mesh}", d.blob_file(mesh).parent, d.blob_file(mesh)),
                                       (f"/v1/models/{model}", d.blob_file(model).parent, d.blob_file(model)),
                                       (upload, store / "uploads", store / "uploads" / upload.rsplit("/", 1)[1])):
                with self.subTest(path):
                    folder.chmod(0o500)
                    reply = d.ask("DELETE", path, headers=TUS)
                    self.assertEqual((reply.status, reply.json["type"]), (503, "urn:hairbake:problem:unwritable"), reply.body)
                    self.assertIn(f"in {folder}: Permission denied", reply.json["detail"])
                    self.assertTrue(file.exists())
                    self.assertTrue((store / "reserve").exists())  # which is for a full disk
                    folder.chmod(0o750)
                    self.assertEqual(d.ask("DELETE", path, headers=TUS).status, 204)
                    self.assertFalse(file.exists())
            sky = d.put(hdr_bytes())
            request = quick_request(environment=sky, irradiance={"face_size": 32, "specular_maps": 6})
            bake = d.ask("POST", "/v1/bakes", request).json["id"]
            self.assertEqual(d.wait(bake)["state"], "done")
            folders = list((store / "blobs").iterdir())
            for folder in folders:
                folder.chmod(0o500)
            data = os.urandom(600_000)
            self.assertEqual(d.ask("PUT", f"/v1/blobs/{sha256(data)}", data).status, 503)
            self.assertEqual(d.ask("GET", f"/v1/bakes/{bake}").json["state"], "done")  # neither forgotten nor removed
            for folder in folders:
                folder.chmod(0o750)
            d.put(data)
            self.assertEqual(d.ask("GET", f"/v1/bakes/{bake}").status, 410)


class Refused(unittest.TestCase):
    def test_without_tokens_the_header_is_named_with_what_is_allowed_and_the_remedy(self):
        """Fault: 403 "answers this machine alone". Relatives: the origin, a proxy."""
        with Daemon() as d:
            for headers, slug, words in (
                    ({"Host": "farm.example:8080"}, "no-tokens",
                     ('the header Host is "farm.example:8080"; allowed are localhost, 127.0.0.1 and [::1], with any port',
                      "configure a token ([[token]])")),
                    ({"Origin": "https://evil.example"}, "foreign-origin",
                     ('the header Origin is "https://evil.example"', 'the address in Host, "localhost"', "proxy_set_header Host $http_host")),
                    ({"X-Forwarded-For": "192.0.2.1"}, "no-tokens",
                     ("a proxy forwarded the request (it has the header X-Forwarded-For)", "configure a token ([[token]])"))):
                with self.subTest(headers):
                    reply = d.ask("GET", "/v1/bakes", headers=headers)
                    self.assertEqual((reply.status, reply.json["type"]), (403, f"urn:hairbake:problem:{slug}"))
                    for part in words:
                        self.assertIn(part, reply.json["detail"])
            long = d.ask("GET", "/v1/bakes", headers={"Host": "x" * 5000}).json["detail"]
            self.assertIn("x" * 200 + '..."', long)
            self.assertLess(len(long), 1000)

    def test_relative_with_tokens_the_scope_and_the_token_are_named(self):
        token = "a" * 43
        tokens = f'[[token]]\nname = "farm"\nsha256 = "{sha256(token.encode())}"\nscopes = ["read", "upload"]\n'
        with Daemon(tokens=tokens) as d:
            known = {"Authorization": f"Bearer {token}"}
            for headers, status, words in (
                    (known, 403, 'the token "farm" has the scopes read, upload; needed is bake or admin'),
                    ({}, 401, "the request has no token; needed is Authorization: Bearer TOKEN"),
                    ({"Authorization": "Bearer wrong"}, 401, "the header Authorization has no valid token"),
                    ({"Cookie": "hairbake_session=old"}, 401, "the session has ended")):
                with self.subTest(headers):
                    reply = d.ask("POST", "/v1/bakes", {}, headers)
                    self.assertEqual(reply.status, status)
                    self.assertIn(words, reply.json["detail"])
                    self.assertNotIn(token, reply.json["detail"])


class TooMany(unittest.TestCase):
    """Fault: a 429 said neither how many there are nor how many are allowed."""

    def test_bodies_at_once(self):
        """Those of one address: server/http/body_limits_test.cpp."""
        with Daemon(listen="port = 0\nbodies = 2") as d, contextlib.ExitStack() as stack:
            begun = head("PUT", f"/v1/blobs/{'0' * 64}", 100)
            for count in range(2):
                stack.enter_context(under_way(d, begun + b"x"))
                end = time.monotonic() + PATIENCE
                while len(d.leftovers()) <= count:
                    self.assertLess(time.monotonic(), end)
                    time.sleep(0.02)
            reply = d.ask("PUT", f"/v1/blobs/{sha256(b'x')}", b"x")
            self.assertEqual((reply.status, reply.headers["Retry-After"]), (429, "1"))
            self.assertIn("2 uploads and long bodies are under way; allowed are up to 2 at once ([listen] bodies): try again in "
                          "1 s", reply.json["detail"])

    def test_the_wait_follows_from_how_long_bodies_take(self):
        """Fault: it was always 1 s. The mean rest of n bodies is 1/(n + 1) of what they took so far: server/http/place_times_test.cpp."""
        with Daemon(listen="port = 0\nbodies = 1") as d, under_way(d, head("PUT", f"/v1/blobs/{'0' * 64}", 100) + b"x"):
            end = time.monotonic() + PATIENCE
            while not d.leftovers():
                self.assertLess(time.monotonic(), end)
            time.sleep(2.2)
            reply = d.ask("PUT", f"/v1/blobs/{sha256(b'x')}", b"x")
            self.assertEqual(reply.status, 429)
            self.assertGreaterEqual(int(reply.headers["Retry-After"]), 2)
            self.assertIn(f"try again in {reply.headers['Retry-After']} s", reply.json["detail"])

    def test_relative_the_first_of_the_unfinished_uploads_ends_sooner(self):
        with Daemon(config="open_uploads = 1\nupload_lifetime_s = 20") as d:
            self.assertEqual(d.create_upload(b"12").status, 201)
            reply = d.create_upload(b"12")
            self.assertEqual(reply.status, 429)
            self.assertIn(int(reply.headers["Retry-After"]), range(1, 21))
            self.assertIn(f"try again in {reply.headers['Retry-After']} s", reply.json["detail"])

    def test_relative_a_paused_queue(self):
        """/readyz said 5 s; the next try may be 30 s away."""
        with Daemon() as d:
            d.stop()
            d.limits = f'program = "{d.path / "worker"}"'
            d.start()
            d.ask("POST", "/v1/bakes", quick_request(d.put(hair_bytes())))
            eventually(lambda: int(d.ask("GET", "/readyz").headers["Retry-After"] or 0) > 5)

    def test_relative_unfinished_uploads_of_one_token(self):
        with Daemon(config="open_uploads = 2\nupload_lifetime_s = 3600") as d:
            for _ in range(2):
                self.assertEqual(d.create_upload(b"12").status, 201)
            reply = d.create_upload(b"12")
            self.assertEqual((reply.status, reply.headers["Retry-After"]), (429, "60"))
            self.assertIn("there are 2 unfinished uploads of this token; allowed are 2: finish some or delete them, and try again "
                          "in 60 s; one that receives nothing for 3600 s ends by itself", reply.json["detail"])


class Continue(unittest.TestCase):
    """Fault: a request that waits for "100 Continue" got it before a refusal whose reason was known from its head."""

    def answer(self, d, begun):
        """The status lines that come before any byte of the body is sent."""
        with d.connect(timeout=5) as connection:
            connection.sendall(begun)
            reply = connection.recv(4096)
            return [line.split()[1] for line in reply.splitlines() if line.startswith(b"HTTP/1.1 ")]

    def test_a_refusal_comes_alone(self):
        """Relatives of the budget: routes, tokens, length, type, digest, an upload's offset; and other spellings."""
        expect = {"Expect": "100-continue"}
        with Daemon(config="budget_mb = 1\nblob_mb = 2\nkeep_free_mb = 0") as d:
            upload = d.create_upload(b"an upload").headers["Location"]
            patch = {**expect, **TUS, "Content-Type": "application/offset+octet-stream"}
            blob = f"/v1/blobs/{'0' * 64}"
            for status, begun in ((b"507", head("PUT", blob, (1 << 20) + 1, expect)),
                                  (b"507", head("PUT", blob, (1 << 20) + 1, {"Expect": "100-Continue"})),
                                  (b"507", head("POST", "/v1/environments", (1 << 20) + 1, {**expect, **OCTETS})),
                                  (b"413", head("PUT", blob, 3 << 20, expect)), (b"404", head("PUT", "/nothing", 5, expect)),
                                  (b"422", head("PUT", "/v1/blobs/wrong", 5, expect)),
                                  (b"415", head("POST", "/v1/bakes", 5, {**expect, "Content-Type": "text/plain"})),
                                  (b"409", head("PATCH", upload, 5, {**patch, "Upload-Offset": 4})),
                                  (b"413", head("PATCH", upload, 50, {**patch, "Upload-Offset": 0}))):
                self.assertEqual(self.answer(d, begun), [status], begun)
        with Daemon(tokens='[[token]]\nname = "x"\nsha256 = "' + "0" * 64 + '"\nscopes = ["read"]\n') as d:
            self.assertEqual(self.answer(d, head("PUT", blob, 5, expect)), [b"401"])

    def test_a_body_that_is_taken_is_asked_for_once(self):
        data = b"x" * 100_000
        with Daemon() as d:
            for name, begun, body in (("length", head("PUT", f"/v1/blobs/{sha256(data)}", len(data), {"Expect": "100-continue"}), data),
                                      ("chunks", head("PUT", f"/v1/blobs/{sha256(data)}", None, {"Expect": "100-continue"}),
                                       b"%x\r\n" % len(data) + data + b"\r\n0\r\n\r\n")):
                with self.subTest(name), d.connect() as connection:
                    connection.sendall(begun)
                    self.assertEqual(connection.recv(4096), b"HTTP/1.1 100 Continue\r\n\r\n")
                    connection.sendall(body)
                    self.assertIn(connection.recv(4096).split()[1], (b"200", b"201"))
            # A client that does not wait, and one of HTTP/1.0, get none.
            answer = d.raw(head("PUT", f"/v1/blobs/{sha256(b'abc')}", 3, {"Expect": "100-continue"}) + b"abc")
            self.assertTrue(answer.startswith(b"HTTP/1.1 201"), answer)
            old = head("PUT", f"/v1/blobs/{sha256(b'abcd')}", 4, {"Expect": "100-continue"}).replace(b"HTTP/1.1", b"HTTP/1.0")
            self.assertRegex(d.raw(old, b"abcd", pause=0.2), rb"^HTTP/1\.[01] 201")


if __name__ == "__main__":
    unittest.main()
