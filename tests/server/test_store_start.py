"""Starts of a store with another database than its own, in another folder, or beside another daemon: no file is removed."""
import contextlib
import os
import random
import re
import shutil
import sqlite3
import subprocess
import tempfile
import time
import unittest
from pathlib import Path

from harness import PATIENCE, PROGRAMS, TUS, Daemon, hair_bytes, hdr_bytes, quick_request, sha256


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


class OtherDatabase(StoreTest):
    """Fault: a start with another database removed every blob that it did not know."""

    def test_a_start_without_the_database_stops_and_its_return_heals(self):
        def empty_file(d):
            d.database.write_bytes(b"")

        def empty_database(d):
            with contextlib.closing(sqlite3.connect(d.database)) as made:
                made.execute("VACUUM")  # a valid file without tables
            self.assertGreater(d.database.stat().st_size, 0)

        for name, put_there in {"put aside": lambda d: None, "an empty file": empty_file, "no tables": empty_database}.items():
            for with_id in (True, False):  # a store of an earlier version has no id
                with self.subTest(name, with_id=with_id), Store() as d:
                    kept, mark = d.path / "aside", d.path / "mark"
                    d.database.rename(kept)
                    if not with_id:
                        (d.store / "store-id").rename(mark)
                    put_there(d)
                    self.assert_stops(d, "is missing or empty", f"{len(d.files) - 1} files in blobs and 1 in uploads",
                                      "hairbaked store accept")
                    self.assertRaises(subprocess.CalledProcessError, d.accept)  # that needs a database
                    self.assertEqual(files_below(d.store), d.files)
                    kept.rename(d.database)
                    if not with_id:
                        mark.rename(d.store / "store-id")
                    d.start()
                    self.assert_serves_all(d)

    def test_a_database_of_which_only_the_log_is_left_stops_the_start_and_the_log_stays(self):
        for empty in (False, True):
            with self.subTest(empty=empty), Store() as d:
                d.start()
                data = os.urandom(100)
                d.data[d.put(data)] = data  # in the log alone
                d.kill()
                log, kept = d.store / "hairbake.db-wal", d.path / "aside"
                whole = log.read_bytes()
                self.assertGreater(len(whole), 0)
                d.database.rename(kept)
                if empty:
                    d.database.write_bytes(b"")
                found = "is empty" if empty else "is missing"
                self.assert_stops(d, found, "hairbake.db-wal", "Put the database back beside it")
                self.assertEqual(log.read_bytes(), whole)
                kept.rename(d.database)
                d.start()
                self.assert_serves_all(d)

    def test_a_database_without_its_log_is_an_older_one(self):
        with Store() as d:
            d.start()
            data = os.urandom(100)
            digest = d.put(data)
            d.kill()
            log = d.store / "hairbake.db-wal"
            self.assertGreater(log.stat().st_size, 0)
            log.rename(d.path / "aside")
            self.assert_stops(d, "older than the store", "with its -wal")
            (d.path / "aside").rename(log)
            d.start()
            self.assertEqual(d.ask("GET", f"/v1/blobs/{digest}").body, data)

    def test_an_older_copy_stops_the_start_and_after_accept_unknown_files_are_in_lost_and_found(self):
        with Store() as d:
            copy = d.path / "copy"
            shutil.copy(d.database, copy)
            known = dict(d.data)
            late = [os.urandom(500 + n) for n in range(3)]
            for data in late:
                d.add(data)
            shutil.copy(copy, d.database)
            self.assert_stops(d, "older than the store", "hairbaked store accept", "lost+found")
            self.assert_stops(d, "older than the store")  # a refused start does not make the next one succeed
            d.accept()
            (d.path / "log").write_text("")
            d.start()
            self.assertEqual(d.lost_and_found(), {sha256(data): data for data in late})
            self.assertIn(f"moved 3 files of {sum(map(len, late))} bytes to {d.store}/lost+found/", d.log)
            self.assertNotIn("removed", d.log.replace("Nothing was changed or removed", ""))
            d.data = known
            self.assert_serves_all(d)
            d.stop()
            d.start()  # lost+found itself stays
            self.assertEqual(len(d.lost_and_found()), 3)

    def test_a_copy_made_while_the_daemon_ran_is_older_after_its_stop(self):
        with Store() as d:
            d.start()
            copy = d.path / "copy"
            with contextlib.closing(sqlite3.connect(d.database)) as source, contextlib.closing(sqlite3.connect(copy)) as to:
                source.backup(to)
            data = os.urandom(700)
            digest = d.put(data)
            d.stop()
            shutil.copy(copy, d.database)
            self.assert_stops(d, "older than the store")
            self.assertEqual(d.blob_file(digest).read_bytes(), data)

    def test_a_copy_that_is_too_young_to_be_told_moves_unknown_files_and_removes_none(self):
        """A copy of the running generation, put back after a kill: blobs and uploads go to lost+found."""
        with Store() as d:
            d.start()
            copy = d.path / "copy"
            with contextlib.closing(sqlite3.connect(d.database)) as source, contextlib.closing(sqlite3.connect(copy)) as to:
                source.backup(to)
            late = os.urandom(700)
            d.put(late)
            upload, empty = (d.create_upload(b"a late upload").headers["Location"].rsplit("/", 1)[1] for _ in range(2))
            self.assertEqual(d.append(f"/v1/uploads/{upload}", 0, b"a late").status, 204)
            d.kill()
            for end in ("-wal", "-shm"):
                Path(f"{d.database}{end}").unlink()
            shutil.copy(copy, d.database)
            d.start()
            self.assertEqual(d.lost_and_found(), {sha256(late): late, upload: b"a late"})
            self.assertFalse((d.store / "uploads" / empty).exists())
            self.assertIn("removed 1 files of 0 bytes: empty uploads that the database does not know", d.log)
            self.assert_serves_all(d)

    def test_the_database_of_another_store_stops_the_start_of_both(self):
        with Store() as one, Store() as other:
            kept = one.path / "aside"
            one.database.rename(kept)
            other.database.rename(one.database)
            kept.rename(other.database)
            for d in (one, other):
                self.assert_stops(d, one.id, other.id, "folder of its own store")

    def test_a_database_of_the_version_without_id_is_older_than_a_store_with_one(self):
        with Store() as d:
            d.sql("PRAGMA user_version = 5")
            before = d.database.read_bytes()
            self.assert_stops(d, "older than the store", "version 5")
            self.assertEqual(d.database.read_bytes(), before)

    def test_the_database_of_another_program_stops_the_start_and_is_not_changed(self):
        with Store() as d:
            d.database.unlink()
            d.sql("CREATE TABLE somebody(x)")
            before = d.database.read_bytes()
            self.assertIn("another program", d.refused())
            self.assertEqual((d.database.read_bytes(), files_below(d.store)), (before, d.files))

    def test_a_crash_between_database_and_file_is_told_from_an_old_folder(self):
        for ahead, starts in ((0, True), (1, True), (2, False)):
            with self.subTest(ahead=ahead), Store() as d:
                d.sql(f"UPDATE store SET generation = {d.generation + ahead}")
                if starts:
                    d.start()
                    self.assert_serves_all(d)
                else:
                    self.assert_stops(d, "older than its database", "Put the newer folder back")

    def test_a_folder_without_its_id_stops_the_start(self):
        with Store() as d:
            for spoil in (lambda mark: mark.unlink(), lambda mark: mark.write_text("id\n")):
                spoil(d.store / "store-id")
                self.assert_stops(d, "store-id", "hairbaked store accept")
                d.accept()
                d.start()
                self.assert_serves_all(d)
                d.stop()


    def test_the_advice_for_a_broken_database_loses_nothing(self):
        with Store() as d:
            copy = d.path / "copy"
            shutil.copy(d.database, copy)
            late = os.urandom(900)
            d.add(late)
            d.database.write_bytes(b"broken" * 1000)
            log = d.refused()
            self.assertIn("restore a copy and run `hairbaked store accept --config FILE`", log)
            self.assertEqual({name: data for name, data in files_below(d.store).items() if name in d.files}, d.files)
            d.database.rename(d.path / "broken")
            shutil.copy(copy, d.database)
            d.accept()
            d.start()
            self.assertEqual(d.lost_and_found(), {sha256(late): late})
            del d.data[sha256(late)]
            self.assert_serves_all(d)

    def test_a_deleted_database_can_be_saved_while_the_daemon_runs(self):
        """The commands of docs/deployment.md."""
        with Store() as d:
            d.start()
            data = os.urandom(700)
            d.data[d.put(data)] = data
            for end in ("", "-wal", "-shm"):
                Path(f"{d.database}{end}").unlink()
            self.assertEqual(d.ask("GET", "/readyz").status, 503)
            opened = {os.readlink(file): file for file in Path(f"/proc/{d.process.pid}/fd").iterdir()}
            for end in ("", "-wal"):
                shutil.copy(opened[f"{d.database}{end} (deleted)"], d.path / f"saved{end}")
            self.assertEqual(d.stop()[0], 0)
            for end in ("", "-wal"):
                (d.path / f"saved{end}").rename(f"{d.database}{end}")
            d.start()
            self.assert_serves_all(d)

    def test_a_first_start_that_is_killed_can_be_repeated(self):
        """Relative: a folder that holds a part of a new store is no folder of somebody else."""
        rng = random.Random(7)
        with Daemon() as d:
            d.stop()
            for _ in range(20):
                shutil.rmtree(d.path / "store")
                process = d.spawn()
                time.sleep(rng.uniform(0, 0.15))
                process.kill()
                process.wait()
                process.stdout.close()
                d.start()
                self.assertEqual(d.ask("GET", f"/v1/blobs/{d.put(b'data')}").body, b"data")
                d.stop()


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


