"""Worlds whose places look alike, as world and path files of phasescan: aisles, uneven aisles, pillars, cubicles, drawn from a seed.

usage: repeating_worlds.py KIND SEED WORLD.yaml PATH.yaml; without arguments the kinds.
"""
import random
import sys


def text(points):
    return "[" + ", ".join(f"[{x:.3f}, {y:.3f}]" for x, y in points) + "]"


def box(x0, y0, x1, y1):
    return [(x0, y0), (x1, y0), (x1, y1), (x0, y1)]


def to_and_fro(left, right, rows):
    """Along each row, the next one the other way."""
    return [p for k, y in enumerate(rows) for p in ([(left, y), (right, y)] if k % 2 == 0 else [(right, y), (left, y)])]


def aisles(chance, uneven):
    """Shelves of one length in a hall; uneven: each begins and ends elsewhere."""
    count, length = chance.randint(4, 8), chance.uniform(6.0, 14.0)
    deep, aisle = chance.uniform(0.6, 1.2), chance.uniform(1.6, 2.4)
    width, height = length + 6.0, count * (deep + aisle) + aisle
    solids = []
    for k in range(count):
        a, b = (chance.uniform(-0.4, 0.6), chance.uniform(-0.6, 0.4)) if uneven else (0.0, 0.0)
        y = aisle + k * (deep + aisle)
        solids.append(box(3.0 + a, y, 3.0 + length + b, y + deep))
    rows = [k * (deep + aisle) + aisle / 2 for k in range(count + 1)]
    path = to_and_fro(1.5, width - 1.5, rows)
    return width, height, solids, [], path + [(path[-1][0], rows[0]), path[0]]


def pillars(chance):
    across, along, apart, half = chance.randint(4, 8), chance.randint(3, 6), chance.uniform(2.5, 4.0), chance.uniform(0.15, 0.3)
    width, height = across * apart, along * apart
    solids = [box(i * apart - half, k * apart - half, i * apart + half, k * apart + half) for i in range(1, across) for k in range(1, along)]
    rows = [(k + 0.5) * apart for k in range(along)]
    path = to_and_fro(apart / 2, width - apart / 2, rows)
    return width, height, solids, [], path + [(path[-1][0], rows[0]), path[0]]


def cubicles(chance):
    """Rooms of one size on both sides of a way, a desk in each."""
    count, size, deep, way = chance.randint(5, 9), chance.uniform(2.8, 4.0), chance.uniform(2.6, 3.6), chance.uniform(1.8, 2.4)
    width, height, door = count * size, 2 * deep + way, 1.2
    lines = []
    for k in range(count):
        x, gap = k * size, (size - door) / 2
        for y, side in ((deep, -1), (deep + way, 1)):
            lines += [[(x, y), (x + gap, y)], [(x + size - gap, y), (x + size, y)]]
            wall = 0.0 if side < 0 else height
            lines.append([(x + 0.01, y + side * 2.2), (x + 1.0, y + side * 2.2), (x + 1.0, wall)])
            if k > 0:
                lines.append([(x, wall), (x, y)])
    middle, step = height / 2, chance.choice((2, 3))
    path = [(0.8, middle)]
    for k in range(0, count, step):
        x = (k + 0.5) * size
        path += [(x, middle), (x, deep - 1.2), (x, middle)]
    for k in range(count - 1, -1, -step):
        x = (k + 0.5) * size
        path += [(x, middle), (x, deep + way + 1.2), (x, middle)]
    return width, height, [], lines, path + [(0.8, middle)]


KINDS = {"aisles": lambda chance: aisles(chance, False), "uneven": lambda chance: aisles(chance, True), "pillars": pillars, "cubicles": cubicles}


def make(kind, seed, world, path):
    width, height, solids, lines, way = KINDS[kind](random.Random(seed))
    outline = box(0, 0, width, height)
    with open(world, "w") as out:
        out.write("walls:\n")
        for points in [outline, *solids]:
            out.write(f"  - {{points: {text(points)}, closed: true}}\n" if points is not outline else f"  - {{points: {text(points + points[:1])}}}\n")
        for points in lines:
            out.write(f"  - {{points: {text(points)}}}\n")
        out.write(f"rooms:\n  - {text(outline)}\n")
    with open(path, "w") as out:
        out.write(f"points: {text(way)}\n")


if __name__ == "__main__":
    if len(sys.argv) != 5:
        sys.exit("\n".join(KINDS))
    make(sys.argv[1], int(sys.argv[2]), sys.argv[3], sys.argv[4])
