"""Logs of a simulated robot, made worse as sensors, cables and robots make them worse. Each kind of KINDS changes the scans of a log in place.

usage: dirty_logs.py IN.jsonl OUT.jsonl KIND [SEED]; without arguments the kinds.
A kind is a function of (scans, chance, **its numbers); another one is a line of KINDS.
"""
import json
import math
import random
import sys

FIRST = 15  # scans at the start that stay whole


def chosen(scans, chance, share):
    return [k for k in range(FIRST, len(scans)) if chance.random() < share]


def turned(scans, chance, share):
    """A driver that lost the index pulse: the whole turn begins 15 to 170 degrees late."""
    for k in chosen(scans, chance, share):
        r = scans[k]["ranges"]
        late = chance.randint(len(r) // 24, len(r) * 17 // 36)
        scans[k]["ranges"] = r[late:] + r[:late]


def lost_part(chance, beams):
    """First beam and number of beams of one to a third of 10 to 20 packets in a row."""
    packets = chance.randint(10, 20)
    gone = chance.randint(1, packets // 3) * beams // packets
    return chance.randrange(packets * 2 // 3) * beams // packets, gone


def packets_lost(scans, chance, share):
    """One to a third of 10 to 20 packets are lost, what came later moves up, and the end has no return."""
    for k in chosen(scans, chance, share):
        r = scans[k]["ranges"]
        at, gone = lost_part(chance, len(r))
        scans[k]["ranges"] = r[:at] + r[at + gone:] + [0] * gone


def packets_kept(scans, chance, share):
    """The same, and the end is what a buffer still had from the turn before."""
    whole = [list(s["ranges"]) for s in scans]
    for k in chosen(scans, chance, share):
        r = whole[k]
        at, gone = lost_part(chance, len(r))
        scans[k]["ranges"] = r[:at] + r[at + gone:] + whole[k - 1][len(r) - gone:]


def of_another_time(scans, chance, share):
    """Half of the turn is from another time: 5 to 60 s before."""
    whole = [list(s["ranges"]) for s in scans]
    for k in chosen(scans, chance, share):
        other = whole[max(0, k - chance.randint(50, 600))]
        half = len(other) // 2
        scans[k]["ranges"] = other[:half] + whole[k][half:] if chance.random() < 0.5 else whole[k][:half] + other[half:]


def body(scans, chance, shape, view_deg=180.0, distance=0.25, at_deg=180.0):
    """Parts of the robot in the scan plane: posts, a flat plate, a round housing, a box around a corner."""
    half = view_deg / 2.0
    for s in scans:
        s["range_min"] = min(s["range_min"], 0.05)
        for k in range(len(s["ranges"])):
            off = (math.degrees(s["angle_min"] + k * s["angle_increment"]) - at_deg + 180.0) % 360.0 - 180.0
            r = None
            if shape == "posts" and any(abs((off - c + 180) % 360 - 180) < view_deg / 8 for c in (-135, -45, 45, 135)):
                r = distance
            elif shape != "posts" and abs(off) < half:
                a = math.radians(off)
                r = {"ring": distance, "plate": distance / max(0.2, math.cos(a)),
                     "box": distance / max(0.2, abs(math.cos(a)), abs(math.sin(a)))}[shape]
            if r is not None:
                s["ranges"][k] = round(r + chance.gauss(0.0, 0.005), 4)


KINDS = {
    "clean": lambda scans, chance: None,
    "1 % turned": lambda scans, chance: turned(scans, chance, 0.01),
    "3 % turned": lambda scans, chance: turned(scans, chance, 0.03),
    "1 % packets lost": lambda scans, chance: packets_lost(scans, chance, 0.01),
    "3 % packets lost": lambda scans, chance: packets_lost(scans, chance, 0.03),
    "3 % packets kept": lambda scans, chance: packets_kept(scans, chance, 0.03),
    "1 % half of another time": lambda scans, chance: of_another_time(scans, chance, 0.01),
    "own posts, 60 deg": lambda scans, chance: body(scans, chance, "posts", 60, 0.2),
    "own plate, 90 deg": lambda scans, chance: body(scans, chance, "plate", 90, 0.3),
    "own ring, 180 deg": lambda scans, chance: body(scans, chance, "ring", 180, 0.25),
    "own box, 150 deg": lambda scans, chance: body(scans, chance, "box", 150, 0.4, 150),
    "own ring, 200 deg": lambda scans, chance: body(scans, chance, "ring", 200, 0.5, -160),
}


def make(source, target, kind, seed=1):
    with open(source) as log:
        scans = [json.loads(line) for line in log]
    KINDS[kind](scans, random.Random(seed))
    with open(target, "w") as out:
        for s in scans:
            out.write(json.dumps(s) + "\n")


if __name__ == "__main__":
    if len(sys.argv) < 4:
        sys.exit("\n".join(KINDS))
    make(sys.argv[1], sys.argv[2], sys.argv[3], int(sys.argv[4]) if len(sys.argv) > 4 else 1)
