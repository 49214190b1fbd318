#!/usr/bin/python3
"""Measures the service behind nginx: slow clients, polling, downloads. Prints ratios to nginx alone in the same run.

bench_nginx.py [seconds of each measurement, default 5] [MB of the download, default 500]. HAIRBAKE_PROGRAMS is the
folder of the programs.
"""
import http.client
import os
import re
import selectors
import socket
import statistics
import subprocess
import sys
import threading
import time
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "server"))
from front import TOKEN, Front, admin_token, free_port  # noqa: E402
from harness import Daemon, hair_bytes, hdr_bytes, quick_request, sha256  # noqa: E402

SECONDS = float(sys.argv[1]) if len(sys.argv) > 1 else 5
MEGABYTES = int(sys.argv[2]) if len(sys.argv) > 2 else 500
AUTHORITY = f"Host: localhost\r\nAuthorization: Bearer {TOKEN}\r\n"


def drip(port, count, stop):
    """Keeps `count` connections that send a byte a second: half of them send a head, half the body of an upload."""
    heads = [b"GET /healthz HTTP/1.1\r\nX-Slow: ",
             f"PUT /v1/blobs/{'0' * 64} HTTP/1.1\r\n{AUTHORITY}Content-Length: 1000000\r\n\r\n".encode()]
    selector, connections = selectors.DefaultSelector(), []

    def connect(i):
        connection = socket.create_connection(("127.0.0.1", port))
        connection.sendall(heads[i % 2])
        selector.register(connection, selectors.EVENT_READ, i)
        return connection

    connections = [connect(i) for i in range(count)]
    while not stop.wait(1):
        for key, _ in selector.select(0):  # nginx closed it: open it again
            selector.unregister(key.fileobj)
            key.fileobj.close()
            connections[key.data] = connect(key.data)
        for connection in connections:
            try:
                connection.send(b"x")
            except OSError:
                pass
    for connection in connections:
        connection.close()


def healthz_milliseconds(port, seconds):
    """Times of single requests. Every other request uses a new connection."""
    times, end, kept = [], time.monotonic() + seconds, http.client.HTTPConnection("127.0.0.1", port)
    while time.monotonic() < end:
        connection = kept if len(times) % 2 else http.client.HTTPConnection("127.0.0.1", port)
        begin = time.perf_counter()
        connection.request("GET", "/healthz")
        reply = connection.getresponse()
        reply.read()
        times.append((time.perf_counter() - begin) * 1000)
        assert reply.status == 200, reply.status
        if connection is not kept:
            connection.close()
    kept.close()
    return sorted(times)


def describe(name, times):
    print(f"{name}: p50 {times[len(times) // 2]:.1f} ms, p99 {times[len(times) * 99 // 100]:.1f} ms of {len(times)} requests")


def bench_slow_clients(front):
    describe("GET /healthz, nobody else", healthz_milliseconds(front.port, SECONDS))
    idle = [socket.create_connection(("127.0.0.1", front.port)) for _ in range(300)]
    stop = threading.Event()
    slow = threading.Thread(target=drip, args=(front.port, 50, stop))
    slow.start()
    time.sleep(2)
    describe("GET /healthz beside 300 idle and 50 dripping connections (target: p99 under 50 ms)",
             healthz_milliseconds(front.port, 2 * SECONDS))
    stop.set()
    slow.join()
    for connection in idle:
        connection.close()


def requests_per_second(url):
    text = subprocess.run(["wrk", "-t2", "-c16", f"-d{SECONDS:.0f}s", "-H", f"Authorization: Bearer {TOKEN}", url],
                          stdout=subprocess.PIPE, text=True, check=True).stdout
    assert "Non-2xx" not in text, text
    return float(re.search(r"Requests/sec:\s+([\d.]+)", text).group(1))


def compare(name, unit, ours, nginx, rounds, target):
    pairs = [(ours(), nginx()) for _ in range(rounds)]
    ratios = sorted(a / b for a, b in pairs)
    a, b = (statistics.median(column) for column in zip(*pairs))
    print(f"{name}: {a:.0f} {unit}, nginx alone {b:.0f} {unit}, ratio {statistics.median(ratios):.2f}, "
          f"of {rounds} rounds {ratios[0]:.2f} to {ratios[-1]:.2f} (target: {target})", flush=True)


def processor_seconds():
    """All seconds, and the stolen ones: a process here could run, but the host ran another guest."""
    values = [int(word) for word in Path("/proc/stat").read_text().split("\n", 1)[0].split()[1:9]]
    return sum(values) / os.sysconf("SC_CLK_TCK"), values[7] / os.sysconf("SC_CLK_TCK")


def bench_polling(front, plain_port):
    bake = front.ask("POST", "/v1/bakes", quick_request(front.put(hair_bytes()), front.put(hdr_bytes()))).json["id"]
    front.wait(bake)
    compare("GET /v1/bakes/{id}, 16 connections", "/s", lambda: requests_per_second(f"http://127.0.0.1:{front.port}/v1/bakes/{bake}"),
            lambda: requests_per_second(f"http://127.0.0.1:{plain_port}/constant"), 5, "at least 0.2")


def bytes_per_second(url):
    text = subprocess.run(["curl", "-sSf", "-o", "/dev/null", "-w", "%{size_download} %{time_total}", "-H",
                           f"Authorization: Bearer {TOKEN}", url], stdout=subprocess.PIPE, text=True, check=True).stdout
    size, seconds = text.split()
    assert int(size) == MEGABYTES << 20, text
    return int(size) / float(seconds) / 1e6


def bench_download(daemon, front, plain_port):
    data = os.urandom(1 << 20) * MEGABYTES
    digest = sha256(data)
    begin = time.monotonic()
    front.put(data)
    print(f"upload of {MEGABYTES} MB: {MEGABYTES / (time.monotonic() - begin):.0f} MB/s")
    del data
    ours = f"http://127.0.0.1:{front.port}/v1/blobs/{digest}"
    static = f"http://127.0.0.1:{plain_port}/static/{digest[:2]}/{digest}"
    compare(f"download of {MEGABYTES} MB", "MB/s", lambda: bytes_per_second(ours), lambda: bytes_per_second(static), 5, "at least 0.8")
    daemon.kill()
    daemon.start()
    print(f"the first after a restart, with its digest checked: {bytes_per_second(ours):.0f} MB/s")


def main():
    load, begin = [os.getloadavg()[0]], processor_seconds()
    plain_port = free_port()
    with Daemon(tokens=admin_token(), config="blob_mb = 4096", listen='socket = "socket"\naccel = "/blobs/"') as daemon:
        plain = (f"\nserver {{ listen 127.0.0.1:{plain_port} reuseport; default_type application/json;\n"
                 f"access_log /dev/stdout json buffer=64k flush=1s;\n"
                 f"location = /constant {{ return 200 '{'x' * 3100}'; }}\n"
                 f"location /static/ {{ alias {daemon.path}/store/blobs/; }} }}\n")
        with Front(daemon, body="4096m", more=plain) as front:
            bench_slow_clients(front)
            bench_polling(front, plain_port)
            bench_download(daemon, front, plain_port)
    load.append(os.getloadavg()[0])
    all_seconds, stolen = (now - then for now, then in zip(processor_seconds(), begin))
    print(f"the host took {100 * stolen / all_seconds:.0f} % of the processors' time for others")
    print(f"load average before and after, on {os.cpu_count()} processors: {load[0]:.1f}, {load[1]:.1f}")


main()
