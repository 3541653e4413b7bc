"""One file a job: segment, evaluate, plan, score, contact sheets."""
