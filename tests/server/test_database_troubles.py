"""Passing troubles of the database: a full disk at the start, and the lock of another program."""
import os
import shutil
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

from disks import LastingDisk
from harness import PATIENCE, PROGRAMS, Daemon, sha256
from stores import Store, end_of, files_below

HOLD = """import sqlite3, sys
other = sqlite3.connect(sys.argv[1])
other.execute("BEGIN " + sys.argv[2])
print("held", flush=True)
sys.stdin.read(1) if sys.argv[3] == "0" else __import__("time").sleep(float(sys.argv[3]))"""


class Holder:
    """Another program that holds the database's lock: for `seconds`, or until release()."""

    def __init__(self, database, seconds=0, kind="IMMEDIATE"):
        self.process = subprocess.Popen([sys.executable, "-c", HOLD, database, kind, str(seconds)], stdin=subprocess.PIPE,
                                        stdout=subprocess.PIPE)
        assert self.process.stdout.readline() == b"held\n"

    def __enter__(self):
        return self

    def release(self):
        self.process.stdin.close()
        self.process.wait(PATIENCE)
        self.process.stdout.close()

    def __exit__(self, *_):
        self.release()


class Locked(unittest.TestCase):
    """Fault: while another program held the lock, writes were 500 at once, and a start advised to move the database away."""

    def test_a_write_waits_for_a_lock_that_is_released(self):
        with Daemon() as d:
            database = d.path / "store/hairbake.db"
            for kind in ("IMMEDIATE", "EXCLUSIVE"):
                with Holder(database, seconds=1, kind=kind):
                    d.put(kind.encode())

    def test_a_lock_that_stays_is_503_and_the_request_works_afterwards(self):
        """Relatives of PUT: a name, a bake, an upload, a deletion."""
        with Daemon() as d:
            gone, kept = d.put(b"gone"), d.put(b"kept")
            requests = {"PUT": ("PUT", f"/v1/blobs/{sha256(b'new')}", b"new"),
                        "name": ("PUT", "/v1/names/model/x", {"sha256": kept}),
                        "DELETE": ("DELETE", f"/v1/blobs/{gone}")}
            with Holder(d.path / "store/hairbake.db"):
                replies = {name: d.ask(*request) for name, request in requests.items()}
                replies["upload"] = d.create_upload(b"a body")
                self.assertEqual(d.ask("GET", f"/v1/blobs/{gone}").body, b"gone")  # what is read may be read
            for name, reply in replies.items():
                self.assertEqual((reply.status, reply.headers["Retry-After"]), (503, "5"), (name, reply.body))
                self.assertIn("another program holds the lock of the database", reply.json["detail"], name)
            for name, request in requests.items():
                self.assertIn(d.ask(*request).status, (200, 201, 204), name)

    def test_a_start_waits_for_the_lock(self):
        with Store() as d:
            for kind in ("IMMEDIATE", "EXCLUSIVE"):
                with Holder(d.database, seconds=1, kind=kind):
                    d.start()
                self.assertEqual(d.ask("GET", "/readyz").status, 200)
                d.stop()

    def test_a_start_under_a_lock_that_stays_changes_nothing_and_says_why(self):
        """Relative: `store accept`. The exit code lets systemd try again."""
        with Store() as d:
            unknown = d.store / "blobs/ab" / ("ab" * 32)
            unknown.write_bytes(b"the database does not know it")
            leftover = d.store / "tmp" / ("0" * 32)
            leftover.write_bytes(b"a body of an earlier run")
            before = files_below(d.store)
            for kind in ("IMMEDIATE", "EXCLUSIVE"):
                with self.subTest(kind), Holder(d.database, kind=kind):
                    (d.path / "log").write_text("")
                    self.assertEqual(end_of(d.spawn()), 1, d.log)
                    accept = subprocess.run([PROGRAMS / "hairbaked", "store", "accept", "--config", d.path / "hairbake.toml"],
                                            capture_output=True, text=True, timeout=PATIENCE)
                    self.assertEqual(accept.returncode, 1, accept.stderr)
                    for text in (d.log, accept.stderr):
                        self.assertIn("another program holds the lock of the database", text)
                        self.assertNotIn("ove it away", text)
                    self.assertEqual(files_below(d.store), before)
            d.start()


