"""nginx in front of the daemon, with the committed configuration: what it lets through, and TLS."""
import http.client
import os
import subprocess
import unittest

from front import ACCEL, AUTHORITY, TOKEN, Front, admin_token, statuses, trusting
from harness import Daemon, Reply, sha256


class Gate(unittest.TestCase):
    """What nginx lets through and what it answers by itself."""

    def check_problem(self, reply, status):
        self.assertEqual((reply.status, reply.headers["Content-Type"]), (status, "application/problem+json"))
        self.assertEqual(reply.json["status"], status)
        self.assertTrue(reply.json["type"].startswith("urn:hairbake:problem:") and reply.json["title"] and reply.json["detail"])

    def test_without_tokens_nothing_is_forwarded(self):
        with Daemon() as d, Front(d) as f:
            for method, path in (("GET", "/healthz"), ("GET", "/v1/bakes"), ("GET", "/metrics"), ("POST", "/v1/rebakes"),
                                 ("PUT", f"/v1/blobs/{sha256(b'x')}"), ("DELETE", "/v1/session")):
                for headers in ({}, {"Host": "localhost"}, {"X-Forwarded-For": ""}):
                    reply = f.ask(method, path, b"x" if method == "PUT" else None, headers)
                    self.check_problem(reply, 403)
                    self.assertEqual(reply.json["type"], "urn:hairbake:problem:no-tokens")
            self.assertEqual(d.ask("GET", "/v1/bakes").status, 200)
            self.assertEqual(d.ask("GET", "/v1/bakes", headers={"Forwarded": "for=192.0.2.1"}).status, 403)

    def test_files_of_the_store_cannot_be_asked_for_from_outside(self):
        with Daemon(tokens=admin_token(), listen=f"port = 0\n{ACCEL}") as d, Front(d) as f:
            digest = f.put(b"the secret")
            inside = f"/blobs/{digest[:2]}/{digest}"
            for path in (inside, f"/{inside}", f"/x/..{inside}", inside.replace("/b", "/%62"), inside.replace("/b", "/./b"),
                         f"/v1/blobs/..%2f..{inside}", f"{inside}?x", "/blobs/", "/problem", f"http://localhost{inside}"):
                answer = f.raw(f"GET {path} HTTP/1.1\r\n{AUTHORITY}Connection: close\r\n\r\n".encode())
                self.assertIn(statuses(answer), ([404], [400]), path)
                self.assertNotIn(b"the secret", answer)
            for headers in ({"X-Accel-Redirect": inside}, {"X-Accel-Redirect": inside, "Authorization": ""},
                            {"X-Test": f"%0d%0aX-Accel-Redirect:%20{inside}"}):
                reply = f.ask("GET", "/healthz", headers=headers)
                self.assertIn(reply.status, (200, 400))
                self.assertNotIn(b"the secret", reply.body)

    def test_errors_of_nginx_are_problems(self):
        with Daemon(tokens=admin_token()) as d, Front(d, body="1m") as f:
            for method, path, headers, status in (
                    ("GET", "/" + "a" * 20000, {}, 414), ("TRACE", "/", {}, 405), ("GET", "/blobs/x", {}, 404),
                    ("GET", "/", {"X": "a" * 20000}, 431), ("PUT", "/v1/blobs/x", {"Content-Length": "2000000"}, 413),
                    ("POST", "/v1/bakes", {"Content-Length": "20000000"}, 413)):
                reply = f.ask(method, path, headers=headers)
                self.check_problem(reply, status)
                self.assertEqual(reply.headers["X-Content-Type-Options"], "nosniff")
                self.assertNotIn("/", reply.headers["Server"])
            d.kill()
            reply = f.ask("GET", "/v1/bakes")
            self.check_problem(reply, 503)
            self.assertEqual(reply.headers["Retry-After"], "5")
            d.start()

    def test_replies_carry_security_headers_once(self):
        with Daemon(tokens=admin_token()) as d, Front(d) as f:
            reply = f.ask("GET", "/v1/bakes")
            for name, value in (("X-Content-Type-Options", "nosniff"), ("X-Frame-Options", "DENY"), ("Referrer-Policy", "no-referrer"),
                                ("Content-Security-Policy", "default-src 'none'; frame-ancestors 'none'")):
                self.assertEqual(reply.headers.get_all(name), [value])
            self.assertIsNone(reply.headers["Strict-Transport-Security"])

    def test_too_many_requests_get_429(self):
        with Daemon(tokens=admin_token()) as d, Front(d, rate="1r/s") as f:
            connection = http.client.HTTPConnection("127.0.0.1", f.port)
            for count in range(3000):  # 500 in a burst, then one a second: at less than 1.2 a second it would not be told
                connection.request("GET", "/healthz")
                reply = connection.getresponse()
                reply = Reply(reply.status, reply.headers, reply.read())
                if reply.status != 200:
                    break
            connection.close()
            self.check_problem(reply, 429)
            self.assertEqual(reply.headers["Retry-After"], "1")
            self.assertGreaterEqual(count, 500)

    def test_a_refused_upload_gets_its_refusal(self):
        with Daemon(tokens=admin_token(), config="blob_mb = 1") as d, Front(d) as f:
            data = os.urandom(8 << 20)
            for headers, status in (({"Authorization": ""}, 401), ({}, 413)):
                reply = f.ask("PUT", f"/v1/blobs/{sha256(data)}", data, headers)
                self.check_problem(reply, status)


class Tls(unittest.TestCase):
    def test_the_site_with_tls_serves_and_the_plain_port_leads_to_it(self):
        with Daemon(tokens=admin_token()) as d, Front(d, tls=True) as f:
            connection = http.client.HTTPSConnection("localhost", f.port, context=trusting(f))
            connection.request("POST", "/v1/session", headers={"Authorization": f"Bearer {TOKEN}"})
            reply = connection.getresponse()
            self.assertEqual((reply.status, reply.headers["Strict-Transport-Security"]), (204, "max-age=31536000"))
            self.assertRegex(reply.headers["Set-Cookie"], r"(?i)HttpOnly; SameSite=Strict; .*; Secure$")
            connection.close()
            version = subprocess.run(["curl", "-sS", "--http2", "--cacert", f.path / "chain.pem", "-o", "/dev/null", "-w",
                                      "%{http_version} %{http_code}", "-H", f"Authorization: Bearer {TOKEN}",
                                      f"https://localhost:{f.port}/v1/bakes"], capture_output=True, text=True, check=True).stdout
            self.assertEqual(version, "2 200")
            old = subprocess.run(["curl", "-sS", "--tlsv1.1", "--tls-max", "1.1", "--ciphers", "DEFAULT@SECLEVEL=0", "--cacert",
                                  f.path / "chain.pem", f"https://localhost:{f.port}/"], capture_output=True, check=False)
            self.assertNotEqual(old.returncode, 0)
            plain = f.raw(b"GET /v1/bakes HTTP/1.1\r\nHost: localhost\r\nConnection: close\r\n\r\n")
            self.assertEqual(statuses(plain), [400])
            self.assertIn(b"application/problem+json", plain)
            connection = http.client.HTTPConnection("localhost", f.plain_port)
            connection.request("GET", "/v1/bakes?limit=1")
            reply = connection.getresponse()
            self.assertEqual((reply.status, reply.headers["Location"]), (308, f"https://localhost:{f.port}/v1/bakes?limit=1"))
            connection.close()


if __name__ == "__main__":
    unittest.main()
