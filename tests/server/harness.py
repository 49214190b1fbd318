"""The real daemon, started for a test and asked over HTTP. Standard library only."""
import base64
import hashlib
import http.client
import json
import os
import signal
import socket
import struct
import subprocess
import tempfile
import time
from pathlib import Path

PROGRAMS = Path(os.environ.get("HAIRBAKE_PROGRAMS", Path(__file__).resolve().parents[2] / "build/bin"))
TUS = {"Tus-Resumable": "1.0.0"}
PATIENCE = float(os.environ.get("HAIRBAKE_PATIENCE", "120"))  # seconds; only a failure takes so long


def sha256(data):
    return hashlib.sha256(data).hexdigest()


def hair_bytes(strands=40, points=10, seed=0):
    """A HAIR file (segments from the header, points and thickness arrays): straight strands on a grid, which lean by their seed."""
    count = strands * points
    head = struct.pack("<4sIIIIffff f f", b"HAIR", strands, count, 2, points - 1, 0.01, 0.0, 0.5, 0.5, 0.5, 0.0)[:40]
    data = bytearray(head + b"test".ljust(88, b"\0"))
    lean = 0.02 + 0.004 * (seed % 50)  # another A
    for s in range(strands):
        for p in range(points):
            data += struct.pack("<fff", s % 7 * 0.1 + lean * p + 0.001 * seed, 0.1 * p, s // 7 * 0.1)
    return bytes(data)


def hdr_bytes(red=128, width=16):
    """A flat RGBE panorama of one colour, 2:1."""
    head = f"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y {width // 2} +X {width}\n".encode()
    return head + bytes([red, 64, 32, 129]) * (width * width // 2)


class Reply:
    def __init__(self, status, headers, body):
        self.status, self.headers, self.body = status, headers, body

    @property
    def json(self):
        return json.loads(self.body)


class Daemon:
    """`with Daemon() as d:`; the store outlives restarts within the block."""

    def __init__(self, config="", workers=1, max_crashes=50, tokens="", listen="port = 0", limits="", before=(),
                 crash_wait=0):
        """`config`, `listen` and `limits` are lines of [store], [listen] and [workers]; `before` are the words of a program
        that starts the daemon; `crash_wait` is [workers] crash_wait_s. With a socket in `listen`, `port` is None and `address` is the socket's path."""
        self.folder = tempfile.TemporaryDirectory(prefix="hairbake-server-")
        self.path = Path(self.folder.name)
        self.config, self.workers, self.max_crashes, self.tokens = config, workers, max_crashes, tokens
        self.listen, self.limits, self.before, self.crash_wait = listen, limits, list(before), crash_wait
        self.process, self.port, self.address = None, None, None

    def __enter__(self):
        self.start()
        return self

    def __exit__(self, *_):
        if self.process and self.process.poll() is None:
            self.kill()
        self.folder.cleanup()

    def write_config(self):
        (self.path / "hairbake.toml").write_text(
            f'[listen]\n{self.listen}\n[store]\nfolder = "store"\n{self.config}\n'
            f"[workers]\ncount = {self.workers}\nthreads = 1\nmax_crashes = {self.max_crashes}\n"
            f"crash_wait_s = {self.crash_wait}\n"
            f"{self.limits}\n{self.tokens}\n")

    def spawn(self):
        self.write_config()
        with open(self.path / "log", "ab") as log:
            return subprocess.Popen([*self.before, PROGRAMS / "hairbaked", "--config", self.path / "hairbake.toml"],
                                    stdout=subprocess.PIPE, stderr=log, stdin=subprocess.DEVNULL)

    def start(self):
        self.process = self.spawn()
        line = self.process.stdout.readline().decode()
        if "listens on" not in line:
            raise AssertionError(f"the daemon did not start: {(self.path / 'log').read_text()}")
        place = line.split("listens on ")[1].strip()
        if place.startswith("unix:"):
            self.address = place[5:]
        else:
            self.port = int(place.rsplit(":", 1)[1])
            self.address = ("127.0.0.1", self.port)

    def kill(self):
        self.process.kill()
        self.process.wait()
        self.process.stdout.close()

    def stop(self):
        """Asks it to stop; returns exit code and seconds."""
        begin = time.monotonic()
        self.process.send_signal(signal.SIGTERM)
        code = self.process.wait(PATIENCE)
        self.process.stdout.close()
        return code, time.monotonic() - begin

    def become_bound_to_modes(self):
        """Starts anew; root ignores a file's mode by two capabilities."""
        if os.geteuid() == 0:
            self.stop()
            self.before = ["setpriv", "--bounding-set=-dac_override,-dac_read_search"]
            self.start()

    def memory_kb(self, field):
        """A line of /proc/PID/status in kB: VmRSS is now, VmHWM the most there ever was."""
        status = Path(f"/proc/{self.process.pid}/status").read_text()
        return int(next(line.split()[1] for line in status.splitlines() if line.startswith(field)))

    def workers_running(self):
        """Process ids of the daemon's children that are not dead yet."""
        found = []
        for stat in Path("/proc").glob("[0-9]*/stat"):
            try:
                state, parent = stat.read_text().rsplit(")", 1)[1].split()[:2]
            except (FileNotFoundError, ProcessLookupError):
                continue
            if int(parent) == self.process.pid and state != "Z":
                found.append(int(stat.parent.name))
        return found

    def wait_for_worker(self, running=True):
        """The first worker's process id; with running=False, waits until there is none."""
        end = time.monotonic() + PATIENCE
        while bool(children := self.workers_running()) != running:
            if time.monotonic() > end:
                raise AssertionError("no worker started" if running else "a worker does not end")
            time.sleep(0.05)
        return children[0] if running else None

    def wait_for_log(self, words):
        end = time.monotonic() + PATIENCE
        while words not in (log := (self.path / "log").read_text()):
            if time.monotonic() > end:
                raise AssertionError(f"{words!r} is not in the log: {log}")
            time.sleep(0.05)

    def ask(self, method, path, body=None, headers=None):
        connection = http.client.HTTPConnection("localhost")
        connection.sock = self.connect()
        if isinstance(body, (dict, list)):
            body = json.dumps(body)
            headers = {"Content-Type": "application/json", **(headers or {})}
        try:
            connection.request(method, path, body, headers or {})
            reply = connection.getresponse()
            return Reply(reply.status, reply.headers, reply.read())
        finally:
            connection.close()

    def connect(self, timeout=PATIENCE):
        s = socket.socket(socket.AF_INET if self.port else socket.AF_UNIX)
        s.settimeout(timeout)
        try:
            s.connect(self.address)
        except OSError:
            s.close()
            raise
        return s

    def raw(self, data, then=b"", pause=0):
        """Sends bytes as they are; what came back until the connection closed."""
        with self.connect(timeout=15) as s:
            try:
                s.sendall(data)
                if then:
                    time.sleep(pause)
                    s.sendall(then)
            except (BrokenPipeError, ConnectionResetError):
                pass
            answer = b""
            try:
                while piece := s.recv(65536):
                    answer += piece
            except ConnectionResetError:
                pass
            return answer

    def put(self, data):
        digest = sha256(data)
        reply = self.ask("PUT", f"/v1/blobs/{digest}", data)
        assert reply.status in (200, 201), (reply.status, reply.body)
        return digest

    def create_upload(self, data, digest=None):
        """By tus; without a digest, the one of the data."""
        return self.ask("POST", "/v1/uploads", headers={**TUS, "Upload-Length": str(len(data)), "Upload-Metadata":
                                                        f"sha256 {base64_text(digest or sha256(data))},name eA=="})

    def append(self, upload, offset, data):
        return self.ask("PATCH", upload, data, {**TUS, "Upload-Offset": str(offset),
                                                "Content-Type": "application/offset+octet-stream"})

    def blob_file(self, digest):
        return self.path / "store/blobs" / digest[:2] / digest

    def wait(self, bake):
        """The bake once it has ended."""
        end = time.monotonic() + PATIENCE
        while time.monotonic() < end:
            view = self.ask("GET", f"/v1/bakes/{bake}").json
            if view["state"] in ("done", "failed", "cancelled"):
                return view
            time.sleep(0.03)
        raise AssertionError(f"{bake} is still {view}")

    def file(self, bake, name):
        reply = self.ask("GET", f"/v1/bakes/{bake}/files/{name}")
        assert reply.status == 200, (reply.status, reply.body)
        return reply.body

    def leftovers(self):
        return sorted(p.name for p in (self.path / "store/tmp").iterdir())


def quick_request(hair=None, environment=None, **more):
    """A bake that takes a fraction of a second."""
    request = {"transmittance": {"directions": 16, "voxels": 32, "reference_vertices": 0},
               "irradiance": {"face_size": 4, "specular_maps": 3}, "outputs": ["npy"]}
    if hair:
        request["hair"] = f"sha256:{hair}"
    if environment:
        request["environment"] = f"sha256:{environment}"
    for name, value in more.items():
        request[name] = {**request.get(name, {}), **value} if isinstance(value, dict) else value
    return request


def slow_request(hair, seed=1):
    """A stage that works for many seconds: traced, with the most directions."""
    return quick_request(hair, transmittance={"method": "trace", "directions": 4096, "direction_set": "random", "seed": seed})


def base64_text(text):
    return base64.b64encode(text.encode()).decode()
