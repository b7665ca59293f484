"""Checks of scans by many photographs, in the pages, with the simulated camera."""

from __future__ import annotations

import shlex
import time
from typing import Any

from studio_bench import Bench, calibrated_from, quiet, sphere_radius
from studio_demo import cloud_is_drawn, sphere_is_right, turned_and_taken
from studio_pages import Browser, Operator, selected
from studio_server import Studio, wait_until

FRAMES = {"gray": 22, "phase": 24}
"""White, black, the bits of 1024 columns with their inverses; or fewer bits and eight steps."""

METHODS = ("phase",)
"""Gray code goes the same way; the simulated camera takes two seconds for a photograph."""


def scanned(studio: Studio, page: Operator, method: str, count: int) -> tuple[Any, float]:
    """A scan by one click, and how long it took."""
    page.press("scan-method", method=method)
    studio.wait("the method", lambda s: s["scan"]["method"] == method)
    begun = time.monotonic()
    page.press("scan", mode="once")
    shots = studio.wait("a few photographs", lambda s: s["scan"]["shots"] and s["scan"]["shots"]["frame"] >= 7, 120)["scan"]["shots"]
    assert shots["of"] == FRAMES[method] and not shots["by_hand"], shots
    wait_until("the page says how far it is", lambda: int(page.run("return document.querySelector('[data-state=shots]')?.dataset.frame ?? 0")) >= 7)
    assert f"of {FRAMES[method]}" in page.text("[data-state=shots]")
    page.keep(f"20-{method}-under-way")
    state = studio.wait("its cloud", lambda s: len(s["scan"]["clouds"]) == count and not s["busy"], 240)
    return state, time.monotonic() - begun


def a_sequence_is_shown_photographed_and_reconstructed_by_one_click(bench: Bench, b: Browser) -> None:
    with bench.studio("sequence", "--demo") as studio:
        with quiet(b, studio):
            page = b.window(studio.link("operator"))
            page.pictures = bench.pictures
            b.opened_by(lambda: page.press("open-display"))
            page.press("go-on", step="calibrate")
            turned_and_taken(studio, page, 1)
            turned_and_taken(studio, page, 2)
            page.press("go-on", step="scan")
            for n, method in enumerate(METHODS, 1):
                state, seconds = scanned(studio, page, method, n)
                entry = state["scan"]["clouds"][-1]
                assert entry["frames"] == FRAMES[method] and not entry["warnings"], entry
                shown = cloud_is_drawn(page)
                page.keep(f"21-{method}-cloud")
                folder = studio.folder / f"scan-00{n}"
                assert len(list(folder.glob("frame_*.jpg"))) == FRAMES[method] and (folder / "sequence.json").exists()
                radius = sphere_is_right(bench, studio.folder / entry["name"])
                bench.figure(f"{method}: {FRAMES[method]} photographs and a cloud of {shown} points in {seconds:.0f} s, "
                             f"delay {state['camera']['latency_ms']} ms; sphere {radius:.2f} mm")
                same_by_command(bench, studio, entry["name"])
                for form in ("ply", "glb", "pcd", "obj"):
                    saved = studio.request("GET", f"/api/clouds/{entry['id']}.{form}", role="operator")
                    assert saved.status == 200 and len(saved.body) > 1000, form
            stopped_is_told(studio, page)
        studio.kill()
        with bench.studio("sequence", "--demo", port=studio.port) as again:
            state = again.wait("what was there", lambda s: calibrated_from(s, 2))
            assert [c["frames"] for c in state["scan"]["clouds"]] == [FRAMES[method] for method in METHODS]
            assert [u["name"] for u in state["scan"]["unfinished"]] == [f"scan-00{len(METHODS) + 1}"] and state["scan"]["method"] == METHODS[-1]


def same_by_command(bench: Bench, studio: Studio, cloud: str) -> None:
    """The command in the log makes the same cloud."""
    command = shlex.split((studio.folder / "commands.txt").read_text().splitlines()[-1])
    assert command[:2] == ["slcal", "reconstruct"] and command[-2:] == ["-o", cloud], command
    given = [str(studio.folder / word) if (studio.folder / word).exists() else word for word in command[2:-1]]
    again = bench.folder / f"again-{cloud}"
    bench.run("reconstruct", *given, again)
    assert again.read_bytes() == (studio.folder / cloud).read_bytes()
    assert abs(sphere_radius(again) - sphere_radius(studio.folder / cloud)) < 1e-9


def stopped_is_told(studio: Studio, page: Operator) -> None:
    page.press("scan", mode="once")
    studio.wait("a few photographs", lambda s: s["scan"]["shots"] and s["scan"]["shots"]["frame"] >= 3, 120)
    page.press("scan", mode="stop")
    state = studio.wait("the end", lambda s: not s["scan"]["shots"])
    assert state["scan"]["unfinished"][0]["have"] >= 2 and len(state["scan"]["clouds"]) == len(METHODS)
    wait_until("the page says so", lambda: "not finished" in page.text("[data-state=unfinished]"))
    page.wait_for(selected("scan", mode="once"))
    page.keep("22-stopped")


CHECKS = (a_sequence_is_shown_photographed_and_reconstructed_by_one_click,)
