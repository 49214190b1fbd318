"""A store on a small disk of its own, which a test fills."""
import errno
import subprocess
from pathlib import Path

from harness import PATIENCE, Daemon

SIZE_MB = 8


class SmallDisk(Daemon):
    """The store is a tmpfs of SIZE_MB that only the daemon and its workers see; it is gone when the daemon ends."""

    def __init__(self, config="keep_free_mb = 0", size_mb=SIZE_MB):
        super().__init__(config=config)
        self.size_mb = size_mb
        self.store = self.path / "store"
        self.store.mkdir()
        mount = f'mount -t tmpfs -o size={size_mb}m none "$0" && exec "$@"'
        self.before = ["unshare", "--map-root-user", "--mount", "sh", "-c", mount, self.store]

    @property
    def inside(self):
        """The store as the daemon sees it."""
        return Path(f"/proc/{self.process.pid}/root{self.store}")

    def run_inside(self, script):
        subprocess.run(["nsenter", "--target", str(self.process.pid), "--user", "--mount", "--preserve-credentials", "sh", "-c",
                        script, self.store], check=True, timeout=PATIENCE)

    def fill(self, leave=0, name="filler"):
        """Writes until nothing fits any more, then gives `leave` bytes free. Another `name` keeps what the last one took."""
        with open(self.inside / name, "wb", buffering=0) as filler:
            try:
                while filler.write(bytes(4096)):
                    pass
            except OSError as error:
                assert error.errno == errno.ENOSPC, error
            filler.truncate(filler.tell() - leave)

    def free_filler(self):
        (self.inside / "filler").unlink()

    def make_log_full(self, **how):
        """Fills the disk so that the database's log cannot grow. The log keeps the size that it once had, and is begun anew
        after a checkpoint: so it is emptied first."""
        subprocess.run(["nsenter", "--target", str(self.process.pid), "--user", "--mount", "--preserve-credentials", "python3",
                        "-c", "import sqlite3, sys; sqlite3.connect(sys.argv[1]).execute('PRAGMA wal_checkpoint(TRUNCATE)')",
                        self.store / "hairbake.db"], check=True, timeout=PATIENCE)
        assert (self.inside / "hairbake.db-wal").stat().st_size == 0
        self.fill(**how)

    def leftovers(self):
        return sorted(p.name for p in (self.inside / "tmp").iterdir())


class LastingDisk(SmallDisk):
    """The same, and the disk outlives restarts of the daemon."""

    def __enter__(self):
        mount = f'mount -t tmpfs -o size={self.size_mb}m none "$0" && echo mounted && exec sleep infinity'
        self.holder = subprocess.Popen(["unshare", "--map-root-user", "--mount", "sh", "-c", mount, self.store],
                                       stdout=subprocess.PIPE)
        assert self.holder.stdout.readline() == b"mounted\n"
        self.before = ["nsenter", "--target", str(self.holder.pid), "--user", "--mount", "--preserve-credentials"]
        return super().__enter__()

    def __exit__(self, *stack):
        super().__exit__(*stack)
        self.holder.kill()
        self.holder.wait()
        self.holder.stdout.close()

    @property
    def inside(self):
        return Path(f"/proc/{self.holder.pid}/root{self.store}")
