"""Recorded CARMEN logs as a worse scanner would have written them: noise on every range, or beams that did not come back."""
import gzip
import random

NO_RETURN = 81.9  # [m]


def make(source, target, noise_m=0.0, missing=0.0, seed=1):
    chance = random.Random(seed)
    with gzip.open(source, "rt") as log, open(target, "w") as out:
        for line in log:
            words = line.split()
            if words and words[0] == "FLASER":
                for k in range(2, 2 + int(words[1])):
                    r = float(words[k])
                    if r < 80.0:
                        r = NO_RETURN if chance.random() < missing else max(0.02, r + chance.gauss(0.0, noise_m))
                    words[k] = f"{r:.3f}"
                line = " ".join(words) + "\n"
            out.write(line)
