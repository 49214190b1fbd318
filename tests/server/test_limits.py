"""Limits of what a client can use: memory, connections, sockets, unfinished uploads."""
import hashlib
import json
import os
import subprocess
import unittest

from harness import PATIENCE, PROGRAMS, Daemon, base64_text, hair_bytes, hdr_bytes, quick_request, sha256

MEGABYTE = 1 << 20
UPLOAD_MB, GROWTH_MB = 500, 64  # the promise of docs/architecture.md
PIECE = os.urandom(MEGABYTE)


def head(method, path, *lines):
    return "\r\n".join([f"{method} {path} HTTP/1.1", "Host: localhost", *lines, "", ""]).encode()


def reply_on(connection):
    """Status, headers and body of what comes until the connection closes; an interim 100 is left out."""
    data = b""
    while piece := connection.recv(65536):
        data += piece
    data = data.removeprefix(b"HTTP/1.1 100 Continue\r\n\r\n")
    top, _, body = data.partition(b"\r\n\r\n")
    lines = top.decode().split("\r\n")
    return int(lines[0].split()[1]), dict(line.split(": ", 1) for line in lines[1:]), body


def received(connection, count):
    """Exactly so many bytes: they may come in pieces."""
    data = b""
    while len(data) < count and (piece := connection.recv(count - len(data))):
        data += piece
    return data


class BigUploads(unittest.TestCase):
    def test_half_a_gigabyte_grows_the_daemon_by_at_most_64_mb(self):
        whole = hashlib.sha256()
        for number in range(UPLOAD_MB):
            whole.update(number.to_bytes(4, "little") + PIECE[4:])
        path = f"/v1/blobs/{whole.hexdigest()}"
        for framing in (f"Content-Length: {UPLOAD_MB * MEGABYTE}", "Transfer-Encoding: chunked"):
            chunked = "chunked" in framing
            with Daemon() as d, d.connect() as s:
                before = d.memory_kb("VmRSS")
                s.sendall(head("PUT", path, framing))
                for number in range(UPLOAD_MB):
                    data = number.to_bytes(4, "little") + PIECE[4:]
                    s.sendall(b"%x\r\n" % MEGABYTE + data + b"\r\n" if chunked else data)
                if chunked:
                    s.sendall(b"0\r\n\r\n")
                self.assertEqual(reply_on(s)[0], 201, framing)
                grown = d.memory_kb("VmHWM") - before
                self.assertLessEqual(grown, GROWTH_MB * 1024, framing)
                # So does sending it back.
                with d.connect() as back:
                    back.sendall(head("GET", path))
                    found, data = hashlib.sha256(), b""
                    while b"\r\n\r\n" not in data:
                        data += back.recv(65536)
                    found.update(data.partition(b"\r\n\r\n")[2])
                    while data := back.recv(MEGABYTE):
                        found.update(data)
                self.assertEqual(found.hexdigest(), whole.hexdigest())
                self.assertLessEqual(d.memory_kb("VmHWM") - before, GROWTH_MB * 1024, framing)

    def test_a_length_over_the_limit_is_refused_before_a_byte_of_it_is_sent(self):
        with Daemon(config="blob_mb = 1") as d:
            status, headers, body = reply_on_only_head(d, f"Content-Length: {MEGABYTE + 1}")
            self.assertEqual((status, headers["Content-Type"]), (413, "application/problem+json"))
            self.assertIn(f"allowed is up to {MEGABYTE}", json.loads(body)["detail"])
            # With Expect, too; the reply may follow a 100.
            self.assertEqual(reply_on_only_head(d, f"Content-Length: {MEGABYTE + 1}", "Expect: 100-continue")[0], 413)

    def test_chunks_over_the_limit_are_refused_as_soon_as_they_pass_it(self):
        with Daemon(config="blob_mb = 1") as d, d.connect() as s:
            s.sendall(head("PUT", f"/v1/blobs/{'0' * 64}", "Transfer-Encoding: chunked"))
            chunk = b"%x\r\n" % MEGABYTE + PIECE + b"\r\n"
            s.sendall(chunk)
            s.sendall(b"1\r\nx\r\n")  # one byte too many; there is no last chunk
            self.assertEqual(reply_on(s)[0], 413)
            self.assertEqual(d.leftovers(), [])


