"""Who may include whom: reads every #include of the sources and names those that break the table below.

Usage: include_rules_test.py [ROOT]. Exit code 0 when nothing breaks, 1 otherwise. It first checks itself on planted lines.
"""
import re
import sys
from pathlib import Path

# A header may be included where a pattern of its includer's row matches it. The first matching row holds.
# Patterns are regular expressions over paths from the root.
TABLE = [
    (r"core/base/", [r"core/base/"]),
    # Settings are plain structs that the daemon and the command line see: they may include nothing else.
    (r"core/\w+/\w+_settings\.h$", [r"core/base/", r"core/\w+/\w+_settings\.h", r"core/environment/directional_light\.h"]),
    (r"core/request/", [r"core/(base|request)/", r"core/\w+/\w+_settings\.h"]),
    (r"core/visibility/", [r"core/(base|visibility)/"]),
    (r"core/hair/", [r"core/(base|hair)/"]),
    (r"core/mesh/", [r"core/(base|mesh)/"]),
    (r"core/environment/", [r"core/(base|environment)/"]),
    (r"core/fiber/", [r"core/(base|fiber)/"]),
    (r"core/irradiance/", [r"core/(base|environment|fiber|irradiance)/"]),
    (r"core/volume/", [r"core/(base|hair|mesh|visibility|volume)/"]),
    # never volume: the reference is independent of the bake
    (r"core/reference/", [r"core/(base|hair|mesh|visibility|reference)/"]),
    (r"core/render/", [r"core/(base|hair|mesh|visibility|environment|fiber|irradiance|reference|render|request)/"]),
    (r"core/output/", [r"core/(base|hair|mesh|environment|irradiance|visibility|volume|reference|output|request)/",
                       r"core/bake\w*\.h"]),
    (r"core/sample/", [r"core/(base|hair|mesh|environment|output|sample)/"]),
    (r"core/tools/", [r"core/(base|hair|mesh|environment|output|request|tools)/"]),
    (r"core/[^/]+$", [r"core/"]),
    (r"clients/", [r"core/(bake\w*|render)\.h", r"core/(request|tools)/", r"core/output/manifest\.h", r"core/sample/sample\.h",
                   r"core/base/", r"clients/"]),
    (r"server/worker/", [r"core/", r"server/worker/"]),
    (r"server/http/", [r"core/(request|base)/", r"server/(http|jobs|settings)"]),
    (r"server/jobs/", [r"core/(request|base)/", r"server/(jobs|store|settings)"]),
    (r"server/store/", [r"core/(request|base)/", r"server/(store|settings)"]),
    (r"server/", [r"core/(request|base)/", r"server/(?!worker/)"]),
    (r"tests/", [r"core/", r"clients/", r"server/", r"tests/"]),
]
OURS = re.compile(r"(core|clients|server|tests)/")
# Libraries that stay in .cpp files.
IN_SOURCES_ONLY = re.compile(r"(openvdb|embree\d|OpenImageIO|hwy|valijson|curl)/|(httplib|sqlite3|tiny_gltf|tiny_obj_loader)\.h")
INCLUDE = re.compile(r'^\s*#\s*include\s*([<"])([^>"]+)[>"]')


def problem(includer, line):
    """What is wrong with this line of the file `includer` (a path from the root), or None."""
    match = INCLUDE.match(line)
    if not match:
        return None
    quote, header = match.groups()
    if includer.endswith(".h") and IN_SOURCES_ONLY.match(header):
        return f"{header} may only be included in .cpp files"
    if not OURS.match(header):
        return f'"{header}": our headers are named by their path from the root, others in <>' if quote == '"' else None
    for row, allowed in TABLE:
        if re.match(row, includer):
            return None if any(re.match(a, header) for a in allowed) else f"{header} may not be included from {row}"
    return f"{includer} is in no row of the table"


def check_itself():
    """Planted lines: each must be judged as given."""
    planted = [
        ("core/base/a.cpp", '#include "core/base/vec.h"', True),
        ("core/base/a.cpp", '#include "core/hair/hair_model.h"', False),
        ("core/hair/a.cpp", '  #  include "core/base/vec.h"  // comment', True),
        ("core/hair/a.cpp", '#include "core/environment/environment_map.h"', False),
        ("core/environment/a.h", '#include "core/hair/hair_model.h"', False),
        ("core/fiber/a.h", '#include "core/irradiance/irradiance_maps.h"', False),
        ("core/irradiance/a.h", '#include "core/fiber/fiber_model.h"', True),
        ("core/irradiance/a.h", '#include "core/hair/hair_model.h"', False),
        ("core/volume/a.h", '#include "core/hair/strand_geometry.h"', True),
        ("core/volume/a.h", '#include "core/reference/tracer.h"', False),
        ("core/reference/a.cpp", '#include "core/volume/transmittance.h"', False),
        ("core/output/a.cpp", '#include "core/bake.h"', True),
        ("core/output/a.cpp", '#include "core/request/request_json.h"', True),  # the manifest holds the request as run
    ("core/output/a.cpp", '#include "core/sample/sample.h"', False),
        ("core/bake.cpp", '#include "core/output/manifest.h"', True),
        ("core/bake.cpp", '#include "server/store/store.h"', False),
        ("clients/cli/a.cpp", '#include "core/bake.h"', True),
        ("clients/cli/a.cpp", '#include "core/request/request_json.h"', True),
        ("clients/cli/a.cpp", '#include "core/sample/sample.h"', True),
        ("clients/cli/a.cpp", '#include "core/hair/hair_file.h"', False),
        ("clients/cli/a.cpp", '#include "server/settings.h"', False),
        ("server/http/a.cpp", '#include "server/store/store.h"', False),
        ("server/worker/a.cpp", '#include "server/jobs/jobs.h"', False),
        ("server/main.cpp", '#include "clients/cli/a.h"', False),
        ("core/volume/a.cpp", "#include <openvdb/openvdb.h>", True),
        ("core/volume/a.h", "#include <openvdb/openvdb.h>", False),
        ("core/reference/a.h", "#include <embree3/rtcore.h>", False),
        ("core/environment/a.h", "#include <OpenImageIO/imageio.h>", False),
        ("core/volume/a.h", "#include <hwy/highway.h>", False),
        ("server/http/a.h", "#include <httplib.h>", False),
        ("server/store/a.h", "#include <sqlite3.h>", False),
        ("clients/cli/remote/a.h", "#include <curl/curl.h>", False),
        ("core/base/a.h", "#include <vector>", True),
        ("core/base/a.h", '#include "vec.h"', False),
        ("core/base/a.h", '// #include "core/hair/hair_model.h"', True),
        ("elsewhere/a.h", '#include "core/bake.h"', False),
    ]
    wrong = [(f, line) for f, line, good in planted if (problem(f, line) is None) != good]
    for includer, line in wrong:
        print(f"the rule judges this planted line wrongly: {includer}: {line}")
    return not wrong


def main():
    root = Path(sys.argv[1]) if len(sys.argv) > 1 else Path(__file__).resolve().parent.parent
    files = [f for folder in ("core", "clients", "server", "tests") for f in sorted((root / folder).rglob("*"))
             if f.suffix in (".h", ".cpp")]
    broken = 0
    for file in files:
        includer = file.relative_to(root).as_posix()
        for number, line in enumerate(file.read_text(encoding="utf-8").splitlines(), 1):
            message = problem(includer, line)
            if message:
                broken += 1
                print(f"{includer}:{number}: {message}")
    print(f"{len(files)} files read, {broken} includes break the rules")
    return 0 if check_itself() and not broken and files else 1


if __name__ == "__main__":
    sys.exit(main())
