"""`slcal studio` as a process, and requests to it that no page would send."""

from __future__ import annotations

import http.client
import json
import signal
import socket
import subprocess
import time
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any, TypeVar
from urllib.parse import urlencode, urlsplit

import websocket

HOST = "127.0.0.1"
PATIENCE_S = 60.0
"""A busy machine may take long; what takes longer hangs."""
SOON_S = 0.05

Found = TypeVar("Found")


class Skipped(Exception):
    """What cannot be checked on this machine, and why."""


def wait_until(what: str, found: Callable[[], Found | None], patience_s: float = PATIENCE_S) -> Found:
    """What `found` returns, as soon as that is something."""
    end = time.monotonic() + patience_s
    while True:
        value = found()
        if value:
            return value
        if time.monotonic() > end:
            raise AssertionError(f"not within {patience_s:.0f} s: {what}")
        time.sleep(SOON_S)


def free_port() -> int:
    """A port that nobody uses at the moment."""
    with socket.socket() as found:
        found.bind((HOST, 0))
        return int(found.getsockname()[1])


@dataclass
class Answer:
    """What the server answered."""

    status: int
    headers: dict[str, str]
    body: bytes

    def json(self) -> Any:
        return json.loads(self.body)

    @property
    def code(self) -> str:
        """The name of the error; empty where there is none."""
        return str(self.json()["error"]["code"]) if self.status >= 400 else ""


class Studio:
    """A studio that runs until it is ended."""

    def __init__(self, slcal: Path, folder: Path, *args: str, port: int | None = None) -> None:
        self.slcal, self.folder = slcal, folder
        self.port = port or free_port()
        self.host = f"{HOST}:{self.port}"
        self.origin = f"http://{self.host}"
        self.complaints = folder.with_name(f"{folder.name}.stderr")
        with self.complaints.open("ab") as errors:
            # As a terminal starts it, whatever is ignored here (`nohup`, a shell's `&`).
            signal.signal(signal.SIGINT, signal.default_int_handler)
            self.process = subprocess.Popen(
                [slcal, "studio", "--no-open", "--json", "--dir", folder, "--port", str(self.port), *args],
                stdout=subprocess.PIPE, stderr=errors, text=True)
        self.addresses: dict[str, Any] = json.loads(self._printed())
        self.cookies: dict[str, str] = {}

    def _printed(self) -> str:
        """The JSON document that it prints before it serves."""
        assert self.process.stdout
        lines = []
        for line in self.process.stdout:
            lines.append(line)
            if line.rstrip() == "}":
                return "".join(lines)
        raise AssertionError(f"no addresses; exit {self.process.wait()}: {self.complaints.read_text()}")

    def __enter__(self) -> Studio:
        return self

    def __exit__(self, *_: object) -> None:
        self.kill()

    def kill(self) -> None:
        """As kill -9 does."""
        self.process.kill()
        self.process.wait()

    def interrupt(self) -> int:
        """As Ctrl-C does; the exit code."""
        self.process.send_signal(signal.SIGINT)
        return self.process.wait(10)

    def link(self, role: str) -> str:
        """The address of a role's page, with its token."""
        return str(self.addresses[role])

    def token(self, role: str) -> str:
        return urlsplit(self.link(role)).fragment

    def request(self, method: str, path: str, body: bytes | None = None, role: str | None = None,
                **headers: str | None) -> Answer:
        """A request as a page of that role sends it. `headers` replace those of a page; None leaves one out."""
        sent: dict[str, str | None] = {"Host": self.host}
        if method != "GET":
            sent["Origin"] = self.origin
        if role:
            sent["Cookie"] = self.cookie(role)
            path += ("&" if "?" in path else "?") + urlencode({"as": role})
        sent.update(headers)
        connection = http.client.HTTPConnection(HOST, self.port, timeout=PATIENCE_S)
        try:
            connection.putrequest(method, path, skip_host=True, skip_accept_encoding=True)
            if body is not None:
                sent.setdefault("Content-Length", str(len(body)))
            for name, value in sent.items():
                if value is not None:
                    connection.putheader(name, value)
            connection.endheaders()
            # A server that refuses by the length alone hangs up before all was sent.
            try:
                connection.send(body or b"")
            except (BrokenPipeError, ConnectionResetError):
                pass
            answer = connection.getresponse()
            return Answer(answer.status, {k.lower(): v for k, v in answer.getheaders()}, answer.read())
        finally:
            connection.close()

    def session(self, token: str, **headers: str | None) -> Answer:
        return self.request("POST", "/api/session", json.dumps({"token": token}).encode(), **headers)

    def cookie(self, role: str) -> str:
        if role not in self.cookies:
            answer = self.session(self.token(role))
            assert answer.status == 200 and answer.json() == {"role": role}, answer
            self.cookies[role] = answer.headers["set-cookie"].split(";")[0]
        return self.cookies[role]

    def state(self, role: str = "operator") -> Any:
        answer = self.request("GET", "/api/state", role=role)
        assert answer.status == 200, answer
        return answer.json()

    def wait(self, what: str, found: Callable[[Any], Any], patience_s: float = PATIENCE_S) -> Any:
        """The state, as soon as it is as wanted."""
        def seen() -> Any:
            state = self.state()
            return state if found(state) else None

        try:
            return wait_until(what, seen, patience_s)
        except AssertionError as error:
            state = self.state()
            keys = ("step", "busy", "problem", "sentence", "next", "auto_shot", "display", "camera", "guide", "demo_scene", "photographs", "others")
            brief = "\n    ".join(f"{key}: {json.dumps(state[key])}" for key in keys)
            raise AssertionError(f"{error}\n    {brief}\n    live: {self._looked()}") from None

    def _looked(self) -> str:
        """What was found in the next live frame."""
        try:
            with self.socket("watcher") as page:
                live = page.receive("live", patience_s=3)["live"]
                return json.dumps({**live, "corners": len(live["corners"])})
        except AssertionError as error:
            return str(error)

    def upload(self, body: bytes, name: str = "photograph.jpg", role: str = "operator", **headers: str | None) -> Answer:
        return self.request("POST", f"/api/photographs?{urlencode({'name': name})}", body, role, **headers)

    def socket(self, role: str, cookie: str | None = None, origin: str | None = None, host: str | None = None) -> Socket:
        return Socket(self, role, cookie, origin, host)


