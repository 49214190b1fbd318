"""HTTP with retries after lost connections. The only module that uses http.client."""
from __future__ import annotations

import http.client
import json
import re
import ssl
import sys
import time
import urllib.parse
import warnings
from typing import Any, Callable, Dict, Iterator, List, Mapping, Optional

from ._errors import ConnectionLost, Refused, Unreachable, UsageError, plain

BUSY = (408, 429, 502, 503, 504)
PIECE = 1 << 18
FIRST_PAUSE_S, LONGEST_PAUSE_S = 0.1, 5.0
TIMEOUT_S = 120.0  # without a received byte; the server computes the digest of a large upload before it answers
IDENTIFIER = re.compile(r"[0-9A-Za-z_-]{1,128}")

Json = Dict[str, Any]
Sink = Callable[["Answer", bytes], None]


def needed_lines(needed_by: Json) -> List[str]:
    """What refers to an input that is not deleted, one line each, and how many more there are."""
    lines: List[str] = []
    for part, what in (("bakes", "bakes"), ("names", "versions of names")):
        found = needed_by.get(part)
        found = found if isinstance(found, dict) else {}
        first = found.get("first")
        entries = [entry for entry in first if isinstance(entry, dict)] if isinstance(first, list) else []
        for entry in entries:
            lines.append(f"bake {entry.get('id')} ({entry.get('state')})" if part == "bakes" else
                         f"name {entry.get('kind')}/{entry.get('path')}@{entry.get('version')}")
        count = found.get("count")
        if isinstance(count, int) and count > len(entries):
            lines.append(f"and {count - len(entries)} more {what}")
    return lines


class Answer:
    def __init__(self, status: int, headers: Mapping[str, str]) -> None:
        self.status = status
        self.headers = {name.lower(): value for name, value in headers.items()}
        self.body = b""

    def json(self) -> Json:
        """The body, a JSON object; raises Refused for anything else."""
        try:
            value = json.loads(self.body)
        except (ValueError, RecursionError):
            value = None
        if not isinstance(value, dict):
            raise Refused("the server's answer is not JSON; is it a hairbaked?", status=self.status)
        return value

    def refuse(self) -> Refused:
        """The exception for an error answer: the server's message and the field at fault."""
        try:
            problem = self.json()
        except Refused:
            problem = {}
        field, title = plain(problem.get("field", "")), plain(problem.get("title", ""))
        words = plain(problem.get("detail", "")) or title or "no reason given"
        if field and field not in words:
            words = f"{field}: {words}"
        advice = "; a token is needed" if self.status == 401 else ""
        needed_by = problem.get("needed_by")
        needed_by = needed_by if isinstance(needed_by, dict) else {}
        lines = "".join("\n  " + plain(line) for line in needed_lines(needed_by))
        return Refused(f"the server refuses: {words} (HTTP {self.status}){advice}{lines}", field, self.status, needed_by)


class Patience:
    """Waits between retries, longer each time, until `seconds` have passed since the first failure."""

    def __init__(self, seconds: float) -> None:
        self.seconds = seconds
        self.renew()

    def renew(self) -> None:
        """Starts the time again, after progress was made."""
        self.failing_since: Optional[float] = None
        self.pause = FIRST_PAUSE_S

    def wait(self, lost: ConnectionLost) -> None:
        now = time.monotonic()
        if self.failing_since is None:
            self.failing_since = now
            if self.seconds > 0:
                print(f"hairbake: warning: {lost}; retrying for {self.seconds:.0f} s", file=sys.stderr)
        if now - self.failing_since >= self.seconds:
            raise lost
        time.sleep(self.pause)
        self.pause = min(2 * self.pause, LONGEST_PAUSE_S)


def identifier(value: object, what: str = "id") -> str:
    """`value` if it has the form of the service's ids. Raises Refused."""
    if not isinstance(value, str) or not IDENTIFIER.fullmatch(value):
        raise Refused(f"{plain(value)!r} is not a valid {what}")
    return value


