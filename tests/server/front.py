"""nginx with the committed configuration in front of a daemon, started for a test."""
import os
import re
import signal
import socket
import ssl
import subprocess
import tempfile
import time
from pathlib import Path

from harness import PATIENCE, Daemon, sha256

DOCKER = Path(__file__).resolve().parents[2] / "docker"
TOKEN = "the token of the tests"
NOBODY = 65534
AUTHORITY = f"Host: localhost\r\nAuthorization: Bearer {TOKEN}\r\n"
ACCEL = 'accel = "/blobs/"'


def admin_token():
    return f'[[token]]\nname = "test"\nsha256 = "{sha256(TOKEN.encode())}"\nscopes = ["admin"]\n'


def free_port():
    with socket.socket() as s:
        s.bind(("127.0.0.1", 0))
        return s.getsockname()[1]


def self_made_certificate(folder):
    """For localhost, valid for a day."""
    subprocess.run(["openssl", "req", "-x509", "-newkey", "ec", "-pkeyopt", "ec_paramgen_curve:prime256v1", "-nodes", "-days", "1",
                    "-subj", "/CN=localhost", "-addext", "subjectAltName=DNS:localhost,IP:127.0.0.1", "-keyout",
                    folder / "key.pem", "-out", folder / "chain.pem"], check=True, stderr=subprocess.DEVNULL)
    (folder / "key.pem").chmod(0o640)


class Front:
    """`with Front(daemon) as f:`; nginx on free ports in front of a running daemon. nginx.conf and nginx-locations.conf are used
    as they are; of the site file, only what is there to be set is replaced. Never runs as root: a test that does starts nginx as
    nobody in its own group, as a deployment does."""

    def __init__(self, daemon, tls=False, rate="100000r/s", body="64m", more=""):
        self.daemon, self.tls, self.rate, self.body, self.more = daemon, tls, rate, body, more
        self.folder = tempfile.TemporaryDirectory(prefix="hairbake-nginx-")
        self.path = Path(self.folder.name)
        self.port, self.plain_port = free_port(), free_port()
        self.address = ("127.0.0.1", self.port)

    def site(self):
        text = (DOCKER / ("nginx-site-tls.conf" if self.tls else "nginx-site.conf")).read_text()
        server = f"127.0.0.1:{self.daemon.port}" if self.daemon.port else f"unix:{self.daemon.address}"
        for pattern, new in (
                (r"server unix:/run/hairbaked/hairbaked\.sock;", f"server {server};"),
                (r"rate=500r/s", f"rate={self.rate}"),
                (r"listen 8443 ", f"listen 127.0.0.1:{self.port} "),
                (r"listen 8000 ", f"listen 127.0.0.1:{self.plain_port if self.tls else self.port} "),
                (r"host:8443", f"host:{self.port}"),
                (r"/etc/hairbake/tls", str(self.path)),
                (r"/var/lib/hairbake/store", str(self.daemon.path / "store")),
                (r"client_max_body_size \w+;", f"client_max_body_size {self.body};")):
            text = re.sub(pattern, new, text)
        return text + self.more

    def __enter__(self):
        for name in ("nginx.conf", "nginx-locations.conf"):
            (self.path / name).write_bytes((DOCKER / name).read_bytes())
        (self.path / "site.conf").write_text(self.site())
        if self.tls:
            self_made_certificate(self.path)
        who = {}
        if os.geteuid() == 0:
            who = {"user": NOBODY, "group": os.getegid(), "extra_groups": []}
            self.path.chmod(0o770)
            self.daemon.path.chmod(0o750)
        with open(self.path / "log", "ab") as log:
            os.chmod(log.name, 0o660)
            self.process = subprocess.Popen(["nginx", "-p", self.path, "-c", self.path / "nginx.conf"], stdout=log, stderr=log,
                                            stdin=subprocess.DEVNULL, **who)
        end = time.monotonic() + PATIENCE
        while True:
            try:
                socket.create_connection(("127.0.0.1", self.port)).close()
                return self
            except ConnectionRefusedError:
                if self.process.poll() is not None or time.monotonic() > end:
                    raise AssertionError(f"nginx did not start: {self.log()}") from None
                time.sleep(0.02)

    def __exit__(self, *_):
        self.process.send_signal(signal.SIGTERM)
        self.process.wait(PATIENCE)
        self.folder.cleanup()

    def log(self):
        return (self.path / "log").read_text()

    def ask(self, method, path, body=None, headers=None):
        """With the admin token unless the headers say otherwise."""
        return Daemon.ask(self, method, path, body, {"Authorization": f"Bearer {TOKEN}", **(headers or {})})

    connect = Daemon.connect
    raw = Daemon.raw
    put = Daemon.put
    wait = Daemon.wait
    file = Daemon.file


def trusting(front):
    """A TLS context that knows the front's certificate alone."""
    return ssl.create_default_context(cafile=front.path / "chain.pem")


def statuses(answer):
    """Of the replies in what a raw connection gave."""
    return [int(s) for s in re.findall(rb"HTTP/1\.1 (\d{3}) ", answer)]
