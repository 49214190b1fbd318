"""The HTTP server: routes, framing, ranges, access, uploads."""
import email.utils
import json
import re
import shutil
import socket
import subprocess
import tempfile
import time
import unittest
from pathlib import Path

from harness import PATIENCE, PROGRAMS, TUS, Daemon, hair_bytes, quick_request, sha256


def status_of(answer):
    """Of a raw reply; None when the connection was closed without one."""
    match = re.match(rb"HTTP/1\.1 (\d{3}) ", answer)
    return int(match.group(1)) if match else None


class Page(unittest.TestCase):
    """The web page: files that are read when the daemon starts."""

    def test_the_page_is_served_from_what_was_there_at_the_start(self):
        with tempfile.TemporaryDirectory() as folder:
            web = Path(folder) / "web"
            (web / "app").mkdir(parents=True)
            (web / "index.html").write_text('<script type="module" src="{assets}/app/main.js"></script>')
            (web / "app/main.js").write_text("export {};")
            (web / "secret.txt").write_text("not of a page's kinds")
            with Daemon(config=f'[web]\nfolder = "{web}"') as d:
                (web / "app/late.js").write_text("export {};")  # written after the start
                index = d.ask("GET", "/")
                self.assertEqual((index.status, index.headers["Content-Type"]), (200, "text/html; charset=utf-8"))
                self.assertEqual(index.headers["Cache-Control"], "no-cache")
                policy = index.headers["Content-Security-Policy"]
                self.assertTrue(policy.startswith("default-src 'none'; script-src 'self'; style-src 'self';"), policy)
                self.assertNotIn("unsafe", policy)
                self.assertIn("frame-ancestors 'none'", policy)
                self.assertEqual(index.headers["X-Content-Type-Options"], "nosniff")
                self.assertEqual(index.headers["Referrer-Policy"], "no-referrer")
                again = d.ask("GET", "/", headers={"If-None-Match": index.headers["ETag"]})
                self.assertEqual(again.status, 304)
                address = re.search(r'src="(/assets/[0-9a-f]{16}/app/main\.js)"', index.body.decode()).group(1)
                script = d.ask("GET", address)
                self.assertEqual((script.status, script.body), (200, b"export {};"))
                self.assertEqual(script.headers["Content-Type"], "text/javascript; charset=utf-8")
                self.assertEqual(script.headers["Cache-Control"], "public, max-age=31536000, immutable")
                base = address.rsplit("/app", 1)[0]
                for path in (base + "/app/late.js", base + "/secret.txt", base + "/index.html", base + "/app", base,
                             "/assets/0123456789abcdef/app/main.js", base + "/..%2findex.html", "/app/main.js"):
                    self.assertIn(d.ask("GET", path).status, (400, 404), path)

    def test_without_a_folder_there_is_no_page_and_a_wrong_one_is_refused(self):
        with Daemon(config='[web]\nfolder = ""') as d:
            self.assertEqual((d.ask("GET", "/").status, d.ask("GET", "/assets/x/y.js").status), (404, 404))
            self.assertEqual(d.ask("GET", "/healthz").status, 200)
            d.stop()
            d.config = '[web]\nfolder = "nowhere"'
            with self.assertRaisesRegex(AssertionError, "web.folder"):
                d.start()
            d.process.stdout.close()


