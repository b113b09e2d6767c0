"""Submissions: one file with the actions of a run, which anybody can replay; their verification, and sealed splits.

Nothing here imports an agent: a replay needs the house, the robot, the task and the recorded actions.
"""
