"""One family against points: what may move (freedom.py, demands.py), the solver (solve.py), how sure its numbers are
(settlement.py, uncertainty.py), which points it gets (evidence.py), and whose each point is (label.py).
"""
