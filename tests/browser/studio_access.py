"""Checks of who may do what, without a browser: requests that no page of the studio would send."""

from __future__ import annotations

import errno
import http.client
import io
import socket
import struct
import time
import zlib
from pathlib import Path
from typing import Any

from PIL import Image
from studio_bench import Bench
from studio_server import HOST, Skipped, Studio, refused_socket

MB = 1 << 20
ROLES = ("operator", "display", "camera", "watcher")
PAGES = ("/", "/display", "/camera", "/web/style.css", "/web/studio.js", "/web/cloud_view.js")
DATA = ("/api/state", "/api/live.jpg", "/api/shown.png", "/api/photographs/1.jpg", "/api/scans/1.jpg", "/api/clouds/1", "/api/clouds/1.ply",
        "/api/clouds/1.glb", "/api/cloud/live", "/report", "/api/exports/opencv")
SHUT_TO_CAMERA = [path for path in DATA if path != "/api/state"]
POSTS = ("/api/photographs", "/api/picture", "/api/painted")


def settled(studio: Studio) -> Any:
    """What a request could have changed: the state as the operator is told it, and the folder."""
    state = studio.wait("nothing under way", lambda s: not s["busy"])
    del state["others"]
    return state, contents(studio.folder)


def contents(folder: Path) -> dict[str, int]:
    return {str(p.relative_to(folder)): p.stat().st_size for p in sorted(folder.rglob("*")) if p.is_file()}


def no_token_or_a_wrong_one_opens_nothing(bench: Bench) -> None:
    studio = bench.finished
    before = settled(studio)
    for token in ("", "0" * 32, studio.token("operator")[:-1], studio.token("operator").upper() + " "):
        answer = studio.session(token)
        assert answer.status == 403 and answer.code == "token-wrong" and "set-cookie" not in answer.headers, answer
    assert studio.request("POST", "/api/session", b"not json").status == 400
    for path in PAGES:
        assert studio.request("GET", path).status == 200, path
    for cookie in (None, "slcal=1", f"slcal-{studio.port}-operator={'0' * 32}"):
        for path in DATA:
            answer = studio.request("GET", f"{path}?as=operator", Cookie=cookie)
            assert answer.status == 403, (path, cookie, answer)
        for path in POSTS:
            answer = studio.request("POST", f"{path}?as=operator", b"x", Cookie=cookie)
            assert answer.status == 403, (path, cookie, answer)
        assert refused_socket(studio, "operator", cookie=cookie or "") == 403
    assert settled(studio) == before


def answers_carry_what_keeps_browsers_safe(bench: Bench) -> None:
    with bench.real("headers") as studio:
        for path in (*PAGES, "/nothing", "/api/state"):
            headers = studio.request("GET", path).headers
            policy = headers["content-security-policy"]
            for part in ("default-src 'none'", "script-src 'self'", "connect-src 'self'", "frame-ancestors 'none'", "form-action 'none'"):
                assert part in policy, (path, policy)
            assert "unsafe" not in policy and headers["referrer-policy"] == "no-referrer", (path, headers)
            assert headers["x-content-type-options"] == "nosniff" and headers["cache-control"] == "no-store", (path, headers)
        cookie = studio.session(studio.token("watcher")).headers["set-cookie"]
        assert "HttpOnly" in cookie and "SameSite=Strict" in cookie and studio.token("watcher") not in cookie, cookie
        tokens = {studio.token(role) for role in ("operator", "display", "watcher")}
        assert len(tokens) == 3 and all(len(bytes.fromhex(token)) == 16 for token in tokens)