class Socket:
    """The connection of a page, without a page."""

    def __init__(self, studio: Studio, role: str, cookie: str | None, origin: str | None, host: str | None) -> None:
        options: dict[str, Any] = {"suppress_origin": True} if origin == "" else {"origin": origin or studio.origin}
        self.socket = websocket.create_connection(
            f"ws://{studio.host}/ws?as={role}", timeout=PATIENCE_S, host=host or studio.host,
            cookie=studio.cookie(role) if cookie is None else cookie, **options)

    def __enter__(self) -> Socket:
        return self

    def __exit__(self, *_: object) -> None:
        self.socket.close()

    def send(self, event: str, **more: Any) -> None:
        self.socket.send(json.dumps({"event": event, **more}))

    def frame(self, seq: int, jpeg: bytes) -> None:
        """A live frame."""
        self.socket.send_binary(seq.to_bytes(4, "little") + bytes(4) + jpeg)

    def receive(self, kind: str, found: Callable[[Any], Any] = lambda _: True, patience_s: float = PATIENCE_S) -> Any:
        """The next message of a kind that is as wanted."""
        end = time.monotonic() + patience_s
        while time.monotonic() < end:
            self.socket.settimeout(max(0.01, end - time.monotonic()))
            try:
                # Pings are handed over as well: a studio that only pings does not make this wait for ever.
                opcode, data = self.socket.recv_data(control_frame=True)
            except websocket.WebSocketTimeoutException:
                break
            if opcode == websocket.ABNF.OPCODE_CLOSE:
                raise AssertionError("the studio has closed the connection")
            if opcode != websocket.ABNF.OPCODE_TEXT:
                continue
            message = json.loads(data)
            if message["type"] == kind and found(message):
                return message
        raise AssertionError(f"no message of the kind {kind} within {patience_s:.1f} s")


def refused_socket(studio: Studio, role: str, **options: str) -> int:
    """The status with which a connection is refused; 101 where it is not."""
    try:
        with studio.socket(role, **options):
            return 101
    except websocket.WebSocketBadStatusException as error:
        return int(error.status_code)
