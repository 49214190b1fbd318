"""A result from the server as a folder that appears whole or not at all."""
from __future__ import annotations

import hashlib
import json
import os
import re
import shutil
from contextlib import contextmanager
from pathlib import Path
from typing import Any, BinaryIO, Callable, Dict, Iterator, List, Mapping, NamedTuple, Optional

from ._arrays import Array, read_arrays
from ._errors import ConnectionLost, HairbakeError, Refused, UsageError, plain, words_of
from ._http import Answer, Http
from ._upload import digest_of_file

NAME = re.compile(r"[0-9A-Za-z_-][0-9A-Za-z._-]{0,199}")
DIGEST = re.compile(r"[0-9a-f]{64}")
MOST_FILES = 4096
MOST_WARNINGS = 100


class Result(NamedTuple):
    """A result folder. `received` is the number of bytes that the fetch received."""

    folder: Path
    received: int

    def manifest(self) -> Dict[str, Any]:
        manifest: Dict[str, Any] = json.loads((self.folder / "manifest.json").read_text(encoding="utf-8"))
        return manifest

    def warnings(self) -> List[str]:
        """The warnings of the bake's stages, at most 100."""
        return warnings_in((self.folder / "manifest.json").read_bytes())

    def arrays(self) -> Dict[str, Array]:
        """By name: "transmittance", "diffuse", "specular" ..."""
        return read_arrays(self.folder)


def warnings_in(manifest: bytes) -> List[str]:
    """The warnings that a manifest lists, at most 100, made fit for a terminal. It is not trusted: one that is no JSON
    object, or lists something else, has none."""
    try:
        whole = json.loads(manifest)
    except (ValueError, RecursionError):
        return []
    warnings = whole.get("warnings") if isinstance(whole, dict) else None
    return [plain(text) for text in warnings if isinstance(text, str)][:MOST_WARNINGS] if isinstance(warnings, list) else []


class Listed(NamedTuple):
    name: str
    digest: str
    bytes: int


def listed_files(manifest: bytes) -> List[Listed]:
    """The files that the manifest lists. Checks everything in it. Raises Refused."""
    answer = Answer(200, {})
    answer.body = manifest
    entries = answer.json().get("files")
    if not isinstance(entries, list) or len(entries) > MOST_FILES:
        raise Refused("the server's manifest cannot be trusted: it lists no files, or too many")
    files: Dict[str, Listed] = {}
    for entry in entries:
        try:
            file = Listed(entry["name"], entry["sha256"], entry["bytes"])
            good = (NAME.fullmatch(file.name) and file.name != "manifest.json" and DIGEST.fullmatch(file.digest)
                    and type(file.bytes) is int and file.bytes >= 0 and file.name not in files)
        except (KeyError, TypeError):
            good = None
        if not good:
            raise Refused(f"the server's manifest cannot be trusted: it lists {plain(entry)}")
        files[file.name] = file
    return list(files.values())


def check_result_folder(folder: Path) -> None:
    """Raises UsageError if the folder holds other files than those of an earlier result."""
    if not folder.exists():
        return
    if not folder.is_dir():
        raise UsageError(f"{folder} is not a folder", "out")
    there = {entry.name for entry in folder.iterdir()} - {"manifest.json"}
    if not there and not (folder / "manifest.json").exists():
        return
    try:
        known = {file.name for file in listed_files((folder / "manifest.json").read_bytes())}
    except (OSError, Refused) as error:
        raise UsageError(f"{folder} holds files but no manifest.json of hairbake", "out") from error
    if there - known:
        raise UsageError(f"{folder} holds {sorted(there - known)[0]}, which its manifest.json does not list", "out")


def check_outside(folder: Path, inputs: Mapping[str, str]) -> None:
    """Raises UsageError for an input file (by the name of its field) in `folder`, whose content a fetch replaces. Inputs
    that are no files here are passed over."""
    inside = folder.resolve()
    for field, value in inputs.items():
        path = Path(value)
        if path.exists() and any(inside in (place, *place.parents) for place in (path.resolve(), path.parent.resolve())):
            raise UsageError(f"{field} is {path}, which lies in the result folder {folder}: the result would delete it; "
                             "give another folder, or copy the input elsewhere", field)


def prove_writable(folder: Path) -> None:
    """Makes the hidden folder of a fetch, with the parents that are missing, and removes what it made. Raises
    HairbakeError if results cannot be written there."""
    made = [parent for parent in Path(os.path.abspath(folder)).parents if not parent.exists()]
    try:
        with part_folder(Path(os.path.abspath(folder))):
            pass
        for parent in made:
            parent.rmdir()
    except OSError as error:
        raise HairbakeError(words_of(error, folder), "out") from error


