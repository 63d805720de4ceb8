"""The nodes and edges of a mission on roads, as its vehicles know them."""

from __future__ import annotations

import math
from pathlib import Path

from teamformer.files.imports.lif import LaidOutGraph, read_layout
from teamformer.fleet.bodies.vda5050.state import State
from teamformer.fleet.fleet_mission import FleetMission
from teamformer.mission.parts.grid import Place
from teamformer.mission.parts.roads import Roads

ALMOST = 0.98
"""The share of a way that a vehicle has driven at most while it has not passed the next node."""


NEAR = 1.0
"""Metres from a node at which a vehicle that has passed none stands there."""


class RoadGraph:
    """Names places of roads as nodes, and knows at which node a vehicle is or comes next.

    A node is called as its place, an edge as in the layout; without a layout, or where it does not
    have the edge, an edge is called by its ends, as in `dock-gate`.
    """

    def __init__(
        self, mission: FleetMission, robot: int, layout: LaidOutGraph | None = None
    ) -> None:
        world = mission.source.world
        assert isinstance(world, Roads), "only these have a graph"
        self._world, self._ways = world, mission.ways
        self._moves, self._pace = mission.source.robots[robot].moves, mission.paces[robot]
        self._layout = layout or LaidOutGraph({}, {})
        self._numbers = {name: number for number, name in enumerate(world.places)}
        self._on: tuple[int, int] = (-1, -1)  # the places between which the vehicle drives
        self._driven, self._looked = 0.0, 0.0

    def node(self, place: Place) -> str:
        """Return the node of a place."""
        return self._world.name_of(place)

    def edge(self, start: str, end: str) -> str:
        """Return the edge from one node to another."""
        by_type = self._layout.edges.get((start, end), {})
        return by_type.get(self._moves) or next(iter(by_type.values()), f"{start}-{end}")

    def position(self, place: Place) -> Place | None:
        """Return where a node is in metres, if the layout says so."""
        return self._layout.positions.get(self.node(place))

    def between(self, here: Place, goal: Place) -> list[Place]:
        """Return the places on the way from one place to another."""
        start = (here[0], 0)
        if start == goal or not self._world.leads(self._moves, start, goal):
            return []
        return [place for place, _ in self._ways.stages(start, goal, self._moves)][:-1]

    def locate(self, state: State, now: float) -> Place | None:
        """Return the place where a vehicle is, or comes next with the seconds that it takes there.

        None if it does not say at which of the nodes it was last. A vehicle does not tell how far
        it has come, so it is taken to drive as fast as the table says, while it says that it does.
        """
        last = self._numbers.get(state.last_node, self._near(state.place))
        following = self._numbers.get(state.next_node)
        if last is None or following is None or following == last:
            self._on = (-1, -1)
            return None if last is None else (last, 0)
        takes = float(self._world.ways[self._moves][last][following]) / self._pace
        if self._on != (last, following):
            self._on, self._driven, self._looked = (last, following), 0.0, now
        if state.is_moving:
            self._driven = min(ALMOST * takes, self._driven + now - self._looked)
        self._looked = now
        return following, takes - self._driven

    def _near(self, at: Place | None) -> int | None:
        """Return the node at which a vehicle stands that has passed none yet, if one is near."""
        known = self._layout.positions
        away = {} if at is None else {name: math.dist(at, known[name]) for name in known}
        nearest = min(away, key=away.__getitem__, default="")
        return self._numbers.get(nearest) if nearest and away[nearest] <= NEAR else None


def graph_of(mission: FleetMission, robot: int, layout: str | None) -> RoadGraph | None:
    """Return the graph of a mission on roads, with the names of a LIF file; None for others.

    Raises what reading the file raises.
    """
    if not isinstance(mission.source.world, Roads):
        return None
    return RoadGraph(mission, robot, None if layout is None else read_layout(Path(layout)))
