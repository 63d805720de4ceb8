"""What an iteration learns: rollouts, advantages, PPO and rollout improvement."""
