"""Clients that send slowly: bodies that hold places, heads and idle connections that hold threads."""
import contextlib
import select
import socket
import threading
import time
import unittest

from front import TOKEN, admin_token
from harness import PATIENCE, TUS, Daemon, sha256
from rooms import eventually, head

BEARER = {"Authorization": f"Bearer {TOKEN}"}


class Slow:
    """`with Slow(d, begun, count) as slow:`; connections that have sent `begun` and go on to send a byte now and then."""

    def __init__(self, d, begun, count, byte=b"x"):
        self.d, self.begun, self.byte, self.ended = d, begun, byte, threading.Event()
        self.sockets = [d.connect() for _ in range(count)]

    def __enter__(self):
        for s in self.sockets:
            s.sendall(self.begun)
        self.thread = threading.Thread(target=self.trickle)
        self.thread.start()
        return self

    def trickle(self):
        while not self.ended.wait(0.3):
            for s in self.sockets:
                with contextlib.suppress(OSError):  # closed after its answer
                    s.send(self.byte)

    def __exit__(self, *_):
        self.ended.set()
        self.thread.join()
        for s in self.sockets:
            s.close()


def answer(s):
    """What the daemon sends until it closes."""
    found = b""
    with contextlib.suppress(ConnectionResetError):
        while piece := s.recv(65536):
            found += piece
    return found


class SlowBodies(unittest.TestCase):
    """Fault: 16 slow bodies from each of three addresses held all 48 places without end."""

    def test_three_addresses_leave_places_to_a_fourth(self):
        """Behind nginx: test_nginx_places."""
        with Daemon(tokens=admin_token()) as d, contextlib.ExitStack() as stack:
            def ask(address, data):
                return d.ask("PUT", f"/v1/blobs/{sha256(data)}", data, {**BEARER, "X-Forwarded-For": address})

            for number, places in ((1, 16), (2, 32), (3, 40)):  # the third has 8 when 8 are left
                begun = head("PUT", f"/v1/blobs/{'0' * 64}", 1_000_000, {**BEARER, "X-Forwarded-For": f"127.0.0.{number}"})
                stack.enter_context(Slow(d, begun + b"x", 16))
                eventually(lambda: len(d.leftovers()) == places)
            for number in range(20):
                self.assertEqual(ask("127.0.0.4", f"data {number}".encode() * 20_000).status, 201)
            reply = ask("127.0.0.3", b"one more")
            self.assertEqual(reply.status, 429)
            self.assertIn("8 uploads and long bodies are under way from your address, and 8 of 48 places are free; an address may "
                          "take one more only while more are free than it has", reply.json["detail"])

    def test_a_body_that_is_too_slow_ends_and_its_place_is_free(self):
        """Relatives: a body in chunks, a long JSON body, and a resumable upload, which keeps what arrived."""
        with Daemon(listen="port = 0\nbodies = 1\nbody_rate = 1000\nbody_window_s = 1") as d:
            upload = d.create_upload(bytes(100_000)).headers["Location"]
            blob = f"/v1/blobs/{'0' * 64}"
            for name, begun, byte in (
                    ("a length", head("PUT", blob, 1_000_000), b"x"), ("chunks", head("PUT", blob, None), b"1\r\nx\r\n"),
                    ("JSON", head("POST", "/v1/rebakes", 100_000, {"Content-Type": "application/json"}), b" "),
                    ("an upload", head("PATCH", upload, 100_000, {**TUS, "Content-Type": "application/offset+octet-stream",
                                                                  "Upload-Offset": "0"}) + b"begun", b"x")):
                with self.subTest(name), Slow(d, begun, 1, byte) as slow:
                    found = answer(slow.sockets[0])
                    self.assertIn(b" 408 ", found.splitlines()[0])
                    self.assertIn(b"urn:hairbake:problem:too-slow", found)
                    self.assertIn(b"the body brought fewer than 1000 bytes a second, as the mean of 1 s ([listen] body_rate, "
                                  b"body_window_s): send it over a faster connection, or as a resumable upload", found)
                    self.assertEqual(d.ask("PUT", f"/v1/blobs/{sha256(b'x')}", b"x").status, 200 if name != "a length" else 201)
            self.assertGreaterEqual(int(d.ask("HEAD", upload, headers=TUS).headers["Upload-Offset"]), len(b"begun"))
            self.assertEqual(d.leftovers(), [])

    def test_relative_a_body_that_is_steady_passes_whatever_it_takes(self):
        data = bytes(60_000)
        with Daemon(listen="port = 0\nbody_rate = 1000\nbody_window_s = 1") as d, d.connect() as s:
            s.sendall(head("PUT", f"/v1/blobs/{sha256(data)}", len(data)))
            for at in range(0, len(data), 5_000):  # ten times the least rate, for three windows
                s.sendall(data[at:at + 5_000])
                time.sleep(0.25)
            self.assertIn(b" 201 ", s.recv(4096).splitlines()[0])


