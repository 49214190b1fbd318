"""nginx in front of the daemon, with the committed configuration; and hostile requests, to nginx and to the daemon itself."""
import http.client
import os
import re
import socket
import subprocess
import threading
import time
import unittest
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import hostile
from front import TOKEN, Front, admin_token, trusting
from harness import PATIENCE, Daemon, Reply, base64_text, hair_bytes, hdr_bytes, quick_request, sha256

AUTHORITY = f"Host: localhost\r\nAuthorization: Bearer {TOKEN}\r\n"
REFUSALS = {400, 404, 405, 408, 413, 414, 415, 422, 431, 501, 505}
ACCEL = 'accel = "/blobs/"'


def statuses(answer):
    """Of the replies in what a raw connection gave."""
    return [int(s) for s in re.findall(rb"HTTP/1\.1 (\d{3}) ", answer)]


def probe(target, data):
    """What comes back for bytes sent as they are, until the other side closes. When it says nothing for a while, this side ends
    the connection first: nginx keeps it after an answer, and either may wait for the rest of a request."""
    answer = b""
    with socket.create_connection(("127.0.0.1", target.port), timeout=PATIENCE) as s:
        try:
            s.sendall(data)
            while True:
                s.settimeout(0.3 if answer else 2)
                piece = s.recv(65536)
                answer += piece
                if not piece:
                    return answer
        except TimeoutError:
            s.settimeout(PATIENCE)
        except (BrokenPipeError, ConnectionResetError):
            pass  # the reply may have come before
        try:
            s.shutdown(socket.SHUT_WR)
            while piece := s.recv(65536):
                answer += piece
        except OSError:
            pass
    return answer


def resident_bytes(process):
    return int(re.search(r"VmRSS:\s+(\d+) kB", Path(f"/proc/{process}/status").read_text()).group(1)) * 1024


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


