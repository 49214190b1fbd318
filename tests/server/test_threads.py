"""The daemon under ThreadSanitizer: `./dev test --all` builds it in build/threads and runs this; the worker is the usual one."""
import os
import threading
import unittest
from pathlib import Path

from harness import PROGRAMS, Daemon, base64_text, hair_bytes, hdr_bytes, quick_request, sha256

WORKER = os.environ.get("HAIRBAKE_WORKER", PROGRAMS / "hairbake-worker")
CLIENTS, ROUNDS = 6, 8
# GCC 12's ThreadSanitizer cannot place its shadow where the kernel shuffles addresses with more than 28 bits.
RANDOM_BITS = Path("/proc/sys/vm/mmap_rnd_bits")
FIXED_ADDRESSES = ["setarch", "--addr-no-randomize"] if int(RANDOM_BITS.read_text()) > 28 else []
FINDING = "WARNING: ThreadSanitizer"
TUS = {"Tus-Resumable": "1.0.0"}


class Client:
    """Sends requests of all kinds, at the same time as other clients."""

    def __init__(self, daemon, number):
        self.daemon, self.number, self.failure = daemon, number, None

    def run(self):
        try:
            for round_number in range(ROUNDS):
                self.one_round(round_number)
        except Exception as error:  # reported by the test
            self.failure = error

    def expect(self, statuses, *question, **more):
        reply = self.daemon.ask(*question, **more)
        if reply.status not in statuses:
            raise AssertionError(f"{question[:2]}: {reply.status} {reply.body[:300]}")
        return reply

    def one_round(self, step):
        shared, own = hair_bytes(seed=step), hdr_bytes(red=64 + self.number * ROUNDS + step)
        for data in (shared, own):
            self.expect((200, 201), "PUT", f"/v1/blobs/{sha256(data)}", data)
        self.expect((200, 201), "POST", "/v1/models", {"sha256": sha256(shared)})
        self.expect((200,), "PUT", "/v1/names/environment/sky", {"sha256": sha256(own)})
        request = {**quick_request(sha256(shared)), "environment": "name:sky"}
        bake = self.expect((200, 202), "POST", "/v1/bakes", request).json["id"]
        if self.number == 0:
            self.expect((200, 409), "DELETE", f"/v1/bakes/{bake}")
            self.expect((200, 202), "POST", "/v1/bakes", request)
        for path in (f"/v1/bakes/{bake}", "/v1/bakes?limit=5", "/v1/models", "/metrics", "/readyz", "/openapi.json", "/v1/nothing"):
            self.expect((200, 404), "GET", path)
        self.upload(os.urandom(5000))
        self.delete_and_cut(os.urandom(5000), own)
        self.daemon.raw(b"PUT /v1/blobs/x HTTP/1.1\r\nHost: localhost\r\nContent-Length: 9\r\n\r\n")
        if step % 4 == 3:
            view = self.daemon.wait(bake)
            if view["state"] == "done":
                for file in view["files"]:
                    self.expect((206, 404, 409, 416), "GET", file["href"], headers={"Range": "bytes=0-99"})
            self.expect((202, 422), "POST", "/v1/rebakes", {"environment": f"sha256:{sha256(own)}", "models": [f"sha256:{sha256(shared)}"]})

    def upload(self, data):
        path = self.expect((201,), "POST", "/v1/uploads", headers={
            **TUS, "Upload-Length": str(len(data)), "Upload-Metadata": f"sha256 {base64_text(sha256(data))}"}).headers["Location"]
        for begin in (0, 2500):
            self.expect((204,), "PATCH", path, data[begin:begin + 2500], headers={
                **TUS, "Upload-Offset": str(begin), "Content-Type": "application/offset+octet-stream"})


    def delete_and_cut(self, data, sky):
        """Deletions of what is needed and of what is not, and bodies that are cut or in chunks."""
        self.expect((201,), "PUT", f"/v1/blobs/{sha256(data[::-1])}", iter([data[:1000:-1], data[1000::-1]]))
        with self.daemon.connect() as connection:
            connection.sendall(f"PUT /v1/blobs/{'0' * 64} HTTP/1.1\r\nHost: x\r\nContent-Length: 9999\r\n\r\n".encode() + data)
        self.expect((200,), "GET", "/v1/blobs?unneeded=1")
        self.expect((409,), "DELETE", f"/v1/blobs/{sha256(sky)}")  # a name means it
        self.expect((204,), "DELETE", f"/v1/blobs/{sha256(data[::-1])}")


class Threads(unittest.TestCase):
    def stress(self, starts, before=()):
        """What the daemon logged under all clients at once, started that many times on one store."""
        with Daemon(config="scrub_s = 1", workers=2, limits=f'program = "{WORKER}"', listen="port = 0\nthreads = 4\nwaiting = 64",
                    before=[*FIXED_ADDRESSES, *before, "env", "TSAN_OPTIONS=exitcode=0"]) as d:
            for start in range(starts):
                if start > 0:
                    d.start()
                clients = [Client(d, number) for number in range(CLIENTS)]
                threads = [threading.Thread(target=client.run) for client in clients]
                for thread in threads:
                    thread.start()
                for thread in threads:
                    thread.join()
                self.assertEqual([client.failure for client in clients], [None] * CLIENTS)
                self.assertEqual(d.stop()[0], 0)
            return (Path(d.path) / "log").read_text()

    def test_no_race_is_found(self):
        log = self.stress(starts=2)
        self.assertNotIn(FINDING, log, log[log.find(FINDING):][:4000])

    def test_a_planted_race_is_found(self):
        log = self.stress(starts=1, before=["env", "HAIRBAKE_PLANTED_RACE=1"])
        self.assertIn(FINDING, log)
        self.assertIn("race()", log)


if __name__ == "__main__":
    unittest.main()
