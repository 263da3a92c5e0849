"""Plays a built-in mission: takes the soda from the break room to the freeze ray, and waits until the ray has cooled it."""

import numpy as np

import cohabit
from cohabit import GoTo, Interact, PickUp, Place

env = cohabit.Env("cold_soda", planes=("color",))
env.reset(seed=0)
can, shelf, computer = "CanSodaNew_01_1", "AP_Prop_Shelf_Wall_04_10000", "V_Monitor_FreezeRay_10000"
for action in [GoTo(can), PickUp(can), GoTo(shelf), Place(shelf), GoTo(computer), Interact("toggle", computer)]:
    observation, reward, terminated, truncated, info = env.act(action)
    print(action, "->", info["detail"], f"(reward {reward:+.2f})")
# The computer is on at once; the freeze ray takes a moment.
wait = np.array([cohabit.CHOICES.index("wait"), 0])
while not (terminated or truncated):
    observation, reward, terminated, truncated, info = env.step(wait)
    print("wait", f"(reward {reward:+.2f})")
for goal in env.state.goals:
    print("met" if goal.met else "open", goal.description, sep=": ")