class Gate(unittest.TestCase):
    """What nginx lets through and what it answers by itself."""

    def check_problem(self, reply, status):
        self.assertEqual((reply.status, reply.headers["Content-Type"]), (status, "application/problem+json"))
        self.assertEqual(reply.json["status"], status)
        self.assertTrue(reply.json["type"].startswith("urn:hairbake:problem:") and reply.json["title"] and reply.json["detail"])

    def test_without_tokens_nothing_is_forwarded(self):
        with Daemon() as d, Front(d) as f:
            for method, path in (("GET", "/healthz"), ("GET", "/v1/bakes"), ("GET", "/metrics"), ("POST", "/v1/rebakes"),
                                 ("PUT", f"/v1/blobs/{sha256(b'x')}"), ("DELETE", "/v1/session")):
                for headers in ({}, {"Host": "localhost"}, {"X-Forwarded-For": ""}):
                    reply = f.ask(method, path, b"x" if method == "PUT" else None, headers)
                    self.check_problem(reply, 403)
                    self.assertEqual(reply.json["type"], "urn:hairbake:problem:no-tokens")
            self.assertEqual(d.ask("GET", "/v1/bakes").status, 200)
            self.assertEqual(d.ask("GET", "/v1/bakes", headers={"Forwarded": "for=192.0.2.1"}).status, 403)

    def test_files_of_the_store_cannot_be_asked_for_from_outside(self):
        with Daemon(tokens=admin_token(), listen=f"port = 0\n{ACCEL}") as d, Front(d) as f:
            digest = f.put(b"the secret")
            inside = f"/blobs/{digest[:2]}/{digest}"
            for path in (inside, f"/{inside}", f"/x/..{inside}", inside.replace("/b", "/%62"), inside.replace("/b", "/./b"),
                         f"/v1/blobs/..%2f..{inside}", f"{inside}?x", "/blobs/", "/problem", f"http://localhost{inside}"):
                answer = f.raw(f"GET {path} HTTP/1.1\r\n{AUTHORITY}Connection: close\r\n\r\n".encode())
                self.assertIn(statuses(answer), ([404], [400]), path)
                self.assertNotIn(b"the secret", answer)
            for headers in ({"X-Accel-Redirect": inside}, {"X-Accel-Redirect": inside, "Authorization": ""},
                            {"X-Test": f"%0d%0aX-Accel-Redirect:%20{inside}"}):
                reply = f.ask("GET", "/healthz", headers=headers)
                self.assertIn(reply.status, (200, 400))
                self.assertNotIn(b"the secret", reply.body)

    def test_errors_of_nginx_are_problems(self):
        with Daemon(tokens=admin_token()) as d, Front(d, body="1m") as f:
            for method, path, headers, status in (
                    ("GET", "/" + "a" * 20000, {}, 414), ("TRACE", "/", {}, 405), ("GET", "/blobs/x", {}, 404),
                    ("GET", "/", {"X": "a" * 20000}, 431), ("PUT", "/v1/blobs/x", {"Content-Length": "2000000"}, 413),
                    ("POST", "/v1/bakes", {"Content-Length": "20000000"}, 413)):
                reply = f.ask(method, path, headers=headers)
                self.check_problem(reply, status)
                self.assertEqual(reply.headers["X-Content-Type-Options"], "nosniff")
                self.assertNotIn("/", reply.headers["Server"])
            d.kill()
            reply = f.ask("GET", "/v1/bakes")
            self.check_problem(reply, 503)
            self.assertEqual(reply.headers["Retry-After"], "5")
            d.start()

    def test_replies_carry_security_headers_once(self):
        with Daemon(tokens=admin_token()) as d, Front(d) as f:
            reply = f.ask("GET", "/v1/bakes")
            for name, value in (("X-Content-Type-Options", "nosniff"), ("X-Frame-Options", "DENY"), ("Referrer-Policy", "no-referrer"),
                                ("Content-Security-Policy", "default-src 'none'; frame-ancestors 'none'")):
                self.assertEqual(reply.headers.get_all(name), [value])
            self.assertIsNone(reply.headers["Strict-Transport-Security"])

    def test_too_many_requests_get_429(self):
        with Daemon(tokens=admin_token()) as d, Front(d, rate="1r/s") as f:
            connection = http.client.HTTPConnection("127.0.0.1", f.port)
            for count in range(3000):  # 500 in a burst, then one a second: at less than 1.2 a second it would not be told
                connection.request("GET", "/healthz")
                reply = connection.getresponse()
                reply = Reply(reply.status, reply.headers, reply.read())
                if reply.status != 200:
                    break
            connection.close()
            self.check_problem(reply, 429)
            self.assertEqual(reply.headers["Retry-After"], "1")
            self.assertGreaterEqual(count, 500)

    def test_a_refused_upload_gets_its_refusal(self):
        with Daemon(tokens=admin_token(), config="blob_mb = 1") as d, Front(d) as f:
            data = os.urandom(8 << 20)
            for headers, status in (({"Authorization": ""}, 401), ({}, 413)):
                reply = f.ask("PUT", f"/v1/blobs/{sha256(data)}", data, headers)
                self.check_problem(reply, status)


HELD = 60          # sockets of one address that do not end their bodies; nginx once had 48 places for uploads in all
OTHER = "127.0.0.2"
SECRETS = {"reader": "read", "sender": "upload"}  # tokens and their scopes


def tokens():
    return admin_token() + "".join(f'[[token]]\nname = "{name}"\nsha256 = "{sha256(name.encode())}"\nscopes = ["{scope}"]\n'
                                   for name, scope in SECRETS.items())


class Held:
    """`with Held(front, method, path, token, length) as held:`; sockets of one address that have sent a head and go on to send
    a byte of their bodies now and then, whatever the answer is: so nginx waits for the rest of each."""

    def __init__(self, front, method, path, token=None, length=1_000_000, more="", count=HELD):
        self.front, self.count = front, count
        authority = f"Authorization: Bearer {token}\r\n" if token else ""
        self.head = (f"{method} {path} HTTP/1.1\r\nHost: localhost\r\n{authority}{more}Content-Length: {length}\r\n\r\nx").encode()
        self.sockets, self.answers, self.ended = [], {}, threading.Event()
        self.lock = threading.Lock()  # a TLS connection is for one thread at a time

    def __enter__(self):
        for _ in range(self.count):
            s = socket.create_connection(("127.0.0.1", self.front.port), timeout=PATIENCE)
            if self.front.tls:
                s = trusting(self.front).wrap_socket(s, server_hostname="localhost")
            s.sendall(self.head)
            s.setblocking(False)
            self.sockets.append(s)
        self.thread = threading.Thread(target=self.trickle)
        self.thread.start()
        return self

    def trickle(self):
        while not self.ended.wait(0.5):
            for s in self.sockets:
                with self.lock:
                    try:
                        s.send(b"x")
                    except OSError:
                        pass  # closed after its answer

    def statuses(self, count):
        """Of the answers so far; waits until there are `count`."""
        end = time.monotonic() + PATIENCE
        while len(self.answers) < count and time.monotonic() < end:
            for s in set(self.sockets) - set(self.answers):
                with self.lock:
                    try:
                        if found := statuses(s.recv(4096)):
                            self.answers[s] = found[0]
                    except OSError:
                        pass  # nothing yet
            time.sleep(0.02)
        return list(self.answers.values())

    def __exit__(self, *_):
        self.ended.set()
        self.thread.join()
        for s in self.sockets:
            s.close()


