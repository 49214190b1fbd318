"""Who may include whom: reads every #include of the sources, follows it through headers, and names what breaks the tables.

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
    (r"core/result/", [r"core/(base|hair|mesh|environment|fiber|irradiance|reference|volume|request|result)/"]),
    (r"core/output/", [r"core/(base|hair|environment|fiber|volume|request|result|output)/"]),
    (r"core/stages/", [r"core/(?!render/|sample/|tools/)\w+/"]),
    (r"core/sample/", [r"core/(base|hair|mesh|environment|output|sample)/"]),
    (r"core/tools/", [r"core/(base|hair|mesh|environment|output|request|tools)/"]),
    (r"core/[^/]+$", [r"core/"]),  # the facades: bake, render, reading results back
    (r"clients/", [r"core/(bake|render)\.h", r"core/(base|request|tools)/", r"core/render/render_request\.h",
                   r"core/output/manifest\.h", r"core/sample/sample\.h", r"clients/"]),
    (r"server/worker/", [r"core/", r"server/worker/"]),
    (r"server/http/", [r"core/(request|base)/", r"server/(http|jobs|settings)"]),
    (r"server/jobs/", [r"core/(request|base)/", r"server/(jobs|store|settings)"]),
    (r"server/store/", [r"core/(request|base)/", r"server/(store|settings)"]),
    (r"server/", [r"core/(request|base)/", r"server/(?!worker/)"]),
    (r"tests/", [r"core/", r"clients/", r"server/", r"tests/"]),
]
# What a file must not reach through any number of headers. Every row that matches the file holds.
NEVER_REACHED = [
    # The request, the daemon and what both see know settings, but no hair model, environment map or stage.
    (r"(core/request|server/(?!worker/))", r"core/(?!base/|request/|\w+/\w+_settings\.h|environment/directional_light\.h)"),
    (r"core/reference/", r"core/volume/"),
    (r"core/volume/", r"core/(environment|fiber|irradiance|reference|request|result)/(?!\w+_settings\.h)"),
    (r"core/irradiance/", r"core/(hair|mesh|volume|reference|request|result)/(?!\w+_settings\.h)"),
    (r"server/http/", r"(SQLiteCpp/|sqlite3\.h|server/store/database\.h)"),  # typed calls of jobs/ alone
    (r"server/(http|jobs|store)/", r"httplib\.h"),
]
NEVER_REACHED_BUT = {("server/http/http_server.cpp", "httplib.h")}
OURS = re.compile(r"(core|clients|server|tests)/")
# Libraries that stay in .cpp files.
IN_SOURCES_ONLY = re.compile(r"(openvdb|embree\d|OpenImageIO|OpenEXR|GL|hwy|valijson|curl)/|(httplib|sqlite3|tiny_gltf|tiny_obj_loader)\.h")
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


def includes_of(file):
    """The headers that a source names, in order."""
    matches = (INCLUDE.match(line) for line in file.read_text(encoding="utf-8").splitlines())
    return [match.group(2) for match in matches if match]


def reached(includer, includes):
    """Every header that `includer` reaches, with the header that names it: {header: named by}."""
    found, waiting = {}, [includer]
    while waiting:
        at = waiting.pop()
        for header in includes.get(at, []):
            if header not in found and header != includer:
                found[header] = at
                waiting.append(header)
    return found


def chain_to(header, found):
    """"a.h <- b.h <- c.cpp": how the header was reached."""
    chain = [header]
    while chain[-1] in found:
        chain.append(found[chain[-1]])
    return " <- ".join(chain)


def reach_problems(includer, includes):
    found = reached(includer, includes)
    for row, never in NEVER_REACHED:
        if not re.match(row, includer):
            continue
        for header in found:
            if re.match(never, header) and (includer, header) not in NEVER_REACHED_BUT:
                yield f"{row} must not reach {header}: {chain_to(header, found)}"


def check_reach():
    """Planted headers: what is reached through others must be found, and nothing else."""
    includes = {"core/reference/a.cpp": ["core/reference/a.h"], "core/reference/a.h": ["core/hair/h.h", "vector"],
                "core/hair/h.h": ["core/volume/v.h"], "server/jobs/j.cpp": ["core/request/r.h"],
                "core/request/r.h": ["core/hair/strand_settings.h", "core/request/r.h"], "server/http/h.cpp": ["server/jobs/s.h"],
                "server/jobs/s.h": ["server/store/database.h"]}
    broken = {file for file in includes if list(reach_problems(file, includes))}
    expected = {"core/reference/a.cpp", "core/reference/a.h", "server/http/h.cpp"}
    if broken != expected:
        print(f"following planted headers finds {sorted(broken)} instead of {sorted(expected)}")
    return broken == expected


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
        ("core/output/a.cpp", '#include "core/result/bake_result.h"', True),
        ("core/output/a.cpp", '#include "core/bake.h"', False),
        ("core/hair/strand_settings.h", '#include "core/hair/hair_model.h"', False),
        ("core/request/a.h", '#include "core/hair/strand_settings.h"', True),
        ("core/request/a.h", '#include "core/hair/hair_model.h"', False),
        ("server/http/a.cpp", '#include "core/bake.h"', False),
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
    includes = {file.relative_to(root).as_posix(): includes_of(file) for file in files}
    for file in files:
        includer = file.relative_to(root).as_posix()
        for message in reach_problems(includer, includes):
            broken += 1
            print(f"{includer}: {message}")
        for number, line in enumerate(file.read_text(encoding="utf-8").splitlines(), 1):
            message = problem(includer, line)
            if message:
                broken += 1
                print(f"{includer}:{number}: {message}")
    print(f"{len(files)} files read, {broken} includes break the rules")
    return 0 if check_itself() and check_reach() and not broken and files else 1


if __name__ == "__main__":
    sys.exit(main())
