"""Plays a built-in mission: takes the soda from the break room to the freeze ray."""

import cohabit
from cohabit import GoTo, Interact, PickUp, Place

env = cohabit.Env("cold_soda", planes=("color",))
env.reset(seed=0)
can, shelf, computer = "CanSodaNew_01_1", "AP_Prop_Shelf_Wall_04_10000", "V_Monitor_FreezeRay_10000"
for action in [GoTo(can), PickUp(can), GoTo(shelf), Place(shelf), GoTo(computer), Interact("toggle", computer)]:
    observation, reward, terminated, truncated, info = env.act(action)
    print(action, "->", info["detail"], f"(reward {reward:+.2f})")
print(env.state)
