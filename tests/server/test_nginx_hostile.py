"""Hostile requests, to nginx and to the daemon itself."""
import re
import socket
import unittest
from pathlib import Path

import hostile
from front import ACCEL, AUTHORITY, TOKEN, Front, admin_token, statuses
from harness import PATIENCE, Daemon, sha256

REFUSALS = {400, 404, 405, 408, 413, 414, 415, 422, 431, 501, 505}


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
                        self.assertNotIn(b"\nX-Evil", answer)  # a header; messages show the text
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
