"""Replies and messages that people read: which field or file, what was found, what is allowed, what to do."""
import contextlib
import subprocess
import time
import unittest

from harness import PATIENCE, PROGRAMS, TUS, Daemon, hair_bytes, hdr_bytes, sha256
from rooms import head, under_way

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
        with Daemon() as d:
            hair, mesh = d.put(hair_bytes()), d.put(b"a mesh")
            self.assertEqual(d.ask("POST", "/v1/models", {"sha256": hair}).status, 201)
            for path, status, words in ((f"/v1/blobs/{hair}", 409, f"the kind model; DELETE /v1/models/{hair} deletes it"),
                                        (f"/v1/environments/{hair}", 404, f"the kind model; DELETE /v1/models/{hair} deletes it"),
                                        (f"/v1/models/{mesh}", 404, f"the kind mesh; DELETE /v1/blobs/{mesh} deletes it")):
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