def foreign_hosts_and_origins_are_refused(bench: Bench) -> None:
    photo = bench.sheets()[0].read_bytes()
    with bench.real("foreign") as studio:
        studio.cookie("operator")
        before = settled(studio)
        own, port = studio.origin, studio.port
        origins = (None, "", "null", "http://evil.example", f"http://evil.example:{port}", f"https://{studio.host}", f"http://{HOST}",
                   f"http://localhost:{port}", f"{own}.evil.example", f"http://{HOST}:{port + 1}")
        for origin in origins:
            assert studio.session(studio.token("operator"), Origin=origin).status == 403, origin
            for path in POSTS:
                assert studio.request("POST", path, photo, "operator", Origin=origin).status == 403, (path, origin)
            assert refused_socket(studio, "operator", origin=origin or "") == 403, origin
        for host in ("evil.example", f"evil.example:{port}", HOST, f"{HOST}:{port + 1}", "", f"{HOST}.evil.example:{port}"):
            for path in ("/", "/api/state", "/web/studio.js"):
                status = studio.request("GET", path, role="operator", Host=host).status
                assert status in {400, 403}, (path, host, status)
            origin = f"http://{host}"
            assert studio.request("POST", "/api/photographs", photo, "operator", Host=host, Origin=origin).status in {400, 403}, host
            if host:
                assert refused_socket(studio, "operator", host=host, origin=origin) == 403, host
        assert studio.request("GET", "/", Host=f"localhost:{port}").status == 200
        assert settled(studio) == before
        # What is refused for its origin is not refused for anything else.
        assert refused_socket(studio, "operator") == 101


def every_role_keeps_to_what_it_may(bench: Bench) -> None:
    photo = bench.sheets()[0].read_bytes()
    studio = bench.finished
    before = settled(studio)
    for role in ROLES:
        if role == "camera" and not studio.addresses["camera"]:
            continue
        for other in ROLES:
            if other != role:
                assert studio.request("GET", f"/api/state?as={other}", Cookie=studio.cookie(role)).status == 403, (role, other)
                assert refused_socket(studio, other, cookie=studio.cookie(role)) == 403, (role, other)
    for role in ("watcher", "display"):
        assert studio.upload(photo, role=role).status == 403, role
        assert studio.request("POST", "/api/picture", photo, role).status == 403, role
        secrets = studio.state(role)
        assert secrets["links"] is None and not secrets["you"]["operating"], (role, secrets["links"])
        for path in ("/api/photographs/1.jpg", "/api/clouds/1", "/report"):
            assert studio.request("GET", path, role=role).status == 200, (role, path)
    assert studio.state("watcher")["dir"] is None
    for role in ("watcher", "operator"):
        assert studio.request("POST", "/api/painted?sequence=1", photo, role).status == 403, role
    for role in ("watcher", "display"):
        with studio.socket(role) as page:
            page.receive("state")
            for event in ({"event": "step", "step": "use"}, {"event": "take-over"}, {"event": "photograph", "id": 1, "used": False},
                          {"event": "set-up", "size": "A4"}, {"event": "take"}, {"event": "camera", "kind": "phone"}):
                page.send(**event)
            page.frame(1, photo)
    with studio.socket("operator") as first, studio.socket("operator") as second:
        assert first.receive("state")["state"]["you"]["operating"]
        assert not second.receive("state")["state"]["you"]["operating"]
        second.send("step", step="use")
        assert second.receive("refused")["problem"]["code"] == "not-operating"
        for nonsense in ('{"event": "format-disk"}', "[]", "", "\u0000", '{"event": "step", "step": "moon"}'):
            second.socket.send(nonsense)
            assert second.receive("refused")["problem"]["code"] == "malformed", nonsense
    time.sleep(0.2)
    assert settled(studio) == before


def the_phone_uploads_and_nothing_else(bench: Bench) -> None:
    photo = bench.sheets()[0].read_bytes()
    with bench.real("phone", "--lan") as studio:
        if not studio.addresses["camera"]:
            raise Skipped("this machine has no address in a network")
        with studio.socket("operator") as page:
            page.send("camera", kind="phone")
            page.send("step", step="calibrate")
            studio.wait("step calibrate", lambda s: s["step"] == "calibrate" and not s["busy"])
            for path in SHUT_TO_CAMERA:
                assert studio.request("GET", path, role="camera").status == 403, path
            for path in ("/api/picture", "/api/painted"):
                assert studio.request("POST", path, photo, "camera").status == 403, path
            told = studio.state("camera")
            assert told.get("links") is None and told.get("dir") is None
            with studio.socket("camera") as phone:
                phone.send("step", step="set-up")
                answer = studio.upload(photo, "IMG_0001.JPG", "camera")
                assert answer.status == 200 and answer.json() == {"id": 1, "scan": False}, answer
                phone.receive("state", lambda m: m["state"]["photographs"] and not m["state"]["photographs"][0]["problem"])
            assert studio.state()["step"] == "calibrate"


