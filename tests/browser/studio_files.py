"""Checks of the folder and the process: nothing is lost, nobody else works there, the right files are taken."""

from __future__ import annotations

import io
import json
import os
import signal
import socket
import subprocess
import time
from pathlib import Path
from typing import Any

from PIL import Image
from studio_bench import Bench, calibrated_from, sphere_radius
from studio_server import HOST, free_port


def ended(bench: Bench, *args: str | Path) -> tuple[int, str]:
    """Exit code and words of a studio that does not start."""
    done = subprocess.run([bench.slcal, "studio", "--no-open", *args], capture_output=True, text=True, timeout=30)
    return done.returncode, done.stderr


def a_killed_studio_goes_on_where_it_was(bench: Bench) -> None:
    with bench.calibrated("killed") as studio:
        before = studio.state()
        rig = json.loads((studio.folder / "rig.json").read_text())
        studio.kill()
    with bench.studio("killed") as studio:
        after = studio.wait("the same again", lambda s: calibrated_from(s, 2))
        for key in ("step", "photographs", "set_up", "command", "sentence"):
            assert after[key] == before[key], (key, before[key], after[key])
        assert [f["value"] for f in after["calibration"]["figures"]] == [f["value"] for f in before["calibration"]["figures"]]
        assert [(c["name"], c["points"]) for c in after["scan"]["clouds"]] == [(c["name"], c["points"]) for c in before["scan"]["clouds"]]
        assert json.loads((studio.folder / "rig.json").read_text())["camera"] == rig["camera"]
        # Killed while it works on a photograph that has just arrived.
        with studio.socket("operator") as page:
            page.send("step", step="calibrate")
            studio.wait("step calibrate", lambda s: s["step"] == "calibrate")
            page.send("photograph", id=1, used=False)
            studio.wait("one photograph left", lambda s: calibrated_from(s, 1))
            assert studio.upload(bench.sheets()[1].read_bytes()).json()["id"] == 3
        studio.kill()
    for file in (bench.folder / "killed").glob("*.json"):
        json.loads(file.read_text())
    with bench.studio("killed") as studio:
        state = studio.wait("both that are used", lambda s: calibrated_from(s, 2))
        assert [(p["id"], p["used"]) for p in state["photographs"]] == [(1, False), (2, True), (3, True)]
        assert state["step"] == "calibrate" and len(state["scan"]["clouds"]) == 1
        assert studio.interrupt() == 0


def a_folder_and_a_port_belong_to_one_studio(bench: Bench) -> None:
    with bench.real("alone") as studio:
        code, words = ended(bench, "--dir", studio.folder, "--port", str(free_port()))
        assert code == 1 and "another" in words and "--dir" in words, (code, words)
        code, words = ended(bench, "--dir", bench.folder / "beside", "--port", str(studio.port))
        assert code == 1 and f"--port {studio.port}" in words, (code, words)
        assert studio.state()["step"] == "set-up"
        assert studio.interrupt() == 0
    with socket.socket() as taken:
        taken.bind((HOST, 0))
        taken.listen()
        code, words = ended(bench, "--dir", bench.folder / "beside", "--port", str(taken.getsockname()[1]))
        assert code == 1, (code, words)
    (bench.folder / "a file").write_text("not a folder")
    code, words = ended(bench, "--dir", bench.folder / "a file")
    assert code == 1 and "folder" in words, (code, words)
    code, words = ended(bench, "--watch", bench.folder / "nowhere", "--dir", bench.folder / "beside")
    assert code == 3 and "--watch" in words, (code, words)


def interrupts_end_it_also_while_pages_are_open_and_it_works(bench: Bench) -> None:
    for sent in (signal.SIGINT, signal.SIGTERM):
        with bench.real(f"interrupted-{sent}") as studio, studio.socket("operator") as page, studio.socket("watcher"):
            page.send("camera", kind="files")
            page.send("step", step="calibrate")
            studio.wait("step calibrate", lambda s: s["step"] == "calibrate" and not s["busy"])
            studio.upload(bench.sheets()[0].read_bytes())
            studio.process.send_signal(sent)
            code = studio.process.wait(10)
            assert code == 0 or sent != signal.SIGINT, code
            assert (studio.folder / "sheet-001.png").exists()


def photographs_of_another_size_say_so(bench: Bench) -> None:
    with bench.real("sizes") as studio, studio.socket("operator") as page:
        page.send("camera", kind="files")
        page.send("step", step="calibrate")
        studio.wait("step calibrate", lambda s: s["step"] == "calibrate" and not s["busy"])
        first, second = bench.sheets()
        studio.upload(first.read_bytes())
        studio.wait("a calibration", lambda s: calibrated_from(s, 1))
        smaller = io.BytesIO()
        Image.open(second).resize((1000, 750)).save(smaller, "PNG")
        assert studio.upload(smaller.getvalue()).status == 200
        state = studio.wait("both looked at", lambda s: len(s["photographs"]) == 2 and not s["busy"])
        problem = state["photographs"][1]["problem"]
        assert problem and "1000" in problem["message"] and "1280" in problem["message"], problem
        # The calibration is what it was.
        assert state["calibration"]["photographs"] == 1 and state["problem"]["code"] == "photograph-refused", state["problem"]
        blank = io.BytesIO()
        Image.new("RGB", (1280, 960), (60, 60, 60)).save(blank, "PNG")
        studio.upload(blank.getvalue())
        state = studio.wait("all looked at", lambda s: len(s["photographs"]) == 3 and not s["busy"])
        assert state["photographs"][2]["problem"]["message"] and state["calibration"]["photographs"] == 1


