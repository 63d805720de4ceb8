"""Learning: rollouts, PPO with a central critic, checkpoints; the one home of training."""