def nothing_changes_by_get(bench: Bench) -> None:
    studio = bench.finished
    before = settled(studio)
    for path in (*PAGES, *DATA):
        for role in ROLES[:2]:
            studio.request("GET", f"{path}{'&' if '?' in path else '?'}event=step&step=use&used=false&id=1", role=role)
    for method in ("GET", "HEAD", "DELETE", "PUT", "PATCH", "OPTIONS"):
        for path in (*POSTS, "/api/session"):
            status = studio.request(method, path, role="operator").status
            assert status in {403, 404, 405}, (method, path, status)
    assert settled(studio) == before


def large_uploads_are_refused(bench: Bench) -> None:
    studio = bench.finished
    before = settled(studio)
    for path in POSTS[:2]:
        answer = studio.request("POST", path, bytes(55 * MB), "operator")
        assert answer.status == 413 and answer.code == "too-large", answer
        assert "50 MB" in answer.json()["error"]["message"], answer
    # Without saying beforehand how much comes.
    assert chunked(studio, 55) == 413
    assert settled(studio) == before
    assert studio.request("POST", "/api/session", b" " * MB).status == 413


def chunked(studio: Studio, megabytes: int) -> int:
    """The status of an upload of unknown length."""
    connection = http.client.HTTPConnection(HOST, studio.port, timeout=60)
    headers = {"Origin": studio.origin, "Cookie": studio.cookie("operator"), "Transfer-Encoding": "chunked"}
    connection.putrequest("POST", "/api/photographs?as=operator")
    for name, value in headers.items():
        connection.putheader(name, value)
    connection.endheaders()
    try:
        for _ in range(megabytes):
            connection.send(b"%x\r\n" % MB + bytes(MB) + b"\r\n")
        connection.send(b"0\r\n\r\n")
    except (BrokenPipeError, ConnectionResetError):
        pass
    status = connection.getresponse().status
    connection.close()
    return status


def what_is_no_photograph_is_refused(bench: Bench) -> None:
    photo = bench.sheets()[0].read_bytes()
    studio = bench.finished
    before = settled(studio)
    for name, body, status in (
        ("notes.txt", b"a text file\n" * 100, 415), ("photo.jpg", b"a text file\n" * 100, 415), ("empty.jpg", b"", 415),
        ("moving.gif", b"GIF89a" + bytes(100), 415), ("page.svg", b"<svg xmlns='http://www.w3.org/2000/svg'/>", 415),
        ("cut.png", photo[: len(photo) // 2], 422), ("head.jpg", b"\xff\xd8\xff\xe0\0\x10JFIF" + bytes(50), 422),
        ("vast.png", vast_png(), 422),
    ):
        answer = studio.upload(body, name)
        assert answer.status == status, (name, answer)
        error = answer.json()["error"]
        assert error["message"] and error["code"], error
        assert answer.headers["content-type"] == "application/json"
    assert settled(studio) == before


def vast_png() -> bytes:
    """A small file that claims 100,000 x 100,000 px."""
    def chunk(kind: bytes, data: bytes) -> bytes:
        return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))

    head = struct.pack(">IIBBBBB", 100_000, 100_000, 8, 2, 0, 0, 0)
    return b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", head) + chunk(b"IDAT", zlib.compress(bytes(10_000))) + chunk(b"IEND", b"")


