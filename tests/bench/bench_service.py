#!/usr/bin/env python3
"""Measures the real daemon with a thousand grooms: posts done requests again, and asks for new lighting of all grooms.

bench_service.py [submit] [rebake]; both without arguments. HAIRBAKE_PROGRAMS is the folder of the programs.
"""
import json
import random
import socket
import statistics
import sys
import time
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "server"))
from harness import Daemon, hair_bytes, hdr_bytes, quick_request  # noqa: E402

SUBMISSIONS, GROOMS = 10_000, 1_000


def exchange(port, request):
    """Sends one request on a connection of its own, as the daemon requires. Returns the whole reply."""
    with socket.create_connection(("127.0.0.1", port)) as connection:
        connection.sendall(request)
        reply = b""
        while piece := connection.recv(65536):
            reply += piece
        return reply


def get(path):
    return f"GET {path} HTTP/1.1\r\nHost: localhost\r\n\r\n".encode()


def post(path, body):
    return (f"POST {path} HTTP/1.1\r\nHost: localhost\r\nContent-Type: application/json\r\n"
            f"Content-Length: {len(body)}\r\n\r\n{body}").encode()


def times_of(port, requests):
    """Seconds of each request, one after the other. Every reply must be 200."""
    seconds = []
    for request in requests:
        begin = time.perf_counter()
        reply = exchange(port, request)
        seconds.append(time.perf_counter() - begin)
        assert reply.startswith(b"HTTP/1.1 200 "), reply[:200]
    return seconds


def show(what, seconds):
    ordered = sorted(seconds)
    print(f"{what}: median {statistics.median(ordered) * 1e3:.3f} ms, "
          f"p99 {ordered[int(len(ordered) * 0.99)] * 1e3:.3f} ms ({len(ordered)} requests)", flush=True)


def bake_grooms(d, sky):
    """Bakes GROOMS different grooms under one sky. Returns their requests by the ids of the bakes."""
    begin = time.perf_counter()
    requests = [quick_request(d.put(hair_bytes(strands=4, points=4, seed=seed)), sky) for seed in range(GROOMS)]
    bakes = {}
    for request in requests:
        reply = d.ask("POST", "/v1/bakes", request)
        assert reply.status in (200, 202), reply.body
        bakes[reply.json["id"]] = request
    while d.ask("GET", "/v1/bakes?state=queued&limit=1").json["bakes"] or \
            d.ask("GET", "/v1/bakes?state=running&limit=1").json["bakes"]:
        time.sleep(0.5)
    print(f"{GROOMS} grooms baked once: {time.perf_counter() - begin:.1f} s", flush=True)
    return bakes


def bench_submit(d, bakes, _):
    """Posts in random order, as a build farm does. A view is kept in memory until the database changes, so the first
    time of each bake is also shown alone."""
    bodies = {bake: json.dumps(request) for bake, request in bakes.items()}
    order = random.Random(1).choices(list(bakes), k=SUBMISSIONS)
    show("GET /healthz", times_of(d.port, [get("/healthz")] * 2000))
    seconds = times_of(d.port, [post("/v1/bakes", bodies[bake]) for bake in order])
    show("POST /v1/bakes, done before (target of the median: 1 ms)", seconds)
    first = {bake: at for at, bake in reversed(list(enumerate(order)))}
    show("of these, the first of each bake", [seconds[at] for at in first.values()])
    show("GET /v1/bakes/{id}", times_of(d.port, [get(f"/v1/bakes/{bake}") for bake in order[:2000]]))


def seconds_until_done(d, batch):
    begin = time.perf_counter()
    while True:
        states = d.ask("GET", batch).json["states"]
        if states["done"] == sum(states.values()):
            return time.perf_counter() - begin
        assert states["failed"] == 0, states
        time.sleep(0.02)


def bench_rebake(d, _, old):
    new, alone = (d.put(hdr_bytes(red=red)) for red in (101, 102))
    begin = time.perf_counter()
    d.wait(d.ask("POST", "/v1/bakes", quick_request(environment=alone)).json["id"])
    stage = time.perf_counter() - begin
    begin = time.perf_counter()
    reply = d.ask("POST", "/v1/rebakes", {"environment": f"sha256:{new}", "replaces": f"sha256:{old}"})
    assert reply.status == 202, reply.body
    posted = time.perf_counter() - begin
    seconds_until_done(d, reply.headers["Location"])
    total = time.perf_counter() - begin
    print(f"{reply.json['bakes']} grooms under a new lighting: {total:.2f} s (the request {posted:.2f} s); one irradiance stage "
          f"alone {stage:.2f} s; more than that by {total - stage:.2f} s (target: 10 s)", flush=True)


if __name__ == "__main__":
    benches = {"submit": bench_submit, "rebake": bench_rebake}
    with Daemon(workers=2) as daemon:
        lighting = daemon.put(hdr_bytes(red=100))
        grooms = bake_grooms(daemon, lighting)
        for name in sys.argv[1:] or benches:
            benches[name](daemon, grooms, lighting)