class HttpServer(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.daemon = Daemon().__enter__()

    @classmethod
    def tearDownClass(cls):
        cls.daemon.__exit__()

    def test_the_route_table_and_the_document_say_the_same(self):
        document = self.daemon.ask("GET", "/openapi.json").json
        table = subprocess.run([PROGRAMS / "hairbaked", "routes"], check=True, capture_output=True, text=True).stdout
        described, found = {}, {}
        for line in table.splitlines():
            method, pattern, scope, limit, *types = line.split()
            found[method, pattern.replace("...}", "}")] = scope, int(limit) > 0, set(types)
        for pattern, operations in document["paths"].items():
            for method, operation in operations.items():
                scope = re.search(r"Scope: ([a-z]+)\.", operation["description"]).group(1)
                self.assertEqual(bool(operation["security"]), scope != "open", (method, pattern))
                self.assertIn("503", operation["responses"], (method, pattern))  # all threads may be busy
                for status, answer in operation["responses"].items():
                    if status >= "400":
                        self.assertIn("application/problem+json", answer["content"], (method, pattern, status))
                content = operation.get("requestBody", {}).get("content", {})
                types = set() if pattern == "/v1/blobs/{sha256}" else set(content)  # a file may be sent as any type
                described[method.upper(), pattern] = scope, bool(content), types
                if content:
                    self.assertLessEqual({"400", "411", "413"} | ({"415"} if types else set()), set(operation["responses"]), pattern)
        self.assertEqual(described, found)

    def test_lists_and_names_answer_what_the_document_says(self):
        d = self.daemon
        hair = d.put(hair_bytes())
        d.ask("POST", "/v1/models", {"sha256": hair})
        d.ask("PUT", "/v1/names/model/hero", {"sha256": hair, "note": "first"})
        d.wait(d.ask("POST", "/v1/bakes", quick_request(hair)).json["id"])
        schemas = d.ask("GET", "/openapi.json").json["components"]["schemas"]

        def parts_of(name):
            """Required and all fields of a schema, those that it takes over too."""
            schema = schemas[name]
            required, fields = set(schema.get("required", [])), dict(schema.get("properties", {}))
            for part in schema.get("allOf", []):
                more = parts_of(part["$ref"].rpartition("/")[2]) if "$ref" in part else (set(part["required"]), part["properties"])
                required |= more[0]
                fields.update(more[1])
            return required, fields

        def check(value, name):
            required, fields = parts_of(name)
            self.assertLessEqual(required, set(value), name)
            self.assertLessEqual(set(value), set(fields), name)
            for field, schema in fields.items():
                item = schema.get("items", {}).get("$ref", "").rpartition("/")[2]
                if item:
                    self.assertTrue(value[field], name)  # at least one, so that something was checked
                    for entry in value[field]:
                        check(entry, item)

        for path, name in (("/v1/bakes", "BakePage"), ("/v1/blobs", "BlobPage"), ("/v1/models", "ModelPage"), ("/v1/names/model", "NamePage"),
                           ("/v1/names/model/hero", "Name")):
            check(d.ask("GET", path).json, name)
        check(d.ask("GET", d.ask("GET", "/v1/bakes").json["bakes"][0]["links"]["self"]).json, "Bake")

    def test_every_route_has_rule_limit_and_problem(self):
        d = self.daemon
        document = d.ask("GET", "/openapi.json").json
        self.assertIn("transmittance", document["components"]["schemas"]["BakeRequest"]["properties"])
        for pattern, operations in document["paths"].items():
            path = pattern.replace("{sha256}", "0" * 64).replace("{kind}", "model").replace("{path}", "x").replace(
                "{id}", "x").replace("{name}", "x")
            methods = {m.upper() for m in operations} | ({"HEAD"} if "get" in operations else set()) | {"OPTIONS"}
            wrong = next(m for m in ("DELETE", "PATCH", "PUT", "POST") if m not in methods and not (
                m == "PUT" and "/names/" in path))
            reply = d.ask(wrong, path)
            self.assertEqual((reply.status, reply.headers["Content-Type"]), (405, "application/problem+json"), pattern)
            self.assertEqual(set(reply.headers["Allow"].split(", ")) - {"HEAD"}, methods - {"HEAD"}, pattern)
            for method, operation in operations.items():
                if method == "options":
                    continue
                takes_body = "requestBody" in operation
                # The rule: a page of another site may not ask, except what is open to all.
                reply = d.ask(method.upper(), path, headers={"Host": "evil.example"})
                if operation["security"]:
                    self.assertEqual((reply.status, reply.json["type"] if method != "head" else ""),
                                     (403, "urn:hairbake:problem:no-tokens" if method != "head" else ""), (method, pattern))
                # The limit: more than it is refused before a byte is read.
                if method in ("post", "put", "patch"):
                    head = (f"{method.upper()} {path} HTTP/1.1\r\nHost: localhost\r\nContent-Type: application/json\r\n"
                            f"Content-Length: 99999999999999\r\nTus-Resumable: 1.0.0\r\n\r\n").encode()
                    self.assertEqual(status_of(d.raw(head)), 413, (method, pattern))
                    head = head.replace(b"Content-Length: 99999999999999\r\n", b"")
                    if takes_body:  # neither length nor chunks
                        self.assertEqual(status_of(d.raw(head)), 411, (method, pattern))
                    if takes_body and "/blobs/" not in path:
                        reply = d.ask(method.upper(), path, b"x", {"Content-Type": "text/plain", "Tus-Resumable": "1.0.0"})
                        self.assertEqual((reply.status, reply.json["field"]), (415, "Content-Type"), (method, pattern))
                self.assertTrue(takes_body or method not in ("put", "patch"))

    def test_what_is_not_there_is_a_problem(self):
        for path in ("/v1", "/v1/bakes/" + "0" * 64, "/v2/bakes", "/v1/blobs/" + "0" * 64, "/v1/batches/x", "/etc/passwd"):
            reply = self.daemon.ask("GET", path)
            self.assertEqual((reply.status, reply.headers["Content-Type"]), (404, "application/problem+json"), path)
            self.assertEqual(reply.json["type"], "urn:hairbake:problem:not-found")

    def test_a_connection_carries_one_request(self):
        one = b"GET /healthz HTTP/1.1\r\nHost: localhost\r\n\r\n"
        answer = self.daemon.raw(one + one)  # pipelined
        self.assertEqual(answer.count(b"HTTP/1.1 200"), 1)
        self.assertIn(b"Connection: close", answer)

    def test_a_cut_upload_stores_nothing(self):
        data = b"x" * 100_000
        digest = sha256(data)
        with socket.create_connection(("127.0.0.1", self.daemon.port)) as s:
            s.sendall(f"PUT /v1/blobs/{digest} HTTP/1.1\r\nHost: localhost\r\nContent-Length: {len(data)}\r\n\r\n".encode()
                      + data[:50_000])
            s.shutdown(socket.SHUT_WR)
            self.assertIn(status_of(s.recv(1000)), (400, None))
        self.assertEqual(self.daemon.ask("HEAD", f"/v1/blobs/{digest}").status, 404)

    def test_a_chunked_body_is_taken_and_its_digest_checked(self):
        data = b"chunked body"
        head = "PUT /v1/blobs/{} HTTP/1.1\r\nHost: localhost\r\nTransfer-Encoding: chunked\r\nExpect: 100-continue\r\n\r\n"
        body = b"c\r\n" + data + b"\r\n0\r\n\r\n"
        answer = self.daemon.raw(head.format(sha256(data)).encode(), body, pause=0.2)
        self.assertTrue(answer.startswith(b"HTTP/1.1 100 Continue\r\n\r\nHTTP/1.1 201"), answer)
        answer = self.daemon.raw(head.format(sha256(b"other")).encode() + body)
        self.assertIn(b" 422 ", answer)
        self.assertEqual(self.daemon.ask("GET", f"/v1/blobs/{sha256(data)}").body, data)
        self.assertEqual(self.daemon.ask("HEAD", f"/v1/blobs/{sha256(b'other')}").status, 404)

    def test_ranges(self):
        data = bytes(range(200)) * 10
        digest = self.daemon.put(data)
        tag = f'"{digest}"'

        def get(**headers):
            return self.daemon.ask("GET", f"/v1/blobs/{digest}", headers={k.replace("_", "-"): v for k, v in headers.items()})

        whole = get()
        self.assertEqual((whole.status, whole.body, whole.headers["ETag"]), (200, data, tag))
        for text, first, end in (("0-0", 0, 1), ("5-9", 5, 10), ("1990-", 1990, 2000), ("-3", 1997, 2000), ("0-99999", 0, 2000),
                                 ("-99999", 0, 2000)):
            part = get(Range=f"bytes={text}")
            self.assertEqual((part.status, part.body), (206, data[first:end]), text)
            self.assertEqual(part.headers["Content-Range"], f"bytes {first}-{end - 1}/2000")
        for text in ("2000-", "2000-2001", "-0"):
            wrong = get(Range=f"bytes={text}")
            self.assertEqual((wrong.status, wrong.headers["Content-Range"]), (416, "bytes */2000"), text)
        self.assertEqual(get(Range="bytes=0-1,5-6").body, data)  # several ranges: the whole file
        self.assertEqual(get(Range="bytes=0-1", If_Range=tag).status, 206)
        self.assertEqual(get(Range="bytes=0-1", If_Range='"other"').body, data)
        self.assertEqual(get(If_None_Match=f'W/"x", {tag}').status, 304)
        head = self.daemon.ask("HEAD", f"/v1/blobs/{digest}")
        self.assertEqual((head.status, head.headers["Content-Length"], head.body), (200, "2000", b""))

    def test_pages_of_other_sites_are_refused(self):
        self.assertEqual(self.daemon.ask("GET", "/v1/bakes", headers={"Host": "rebound.example:80"}).status, 403)
        self.assertEqual(self.daemon.ask("GET", "/v1/bakes", headers={"Origin": "https://evil.example"}).status, 403)
        own = f"localhost:{self.daemon.port}"
        self.assertEqual(self.daemon.ask("GET", "/v1/bakes", headers={"Host": own, "Origin": f"http://{own}"}).status, 200)

    def test_metrics_count(self):
        text = self.daemon.ask("GET", "/metrics").body.decode()
        self.assertRegex(text, r'hairbake_http_requests_total\{method="[A-Z]+",status="\d+"\} \d')
        self.assertRegex(text, r'hairbake_bakes\{state="queued"\} 0')


class Process(unittest.TestCase):
    """The daemon as a program among others."""

    def test_it_is_ready_while_the_worker_program_is_there(self):
        with Daemon(config="budget_mb = 1\nkeep_free_mb = 0") as d:
            d.stop()
            program = d.path / "worker"
            shutil.copy(PROGRAMS / "hairbake-worker", program)
            d.limits = f'program = "{program}"'
            d.start()
            ready = d.ask("GET", "/readyz")
            self.assertEqual((ready.status, ready.json), (200, {"status": "ready"}))  # no warnings
            program.rename(d.path / "aside")
            lacking = d.ask("GET", "/readyz")
            self.assertEqual((lacking.status, lacking.json["type"]), (503, "urn:hairbake:problem:not-ready"))
            self.assertIn("worker program", lacking.json["detail"])
            self.assertIsNotNone(lacking.headers["Retry-After"])
            self.assertEqual(d.ask("GET", "/healthz").status, 200)  # still alive
            (d.path / "aside").rename(program)
            self.assertEqual(d.ask("GET", "/readyz").status, 200)

    def test_every_line_of_the_log_is_json(self):
        with Daemon(max_crashes=0) as d:
            hair = d.put(hair_bytes())
            d.wait(d.ask("POST", "/v1/bakes", quick_request(hair)).json["id"])
            broken = d.put(hair_bytes()[:200])
            d.wait(d.ask("POST", "/v1/bakes", quick_request(broken)).json["id"])
            d.stop()
            d.blob_file(hair).write_bytes(hair_bytes(seed=1))  # of the same length
            d.blob_file(broken).unlink()
            d.start()
            self.assertEqual(d.ask("GET", f"/v1/blobs/{hair}").status, 404)
            d.stop()
            lines = [json.loads(line) for line in (d.path / "log").read_text().splitlines()]
            self.assertLessEqual({"info", "warning", "error"}, {line["level"] for line in lines})  # a bake, a loss, rotten bytes
            for line in lines:
                self.assertEqual(set(line), {"time", "level", "thread", "message"})
                self.assertRegex(line["time"], r"^\d{4}-\d\d-\d\dT\d\d:\d\d:\d\d\.\d{3}[+-]\d\d:\d\d$")

    def test_one_port_has_one_daemon(self):
        with Daemon() as d, Daemon() as other:
            other.stop()
            other.listen = f"port = {d.port}"
            second = other.spawn()
            self.assertEqual(second.wait(PATIENCE), 2)
            second.stdout.close()
            self.assertIn(f"cannot listen on 127.0.0.1 port {d.port}", (other.path / "log").read_text())
            self.assertEqual(d.ask("GET", "/healthz").status, 200)

    def test_it_links_none_of_the_libraries_that_bake(self):
        def needed(program):
            return subprocess.run(["ldd", PROGRAMS / program], check=True, capture_output=True, text=True).stdout.lower()

        for library in ("openvdb", "embree", "openimageio", "tbb"):
            self.assertNotIn(library, needed("hairbaked"))
            self.assertIn(library, needed("hairbake-worker"))  # else the check above means nothing


class Tokens(unittest.TestCase):
    def test_a_new_token_is_taken_with_the_lines_that_are_printed(self):
        printed = subprocess.run([PROGRAMS / "hairbaked", "token", "new"], check=True, capture_output=True, text=True).stdout
        first, lines = printed.split("\n\n", 1)
        token = first.split(": ")[1]
        # 32 random bytes are 42 letters of 6 bits and one of the last 4.
        self.assertRegex(token, r"^[A-Za-z0-9_-]{43}$")
        self.assertIn(f'sha256 = "{sha256(token.encode())}"', lines)
        again = subprocess.run([PROGRAMS / "hairbaked", "token", "new"], check=True, capture_output=True, text=True).stdout
        self.assertNotIn(token, again)
        with Daemon(tokens=lines.replace('name = "unnamed"', 'name = "farm"')) as d:
            blob = f"/v1/blobs/{sha256(b'x')}"
            self.assertEqual(d.ask("PUT", blob, b"x", {"Authorization": f"Bearer {token}"}).status, 201)
            self.assertEqual(d.ask("GET", blob, headers={"Authorization": f"Bearer {token}"}).status, 200)
            for wrong in (sha256(token.encode()), token[:-1], token.swapcase()):
                self.assertEqual(d.ask("GET", blob, headers={"Authorization": f"Bearer {wrong}"}).status, 401, wrong)

    def test_the_oldest_of_too_many_sessions_of_a_token_goes_and_other_tokens_keep_theirs(self):
        tokens = "".join(f'[[token]]\nname = "{name}"\nsha256 = "{sha256(name.encode())}"\nscopes = ["read"]\n'
                         for name in ("many", "one"))
        with Daemon(tokens=tokens) as d:
            def open_session(token):
                reply = d.ask("POST", "/v1/session", headers={"Authorization": f"Bearer {token}"})
                self.assertEqual(reply.status, 204, reply.body)
                return reply.headers["Set-Cookie"].split(";")[0]

            def status(cookie):
                return d.ask("GET", "/v1/bakes", headers={"Cookie": cookie}).status

            other = open_session("one")
            sessions = [open_session("many") for _ in range(1000)]  # as many as one token may have
            self.assertEqual(status(sessions[0]), 200)
            sessions.append(open_session("many"))
            self.assertEqual([status(cookie) for cookie in (sessions[0], sessions[1], sessions[-1], other)], [401, 200, 200, 200])
            self.assertEqual(status(open_session("one")), 200)

    def test_scopes_expiry_and_sessions(self):
        def token(name, text, scopes, more=""):
            return f'[[token]]\nname = "{name}"\nsha256 = "{sha256(text.encode())}"\nscopes = {json.dumps(scopes)}\n{more}\n'

        tokens = (token("reader", "r", ["read"]) + token("farm", "f", ["read", "upload", "bake"]) +
                  token("old", "o", ["admin"], "expires = 2020-01-01T00:00:00Z") + token("chief", "c", ["admin"]))
        with Daemon(tokens=tokens) as d:
            def ask(method, path, text=None, body=None, **headers):
                if text:
                    headers["Authorization"] = f"Bearer {text}"
                return d.ask(method, path, body, headers)

            self.assertEqual(ask("GET", "/v1/bakes").status, 401)
            self.assertEqual(ask("GET", "/v1/bakes", "wrong").headers["WWW-Authenticate"], 'Bearer realm="hairbake"')
            self.assertEqual(ask("GET", "/v1/bakes", "o").status, 401)
            self.assertEqual(ask("GET", "/v1/bakes", "r", Host="farm.example").status, 200)
            blob = f"/v1/blobs/{sha256(b'x')}"
            self.assertEqual([ask("PUT", blob, t, b"x").status for t in "rfc"], [403, 201, 200])
            self.assertEqual(ask("GET", "/healthz").status, 200)
            name = ask("PUT", "/v1/names/model/m", "f", json.dumps({"sha256": sha256(b"x")})).json
            self.assertEqual(name["token"], "farm")

            self.assertEqual(ask("POST", "/v1/session", "wrong").status, 401)
            cookie = ask("POST", "/v1/session", "r").headers["Set-Cookie"]
            self.assertIn("HttpOnly; SameSite=Strict", cookie)
            value = cookie.split(";")[0]
            self.assertEqual(ask("GET", "/v1/bakes", Cookie=f"a=b; {value}").status, 200)
            self.assertEqual(ask("PUT", blob, body=b"x", Cookie=value).status, 403)
            self.assertEqual(ask("GET", "/v1/bakes", Cookie=value, Origin="https://evil.example").status, 403)
            ask("DELETE", "/v1/session", Cookie=value)
            self.assertEqual(ask("GET", "/v1/bakes", Cookie=value).status, 401)


class Uploads(unittest.TestCase):
    def test_an_upload_goes_on_after_a_lost_connection_and_a_killed_daemon(self):
        data = hair_bytes(strands=500)
        with Daemon() as d:
            reply = d.create_upload(data)
            self.assertEqual(reply.status, 201, reply.body)
            path = reply.headers["Location"]
            self.assertEqual(d.append(path, 0, data[:1000]).headers["Upload-Offset"], "1000")
            # A connection that breaks during a PATCH: the received bytes stay.
            with socket.create_connection(("127.0.0.1", d.port)) as s:
                s.sendall((f"PATCH {path} HTTP/1.1\r\nHost: localhost\r\nTus-Resumable: 1.0.0\r\nUpload-Offset: 1000\r\n"
                           f"Content-Type: application/offset+octet-stream\r\nContent-Length: {len(data) - 1000}\r\n\r\n").encode()
                          + data[1000:3000])
                s.shutdown(socket.SHUT_WR)
                s.recv(1000)
            d.kill()
            d.start()
            head = d.ask("HEAD", path, headers=TUS)
            self.assertEqual((head.headers["Upload-Offset"], head.headers["Upload-Length"]), ("3000", str(len(data))))
            self.assertEqual(d.append(path, 1000, data[1000:]).status, 409)
            self.assertEqual(d.append(path, 3000, data[3000:]).status, 204)
            self.assertEqual(d.ask("GET", f"/v1/blobs/{sha256(data)}").body, data)
            self.assertEqual(d.ask("HEAD", path, headers=TUS).status, 404)

    def test_refuses_wrong_uploads(self):
        with Daemon(config="blob_mb = 1\nupload_lifetime_s = 1") as d:
            self.assertEqual(d.ask("POST", "/v1/uploads", headers={"Upload-Length": "1"}).status, 412)
            self.assertEqual(d.ask("POST", "/v1/uploads", headers={**TUS, "Upload-Length": "1"}).status, 400)
            self.assertEqual(d.ask("POST", "/v1/uploads", headers={**TUS, "Upload-Length": "2000000"}).status, 413)
            self.assertEqual(d.ask("OPTIONS", "/v1/uploads").headers["Tus-Extension"], "creation,termination,expiration")
            path = d.create_upload(b"right", sha256(b"other")).headers["Location"]
            self.assertEqual(d.append(path, 0, b"right!").status, 413)  # beyond its length
            self.assertEqual(d.append(path, 0, b"right").status, 422)  # of another digest: deleted
            self.assertEqual(d.ask("HEAD", path, headers=TUS).status, 404)
            path = d.create_upload(b"given up").headers["Location"]
            self.assertEqual(d.ask("DELETE", path, headers=TUS).status, 204)
            self.assertEqual(list((d.path / "store/uploads").iterdir()), [])

    def test_a_patch_without_the_media_type_is_refused_and_nothing_of_it_is_kept(self):
        with Daemon() as d:
            path = d.create_upload(b"hello").headers["Location"]
            reply = d.ask("PATCH", path, b"hello", {**TUS, "Upload-Offset": "0"})
            self.assertEqual(reply.status, 415, reply.body)
            self.assertEqual(reply.json["field"], "Content-Type")
            self.assertEqual(d.ask("HEAD", path, headers=TUS).headers["Upload-Offset"], "0")
            self.assertEqual(d.append(path, 0, b"hello").status, 204)

    def test_an_upload_that_does_not_grow_expires_when_it_says(self):
        lifetime = 1
        with Daemon(config=f"upload_lifetime_s = {lifetime}") as d:
            before = time.time()
            reply = d.create_upload(b"hello")
            path, after = reply.headers["Location"], time.time()
            expires = self.date(reply)
            # The date has whole seconds, so it can be up to one second early.
            self.assertTrue(before + lifetime - 1 < expires <= after + lifetime, (before, expires, after))
            before = time.time()
            expires = self.date(d.append(path, 0, b"he"))  # it received bytes: counted from now
            self.assertTrue(before + lifetime - 1 < expires <= time.time() + lifetime)
            self.assertEqual(len(list((d.path / "store/uploads").iterdir())), 1)
            d.stop()
            time.sleep(lifetime + 0.1)
            d.start()
            self.assertIn(d.ask("HEAD", path, headers=TUS).status, (404, 410))
            self.assertIn(d.append(path, 2, b"llo").status, (404, 410))
            self.assertEqual(list((d.path / "store/uploads").iterdir()), [])
            self.assertEqual(d.create_upload(b"hello").status, 201)  # a new one can be created

    @staticmethod
    def date(reply):
        """Upload-Expires in seconds since 1970; an HTTP date is of one form."""
        text = reply.headers["Upload-Expires"]
        expires = email.utils.parsedate_to_datetime(text)
        assert email.utils.format_datetime(expires, usegmt=True) == text, text
        return expires.timestamp()


if __name__ == "__main__":
    unittest.main()