def names_of_uploads_never_become_paths(bench: Bench) -> None:
    photo = bench.sheets()[0].read_bytes()
    outside = bench.folder / "names"
    outside.mkdir()
    with bench.real("names/project") as studio, studio.socket("operator") as page:
        page.send("camera", kind="files")
        page.send("step", step="calibrate")
        studio.wait("step calibrate", lambda s: s["step"] == "calibrate" and not s["busy"])
        names = ("../../x.jpg", "/etc/x.jpg", "..\\..\\x.jpg", "rig.json", ".slcal-studio.lock", "a\0b.jpg", "x" * 5000, "", "<img src=x>.jpg")
        for n, name in enumerate(names, 1):
            answer = studio.upload(photo, name)
            assert answer.status == 200 and answer.json()["id"] == n, (name, answer)
        studio.wait("all of them looked at", lambda s: len(s["photographs"]) == len(names) and not s["busy"], 120)
        kept = [p["name"] for p in studio.state()["photographs"]]
        assert kept == [f"sheet-{n:03}.png" for n in range(1, len(names) + 1)], kept
        assert all((studio.folder / name).read_bytes() == photo for name in kept)
        assert [p.name for p in outside.iterdir() if p != studio.folder and p != studio.complaints] == []
        for path in ("/api/photographs/../rig.json", "/api/photographs/..%2Frig.json", "/web/..%2F..%2Fmain.rs", "/api/clouds/..%2F..%2Fx",
                     "/api/photographs/%2e%2e%2frig.json", "/api/exports/..%2F..%2Fx"):
            assert studio.request("GET", path, role="operator").status == 404, path


def photographs_are_served_without_what_the_camera_wrote(bench: Bench) -> None:
    picture = Image.open(bench.sheets()[0])
    exif = Image.Exif()
    exif[0x010F], exif[0x9286] = "Maker", "a secret place"
    kept = io.BytesIO()
    picture.save(kept, "JPEG", quality=95, exif=exif, comment=b"a secret place")
    with bench.real("exif") as studio, studio.socket("operator") as page:
        page.send("camera", kind="files")
        page.send("step", step="calibrate")
        studio.wait("step calibrate", lambda s: s["step"] == "calibrate" and not s["busy"])
        assert studio.upload(kept.getvalue()).status == 200
        assert (studio.folder / "sheet-001.jpg").read_bytes() == kept.getvalue(), "kept as it came"
        for query in ("", "?width=320"):
            served = studio.request("GET", f"/api/photographs/1.jpg{query}", role="operator").body
            assert b"secret" not in served and not Image.open(io.BytesIO(served)).getexif(), query


def loopback_alone_is_served(bench: Bench) -> None:
    with bench.real("loopback") as studio:
        other = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        try:
            other.connect(("192.0.2.1", 9))
            address = other.getsockname()[0]
        except OSError:
            raise Skipped("this machine has no address in a network") from None
        finally:
            other.close()
        if address.startswith("127."):
            raise Skipped("this machine has no address in a network")
        with socket.socket() as knock:
            knock.settimeout(2)
            assert knock.connect_ex((address, studio.port)) != 0, f"answers at {address}"


def slow_heads_lock_nobody_out(bench: Bench) -> None:
    with bench.real("slow") as studio:
        slow = [socket.socket() for _ in range(200)]
        try:
            for one in slow:
                # Another machine, as far as the server can tell.
                one.bind(("127.0.0.2", 0))
                one.connect((HOST, studio.port))
                one.sendall(b"GET / HTTP/1.1\r\nHost: ")
                one.setblocking(False)
            begin, left = time.monotonic(), slow
            while left:
                assert time.monotonic() - begin < 30, f"{len(left)} heads that never end are still open"
                asked = time.monotonic()
                assert studio.request("GET", "/api/state", role="operator").status == 200
                assert time.monotonic() - asked < 5, "a page waits for the heads of others"
                left = [one for one in left if drips(one)]
                time.sleep(0.5)
        except OSError as unbound:
            if unbound.errno == errno.EADDRNOTAVAIL:
                raise Skipped("this machine has one loopback address") from None
            raise
        finally:
            for one in slow:
                one.close()


def drips(connection: socket.socket) -> bool:
    """Sends one byte more of a head; whether the other side is still there."""
    try:
        connection.send(b"x")
        return connection.recv(1024) != b""
    except BlockingIOError:
        return True
    except (BrokenPipeError, ConnectionResetError):
        return False


CHECKS = (
    no_token_or_a_wrong_one_opens_nothing, answers_carry_what_keeps_browsers_safe, foreign_hosts_and_origins_are_refused,
    every_role_keeps_to_what_it_may, the_phone_uploads_and_nothing_else, nothing_changes_by_get, large_uploads_are_refused,
    what_is_no_photograph_is_refused, names_of_uploads_never_become_paths, photographs_are_served_without_what_the_camera_wrote,
    loopback_alone_is_served, slow_heads_lock_nobody_out,
)
