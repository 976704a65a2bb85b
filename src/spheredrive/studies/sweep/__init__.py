"""Many designs at once: what a study file varies, worked out in batches on one core or many machines, nothing lost.

Nothing is imported here: a worker process reads this before it has been told how many threads its libraries may start.
"""
