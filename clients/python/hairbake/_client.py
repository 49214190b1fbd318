"""The client: what a pipeline script calls."""
from __future__ import annotations

import os
import re
import stat
import sys
import time
from pathlib import Path
from typing import Any, Callable, Dict, Iterable, List, Mapping, NamedTuple, Optional, Sequence, Union

from ._errors import BakeCancelled, BakeFailed, HairbakeError, Refused, UsageError, plain
from ._fetch import Result, fetch_result, warnings_in
from ._http import Http, Json, identifier
from ._upload import check_file, send_if_lacking

PathLike = Union[str, "os.PathLike[str]"]
Progress = Callable[[str, float], None]  #: stage ("upload", "bake", "fetch") and its fraction
ENDED = ("done", "failed", "cancelled")
FIRST_POLL_S, LONGEST_POLL_S = 0.1, 2.0
REFERENCE = re.compile(r"(name|sha256):")


class Bake(NamedTuple):
    """A bake in the state that the server last reported. `view` is the server's whole answer."""

    id: str
    state: str  #: "queued", "running", "done", "failed" or "cancelled"
    view: Json

    @property
    def fraction(self) -> float:
        """The share of the bake that is done, 0 to 1."""
        fraction = self.view.get("fraction")
        return min(1.0, max(0.0, float(fraction))) if isinstance(fraction, (int, float)) else 0.0

    @property
    def message(self) -> str:
        """The reason why it failed, or empty."""
        error = self.view.get("error")
        return plain(error.get("message", "")) if isinstance(error, dict) else ""

    @property
    def field(self) -> str:
        """The request's field at fault, or empty."""
        error = self.view.get("error")
        return plain(error.get("field", "")) if isinstance(error, dict) else ""


class Batch(NamedTuple):
    """Bakes that a re-bake made."""

    id: str
    bakes: int
    states: Dict[str, int]  #: number of bakes in each state
    created: str = ""  #: when, in UTC: "2026-11-28T10:00:00Z"


BakeOrId = Union[Bake, str]


def read_token(file: PathLike) -> str:
    """The token in `file`. Warns when everybody on this machine can read the file. Raises HairbakeError."""
    path = Path(file)
    try:
        token = path.read_text(encoding="ascii", errors="replace").strip()
        if path.stat().st_mode & stat.S_IROTH:
            print(f"hairbake: warning: {path} can be read by everybody on this machine", file=sys.stderr)
    except OSError as error:
        raise HairbakeError(f"{path}: {error.strerror or error}", "token-file") from error
    if not re.fullmatch(r"[!-~]{1,4096}", token):
        raise HairbakeError(f"{path} is not a token: one word of printable characters", "token-file")
    return token


def check_files(inputs: Mapping[str, PathLike]) -> None:
    """Checks every input (by the name of its field) that is no reference, before any of them is sent. Raises
    HairbakeError."""
    for field, value in inputs.items():
        if not REFERENCE.match(os.fspath(value)):
            check_file(Path(value), field)


def _bake(view: Any) -> Bake:
    if not isinstance(view, dict):
        raise Refused("the server's answer is not a bake")
    return Bake(identifier(view.get("id")), str(view.get("state")), view)


def _batch(view: Json) -> Batch:
    states, bakes = view.get("states"), view.get("bakes")
    counted = isinstance(states, dict) and all(isinstance(count, int) for count in states.values())
    if not isinstance(bakes, int) or not counted:
        raise Refused("the server's answer is not a batch")
    return Batch(identifier(view.get("id")), bakes, dict(states or {}), plain(view.get("created") or ""))


def _id(bake: BakeOrId) -> str:
    return bake.id if isinstance(bake, Bake) else identifier(bake)


