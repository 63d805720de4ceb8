"""The benchmark: every setting with every method and every seed, each trial exactly once."""

from __future__ import annotations

import hashlib
import re
from collections import defaultdict
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from contextlib import closing
from dataclasses import dataclass, field, replace
from functools import cache
from pathlib import Path

from teamformer.base.errors import TeamformerError
from teamformer.bench.executors import Engine
from teamformer.bench.jobs import Job, known_row, ready_method
from teamformer.bench.rows import Row
from teamformer.bench.store import BenchmarkDescription, Store
from teamformer.bench.suites import Suite, cells, player_of
from teamformer.bench.trials_in_time import why_not_in_time
from teamformer.files.drawn.named_settings import is_in_time, size_of
from teamformer.files.imports.authors import read_worlds
from teamformer.methods.by_name import files_of_own, without_suffix
from teamformer.methods.listings import method_names, our_method_names

TIMED = 50
"""The first so many trials of each method in each setting run one by one, for their time."""

TIMED_AT_ONCE = 5
MOST_SIDE_BY_SIDE = 50
MOST_ROBOTS_SIDE_BY_SIDE = 1000
"""How large jobs are: what a crash can cost, and what memory a process needs."""

AUTHORS = "authors-heuristic"
"""The name of the authors' own heuristic, whose makespans come with their worlds."""


@dataclass(frozen=True)
class Request:
    """What is asked for; empty `methods` and `settings` mean the suite's own.

    `worlds` are files with worlds of the paper's authors, by setting.
    """

    suite: Suite
    trials: int
    first_seed: int = 0
    time_limit: float = 10.0
    methods: tuple[str, ...] = ()
    settings: tuple[str, ...] = ()
    workers: int = 1
    worlds: Mapping[str, Path] = field(default_factory=dict)

    @property
    def about(self) -> BenchmarkDescription:
        """Return what all rows of this benchmark have in common."""
        stamp = hashlib.sha256()
        for path in sorted(self.worlds.values()):
            stamp.update(path.read_bytes())
        return BenchmarkDescription(
            suite=self.suite.name,
            first_seed=self.first_seed,
            rules={**self.suite.rules, **self.suite.method_settings},
            worlds=stamp.hexdigest()[:12] if self.worlds else "",
        )

    def seeds(self, setting: str) -> list[int]:
        """Return the world seeds of a setting."""
        if setting in self.worlds:
            seeds = [world.seed for world in read_worlds(self.worlds[setting])]
            return [seed for seed in seeds if seed >= self.first_seed][: self.trials]
        return list(range(self.first_seed, self.first_seed + self.trials))


def run_benchmark(
    request: Request,
    store: Store,
    engine: Engine,
    say: Callable[[str], None],
    on_rows: Callable[[int, int], None] = lambda done, total: None,
) -> None:
    """Run every trial that the store does not hold yet.

    What cannot be run, a method that is not there or does not fit, is said and left out.
    `on_rows` is told how many trials are there, of how many.
    """
    wanted = list(fitting_cells(request, say))
    if not wanted:
        raise TeamformerError("no method of those asked for fits any setting of those asked for")
    _check_limit(request, wanted, store)
    code = code_stamp()
    store.add(_authors_rows(request, code))
    _forget_changed(wanted, store, say)
    if {row.code.split("+")[0] for row in store.rows.values()} - {code}:
        say(f"{store.folder}: holds rows that other versions of the code made; they are kept")
    jobs = list(_jobs(request, wanted, store, code))
    total = sum(len(request.seeds(setting)) for setting, _ in wanted)
    missing = sum(len(job.seeds) for job in jobs)
    if 0 < missing < total:
        say(f"{total - missing} of {total} trials are there already")
    on_rows(total - missing, total)
    with closing(engine(jobs, request.workers)) as batches:
        for rows in batches:
            store.add(rows)
            missing -= len(rows)
            on_rows(total - missing, total)
    store.finish(_order(request.suite))


def _forget_changed(
    wanted: Sequence[tuple[str, str]], store: Store, say: Callable[[str], None]
) -> None:
    """Have the trials of a user's own method run again if its code is not what it was."""
    for method in sorted({method for _, method in wanted}):
        own = own_stamp(method)
        old = [
            key for key, row in store.rows.items() if row.method == method and own != own_part(row)
        ]
        if old:
            say(f"{method} has changed since; its {len(old)} trials are run again")
            store.forget(old)


def own_part(row: Row) -> str:
    """Return the stamp of a user's own method that a row's code has; empty for one of ours."""
    return row.code.partition("+")[2]


def _check_limit(request: Request, wanted: Sequence[tuple[str, str]], store: Store) -> None:
    """Refuse to mix plans that were given more time with plans that were given less."""
    asked = {method for _, method in wanted}
    for row in store.rows.values():
        if row.method in asked and row.time_limit not in (None, request.time_limit):
            what = f"{row.method} had {row.time_limit:g} s here, not {request.time_limit:g} s"
            raise TeamformerError(
                f"{store.folder}: {what}", "give the same --time-limit, or name another folder"
            )