class SlowHeads(unittest.TestCase):
    """Fault: 70 connections that had sent half a head kept all threads, and /healthz was not answered."""

    def assert_healthy(self, d):
        with d.connect(timeout=PATIENCE / 2) as s:
            s.sendall(b"GET /healthz HTTP/1.1\r\nHost: localhost\r\n\r\n")
            self.assertIn(b" 200 ", s.recv(4096).splitlines()[0])

    def test_half_sent_heads_give_their_threads_to_others(self):
        """Relatives: a head without the end of its first line, and short bodies, which have no place."""
        for name, begun in (("a head", b"GET /healthz HTTP/1.1\r\nHost: localhost\r\nX-Test: "), ("a line", b"GET /health"),
                            ("a body", head("POST", "/v1/bakes", 60_000, {"Content-Type": "application/json"}) + b" ")):
            with self.subTest(name), Daemon() as d, Slow(d, begun, 70) as slow:
                self.assert_healthy(d)
                answered = select.select(slow.sockets, [], [], PATIENCE)[0]  # six had to wait, so at least six were given up
                found = answer(answered[0])
                self.assertIn(b" 408 ", found.splitlines()[0])
                self.assertIn(b"urn:hairbake:problem:too-slow", found)
                self.assertRegex(found, b"while other connections waited: send it again")

    def test_relative_idle_connections(self):
        """Ten seconds is what one may be idle while no other waits."""
        with Daemon() as d, contextlib.ExitStack() as stack:
            for _ in range(250):
                stack.enter_context(d.connect())
            begin = time.monotonic()
            self.assert_healthy(d)
            self.assertLess(time.monotonic() - begin, 10)  # 250 of them need 4 s: a second for each 64

    def test_relative_more_idle_connections_than_may_wait(self):
        """Fault: 64 kept the threads and 256 the queue, and everybody else got 503."""
        with Daemon() as d, contextlib.ExitStack() as stack:
            for _ in range(3):
                for _ in range(400):
                    stack.enter_context(d.connect())
                self.assert_healthy(d)

    def test_relative_a_head_that_comes_slowly_is_served_while_no_other_waits(self):
        with Daemon() as d, d.connect() as s:
            for byte in b"GET /healthz HTTP/1.1\r\nHost: localhost\r\n\r\n":
                s.sendall(bytes([byte]))
                time.sleep(0.03)
            self.assertIn(b" 200 ", s.recv(4096).splitlines()[0])

    def test_relative_a_request_that_is_cut_is_not_slow(self):
        with Daemon() as d, d.connect() as s:
            s.sendall(head("PUT", f"/v1/blobs/{'0' * 64}", 60_000) + b"x")
            s.shutdown(socket.SHUT_WR)
            self.assertIn(b" 400 ", answer(s).splitlines()[0])

    def test_relative_a_head_that_does_not_end_is_given_up(self):
        """However often a byte comes: the time is for the whole head."""
        with Daemon() as d, Slow(d, b"GET /healthz HTTP/1.1\r\nHost: localhost\r\nX-Test: ", 1) as slow:
            self.assertIn(b" 408 ", answer(slow.sockets[0]).splitlines()[0])


if __name__ == "__main__":
    unittest.main()
