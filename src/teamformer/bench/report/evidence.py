"""What a folder of rows can say to a claim: means, savings and failures by setting and method."""

from __future__ import annotations

from collections.abc import Sequence

from teamformer.bench.rows import Row
from teamformer.bench.statistics import Mean, mean_of
from teamformer.bench.summary import Summary, differences, summarise


class Evidence:
    """Rows, looked up by setting and method; None where something was not measured."""

    def __init__(self, rows: Sequence[Row]) -> None:
        self.rows = rows
        self.summaries = summarise(rows)
        self._summaries = {(s.setting, s.method): s for s in self.summaries}
        self._makespans: dict[tuple[str, str], dict[int, float]] = {}
        for row in rows:
            worlds = self._makespans.setdefault((row.setting, row.method), {})
            if row.makespan is not None:
                worlds[row.world_seed] = row.makespan

    def summary(self, setting: str, method: str) -> Summary | None:
        """Return how a method did in a setting."""
        return self._summaries.get((setting, method))

    def difference(self, setting: str, method: str, bar: str) -> Mean | None:
        """Return the mean difference in makespan to another method, world by world."""
        ours = self._makespans.get((setting, method))
        theirs = self._makespans.get((setting, bar))
        return differences(ours, theirs) if ours and theirs else None

    def saving(self, setting: str, method: str, bar: str) -> Mean | None:
        """Return the share of another method's mean makespan that is saved, on the same worlds."""
        difference = self.difference(setting, method, bar)
        if not difference or not difference.count:
            return None
        ours = self._makespans[setting, method]
        theirs = self._makespans[setting, bar]
        mean = mean_of([theirs[world] for world in theirs if world in ours]).value
        return Mean(-difference.value / mean, difference.deviation / mean, difference.count)

    def from_optimum(self, setting: str, method: str) -> Mean | None:
        """Return how far makespans are from proven optimal schedules in which joining is free."""
        optimum = {
            row.world_seed: row.relaxed
            for row in self.rows
            if row.setting == setting and row.relaxed and row.relaxed == row.relaxed_bound
        }
        found = differences(self._makespans.get((setting, method), {}), optimum)
        return found if found.count else None

    def makespans(self, setting: str, method: str) -> list[float]:
        """Return the makespans of completed trials."""
        return list(self._makespans.get((setting, method), {}).values())

    def splits(self, setting: str, method: str) -> list[int]:
        """Return the splits of each trial."""
        trials = [row for row in self.rows if (row.setting, row.method) == (setting, method)]
        return [row.splits or 0 for row in trials]

    def least_timed(self) -> int:
        """Return how many trials a mean of inference times rests on at least."""
        return min((s.inference.count for s in self.summaries if s.inference.count), default=0)
