"""The relaxed problem, in which joining and splitting are free: schedules, search and proofs."""
