"""What the tests of both clients need: a proxy that counts and cuts, a server that lies, a daemon that comes back."""
import json
import os
import re
import socket
import socketserver
import ssl
import subprocess
import sys
import tempfile
import threading
import time
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[2] / "server"))
from harness import PATIENCE, PROGRAMS, Daemon, sha256  # noqa: E402

ROOT = Path(__file__).resolve().parents[3]
SETTINGS = ("transmittance.directions=16", "transmittance.voxels=32", "transmittance.reference_vertices=0",
            "irradiance.face_size=4", "irradiance.specular_maps=3")
QUICK = [word for setting in SETTINGS for word in ("--set", setting)] + ["--outputs", "npy"]


class LastingDaemon(Daemon):
    """Comes back on the port that it had."""

    def write_config(self):
        super().write_config()
        if self.port:
            file = self.path / "hairbake.toml"
            file.write_text(file.read_text().replace("port = 0", f"port = {self.port}"))


class Proxy:
    """`with Proxy(daemon) as p:` forwards connections to the daemon and counts what it forwards. `cut_sent` and
    `cut_received` end the connection after that many bytes of it, once; with `stall` it goes silent instead."""

    def __init__(self, daemon, cut_sent=None, cut_received=None, stall=False, tls=None, port=0):
        self.daemon, self.stall, self.tls = daemon, stall, tls
        self.cuts = {"sent": cut_sent, "received": cut_received}
        self.sent = self.received = 0
        self.heads = []  # of requests, as text
        self.stalled, self.closing = threading.Event(), threading.Event()
        self.listener = socket.create_server(("127.0.0.1", port))
        self.port = self.listener.getsockname()[1]

    @property
    def url(self):
        return f"{'https' if self.tls else 'http'}://127.0.0.1:{self.port}"

    def __enter__(self):
        threading.Thread(target=self.accept, daemon=True).start()
        return self

    def __exit__(self, *_):
        self.closing.set()
        self.listener.shutdown(socket.SHUT_RDWR)  # wakes accept(), which else keeps the port
        self.listener.close()

    def accept(self):
        while not self.closing.is_set():
            try:
                client, _ = self.listener.accept()
            except OSError:
                return
            threading.Thread(target=self.serve, args=(client,), daemon=True).start()

    def serve(self, client):
        try:
            if self.tls:
                client = self.tls.wrap_socket(client, server_side=True)
            with socket.create_connection(("127.0.0.1", self.daemon.port)) as server, client:
                back = threading.Thread(target=self.pump, args=(server, client, "received"), daemon=True)
                back.start()
                self.pump(client, server, "sent")
                back.join()
        except OSError:
            client.close()

    def pump(self, source, target, way):
        left, first = self.cuts[way], way == "sent"
        try:
            while piece := source.recv(65536):
                if first:
                    self.heads.append(piece.split(b"\r\n\r\n")[0].decode("latin-1"))
                    first = False
                piece = piece if left is None else piece[:left]
                setattr(self, way, getattr(self, way) + len(piece))
                target.sendall(piece)
                if left is not None:
                    left -= len(piece)
                    if left == 0 and self.cuts[way] is not None:
                        self.cuts[way] = None
                        self.stalled.set()
                        if self.stall:
                            self.closing.wait()
                        break
        except OSError:
            pass
        for end in (source, target):
            try:
                end.shutdown(socket.SHUT_RDWR)
            except OSError:
                pass