class Places(unittest.TestCase):
    """One address cannot take the places of others, and a body that was not let in has none."""
    tls = False
    BLOB = f"/v1/blobs/{'0' * 64}"
    TUS = "Tus-Resumable: 1.0.0\r\nUpload-Offset: 0\r\nContent-Type: application/offset+octet-stream\r\n"

    @classmethod
    def setUpClass(cls):
        cls.daemon = Daemon(tokens=tokens(), config="blob_mb = 32").__enter__()
        cls.front = Front(cls.daemon, tls=cls.tls).__enter__()

    @classmethod
    def tearDownClass(cls):
        cls.front.__exit__()
        cls.daemon.__exit__()

    def ask_from(self, address, method, path, body, headers=None):
        if self.tls:
            connection = http.client.HTTPSConnection("localhost", self.front.port, timeout=PATIENCE, context=trusting(self.front),
                                                     source_address=(address, 0))
        else:
            connection = http.client.HTTPConnection("127.0.0.1", self.front.port, timeout=PATIENCE, source_address=(address, 0))
        connection.request(method, path, body, {"Authorization": f"Bearer {TOKEN}", **(headers or {})})
        reply = connection.getresponse()
        reply = Reply(reply.status, reply.headers, reply.read())
        connection.close()
        return reply

    def check_passes(self, address, name):
        """Uploads one after another and at once, a JSON body on each side of 64 KiB, and a resumable upload."""
        def put(number):
            data = f"{self.tls} {name} {address} {number}".encode() * 1000
            return self.ask_from(address, "PUT", f"/v1/blobs/{sha256(data)}", data).status
        self.assertEqual({put(number) for number in range(10)}, {201}, name)
        with ThreadPoolExecutor(10) as pool:
            self.assertEqual(set(pool.map(put, range(10, 40))), {201}, name)
        for path, body in (("/v1/bakes", "{}"), ("/v1/rebakes", " " * 100_000 + "{}")):
            reply = self.ask_from(address, "POST", path, body, {"Content-Type": "application/json"})
            self.assertEqual(reply.status, 422, (name, path, reply.body))
        data = f"resumed {self.tls} {name} {address}".encode()
        tus = {"Tus-Resumable": "1.0.0"}
        reply = self.ask_from(address, "POST", "/v1/uploads", None, {
            **tus, "Upload-Length": str(len(data)), "Upload-Metadata": f"sha256 {base64_text(sha256(data))}"})
        self.assertEqual(reply.status, 201, (name, reply.body))
        reply = self.ask_from(address, "PATCH", reply.headers["Location"], data, {
            **tus, "Upload-Offset": "0", "Content-Type": "application/offset+octet-stream"})
        self.assertEqual(reply.status, 204, (name, reply.body))

    def test_sockets_that_are_not_let_in_take_no_place(self):
        for name, allowed, held in (
                ("no token", {401}, Held(self.front, "PUT", self.BLOB)),
                ("a wrong token", {401}, Held(self.front, "PUT", self.BLOB, "guessed")),
                ("a token without the scope", {403}, Held(self.front, "PUT", self.BLOB, "reader")),
                ("a model without a token", {401}, Held(self.front, "POST", "/v1/models")),
                ("too large for the daemon", {413}, Held(self.front, "PUT", self.BLOB, TOKEN, 40 << 20)),
                ("too large for nginx", {413}, Held(self.front, "PUT", self.BLOB, TOKEN, 100 << 20)),
                ("nothing there", {404}, Held(self.front, "PUT", "/v1/blobs/a/b", TOKEN)),
                ("no such upload", {404, 409}, Held(self.front, "PATCH", f"/v1/uploads/{'0' * 32}", TOKEN, more=self.TUS)),
                ("a resumable upload without a token", {401}, Held(self.front, "PATCH", "/v1/uploads/x", more=self.TUS))):
            with self.subTest(name), held:
                found = held.statuses(HELD)
                self.assertEqual((len(found), set(found) - allowed), (HELD, set()))
                self.check_passes("127.0.0.1", name)  # also from the same address
                self.check_passes(OTHER, name)

    def test_slow_uploads_of_one_address_leave_places_to_others(self):
        with Held(self.front, "PUT", self.BLOB, "sender") as held:
            self.assertEqual(held.statuses(HELD - 16), [429] * (HELD - 16))  # 16 have places, and no answer yet
            self.check_passes(OTHER, "slow uploads")
            reply = self.ask_from("127.0.0.1", "PUT", f"/v1/blobs/{sha256(b'x')}", b"x")
            self.assertEqual((reply.status, reply.headers["Retry-After"], reply.json["type"]), (429, "1", "urn:hairbake:problem:too-many"))
        self.check_passes("127.0.0.1", "after slow uploads")  # the places are free again

    def test_slow_json_bodies_take_no_thread_of_the_daemon(self):
        for path in ("/v1/bakes", "/v1/rebakes", "/v1/names/model/x", "/v1/render"):
            for token in (None, TOKEN):
                method = "PUT" if "names" in path else "POST"
                held = Held(self.front, method, path, token, 60_000, "Content-Type: application/json\r\n")
                with self.subTest((path, token)), held:
                    self.check_passes("127.0.0.1", f"{path} {token}")
                    self.check_passes(OTHER, f"{path} {token}")


