"""Makes data/store_N.tar.xz: a store of database version N, with the programs of a commit before version N + 1.

Usage: HAIRBAKE_PROGRAMS=FOLDER make_store.py OUTPUT. FOLDER holds hairbaked and hairbake-worker: of commit 8908c4a for version
4, of fc5ecbb for version 5.
The archive holds `store/` as that daemon left it and `expected.json`: the requests, and what the daemon answered to them.
"""
import json
import sys
import tarfile
import tempfile
from pathlib import Path

from harness import TUS, Daemon, base64_text, hair_bytes, hdr_bytes, quick_request, sha256

SETTINGS = {"transmittance": {"directions": 16, "voxels": 32, "reference_vertices": 8},
            "irradiance": {"face_size": 4, "specular_maps": 3, "exponent": 32, "rotation_deg": [0.0, 30.0, 0.0], "exposure_stops": 1.0},
            "outputs": ["npy", "ktx2"]}


def ask(daemon, method, path, body=None):
    reply = daemon.ask(method, path, body)
    assert reply.status in (200, 201, 202), (path, reply.status, reply.body)
    return reply.json


def answers(daemon):
    """What the daemon answers about everything that the store holds: address -> JSON."""
    paths = ["/v1/bakes", "/v1/bakes?name=sky", "/v1/models", "/v1/environments", "/v1/names/environment",
             "/v1/names/environment/sky", "/v1/names/model/groom"]
    paths += [f"/v1/bakes/{bake['id']}" for bake in ask(daemon, "GET", "/v1/bakes")["bakes"]]
    return {path: ask(daemon, "GET", path) for path in paths}


def digests(daemon):
    """Address of each file of each done bake -> SHA-256 of its bytes."""
    found = {}
    for bake in ask(daemon, "GET", "/v1/bakes?state=done")["bakes"]:
        for file in ask(daemon, "GET", f"/v1/bakes/{bake['id']}")["files"]:
            reply = daemon.ask("GET", file["href"])
            assert reply.status == 200, (file["href"], reply.body)
            found[file["href"]] = sha256(reply.body)
    return found


def fill(daemon):
    """Two bakes of both stages (one by names), one of each stage alone, a batch, a failed bake, an unfinished upload."""
    hair, sky, evening = (daemon.put(data) for data in (hair_bytes(strands=30), hdr_bytes(), hdr_bytes(red=99)))
    ask(daemon, "POST", "/v1/models", {"sha256": hair})
    ask(daemon, "POST", "/v1/environments", {"sha256": sky})
    ask(daemon, "PUT", "/v1/names/model/groom", {"sha256": hair, "note": "first"})
    ask(daemon, "PUT", "/v1/names/environment/sky", {"sha256": evening})
    ask(daemon, "PUT", "/v1/names/environment/sky", {"sha256": sky})
    requests = {"both": {"hair": f"sha256:{hair}", "environment": f"sha256:{sky}", **SETTINGS},
                "named": {"hair": "name:groom", "environment": "name:sky@2", "outputs": ["npy"],
                          "transmittance": {"directions": 16, "voxels": 32, "reference_vertices": 0, "method": "trace"},
                          "irradiance": {"face_size": 4, "specular_maps": 2}},
                "hair alone": quick_request(hair, transmittance={"seed": 3, "direction_set": "random"}),
                "environment alone": quick_request(environment=sky, irradiance={"model": "kajiya-kay", "tint": [1.0, 0.5, 0.25]}),
                "failed": quick_request(daemon.put(b"no hair model"))}
    ids = {}
    for name, request in requests.items():
        ids[name] = ask(daemon, "POST", "/v1/bakes", request)["id"]
        assert daemon.wait(ids[name])["state"] == ("failed" if name == "failed" else "done"), name
    batch = ask(daemon, "POST", "/v1/rebakes", {"name": "sky", "environment": f"sha256:{evening}"})["id"]
    for bake in ask(daemon, "GET", f"/v1/bakes?batch={batch}")["bakes"]:
        assert daemon.wait(bake["id"])["state"] == "done", bake
    data = b"an upload that was interrupted"
    upload = daemon.create_upload(data).headers["Location"]
    assert daemon.append(upload, 0, data[:11]).status == 204
    return {"requests": requests, "ids": ids, "batch": ask(daemon, "GET", f"/v1/batches/{batch}"),
            "batch_bakes": ask(daemon, "GET", f"/v1/bakes?batch={batch}"),
            "upload": {"path": upload, "data": data.decode(), "offset": 11}}


def main(output):
    with Daemon() as daemon, tempfile.TemporaryDirectory() as folder:
        expected = fill(daemon)
        expected |= {"answers": answers(daemon), "digests": digests(daemon)}
        assert daemon.stop()[0] == 0
        described = Path(folder) / "expected.json"
        described.write_text(json.dumps(expected, indent=1))
        with tarfile.open(output, "w:xz") as archive:
            archive.add(described, "expected.json")
            archive.add(daemon.path / "store", "store", filter=lambda entry: None if entry.name.endswith("/lock") else entry)


if __name__ == "__main__":
    main(sys.argv[1])
