"""nginx sends files of the store as the daemon does."""
import re
import unittest

from front import ACCEL, TOKEN, Front, admin_token
from harness import Daemon, hair_bytes, hdr_bytes, quick_request, sha256


class FilesTest:
    """The same over both kinds of upstream."""
    listen = ""

    @classmethod
    def setUpClass(cls):
        cls.daemon = Daemon(tokens=admin_token(), listen=f"{cls.listen}\n{ACCEL}").__enter__()
        cls.front = Front(cls.daemon).__enter__()

    @classmethod
    def tearDownClass(cls):
        cls.front.__exit__()
        cls.daemon.__exit__()

    def test_every_file_of_a_bake_arrives_whole_under_its_digest(self):
        f = self.front
        bake = f.ask("POST", "/v1/bakes", quick_request(f.put(hair_bytes()), f.put(hdr_bytes()))).json["id"]
        view = f.wait(bake)
        self.assertEqual(view["state"], "done")
        blobs = [file for file in view["files"] if "sha256" in file]
        self.assertGreater(len(blobs), 2)
        for file in blobs:
            reply = f.ask("GET", file["href"])
            self.assertEqual((reply.status, sha256(reply.body), reply.headers["ETag"]),
                             (200, file["sha256"], f'"{file["sha256"]}"'), file["name"])
            self.assertEqual(reply.headers["Content-Type"],
                             "image/png" if file["name"].endswith(".png") else "application/json"
                             if file["name"].endswith(".json") else "application/octet-stream", file["name"])
        manifest = f.ask("GET", f"/v1/bakes/{bake}/files/manifest.json", headers={"Accept-Encoding": "gzip"})
        self.assertEqual((manifest.status, manifest.headers["Content-Encoding"]), (200, "gzip"))

    def test_nginx_sends_blobs_whole_and_in_ranges_as_the_daemon_does(self):
        data = bytes(range(200)) * 10
        digest = self.front.put(data)
        path, tag = f"/v1/blobs/{digest}", f'"{digest}"'

        def get(method="GET", **headers):
            return self.front.ask(method, path, headers={k.replace("_", "-"): v for k, v in headers.items()})

        whole = get()
        self.assertEqual((whole.status, whole.body, whole.headers["ETag"], whole.headers["Content-Type"]),
                         (200, data, tag, "application/octet-stream"))
        for name in ("ETag", "Accept-Ranges", "Content-Type", "X-Content-Type-Options"):
            self.assertEqual(len(whole.headers.get_all(name)), 1, name)
        for text, first, end in (("0-0", 0, 1), ("5-9", 5, 10), ("1990-", 1990, 2000), ("-3", 1997, 2000), ("0-99999", 0, 2000)):
            part = get(Range=f"bytes={text}")
            self.assertEqual((part.status, part.body, part.headers["ETag"]), (206, data[first:end], tag), text)
            self.assertEqual(part.headers["Content-Range"], f"bytes {first}-{end - 1}/2000")
        for text in ("2000-", "2000-2001", "-0"):
            wrong = get(Range=f"bytes={text}")
            self.assertEqual((wrong.status, wrong.headers["Content-Range"], wrong.headers["Content-Type"]),
                             (416, "bytes */2000", "application/problem+json"), text)
        self.assertEqual(get(Range="bytes=0-1,5-6").body, data)  # several ranges: the whole file
        self.assertEqual(get(Range="bytes=0-1", If_Range=tag).status, 206)
        self.assertEqual(get(Range="bytes=0-1", If_Range='"other"').body, data)
        self.assertEqual(get(If_None_Match=f'W/"x", {tag}').status, 304)
        head = get("HEAD")
        self.assertEqual((head.status, head.headers["Content-Length"], head.headers["ETag"], head.body), (200, "2000", tag, b""))

    def test_a_spoiled_blob_is_not_served_after_a_restart(self):
        data = b"as it was sent" * 100
        digest = self.front.put(data)
        path = f"/v1/blobs/{digest}"
        self.assertEqual(self.front.ask("GET", path).body, data)
        self.daemon.kill()
        (self.daemon.path / "store/blobs" / digest[:2] / digest).write_bytes(b"as it is not " * 100 + b"-" * 100)
        self.daemon.listen = re.sub(r"port = \d+", f"port = {self.daemon.port}", self.daemon.listen)  # nginx knows this one
        self.daemon.start()
        reply = self.front.ask("GET", path)
        self.assertEqual((reply.status, reply.headers["Content-Type"]), (404, "application/problem+json"))
        self.assertIn(f"send the file sha256:{digest} again", reply.json["detail"])
        self.assertEqual(self.front.ask("GET", path).status, 404)


class FilesOverLoopback(FilesTest, unittest.TestCase):
    listen = "port = 0"

    def test_only_what_came_through_nginx_is_left_to_nginx(self):
        data = b"some bytes"
        path = f"/v1/blobs/{self.front.put(data)}"
        token = {"Authorization": f"Bearer {TOKEN}"}
        self.assertEqual(self.daemon.ask("GET", path, headers=token).body, data)
        left = self.daemon.ask("GET", path, headers={**token, "X-Forwarded-For": "192.0.2.1"})
        self.assertEqual((left.status, left.body, left.headers["X-Accel-Redirect"]),
                         (200, b"", f"/blobs/{sha256(data)[:2]}/{sha256(data)}"))

    def test_short_replies_need_no_buffer_and_only_nginx_learns_it(self):
        def word(path, **more):
            reply = self.daemon.ask("GET", path, headers={"Authorization": f"Bearer {TOKEN}", **more})
            self.assertEqual(reply.status, 200)
            return len(reply.body), reply.headers.get("X-Accel-Buffering")

        forwarded = {"X-Forwarded-For": "192.0.2.1"}
        self.assertEqual(word("/v1/bakes", **forwarded)[1], "no")
        self.assertIsNone(word("/v1/bakes")[1])
        size, buffering = word("/openapi.json", **forwarded)
        self.assertGreater(size, 6144)  # more than nginx's first read
        self.assertIsNone(buffering)
        size, buffering = word("/metrics", **forwarded, **{"Accept-Encoding": "gzip"})
        self.assertGreater(size, 1000)  # nginx compresses it
        self.assertIsNone(buffering)
        self.assertIsNone(self.front.ask("GET", "/v1/bakes").headers.get("X-Accel-Buffering"))


class FilesOverSocket(FilesTest, unittest.TestCase):
    listen = 'socket = "socket"'


if __name__ == "__main__":
    unittest.main()
