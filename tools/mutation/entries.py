"""The list of one-line changes (tools/mutants.txt): read, looked up in today's code, put in.

An entry is a file, what rule is broken, the lines as they stand, and what stands there instead:

    src/graph/pose_graph.cpp | the robust kernel is left out
    - const double scale = options.kernel_m;
    + const double scale = 1e9;

Blanks at both ends of a line do not count. Lines marked with ` ` (a blank) stand before or after and stay; they are given
where the changed line alone occurs more than once. `#` begins a comment.
"""
import dataclasses
import pathlib

ROOT = pathlib.Path(__file__).resolve().parents[2]
LIST = ROOT / "tools/mutants.txt"


@dataclasses.dataclass(frozen=True)
class Entry:
    file: str
    rule: str
    old: tuple  # lines, blanks at both ends removed
    new: tuple
    line: int = dataclasses.field(compare=False)  # of the list

    @property
    def folder(self):
        return self.file.removeprefix("include/phasescan/").removeprefix("src/").split("/")[0]

    @property
    def key(self):
        return "\n".join([self.file, *self.old, "->", *self.new])


def read(path=LIST):
    found, head, old, new = [], None, [], []

    def end():
        if head and tuple(old) == tuple(new):
            raise ValueError(f"{path}:{head[2]}: changes nothing")
        if head:
            found.append(Entry(head[0], head[1], tuple(old), tuple(new), head[2]))
        old.clear(), new.clear()

    for number, line in enumerate(path.read_text().splitlines(), 1):
        if line.startswith("#") or not line.strip():
            continue
        if line[0] in "-+ ":
            if head is None:
                raise ValueError(f"{path}:{number}: no file before this line")
            text = line[1:].strip()
            if line[0] in "- ":
                old.append(text)
            if line[0] in "+ ":
                new.append(text)
        else:
            end()
            file, bar, rule = (part.strip() for part in line.partition("|"))
            if not bar or not rule:
                raise ValueError(f"{path}:{number}: expected FILE | WHAT RULE IS BROKEN, got '{line}'")
            head = (file, rule, number)
    end()
    seen = {}
    for entry in found:
        if entry.key in seen:
            raise ValueError(f"{path}:{entry.line}: the same change as in line {seen[entry.key]}")
        seen[entry.key] = entry.line
    return found


def places(entry, root=ROOT):
    """Where (first line, counted from 0) the old lines stand in the file; [] where the file is not there."""
    path = root / entry.file
    if not path.is_file():
        return []
    lines = [line.strip() for line in path.read_text().splitlines()]
    size = len(entry.old)
    return [k for k in range(len(lines) - size + 1) if tuple(lines[k:k + size]) == entry.old]


def changed(entry, root=ROOT):
    """The file's text with the change in it."""
    where = places(entry, root)
    if len(where) != 1:
        raise ValueError(f"{entry.file}: '{entry.old[0]}' stands there {len(where)} times, expected once")
    lines = (root / entry.file).read_text().splitlines()
    lines[where[0]:where[0] + len(entry.old)] = entry.new
    return "\n".join(lines) + "\n"


def stale(entries, root=ROOT):
    """Lines that say which entries do not fit today's code."""
    found = []
    for entry in entries:
        times = len(places(entry, root))
        if times != 1:
            gone = "no such file" if not (root / entry.file).is_file() else f"found {times} times"
            found.append(f"{LIST.relative_to(ROOT)}:{entry.line}: {entry.file}: {entry.rule}: {gone}")
    return found


def written(file, rule, context, old, new):
    """An entry as it stands in the list. @param context  lines before, which stay"""
    return "\n".join([f"{file} | {rule}", *(f"  {line}" for line in context), *(f"- {line}" for line in old), *(f"+ {line}" for line in new)])
