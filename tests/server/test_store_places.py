"""What is in the place of a file of the store: nothing, a folder, a pipe, a socket, a device, or a file that is closed."""
import os
import shutil
import socket
import stat
import unittest

from harness import TUS, Daemon, hair_bytes, hdr_bytes, quick_request
from stores import Store, StoreTest


def pipe(path):
    os.mkfifo(path)


def listening(path):
    """A socket. Its path may be longer than an address of a socket may be."""
    with socket.socket(socket.AF_UNIX) as s:
        folder = os.open(path.parent, os.O_PATH)
        s.bind(f"/proc/self/fd/{folder}/s")
        os.close(folder)
    (path.parent / "s").rename(path)


def device(path):
    os.mknod(path, 0o600 | stat.S_IFCHR, os.makedev(1, 5))  # /dev/zero: it never ends


def folder(path):
    path.mkdir()
    (path / "inside").write_bytes(b"somebody's")


def loop(path):
    path.symlink_to(path)


WORDS = {pipe: "a named pipe", listening: "a socket", folder: "a folder", loop: "a symbolic link", device: "a device"}
FOREIGN = {name: word for name, word in WORDS.items() if name is not device or os.geteuid() == 0}


class ForeignEntries(StoreTest):
    """Fault: a pipe in the place of a blob kept a thread for ever; a folder, a socket or a device gave a 500, and the blob
    could not be sent again."""

    def assert_moved(self, d, digest, word):
        d.wait_for_log(f"{word} was in the place of blob {digest}")
        self.assertTrue(any(os.path.lexists(path) for path in (d.path / "store/lost+found").rglob(digest + "*")))

    def test_a_blob_is_lost_and_can_be_sent_again(self):
        """Relatives: GET, HEAD, a model's POST, and sending the file again without asking for it first."""
        for spoil, word in FOREIGN.items():
            with Daemon() as d:
                for ask in ("GET", "model", "PUT"):
                    with self.subTest(word, ask=ask):
                        data = hair_bytes(seed=len(ask))
                        digest = d.put(data)
                        d.blob_file(digest).unlink()
                        spoil(d.blob_file(digest))
                        if ask == "GET":
                            reply = d.ask("GET", f"/v1/blobs/{digest}")
                            self.assertEqual(reply.status, 404, reply.body)
                            self.assertIn(f"send the file sha256:{digest} again", reply.json["detail"])
                            d.wait_for_log(f"the stored bytes of sha256:{digest} were lost or spoiled")
                        elif ask == "model":
                            reply = d.ask("POST", "/v1/models", {"sha256": digest})
                            self.assertEqual(reply.status, 422, reply.body)
                        self.assertEqual(d.put(data), digest)
                        self.assert_moved(d, digest, word)
                        self.assertEqual(d.ask("GET", f"/v1/blobs/{digest}").body, data)

    def test_a_result_is_baked_again_and_a_bake_tells_its_lost_input(self):
        for spoil, word in FOREIGN.items():
            with self.subTest(word), Daemon() as d:
                hair, sky = d.put(hair_bytes()), d.put(hdr_bytes())
                bake = d.ask("POST", "/v1/bakes", quick_request(hair)).json["id"]
                file = next(f for f in d.wait(bake)["files"] if f["name"] == "transmittance.npy")
                right = d.ask("GET", file["href"]).body
                d.blob_file(file["sha256"]).unlink()
                spoil(d.blob_file(file["sha256"]))
                self.assertEqual(d.ask("GET", file["href"]).status, 503)
                self.assertEqual(d.wait(bake)["state"], "done")
                self.assertEqual(d.ask("GET", file["href"]).body, right)
                self.assert_moved(d, file["sha256"], word)
                d.blob_file(sky).unlink()
                spoil(d.blob_file(sky))
                view = d.wait(d.ask("POST", "/v1/bakes", quick_request(environment=sky)).json["id"])
                self.assertEqual((view["state"], view["error"]["kind"]), ("failed", "bad_input"), view)
                self.assertIn(f"send the file sha256:{sky} again", view["error"]["message"])
                self.assertEqual(d.leftovers(), [])

    def test_relative_the_scrub_and_a_deletion(self):
        with Daemon(config="scrub_s = 1") as d:
            digests = {word: d.put(os.urandom(1000)) for word in FOREIGN.values()}
            for spoil, word in FOREIGN.items():
                d.blob_file(digests[word]).unlink()
                spoil(d.blob_file(digests[word]))
            for word, digest in digests.items():
                self.assert_moved(d, digest, word)
                self.assertEqual(d.ask("HEAD", f"/v1/blobs/{digest}").status, 404)
        with Daemon() as d:
            digest = d.put(b"to be deleted")
            d.blob_file(digest).unlink()
            folder(d.blob_file(digest))
            self.assertEqual(d.ask("DELETE", f"/v1/blobs/{digest}").status, 204)
            self.assertFalse(d.blob_file(digest).exists())
            self.assertEqual([f.read_bytes() for f in (d.path / "store/lost+found").rglob("inside")], [b"somebody's"])

    def test_relative_a_start_moves_them_away(self):
        """Also in the place of an empty file, and in that of an upload."""
        for spoil, word in FOREIGN.items():
            with self.subTest(word), Store() as d:
                d.start()
                empty = d.put(b"")
                upload = d.create_upload(b"an upload").headers["Location"]
                d.stop()
                for path in (d.blob_file(d.hair), d.blob_file(empty), d.store / "uploads" / upload.split("/")[-1]):
                    path.unlink()
                    spoil(path)
                d.start()
                for digest in (d.hair, empty):
                    self.assertEqual(d.ask("HEAD", f"/v1/blobs/{digest}").status, 404)
                d.put(b"")
                d.put(d.data[d.hair])
                self.assertEqual(d.ask("HEAD", upload, headers=TUS).status, 404)
                self.assert_serves_all(d)

    def test_relative_an_upload_whose_file_is_gone_or_no_file(self):
        """A HEAD told the offset 0, a PATCH waited for the reader of a pipe for ever."""
        def gone(path):
            pass

        for spoil in (gone, *FOREIGN):
            with self.subTest(spoil.__name__), Daemon() as d:
                upload = d.create_upload(b"an upload").headers["Location"]
                self.assertEqual(d.append(upload, 0, b"an up").status, 204)
                file = d.path / "store/uploads" / upload.split("/")[-1]
                file.unlink()
                spoil(file)
                for reply in (d.ask("HEAD", upload, headers=TUS), d.append(upload, 5, b"load")):
                    self.assertEqual(reply.status, 404, reply.body)
                self.assertIn("begin a new upload", d.append(upload, 5, b"load").json["detail"])
                self.assertEqual(d.ask("DELETE", upload, headers=TUS).status, 204)
                self.assertEqual(list((d.path / "store/uploads").iterdir()), [])

    def test_relative_the_id_of_a_store_that_is_no_file_stops_the_start(self):
        with Store() as d:
            kept = (d.store / "store-id").read_bytes()
            for spoil, word in FOREIGN.items():
                (d.store / "store-id").unlink()
                spoil(d.store / "store-id")
                if spoil is not loop:  # that one cannot be looked at
                    self.assert_stops(d, f"{d.store / 'store-id'} is {word}; allowed is a file")
                else:
                    d.refused()
                path = d.store / "store-id"
                shutil.rmtree(path) if path.is_dir() else path.unlink()
                (d.store / "store-id").write_bytes(kept)
            d.start()
            self.assert_serves_all(d)