def fitting_cells(request: Request, say: Callable[[str], None]) -> Iterator[tuple[str, str]]:
    """Yield every (setting, method) that can be run; say which cannot, and why."""
    said: set[str] = set()
    for setting, method in cells(request.suite, request.methods, request.settings):
        why = ""
        is_listed = without_suffix(player_of(method)) in (*method_names(), AUTHORS)
        if not is_listed and not request.methods:
            why = f"{method}: not in this installation; skipped"
        elif not fits(method, setting):
            why = f"{method}: does not fit {setting}; skipped"
        elif method != AUTHORS:  # an unknown name ends it here
            player = ready_method(player_of(method), request.time_limit)
            if is_in_time(setting) and (refused := why_not_in_time(player)):
                why = f"{setting}: {refused}; skipped"
        if not why:
            yield setting, method
        elif why not in said:
            said.add(why)
            say(why)


def fits(method: str, setting: str) -> bool:
    """Say whether a method made for a number of capabilities, `-c4`, can serve a setting."""
    most = re.search(r"-c(\d+)(-|$)", method)
    return most is None or size_of(setting).capabilities <= int(most[1])


def _jobs(
    request: Request, wanted: Iterable[tuple[str, str]], store: Store, code: str
) -> Iterator[Job]:
    """Yield what is still to be run; the first job that meets a world works out its bars."""
    known = {(row.setting, row.world_seed) for row in store.rows.values() if row.lower_bound}
    for setting, method in wanted:
        job = Job(
            request.suite.name,
            setting,
            method,
            (),
            request.time_limit,
            "+".join(filter(None, (code, own_stamp(method)))),
            worlds=request.worlds.get(setting),
            rules=request.suite.rules,
            settings=request.suite.method_settings.get(method, {}),
        )
        alone = _goes_alone(method, request)
        groups: dict[tuple[bool, bool], list[int]] = defaultdict(list)
        for place, seed in enumerate(request.seeds(setting)):
            if (setting, method, seed) not in store.rows:
                groups[alone or place < TIMED, (setting, seed) not in known].append(seed)
                known.add((setting, seed))
        for (is_timed, bare), seeds in groups.items():
            for some in _in_jobs(seeds, _lot_size(setting, is_timed, alone)):
                yield replace(job, seeds=some, is_timed=is_timed, with_bars=bare)


def _goes_alone(method: str, request: Request) -> bool:
    """Say whether trials must not share a batch: a planner's, and those of methods not ours."""
    method = player_of(method)
    is_ours = without_suffix(method) in our_method_names()
    return not is_ours or ready_method(method, request.time_limit).needs_everything


def _lot_size(setting: str, is_timed: bool, alone: bool) -> int:
    if alone:
        return 1
    if is_timed:
        return TIMED_AT_ONCE
    return max(1, min(MOST_SIDE_BY_SIDE, MOST_ROBOTS_SIDE_BY_SIDE // size_of(setting).robots))


def _in_jobs(seeds: Sequence[int], size: int) -> Iterator[tuple[int, ...]]:
    for begin in range(0, len(seeds), size):
        yield tuple(seeds[begin : begin + size])


def _authors_rows(request: Request, code: str) -> Iterator[Row]:
    """Yield the makespans that come with the authors' worlds, as rows of their heuristic."""
    for setting, path in request.worlds.items():
        job = Job(request.suite.name, setting, AUTHORS, (), 0.0, code, worlds=path)
        seeds = set(request.seeds(setting))
        for world in read_worlds(path):
            if world.seed in seeds:
                yield known_row(job, world.seed, world.mission, world.heuristic)


def _order(suite: Suite) -> Callable[[Row], tuple[int, int, str, int]]:
    """Return what rows are put in order by: as the suite has settings and methods."""
    settings = {name: place for place, name in enumerate(suite.settings)}
    listed = dict.fromkeys(method for _, method in cells(replace(suite, without=())))
    methods = {name: place for place, name in enumerate(listed)}

    def key(row: Row) -> tuple[int, int, str, int]:
        setting = settings.get(row.setting, len(settings))  # others: of an older suite file
        return setting, methods.get(row.method, len(methods)), row.method, row.world_seed

    return key


@cache
def own_stamp(method: str) -> str:
    """Return a text that changes when the file of a user's own method does, or a trained folder.

    It is empty for the methods that come with the package.
    """
    stamp = hashlib.sha256()
    files = files_of_own(player_of(method))
    for path in files:
        stamp.update(path.name.encode() + path.read_bytes())
    return stamp.hexdigest()[:12] if files else ""


@cache
def code_stamp() -> str:
    """Return a text that changes when the code, a suite or a shipped network does."""
    root = Path(__file__).parents[1]
    stamp = hashlib.sha256()
    for path in sorted(root.rglob("*")):
        if path.suffix in (".py", ".yaml", ".onnx"):
            stamp.update(str(path.relative_to(root)).encode() + path.read_bytes())
    return stamp.hexdigest()[:12]
