# SPDX-License-Identifier: Apache-2.0
# labels: none
"""`standoff view` and `standoff fly --view` as servers: who is answered, what ends them, and that nothing is left."""

import json
import os
import pathlib
import signal
import socket
import sys
import time
import urllib.error
import urllib.request

from program import run
from viewing import MESH, expect, failures, served

here = pathlib.Path.cwd()
temporary = here / "tmp"


def served_here(*arguments):
    """Its temporary files are in a folder of their own, and there is no screen."""
    environment = {**os.environ, "TMPDIR": str(temporary)}
    environment.pop("DISPLAY", None)
    return served(*arguments, environment=environment)


def ask(address, method="GET", body=None, **headers):
    """The status and the body of an answer."""
    request = urllib.request.Request(address, method=method, data=body, headers=headers)
    try:
        with urllib.request.urlopen(request, timeout=30) as answer:
            return answer.status, answer.read()
    except urllib.error.HTTPError as error:
        return error.code, error.read()


def raw(address, request):
    host, port = address.split("/")[2].split(":")
    with socket.create_connection((host, int(port)), timeout=30) as client:
        client.sendall(request)
        client.shutdown(socket.SHUT_WR)
        heard = b""
        while part := client.recv(65536):
            heard += part
    return heard


def strangers_are_refused(address):
    home, token = address.rsplit("/", 2)[0], address.rsplit("/", 2)[1]
    expect(address.startswith("http://127.0.0.1:") and len(token) == 32, "the address is on loopback and has a long token")
    expect(ask(address)[0] == 200, "the page is there")
    for wrong in (home + "/", f"{home}/{token}", f"{home}/{token[:-1]}x/state", f"{home}/state", f"{home}/{token.upper()}/"):
        expect(ask(wrong)[0] == 403, f"no answer without the token: {wrong}")
    for host in ("rebound.example", "127.0.0.1.rebound.example", "0.0.0.0"):
        expect(ask(address, Host=host)[0] == 403, f"no answer to {host}")
    expect(ask(address + "state", Origin="http://other.example")[0] == 403, "no answer to other origins")
    expect(ask(address + "state", Origin="null")[0] == 403, "no answer to pages without origin")
    expect(ask(address + "compute", "GET")[0] == 405, "what changes something is a POST")
    expect(ask(address + "state", "PUT")[0] == 405, "no other methods")
    for path in ("../../../etc/passwd", "%2e%2e/%2e%2e/etc/passwd", "data?id=../../etc/passwd", "data?id=/etc/passwd", "data"):
        status, body = ask(address + path)
        expect(status in (403, 404, 422) and b"root:" not in body, f"there are no files: {path}")
    expect(raw(address, b"GET / HTTP/1.0\r\n\r\n").startswith(b"HTTP/1.1 505"), "other versions are refused")
    expect(raw(address, b"\x16\x03\x01\x02\x00\x01\x00\x01\xfc\x03\x03").startswith(b""), "TLS is not understood, and harms nothing")
    expect(ask(address)[0] == 200, "the page is still there")


def fields_are_computed(address):
    good = "compute?resolution=16&thickness=0.3&sign=auto&device=cpu"
    status, body = ask(address + good, "POST", b"")
    expect(status == 200 and len(body) > 100, "a field is computed")
    for bad in ("compute", good.replace("16", "1"), good.replace("16", "100000"), good.replace("0.3", "-1"), good.replace("0.3", "nan"),
                good.replace("auto", "best"), good.replace("auto", "shell:1"), good.replace("cpu", "cuda:x"), good.replace("16", "16&x=%zz")):
        status, body = ask(address + bad, "POST", b"")
        expect(status in (400, 422) and body, f"{bad}: {status}")
    status, body = ask(address + "point?at=-1,0.2,0.2")
    answer = json.loads(body)
    expect(status == 200 and abs(answer["distance"] - 1) < 1e-12 and abs(answer["gradient"][0] + 1) < 1e-12, "a point's distance is exact")
    for bad in ("point", "point?at=1,2", "point?at=nan,0,0", "point?at=1e300,0,0", "point?at=a"):
        expect(ask(address + bad)[0] == 422, f"{bad} is an error")


def meshes_are_dropped(address):
    name = "%3Cimg%20src=x%20onerror=alert(1)%3E.off"
    off = "OFF\n4 4 0\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n3 0 2 1\n3 0 1 3\n3 0 3 2\n3 1 2 3\n".encode()
    status, body = ask(f"{address}upload?name={name}", "POST", off)
    live = json.loads(body)["live"]
    expect(status == 200 and live["triangles"] == 4 and live["name"] == "<img src=x onerror=alert(1)>.off", "a mesh is dropped")
    for bad, content in (("a.exe", off), ("a", off), ("..%2f..%2fa", off), ("a.off", b"OFF\n9 9 9\n"), ("a.ply", b"\0" * 1000), ("a.off", b"")):
        status, body = ask(f"{address}upload?name={bad}", "POST", content)
        expect(status == 422 and b"standoff-" not in body and str(temporary).encode() not in body, f"{bad}: {status} {body}")
    expect(json.loads(ask(address + "state")[1])["live"]["name"] == live["name"], "what cannot be read changes nothing")
    expect(not list(temporary.iterdir()), "no file is left of what was dropped")


def ends_with_the_page(program, address):
    host, port = address.split("/")[2].split(":")
    path = address.split(port, 1)[1]
    page = socket.create_connection((host, int(port)), timeout=30)
    page.sendall(f"GET {path}events HTTP/1.1\r\nHost: localhost\r\n\r\n".encode())
    page.recv(100)
    time.sleep(0.3)
    expect(program.poll() is None, "the program runs while the page is open")
    page.close()
    expect(program.wait(30) == 0, "it ends once the page is closed")


def main():
    temporary.mkdir()
    (here / "a.obj").write_text(MESH)
    with served_here("view", "a.obj", "-r", "16", "--no-browser") as (program, address):
        strangers_are_refused(address)
        fields_are_computed(address)
        meshes_are_dropped(address)
        program.send_signal(signal.SIGINT)
        expect(program.wait(30) == 0, "Ctrl-C ends it")
    with served_here("view", "a.obj", "-r", "16") as (program, address):  # without a screen no browser is opened
        ends_with_the_page(program, address)
    with served_here("fly", "--view", "--labyrinth", "scene:labyrinth:3000", "--fly", "a.obj", "--flies", "3", "--no-browser") as (program, address):
        for changed in ("mode=thesis", "speed=5", "flies=7", "rate=600"):
            expect(ask(f"{address}controls?{changed}", "POST", b"")[0] == 200, f"{changed} is changed")
        for bad in ("mode=other", "speed=-1", "speed=nan", "flies=0", "flies=100000", "rate=-1", "rate=1e99"):
            expect(ask(f"{address}controls?{bad}", "POST", b"")[0] == 422, f"{bad} is an error")
        program.send_signal(signal.SIGTERM)
        expect(program.wait(30) == 0, "a signal ends it")
    expect(not list(temporary.iterdir()), "nothing is left")
    taken = socket.create_server(("127.0.0.1", 0))
    run("view", "a.obj", "--port", taken.getsockname()[1], "--no-browser", code=2, says="cannot be had")
    sys.exit(1 if failures else 0)


main()