class LinkedUploads(StoreTest):
    """Fault: an upload that the database does not know was removed because its file had a second link, with the reason that
    its bytes were a blob."""

    def test_a_second_link_that_is_no_blob_is_no_reason_to_remove(self):
        with Store() as d:
            blob = d.blob_file(d.hair)
            uploads = d.store / "uploads"
            os.link(blob, uploads / ("a" * 32))  # as a crash leaves it
            (d.path / "of somebody").write_bytes(b"linked elsewhere")
            os.link(d.path / "of somebody", uploads / ("b" * 32))
            shutil.copy(blob, uploads / ("c" * 32))  # the bytes of a blob, and linked elsewhere
            os.link(uploads / ("c" * 32), d.path / "copy")
            (uploads / ("d" * 32)).write_bytes(b"")
            (d.path / "log").write_text("")
            d.start()
            self.assertEqual(sorted(f.name for f in uploads.iterdir()), [d.upload.split("/")[-1]])
            self.assertEqual(d.lost_and_found(), {"b" * 32: b"linked elsewhere", "c" * 32: d.data[d.hair]})
            size = len(d.data[d.hair])
            for line in (f"removed 1 files of {size} bytes: uploads that had become blobs, which keep the bytes",
                         "removed 1 files of 0 bytes: empty uploads that the database does not know",
                         f"moved 2 files of {size + 16} bytes"):
                d.wait_for_log(line)
            self.assert_serves_all(d)


if __name__ == "__main__":
    unittest.main()
