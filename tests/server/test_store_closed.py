"""Starts of a store with files that are closed, and `store accept` where there is no store."""
import os
import shutil
import subprocess
import unittest
from pathlib import Path

from harness import PATIENCE, PROGRAMS, TUS, Daemon
from stores import Store, StoreTest, end_of, files_below


class ClosedFiles(StoreTest):
    """Fault: a start met a file that it could not read or write, and the message named neither file nor cause, or its
    advice was to move a healthy database away."""

    def test_files_and_folders_that_are_closed_stop_the_start_with_path_and_cause(self):
        with Store() as d:
            d.bind_to_modes()
            for name, mode, verb in (("hairbake.db", 0, "read"), ("hairbake.db", 0o440, "written"), ("store-id", 0, "read"),
                                     ("lock", 0, "read"), ("lock", 0o440, "written"), ("blobs", 0, "read"),
                                     (f"blobs/{d.hair[:2]}", 0, "read"), (f"blobs/{d.hair[:2]}", 0o500, "written"),
                                     ("tmp", 0o500, "written"), ("uploads", 0, "read"), ("", 0, "read"), ("", 0o500, "written")):
                path = d.store / name
                with self.subTest(name, mode=oct(mode)):
                    right = path.stat().st_mode & 0o7777
                    path.chmod(mode)
                    try:
                        log = d.refused()
                    finally:
                        path.chmod(right)
                    self.assertIn(f"{path} cannot be {verb}: Permission denied. Nothing was changed", log)
                    self.assertIn(f"chown -R {os.geteuid()} {d.store}", log)
                    self.assertNotIn("ove it away", log)
                    self.assertNotIn("store accept", log)
                    self.assertEqual(files_below(d.store), d.files)
            d.start()
            self.assert_serves_all(d)

    @unittest.skipUnless(os.geteuid() == 0, "root alone can act as another user")
    def test_accept_as_root_leaves_a_store_that_the_user_of_the_daemon_can_open(self):
        user = 54321
        d = Store(before=["setpriv", f"--reuid={user}", f"--regid={user}", "--clear-groups"])
        d.path.chmod(0o777)
        with d:
            copy = d.path / "copy"
            shutil.copy(d.database, copy)
            d.add(os.urandom(500))
            shutil.copy(copy, d.database)
            d.refused()
            for missing in ("store-id", "lock", "tmp", "uploads"):  # relatives: each of these is made anew
                with self.subTest(missing):
                    aside = d.path / "aside"
                    (d.store / missing).rename(aside)
                    d.accept()
                    if missing == "uploads":
                        aside.joinpath(d.upload.rsplit("/", 1)[1]).rename(d.store / "uploads" / d.upload.rsplit("/", 1)[1])
                    subprocess.run(["rm", "-rf", aside], check=True)
                    for file in d.store.rglob("*"):
                        self.assertEqual((file.stat().st_uid, file.stat().st_gid), (user, user), file)
                    d.data = {digest: data for digest, data in d.data.items() if d.blob_file(digest).exists()}
                    d.start()
                    d.put(os.urandom(100))
                    d.stop()
            # One that an earlier program left to root.
            os.chown(d.store / "store-id", 0, 0)
            self.assertIn("store-id cannot be read: Permission denied", d.refused())
            d.accept()
            d.start()

    def test_a_folder_in_uploads_is_moved_to_lost_and_found(self):
        """Relatives: an empty folder, and one with the name of an upload."""
        with Store() as d:
            (d.store / "uploads/somebody").mkdir()
            (d.store / "uploads/somebody/letter").write_text("mine")
            (d.store / "uploads/empty").mkdir()
            upload = d.store / "uploads" / d.upload.rsplit("/", 1)[1]
            upload.unlink()
            upload.mkdir()
            d.start()
            self.assertEqual(d.lost_and_found(), {"letter": b"mine"})
            self.assertEqual(list((d.store / "uploads").iterdir()), [])
            self.assertEqual(d.ask("HEAD", d.upload, headers=TUS).status, 404)

    def test_a_file_in_the_place_of_a_folder_stops_the_start(self):
        with Store() as d:
            d.store.rename(d.path / "aside")
            d.store.write_text("x")
            log = d.refused()
            self.assertIn(f"{d.store} cannot be made: Not a directory", log)
            self.assertIn("Let [store] folder name the folder of a store", log)
            d.store.unlink()
            (d.path / "aside").rename(d.store)
            for part in ("tmp", "uploads"):
                (d.store / part).rename(d.path / "aside")
                (d.store / part).write_text("x")
                self.assertIn(f"{d.store / part} cannot be made: Not a directory", d.refused())
                (d.store / part).unlink()
                (d.path / "aside").rename(d.store / part)
            d.database.rename(d.path / "aside")
            d.database.mkdir()
            self.assertIn(f"the database {d.database} cannot be read", d.refused())

    def test_a_lost_row_of_the_store_stops_the_start_until_accept(self):
        with Store() as d:
            d.sql("DELETE FROM store")
            self.assert_stops(d, "the row of its table store", "hairbaked store accept --config FILE")
            d.accept()
            d.start()
            self.assert_serves_all(d)

    def test_a_database_that_is_found_broken_after_its_check_stops_the_start_with_its_path(self):
        with Store() as d:
            spoiled = 0
            whole = d.database.read_bytes()
            for page in range(8, min(len(whole) // 4096, 30), 3):
                other = (page + 7) % (len(whole) // 4096)
                d.database.write_bytes(whole[:page * 4096] + whole[other * 4096:(other + 1) * 4096] + whole[(page + 1) * 4096:])
                (d.path / "log").write_text("")
                d.process = d.spawn()
                if b"listens" in d.process.stdout.readline():
                    d.stop()
                else:
                    spoiled += 1
                    self.assertEqual(end_of(d.process), 3, d.log)
                    self.assertIn(str(d.store), d.log)
                for end in ("-wal", "-shm"):
                    Path(f"{d.database}{end}").unlink(missing_ok=True)
            self.assertGreater(spoiled, 0)


class AcceptWithoutStore(StoreTest):
    """Fault: `store accept` made a new store where there was none, and told of success."""

    def test_accept_refuses_a_folder_without_a_store_and_leaves_it(self):
        with Daemon() as d:
            d.stop()
            for exists in (True, False):
                for line in ("", f'id = "{32 * "0"}"'):
                    with self.subTest(exists=exists, line=line):
                        shutil.rmtree(d.path / "store", ignore_errors=True)
                        if exists:
                            (d.path / "store").mkdir()
                        d.config = line
                        d.write_config()
                        done = subprocess.run([PROGRAMS / "hairbaked", "store", "accept", "--config", d.path / "hairbake.toml"],
                                              capture_output=True, text=True, timeout=PATIENCE)
                        self.assertEqual((done.returncode, done.stdout), (3, ""))
                        self.assertIn(str(d.path / "store"), done.stderr)
                        self.assertIn("its disk mounted?", done.stderr)
                        self.assertEqual((d.path / "store").exists(), exists)
                        if exists:
                            self.assertEqual(list((d.path / "store").iterdir()), [])


if __name__ == "__main__":
    unittest.main()
