# SPDX-License-Identifier: GPL-2.0-only
"""The part of bench/scaling.py that is about more ranks than are here.

t_frame = max(work/K imbalance + plan + exchange + moves, supervisor): terms measured, then carried on to 10^3 ranks. A frame is
one window. Supervisor and executors work at the same time, so the slower of them sets the pace. Plans are made here, for a crowd
of as many objects and executors: their time and the imbalance that they leave are those of the program.
"""

import pickle
import statistics
import time

import numpy as np


def table(data: dict, crowd_scene) -> str:
    """Markdown: costs per unit, and what comes of them. ``data`` is scaling.json, the scene one that is prepared."""
    cost = fit(data, crowd_scene)
    lines = [f"- {name}: {value:.3g} {unit}" for name, (value, unit) in cost.items()]
    lines.append(
        "\n| particles | executors | work/K, balanced | imbalance | plan, exchange | moves | supervisor | frame [s] | "
        "times as fast | bound by | were it not for the supervisor |\n|---|---|---|---|---|---|---|---|---|---|---|"
    )
    values = {name: value for name, (value, _) in cost.items()}
    lines += [
        row(objects, size, executors, values)
        for objects, size in ((1_000, 1_000), (10_000, 1_000), (100_000, 1_000))
        for executors in (1, 16, 128, 1_024)
        if objects >= 4 * executors
    ]
    return "\n".join(lines)


def fit(data: dict, crowd_scene) -> dict:
    """Costs per unit, out of the runs where they show, else measured now."""
    from mdanim_lammps.parallel.plan.orders import Order
    from scipy.optimize import nnls

    hail, crowd = (data["runs"][name] for name in ("hail", "crowd"))
    known = data["known"]
    work = statistics.median(r["cpu"] / r["frames"] / known["hail"]["particles"] for r in hail["0"])
    distributed = {
        name: [(int(case.split()[0]), r) for case, runs in of.items() if case != "0" for r in runs]
        for name, of in (("hail", hail), ("crowd", crowd))
    }
    # Time of the supervisor for a frame, for an object in it, and for a particle.
    seen = np.array([(1, r[0]["objects"], r[0]["particles"]) for r in data["supervisor"].values()])
    medians = np.array([statistics.median(s for r in runs for s in r["seconds"]) for runs in data["supervisor"].values()])
    per_frame, per_object, per_particle = nnls(seen / medians[:, None], np.ones(len(medians)))[0].tolist()
    moving = statistics.median(r["spent"][1] * k / r["moves"] for k, r in distributed["crowd"] if r["moves"])
    scene, order = crowd_scene, _plan(10_000, 8)[0]
    message = Order(order, np.zeros((10_000, 3)), np.zeros((10_000, 3)), 100, True)
    seconds = least(lambda: pickle.loads(pickle.dumps(message, protocol=pickle.HIGHEST_PROTOCOL)))
    return {
        "work": (work, "s of processor time per particle and frame (hail)"),
        "per_particle": (per_particle, "s of the supervisor per particle and frame"),
        "per_object": (per_object, "s of the supervisor per object and frame"),
        "per_frame": (per_frame, "s of the supervisor per frame, besides"),
        "moved": (moving, "s of executors for an object that moves, with instances built anew (crowd, wall time)"),
        "order": (seconds / 10_000, "s to pack and unpack an order, per object (central: once for each executor)"),
        "memory": (
            len(pickle.dumps(scene.plan)) / scene.system.particles + 72,
            "bytes of every executor per particle of the scene",
        ),
        "latency": (LATENCY, "s for a message between hosts (assumed)"),
        "wire": (1.0 / BANDWIDTH, "s per byte between hosts (assumed)"),
    }


LATENCY, BANDWIDTH = 2e-4, 1e9
"""Latency of a message [s], mostly the nap of the process that waits for it (messages.NAP); a network of 10 Gbit [bytes/s]."""
SHARE = 120
"""Bytes of an executor's share of a frame for each of its objects."""
MOVES = 0.004
"""Part of the objects that move in a frame: crowds of a thousand, `python bench/planning.py crowd`."""


def _plan(objects: int, executors: int):
    """The second plan of a crowd, one object in a volume of 30 of them, after all have gone on a little; and its seconds."""
    from mdanim_lammps.parallel.plan import frame_plan as planning

    rng = np.random.default_rng(objects)
    low = rng.uniform(0.0, (30.0 * objects) ** (1.0 / 3.0), (objects, 3))
    edge, d = rng.uniform(0.5, 1.0, (objects, 3)), np.full(objects, 0.05)
    cost = (1e4 * rng.uniform(0.9, 1.1, objects)).astype(np.int64)
    known = dict(particles=np.full(objects, 1000), still=np.zeros(objects, bool), gap=0.1)
    first = planning.plan(low, low + edge, d, cost, np.full(objects, -1), executors, **known)
    low += rng.normal(0.0, 0.1, low.shape)
    begin = time.process_time()
    second = planning.plan(low, low + edge, d, cost, first.owner, executors, previous=first, **known)
    return second, time.process_time() - begin


def least(work, turns: int = 5) -> float:
    """Seconds of a call, the least of some."""
    spent = []
    for _ in range(turns):
        start = time.process_time()
        work()
        spent.append(time.process_time() - start)
    return min(spent)


def row(objects: int, size: int, executors: int, cost: dict) -> str:
    """A line of the table, under the control that is faster there."""
    particles = objects * size
    plan, planning = _plan(objects, executors)
    imbalance = float(plan.load.max() / plan.load.mean())
    work = cost["work"] * particles / executors
    report, order = 64.0 * objects, 100.0 * objects  # bytes
    steps = np.ceil(np.log2(max(2, executors)))
    exchange = {
        "central": planning + executors * (cost["order"] * objects + order * cost["wire"]) + 2 * cost["latency"],
        "peers": planning + report * cost["wire"] + steps * cost["latency"] + cost["order"] * objects,
    }
    if executors == 1:
        exchange = {"central": 0.0}
    control = min(exchange, key=exchange.get)
    moves = MOVES * objects / executors * cost["moved"] * (executors > 1)
    told = (cost["per_object"] + SHARE * cost["wire"]) * objects
    supervisor = cost["per_frame"] + told + cost["per_particle"] * particles
    mine = work * imbalance + exchange[control] + moves
    frame = max(mine, supervisor)
    terms = {"work": work * imbalance, f"exchange ({control})": exchange[control], "moves": moves}
    bound = "supervisor" if supervisor > mine else max(terms, key=terms.get)
    return (
        f"| {particles:,} | {executors:,} | ".replace(",", " ")
        + f"{work:.3g} | {imbalance:.2f} | {exchange[control]:.2g} | {moves:.2g} | {supervisor:.2g} "
        + f"| {frame:.3g} | {cost['work'] * particles / frame:.3g} | {bound} | "
        f"{cost['work'] * particles / mine:.3g} |"
    )
