"""Writes a football pitch of dm_control with a ball on it."""

import sys

from dm_control import mjcf
from dm_control.locomotion.soccer import pitch, soccer_ball

arena = pitch.Pitch(size=(7.0, 5.0), goal_size=(0.6, 1.5, 1.2))
ball = soccer_ball.SoccerBall()
arena.add_free_entity(ball)
mjcf.export_with_assets(arena.mjcf_model, sys.argv[1], "pitch.xml")
