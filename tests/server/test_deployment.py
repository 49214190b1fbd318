"""The files of a deployment: systemd units, the OpenAPI document, the metrics."""
import subprocess
import tempfile
import unittest
from pathlib import Path

from harness import Daemon, hair_bytes, hdr_bytes, quick_request

ROOT = Path(__file__).resolve().parents[2]
NPM = ROOT / "tests/npm"
PROMTOOL = ROOT / "build/promtool/promtool"
UNITS = sorted((ROOT / "config/systemd").glob("*.service"))


def run(*command, **more):
    done = subprocess.run(command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, check=False, **more)
    return done.returncode, done.stdout


class Systemd(unittest.TestCase):
    def test_units_are_exposed_by_two_of_ten_at_most(self):
        self.assertEqual([u.name for u in UNITS], ["hairbake-nginx.service", "hairbaked.service"])
        for unit in UNITS:
            code, text = run("systemd-analyze", "security", "--offline=true", "--threshold=20", unit)  # in tenths
            self.assertEqual(code, 0, text)

    def test_systemd_knows_every_line_of_the_units(self):
        for unit in UNITS:
            with tempfile.TemporaryDirectory() as folder:
                copy = Path(folder, unit.name)
                # The programs are elsewhere in a build tree.
                copy.write_text(unit.read_text().replace("/usr/local/bin/hairbaked ", "/bin/true ").replace("After=network.target", "After="))
                code, text = run("systemd-analyze", "verify", "--man=no", "--recursive-errors=no", copy)
                self.assertEqual((code, text), (0, ""), unit.name)


class Documents(unittest.TestCase):
    def test_redocly_and_spectral_find_nothing_in_the_document_that_is_served(self):
        with Daemon() as d, tempfile.TemporaryDirectory() as folder:
            document = Path(folder, "openapi.json")
            document.write_bytes(d.ask("GET", "/openapi.json").body)
            self.assertEqual(run("node", NPM / "lint_openapi.mjs", document), (0, ""))
            rules = Path(folder, "rules.json")
            rules.write_text('{"extends": "spectral:oas"}')
            code, text = run(NPM / "node_modules/.bin/spectral", "lint", "--fail-severity=hint", "-r", rules, document)
            self.assertEqual(code, 0, text)

    def test_redocly_finds_what_was_planted(self):
        with tempfile.TemporaryDirectory() as folder:
            document = Path(folder, "openapi.json")
            document.write_text('{"openapi": "3.1.0", "info": {"title": "x", "version": "1"}, "paths": {"/{id}": {"get": {"responses": {}}}}}')
            code, text = run("node", NPM / "lint_openapi.mjs", document)
            self.assertEqual(code, 1)
            self.assertIn("path-parameters-defined", text)

    def test_promtool_finds_nothing_in_the_metrics(self):
        with Daemon() as d:
            d.wait(d.ask("POST", "/v1/bakes", quick_request(d.put(hair_bytes()), d.put(hdr_bytes()))).json["id"])
            d.ask("GET", "/nothing")
            text = d.ask("GET", "/metrics").body
            done = subprocess.run([PROMTOOL, "check", "metrics"], input=text, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, check=False)
            self.assertEqual((done.returncode, done.stdout.decode()), (0, ""))
            broken = subprocess.run([PROMTOOL, "check", "metrics"], input=text.replace(b"_total", b""), capture_output=True, check=False)
            self.assertNotEqual(broken.returncode, 0)


if __name__ == "__main__":
    unittest.main()