class FullDiskAtTheStart(unittest.TestCase):
    """Fault: a full disk without a reserve: "disk I/O error ... Move it away"."""

    def test_the_message_says_how_much_to_free_and_room_heals(self):
        with LastingDisk() as d:
            kept = d.put(b"kept")
            d.stop()
            (d.inside / "reserve").unlink()
            d.fill()
            for command in ([], ["store", "accept"]):
                with self.subTest(command):
                    done = subprocess.run([*d.before, PROGRAMS / "hairbaked", *command, "--config", d.path / "hairbake.toml"],
                                          capture_output=True, text=True, timeout=PATIENCE)
                    self.assertEqual(done.returncode, 1, done.stderr)
                    for words in ("its disk is full", "Free at least 256 KiB", "Nothing was changed or removed"):
                        self.assertIn(words, done.stderr)
                    self.assertNotIn("ove it away", done.stderr)
            d.free_filler()
            d.start()
            self.assertEqual(d.ask("GET", f"/v1/blobs/{kept}").body, b"kept")


@unittest.skipUnless(os.geteuid() == 0 and shutil.which("mkfs.ext4"), "needs root and mkfs.ext4")
class SmallBlocks(unittest.TestCase):
    """Fault: on a disk with blocks of 1 KiB that is nearly full, the start ended by SIGBUS: SQLite writes its -shm through a
    mapping whose blocks the disk could not give."""

    def setUp(self):
        self.folder = Path(tempfile.mkdtemp(prefix="hairbake-blocks-"))
        self.addCleanup(shutil.rmtree, self.folder, ignore_errors=True)
        image, self.disk = self.folder / "image", self.folder / "disk"
        self.disk.mkdir()
        with open(image, "wb") as file:
            file.truncate(40 << 20)
        subprocess.run(["mkfs.ext4", "-q", "-F", "-b", "1024", "-m", "0", image], check=True)
        if subprocess.run(["mount", "-o", "loop", image, self.disk], capture_output=True).returncode != 0:
            self.skipTest("no loop device")
        self.addCleanup(subprocess.run, ["umount", "--lazy", self.disk], check=True)

    def fill(self, leave_kib):
        """Leaves so many KiB free."""
        (self.disk / "pad").write_bytes(bytes(leave_kib << 10))
        os.sync()
        for count in (65536, 1024):
            with open(self.disk / f"filler{count}", "wb", buffering=0) as filler:
                try:
                    while filler.write(bytes(count)):
                        pass
                except OSError:
                    pass
        (self.disk / "pad").unlink()
        os.sync()

    def test_the_start_says_that_the_disk_is_full_or_serves(self):
        with Daemon(config="keep_free_mb = 0") as d:
            d.stop()
            shutil.move(d.path / "store", self.disk / "store")
            (d.path / "store").symlink_to(self.disk / "store")
            for end in ("stop", "kill"):
                for leave in (0, 2, 8, 16, 32, 48):
                    with self.subTest(end, leave_kib=leave):
                        d.start()
                        kept = d.put(b"kept %d" % leave)
                        getattr(d, end)()
                        (self.disk / "store/reserve").unlink(missing_ok=True)
                        self.fill(leave)
                        (d.path / "log").write_text("")
                        d.process = d.spawn()
                        if "listens on" in (line := d.process.stdout.readline().decode()):
                            d.address = ("127.0.0.1", int(line.rsplit(":", 1)[1]))
                            self.assertEqual(d.ask("GET", f"/v1/blobs/{kept}").status, 200)
                            self.assertIn(d.ask("PUT", f"/v1/blobs/{sha256(b'x')}", b"x").status, (200, 201, 507))
                            d.kill()
                        else:
                            self.assertEqual(end_of(d.process), 1, (d.path / "log").read_text())
                            self.assertIn("disk is full", (d.path / "log").read_text())
                        for count in (65536, 1024):
                            (self.disk / f"filler{count}").unlink()
            d.start()


class StoreIdNotWritable(unittest.TestCase):
    """Fault: a `store-id` that cannot be written was a warning in the log alone."""

    def test_readyz_names_the_file(self):
        with Daemon() as d:
            kept = d.put(b"kept")
            d.stop()
            mark = d.path / "store/store-id"
            d.before = ["unshare", "--map-root-user", "--mount", "sh", "-c", 'mount --bind "$0" "$0" && exec "$@"', mark]
            d.start()  # nothing can be renamed over a mounted file
            ready = d.ask("GET", "/readyz")
            self.assertEqual(ready.status, 503)
            self.assertIn(f"{mark} cannot be written", ready.json["detail"])
            self.assertEqual(d.ask("GET", f"/v1/blobs/{kept}").status, 200)
            subprocess.run(["nsenter", "--target", str(d.process.pid), "--user", "--mount", "--preserve-credentials", "umount",
                            "--lazy", mark], check=True, timeout=PATIENCE)
            self.assertEqual(d.ask("GET", "/readyz").status, 200)
            d.stop()
            d.before = []
            d.start()


if __name__ == "__main__":
    unittest.main()