class Client:
    """Talks to one service.

    server:            http://HOST:PORT or https://HOST
    token, token_file: the token, or a file with it; only if the service has tokens
    ca_file:           certificates (PEM) that replace the system's
    patience_s:        time for retries while the service cannot be reached, for example during a restart
    progress:          called with the stage and its fraction

    Inputs are paths, "sha256:DIGEST" or "name:NAME". Every method raises HairbakeError: Unreachable, Refused (with the
    field at fault), or HairbakeError itself for a local file. Not thread-safe."""

    def __init__(self, server: str, token: str = "", token_file: Optional[PathLike] = None,
                 ca_file: Optional[str] = None, patience_s: float = 120, progress: Optional[Progress] = None) -> None:
        self._http = Http(server, read_token(token_file) if token_file else token, ca_file, patience_s)
        self._progress: Progress = progress or (lambda stage, fraction: None)
        self._paths: Dict[str, str] = {}  # references of files that were sent

    def upload(self, file: PathLike, kind: str = "", name: str = "", note: str = "") -> str:
        """Sends the file when the server lacks it and returns "sha256:DIGEST". With `kind` "model" or "environment" the
        server reads and lists it. `name` ("stage1/sunset") needs a kind, which may be "mesh"; the name then means this
        file."""
        path = Path(file)
        try:
            size = max(1, path.stat().st_size)
        except OSError as error:
            raise HairbakeError(f"{path}: {error.strerror or error}") from error
        reference = send_if_lacking(self._http, path, lambda done: self._progress("upload", done / size))
        self._paths[reference] = str(path)
        digest = {"sha256": reference.split(":")[1]}
        if kind in ("model", "environment"):
            self._http.json("POST", f"/v1/{kind}s", digest)
        if name:
            if kind not in ("model", "environment", "mesh") or not re.fullmatch(r"[0-9A-Za-z._/-]{1,200}", name):
                raise UsageError(f"name is {name!r}; allowed are up to 200 letters, digits and . _ - / with "
                                 "a kind", "name")
            self._http.json("PUT", f"/v1/names/{kind}/{name}", {**digest, "note": note})
        return reference

    def delete(self, reference: str, kind: str = "", force: bool = False) -> None:
        """Deletes the input "sha256:DIGEST" from the server; results stay. `kind` "model" or "environment": the server
        lists it. Raises Refused with `needed_by` if done bakes or versions of names refer to it and `force` is false, and
        always while a bake that has not ended needs it."""
        digest = re.fullmatch(r"sha256:([0-9a-f]{64})", reference)
        if not digest:
            raise UsageError(f"input is {plain(reference)}; allowed is sha256:DIGEST with 64 hexadecimal digits", "input")
        place = f"{kind}s" if kind in ("model", "environment") else "blobs"
        answer = self._http.ask("DELETE", f"/v1/{place}/{digest.group(1)}" + ("?force=1" if force else ""))
        if answer.status != 204:
            raise answer.refuse()

    def submit(self, hair: Optional[PathLike] = None, environment: Optional[PathLike] = None, *,
               occluder: Optional[PathLike] = None, receiver: Optional[PathLike] = None, priority: int = 0,
               **fields: Any) -> Bake:
        """Posts the request for a bake. A request whose result is stored is done at once. `fields` are the other
        blocks of the request: strand={...}, transmittance={...}, fiber={...}, environment_settings={...},
        irradiance={...}, outputs=[...]."""
        request: Json = {**fields, "priority": priority}
        inputs = {"hair": hair, "environment": environment, "occluder": occluder, "receiver": receiver}
        check_files({field: value for field, value in inputs.items() if value is not None})
        for field, value in inputs.items():
            if value is not None:
                request[field] = self._reference(value)
        return _bake(self._http.json("POST", "/v1/bakes", request))

    def status(self, bake: BakeOrId) -> Bake:
        return _bake(self._http.json("GET", f"/v1/bakes/{_id(bake)}"))

    def list(self, newest: Optional[int] = None, **filters: str) -> List[Bake]:
        """The bakes that match the filters, newest first. Filters: state, model, environment, name, batch. `newest`: at
        most this number of bakes, up to 1,000; None: all."""
        query = "&".join(f"{name}={_plain_filter(value)}" for name, value in filters.items())
        bakes: List[Bake] = []
        cursor = ""
        while True:
            page = self._http.json("GET", f"/v1/bakes?limit={newest or 1000}&{query}{cursor}")
            views = page.get("bakes")
            if not isinstance(views, list):
                raise Refused("the server's answer is not a list of bakes")
            bakes += [_bake(view) for view in views]
            if newest or page.get("next") is None:
                return bakes
            cursor = f"&cursor={identifier(page['next'], 'cursor')}"

    def wait(self, bake: BakeOrId) -> Bake:
        """Waits until the bake is done and returns it. Raises BakeFailed with the reason, or BakeCancelled."""
        return self.wait_all([bake])[0]

    def wait_all(self, bakes: Iterable[BakeOrId]) -> List[Bake]:
        """Waits until all have ended. Raises BakeFailed or BakeCancelled for the first that is not done."""
        ended = self.wait_ended(bakes)
        for bake in ended:
            if bake.state != "done":
                words = f"bake {bake.id} " + ("failed" if bake.state == "failed" else "was cancelled")
                reason = self.with_paths(f"{words}: {bake.message}" if bake.message else words)
                raise (BakeFailed if bake.state == "failed" else BakeCancelled)(reason, bake.field)
        return ended

    def wait_ended(self, bakes: Iterable[BakeOrId]) -> List[Bake]:
        """Waits until all are done, failed or cancelled."""
        ids = [_id(bake) for bake in bakes]
        ended: Dict[str, Bake] = {}
        tags: Dict[str, str] = {}
        pause = FIRST_POLL_S
        while True:
            fractions = 0.0
            for bake in ids:
                if bake not in ended:
                    view = self._poll(bake, tags)
                    if view and view.state in ENDED:
                        ended[bake] = view
                    elif view:
                        fractions += view.fraction
            self._progress("bake", (len(ended) + fractions) / max(1, len(set(ids))))
            if len(ended) == len(set(ids)):
                return [ended[bake] for bake in ids]
            time.sleep(pause)
            pause = min(1.3 * pause, LONGEST_POLL_S)

    def fetch(self, bake: BakeOrId, folder: PathLike) -> Result:
        """Fetches the result into a folder, which appears whole or not at all. The folder must be new, empty or an
        earlier result. An interrupted fetch is resumed. Every file is checked against its digest."""
        return fetch_result(self._http, _id(bake), Path(folder), lambda fraction: self._progress("fetch", fraction))

    def cancel(self, bake: BakeOrId) -> None:
        """Cancels the bake. Does nothing if it is cancelled already. Raises Refused if it is done or has failed."""
        answer = self._http.ask("DELETE", f"/v1/bakes/{_id(bake)}")
        if answer.status == 409 and self.status(bake).state == "cancelled":
            return
        if answer.status != 200:
            raise answer.refuse()

    def warnings(self, bake: BakeOrId) -> List[str]:
        """The warnings of the stages of a bake that is done, at most 100. None where the service has its manifest no
        more."""
        answer = self._http.ask("GET", f"/v1/bakes/{_id(bake)}/files/manifest.json")
        return [self.with_paths(text) for text in warnings_in(answer.body)] if answer.status == 200 else []

    def rebake(self, environment: PathLike, *, bakes: Optional[Sequence[BakeOrId]] = None,
               replaces: Optional[PathLike] = None, name: Optional[str] = None,
               models: Optional[Sequence[PathLike]] = None, priority: int = 0,
               **blocks: Mapping[str, Any]) -> Batch:
        """Bakes grooms again under a new environment; their transmittance is not computed again. Exactly one of
        `bakes`, `replaces` (an environment), `name` (of an environment) and `models` selects the grooms. `blocks` are
        blocks of the request whose fields change: irradiance={...}, environment_settings={...}, fiber={...}."""
        return _batch(self._rebake("", environment, bakes, replaces, name, models, priority, blocks))

    def rebake_forecast(self, environment: PathLike, *, bakes: Optional[Sequence[BakeOrId]] = None,
                        replaces: Optional[PathLike] = None, name: Optional[str] = None,
                        models: Optional[Sequence[PathLike]] = None, **blocks: Mapping[str, Any]) -> Json:
        """The work that rebake() would do: {"bakes": n, "done_bakes": n, "reused_stages": {...},
        "computed_stages": {...}}."""
        return self._rebake("?dry_run=1", environment, bakes, replaces, name, models, 0, blocks)

    def batch(self, batch: Union[Batch, str]) -> Batch:
        id = batch.id if isinstance(batch, Batch) else identifier(batch)
        return _batch(self._http.json("GET", f"/v1/batches/{id}"))

    def wait_batch(self, batch: Union[Batch, str]) -> List[Bake]:
        """Waits until all bakes of the batch are done, failed or cancelled, and returns them."""
        pause = FIRST_POLL_S
        while True:
            now = self.batch(batch)
            live = now.states.get("queued", 0) + now.states.get("running", 0)
            self._progress("bake", 1 - live / max(1, now.bakes))
            if not live:
                return self.list(batch=now.id)
            time.sleep(pause)
            pause = min(1.3 * pause, LONGEST_POLL_S)

    def with_paths(self, text: str) -> str:
        """`text`, with the paths of sent files in place of their digests."""
        for reference, path in self._paths.items():
            text = text.replace(reference, path)
        return text

    def _reference(self, value: PathLike) -> str:
        text = os.fspath(value)
        return text if REFERENCE.match(text) else self.upload(text)

    def _poll(self, bake: str, tags: Dict[str, str]) -> Optional[Bake]:
        """The bake, or None if it has not changed."""
        answer = self._http.ask("GET", f"/v1/bakes/{bake}", {"If-None-Match": tags[bake]} if bake in tags else None)
        if answer.status == 304:
            return None
        if answer.status != 200:
            raise answer.refuse()
        if "etag" in answer.headers:
            tags[bake] = answer.headers["etag"]
        return _bake(answer.json())

    def _rebake(self, query: str, environment: PathLike, bakes: Optional[Sequence[BakeOrId]],
                replaces: Optional[PathLike], name: Optional[str], models: Optional[Sequence[PathLike]],
                priority: int, blocks: Mapping[str, Mapping[str, Any]]) -> Json:
        check_files({"environment": environment, **({"replaces": replaces} if replaces is not None else {}),
                     **{f"models[{i}]": model for i, model in enumerate(models or ())}})
        body: Json = {"environment": self._reference(environment), "priority": priority}
        if bakes is not None:
            body["bakes"] = [_id(bake) for bake in bakes]
        if replaces is not None:
            body["replaces"] = self._reference(replaces)
        if name is not None:
            body["name"] = name
        if models is not None:
            body["models"] = [self._reference(model) for model in models]
        body.update((block, dict(fields)) for block, fields in blocks.items() if fields is not None)
        return self._http.json("POST", f"/v1/rebakes{query}", body)


def _plain_filter(value: str) -> str:
    if not re.fullmatch(r"[0-9A-Za-z._/:-]{1,600}", value):
        raise UsageError(f"{plain(value)!r} is not a valid filter")
    return value