def reply_on_only_head(daemon, *lines):
    with daemon.connect() as s:
        s.sendall(head("PUT", f"/v1/blobs/{'0' * 64}", *lines))
        return reply_on(s)


class Connections(unittest.TestCase):
    def test_a_full_queue_answers_503_and_says_when_to_come_again(self):
        with Daemon(listen="port = 0\nthreads = 2\nwaiting = 3") as d:
            held, long = [], bytes(100_000)  # a short one would give its thread to those that wait
            for _ in range(2):  # each occupies a thread, which waits for the body
                s = d.connect()
                s.sendall(head("PUT", f"/v1/blobs/{sha256(long)}", f"Content-Length: {len(long)}", "Expect: 100-continue"))
                self.assertEqual(received(s, 25), b"HTTP/1.1 100 Continue\r\n\r\n")
                held.append(s)
            idle = [d.connect() for _ in range(3)]  # these fill the queue, in the order in which they came
            for s in idle:
                s.sendall(b"GET /he")  # one that sent nothing would make room
            reply = d.ask("GET", "/healthz")
            self.assertEqual((reply.status, reply.headers["Retry-After"], reply.headers["Content-Type"]),
                             (503, "2", "application/problem+json"))
            self.assertEqual(reply.json["type"], "urn:hairbake:problem:busy")
            for s in held:
                s.sendall(long)
                self.assertIn(reply_on(s)[0], (200, 201))
                s.close()
            for s in idle:
                s.close()
            self.assertEqual(d.ask("GET", "/healthz").status, 200)

    def test_refused_bodies_occupy_no_thread(self):
        """A client that was refused and does not end its body: the daemon reads on for a while, in one thread for all."""
        tokens = f'[[token]]\nname = "a"\nsha256 = "{sha256(b"a")}"\nscopes = ["upload"]\n'
        with Daemon(listen="port = 0\nthreads = 2\nwaiting = 1", tokens=tokens) as d:
            held = []
            for token in ("", "Authorization: Bearer b", "Authorization: Bearer a") * 20:
                s = d.connect()
                s.sendall(head("PUT", f"/v1/blobs/{'0' * 64}", *([token] if token else []), f"Content-Length: {1 << 40}") + b"x")
                self.assertIn(int(received(s, 12).split()[1]), (401, 413))  # and not 503
                held.append(s)
            for s in held:
                s.sendall(b"more")  # none of them is reset yet
                s.close()

    def test_out_of_descriptors_it_says_so_and_serves_again_when_there_are_some(self):
        with Daemon(before=["prlimit", "--nofile=48:48"]) as d:  # an idle daemon has about twenty
            idle = [d.connect() for _ in range(60)]
            d.wait_for_log("no connection can be accepted at present: Too many open files")
            for s in idle:
                s.close()
            self.assertEqual(d.ask("GET", "/healthz").status, 200)
            self.assertEqual((d.path / "log").read_text().count("no connection can be accepted"), 1)  # not for each attempt

    def test_the_reply_to_a_head_that_is_not_understood_is_not_lost_in_a_reset(self):
        with Daemon() as d:
            for head in (b"FOO / HTTP/1.1\r\nX-Long: " + b"a" * 7000, b"GET / HTTP/1.1\r\nHost: localhost\r\nCookie: " + b"a" * 30000):
                with d.connect() as s:
                    s.sendall(head + b"\r\n\r\n")
                    reply = b""
                    while piece := s.recv(65536):  # a reset would raise
                        reply += piece
                    self.assertTrue(reply.startswith(b"HTTP/1.1 400 "), reply)

    def test_one_token_has_so_many_unfinished_uploads(self):
        with Daemon(config="open_uploads = 2") as d:
            def create():
                return d.ask("POST", "/v1/uploads", headers={"Tus-Resumable": "1.0.0", "Upload-Length": "5",
                                                             "Upload-Metadata": f"sha256 {base64_text(sha256(b'hello'))}"})
            first, second, third = create(), create(), create()
            self.assertEqual([first.status, second.status, third.status], [201, 201, 429])
            self.assertEqual((third.json["type"], third.headers["Retry-After"]), ("urn:hairbake:problem:too-many", "60"))
            d.ask("DELETE", first.headers["Location"], headers={"Tus-Resumable": "1.0.0"})
            self.assertEqual(create().status, 201)

    def test_unfinished_uploads_together_may_not_pass_the_budget(self):
        tokens = "".join(f'[[token]]\nname = "{name}"\nsha256 = "{sha256(name.encode())}"\nscopes = ["upload"]\n' for name in "ab")
        with Daemon(config="budget_mb = 1\nblob_mb = 1", tokens=tokens) as d:  # 1,048,576 bytes
            def ask(method, path, token, **more):
                return d.ask(method, path, headers={"Tus-Resumable": "1.0.0", "Authorization": f"Bearer {token}", **more})

            def create(token, size):
                return ask("POST", "/v1/uploads", token, **{"Upload-Length": str(size),
                                                            "Upload-Metadata": f"sha256 {base64_text(sha256(b'hello'))}"})
            first = create("a", 600_000)  # a large one is allowed when it is the only one
            self.assertEqual(first.status, 201)
            own = create("a", 1)
            self.assertEqual((own.status, own.json["type"]), (429, "urn:hairbake:problem:too-many"))
            self.assertIn("of this token have 600001; allowed are 524288 bytes", own.json["detail"])
            self.assertEqual([create("b", 448_577).status, create("b", 448_576).status], [507, 201])
            self.assertEqual(ask("DELETE", first.headers["Location"], "a").status, 204)
            self.assertEqual([create("a", 300_000).status, create("a", 224_288).status, create("a", 1).status], [201, 201, 429])

    def test_an_upload_that_is_refused_costs_no_result(self):
        with Daemon(config="budget_mb = 1\nblob_mb = 1\nopen_uploads = 1") as d:
            bake = d.ask("POST", "/v1/bakes", quick_request(d.put(hair_bytes()), d.put(hdr_bytes()))).json["id"]
            self.assertEqual(d.wait(bake)["state"], "done")

            def create(**metadata):
                return d.ask("POST", "/v1/uploads", headers={"Tus-Resumable": "1.0.0", "Upload-Length": str(1 << 20), **metadata})
            metadata = {"Upload-Metadata": f"sha256 {base64_text(sha256(b'hello'))}"}
            self.assertEqual(create().status, 400)  # without a digest
            self.assertEqual(create(**metadata).status, 507)  # beside the two inputs it has no room
            self.assertEqual(d.ask("GET", f"/v1/bakes/{bake}").json["state"], "done")


