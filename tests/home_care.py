"""A small instance of home health care: two patients, one of whom two caregivers visit."""

from __future__ import annotations

from typing import Any

HHCRSP: Any = {
    "patients": [
        {
            "id": "p1",
            "location": [3, 4],
            "time_window": [10, 20],
            "required_caregivers": [{"service": "s2"}],
        },
        {
            "id": "p2",
            "location": [-3, 4],
            "time_window": [0, 30],
            "required_caregivers": [
                {"service": "s1", "duration": 4},
                {"service": "s2", "duration": 7},
            ],
            "synchronization": {"type": "sequential", "distance": [5, 9]},
        },
    ],
    "services": [{"id": "s1", "default_duration": 3}, {"id": "s2", "default_duration": 6}],
    "caregivers": [{"id": "c1", "abilities": ["s1", "s2"]}, {"id": "c2", "abilities": ["s2"]}],
    "central_offices": [{"id": "d", "location": [0, 0]}],
    "distances": [[0, 5, 5], [7, 0, 6], [5, 6, 0]],
}