class PlacesOverTls(Places):
    tls = True


class Tls(unittest.TestCase):
    def test_the_site_with_tls_serves_and_the_plain_port_leads_to_it(self):
        with Daemon(tokens=admin_token()) as d, Front(d, tls=True) as f:
            connection = http.client.HTTPSConnection("localhost", f.port, context=trusting(f))
            connection.request("POST", "/v1/session", headers={"Authorization": f"Bearer {TOKEN}"})
            reply = connection.getresponse()
            self.assertEqual((reply.status, reply.headers["Strict-Transport-Security"]), (204, "max-age=31536000"))
            self.assertRegex(reply.headers["Set-Cookie"], r"(?i)HttpOnly; SameSite=Strict; .*; Secure$")
            connection.close()
            version = subprocess.run(["curl", "-sS", "--http2", "--cacert", f.path / "chain.pem", "-o", "/dev/null", "-w",
                                      "%{http_version} %{http_code}", "-H", f"Authorization: Bearer {TOKEN}",
                                      f"https://localhost:{f.port}/v1/bakes"], capture_output=True, text=True, check=True).stdout
            self.assertEqual(version, "2 200")
            old = subprocess.run(["curl", "-sS", "--tlsv1.1", "--tls-max", "1.1", "--ciphers", "DEFAULT@SECLEVEL=0", "--cacert",
                                  f.path / "chain.pem", f"https://localhost:{f.port}/"], capture_output=True, check=False)
            self.assertNotEqual(old.returncode, 0)
            plain = f.raw(b"GET /v1/bakes HTTP/1.1\r\nHost: localhost\r\nConnection: close\r\n\r\n")
            self.assertEqual(statuses(plain), [400])
            self.assertIn(b"application/problem+json", plain)
            connection = http.client.HTTPConnection("localhost", f.plain_port)
            connection.request("GET", "/v1/bakes?limit=1")
            reply = connection.getresponse()
            self.assertEqual((reply.status, reply.headers["Location"]), (308, f"https://localhost:{f.port}/v1/bakes?limit=1"))
            connection.close()


