"""Sends files that the server lacks, by tus 1.0. Resumes interrupted uploads."""
from __future__ import annotations

import base64
import hashlib
import os
import re
import stat
from pathlib import Path
from typing import BinaryIO, Callable, Iterator, Optional

from ._errors import ConnectionLost, HairbakeError, Refused, UsageError, words_of
from ._http import PIECE, Http, identifier

GONE = (404, 410)


def open_input(path: Path) -> BinaryIO:
    try:
        return open(path, "rb")
    except OSError as error:  # else it would be taken for an error of the connection
        raise HairbakeError(words_of(error, path)) from error


def digest_of_file(path: Path) -> str:
    """SHA-256 as hexadecimal digits."""
    digest = hashlib.sha256()
    with open_input(path) as file:
        while piece := file.read(1 << 20):
            digest.update(piece)
    return digest.hexdigest()


def is_stored(http: Http, digest: str) -> bool:
    answer = http.ask("HEAD", f"/v1/blobs/{digest}")
    if answer.status == 404:
        return False
    if answer.status != 200:
        raise answer.refuse()
    return True


class _Memory:
    """The id of an unfinished upload, in a file that later processes and the program hairbake read."""

    def __init__(self, url: str, digest: str) -> None:
        cache = Path(os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache")
        self.file = cache / "hairbake/uploads" / hashlib.sha256(f"{url} {digest}".encode()).hexdigest()

    def recall(self) -> str:
        try:
            return identifier(self.file.read_text().strip())
        except (OSError, UnicodeDecodeError, Refused):
            return ""

    def keep(self, upload: str) -> None:
        try:
            self.file.parent.mkdir(parents=True, exist_ok=True)
            self.file.write_text(upload + "\n")
        except OSError:
            pass  # the upload then cannot be resumed by another process

    def forget(self) -> None:
        try:
            self.file.unlink()
        except OSError:
            pass


class _Upload:
    def __init__(self, http: Http, path: Path, digest: str, progress: Callable[[int], None]) -> None:
        self.http, self.path, self.digest, self.progress = http, path, digest, progress
        self.bytes = path.stat().st_size
        self.memory = _Memory(http.url, digest)

    def run(self) -> None:
        patience, furthest, begun = self.http.patience(), 0, 0
        upload = self.memory.recall()
        while True:
            try:
                if not upload:
                    begun += 1
                    if begun > 3:
                        raise Refused(f"the server loses the upload of {self.path} each time")
                    upload = self.create()
                    self.memory.keep(upload)
                offset = self.offset_of(upload)
                if offset is not None and offset > furthest:
                    furthest = offset
                    patience.renew()
                if offset is not None and self.append(upload, offset):
                    break
                upload = ""  # the upload is gone: it is complete, or it has expired
                self.memory.forget()
                if is_stored(self.http, self.digest):
                    break
            except ConnectionLost as lost:
                patience.wait(lost)
        self.memory.forget()

    def create(self) -> str:
        metadata = "sha256 " + base64.b64encode(self.digest.encode()).decode()
        answer = self.http.once("POST", "/v1/uploads", {
            "Tus-Resumable": "1.0.0", "Upload-Length": str(self.bytes), "Upload-Metadata": metadata})
        if answer.status != 201:
            raise answer.refuse()
        return identifier(answer.headers.get("location", "").rsplit("/", 1)[-1], "place for an upload")

    def offset_of(self, upload: str) -> Optional[int]:
        """The offset, or None if there is no such upload."""
        answer = self.http.once("HEAD", f"/v1/uploads/{upload}", {"Tus-Resumable": "1.0.0"})
        if answer.status in GONE:
            return None
        if answer.status != 200:
            raise answer.refuse()
        offset = answer.headers.get("upload-offset", "")
        if not re.fullmatch("[0-9]{1,18}", offset) or int(offset) > self.bytes:
            raise Refused(f"the server states a wrong offset for the upload of {self.path}")
        return int(offset)

    def append(self, upload: str, offset: int) -> bool:
        """Sends the rest of the file. False if the upload is gone."""
        answer = self.http.once("PATCH", f"/v1/uploads/{upload}", {
            "Tus-Resumable": "1.0.0", "Content-Type": "application/offset+octet-stream", "Upload-Offset": str(offset)},
            source=self.pieces(offset), source_bytes=self.bytes - offset)
        if answer.status in GONE:
            return False
        if answer.status == 409:  # another process sends it, or the server has not yet closed the lost connection
            raise ConnectionLost(f"{self.http.url}: another request is writing the upload of {self.path}")
        if answer.status != 204:
            raise answer.refuse()
        return True

    def pieces(self, offset: int) -> Iterator[bytes]:
        with open_input(self.path) as file:
            file.seek(offset)
            while offset < self.bytes:
                piece = file.read(min(PIECE, self.bytes - offset))
                if not piece:
                    raise HairbakeError(f"{self.path}: became shorter while it was sent")
                yield piece
                offset += len(piece)
                self.progress(offset)


def check_file(path: Path, field: str = "") -> None:
    """Raises HairbakeError unless the path is a file that can be opened. `field` is the name of the input."""
    try:
        mode = path.stat().st_mode
        if stat.S_ISDIR(mode):
            raise UsageError(f"{field + ': ' if field else ''}{path} is a folder; the service takes single files", field)
        if not stat.S_ISREG(mode):
            raise HairbakeError(f"{path}: this is not a regular file", field)
    except OSError as error:
        raise HairbakeError(words_of(error, path), field) from error
    open_input(path).close()


def send_if_lacking(http: Http, path: Path, progress: Callable[[int], None]) -> str:
    """Sends the file if the server lacks it. Returns "sha256:DIGEST". Raises HairbakeError."""
    check_file(path)
    digest = digest_of_file(path)
    if not is_stored(http, digest):
        _Upload(http, path, digest, progress).run()
    return f"sha256:{digest}"