class Liar:
    """A server that answers a done bake whose files are `files` (name to bytes), under `listed` names and digests in
    the manifest; `endless` names a path whose body does not end."""

    def __init__(self, listed, files, endless="", manifest_tag=None):
        manifest = json.dumps({"id": "0" * 64, "files": listed}).encode()
        self.asked = []
        liar = self

        class Handler(BaseHTTPRequestHandler):
            def do_GET(self):
                liar.asked.append(self.path)
                name = self.path.rsplit("/", 1)[1]
                if self.path == endless:
                    return self.answer_without_end()
                if name == "manifest.json":
                    return self.answer(manifest, manifest_tag or sha256(manifest))
                if name in files:
                    return self.answer(files[name], sha256(files[name]))
                self.answer(b'{"id": "' + b"0" * 64 + b'", "state": "done"}', "0")

            def answer(self, body, tag):
                self.send_response(200)
                self.send_header("ETag", f'"{tag}"')
                self.send_header("Content-Length", str(len(body)))
                self.end_headers()
                self.wfile.write(body)

            def answer_without_end(self):
                self.send_response(200)
                self.end_headers()
                try:
                    while True:
                        self.wfile.write(b" " * 65536)
                except OSError:
                    pass

            def log_message(self, *_):
                pass

        self.server = ThreadingHTTPServer(("127.0.0.1", 0), Handler)
        self.server.daemon_threads = True
        self.url = f"http://127.0.0.1:{self.server.server_port}"

    def __enter__(self):
        threading.Thread(target=self.server.serve_forever, daemon=True).start()
        return self

    def __exit__(self, *_):
        self.server.shutdown()
        self.server.server_close()


class TcpLiar:
    """A server that answers every request with `head`, then `forever` again and again, or closes when it is empty."""

    def __init__(self, head, forever):
        class Handler(socketserver.BaseRequestHandler):
            def handle(self):
                try:
                    self.request.recv(65536)
                    self.request.sendall(head)
                    while forever:
                        self.request.sendall(forever)
                except OSError:
                    pass

        self.server = socketserver.ThreadingTCPServer(("127.0.0.1", 0), Handler)
        self.server.daemon_threads = True
        self.url = f"http://127.0.0.1:{self.server.server_address[1]}"

    __enter__, __exit__ = Liar.__enter__, Liar.__exit__


def tls_of_localhost(folder):
    """A server's TLS context and the file of the certificate that it shows, for 127.0.0.1."""
    key, certificate = folder / "key.pem", folder / "certificate.pem"
    subprocess.run(["openssl", "req", "-x509", "-newkey", "rsa:2048", "-nodes", "-keyout", key, "-out", certificate,
                    "-days", "1", "-subj", "/CN=127.0.0.1", "-addext", "subjectAltName=IP:127.0.0.1"], check=True,
                   capture_output=True)
    context = ssl.SSLContext(ssl.PROTOCOL_TLS_SERVER)
    context.load_cert_chain(certificate, key)
    return context, certificate


class Finished:
    def __init__(self, code, out, err):
        self.code, self.out, self.err = code, out, err

    @property
    def events(self):
        return [json.loads(line) for line in self.out.splitlines()]

    def __repr__(self):
        return f"exit code {self.code}\n{self.out}\n{self.err}"


class Workshop:
    """A folder, and a client's program run in it."""

    def __init__(self, command):
        self.command = command
        self.folder = tempfile.TemporaryDirectory(prefix="hairbake-clients-")
        self.path = Path(self.folder.name)
        self.environment = {**os.environ, "XDG_CACHE_HOME": str(self.path / "cache"),
                            "PYTHONPATH": str(ROOT / "clients/python"), "PYTHONDONTWRITEBYTECODE": "1",
                            "no_proxy": "*", "NO_PROXY": "*"}
        for name in ("HAIRBAKE_SERVER", "HAIRBAKE_TOKEN_FILE"):
            self.environment.pop(name, None)

    def write(self, name, data):
        (self.path / name).write_bytes(data)
        return str(self.path / name)

    def start(self, *words, url=None):
        server = ["--server", url] if url else []
        return subprocess.Popen([*self.command, *map(str, words), *server], cwd=self.path, env=self.environment,
                                text=True, stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=subprocess.PIPE)

    def end(self, process):
        out, err = process.communicate(timeout=PATIENCE)
        return Finished(process.returncode, out, err)

    def run(self, *words, url=None):
        return self.end(self.start(*words, url=url))

    def files(self, folder):
        return {file.name: file.read_bytes() for file in (self.path / folder).iterdir()}

    def names(self):
        return sorted(entry.name for entry in self.path.iterdir() if entry.name != "cache")


def first_word(text):
    return re.match(r"\S+", text).group(0)


def until(condition, what):
    end = time.monotonic() + PATIENCE
    while not condition():
        if time.monotonic() > end:
            raise AssertionError(f"it never came to be: {what}")
        time.sleep(0.02)
