"""Stores that a test stops, spoils and starts again."""
import contextlib
import os
import re
import sqlite3
import subprocess
import unittest

from harness import PATIENCE, PROGRAMS, TUS, Daemon, hair_bytes, quick_request


def files_below(folder):
    """Path inside of the folder -> bytes, of every file of the store but lock, id, reserve and database."""
    return {str(file.relative_to(folder)): file.read_bytes() for file in sorted(folder.rglob("*"))
            if file.is_file() and not re.match(r"lock$|store-id$|reserve$|hairbake\.db", str(file.relative_to(folder)))}


def end_of(process):
    """The exit code of a daemon that must stop at its start."""
    try:
        return process.wait(PATIENCE)
    finally:
        process.kill()
        process.wait()
        process.stdout.close()


class Store(Daemon):
    """A daemon with some blobs, a done bake and an upload, stopped."""

    def __enter__(self):
        super().__enter__()
        self.data = {self.put(data): data for data in (os.urandom(1000 + n) for n in range(5))}
        hair = hair_bytes()
        self.hair = self.put(hair)
        self.data[self.hair] = hair
        self.bake = self.ask("POST", "/v1/bakes", quick_request(self.hair)).json["id"]
        assert self.wait(self.bake)["state"] == "done"
        self.upload = self.create_upload(b"an upload").headers["Location"]
        assert self.append(self.upload, 0, b"an up").status == 204
        self.stop()
        self.store, self.database = self.path / "store", self.path / "store/hairbake.db"
        self.files = files_below(self.store)
        return self

    def sql(self, statement):
        with contextlib.closing(sqlite3.connect(self.database)) as database, database:
            return database.execute(statement).fetchall()

    @property
    def id(self):
        return (self.store / "store-id").read_text().split()[1]

    @property
    def generation(self):
        return int((self.store / "store-id").read_text().split()[3])

    def add(self, data):
        """A blob that a later run of the daemon gets."""
        self.start()
        self.data[self.put(data)] = data
        self.stop()

    def refused(self):
        """Starts the daemon, which must stop with a message: the message."""
        (self.path / "log").write_text("")
        code = end_of(self.spawn())
        assert code == 3, (code, self.log)
        return self.log

    def bind_to_modes(self):
        """From the next start on, also for root: see harness.become_bound_to_modes()."""
        if os.geteuid() == 0:
            self.before = ["setpriv", "--bounding-set=-dac_override,-dac_read_search"]

    def accept(self):
        subprocess.run([PROGRAMS / "hairbaked", "store", "accept", "--config", self.path / "hairbake.toml"], check=True,
                       stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, timeout=PATIENCE)

    @property
    def log(self):
        return (self.path / "log").read_text()

    def lost_and_found(self):
        """Bytes of the files in lost+found, by name."""
        return {file.name: file.read_bytes() for file in (self.store / "lost+found").rglob("*") if file.is_file()}


class StoreTest(unittest.TestCase):
    maxDiff = None

    def assert_stops(self, d, *words):
        """Nothing was removed, and the message says so and has the words."""
        before = files_below(d.store)
        log = d.refused()
        for word in (*words, "Nothing was changed or removed"):
            self.assertIn(word, log)
        self.assertEqual(files_below(d.store), before)

    def assert_serves_all(self, d):
        for digest, data in d.data.items():
            self.assertEqual(d.ask("GET", f"/v1/blobs/{digest}").body, data)
        self.assertEqual(d.ask("GET", f"/v1/bakes/{d.bake}").json["state"], "done")
        self.assertEqual(d.ask("HEAD", d.upload, headers=TUS).headers["Upload-Offset"], "5")
