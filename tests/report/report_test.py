"""Makes a tiny report and checks that its page is whole.

Usage: report_test.py BUILD_FOLDER PROGRAM.
"""
import re
import subprocess
import sys
from pathlib import Path


def main():
    """Exit code 0 when the page has all sections, and every picture that it links is a PNG."""
    build, program = Path(sys.argv[1]), sys.argv[2]
    script = Path(__file__).with_name("report.py")
    subprocess.run([sys.executable, script, build, program, "report-test", "--tiny"], check=True)
    page = (build / "report-test" / "index.html").read_text(encoding="utf-8")
    links = re.findall(r'<img src="([^"]+)"', page)
    missing = [link for link in links if (build / "report-test" / link).read_bytes()[:4] != b"\x89PNG"]
    sections, tables = page.count("<h2"), page.count("<table>")
    print(f"{sections} sections, {tables} tables, {len(links)} pictures, {len(missing)} of them broken")
    numbers = not re.search(r"\b(nan|inf)\b", re.sub(r"<[^>]*>", " ", page).lower())
    data = "hairbake sample" in page  # how the models were made stands there too
    return 0 if sections == 9 and tables == 9 and len(links) > 40 and not missing and numbers and data else 1


if __name__ == "__main__":
    sys.exit(main())
