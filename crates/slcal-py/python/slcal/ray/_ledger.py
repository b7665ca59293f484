"""Counts how often frames are started, across processes."""

from __future__ import annotations

from typing import Any

import ray
from ray.util.scheduling_strategies import NodeAffinitySchedulingStrategy


class Ledger:
    """Counts how often each frame was started and not finished, and for which photograph.

    Ray begins the work of a worker that died again, without end. A frame that kills its workers (by all the memory that it
    needs, say) would keep the job for ever; with the count it becomes a row like any other bad frame.
    """

    def __init__(self) -> None:
        self._begun: dict[str, int] = {}
        self._sources: dict[str, str] = {}

    def begin(self, frame: str, source: str) -> tuple[int, str]:
        """How often the frame was started, including now, and its photograph."""
        self._begun[frame] = self._begun.get(frame, 0) + 1
        return self._begun[frame], self._sources.setdefault(frame, source)

    def end(self, frame: str) -> None:
        """The frame is finished, with or without an error."""
        self._begun.pop(frame, None)


def new_ledger() -> Any:
    """A ledger that lives as long as the job, on the machine that started it."""
    here = NodeAffinitySchedulingStrategy(ray.get_runtime_context().get_node_id(), soft=True)
    # Should its process die, the counts begin anew, and no frame is lost.
    actor = ray.remote(Ledger).options(num_cpus=0, max_restarts=-1, max_task_retries=-1, scheduling_strategy=here)
    return actor.remote()
