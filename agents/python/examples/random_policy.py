"""Has chance play missions that are made up, many worlds in a call, and says how fast and how well it does."""

import time

import numpy as np

import cohabit

STEPS, WORLDS = 50, 4

random = np.random.default_rng(0)
suite = cohabit.generate(6, seed=3)
parts = suite.split()
print(suite, "in", len(parts), "parts, such as:", suite[0].instruction)

envs = cohabit.VectorEnv(suite, WORLDS, planes=("color",), size=84, ticks_per_step=10)
envs.reset(seed=0)
began = time.perf_counter()
for _ in range(STEPS):
    observation, rewards, terminated, truncated, infos = envs.step(envs.sample())
print(f"{STEPS * WORLDS / (time.perf_counter() - began):.0f} steps/s, pictures of {observation['color'].shape}")

print(
    cohabit.evaluate(
        lambda observation, infos: cohabit.sample_actions(infos["action_masks"], random),
        suite,
        planes=(),
        max_steps=20,
        ticks_per_step=60,
    )
)
