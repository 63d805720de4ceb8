"""What turns views into decisions, behind one seam.

A new policy is one file and one line in `POLICIES`.
"""

from teamformer.policies.registry import Listing

POLICIES = (
    Listing(
        "teamformer",
        "teamformer.policies.any_fleet:teamformer_any",
        "the best learned policy that comes with the package: teamformer-any",
        trained_on="any number of capabilities",
    ),
    Listing("heuristic", "teamformer.policies.heuristic:Heuristic", "the paper's heuristic"),
    Listing(
        "join-all",
        "teamformer.policies.scripted:JoinAll",
        "joins whom it helps to join, never splits",
    ),
    Listing(
        "join-crew",
        "teamformer.policies.scripted:JoinCrew",
        "as join-all, but joins only its own crew",
    ),
    Listing(
        "teamformer-any",
        "teamformer.policies.any_fleet:teamformer_any",
        "learned; for any fleet, joins only whom it pays to join",
        trained_on="any number of capabilities",
    ),
    Listing(
        "central",
        "teamformer.policies.central:Central",
        "knows everything, plans with OR-Tools CP-SAT",
    ),
)
