"""Requests whose bodies are under way, and a store that is nearly full."""
import contextlib
import os
import time
import unittest

from harness import PATIENCE, TUS, hair_bytes, quick_request

BUDGET = 1 << 20
SMALL = "budget_mb = 1\nblob_mb = 2\nkeep_free_mb = 0"
OCTETS = {"Content-Type": "application/octet-stream"}
PATCH = {**TUS, "Content-Type": "application/offset+octet-stream"}


def head(method, path, length, headers=()):
    """A request's head. Without a length the body comes in chunks."""
    size = "Transfer-Encoding: chunked" if length is None else f"Content-Length: {length}"
    lines = [f"{method} {path} HTTP/1.1", "Host: localhost", size, *(f"{k}: {v}" for k, v in dict(headers).items())]
    return ("\r\n".join(lines) + "\r\n\r\n").encode()


def chunk(data):
    return f"{len(data):x}\r\n".encode() + data + b"\r\n"


@contextlib.contextmanager
def under_way(d, begun):
    """A request whose body does not end; it is cut at the end of the block."""
    connection = d.connect()
    try:
        connection.sendall(begun)
        yield connection
    finally:
        connection.close()


def eventually(holds):
    """Waits until `holds()`, for a change that the daemon makes after a connection ended."""
    end = time.monotonic() + PATIENCE
    while not holds():
        if time.monotonic() > end:
            raise AssertionError("it does not happen")
        time.sleep(0.02)


class RoomTest(unittest.TestCase):
    def fill_budget(self, d, stack, kind):
        """Leaves 100 bytes of room, with the usual hair and an input, an upload or a body under way (until `stack` ends).
        Returns the hair's digest, and the path whose DELETE makes room, or None for a body."""
        hair, data = d.put(hair_bytes()), os.urandom(BUDGET - len(hair_bytes()) - 100)
        if kind == "input":
            return hair, f"/v1/blobs/{d.put(data)}"
        if kind == "upload":
            filler = d.create_upload(data + b"the rest").headers["Location"]
            self.assertEqual(d.append(filler, 0, data).status, 204)
            return hair, filler
        stack.enter_context(under_way(d, head("PUT", f"/v1/blobs/{'0' * 64}", len(data)) + data[:-1]))
        eventually(lambda: [f.stat().st_size for f in (d.path / "store/tmp").iterdir()] == [len(data) - 1])
        return hair, None

    def assert_full(self, reply):
        self.assertEqual((reply.status, reply.headers["Content-Type"]), (507, "application/problem+json"), reply.body)
        self.assertEqual(reply.json["type"], "urn:hairbake:problem:full")

    def assert_busy(self, reply):
        """Bodies under way have the room: the client tries again."""
        self.assertEqual((reply.status, reply.json["type"]), (503, "urn:hairbake:problem:busy"), reply.body)
        self.assertGreater(int(reply.headers["Retry-After"]), 0)
        self.assertIn("bodies", reply.json["detail"])

    def assert_refused_before_the_body(self, d, begun, status=507):
        """The reply comes although no byte of the body does."""
        with d.connect() as connection:
            connection.sendall(begun)
            answer = connection.recv(4096)
            self.assertIn(b" %d " % status, answer.splitlines()[0])
            self.assertEqual(b"\r\nretry-after:" in answer.lower(), status == 503)

    @staticmethod
    def stored(d):
        return sum(file.stat().st_size for file in (d.path / "store/blobs").rglob("*") if file.is_file())

    def bake_some(self, d, count):
        """Bakes of one groom with different seeds; their results are different."""
        hair = d.put(hair_bytes())
        bakes = [d.ask("POST", "/v1/bakes", quick_request(hair, transmittance={"seed": seed, "direction_set": "random"})).json["id"]
                 for seed in range(1, count + 1)]
        for bake in bakes:
            self.assertEqual(d.wait(bake)["state"], "done")
        return bakes

    def kept(self, d, bakes):
        return [bake for bake in bakes if d.ask("GET", f"/v1/bakes/{bake}").status == 200]