class OtherFolder(StoreTest):
    """Fault: the daemon emptied a folder that it was given by mistake."""

    def test_a_folder_of_somebody_else_stops_the_start_and_keeps_every_file(self):
        for entry in ("notes.txt", "tmp/session", "tmp/" + 32 * "a", "blobs/photo.jpg", "uploads/letter", "src/main.c"):
            with self.subTest(entry), Daemon() as d:
                d.stop()
                store = d.path / "elsewhere"
                (store / entry).parent.mkdir(parents=True)
                (store / entry).write_text("mine")
                d.write_config = lambda d=d: (d.path / "hairbake.toml").write_text(
                    '[listen]\nport = 0\n[store]\nfolder = "elsewhere"\n')
                self.assertEqual(end_of(d.spawn()), 3)
                self.assertIn("Nothing was changed or removed", (d.path / "log").read_text())
                self.assertEqual([p.relative_to(store).as_posix() for p in store.rglob("*") if p.is_file()], [entry])

    def test_a_new_file_system_is_an_empty_folder(self):
        with Daemon() as d:
            d.stop()
            shutil.rmtree(d.path / "store")
            (d.path / "store/lost+found").mkdir(parents=True)
            (d.path / "store/lost+found").chmod(0)
            d.start()
            self.assertEqual(d.ask("GET", "/readyz").status, 200)

    def test_files_of_others_in_tmp_of_a_store_stay(self):
        with Store() as d:
            (d.store / "tmp/session").write_text("mine")
            (d.store / "tmp" / (32 * "a")).mkdir()
            (d.store / "tmp" / (32 * "a") / "words.jsonl").write_text("a work folder of a daemon that was killed")
            d.start()
            self.assertEqual(d.leftovers(), ["session"])
            self.assertIn("removed 1 files of 41 bytes: bodies and results", d.log)

    def test_a_disk_that_is_not_mounted_stops_the_start(self):
        with Store() as d:
            d.config = f'id = "{(store_id := d.id)}"'
            d.start()
            d.stop()
            d.store.rename(d.path / "the disk")
            d.store.mkdir()  # the mount point
            self.assert_stops(d, "Is its disk mounted?", store_id)
            shutil.rmtree(d.store)
            (d.path / "the disk").rename(d.store)
            d.start()
            self.assert_serves_all(d)

    def test_blobs_that_are_all_missing_stop_the_start(self):
        """As when the folder blobs is the mount point of a disk that is not mounted; the disk of another store is no better."""
        with Store() as d:
            (d.store / "blobs").rename(d.path / "aside")
            for other in (None, "ab/" + 64 * "a"):
                (d.store / "blobs").mkdir(exist_ok=True)
                if other:
                    (d.store / "blobs/ab" / (64 * "a")).write_text("of another store")
                self.assert_stops(d, "holds none of the", "Is its disk mounted?")
            shutil.rmtree(d.store / "blobs")
            (d.path / "aside").rename(d.store / "blobs")
            d.start()
            self.assert_serves_all(d)
            d.stop()
            # Whoever has lost them for good says so.
            shutil.rmtree(d.store / "blobs")
            d.accept()
            d.start()
            self.assertEqual(d.ask("HEAD", f"/v1/blobs/{d.hair}").status, 404)
            d.put(d.data[d.hair])
            d.ask("POST", "/v1/bakes", quick_request(d.hair))
            self.assertEqual(d.wait(d.bake)["state"], "done")

    def test_another_id_in_the_settings_stops_the_start(self):
        with Store() as d:
            d.config = f'id = "{32 * "0"}"'
            self.assert_stops(d, d.id, 32 * "0", "Does [store] folder name the right folder, and is its disk mounted?",
                              f"To serve this store, set id to {d.id} or remove it")
            d.config = f'id = "{d.id}"'
            d.start()
            self.assert_serves_all(d)

    def test_inputs_that_are_missing_are_named(self):
        """Fault: a start that found all blobs but one missing said how many. Relatives: bytes of another size, and bytes
        that are found missing while the daemon runs."""
        with Store() as d:
            d.start()
            sky, mesh = hdr_bytes(), b"a mesh"
            named = {"model": (d.hair, "hero/hair"), "environment": (d.put(sky), "dusk"), "mesh": (d.put(mesh), "head")}
            for kind, (digest, name) in named.items():
                for path in ("an/older/name", name):
                    self.assertEqual(d.ask("PUT", f"/v1/names/{kind}/{path}", {"sha256": digest}).status, 200)
            unnamed = d.put(hair_bytes(seed=7))
            self.assertEqual(d.ask("POST", "/v1/models", {"sha256": unnamed}).status, 201)
            result = d.ask("GET", f"/v1/bakes/{d.bake}").json["files"][1]["sha256"]
            d.stop()
            kept = next(digest for digest in d.data if digest != d.hair)
            for digest in [f.name for f in (d.store / "blobs").rglob("*") if f.is_file() and f.name != kept]:
                if digest == unnamed:
                    d.blob_file(digest).write_bytes(b"cut")
                else:
                    d.blob_file(digest).unlink()
            (d.path / "log").write_text("")
            d.start()
            lost = [digest for digest in (*d.data, *(digest for digest, _ in named.values()), unnamed) if digest != kept]
            d.wait_for_log(f"{len(set(lost))} inputs are missing or spoiled. They are forgotten and must be sent again:")
            for kind, (digest, name) in named.items():
                self.assertIn(f"send the {kind} {name}@1 (sha256:{digest}) again", d.log)
            self.assertIn(f"send the model sha256:{unnamed} again", d.log)
            for digest in set(d.data) - {d.hair, kept}:
                self.assertIn(f"send the file sha256:{digest} again", d.log)
            for digest in (kept, result):
                self.assertNotIn(digest, d.log)
            self.assertRegex(d.log, "[0-9]+ stored results are missing or spoiled")
            self.assertEqual(d.ask("GET", f"/v1/blobs/{kept}").body, d.data[kept])
            self.assertEqual(d.put(mesh), named["mesh"][0])
            d.blob_file(named["mesh"][0]).unlink()
            reply = d.ask("GET", f"/v1/blobs/{named['mesh'][0]}")
            self.assertEqual(reply.status, 404)
            self.assertIn(f"send the mesh head@1 (sha256:{named['mesh'][0]}) again", reply.json["detail"])
            d.wait_for_log(reply.json["detail"])

    def test_a_database_that_is_refused_gets_no_log_beside_it(self):
        """Fault: reading a database left an empty -wal and a -shm beside it. Relatives: each reason that is found by reading."""
        def of_another_program(d):
            d.database.unlink()
            d.sql("PRAGMA journal_mode = WAL")
            d.sql("CREATE TABLE notes(text)")

        def newer(d):
            d.sql("PRAGMA user_version = 1000")

        def without_row(d):
            d.sql("DELETE FROM store")

        def of_another_store(d):
            d.sql("UPDATE store SET id = '" + 32 * "0" + "'")

        def older(d):
            d.sql("UPDATE store SET generation = 1")

        def without_blobs(d):
            shutil.rmtree(d.store / "blobs")

        for spoil in (of_another_program, newer, without_row, of_another_store, older, without_blobs):
            with self.subTest(spoil.__name__), Store() as d:
                spoil(d)
                before = d.database.read_bytes()
                self.assertEqual(sorted(f.name for f in d.store.glob("hairbake.db*")), ["hairbake.db"])
                for _ in range(2):
                    d.refused()
                    self.assertEqual(sorted(f.name for f in d.store.glob("hairbake.db*")), ["hairbake.db"])
                    self.assertEqual(d.database.read_bytes(), before)

    def test_a_refused_database_keeps_the_log_that_it_had(self):
        with Store() as d:
            connection = sqlite3.connect(d.database)
            connection.execute("PRAGMA user_version = 1000")
            connection.commit()
            shutil.copytree(d.store, d.path / "copy")  # with the log, which closing would write into the database
            connection.close()
            shutil.rmtree(d.store)
            (d.path / "copy").rename(d.store)
            before = {end: d.store.joinpath(f"hairbake.db{end}").read_bytes() for end in ("", "-wal")}
            self.assertGreater(len(before["-wal"]), 0)
            self.assertIn("1000", d.refused())
            self.assertEqual({end: d.store.joinpath(f"hairbake.db{end}").read_bytes() for end in before}, before)

    def test_a_part_on_another_device_stops_the_start(self):
        for part in ("blobs", "tmp", "uploads", "blobs/ab", "lost+found"):
            with self.subTest(part), Store() as d:
                (d.store / part).mkdir(exist_ok=True)
                d.before = ["unshare", "--map-root-user", "--mount", "sh", "-c", 'mount -t tmpfs none "$0" && exec "$@"',
                            d.store / part]
                self.assert_stops(d, f"{d.store / part} is on another device", "mount the whole folder")
                d.before = []
                d.start()
                self.assert_serves_all(d)

    def test_a_database_on_another_device_stops_the_start(self):
        with Store() as d, tempfile.TemporaryDirectory(dir="/dev/shm") as elsewhere:
            if os.stat(elsewhere).st_dev == os.stat(d.store).st_dev:
                self.skipTest("/dev/shm is on the device of the store")
            moved = Path(elsewhere) / "hairbake.db"
            shutil.move(d.database, moved)
            d.database.symlink_to(moved)
            self.assert_stops(d, f"{elsewhere} is on another device")

    def test_a_second_daemon_stops_although_the_lock_file_was_deleted(self):
        for deleted in (False, True):
            with self.subTest(deleted=deleted), Daemon() as d:
                if deleted:
                    (d.path / "store/lock").unlink()
                self.assertEqual(end_of(d.spawn()), 2)
                self.assertIn("another hairbaked works on the store", (d.path / "log").read_text())


if __name__ == "__main__":
    unittest.main()