class UnixSocket(unittest.TestCase):
    def test_bakes_through_it_and_survives_a_kill(self):
        with SocketDaemon() as d:
            self.assertEqual(d.port, None)
            mode = os.stat(d.address).st_mode
            self.assertEqual(oct(mode & 0o777), "0o660")  # owner and group: nginx is in the group
            bake = d.ask("POST", "/v1/bakes", quick_request(d.put(hair_bytes()), d.put(hdr_bytes()))).json["id"]
            self.assertEqual(d.wait(bake)["state"], "done")
            d.kill()
            self.assertTrue(os.path.exists(d.address))  # a killed daemon leaves it
            d.start()
            self.assertEqual(d.ask("GET", f"/v1/bakes/{bake}").json["state"], "done")

    def test_a_socket_that_somebody_listens_on_and_a_file_are_left_alone(self):
        with SocketDaemon() as d, SocketDaemon() as other:
            for place, words in ((d.address, "another process listens on the socket"), (str(d.path / "log"), "is no socket")):
                code, log = other.start_on(place)
                self.assertEqual(code, 2)
                self.assertIn(words, log)
            self.assertEqual(d.ask("GET", "/healthz").status, 200)
            self.assertTrue((d.path / "log").exists())


class SocketDaemon(Daemon):
    """Listens on a socket in its folder."""

    def __init__(self):
        super().__init__()
        self.listen = f'socket = "{self.path / "daemon.sock"}"'

    def start_on(self, place):
        """Exit code and log of a second daemon with the same store settings, but a folder of its own."""
        config = self.path / "other.toml"
        config.write_text(f'[listen]\nsocket = "{place}"\n[store]\nfolder = "other"\n')
        done = subprocess.run([PROGRAMS / "hairbaked", "--config", config], capture_output=True, text=True, timeout=PATIENCE)
        return done.returncode, done.stderr


if __name__ == "__main__":
    unittest.main()
