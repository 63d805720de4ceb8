"""What turns views into decisions, behind one seam.

A new policy is one file and one line in `POLICIES`.
"""

from teamformer.policies.listing import Listing

POLICIES = (
    Listing(
        "teamformer",
        "teamformer.policies.learned.any_fleet:teamformer_any",
        "the best learned policy that comes with the package: teamformer-any",
        trained_on="any number of capabilities",
    ),
    Listing(
        "heuristic", "teamformer.policies.scripted.heuristic:Heuristic", "the paper's heuristic"
    ),
    Listing(
        "join-all",
        "teamformer.policies.scripted.joining:JoinAll",
        "joins whom it helps to join, never splits",
    ),
    Listing(
        "join-fitting",
        "teamformer.policies.scripted.join_fitting:JoinFitting",
        "as join-all, but joins nobody whom no task needs",
    ),
    Listing(
        "join-crew",
        "teamformer.policies.scripted.joining:JoinCrew",
        "as join-all, but joins only its own crew",
    ),
    Listing(
        "follow-plan",
        "teamformer.policies.scripted.follow_plan:FollowPlan",
        "plays the shared plan; without one as join-crew or join-all",
    ),
    Listing(
        "teamformer-any",
        "teamformer.policies.learned.any_fleet:teamformer_any",
        "learned; for any fleet, says where to deviate from join-fitting or join-crew",
        trained_on="any number of capabilities",
    ),
    Listing(
        "teamformer-c4",
        "teamformer.policies.learned.autoregressive:teamformer_c4",
        "the paper's transformer, taught by join-fitting",
        trained_on="up to 4 capabilities",
    ),
    Listing(
        "teamformer-c4-ppo",
        "teamformer.policies.learned.autoregressive:teamformer_c4_ppo",
        "the paper's transformer, by PPO from nothing",
        trained_on="up to 4 capabilities",
    ),
    Listing(
        "teamformer-c8",
        "teamformer.policies.learned.autoregressive:teamformer_c8",
        "the paper's transformer, taught by join-fitting",
        trained_on="up to 8 capabilities",
    ),
    Listing(
        "teamformer-c8-ppo",
        "teamformer.policies.learned.autoregressive:teamformer_c8_ppo",
        "the paper's transformer, by PPO from nothing",
        trained_on="up to 8 capabilities",
    ),
    Listing(
        "teamformer-c100",
        "teamformer.policies.learned.autoregressive:teamformer_c100",
        "the paper's transformer, taught by join-fitting",
        trained_on="up to 100 capabilities",
    ),
    Listing(
        "teamformer-c100-ppo",
        "teamformer.policies.learned.autoregressive:teamformer_c100_ppo",
        "the paper's transformer, by PPO from nothing",
        trained_on="up to 100 capabilities",
    ),
    Listing(
        "deepset-c4",
        "teamformer.policies.learned.combinations:deepset_c4",
        "the paper's deep set with attention, taught by join-fitting",
        trained_on="up to 4 capabilities",
    ),
    Listing(
        "deepset-c4-ppo",
        "teamformer.policies.learned.combinations:deepset_c4_ppo",
        "the paper's deep set with attention, by PPO from nothing",
        trained_on="up to 4 capabilities",
    ),
    Listing(
        "deepset-c8",
        "teamformer.policies.learned.combinations:deepset_c8",
        "the paper's deep set with attention, taught by join-fitting",
        trained_on="up to 8 capabilities",
    ),
    Listing(
        "deepset-c8-ppo",
        "teamformer.policies.learned.combinations:deepset_c8_ppo",
        "the paper's deep set with attention, by PPO from nothing",
        trained_on="up to 8 capabilities",
    ),
    Listing(
        "gnn-c4",
        "teamformer.policies.learned.combinations:gnn_c4",
        "the paper's graph network, taught by join-fitting",
        trained_on="up to 4 capabilities",
    ),
    Listing(
        "gnn-c4-ppo",
        "teamformer.policies.learned.combinations:gnn_c4_ppo",
        "the paper's graph network, by PPO from nothing",
        trained_on="up to 4 capabilities",
    ),
    Listing(
        "gnn-c8",
        "teamformer.policies.learned.combinations:gnn_c8",
        "the paper's graph network, taught by join-fitting",
        trained_on="up to 8 capabilities",
    ),
    Listing(
        "gnn-c8-ppo",
        "teamformer.policies.learned.combinations:gnn_c8_ppo",
        "the paper's graph network, by PPO from nothing",
        trained_on="up to 8 capabilities",
    ),
    Listing(
        "central",
        "teamformer.policies.central.policy:Central",
        "knows everything, searches for a plan, proves bounds with OR-Tools CP-SAT",
    ),
)