def watched_folders_give_each_photograph_once(bench: Bench) -> None:
    shots = bench.folder / "shots"
    shots.mkdir()
    first, second = (p.read_bytes() for p in bench.sheets())
    (shots / "before.png").write_bytes(first)
    with bench.real("watched", "--watch", shots) as studio, studio.socket("operator") as page:
        page.send("step", step="calibrate")
        state = studio.wait("step calibrate", lambda s: s["step"] == "calibrate" and not s["busy"])
        assert state["camera"]["kind"] == "folder" and state["set_up"]["watch"] == str(shots), state["set_up"]
        elsewhere = bench.folder / "elsewhere.png"
        elsewhere.write_bytes(second)
        (shots / "link.png").symlink_to(elsewhere)
        (shots / "link to a folder").symlink_to(bench.folder)
        os.mkfifo(shots / "pipe.png")
        (shots / ".hidden.png").write_bytes(second)
        (shots / "notes.txt").write_text("not a photograph")
        (shots / "a folder.png").mkdir()
        slowly(shots / "DSC_0001.PNG", first, 4, 0.5)
        studio.wait("the photograph", lambda s: calibrated_from(s, 1))
        slowly(shots / "DSC_0002.PNG", second, 2, 0.5)
        studio.wait("the second", lambda s: calibrated_from(s, 2))
        # Touched, and written once more as it was.
        os.utime(shots / "DSC_0001.PNG")
        time.sleep(2.0)
        state = studio.state()
        assert [p["problem"] for p in state["photographs"]] == [None, None], state["photographs"]
        assert (studio.folder / "sheet-001.png").read_bytes() == first and (studio.folder / "sheet-002.png").read_bytes() == second
        assert not studio.complaints.read_text(), studio.complaints.read_text()


def watched_photographs_that_come_too_early_are_kept(bench: Bench) -> None:
    shots = bench.folder / "early"
    shots.mkdir()
    photo = bench.sheets()[0].read_bytes()
    with bench.real("too-early", "--watch", shots) as studio, studio.socket("operator") as page:
        studio.wait("patterns", lambda s: not s["busy"])
        (shots / "DSC_0001.PNG").write_bytes(photo)
        time.sleep(2.0)
        assert not studio.state()["photographs"]
        page.send("step", step="calibrate")
        studio.wait("the photograph", lambda s: calibrated_from(s, 1), 20)


def slowly(path: Path, data: bytes, parts: int, pause_s: float) -> None:
    """Writes a file as a camera does."""
    with path.open("wb") as file:
        for i in range(parts):
            file.write(data[len(data) * i // parts: len(data) * (i + 1) // parts])
            file.flush()
            time.sleep(pause_s)


def commands_of_the_log_do_the_same(bench: Bench) -> None:
    """What commands.txt says, in the folder, gives the same rig and the same cloud."""
    source, copy = bench.finished.folder, bench.folder / "again"
    copy.mkdir()
    lines = (source / "commands.txt").read_text().splitlines()
    for name in ("sheet-001.png", "sheet-002.png", "scan-001.png", "checker.json", "stripes.json"):
        (copy / name).write_bytes((source / name).read_bytes())
    last: dict[str, str] = {}
    for line in lines:
        last[line.split()[1]] = line
    for verb in ("calibrate", "reconstruct"):
        command = f"'{bench.slcal}' -q {last[verb].removeprefix('slcal ')}"
        done = subprocess.run(command, shell=True, cwd=copy, capture_output=True, text=True)
        assert done.returncode == 0, (command, done.stderr)
    same: list[Any] = [json.loads((folder / "rig.json").read_text()) for folder in (source, copy)]
    assert same[0]["camera"] == same[1]["camera"] and same[0]["projector_from_camera"] == same[1]["projector_from_camera"]
    assert (source / "scan-001.ply").stat().st_size == (copy / "scan-001.ply").stat().st_size


def the_scanned_sphere_has_its_radius(bench: Bench) -> None:
    radius = sphere_radius(bench.finished.folder / "scan-001.ply")
    assert abs(radius / 180.0 - 1.0) < 0.005, radius


CHECKS = (
    a_killed_studio_goes_on_where_it_was, a_folder_and_a_port_belong_to_one_studio,
    interrupts_end_it_also_while_pages_are_open_and_it_works, photographs_of_another_size_say_so,
    watched_folders_give_each_photograph_once, watched_photographs_that_come_too_early_are_kept,
    commands_of_the_log_do_the_same, the_scanned_sphere_has_its_radius,
)