@contextmanager
def part_folder(folder: Path) -> Iterator[Path]:
    """The hidden folder beside `folder`, for one process at a time; files in it are named by digest."""
    parts = folder.parent / f".{folder.name}.hairbake-fetch"
    parts.mkdir(parents=True, exist_ok=True)
    descriptor = os.open(parts, os.O_RDONLY)
    try:
        try:
            import fcntl
            fcntl.flock(descriptor, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except ImportError:
            pass
        except BlockingIOError:
            raise UsageError(f"another hairbake is fetching into {folder}", "out") from None
        yield parts
    finally:
        os.close(descriptor)
        try:
            parts.rmdir()  # when it is empty
        except OSError:
            pass


def holds(path: Path, file: Listed) -> bool:
    if path.is_symlink() or not path.is_file() or path.stat().st_size != file.bytes:
        return False
    return digest_of_file(path) == file.digest


class _Fetch:
    def __init__(self, http: Http, bake: str, folder: Path, parts: Path, progress: Callable[[float], None]) -> None:
        self.http, self.address = http, f"/v1/bakes/{bake}/files/"
        self.folder, self.parts, self.progress = folder, parts, progress
        self.received = self.done = self.total = 0

    def run(self) -> None:
        manifest = self.fetch_manifest()
        files = listed_files(manifest)
        self.total = sum(file.bytes for file in files)
        if shutil.disk_usage(self.parts).free < self.total:
            raise HairbakeError(f"{self.folder}: the disk has no room for the result's {self.total} bytes")
        for file in files:
            self.fetch_file(file)
            self.done += file.bytes
            self.report(0)
        self.received += len(manifest)
        self.move_in(manifest, files)

    def report(self, here: int) -> None:
        self.progress((self.done + here) / self.total if self.total else 1.0)

    def fetch_manifest(self) -> bytes:
        answer = self.http.ask("GET", self.address + "manifest.json")
        if answer.status != 200:
            raise answer.refuse()
        if answer.headers.get("etag") != f'"{hashlib.sha256(answer.body).hexdigest()}"':
            raise Refused("the received manifest does not have the digest that the server states")
        return answer.body

    def fetch_file(self, file: Listed) -> None:
        part = self.parts / file.digest
        if holds(part, file):
            return
        if holds(self.folder / file.name, file):
            shutil.copyfile(self.folder / file.name, part)
            return
        resumed = part.exists()
        self.fill(part, file)
        if holds(part, file):
            return
        part.unlink()
        if not resumed:
            raise Refused(f"the received {file.name} does not have the digest {file.digest} of the manifest")
        self.fetch_file(file)  # the part from an earlier fetch may have been wrong

    def fill(self, part: Path, file: Listed) -> None:
        if part.is_symlink() or (part.exists() and part.stat().st_size > file.bytes):
            part.unlink()
        patience = self.http.patience()
        with open(part, "ab") as stream:
            while (have := stream.seek(0, os.SEEK_END)) < file.bytes:
                try:
                    self.receive(stream, file, have)
                    if stream.seek(0, os.SEEK_END) < file.bytes:
                        raise ConnectionLost(f"{self.http.url}: {file.name} ended early")
                except ConnectionLost as lost:
                    if stream.seek(0, os.SEEK_END) > have:
                        patience.renew()
                    patience.wait(lost)

    def receive(self, stream: BinaryIO, file: Listed, have: int) -> None:
        headers = {"Range": f"bytes={have}-", "If-Range": f'"{file.digest}"'} if have else {}
        begun: List[bool] = []

        def sink(head: Answer, piece: bytes) -> None:
            if not begun:
                if head.status != 206:
                    stream.truncate(0)
                elif not head.headers.get("content-range", "").startswith(f"bytes {have}-"):
                    raise Refused("the server sends another range than the requested one")
                begun.append(True)
            end = stream.seek(0, os.SEEK_END) + len(piece)
            if end > file.bytes:
                raise Refused(f"{file.name} is longer than its manifest says")
            try:
                stream.write(piece)
                stream.flush()
            except OSError as error:  # else it would be taken for an error of the connection
                raise HairbakeError(f"{self.folder}: {error.strerror or error}") from error
            self.received += len(piece)
            self.report(end)

        most = max(file.bytes, 1 << 16)  # a refusal has a body too
        answer = self.http.once("GET", self.address + file.name, headers, sink=sink, most_bytes=most)
        if answer.status == 416:
            stream.truncate(0)
        elif answer.status not in (200, 206):
            raise answer.refuse()

    def move_in(self, manifest: bytes, files: List[Listed]) -> None:
        """Puts the complete folder in place. It replaces an earlier result."""
        staging, aside = self.parts / "whole", self.parts / "earlier"
        for leftover in (staging, aside):
            shutil.rmtree(leftover, ignore_errors=True)
        staging.mkdir()
        for file in files:
            shutil.copyfile(self.parts / file.digest, staging / file.name)
        (staging / "manifest.json").write_bytes(manifest)
        check_result_folder(self.folder)
        if self.folder.exists():
            os.rename(self.folder, aside)
        os.rename(staging, self.folder)
        shutil.rmtree(self.parts, ignore_errors=True)


def fetch_result(http: Http, bake: str, folder: Path, progress: Optional[Callable[[float], None]] = None) -> Result:
    """Fetches into `folder`: new, empty or an earlier result, whose files of the same digest are not fetched again.
    Files received so far are kept in a hidden folder beside it; the next fetch resumes there. Raises HairbakeError."""
    folder = Path(os.path.abspath(folder))
    check_result_folder(folder)
    try:
        with part_folder(folder) as parts:
            fetch = _Fetch(http, bake, folder, parts, progress or (lambda fraction: None))
            fetch.run()
    except OSError as error:
        raise HairbakeError(f"{folder}: {error.strerror or error}") from error
    return Result(folder, fetch.received)