class Http:
    """One server. Follows no redirect and uses no proxy."""

    def __init__(self, url: str, token: str, ca_file: Optional[str], patience_s: float) -> None:
        self.url = url.rstrip("/")
        parts = urllib.parse.urlsplit(self.url)
        more = parts.username or parts.query or parts.fragment
        if parts.scheme not in ("http", "https") or not parts.hostname or more:
            raise UsageError(f"server is {url}; allowed is http://HOST:PORT or https://HOST", "server")
        self._host, self._port, self._base = parts.hostname, parts.port, parts.path
        self._context = ssl.create_default_context(cafile=ca_file) if parts.scheme == "https" else None
        self._token, self._patience_s = token, patience_s
        local = self._host in ("localhost", "::1") or self._host.startswith("127.")
        if token and not self._context and not local:
            print("hairbake: warning: the token goes over the network in the clear; https:// protects it",
                  file=sys.stderr)

    def patience(self) -> Patience:
        return Patience(self._patience_s)

    def once(self, method: str, path: str, headers: Optional[Mapping[str, str]] = None, body: bytes = b"",
             source: Optional[Iterator[bytes]] = None, source_bytes: int = 0, sink: Optional[Sink] = None,
             most_bytes: int = 16 << 20) -> Answer:
        """One attempt. `source` gives the request's body in pieces; `sink` takes the body of a 2xx answer. Raises
        ConnectionLost (also for a server that is busy), Unreachable, and Refused for an answer of more than
        `most_bytes`."""
        connection = self._connection()
        try:
            self._send(connection, method, path, headers or {}, body, source, source_bytes)
            answer = self._receive(connection, sink, most_bytes)
        except ssl.SSLCertVerificationError as error:
            raise Unreachable(f"{self.url}: {error}") from error
        except (OSError, http.client.HTTPException) as error:
            raise ConnectionLost(f"{self.url}: {plain(error) or type(error).__name__}") from error
        finally:
            connection.close()
        if answer.status in BUSY:
            raise ConnectionLost(f"{self.url}: {answer.refuse()}")
        return answer

    def ask(self, method: str, path: str, headers: Optional[Mapping[str, str]] = None, body: bytes = b"",
            most_bytes: int = 16 << 20) -> Answer:
        """once() with retries until the patience is used up."""
        patience = self.patience()
        while True:
            try:
                return self.once(method, path, headers, body, most_bytes=most_bytes)
            except ConnectionLost as lost:
                patience.wait(lost)

    def json(self, method: str, path: str, body: Optional[Json] = None) -> Json:
        """Sends and receives JSON. Raises Refused unless the status is 2xx."""
        data = b"" if body is None else json.dumps(body).encode()
        answer = self.ask(method, path, {"Content-Type": "application/json"} if data else None, data)
        if not 200 <= answer.status < 300:
            raise answer.refuse()
        warning = re.search('"(.*)"', answer.headers.get("warning", ""))
        if warning:
            warnings.warn(plain(warning.group(1)), FutureWarning, stacklevel=3)
        return answer.json()

    def _connection(self) -> http.client.HTTPConnection:
        if self._context:
            return http.client.HTTPSConnection(self._host, self._port, timeout=TIMEOUT_S, context=self._context)
        return http.client.HTTPConnection(self._host, self._port, timeout=TIMEOUT_S)

    def _send(self, connection: http.client.HTTPConnection, method: str, path: str, headers: Mapping[str, str],
              body: bytes, source: Optional[Iterator[bytes]], source_bytes: int) -> None:
        connection.putrequest(method, self._base + path, skip_accept_encoding=True)
        for name, value in headers.items():
            connection.putheader(name, value)
        if self._token:
            connection.putheader("Authorization", f"Bearer {self._token}")
        if method not in ("GET", "HEAD", "DELETE"):
            connection.putheader("Content-Length", str(source_bytes if source else len(body)))
        connection.endheaders(body or None)
        try:
            for piece in source or ():
                connection.send(piece)
        except (BrokenPipeError, ConnectionResetError):
            pass  # the server may have sent the reason already

    def _receive(self, connection: http.client.HTTPConnection, sink: Optional[Sink], most_bytes: int) -> Answer:
        response = connection.getresponse()
        answer = Answer(response.status, dict(response.getheaders()))
        length, taken, pieces = response.length, 0, []
        while piece := response.read(PIECE):
            taken += len(piece)
            if taken > most_bytes:
                raise Refused(f"the server's answer is too long; allowed are {most_bytes} bytes")
            if sink and 200 <= answer.status < 300:
                sink(answer, piece)
            else:
                pieces.append(piece)
        if length is not None and taken < length:
            raise http.client.IncompleteRead(b"", length - taken)
        answer.body = b"".join(pieces)
        return answer