class Hostile(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.daemon = Daemon(tokens=admin_token(), listen=f"port = 0\n{ACCEL}").__enter__()
        cls.front = Front(cls.daemon).__enter__()
        cls.sides = {"behind nginx": cls.front, "directly": cls.daemon}

    @classmethod
    def tearDownClass(cls):
        cls.front.__exit__()
        cls.daemon.__exit__()

    def check_nothing_was_stored(self):
        for data in (b"hello", hostile.STOLEN):
            self.assertEqual(self.front.ask("HEAD", f"/v1/blobs/{sha256(data)}").status, 404)
        self.assertEqual(self.daemon.leftovers(), [])

    def test_hostile_requests_get_an_error_or_a_closed_connection_and_memory_stays_flat(self):
        requests = hostile.requests(TOKEN)
        workers = [int(p) for p in Path(f"/proc/{self.front.process.pid}/task/{self.front.process.pid}/children").read_text().split()]
        processes = [self.daemon.process.pid, *workers]
        before = None
        for _ in range(2):
            for side, target in self.sides.items():
                for name, data in requests.items():
                    with self.subTest(side=side, name=name):
                        answer = probe(target, data)
                        self.assertLessEqual(set(statuses(answer)), REFUSALS, answer[:300])
                        self.assertNotIn(b"X-Evil", answer)
            if before is None:  # the first round brings threads and buffers to life
                before = {p: resident_bytes(p) for p in processes}
        self.check_nothing_was_stored()
        # A kept header of 10 or 100 MB would exceed 8 MB.
        for process in processes:
            self.assertLess(resident_bytes(process) - before[process], 8 << 20)

    def test_a_truncated_body_stores_nothing(self):
        data = b"x" * 100_000
        head = f"PUT /v1/blobs/{sha256(data)} HTTP/1.1\r\n{AUTHORITY}".encode()
        for side, target in self.sides.items():
            for name, request in {"with a length": head + b"Content-Length: 100000\r\n\r\n" + data[:50_000],
                                  "chunked": head + b"Transfer-Encoding: chunked\r\n\r\n186a0\r\n" + data[:50_000],
                                  "chunked, without the end": head + b"Transfer-Encoding: chunked\r\n\r\n186a0\r\n" + data + b"\r\n"}.items():
                with socket.create_connection(("127.0.0.1", target.port), timeout=60) as s:
                    s.sendall(request)
                    s.shutdown(socket.SHUT_WR)
                    try:
                        answer = s.recv(1000)
                    except ConnectionResetError:  # nginx does not read what follows an early end
                        answer = b""
                    self.assertIn(statuses(answer), ([], [400]), (side, name))
                self.assertEqual(self.daemon.ask("HEAD", f"/v1/blobs/{sha256(data)}",
                                                 headers={"Authorization": f"Bearer {TOKEN}"}).status, 404, (side, name))
        self.check_nothing_was_stored()

    def test_what_follows_a_body_is_no_part_of_it(self):
        for side, target in self.sides.items():
            data = f"sent twice, {side}".encode()
            answer = target.raw(f"PUT /v1/blobs/{sha256(data)} HTTP/1.1\r\n{AUTHORITY}Content-Length: {len(data)}\r\n\r\n".encode()
                                + data + data + b"\r\n\r\n")
            # nginx keeps the connection, and what follows is no request; the daemon answers once and closes.
            self.assertIn(statuses(answer), ([201], [201, 400]), side)
            self.assertEqual(target.ask("GET", f"/v1/blobs/{sha256(data)}", headers={"Authorization": f"Bearer {TOKEN}"}).body, data)

    def test_pipelined_requests_are_answered_in_order_by_nginx_and_once_by_the_daemon(self):
        pipeline = b"".join(f"GET {path} HTTP/1.1\r\n{AUTHORITY}{more}\r\n".encode()
                            for path, more in (("/healthz", ""), ("/nothing", ""), ("/v1/bakes", "Connection: close\r\n")))
        self.assertEqual(statuses(self.front.raw(pipeline)), [200, 404, 200])
        self.assertEqual(statuses(self.daemon.raw(pipeline)), [200])

    def test_the_body_of_a_get_is_no_request(self):
        hidden = hostile.smuggled(TOKEN)
        for target in self.sides.values():
            for framing, body in ((f"Content-Length: {len(hidden)}", hidden),
                                  ("Transfer-Encoding: chunked", b"%x\r\n%s\r\n0\r\n\r\n" % (len(hidden), hidden))):
                answer = target.raw(f"GET /v1/bakes HTTP/1.1\r\n{AUTHORITY}{framing}\r\nConnection: close\r\n\r\n".encode() + body)
                self.assertEqual(statuses(answer), [400])
        self.check_nothing_was_stored()


if __name__ == "__main__":
    unittest.main()
