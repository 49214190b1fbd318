"""Places for uploads, with nginx in front: one address cannot take those of others."""
import contextlib
import http.client
import socket
import threading
import time
import unittest
from concurrent.futures import ThreadPoolExecutor

from front import TOKEN, Front, admin_token, statuses, trusting
from harness import PATIENCE, Daemon, Reply, base64_text, sha256
from rooms import eventually

HELD = 60          # sockets of one address that do not end their bodies; nginx once had 48 places for uploads in all
OTHER = "127.0.0.2"
SECRETS = {"reader": "read", "sender": "upload"}  # tokens and their scopes


def tokens():
    return admin_token() + "".join(f'[[token]]\nname = "{name}"\nsha256 = "{sha256(name.encode())}"\nscopes = ["{scope}"]\n'
                                   for name, scope in SECRETS.items())


class Held:
    """`with Held(front, method, path, token, length) as held:`; sockets of one address that have sent a head and go on to send
    a byte of their bodies now and then, whatever the answer is: so nginx waits for the rest of each."""

    def __init__(self, front, method, path, token=None, length=1_000_000, more="", count=HELD, address="127.0.0.1"):
        self.front, self.count, self.address = front, count, address
        authority = f"Authorization: Bearer {token}\r\n" if token else ""
        self.head = (f"{method} {path} HTTP/1.1\r\nHost: localhost\r\n{authority}{more}Content-Length: {length}\r\n\r\nx").encode()
        self.sockets, self.answers, self.ended = [], {}, threading.Event()
        self.lock = threading.Lock()  # a TLS connection is for one thread at a time

    def __enter__(self):
        for _ in range(self.count):
            s = socket.create_connection(("127.0.0.1", self.front.port), timeout=PATIENCE, source_address=(self.address, 0))
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

    def check_passes(self, address, name, at_once=10):
        """Uploads one after another and at once, a JSON body on each side of 64 KiB, and a resumable upload."""
        def put(number):
            data = f"{self.tls} {name} {address} {number}".encode() * 1000
            return self.ask_from(address, "PUT", f"/v1/blobs/{sha256(data)}", data).status
        self.assertEqual({put(number) for number in range(10)}, {201}, name)
        with ThreadPoolExecutor(at_once) as pool:
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
        eventually(lambda: not self.daemon.leftovers())  # nginx has cut them all
        self.check_passes("127.0.0.1", "after slow uploads")  # the places are free again

    def test_slow_uploads_of_three_addresses_leave_places_to_a_fourth(self):
        """Fault: they held all 48 places. The third gets 8 places when no more than 8 are left."""
        held = [Held(self.front, "PUT", self.BLOB, "sender", count=16, address=f"127.0.0.{number}") for number in (1, 2, 3)]
        with contextlib.ExitStack() as stack:
            for sockets, places in zip(held, (16, 32, 40)):
                stack.enter_context(sockets)
                eventually(lambda: len(self.daemon.leftovers()) == places)
            self.assertEqual(held[2].statuses(8), [429] * 8)
            self.check_passes("127.0.0.4", "slow uploads of three addresses", at_once=3)

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


if __name__ == "__main__":
    unittest.main()
